//! The textures that the materials of a level may have.

use std::sync::Arc;

use secateur_gltf::chain::LevelTexture;
use secateur_model::{AlphaMode, Surface};

use super::leaf_texture::{LeafTextures, Make, Seen};
use super::level_surfaces::LevelSurfaces;

/// The textures that a level may have, for each of its materials with a mask.
pub(super) struct FittedTextures(Vec<(usize, LeafTextures)>);

impl FittedTextures {
    /// Where a unit of length is `pixels` pixels.
    pub(super) fn of(level: &LevelSurfaces, pixels: f64) -> Self {
        let textures = |(material, surfaces): (usize, Vec<&Surface>)| {
            let look = &surfaces.first()?.material;
            let AlphaMode::Mask(cutoff) = look.alpha_mode else {
                return None;
            };
            let original = look.texture.as_ref()?;
            let seen = Seen::of(&surfaces)?;
            let texels = seen.texels_a_pixel([original.width, original.height], pixels);
            // The factor's alpha is tested with the texture's.
            let cutoff = cutoff / look.base_color[3];
            LeafTextures::new(original, cutoff, &seen, texels).map(|of| (material, of))
        };
        Self(
            level
                .by_material()
                .into_iter()
                .filter_map(textures)
                .collect(),
        )
    }

    /// Whether no material has a texture to make another of.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// One for each of the materials.
    pub(super) fn textures(&self, make: Make) -> Vec<LevelTexture> {
        let texture = |(material, textures): &(usize, LeafTextures)| LevelTexture {
            image: None,
            material: *material,
            texture: Arc::new(textures.made(make)),
            keeps_sampler: false,
        };
        self.0.iter().map(texture).collect()
    }
}
