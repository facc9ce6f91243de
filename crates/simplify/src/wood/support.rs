//! Which piece of wood grows on which.

use glam::DVec3;
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree, RTreeObject};
use secateur_model::{Foliage, LeafId};

use super::nearest::nearest;
use super::parts::Parts;

/// Largest number of corners of a piece that are compared with other pieces.
const MOST_CORNERS: usize = 192;

/// What begins no higher above the lowest wood than this share of the radius of all wood is on the ground.
const GROUND: f64 = 0.02;

/// For each piece the one that it grows on: of those of more area the one nearest to any of its
/// corners. The piece of the most area grows on none. Pieces of equal area are taken in their
/// order.
pub fn supports(wood: &Foliage) -> Vec<Option<usize>> {
    let found = growing(wood).into_iter();
    found.map(|found| Some(found?.on)).collect()
}

/// What a piece grows on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growing {
    pub(super) on: usize,
    /// The corner that is nearest to it.
    pub(super) at: DVec3,
    /// How far that is, in world units.
    pub(super) distance: f64,
}

/// [`supports`], with where and how far off each is.
pub(super) fn growing(wood: &Foliage) -> Vec<Option<Growing>> {
    let area = |index: usize| wood.leaf(LeafId::from_index(index)).area();
    let areas: Vec<f64> = (0..wood.leaves().len()).map(area).collect();
    let ranks = ranks(&areas);
    growing_by(wood, &ranks, |_| None)
}

/// What each part grows on: a part of the same piece, or as [`growing`] has it for pieces the nearest part
/// of a larger piece. What stands on the ground grows on none: stems of a bush may pass each other nearer
/// in the air than where they rise.
pub(super) fn growing_of_parts(parts: &Parts) -> Vec<Option<Growing>> {
    let wood = parts.foliage();
    let count = wood.leaves().len();
    let mut areas = vec![0.0; parts.piece_count()];
    for part in 0..count {
        areas[parts.piece_of(part).index()] += wood.leaf(LeafId::from_index(part)).area();
    }
    let of_pieces = ranks(&areas);
    let ranks: Vec<usize> = (0..count)
        .map(|part| of_pieces[parts.piece_of(part).index()])
        .collect();
    let mut growing = growing_by(wood, &ranks, |part| parts.on(part));
    let ground = Ground::of(wood);
    for (part, found) in growing.iter_mut().enumerate() {
        if parts.on(part).is_none() && ground.bears(wood, part) {
            *found = None;
        }
    }
    growing
}

/// Where a piece begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Foot {
    /// The piece begins on another piece.
    Grows {
        on: usize,
        /// The corner that is nearest to it.
        at: DVec3,
    },
    /// The piece grows on no other.
    Stands {
        /// The y of the lowest wood.
        on_ground: f64,
        /// The y up to which corners of the piece are its foot.
        height: f64,
    },
}

/// The pieces with where they begin, what another grows on before that. What stands on the ground grows on none.
pub(super) fn feet(wood: &Foliage) -> Vec<(usize, Foot)> {
    let ground = Ground::of(wood);
    let growing = growing(wood);
    let foot = |piece: usize| match growing[piece] {
        Some(Growing { on, at, .. }) if !ground.bears(wood, piece) => Foot::Grows { on, at },
        _ => {
            let corners = wood.triangles_of(LeafId::from_index(piece)).iter();
            let low = corners.flat_map(|t| t.corners).map(|corner| corner.y);
            Foot::Stands {
                on_ground: ground.y,
                height: low.fold(f64::INFINITY, f64::min) + ground.reach,
            }
        }
    };
    let area = |piece: usize| wood.leaf(LeafId::from_index(piece)).area();
    let areas: Vec<f64> = (0..growing.len()).map(area).collect();
    let ranks = ranks(&areas);
    let mut pieces: Vec<(usize, Foot)> = (0..growing.len())
        .map(|piece| (piece, foot(piece)))
        .collect();
    pieces.sort_by_key(|(piece, _)| ranks[*piece]);
    pieces
}

/// Where the lowest wood is.
struct Ground {
    y: f64,
    /// What is no higher above that is on the ground.
    reach: f64,
}

impl Ground {
    fn of(wood: &Foliage) -> Self {
        let corners = wood.triangles().iter().flat_map(|t| t.corners);
        let radius = wood.bounding_sphere().map_or(0.0, |sphere| sphere.radius);
        Self {
            y: corners.map(|corner| corner.y).fold(f64::INFINITY, f64::min),
            reach: GROUND * radius,
        }
    }

