//! The multiresolution chain as the order in which a foliage loses its leaves.

use secateur_model::{Foliage, LeafId, PlantSkeleton, RemovalOrder};

use crate::Metric;
use crate::branches::Branches;
use crate::chain_paths::paths;

/// Removes leaves until `leaves` are left, those of the chain's last path first,
/// from its tip: so every prefix is the order to more leaves, and what is left at
/// the end of a path is a level of [`Chain`](crate::Chain). Nothing grows, as in the
/// paper. Wood is not part of it. Leaves that grow on no segment go last.
///
/// Time: branches times depth, times a logarithm.
///
/// # Panics
/// If the skeleton does not pass its check for this foliage.
pub fn chain_order(
    foliage: &Foliage,
    skeleton: &PlantSkeleton,
    metric: Metric,
    leaves: usize,
) -> RemovalOrder {
    let count = foliage.leaves().len();
    skeleton.check(count).expect("a skeleton of this foliage");
    let branches = Branches::of_segments(&skeleton.segments);
    // The place of each segment in the chain, from 1; 0 for none.
    let mut places = vec![0u32; skeleton.segments.len()];
    let mut place = 0;
    for path in paths(&branches, metric) {
        for branch in path {
            for segment in &branches.all()[branch.index()].segments {
                place += 1;
                places[segment.index()] = place;
            }
        }
    }
    let mut drawn: Vec<(u32, u32)> = (skeleton.leaf_segments.iter().zip(0..))
        .map(|(segment, leaf)| (segment.map_or(0, |s| places[s.index()]), leaf))
        .collect();
    drawn.sort_unstable();
    let mut order = RemovalOrder::new(count as u32);
    for &(_, leaf) in drawn.iter().skip(leaves).rev() {
        order.push(LeafId::from_index(leaf as usize), &[]);
    }
    order
}
