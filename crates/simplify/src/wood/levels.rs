//! Ever coarser levels of one piece of wood.

use glam::DVec3;
use secateur_model::{Foliage, LeafId};

use crate::coarsen::leaf_mesh::halvings;

/// A texture that would be off by its whole width counts as much as a surface that is off by this
/// share of the piece's length: little, since bark repeats along a branch. Other values were not
/// tried.
const UV_WEIGHT: f32 = 0.01;

/// A piece with fewer triangles.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// Corners of the piece, numbered as in [`secateur_model::CornerRef`].
    pub(super) triangles: Vec<[u32; 3]>,
    /// The share of the piece's pixels that it shows no longer, or elsewhere: 0 to 1.
    pub(super) loss: f64,
}

/// The levels of a piece, finest first; of any two the coarser loses more.
pub(super) fn levels(wood: &Foliage, piece: LeafId) -> Vec<Level> {
    let triangles = wood.triangles_of(piece);
    let thickness = thickness(wood, piece);
    let mut levels: Vec<Level> = Vec::new();
    for level in halvings(triangles, UV_WEIGHT) {
        let loss = match thickness > 0.0 {
            true => (level.error / thickness).min(1.0),
            false => 1.0,
        };
        // What loses all of a piece is no better than nothing.
        let least = levels.last().map_or(0.0, |finer| finer.loss);
        if loss < 1.0 {
            levels.push(Level {
                triangles: level.triangles,
                loss: loss.max(least),
            });
        }
    }
    levels
}

/// The diameter of a tube as long as the piece and of its area, in world units.
fn thickness(wood: &Foliage, piece: LeafId) -> f64 {
    let corners = || wood.triangles_of(piece).iter().flat_map(|t| t.corners);
    let (low, high) = corners().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), corner| (low.min(corner), high.max(corner)),
    );
    let length = (high - low).length();
    match length > 0.0 {
        true => wood.leaf(piece).area() / (std::f64::consts::PI * length),
        false => 0.0,
    }
}
