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
    let shares: Vec<usize> = leaves_of(foliage)
        .map(|leaf| curves.hull(leaf)[0].triangles)
        .collect();
    let mut sharing = Sharing {
        foliage,
        curves,
        instances: instances(foliage, curves),
        over: at_most.saturating_sub(shares.iter().sum()),
        shares,
    };
    sharing.along_hulls();
    if !is_met(at_most, at_most.saturating_sub(sharing.over)) {
        sharing.beyond_the_budget();
    }
    sharing.off_hulls();
    sharing.shares
}

fn leaves_of(foliage: &Foliage) -> impl Iterator<Item = LeafId> + use<> {
    (0..foliage.leaves().len()).map(LeafId::from_index)
}

/// Leaves that are instances of one mesh, by the first of them.
fn instances(foliage: &Foliage, curves: &LossCurves) -> BTreeMap<LeafId, Vec<LeafId>> {
    let mut instances: BTreeMap<LeafId, Vec<LeafId>> = BTreeMap::new();
    for leaf in leaves_of(foliage) {
        if let Some(first) = curves.first_of_shape(leaf) {
            instances.entry(first).or_default().push(leaf);
        }
    }
    instances
}

/// Triangles that a leaf, and all instances of its mesh, may get more.
struct More {
    leaf: LeafId,
    from: usize,
    to: usize,
    /// The area that each of these triangles saves.
    worth: f64,
}

/// A budget while it is shared.
struct Sharing<'a> {
    foliage: &'a Foliage,
    curves: &'a LossCurves,
    instances: BTreeMap<LeafId, Vec<LeafId>>,
    /// For each leaf, how many triangles it has so far.
    shares: Vec<usize>,
    /// Triangles that no leaf has yet.
    over: usize,
}

impl Sharing<'_> {
    fn is_alone(&self, leaf: LeafId) -> bool {
        self.curves.first_of_shape(leaf).is_none()
    }

    /// All that leaves could get along the hulls of their curves, what saves most first.
    fn wanted(&self) -> Vec<More> {
        let area_of = |leaf: LeafId| self.foliage.leaf(leaf).area();
        let mut more: Vec<More> = Vec::new();
        for leaf in leaves_of(self.foliage) {
            let area = match (self.is_alone(leaf), self.instances.get(&leaf)) {
                (true, _) => area_of(leaf),
                (false, Some(alike)) => {
                    alike.iter().map(|leaf| area_of(*leaf)).sum::<f64>() / alike.len() as f64
                }
                (false, None) => continue,
            };
            for pair in self.curves.hull(leaf).windows(2) {
                let (from, to) = (pair[0].triangles, pair[1].triangles);
                let lost = pair[0].loss - pair[1].loss;
                more.push(More {
                    leaf,
                    from,
                    to,
                    worth: area * lost / (to - from) as f64,
                });
            }
        }
        more.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        more
    }

    fn along_hulls(&mut self) {
        for More { leaf, from, to, .. } in self.wanted() {
            let alone = [leaf];
            let alike = self.instances.get(&leaf).map_or(&alone[..], Vec::as_slice);
            let added = (to - from) * alike.len();
            if self.shares[leaf.index()] == from && added <= self.over {
                for leaf in alike {
                    self.shares[leaf.index()] = to;
                }
                self.over -= added;
            }
        }
    }

    /// The mesh with the most instances gets its next number of triangles, more than the budget has.
    fn beyond_the_budget(&mut self) {
        let most = self.instances.iter().max_by_key(|(_, alike)| alike.len());
        let Some((first, alike)) = most else {
            return;
        };
        let now = self.shares[first.index()];
        let mut all = self.curves.hull(*first).iter().map(|point| point.triangles);
        let Some(to) = all.find(|triangles| *triangles > now) else {
            return;
        };
        for leaf in alike {
            self.over = self.over.saturating_sub(to - self.shares[leaf.index()]);
            self.shares[leaf.index()] = to;
        }
    }

    /// The rest goes to points off the hull, largest leaves first.
    fn off_hulls(&mut self) {
        let alone = leaves_of(self.foliage).filter(|leaf| self.is_alone(*leaf));
        let mut by_area: Vec<LeafId> = alone.collect();
        by_area.sort_by(|a, b| {
            let area = |leaf: &LeafId| self.foliage.leaf(*leaf).area();
            area(b).total_cmp(&area(a))
        });
        for leaf in by_area {
            if self.over == 0 {
                break;
            }
            let share = &mut self.shares[leaf.index()];
            let all = self.curves.points(leaf);
            let now = all.partition_point(|point| point.triangles < *share);
            let near = all[now..].iter();
            let near = near.take_while(|point| point.triangles - *share <= self.over);
            let best = near.min_by(|a, b| a.loss.total_cmp(&b.loss));
            if let Some(best) = best {
                self.over -= best.triangles - *share;
                *share = best.triangles;
            }
        }
    }
}
