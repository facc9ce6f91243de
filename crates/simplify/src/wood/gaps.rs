//! How far leaves and pieces of wood hang in the air.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use secateur_model::{Foliage, LeafId};

use super::bearing::{points_of, triangles_of};
use super::support::{Bounds, bounds, growing};

/// For each leaf how far it is from the nearest wood, or from the nearest leaf that lies lower, in world
/// units: 0 where they touch. So each leaf rests on wood, or on leaves that do.
///
/// Lower is a smaller y of the centre, as glTF has it. Distances are those of corners, centres
/// and the middles of edges from triangles; infinite for the lowest leaf of a plant without wood.
pub fn leaf_gaps(leaves: &Foliage, wood: &Foliage) -> Vec<f64> {
    let tree = |foliage: &Foliage| {
        let all = (0..foliage.leaves().len()).flat_map(|index| {
            let triangles = foliage.triangles_of(LeafId::from_index(index)).iter();
            triangles.map(move |t| GeomWithData::new(bounds(t.corners), index))
        });
        RTree::bulk_load(all.collect::<Vec<_>>())
    };
    let (wood, all) = (tree(wood), tree(leaves));
    let height = |index: usize| leaves.leaf(LeafId::from_index(index)).centre().y;
    let gap = |index: usize| {
        let own_height = height(index);
        let mut least = f64::INFINITY;
        for triangle in leaves.triangles_of(LeafId::from_index(index)) {
            for point in samples(triangle.corners) {
                let point = point.to_array();
                let nearest = wood.nearest_neighbor_iter_with_distance_2(point).next();
                least = nearest.map_or(least, |(_, distance_2)| least.min(distance_2));
                for (other, distance_2) in all.nearest_neighbor_iter_with_distance_2(point) {
                    if distance_2 >= least {
                        break;
                    }
                    if height(other.data) < own_height {
                        least = distance_2;
                        break;
                    }
                }
            }
        }
        least.sqrt()
    };
    (0..leaves.leaves().len())
        .into_par_iter()
        .map(gap)
        .collect()
}

/// For each leaf nothing where it rests on wood, or on a lower leaf that does, each no further from the
/// next than `largest_gap` in world units; else the lowest leaf, by its number, that it rests on,
/// which may be itself.
///
/// Lower and distances are as [`leaf_gaps`] has them.
pub fn hanging_on(leaves: &Foliage, wood: &Foliage, largest_gap: f64) -> Vec<Option<usize>> {
    SortedWood::of(wood).hanging(leaves, largest_gap)
}

/// The triangles of wood, sorted by where they are.
#[derive(Clone, Debug)]
pub(crate) struct SortedWood(Arc<RTree<GeomWithData<Bounds, u32>>>);

impl PartialEq for SortedWood {
    fn eq(&self, other: &Self) -> bool {
        self.0.size() == other.0.size() && self.0.iter().eq(other.0.iter())
    }
}

impl SortedWood {
    pub(crate) fn of(wood: &Foliage) -> Self {
        Self(Arc::new(triangles_of(wood)))
    }

    /// What [`hanging_on`] returns for these leaves and this wood.
    pub(crate) fn hanging(&self, leaves: &Foliage, largest_gap: f64) -> Vec<Option<usize>> {
        let points = |index: usize| {
            let triangles = leaves.triangles_of(LeafId::from_index(index)).iter();
            triangles.flat_map(|t| samples(t.corners))
        };
        // Whether there is any is found much sooner than which is nearest.
        let is_near_wood = |index: usize| {
            points(index).any(|point| {
                let mut near = self
                    .0
                    .locate_within_distance(point.to_array(), largest_gap.powi(2));
                near.next().is_some()
            })
        };
        let count = leaves.leaves().len();
        let is_near_wood: Vec<bool> = (0..count).into_par_iter().map(is_near_wood).collect();
        let mut lowest: Vec<Option<usize>> = vec![None; count];
        let mut upward: Vec<usize> = (0..count).filter(|leaf| !is_near_wood[*leaf]).collect();
        if upward.is_empty() {
            return lowest;
        }
        let all = triangles_of(leaves);
        let height = |index: usize| leaves.leaf(LeafId::from_index(index)).centre().y;
        upward.sort_by(|a, b| height(*a).total_cmp(&height(*b)).then(a.cmp(b)));
        for leaf in upward {
            let mut found = Some(leaf);
            'points: for point in points(leaf) {
                for near in all.locate_within_distance(point.to_array(), largest_gap.powi(2)) {
                    let other = near.data as usize;
                    if height(other) < height(leaf) {
                        if lowest[other].is_none() {
                            found = None;
                            break 'points;
                        }
                        if found == Some(leaf) {
                            found = lowest[other];
                        }
                    }
                }
            }
            lowest[leaf] = found;
        }
        lowest
    }
}

/// For each piece of wood how far it is from the one that it grows on, in world units: see
/// [`supports`](super::supports). The one that grows on none has 0.
pub fn wood_gaps(wood: &Foliage) -> Vec<f64> {
    let found = growing(wood).into_iter();
    found
        .map(|found| found.map_or(0.0, |found| found.distance))
        .collect()
}

/// For each leaf how far it is from the nearest wood, in world units, by its corners and the centres of
/// its triangles; infinite without wood.
pub fn leaf_wood_gaps(leaves: &Foliage, wood: &Foliage) -> Vec<f64> {
    let tree = triangles_of(wood);
    let gap = |index: usize| {
        let points = points_of(leaves.triangles_of(LeafId::from_index(index)));
        let to_wood = |point: DVec3| {
            let mut near = tree.nearest_neighbor_iter_with_distance_2(point.to_array());
            near.next()
                .map_or(f64::INFINITY, |(_, distance_2)| distance_2)
        };
        points
            .into_iter()
            .map(to_wood)
            .fold(f64::INFINITY, f64::min)
            .sqrt()
    };
    (0..leaves.leaves().len())
        .into_par_iter()
        .map(gap)
        .collect()
}

fn samples([a, b, c]: [DVec3; 3]) -> [DVec3; 7] {
    let middle = |p: DVec3, q: DVec3| 0.5 * (p + q);
    [
        a,
        b,
        c,
        middle(a, b),
        middle(b, c),
        middle(c, a),
        (a + b + c) / 3.0,
    ]
}
