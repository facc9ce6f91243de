//! Images of a level's materials beside the base colour, as small as its distance lets them be: normal maps, roughness.
//!
//! The judge draws base colours alone, so nothing of these is chosen by it: a texel a pixel is what a screen shows.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec3, Vec4};
use secateur_eval::{color_of, srgb_byte};
use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Document, MaterialImage, TexelContent};
use secateur_model::Texture;

use super::leaf_texture::{Seen, covered, side_for};
use super::level_surfaces::LevelSurfaces;

/// Texels along a pixel where a level begins.
const TEXELS_A_PIXEL: f64 = 1.0;

/// Another image has at most this share of the texels: a photograph as JPEG takes fewer bytes than a PNG of half as
/// many texels.
const MOST_TEXELS: f64 = 1.0 / 16.0;

/// How texels become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Means {
    /// Colours in linear light, as if all were opaque.
    Colors,
    /// Colours in linear light, each as much as it is seen, and the mean of alpha.
    SeenColors,
    /// Directions, which stay of unit length.
    Normals,
    /// Numbers of 0 to 255, each channel by itself.
    Numbers,
}

impl From<TexelContent> for Means {
    fn from(content: TexelContent) -> Self {
        match content {
            TexelContent::Colors => Self::Colors,
            TexelContent::Normals => Self::Normals,
            TexelContent::Numbers => Self::Numbers,
        }
    }
}

/// An image of a file by its number, in this width and height, and how it was made.
type Key = (usize, [u32; 2], Means);

/// The images that levels of a document were given so far.
#[derive(Default)]
pub(super) struct SmallerImages(RefCell<BTreeMap<Key, Option<Arc<Texture>>>>);

impl SmallerImages {
    /// Smaller images for the materials of a level, where a unit of length is `pixels` pixels: for those that have far
    /// more texels than are seen, and lie on the surface as the base colour does.
    pub(super) fn of(
        &self,
        level: &LevelSurfaces,
        document: &Document,
        pixels: f64,
    ) -> Vec<LevelTexture> {
        let mut textures = Vec::new();
        for (material, surfaces) in level.by_material() {
            let maps = maps_of(document, material);
            let seen = match maps.is_empty() {
                true => None,
                false => Seen::of(&surfaces),
            };
            let Some(seen) = seen else { continue };
            textures.extend(maps.iter().filter_map(|map| {
                let size = size_seen(&seen, map.size, TEXELS_A_PIXEL * pixels)?;
                Some(LevelTexture {
                    material,
                    image: Some(map.image),
                    texture: self.smaller(document, map, size)?,
                    keeps_sampler: true,
                })
            }));
        }
        textures
    }

    /// An image in this width and height in texels; nothing where it can't be decoded.
    fn smaller(
        &self,
        document: &Document,
        image: &MaterialImage,
        size: [u32; 2],
    ) -> Option<Arc<Texture>> {
        let means = Means::from(image.content);
        let key = (image.image, size, means);
        let mut known = self.0.borrow_mut();
        let made = known.entry(key).or_insert_with(|| {
            let original = document.image_texels(image.image)?;
            Some(Arc::new(reduced(&original, size, means)))
        });
        made.clone()
    }
}

/// The images of a material beside its base colour that lie on it as that does, each once. What it shows in two ways is
/// left out.
fn maps_of(document: &Document, material: usize) -> Vec<MaterialImage> {
    let mut images = document.images_of_material(material);
    images.sort_by_key(|one| one.image);
    let is_map = |alike: &&[MaterialImage]| {
        let is_other = |one: &MaterialImage| one.lies_as_base_color && !one.is_base_color;
        alike
            .iter()
            .all(|one| is_other(one) && one.content == alike[0].content)
    };
    let alike = images.chunk_by(|a, b| a.image == b.image);
    alike.filter(is_map).map(|alike| alike[0]).collect()
}

/// Width and height in texels of an image, at first `sides`, reduced to `texels_a_unit` texels for each unit of length of
/// the surfaces; nothing where that saves little.
pub(super) fn size_seen(seen: &Seen, sides: [u32; 2], texels_a_unit: f64) -> Option<[u32; 2]> {
    let texels = seen.texels_a_pixel(sides, texels_a_unit);
    let size = sides.map(|side| side_for(side, texels));
    let count = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
    (count(size) <= MOST_TEXELS * count(sides)).then_some(size)
}

