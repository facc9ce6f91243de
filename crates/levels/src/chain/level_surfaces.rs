//! What is drawn of a level, and which textures it shows.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use secateur_gltf::DrawnSurface;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{Surface, Texture};

/// The surfaces of a level, and which material each has.
#[derive(Clone)]
pub(super) struct LevelSurfaces {
    pub(super) surfaces: Vec<Surface>,
    pub(super) materials: Vec<Option<usize>>,
}

impl LevelSurfaces {
    /// What is drawn of a file.
    pub(super) fn of(drawn: Vec<DrawnSurface>) -> Self {
        Self {
            materials: drawn.iter().map(|drawn| drawn.material).collect(),
            surfaces: drawn.into_iter().map(|drawn| drawn.surface).collect(),
        }
    }

    /// Primitives that are drawn of it as it is written: one mesh, in which what has one material is one primitive.
    pub(super) fn draws(&self) -> usize {
        self.materials.iter().collect::<BTreeSet<_>>().len()
    }

    /// The surfaces, each with the number of its material.
    pub(super) fn with_materials(&self) -> impl Iterator<Item = (&Surface, Option<usize>)> {
        self.surfaces.iter().zip(self.materials.iter().copied())
    }

    /// The surfaces of each material, by its number; those without one are left out.
    pub(super) fn by_material(&self) -> BTreeMap<usize, Vec<&Surface>> {
        by_material(self.with_materials())
    }
}

/// Surfaces by the number of their material; those without one are left out.
pub(super) fn by_material<'s>(
    drawn: impl IntoIterator<Item = (&'s Surface, Option<usize>)>,
) -> BTreeMap<usize, Vec<&'s Surface>> {
    let mut all: BTreeMap<usize, Vec<&Surface>> = BTreeMap::new();
    for (surface, material) in drawn {
        if let Some(material) = material {
            all.entry(material).or_default().push(surface);
        }
    }
    all
}

/// The surfaces of a level with textures of its own.
pub(super) fn retextured(level: &LevelSurfaces, textures: &[LevelTexture]) -> Vec<Surface> {
    let of = |(surface, material): (&Surface, &Option<usize>)| {
        let mut surface = surface.clone();
        show(&mut surface, *material, textures);
        surface
    };
    level
        .surfaces
        .iter()
        .zip(&level.materials)
        .map(of)
        .collect()
}

/// Lets a surface of this material show the texture of a level that is for it, if there is one.
pub fn show(surface: &mut Surface, material: Option<usize>, textures: &[LevelTexture]) {
    let is_its = |own: &&LevelTexture| Some(own.material) == material && own.image.is_none();
    let own = textures.iter().find(is_its);
    if let Some(own) = own {
        let shown = &mut Arc::make_mut(&mut surface.material).texture;
        let mut texture = Arc::clone(&own.texture);
        if let Some(before) = shown.as_ref().filter(|_| own.keeps_sampler)
            && (before.wrap, before.filters) != (texture.wrap, texture.filters)
        {
            texture = Arc::new(Texture {
                wrap: before.wrap,
                filters: before.filters,
                ..Texture::clone(&texture)
            });
        }
        *shown = Some(texture);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_one_material_are_drawn_at_once() {
        let draws = |materials: &[Option<usize>]| {
            let level = LevelSurfaces {
                surfaces: Vec::new(),
                materials: materials.to_vec(),
            };
            level.draws()
        };
        assert_eq!(draws(&[Some(3); 13]), 1, "the blades of a tuft of grass");
        assert_eq!(draws(&[Some(3), None, Some(3), Some(5), None]), 3);
    }
}
