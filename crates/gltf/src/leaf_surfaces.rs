//! What a tree looks like, leaf by leaf: which triangles of which surface a leaf is.

use super::error::Fault;
use super::picture::Pictures;
use super::surfaces::Detail;
use super::{GltfError, Tree};
use glam::DMat3;
use secateur_model::{LeafId, Surface};

/// A surface, and the leaves in it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LeafSurface {
    /// Triangles of one material.
    pub surface: Surface,
    /// Whether it is foliage.
    pub is_foliage: bool,
    /// Its leaves; of wood its pieces, where those are edited too.
    pub leaves: Vec<SurfaceLeaf>,
}

/// A leaf in a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SurfaceLeaf {
    /// Its name in the tree's foliage.
    pub leaf: LeafId,
    /// Its triangles, as places in the surface's, in the order of the foliage's.
    pub triangles: Vec<u32>,
    /// Whether the surface's triangles have their second and third corner the other way round than
    /// the foliage's: a mirrored node draws them.
    pub is_mirrored: bool,
}

impl Tree {
    /// Everything that is drawn, as [`Tree::surfaces_with`], with the leaves of each surface.
    ///
    /// # Errors
    /// [`GltfError`] if there is too much of it.
    pub fn leaf_surfaces(&self, detail: Detail) -> Result<Vec<LeafSurface>, GltfError> {
        let document = &self.document;
        let read = || -> Result<_, Fault> {
            let mut budget = document.budget;
            let survey = document.survey(&self.parts, &mut budget)?;
            let mut pictures = Pictures::new(document, budget);
            let drawn = document.surfaces_of(&self.parts, &survey, &mut pictures, detail)?;
            Ok((survey, drawn))
        };
        let (survey, drawn) = read().map_err(|fault| document.error(fault))?;
        let mut leaves_of_part: Vec<Vec<usize>> = vec![Vec::new(); self.parts.len()];
        for (leaf, source) in self.leaf_sources.iter().enumerate() {
            leaves_of_part[source.part as usize].push(leaf);
        }
        let mut drawn = drawn.into_iter();
        let mut surfaces = Vec::new();
        // As surfaces are made: group by group, wood before foliage, part after part.
        for (index, group) in survey.groups.iter().enumerate() {
            for is_foliage in [false, true] {
                let parts = self.parts.iter().zip(&survey.group_of_part).enumerate();
                let mut first = 0;
                let mut leaves = Vec::new();
                for (number, (part, of)) in parts {
                    if *of != index {
                        continue;
                    }
                    let triangles = part.triangles_that(is_foliage, &group.geometry);
                    let place = |t: &u32| triangles.binary_search(t).ok().map(|k| first + k as u32);
                    let is_mirrored = DMat3::from_mat4(part.world_from_local).determinant() < 0.0;
                    leaves.extend(leaves_of_part[number].iter().filter_map(|&leaf| {
                        let own = self.triangles_of(&self.leaf_sources[leaf]);
                        Some(SurfaceLeaf {
                            leaf: LeafId::from_index(leaf),
                            triangles: own.iter().map(place).collect::<Option<_>>()?,
                            is_mirrored,
                        })
                    }));
                    first += triangles.len() as u32;
                }
                if first == 0 {
                    continue;
                }
                let drawn = drawn
                    .next()
                    .expect("a surface for each group with triangles");
                assert_eq!(drawn.surface.triangles.len(), first as usize);
                surfaces.push(LeafSurface {
                    surface: drawn.surface,
                    is_foliage,
                    leaves,
                });
            }
        }
        Ok(surfaces)
    }
}
