//! The colours of texels that are cut away.
//!
//! Nobody sees them, but mip maps mix them in: over black ones leaves get darker the farther off they
//! are, over white ones they get a pale rim. Such texels get the colours of the leaves near them.

use std::collections::HashMap;
use std::sync::Arc;

use secateur_gltf::{GltfError, Tree};
use secateur_model::Texture;

/// Mip maps are looked at where they are this many times smaller.
const BLOCK: u32 = 8;

/// Colours that differ by no more than this in the mean, of 255, stay as they are.
const HARDLY: f64 = 4.0;

/// A base colour texture in which colours were spread: into clear texels, or beside charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Dilated {
    /// The number of the material that shows it.
    pub material: usize,
    /// Its texels; alpha and sampler are as they were.
    pub texture: Arc<Texture>,
    /// By how much what is seen differs by it, of 255: mip maps of an eighth of the size in the mean over what they show,
    /// or what a level shows beside charts.
    pub difference: f64,
}

/// The base colour textures of a tree's cut-out leaves that mip maps mix other colours into, with the colours of
/// leaves in their clear texels instead. A texel is clear if no material with that image shows it by the tree's
/// cutoff; a level with a lower cutoff may show it. Textures whose mip maps hardly differ by it are left out, and so are
/// those that [`Tree::cut_out_textures`] leaves out.
///
/// # Errors
/// [`GltfError`] if an image can't be read, or they are too large.
pub fn dilated_textures(tree: &Tree) -> Result<Vec<Dilated>, GltfError> {
    let textures = tree.cut_out_textures()?;
    let mut cutoffs: HashMap<usize, f32> = HashMap::new();
    for one in &textures {
        let least = cutoffs.entry(one.image).or_insert(one.cutoff);
        *least = least.min(one.cutoff);
    }
    let mut known: HashMap<_, Option<Dilated>> = HashMap::new();
    let mut all = Vec::new();
    for one in textures {
        let cutoff = cutoffs[&one.image];
        let made = known.entry(Arc::as_ptr(&one.texture)).or_insert_with(|| {
            let texture = dilated(&one.texture, cutoff);
            let difference = difference(&one.texture, &texture, cutoff);
            (difference > HARDLY).then(|| Dilated {
                material: one.material,
                texture: Arc::new(texture),
                difference,
            })
        });
        all.extend(made.clone().map(|made| Dilated {
            material: one.material,
            ..made
        }));
    }
    Ok(all)
}

/// The texture with the mean colours of what is shown nearby where nothing is (pull and push; Gortler et
/// al., The Lumigraph, 1996).
fn dilated(texture: &Texture, cutoff: f32) -> Texture {
    let shown = |texel: &[u8]| match f32::from(texel[3]) / 255.0 >= cutoff {
        true => [texel[0], texel[1], texel[2], 255],
        false => [0; 4],
    };
    let size = [texture.width as usize, texture.height as usize];
    let mut colors: Vec<[u8; 4]> = texture.rgba.chunks_exact(4).map(shown).collect();
    fill(&mut colors, size);
    let filled = texture.rgba.chunks_exact(4).zip(&colors);
    let rgba = filled.flat_map(|(before, [r, g, b, _])| [*r, *g, *b, before[3]]);
    Texture {
        rgba: rgba.collect(),
        ..texture.clone()
    }
}

/// Fills texels whose fourth byte is 0 from an image of half the size; nothing where all are so.
pub(crate) fn fill(colors: &mut [[u8; 4]], [width, height]: [usize; 2]) {
    if colors.iter().all(|color| color[3] > 0) || (width <= 1 && height <= 1) {
        return;
    }
    let half = [width.div_ceil(2), height.div_ceil(2)];
    let mean = |at: usize| {
        let (column, row) = (at % half[0] * 2, at / half[0] * 2);
        let mut sum = [0u32; 3];
        let mut count = 0;
        for y in row..(row + 2).min(height) {
            for color in &colors[y * width..][column..(column + 2).min(width)] {
                if color[3] > 0 {
                    count += 1;
                    for (sum, channel) in sum.iter_mut().zip(color) {
                        *sum += u32::from(*channel);
                    }
                }
            }
        }
        match count {
            0 => [0; 4],
            _ => {
                let [r, g, b] = sum.map(|sum| ((sum + count / 2) / count) as u8);
                [r, g, b, 255]
            }
        }
    };
    let mut above: Vec<[u8; 4]> = (0..half[0] * half[1]).map(mean).collect();
    fill(&mut above, half);
    for (at, color) in colors.iter_mut().enumerate().filter(|(_, c)| c[3] == 0) {
        *color = above[at / width / 2 * half[0] + at % width / 2];
    }
}

