//! A budget of triangles, shared over the leaves.

use std::collections::BTreeMap;

use secateur_model::{Foliage, LeafId};

use super::LossCurves;
use crate::fill::is_met;

/// For each leaf the number of triangles it may keep, at most `at_most` in all unless every
/// leaf is at its least. Triangles go one by one where they save the most area: what the leaf
/// loses without them, times its area. A few may stay over that no leaf can use. Leaves that are instances of one mesh
/// have one number, and get more together: where that leaves a tenth of the budget or more they have too many instead,
/// so that some are to go.
pub fn share_triangles(foliage: &Foliage, at_most: usize, curves: &LossCurves) -> Vec<usize> {
    let leaves = || (0..foliage.leaves().len()).map(LeafId::from_index);
    let mut shares: Vec<usize> = leaves()
        .map(|leaf| curves.hull(leaf)[0].triangles)
        .collect();
    struct More {
        leaf: LeafId,
        from: usize,
        to: usize,
        worth: f64,
    }
    // Instances of one mesh go by the name of the first.
    let mut instances: BTreeMap<LeafId, Vec<LeafId>> = BTreeMap::new();
    for leaf in leaves() {
        if let Some(first) = curves.first_of_shape(leaf) {
            instances.entry(first).or_default().push(leaf);
        }
    }
    let is_alone = |leaf: &LeafId| curves.first_of_shape(*leaf).is_none();
    let mut more: Vec<More> = Vec::new();
    for leaf in leaves() {
        let area = match (is_alone(&leaf), instances.get(&leaf)) {
            (true, _) => foliage.leaf(leaf).area(),
            (false, Some(alike)) => {
                let areas = alike.iter().map(|leaf| foliage.leaf(*leaf).area());
                areas.sum::<f64>() / alike.len() as f64
            }
            (false, None) => continue,
        };
        for pair in curves.hull(leaf).windows(2) {
            let (from, to) = (pair[0].triangles, pair[1].triangles);
            let lost = pair[0].loss - pair[1].loss;
            let worth = area * lost / (to - from) as f64;
            more.push(More {
                leaf,
                from,
                to,
                worth,
            });
        }
    }
    more.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    let mut over = at_most.saturating_sub(shares.iter().sum());
    for More { leaf, from, to, .. } in more {
        let alone = [leaf];
        let alike = instances.get(&leaf).map_or(&alone[..], Vec::as_slice);
        let added = (to - from) * alike.len();
        if shares[leaf.index()] == from && added <= over {
            for leaf in alike {
                shares[leaf.index()] = to;
            }
            over -= added;
        }
    }
    if !is_met(at_most, at_most.saturating_sub(over)) {
        let next = |first: &LeafId| {
            let all = curves.hull(*first).iter();
            let more = all
                .map(|point| point.triangles)
                .find(|n| *n > shares[first.index()]);
            more.map(|n| (*first, n))
        };
        let most = instances.iter().max_by_key(|(_, alike)| alike.len());
        if let Some((first, to)) = most.and_then(|(first, _)| next(first)) {
            for leaf in &instances[&first] {
                over = over.saturating_sub(to - shares[leaf.index()]);
                shares[leaf.index()] = to;
            }
        }
    }
    // The rest goes to points off the hull, largest leaves first.
    let mut by_area: Vec<LeafId> = leaves().filter(is_alone).collect();
    by_area.sort_by(|a, b| {
        let area = |leaf: &LeafId| foliage.leaf(*leaf).area();
        area(b).total_cmp(&area(a))
    });
    for leaf in by_area {
        if over == 0 {
            break;
        }
        let share = &mut shares[leaf.index()];
        let all = curves.points(leaf);
        let now = all.partition_point(|point| point.triangles < *share);
        let near = all[now..].iter();
        let near = near.take_while(|point| point.triangles - *share <= over);
        let best = near.min_by(|a, b| a.loss.total_cmp(&b.loss));
        if let Some(best) = best {
            over -= best.triangles - *share;
            *share = best.triangles;
        }
    }
    shares
}
