//! Clear texels with an alpha below the cutoff.
//!
//! Coarse mip maps mix leaves with all the nothing around them, so that crowns fade. A lower cutoff shows more
//! from afar, but widens leaves close by, too. Clear texels that lie away from leaves may have any alpha
//! below the cutoff: close by they are mixed with each other alone and stay cut away, and from afar the
//! mean is higher.

use std::collections::HashMap;
use std::sync::Arc;

use secateur_gltf::{CutOutTexture, DrawnSurface, GltfError, Tree};
use secateur_model::{Material, Texture};

/// Texels that are no farther from what is shown than the longer side of the texture over this keep their alpha,
/// so that mip maps that show single leaves change little.
const KEPT_PART: u32 = 64;

/// A base colour texture with raised alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Raised {
    /// The number of the material that shows it.
    pub material: usize,
    /// Its texels; colours and sampler are as they were.
    pub texture: Arc<Texture>,
}

/// The textures of a tree whose clear texels may be raised.
pub(super) struct Raisable(Vec<CutOutTexture>);

impl Raisable {
    /// Those that [`Tree::cut_out_textures`] gives. Of materials with one image the lowest cutoff counts.
    pub(super) fn of(tree: &Tree) -> Result<Self, GltfError> {
        let mut textures = tree.cut_out_textures()?;
        let mut least: HashMap<usize, f32> = HashMap::new();
        for one in &textures {
            let cutoff = least.entry(one.image).or_insert(one.cutoff);
            *cutoff = cutoff.min(one.cutoff);
        }
        for one in &mut textures {
            one.cutoff = least[&one.image];
        }
        Ok(Self(textures))
    }

    /// Each with clear texels of this alpha over its cutoff; those that have none away from leaves are left out.
    pub(super) fn by(&self, share: f32) -> Vec<Raised> {
        let mut made: HashMap<_, Option<Arc<Texture>>> = HashMap::new();
        let textures = self.0.iter().filter_map(|one| {
            let made = made.entry(Arc::as_ptr(&one.texture));
            let made =
                made.or_insert_with(|| raised(&one.texture, one.cutoff, share).map(Arc::new));
            Some(Raised {
                material: one.material,
                texture: made.clone()?,
            })
        });
        textures.collect()
    }
}

/// The level with these textures in place of its own.
pub(super) fn with_textures(level: &[DrawnSurface], raised: &[Raised]) -> Vec<DrawnSurface> {
    let mut level = level.to_vec();
    for drawn in &mut level {
        let own = raised
            .iter()
            .find(|one| drawn.material == Some(one.material));
        if let Some(own) = own {
            let mut material = Material::clone(&drawn.surface.material);
            material.texture = Some(own.texture.clone());
            drawn.surface.material = Arc::new(material);
        }
    }
    level
}

/// A texture whose clear texels away from what is shown have this alpha over the cutoff; none if there are none.
fn raised(texture: &Texture, cutoff: f32, share: f32) -> Option<Texture> {
    let alpha = (share * cutoff * 255.0) as u8;
    let is_kept = near_what_is_shown(texture, cutoff);
    let mut texture = texture.clone();
    let mut count = 0;
    for (texel, is_kept) in texture.rgba.chunks_exact_mut(4).zip(&is_kept) {
        if !is_kept && texel[3] < alpha {
            texel[3] = alpha;
            count += 1;
        }
    }
    (count > 0).then_some(texture)
}

/// By texel, row by row, whether it lies in a square about one that is shown. Textures go on beyond their edges.
fn near_what_is_shown(texture: &Texture, cutoff: f32) -> Vec<bool> {
    let (width, height) = (texture.width as usize, texture.height as usize);
    let reach = (texture.width.max(texture.height) / KEPT_PART).max(1) as usize;
    let texels = texture.rgba.chunks_exact(4);
    let shown: Vec<bool> = texels.map(|t| f32::from(t[3]) / 255.0 >= cutoff).collect();
    let along_rows = widened(&shown, [width, height], [1, width], reach);
    widened(&along_rows, [height, width], [width, 1], reach)
}

/// Marks what is within `reach` of a mark along lines. There are `lines` lines of `length`, whose items are
/// `step` apart, and whose first ones are `next` apart.
fn widened(
    marks: &[bool],
    [length, lines]: [usize; 2],
    [step, next]: [usize; 2],
    reach: usize,
) -> Vec<bool> {
    let mut wide = vec![false; marks.len()];
    for line in 0..lines {
        // How far back the last mark is; once around first, for marks before the start.
        let mut since = [usize::MAX; 2];
        for turn in 0..2 * length {
            let places = [turn % length, length - 1 - turn % length];
            for (since, place) in since.iter_mut().zip(places) {
                let at = line * next + place * step;
                *since = match marks[at] {
                    true => 0,
                    false => since.saturating_add(1),
                };
                wide[at] |= *since <= reach;
            }
        }
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::{Filters, Wrap};

    /// A texture of 128 x 64 texels that shows one of them.
    fn dot(column: usize, row: usize) -> Texture {
        let mut rgba = vec![0; 4 * 128 * 64];
        rgba[4 * (row * 128 + column) + 3] = 255;
        Texture {
            width: 128,
            height: 64,
            rgba,
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        }
    }

    /// Those of 5 x 5 texels about what is shown, beyond the edges too.
    #[test]
    fn texels_near_what_is_shown_keep_their_alpha() {
        for (column, row) in [(60, 30), (0, 0), (127, 63), (1, 62)] {
            let texture = raised(&dot(column, row), 0.5, 0.6).unwrap();
            for (k, texel) in texture.rgba.chunks(4).enumerate() {
                let away = |at: usize, from: usize, size: usize| {
                    let straight = at.abs_diff(from);
                    straight.min(size - straight)
                };
                let from_dot = away(k % 128, column, 128).max(away(k / 128, row, 64));
                let expected = match from_dot {
                    0 => 255,
                    1..=2 => 0,
                    _ => 76,
                };
                assert_eq!(texel[3], expected, "{k} of {column} {row}");
            }
        }
    }

    #[test]
    fn what_has_no_clear_texels_away_from_leaves_stays() {
        let mut full = dot(0, 0);
        full.rgba.fill(255);
        assert_eq!(raised(&full, 0.5, 0.6), None);
        // Alpha that is higher already stays.
        let mut soft = dot(0, 0);
        soft.rgba
            .chunks_mut(4)
            .for_each(|texel| texel[3] = texel[3].max(100));
        assert_eq!(raised(&soft, 0.5, 0.6), None);
    }
}