/// By how much blocks of texels differ in their mean colour, of 255, in the mean over those that show something.
fn difference(before: &Texture, after: &Texture, cutoff: f32) -> f64 {
    let (width, height) = (before.width, before.height);
    let (mut sum, mut count) = (0.0, 0u32);
    for top in (0..height).step_by(BLOCK as usize) {
        for left in (0..width).step_by(BLOCK as usize) {
            let (mut moved, mut texels, mut is_shown) = ([0i64; 3], 0i64, false);
            for y in top..(top + BLOCK).min(height) {
                for x in left..(left + BLOCK).min(width) {
                    let at = 4 * (y as usize * width as usize + x as usize);
                    let [a, b] = [before, after].map(|texture| &texture.rgba[at..at + 4]);
                    for (k, moved) in moved.iter_mut().enumerate() {
                        *moved += i64::from(b[k]) - i64::from(a[k]);
                    }
                    texels += 1;
                    is_shown |= f32::from(a[3]) / 255.0 >= cutoff;
                }
            }
            if is_shown {
                let channels = moved.map(|moved| moved.abs() as f64);
                sum += channels.iter().sum::<f64>() / (3 * texels) as f64;
                count += 1;
            }
        }
    }
    sum / f64::from(count.max(1))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::{DVec3, Vec2};
    use secateur_gltf::{Document, plant_to_glb};
    use secateur_model::{AlphaMode, Filters, Finish, Material, Plant, Surface, Wrap};
    use serde_json::{Value, json};

    /// Left of the middle leaves of one colour, with this one in what is cut away.
    fn half(clear: [u8; 3], [width, height]: [u32; 2]) -> Texture {
        let texel = |at: u32| match at % width < width / 2 {
            true => [90, 120, 50, 255],
            false => [clear[0], clear[1], clear[2], 0],
        };
        Texture {
            width,
            height,
            rgba: (0..width * height).flat_map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        }
    }

    #[test]
    fn what_is_cut_away_gets_the_colour_of_leaves_and_stays_clear() {
        for size in [[16, 16], [13, 7], [2, 1], [40, 3]] {
            let before = half([0; 3], size);
            let after = dilated(&before, 0.5);
            let pairs = before.rgba.chunks(4).zip(after.rgba.chunks(4));
            for (at, (before, after)) in pairs.enumerate() {
                assert_eq!(after, [90, 120, 50, before[3]], "texel {at} of {size:?}");
            }
            assert_eq!((after.width, after.height), (size[0], size[1]));
        }
    }

    #[test]
    fn colours_come_from_the_nearest_leaves() {
        let mut texture = half([0; 3], [32, 4]);
        for (at, texel) in texture.rgba.chunks_mut(4).enumerate() {
            texel.copy_from_slice(match at % 32 {
                0..4 => &[200, 0, 0, 255],
                28.. => &[0, 200, 0, 255],
                _ => &[0, 0, 0, 20],
            });
        }
        let after = dilated(&texture, 0.5);
        let color = |column: usize| <[u8; 4]>::try_from(&after.rgba[4 * column..][..4]).unwrap();
        assert_eq!(color(6), [200, 0, 0, 20]);
        assert_eq!(color(25), [0, 200, 0, 20]);
    }

    #[test]
    fn only_colours_that_mip_maps_mix_in_count() {
        // Of the two blocks that show leaves one is half black.
        let dark = half([0; 3], [24, 8]);
        let by = |texture: &Texture| difference(texture, &dilated(texture, 0.5), 0.5);
        assert!(
            (by(&dark) - 260.0 / 3.0 / 2.0 / 2.0).abs() < 1e-9,
            "{}",
            by(&dark)
        );
        assert!(by(&half([88, 119, 52], [24, 8])) < HARDLY);
        // As bright, of another hue.
        assert!(by(&half([50, 90, 120], [24, 8])) > HARDLY);
        // Nothing is shown: nothing is known.
        let nothing = Texture {
            rgba: vec![0; 4 * 16],
            ..half([0; 3], [4, 4])
        };
        assert_eq!(dilated(&nothing, 0.5), nothing);
        assert_eq!(by(&nothing), 0.0);
    }

    /// Cards with this texture and a cutoff of .5, drawn again by a material with this cutoff.
    pub(crate) fn tree(texture: Texture, other_cutoff: f64) -> Tree {
        let material = |alpha_mode, texture| {
            Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture,
                alpha_mode,
                double_sided: true,
                finish: Finish::default(),
            })
        };
        let surface = |material, positions: Vec<DVec3>, triangles| Surface {
            uvs: positions
                .iter()
                .map(|at| Vec2::new(at.x as f32, at.y as f32))
                .collect(),
            positions,
            normals: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles,
            material,
        };
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let card = |k: u32| corners.map(|[x, y]| DVec3::new(x, y, f64::from(k)));
        let quad = |k: u32| [[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|c| 4 * k + c));
        let leaves = surface(
            material(AlphaMode::Mask(0.5), Some(Arc::new(texture))),
            (0..4).flat_map(card).collect(),
            (0..4).flat_map(quad).collect(),
        );
        let wood = [[0.0, -9.0], [1.0, -9.0], [0.0, -1.0]];
        let wood = wood.map(|[x, y]| DVec3::new(x, y, 0.0)).into();
        let glb = plant_to_glb(&Plant {
            name: "cards".to_owned(),
            wood: surface(material(AlphaMode::Opaque, None), wood, vec![[0, 1, 2]]),
            leaves,
            triangles_per_leaf: vec![2; 4],
            skeleton: None,
            holds: None,
        });
        let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        let end = 20 + number(12);
        let mut root: Value = serde_json::from_slice(&glb[20..end]).unwrap();
        let mut other = root["materials"][1].clone();
        other["alphaCutoff"] = json!(other_cutoff);
        root["materials"].as_array_mut().unwrap().push(other);
        let meshes = root["meshes"].as_array_mut().unwrap();
        let all = meshes
            .iter_mut()
            .map(|mesh| mesh["primitives"].as_array_mut());
        for primitives in all.flatten() {
            let leaves = primitives.iter().find(|one| one["material"] == 1).cloned();
            primitives.extend(leaves.map(|mut again| {
                again["material"] = json!(2);
                again
            }));
        }
        let mut text = root.to_string();
        text.extend(std::iter::repeat_n(
            ' ',
            text.len().next_multiple_of(4) - text.len(),
        ));
        let length = (20 + text.len() + glb.len() - end) as u32;
        let mut changed = [&glb[..8], &length.to_le_bytes()].concat();
        changed.extend((text.len() as u32).to_le_bytes());
        changed.extend([b"JSON", text.as_bytes(), &glb[end..]].concat());
        let document = Document::from_bytes("cards.glb", changed, None).unwrap();
        let leaves = ["material:#1", "material:#2"].map(|one| one.parse().unwrap());
        document.into_tree(&leaves).unwrap()
    }

    /// What one material cuts away another may show of the same image.
    #[test]
    fn the_lowest_cutoff_of_an_image_says_what_is_clear() {
        let mut texture = half([0; 3], [24, 8]);
        // A red column that a cutoff of .2 shows.
        for texel in texture.rgba.chunks_mut(4).skip(12).step_by(24) {
            texel.copy_from_slice(&[200, 0, 0, 100]);
        }
        for (other, column) in [(0.5, [90, 120, 50, 100]), (0.2, [200, 0, 0, 100])] {
            let found = dilated_textures(&tree(texture.clone(), other)).unwrap();
            let materials: Vec<usize> = found.iter().map(|one| one.material).collect();
            assert_eq!(materials, [1, 2]);
            for one in &found {
                assert_eq!(one.texture.rgba[4 * 12..][..4], column, "cutoff {other}");
            }
        }
    }
}
