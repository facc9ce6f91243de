//! Textures without holes, as small as the distance of a level lets them be.

use std::sync::Arc;

use glam::Vec3;
use secateur_eval::{color_of, srgb_byte};
use secateur_gltf::Document;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{AlphaMode, Material, Surface, Texture};

use super::leaf_texture::{Seen, covered, side_for};
use super::level_surfaces::LevelSurfaces;

/// Texels along a pixel where a level begins: parts of a plant have more or fewer than the mean.
const TEXELS_A_PIXEL: f64 = 2.0;

/// Another texture has at most this share of the texels: a photograph as JPEG takes fewer bytes than a PNG of half as
/// many texels.
const MOST_TEXELS: f64 = 1.0 / 16.0;

/// Smaller base colour textures for the opaque materials of a level, where a unit of length is `pixels` pixels: for those
/// whose textures have far more texels than are seen.
pub(super) fn smaller_opaque_textures(
    level: &LevelSurfaces,
    document: &Document,
    pixels: f64,
) -> Vec<LevelTexture> {
    let texture = |(material, surfaces): (usize, Vec<&Surface>)| {
        let look = &surfaces.first()?.material;
        let shows_base_color = shows_base_color(document, material, look);
        let original = look.texture.as_ref().filter(|_| shows_base_color)?;
        Some(LevelTexture {
            material,
            texture: Arc::new(smaller(original, &surfaces, pixels)?),
            keeps_sampler: true,
        })
    };
    level
        .by_material()
        .into_iter()
        .filter_map(texture)
        .collect()
}

/// Whether an opaque material shows its base colour texture, and that image nowhere else: not an emission, for one.
fn shows_base_color(document: &Document, material: usize, look: &Material) -> bool {
    let images = document.images_of_material(material);
    let base_colors = images.iter().filter(|image| image.is_base_color);
    let is_plain = !look.finish.is_unlit || images.len() == 1;
    look.alpha_mode == AlphaMode::Opaque && base_colors.count() == 1 && is_plain
}

fn smaller(original: &Texture, surfaces: &[&Surface], pixels: f64) -> Option<Texture> {
    let texels = Seen::of(surfaces)?.texels_a_pixel(original, pixels) / TEXELS_A_PIXEL;
    let sides = [original.width, original.height];
    let size = sides.map(|side| side_for(side, texels));
    let count = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
    (count(size) <= MOST_TEXELS * count(sides)).then(|| means(original, size))
}

/// The texture reduced to this width and height in texels: each texel is the mean of what it covers, in linear light.
fn means(original: &Texture, [width, height]: [u32; 2]) -> Texture {
    let columns: Vec<_> = (0..width)
        .map(|x| covered(x, width, original.width))
        .collect();
    let mut rgba = Vec::new();
    for y in 0..height {
        let rows = covered(y, height, original.height);
        for columns in &columns {
            let (mut sum, mut all) = (Vec3::ZERO, 0.0);
            for &(row, of_row) in &rows {
                for &(column, of_column) in columns {
                    let index = row as usize * original.width as usize + column as usize;
                    let share = of_row * of_column;
                    sum += color_of(original, 4 * index).truncate() * share;
                    all += share;
                }
            }
            rgba.extend((sum / all).to_array().map(srgb_byte));
            rgba.push(u8::MAX);
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

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2};
    use secateur_model::{Filters, Wrap};

    use super::*;

    /// A square of side 1 that shows a whole texture, of 256 x 128 texels, the upper half of them red and the rest blue.
    fn square() -> (Texture, Surface) {
        let texel = |k: u32| match k < 256 * 64 {
            true => [200, 0, 0, 255],
            false => [0, 0, 200, 255],
        };
        let texture = Texture {
            width: 256,
            height: 128,
            rgba: (0..256 * 128).flat_map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        };
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut surface = Surface::empty(Arc::new(Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            finish: secateur_model::Finish::default(),
        }));
        surface.positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into();
        surface.uvs = corners.map(|[x, y]| Vec2::new(x as f32, y as f32)).into();
        surface.triangles = vec![[0, 1, 2], [0, 2, 3]];
        (texture, surface)
    }

    /// 20 pixels that show 181 texels along a side need 40 of them, 32 at 16 pixels: as powers of two, of both sides alike.
    #[test]
    fn few_pixels_get_few_texels() {
        let (texture, surface) = square();
        let sizes = [20.0, 16.0, 60.0, 1000.0].map(|pixels| {
            let made = smaller(&texture, &[&surface], pixels)?;
            Some([made.width, made.height])
        });
        assert_eq!(sizes, [Some([64, 32]), Some([64, 32]), None, None]);
        let made = smaller(&texture, &[&surface], 20.0).unwrap();
        assert_eq!(made.wrap, texture.wrap);
        let halves = [0, made.rgba.len() - 4].map(|at| &made.rgba[at..at + 4]);
        assert_eq!(halves, [[200, 0, 0, 255], [0, 0, 200, 255]]);
    }

    /// A PNG of one texel.
    const TEXEL: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGMIcDAAAAGkAMG0YjvAAAAAAElFTkSuQmCC";

    /// The emission of a black scan is drawn as its colour: the base colour must not become that. Cut-out materials are
    /// fitted elsewhere.
    #[test]
    fn only_opaque_base_colours_get_smaller() {
        let gltf = serde_json::json!({
            "asset": { "version": "2.0" },
            "images": [{ "uri": TEXEL }, { "uri": TEXEL }],
            "textures": [{ "source": 0 }, { "source": 1 }],
            "materials": [
                { "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } },
                { "emissiveTexture": { "index": 1 }, "emissiveFactor": [1, 1, 1] },
                {
                    "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
                    "emissiveTexture": { "index": 1 },
                },
            ],
        });
        let document = Document::from_bytes("plant.gltf", gltf.to_string().into_bytes(), None);
        let document = document.unwrap();
        let look = |is_unlit: bool, alpha_mode: AlphaMode| {
            let (_, surface) = square();
            let mut material = Material::clone(&surface.material);
            (material.finish.is_unlit, material.alpha_mode) = (is_unlit, alpha_mode);
            material
        };
        let shows = |material, is_unlit, alpha_mode| {
            shows_base_color(&document, material, &look(is_unlit, alpha_mode))
        };
        assert!(shows(0, false, AlphaMode::Opaque) && shows(0, true, AlphaMode::Opaque));
        assert!(!shows(0, false, AlphaMode::Mask(0.5)));
        assert!(!shows(1, true, AlphaMode::Opaque));
        // Emissions are drawn without light.
        assert!(!shows(2, true, AlphaMode::Opaque) && shows(2, false, AlphaMode::Opaque));
    }
}
