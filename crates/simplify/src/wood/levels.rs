//! Ever coarser levels of one piece of wood.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use secateur_model::{Facing, Foliage, LeafId};

use super::distance::{corners_of, largest_distance};
use super::rings::tubes;
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

/// A level that is further off than this share of the piece's thickness shows little where the piece
/// was, but still bears leaves and twigs.
const FAR: f64 = 0.9;

/// The levels of a piece by its geometry, finest first; of any two the coarser loses more. Where
/// `is_joint` says so, collapses leave vertices.
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
    let off = |error: f64| match thickness > 0.0 {
        true => error / thickness,
        false => 1.0,
    };
    let collapsed = halvings(triangles, kept).into_iter();
    let collapsed = collapsed.map(|level| (off(level.error), level.triangles));
    let of_few_sides = tubes_of(wood, piece, is_joint).into_iter().map(|level| {
        let off = off(largest_distance(triangles, &level));
        (far(off), level)
    });
    falling(collapsed.chain(of_few_sides))
}

/// [`tubes`] of a piece that have every joint which it has.
pub(super) fn tubes_of(
    wood: &Foliage,
    piece: LeafId,
    is_joint: &dyn Fn(DVec3) -> bool,
) -> Vec<Vec<[u32; 3]>> {
    let triangles = wood.triangles_of(piece);
    let key = |corner: &DVec3| corner.to_array().map(|x| (x + 0.0).to_bits());
    let corners = triangles.iter().flat_map(|t| t.corners);
    let joints = corners.filter(|corner| is_joint(*corner));
    let joints: FxHashSet<[u64; 3]> = joints.map(|corner| key(&corner)).collect();
    let is_seen_from_both_sides = wood.leaf(piece).facing() == Facing::Both;
    let mut levels = tubes(triangles, is_seen_from_both_sides);
    levels.retain(|level| {
        let corners = corners_of(triangles, level);
        let has: FxHashSet<[u64; 3]> = corners.as_flattened().iter().map(key).collect();
        joints.is_subset(&has)
    });
    levels
}

/// The loss of a level that is off by a share of the thickness: never all, and the more the further.
fn far(off: f64) -> f64 {
    match off <= FAR {
        true => off,
        false => 1.0 - (1.0 - FAR) * FAR / off,
    }
}

/// Levels of ever fewer triangles and ever larger losses; what loses as much as one of no more
/// triangles is left out, and what loses all of a piece, which is no better than nothing.
pub(super) fn falling(levels: impl Iterator<Item = (f64, Vec<[u32; 3]>)>) -> Vec<Level> {
    let mut all: Vec<(f64, Vec<[u32; 3]>)> = levels.filter(|(loss, _)| *loss < 1.0).collect();
    // The coarsest first, of as many triangles the one that loses least.
    all.sort_by(|a, b| a.1.len().cmp(&b.1.len()).then(a.0.total_cmp(&b.0)));
    let mut falling: Vec<Level> = Vec::new();
    for (loss, triangles) in all {
        if falling.last().is_none_or(|coarser| loss < coarser.loss) {
            falling.push(Level { triangles, loss });
        }
    }
    falling.reverse();
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