/// A texture reduced to this width and height in texels: each texel is the mean of what it covers.
pub(super) fn reduced(original: &Texture, [width, height]: [u32; 2], means: Means) -> Texture {
    let number = |index: usize| Vec4::from_array(bytes_at(original, index).map(f32::from));
    let value = |index: usize| match means {
        Means::Colors => color_of(original, index).with_w(1.0),
        Means::SeenColors => {
            let color = color_of(original, index);
            (color.truncate() * color.w).extend(color.w)
        }
        Means::Normals => number(index) / 127.5 - 1.0,
        Means::Numbers => number(index) / 255.0,
    };
    let columns: Vec<_> = (0..width)
        .map(|x| covered(x, width, original.width))
        .collect();
    let mut rgba = Vec::new();
    for y in 0..height {
        let rows = covered(y, height, original.height);
        for columns in &columns {
            let (mut sum, mut all) = (Vec4::ZERO, 0.0);
            for &(row, of_row) in &rows {
                for &(column, of_column) in columns {
                    let index = row as usize * original.width as usize + column as usize;
                    let share = of_row * of_column;
                    sum += value(4 * index) * share;
                    all += share;
                }
            }
            rgba.extend(texel_of(sum / all, means));
        }
    }
    Texture {
        width,
        height,
        rgba,
        wrap: original.wrap,
        filters: original.filters,
    }
}

fn bytes_at(texture: &Texture, index: usize) -> [u8; 4] {
    std::array::from_fn(|k| texture.rgba[index + k])
}

/// The bytes of a mean of texels.
fn texel_of(mean: Vec4, means: Means) -> [u8; 4] {
    let byte = |value: f32| (255.0 * value).round() as u8;
    let rgb = mean.truncate();
    let (rgb, alpha) = match means {
        Means::Colors => (rgb.to_array().map(srgb_byte), u8::MAX),
        Means::SeenColors => {
            let seen = rgb / mean.w.max(f32::MIN_POSITIVE);
            (seen.to_array().map(srgb_byte), byte(mean.w))
        }
        Means::Normals => {
            let direction = rgb.normalize_or(Vec3::Z);
            (((direction + 1.0) / 2.0).to_array().map(byte), u8::MAX)
        }
        Means::Numbers => (rgb.to_array().map(byte), byte(mean.w)),
    };
    [rgb[0], rgb[1], rgb[2], alpha]
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2};
    use secateur_gltf::{Detail, surfaces_to_glb};
    use secateur_model::{AlphaMode, Filters, Finish, Material, NormalMap, Surface, Wrap};

    use super::*;

    fn texture(texels: &[[u8; 4]]) -> Texture {
        Texture {
            width: texels.len() as u32,
            height: 1,
            rgba: texels.as_flattened().to_vec(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        }
    }

    /// Black and white mean half of the light, white where black is hardly seen, the middle of two numbers, or a direction
    /// between two.
    #[test]
    fn texels_are_means_of_what_they_are() {
        let mean = |texels: [[u8; 4]; 2], means| reduced(&texture(&texels), [1, 1], means).rgba;
        let grey = [[0, 0, 0, 0], [255, 255, 255, 255]];
        assert_eq!(mean(grey, Means::Colors), [188, 188, 188, 255]);
        assert_eq!(mean(grey, Means::SeenColors), [255, 255, 255, 128]);
        assert_eq!(mean(grey, Means::Numbers), [128, 128, 128, 128]);
        // Along x and along y: between them, as long as either.
        let ways = [[255, 128, 128, 255], [128, 255, 128, 255]];
        assert_eq!(mean(ways, Means::Normals), [218, 218, 128, 255]);
    }

    /// A square of side 1 with a normal map of 256 x 128 texels: 40 pixels need 64 x 32 of them, and 600 pixels all.
    #[test]
    fn a_normal_map_of_few_pixels_gets_smaller() {
        let of = |texel: [u8; 4]| {
            Arc::new(Texture {
                width: 256,
                height: 128,
                ..texture(&[texel; 256 * 128])
            })
        };
        let mut surface = Surface::empty(Arc::new(Material {
            name: "rock".to_owned(),
            base_color: [1.0; 4],
            texture: Some(of([90, 90, 90, 255])),
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            finish: Finish {
                normal_map: Some(NormalMap {
                    texture: of([128, 128, 255, 255]),
                    scale: 1.0,
                }),
                ..Finish::default()
            },
        }));
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        surface.positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into();
        surface.normals = vec![Vec3::Z; 4];
        surface.uvs = corners.map(|[x, y]| Vec2::new(x as f32, y as f32)).into();
        surface.triangles = vec![[0, 1, 2], [0, 2, 3]];
        let glb = surfaces_to_glb("rock", &[(surface, false)]);
        let document = Document::from_bytes("rock.glb", glb, None).unwrap();
        let level = LevelSurfaces::of(document.drawn_as_one(Detail::Color).unwrap());
        let smaller = SmallerImages::default();
        let made = smaller.of(&level, &document, 40.0);
        let images = document.images_of_material(0);
        let map = images
            .iter()
            .find(|one| one.content == TexelContent::Normals);
        let [own] = &made[..] else {
            panic!("one image for one map: {made:?}")
        };
        assert_eq!(own.image, map.map(|map| map.image));
        assert_eq!([own.texture.width, own.texture.height], [64, 32]);
        assert_eq!(own.texture.rgba[..4], [128, 128, 255, 255]);
        assert!(smaller.of(&level, &document, 600.0).is_empty());
        // Each size is made once.
        let again = &smaller.of(&level, &document, 40.0)[0];
        assert!(Arc::ptr_eq(&again.texture, &own.texture));
    }
}
