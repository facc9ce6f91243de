//! Ever coarser levels of one piece of wood.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use secateur_model::{Facing, Foliage, LeafId, LeafTriangle};
use secateur_raster::cpu::LeafFragments;

use super::distance::corners_of;
use super::last_forms::last_forms;
use super::loss::{Judges, Original};
use super::parts::Parts;
use super::rings::tubes;
use super::thickness::thickness;
use crate::coarsen::leaf_mesh::{Kept, collapsed_within, halvings};

/// A texture that would be off by its whole width counts as much as a surface that is off by this
/// share of the piece's length: little, since bark repeats along a branch. Other values were not
/// tried.
pub(super) const UV_WEIGHT: f32 = 0.01;

/// A piece with fewer triangles.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// Corners of the piece, numbered as in [`secateur_model::CornerRef`].
    pub(super) triangles: Vec<[u32; 3]>,
    /// The share of the piece's pixels that it shows no longer, or elsewhere: 0 to 1.
    pub(super) loss: f64,
    /// Whether it goes where the piece went, from end to end.
    pub(super) reaches: bool,
    /// Whether it does, and is seen from all sides: what carries the crown may become that.
    pub(super) stands: bool,
    /// Whether it is only for what carries the crown, where nothing else fits a budget.
    pub(super) is_last_form: bool,
}

/// A normal that would be off by its whole length counts as much as a surface that is off by this
/// share of the piece's thickness. Of 0, .02, .05, .1 and .3, tried at a quarter and a tenth of all
/// triangles, those to .05 look alike on an oak, a birch, a maple and `quat_commontree_1`; on the last
/// .1 has a FLIP of .0196 instead of .0188 at a tenth.
const NORMAL_WEIGHT: f64 = 0.05;

/// [`NORMAL_WEIGHT`] of collapses over all pieces, as a share of the size of the plant. With .005, .02 and .06 `lods` needs
/// 9,592, 7,892 and 7,238 of the 19,604 triangles of `assets/plant2.glb` (Steun/creative-day-plants) for 1,080 pixels. A
/// bare tree needs the fewest for 270 pixels with .02.
pub(super) const EVEN_NORMAL_WEIGHT: f32 = 0.02;

/// What a level loses at most: what shows nothing of a piece may still bear leaves and twigs.
const MOST_LOST: f64 = 0.999;

/// A level goes where its piece went if both ends of that, and its corners on the mean, are no further from it
/// than this share of the radius of the wood: a bent stem may be straight.
const MOST_OFF: f64 = 0.1;

/// A level is seen from all sides if no view shows less of it than this share of what that showed of the piece:
/// a flat strip is next to nothing edge on, a stem that ends in a point is half of it.
const LEAST_SHOWN: f64 = 0.3;

/// The levels of all pieces, finest first; of two of a piece the coarser loses more, but for the coarsest
/// that stands. `collapsed` are the triangles that collapses leave of each piece.
pub(super) fn levels(
    parts: &Parts,
    collapsed: Vec<Vec<Vec<[u32; 3]>>>,
    is_joint: &(dyn Fn(DVec3) -> bool + Sync),
    judges: Judges<'_>,
) -> Vec<Vec<Level>> {
    let wood = parts.foliage();
    let radius = wood.bounding_sphere().map_or(0.0, |sphere| sphere.radius);
    let of_piece = |fragments: &mut LeafFragments, (piece, collapsed): (usize, Vec<_>)| {
        let piece = LeafId::from_index(piece);
        let mut original = Original::new(wood, piece, judges, fragments);
        let all = collapsed.into_iter();
        let all = all.chain(tubes_of(wood, piece, is_joint));
        falling(all.map(|triangles| {
            let lost = original.loss(&triangles);
            let reaches = lost.off.max(lost.ends_off) <= MOST_OFF * radius;
            Level {
                triangles,
                loss: lost.loss.min(MOST_LOST),
                reaches,
                stands: reaches && lost.least_shown >= LEAST_SHOWN,
                is_last_form: false,
            }
        }))
    };
    let all = collapsed.into_par_iter().enumerate();
    let buffer = || LeafFragments::new(judges.resolution);
    all.map_init(buffer, of_piece).collect()
}

