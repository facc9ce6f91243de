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
/// of a larger piece.
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
    growing_by(wood, &ranks, |part| parts.on(part))
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds(AABB<[f64; 3]>, [DVec3; 3]);

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
