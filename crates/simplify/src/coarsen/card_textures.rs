//! The different parts of textures that leaves of a foliage show, and a triangle around each.

use glam::DVec2;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use secateur_model::Foliage;

use super::enclosing_triangle::{CardTexture, Weights, enclosing_triangle};

/// Cells into which all different parts together are divided, at most.
const MAX_CELLS: usize = 1 << 20;

/// Least and largest number of cells along a part's side.
const CELLS_PER_SIDE: [usize; 2] = [32, 256];

/// Number of different parts for which a triangle is sought; leaves of further ones stay as they
/// are. Most trees have a few, which all leaves share.
pub(super) const MAX_CARD_TEXTURES: usize = 1024;

/// What the triangle around a part depends on: its mask, and all texture coordinates.
type Key = (u32, Vec<[u64; 6]>);

/// Parts of the textures of a foliage, each once.
pub(super) struct CardTextures<'a> {
    foliage: &'a Foliage,
    textures: Vec<CardTexture<'a>>,
    number_of: FxHashMap<Key, usize>,
}

impl<'a> CardTextures<'a> {
    pub(super) fn of(foliage: &'a Foliage) -> Self {
        Self {
            foliage,
            textures: Vec::new(),
            number_of: FxHashMap::default(),
        }
    }

    /// The number of the part of a cut-out that triangles of these texture coordinates show; none
    /// if it is new and there are too many.
    pub(super) fn number(&mut self, cutout: u32, triangles: Vec<[DVec2; 3]>) -> Option<usize> {
        let bits = |[a, b, c]: &[DVec2; 3]| [a.x, a.y, b.x, b.y, c.x, c.y].map(f64::to_bits);
        let key = (cutout, triangles.iter().map(bits).collect());
        if self.textures.len() == MAX_CARD_TEXTURES {
            return self.number_of.get(&key).copied();
        }
        Some(*self.number_of.entry(key).or_insert_with(|| {
            self.textures.push(CardTexture {
                triangles,
                mask: &self.foliage.cutouts()[cutout as usize],
            });
            self.textures.len() - 1
        }))
    }

    /// By number the triangle around what a part shows, in weights of the corners of its first
    /// triangle; none where no triangle shows that and hardly more.
    pub(super) fn enclosing_triangles(&self) -> Vec<Option<[Weights; 3]>> {
        let [least, most] = CELLS_PER_SIDE;
        let side = (MAX_CELLS / self.textures.len().max(1))
            .isqrt()
            .clamp(least, most);
        let textures = self.textures.par_iter();
        textures
            .map(|texture| enclosing_triangle(texture, side))
            .collect()
    }
}
