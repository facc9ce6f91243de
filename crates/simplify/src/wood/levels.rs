//! Ever coarser levels of one piece of wood.

use glam::DVec3;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId};

use super::thickness::thickness;
use crate::coarsen::leaf_mesh::{Kept, halvings};

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

/// A normal that would be off by its whole length counts as much as a surface that is off by this
/// share of the piece's thickness. Of 0, .02, .05, .1 and .3, tried at a quarter and a tenth of all
/// triangles, those to .05 look alike on an oak, a birch, a maple and `quat_commontree_1`; on the last
/// .1 has a FLIP of .0196 instead of .0188 at a tenth.
const NORMAL_WEIGHT: f64 = 0.05;

/// The levels of a piece by its geometry, finest first; of any two the coarser loses more. Where
/// `is_joint` says so, vertices stay.
pub(super) fn levels(
    wood: &Foliage,
    piece: LeafId,
    is_joint: &dyn Fn(DVec3) -> bool,
) -> Vec<Level> {
    let triangles = wood.triangles_of(piece);
    let thickness = thickness(wood, piece);
    let first = triangles[0].corners[0];
    let corners = triangles.iter().flat_map(|t| t.corners);
    let size = corners.map(|c| (c - first).length()).fold(0.0, f64::max);
    let normal_weight = match size > 0.0 {
        true => NORMAL_WEIGHT * thickness / size,
        false => 0.0,
    };
    let kept = Kept {
        uv_weight: UV_WEIGHT,
        normal_weight: normal_weight as f32,
        is_locked: is_joint,
    };
    let loss = |error: f64| match thickness > 0.0 {
        true => error / thickness,
        false => 1.0,
    };
    let levels = halvings(triangles, kept).into_iter();
    falling(levels.map(|level| (loss(level.error), level.triangles)))
}

/// Levels of rising losses, at least those that are given; what loses all of a piece is no better
/// than nothing and left out.
pub(super) fn falling(levels: impl Iterator<Item = (f64, Vec<[u32; 3]>)>) -> Vec<Level> {
    let mut falling: Vec<Level> = Vec::new();
    for (loss, triangles) in levels {
        let least = falling.last().map_or(0.0, |finer| finer.loss);
        if loss < 1.0 {
            falling.push(Level {
                triangles,
                loss: loss.max(least),
            });
        }
    }
    falling
}

/// Tells the places that two pieces have.
pub(super) fn joints(wood: &Foliage) -> impl Fn(DVec3) -> bool + Sync {
    let key = |place: DVec3| place.to_array().map(|v| (v + 0.0).to_bits());
    let mut piece_at: FxHashMap<[u64; 3], Option<usize>> = FxHashMap::default();
    for index in 0..wood.leaves().len() {
        for triangle in wood.triangles_of(LeafId::from_index(index)) {
            for corner in triangle.corners {
                let known = piece_at.entry(key(corner)).or_insert(Some(index));
                if *known != Some(index) {
                    *known = None;
                }
            }
        }
    }
    move |place| piece_at.get(&key(place)) == Some(&None)
}
