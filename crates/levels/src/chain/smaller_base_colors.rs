//! Base colours that no test cuts out, as small as the distance of a level lets them be.

use std::sync::Arc;

use secateur_gltf::Document;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{AlphaMode, Material, Surface, Texture};

use super::leaf_texture::Seen;
use super::level_surfaces::LevelSurfaces;
use super::smaller_images::{Means, reduced, size_seen};

/// Texels along a pixel where a level begins: parts of a plant have more or fewer than the mean.
const TEXELS_A_PIXEL: f64 = 2.0;

/// Smaller base colour textures for the materials of a level that are opaque or blend, where a unit of length is `pixels` pixels: for those
/// whose textures have far more texels than are seen.
pub(super) fn smaller_base_colors(
    level: &LevelSurfaces,
    document: &Document,
    pixels: f64,
) -> Vec<LevelTexture> {
    let texture = |(material, surfaces): (usize, Vec<&Surface>)| {
        let look = &surfaces.first()?.material;
        let shows_base_color = shows_base_color(document, material, look);
        let original = look.texture.as_ref().filter(|_| shows_base_color)?;
        Some(LevelTexture {
            image: None,
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

/// Whether a material that is opaque or blends shows its base colour texture, and that image nowhere else: not an emission, for one.
pub(super) fn shows_base_color(document: &Document, material: usize, look: &Material) -> bool {
    let images = document.images_of_material(material);
    let base_colors = images.iter().filter(|image| image.is_base_color);
    let is_plain = !look.finish.is_unlit || images.len() == 1;
    let is_cut_out = matches!(look.alpha_mode, AlphaMode::Mask(_));
    !is_cut_out && base_colors.count() == 1 && is_plain
}

fn smaller(original: &Texture, surfaces: &[&Surface], pixels: f64) -> Option<Texture> {
    let sides = [original.width, original.height];
    let size = size_seen(&Seen::of(surfaces)?, sides, TEXELS_A_PIXEL * pixels)?;
    let means = match surfaces.first()?.material.alpha_mode {
        AlphaMode::Blend => Means::SeenColors,
        AlphaMode::Opaque | AlphaMode::Mask(_) => Means::Colors,
    };
    Some(reduced(original, size, means))
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
    fn only_base_colours_that_no_test_cuts_out_get_smaller() {
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
        assert!(!shows(0, false, AlphaMode::Mask(0.5)) && shows(0, false, AlphaMode::Blend));
        assert!(!shows(1, true, AlphaMode::Opaque));
        // Emissions are drawn without light.
        assert!(!shows(2, true, AlphaMode::Opaque) && shows(2, false, AlphaMode::Opaque));
    }
}
