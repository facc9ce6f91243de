//! A budget of triangles, shared over the leaves.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::iter;

use secateur_model::{Foliage, LeafId};

use super::loss_curve::lower_hull;
use super::{LossCurves, LossPoint};
use crate::fill::is_met;

/// What a leaf that goes loses, as a multiple of what is seen of it. A coarser leaf shows beside itself what it loses;
/// where one goes there is a hole. `difference` at 270 pixels with 1, 1.5 and 2.5, and without a look at what is seen:
/// two public crowns of opaque quads at .35 of their triangles .296, .337, .395, .550 and .154, .160, .171, .297;
/// a bush of such quads at .15 .899, .860, .879, .887; a grown palmetto at .35 .187, .189, .189, .204.
const LOSS_OF_GONE: f64 = 1.5;

/// For each leaf the number of triangles it may keep, at most `at_most` in all unless every
/// leaf is at its least. Triangles go one by one where they save the most: what the leaf
/// loses without them, times its [weight](LossCurves::weight). A few may stay over that no leaf can use. Leaves that are instances of one mesh
/// have one number, and get more together: where that leaves a tenth of the budget or more they have too many instead,
/// so that some are to go.
///
/// Where it is known how much views show of each leaf, those that are hidden count for none: they are as coarse as they
/// can be, and others keep what they leave.
pub fn share_triangles(foliage: &Foliage, at_most: usize, curves: &LossCurves) -> Vec<usize> {
    let all = leaves_of(foliage);
    share_among(foliage, all.collect(), at_most, curves)
}

/// As [`share_triangles`], among some of the leaves; the others may keep all of theirs, which do not count.
pub(crate) fn share_among(
    foliage: &Foliage,
    leaves: Vec<LeafId>,
    at_most: usize,
    curves: &LossCurves,
) -> Vec<usize> {
    let fewest = |leaf| curves.hull(leaf)[0].triangles;
    let all = leaves_of(foliage);
    let mut shares: Vec<usize> = all.map(|leaf| foliage.triangles_of(leaf).len()).collect();
    let mut least = 0;
    for &leaf in &leaves {
        shares[leaf.index()] = match curves.may_go(leaf) {
            true => 0,
            false => fewest(leaf),
        };
        least += shares[leaf.index()];
    }
    let mut sharing = Sharing {
        foliage,
        curves,
        instances: instances(&leaves, curves),
        leaves,
        over: at_most.saturating_sub(least),
        shares,
    };
    sharing.along_hulls();
    if !is_met(at_most, at_most.saturating_sub(sharing.over)) {
        sharing.beyond_the_budget();
    }
    sharing.off_hulls();
    let shares = leaves_of(foliage).zip(sharing.shares);
    shares
        .map(|(leaf, share)| share.max(fewest(leaf)))
        .collect()
}

fn leaves_of(foliage: &Foliage) -> impl Iterator<Item = LeafId> + use<> {
    (0..foliage.leaves().len()).map(LeafId::from_index)
}

/// Leaves that are instances of one mesh, by the first of these.
fn instances(leaves: &[LeafId], curves: &LossCurves) -> BTreeMap<LeafId, Vec<LeafId>> {
    let mut instances: BTreeMap<LeafId, Vec<LeafId>> = BTreeMap::new();
    for leaf in leaves {
        if let Some(first) = curves.first_of_shape(*leaf) {
            instances.entry(first).or_default().push(*leaf);
        }
    }
    let by_first = instances.into_values().map(|alike| (alike[0], alike));
    by_first.collect()
}

/// Triangles that a leaf, and all instances of its mesh, may get more.
struct More {
    leaf: LeafId,
    from: usize,
    to: usize,
    /// The weight that each of these triangles saves.
    worth: f64,
}

/// A budget while it is shared.
struct Sharing<'a> {
    foliage: &'a Foliage,
    curves: &'a LossCurves,
    /// Leaves that share the budget; others keep all of theirs.
    leaves: Vec<LeafId>,
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
        let curves = self.curves;
        let mut more: Vec<More> = Vec::new();
        for &leaf in &self.leaves {
            let weight = match (self.is_alone(leaf), self.instances.get(&leaf)) {
                (true, _) => curves.weight(self.foliage, leaf),
                (false, Some(alike)) => {
                    let weights = alike.iter();
                    let weights = weights.map(|leaf| curves.weight(self.foliage, *leaf));
                    weights.sum::<f64>() / alike.len() as f64
                }
                (false, None) => continue,
            };
            let mut hull = Cow::from(curves.hull(leaf));
            if curves.may_go(leaf) {
                let gone = LossPoint {
                    triangles: 0,
                    loss: LOSS_OF_GONE,
                };
                let all: Vec<LossPoint> = iter::once(gone).chain(hull.iter().copied()).collect();
                hull = lower_hull(&all).into();
            }
            for pair in hull.windows(2) {
                let (from, to) = (pair[0].triangles, pair[1].triangles);
                let lost = pair[0].loss - pair[1].loss;
                more.push(More {
                    leaf,
                    from,
                    to,
                    worth: weight * lost / (to - from) as f64,
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
        let alone = self.leaves.iter().filter(|leaf| self.is_alone(**leaf));
        let mut by_area: Vec<LeafId> = alone.copied().collect();
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