/// The last forms of a piece, for where nothing else of it fits a budget.
pub(super) fn last_levels(wood: &Foliage, piece: LeafId) -> Vec<Level> {
    let forms = last_forms(wood.triangles_of(piece)).into_iter();
    let level = |triangles| Level {
        triangles,
        loss: MOST_LOST,
        reaches: true,
        stands: true,
        is_last_form: true,
    };
    forms.map(level).collect()
}

/// A piece with a number of triangles in a range; none if collapses get to none. Where `is_joint` says so, they
/// leave vertices.
pub(super) fn collapsed_to(
    wood: &Foliage,
    piece: LeafId,
    is_joint: &dyn Fn(DVec3) -> bool,
    counts: std::ops::RangeInclusive<usize>,
) -> Option<Vec<[u32; 3]>> {
    let triangles = wood.triangles_of(piece);
    let plain = triangles.iter().map(|t| LeafTriangle::plain(t.corners));
    let plain: Vec<LeafTriangle> = plain.collect();
    // Where collapses along textures stall, corners are welded by position alone.
    [triangles, &plain].into_iter().find_map(|triangles| {
        let kept = kept(wood, piece, is_joint);
        let kept = collapsed_within(triangles, kept, *counts.end())?;
        counts.contains(&kept.len()).then_some(kept)
    })
}

/// What collapses of edges by geometry leave of all pieces. Where `is_joint` says so, they leave vertices.
pub(super) fn collapsed(
    parts: &Parts,
    is_joint: &(dyn Fn(DVec3) -> bool + Sync),
) -> Vec<Vec<Vec<[u32; 3]>>> {
    let wood = parts.foliage();
    let pieces = (0..wood.leaves().len()).into_par_iter();
    pieces
        .map(|piece| collapsed_of(wood, LeafId::from_index(piece), is_joint))
        .collect()
}

fn collapsed_of(
    wood: &Foliage,
    piece: LeafId,
    is_joint: &dyn Fn(DVec3) -> bool,
) -> Vec<Vec<[u32; 3]>> {
    halvings(wood.triangles_of(piece), kept(wood, piece, is_joint))
}

/// What collapses of a piece are to keep.
fn kept<'a>(wood: &Foliage, piece: LeafId, is_joint: &'a dyn Fn(DVec3) -> bool) -> Kept<'a> {
    let triangles = wood.triangles_of(piece);
    let thickness = thickness(wood, piece);
    let first = triangles[0].corners[0];
    let corners = triangles.iter().flat_map(|t| t.corners);
    let size = corners.map(|c| (c - first).length()).fold(0.0, f64::max);
    let normal_weight = match size > 0.0 {
        true => NORMAL_WEIGHT * thickness / size,
        false => 0.0,
    };
    Kept {
        uv_weight: UV_WEIGHT,
        normal_weight: normal_weight as f32,
        is_locked: is_joint,
    }
}

/// [`tubes`] of a piece that have every joint which it has.
fn tubes_of(wood: &Foliage, piece: LeafId, is_joint: &dyn Fn(DVec3) -> bool) -> Vec<Vec<[u32; 3]>> {
    let triangles = wood.triangles_of(piece);
    let key = |corner: &DVec3| corner.to_array().map(|x| (x + 0.0).to_bits());
    let corners = triangles.iter().flat_map(|t| t.corners);
    let joints = corners.filter(|corner| is_joint(*corner));
    let joints: FxHashSet<[u64; 3]> = joints.map(|corner| key(&corner)).collect();
    let is_seen_from_both_sides = wood.leaf(piece).facing() == Facing::Both;
    let mut levels = tubes(triangles, is_seen_from_both_sides);
    levels.retain(|level| {
        let corners: Vec<_> = corners_of(triangles, level).collect();
        let has: FxHashSet<[u64; 3]> = corners.as_flattened().iter().map(key).collect();
        joints.is_subset(&has)
    });
    levels
}

/// Levels of ever fewer triangles and ever larger losses; what loses as much as one of no more
/// triangles is left out, but for the coarsest that stands, and so is what loses all of a piece, which is no
/// better than nothing.
fn falling(levels: impl Iterator<Item = Level>) -> Vec<Level> {
    let mut all: Vec<Level> = levels.filter(|level| level.loss < 1.0).collect();
    // The coarsest first, of as many triangles the one that loses least.
    let by_count = |a: &Level, b: &Level| a.triangles.len().cmp(&b.triangles.len());
    all.sort_by(|a, b| by_count(a, b).then(a.loss.total_cmp(&b.loss)));
    let mut falling: Vec<Level> = Vec::new();
    let mut least = f64::INFINITY;
    let mut one_stands = false;
    for level in all {
        if level.loss < least || (level.stands && !one_stands) {
            least = level.loss.min(least);
            one_stands |= level.stands;
            falling.push(level);
        }
    }
    falling.reverse();
    falling
}