    /// Whether a piece begins at the ground and has most of its area in the lower half of its height: the tip of a
    /// twig that hangs to the ground is thin.
    fn bears(&self, wood: &Foliage, piece: usize) -> bool {
        let triangles = wood.triangles_of(LeafId::from_index(piece));
        let heights = || triangles.iter().flat_map(|t| t.corners).map(|c| c.y);
        let low = heights().fold(f64::INFINITY, f64::min);
        let high = heights().fold(f64::NEG_INFINITY, f64::max);
        if low > self.y + self.reach {
            return false;
        }
        let middle = 0.5 * (low + high);
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.corners;
            let is_low = (a.y + b.y + c.y) / 3.0 <= middle;
            (b - a).cross(c - a).length() * if is_low { 1.0 } else { -1.0 }
        });
        areas.sum::<f64>() >= 0.0
    }
}

/// The place of each in the order of area, the largest first; those of equal area in their own order.
fn ranks(areas: &[f64]) -> Vec<usize> {
    let mut by_area: Vec<usize> = (0..areas.len()).collect();
    by_area.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]).then(a.cmp(&b)));
    let mut ranks = vec![0; by_area.len()];
    for (place, &index) in by_area.iter().enumerate() {
        ranks[index] = place;
    }
    ranks
}

/// For each the one of lesser rank that is nearest to any of its corners, or the one that is known.
fn growing_by(
    wood: &Foliage,
    ranks: &[usize],
    known: impl Fn(usize) -> Option<usize> + Sync,
) -> Vec<Option<Growing>> {
    let mut boxes = Vec::with_capacity(wood.triangles().len());
    for index in 0..ranks.len() {
        for triangle in wood.triangles_of(LeafId::from_index(index)) {
            boxes.push(GeomWithData::new(bounds(triangle.corners), index));
        }
    }
    let tree = RTree::bulk_load(boxes);
    let support = |index: usize| -> Option<Growing> {
        let known = known(index);
        if known.is_none() && ranks[index] == 0 {
            return None;
        }
        let grows_on = |other: usize| match known {
            Some(known) => other == known,
            None => ranks[other] < ranks[index],
        };
        let triangles = wood.triangles_of(LeafId::from_index(index));
        let corners = triangles.iter().flat_map(|t| t.corners);
        // What a part has in common with the one that it grows on is but a few corners.
        let step = match known {
            Some(_) => 1,
            None => (3 * triangles.len()).div_ceil(MOST_CORNERS),
        };
        let mut best = (f64::INFINITY, usize::MAX, DVec3::ZERO);
        for corner in corners.step_by(step) {
            let nearest = tree.nearest_neighbor_iter_with_distance_2(corner.to_array());
            for (other, distance_2) in nearest {
                if distance_2 >= best.0 {
                    break;
                }
                if grows_on(other.data) {
                    best = (distance_2, other.data, corner);
                    break;
                }
            }
        }
        (best.1 != usize::MAX).then(|| Growing {
            on: best.1,
            at: best.2,
            distance: best.0.sqrt(),
        })
    };
    (0..ranks.len()).into_par_iter().map(support).collect()
}

pub(super) fn bounds(corners: [DVec3; 3]) -> Bounds {
    let points = corners.map(|corner| corner.to_array());
    Bounds(AABB::from_points(points.iter()), corners)
}

/// A triangle with its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds(AABB<[f64; 3]>, [DVec3; 3]);

impl RTreeObject for Bounds {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.0
    }
}

impl rstar::PointDistance for Bounds {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from_array(*point);
        (point - nearest(self.1, point).point).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::Foliage;

    use super::super::tests::tube;
    use super::*;

    /// Two stems that cross above the ground; and a bough of the thicker one whose tip hangs to the ground.
    #[test]
    fn stems_rise_from_the_ground_and_tips_hang_to_it() {
        let mut wood = Foliage::default();
        let right = DVec3::new(2.0, 0.0, 0.0);
        let left = DVec3::new(-2.0, 0.0, 0.0);
        let up = 6.0 * DVec3::Y;
        wood.push_leaf(&tube(left, right + up, 0.2, 8), None)
            .unwrap();
        wood.push_leaf(&tube(right, left + up, 0.1, 8), None)
            .unwrap();
        let from = DVec3::new(1.0, 4.5, 0.0);
        let mut bough = tube(from, DVec3::new(5.0, 0.02, 0.0), 0.06, 8);
        for corner in bough.iter_mut().flat_map(|t| &mut t.corners) {
            let share = (corner.y / from.y).clamp(0.1, 1.0);
            let middle = DVec3::new(5.0, 0.0, 0.0).lerp(from, corner.y / from.y);
            *corner = middle + share * (*corner - middle);
        }
        wood.push_leaf(&bough, None).unwrap();
        let growing = growing_of_parts(&Parts::of(&wood));
        let on: Vec<Option<usize>> = growing.iter().map(|found| Some((*found)?.on)).collect();
        assert_eq!(on, [None, None, Some(0)]);
        // As pieces that may be anywhere the thinner one grows on the other.
        assert_eq!(supports(&wood), [None, Some(0), Some(0)]);
    }
}
