//! Clear texels with an alpha below the cutoff.
//!
//! Coarse mip maps mix leaves with all the nothing around them, so that crowns fade. A lower cutoff shows more
//! from afar, but widens leaves close by, too. Clear texels that lie away from leaves may have any alpha
//! below the cutoff: close by they are mixed with clear ones alone and stay cut away, and from afar the
//! mean is higher. That holds for a hard alpha test, as glTF's masks ask for.

use std::collections::HashMap;
use std::sync::Arc;

use secateur_gltf::{GltfError, Tree};
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
pub(super) struct Raisable(Vec<OfMaterial>);

struct OfMaterial {
    material: usize,
    texture: Arc<Texture>,
    /// The lowest that a material has with the image.
    cutoff: f32,
    /// By texel, row by row, whether it keeps its alpha.
    is_kept: Arc<[bool]>,
}

impl Raisable {
    /// Textures that [`Tree::cut_out_textures`] gives. Of materials with one image the lowest cutoff counts.
    pub(super) fn of(tree: &Tree) -> Result<Self, GltfError> {
        let textures = tree.cut_out_textures()?;
        let mut least: HashMap<usize, f32> = HashMap::new();
        for one in &textures {
            let cutoff = least.entry(one.image).or_insert(one.cutoff);
            *cutoff = cutoff.min(one.cutoff);
        }
        let mut known: HashMap<_, Arc<[bool]>> = HashMap::new();
        let of_materials = textures.into_iter().map(|one| {
            let cutoff = least[&one.image];
            let is_kept = known.entry((Arc::as_ptr(&one.texture), cutoff.to_bits()));
            let is_kept =
                is_kept.or_insert_with(|| near_what_is_shown(&one.texture, cutoff).into());
            OfMaterial {
                material: one.material,
                is_kept: is_kept.clone(),
                texture: one.texture,
                cutoff,
            }
        });
        Ok(Self(of_materials.collect()))
    }

    /// Each with clear texels of this alpha over its cutoff. None if no texture has clear texels away from
    /// leaves, or the mean of one were no longer below its cutoff: the coarsest mip maps would show cards whole.
    pub(super) fn by(&self, share: f64) -> Option<Vec<Raised>> {
        let mut made: HashMap<_, Option<Arc<Texture>>> = HashMap::new();
        let mut all = Vec::new();
        for one in &self.0 {
            // One picture may be the image of several numbers, with a cutoff each.
            let texture = made.entry((Arc::as_ptr(&one.texture), one.cutoff.to_bits()));
            let texture = texture.or_insert_with(|| one.raised(share).map(Arc::new));
            let Some(texture) = texture else {
                continue;
            };
            if mean_alpha(texture) >= one.cutoff {
                return None;
            }
            all.push(Raised {
                material: one.material,
                texture: texture.clone(),
            });
        }
        (!all.is_empty()).then_some(all)
    }
}

impl OfMaterial {
    /// The texture whose clear texels away from what is shown have this alpha over the cutoff; none if there
    /// are none.
    fn raised(&self, share: f64) -> Option<Texture> {
        let alpha = (share * f64::from(self.cutoff) * 255.0) as u8;
        let mut texture = Texture::clone(&self.texture);
        let mut count = 0;
        for (texel, is_kept) in texture.rgba.chunks_exact_mut(4).zip(&*self.is_kept) {
            if !is_kept && texel[3] < alpha {
                texel[3] = alpha;
                count += 1;
            }
        }
        (count > 0).then_some(texture)
    }
}

/// The mean alpha of all texels, 0 to 1.
fn mean_alpha(texture: &Texture) -> f32 {
    let texels = texture.rgba.chunks_exact(4);
    let count = texels.len().max(1) as f64;
    let sum: u64 = texels.map(|texel| u64::from(texel[3])).sum();
    (sum as f64 / count / 255.0) as f32
}

/// The texels of a level's texture with raised alpha, read as the level reads it.
pub(super) fn with_raised(material: &Material, raised: &Raised) -> Option<Material> {
    let texture = material.texture.as_ref()?;
    let texture = Texture {
        rgba: raised.texture.rgba.clone(),
        width: raised.texture.width,
        height: raised.texture.height,
        ..Texture::clone(texture)
    };
    Some(Material {
        texture: Some(Arc::new(texture)),
        ..material.clone()
    })
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

    fn of_material(texture: Texture, cutoff: f32) -> OfMaterial {
        OfMaterial {
            material: 1,
            is_kept: near_what_is_shown(&texture, cutoff).into(),
            texture: Arc::new(texture),
            cutoff,
        }
    }

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

    fn of_dot(column: usize, row: usize, cutoff: f32) -> OfMaterial {
        of_material(dot(column, row), cutoff)
    }

    /// Texels within 5 x 5 about what is shown keep it, beyond the edges too.
    #[test]
    fn texels_near_what_is_shown_keep_their_alpha() {
        for (column, row) in [(60, 30), (0, 0), (127, 63), (1, 62)] {
            let texture = of_dot(column, row, 0.5).raised(0.6).unwrap();
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
        assert_eq!(of_material(full, 0.5).raised(0.6), None);
        // Alpha that is higher already stays.
        let mut soft = dot(0, 0);
        for texel in soft.rgba.chunks_mut(4) {
            texel[3] = texel[3].max(100);
        }
        assert_eq!(of_material(soft, 0.5).raised(0.6), None);
    }

    #[test]
    fn coarsest_mip_maps_do_not_become_whole_cards() {
        // Half of it is shown; the rest but for a margin may have a third of the cutoff, not half of it.
        let mut half = dot(0, 0);
        for (k, texel) in half.rgba.chunks_mut(4).enumerate() {
            texel[3] = 255 * u8::from(k % 128 < 64);
        }
        let raisable = Raisable(vec![of_material(half, 0.6)]);
        assert_eq!(raisable.by(0.3).map(|all| all.len()), Some(1));
        assert_eq!(raisable.by(0.5), None);
        assert_eq!(Raisable(Vec::new()).by(0.5), None);
    }

    /// Two materials show the image, one from an alpha of .3 on: nothing may have more than that.
    #[test]
    fn the_lowest_cutoff_of_an_image_counts() {
        let tree = crate::clear_texels::tests::tree(dot(3, 3), 0.3);
        let raised = Raisable::of(&tree).unwrap().by(0.5).unwrap();
        assert_eq!(raised.len(), 2);
        let highest = |one: &Raised| {
            let alphas = one.texture.rgba.chunks(4).map(|texel| texel[3]);
            alphas.filter(|alpha| *alpha < 255).max()
        };
        let most = (0.5 * 0.3 * 255.0) as u8;
        assert!(raised.iter().all(|one| highest(one) == Some(most)));
    }

    #[test]
    fn a_level_reads_raised_texels_as_it_read_its_own() {
        let mut own = dot(0, 0);
        own.wrap = [Wrap::ClampToEdge; 2];
        let material = Material {
            name: String::new(),
            base_color: [1.0; 4],
            alpha_mode: secateur_model::AlphaMode::Mask(0.5),
            texture: Some(Arc::new(own)),
            double_sided: true,
            finish: secateur_model::Finish::default(),
        };
        let raised = Raised {
            material: 1,
            texture: Arc::new(of_dot(0, 0, 0.5).raised(0.6).unwrap()),
        };
        let changed = with_raised(&material, &raised).unwrap().texture.unwrap();
        assert_eq!(changed.wrap, [Wrap::ClampToEdge; 2]);
        assert_eq!(changed.rgba, raised.texture.rgba);
    }
}
