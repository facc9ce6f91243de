//! How far leaves and pieces of wood hang in the air.

use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use secateur_model::{Foliage, LeafId};

use super::support::{bounds, support_and_distance};

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

/// For each piece of wood how far it is from the one that it grows on, in world units: see
/// [`supports`](super::supports). The one that grows on none has 0.
pub fn wood_gaps(wood: &Foliage) -> Vec<f64> {
    let found = support_and_distance(wood).into_iter();
    found
        .map(|found| found.map_or(0.0, |(_, distance)| distance))
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