/// Tells the places that two pieces have. Parts of one piece may come apart: the one that others grow on
/// is closed.
pub(super) fn joints(parts: &Parts) -> impl Fn(DVec3) -> bool + Sync + use<> {
    let wood = parts.foliage();
    let key = |place: DVec3| place.to_array().map(|v| (v + 0.0).to_bits());
    let mut piece_at: FxHashMap<[u64; 3], Option<LeafId>> = FxHashMap::default();
    for part in 0..wood.leaves().len() {
        let piece = parts.piece_of(part);
        for triangle in wood.triangles_of(LeafId::from_index(part)) {
            for corner in triangle.corners {
                let known = piece_at.entry(key(corner)).or_insert(Some(piece));
                if *known != Some(piece) {
                    *known = None;
                }
            }
        }
    }
    move |place| piece_at.get(&key(place)) == Some(&None)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec2};
    use secateur_model::BoundingSphere;
    use secateur_raster::ViewSet;

    use super::super::nearest::nearest;
    use super::super::parts::of_corners;
    use super::super::tests::tube;
    use super::*;

    const LENGTH: f64 = 8.0;

    /// A bent tube that gets thinner, whose bark repeats 20 times along it.
    fn bent() -> Foliage {
        let mut triangles = tube(DVec3::ZERO, LENGTH * DVec3::Y, 0.5, 24);
        for triangle in &mut triangles {
            for corner in &mut triangle.corners {
                let share = corner.y / LENGTH;
                let radius = 1.0 - 0.6 * share;
                let bend = 0.6 * (5.0 * share).sin();
                *corner = DVec3::new(radius * corner.x + bend, corner.y, radius * corner.z);
            }
            for uv in &mut triangle.uvs {
                uv.y *= 20.0;
            }
        }
        let mut wood = Foliage::default();
        wood.push_leaf(&triangles, None).unwrap();
        wood
    }

    /// How far along the tube the bark of a level is at most from where it was, in world units, where
    /// triangles have these weights of their corners.
    fn slide(all: &[LeafTriangle], level: &[LeafTriangle], weights: DVec3) -> f64 {
        let along = |uv: DVec2| uv.y / 20.0 * LENGTH;
        let of_triangle = |triangle: &LeafTriangle| {
            let at = DMat3::from_cols_array_2d(&triangle.corners.map(Into::into)) * weights;
            let uv = (0..3).map(|k| weights[k] * triangle.uvs[k]).sum();
            let was = all.iter().map(|t| {
                let found = nearest(t.corners, at);
                let uv = (0..3).map(|k| found.weights[k] * t.uvs[k]).sum();
                (found.point.distance(at), along(uv))
            });
            let was = was.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1;
            (along(uv) - was).abs()
        };
        level.iter().map(of_triangle).fold(0.0, f64::max)
    }

    /// Corners have the bark that was there. Amid triangles it is off by less than a fifth of the
    /// tube's thickness where that is most, on all levels that lose less than half.
    #[test]
    fn bark_does_not_swim_along_a_branch() {
        let wood = bent();
        let all = wood.triangles();
        let parts = Parts::of(&wood);
        let views = ViewSet::octahedron(BoundingSphere {
            centre: 4.0 * DVec3::Y,
            radius: 4.5,
        });
        let is_joint = |_| false;
        let judges = Judges {
            views: &views,
            resolution: 128,
        };
        let left = collapsed(&parts, &is_joint);
        let levels = levels(&parts, left, &is_joint, judges);
        let mut count = 0;
        for level in levels[0].iter().filter(|level| level.loss < 0.5) {
            let left = of_corners(all, &level.triangles);
            let at_corners = DVec3::AXES.map(|corner| slide(all, &left, corner));
            let triangles = left.len();
            assert!(
                at_corners.iter().all(|slide| *slide < 1e-6),
                "{at_corners:?} with {triangles} triangles"
            );
            let amid = slide(all, &left, DVec3::splat(1.0 / 3.0));
            assert!(amid < 0.2, "{amid} with {triangles} triangles");
            count += 1;
        }
        assert!(count > 4, "{count} levels");
    }
}
