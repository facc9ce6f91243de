//! Leaves that would hang in the air go.
//!
//! A pass after leaves were chosen, and again after sizes were fitted: leaves that are further than any
//! was from wood at first both from the wood that is left and from lower leaves that rest on it are
//! taken away. Before sizes are fitted others stay in their place, so that the budget is used.

use secateur_model::{Foliage, LeafId, Lod, RemovalOrder, Step};

use crate::wood::SortedWood;

/// How often the order is cut anew, each time with as many triangles more as hang.
const MOST_CUTS: usize = 4;

/// Wood that leaves hang on.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldBy {
    wood: SortedWood,
    largest_gap: f64,
}

impl HeldBy {
    /// What is left of the wood, and how far from it, or from a lower leaf that rests on it, a leaf may be, in world
    /// units.
    pub fn new(wood: &Foliage, largest_gap: f64) -> Self {
        Self {
            wood: SortedWood::of(wood),
            largest_gap,
        }
    }

    /// This wood with another gap.
    #[must_use]
    pub fn with_gap(&self, largest_gap: f64) -> Self {
        Self {
            largest_gap,
            ..self.clone()
        }
    }

    /// How far from the wood, or from a lower leaf that rests on it, a leaf may be, in world units.
    pub fn largest_gap(&self) -> f64 {
        self.largest_gap
    }

    /// For each leaf the lowest leaf that it hangs on in the air; nothing where this wood holds it: see
    /// [`hanging_on`](crate::wood::hanging_on).
    pub(crate) fn lowest(&self, leaves: &Foliage) -> Vec<Option<usize>> {
        self.wood.hanging(leaves, self.largest_gap)
    }

    /// The leaves of a level that hang in the air, by their names.
    pub fn hanging(&self, leaves: &Foliage, lod: &Lod) -> Vec<LeafId> {
        let all = lod.all_leaves().zip(self.lowest(&lod.foliage(leaves)));
        all.filter_map(|((leaf, _), lowest)| lowest.map(|_| leaf))
            .collect()
    }
}

/// Cuts an order where this many triangles are left, and has leaves go that then hang in the air:
/// more of the others stay for them, so that as many triangles as asked for are left. Leaves that hang
/// go last, one a step. At least the first `least` steps stay. The number of steps before those of hanging leaves.
pub(crate) fn cut(
    order: &mut RemovalOrder,
    leaves: &Foliage,
    held_by: Option<&HeldBy>,
    triangles_at_most: Option<usize>,
    least: usize,
) -> usize {
    let steps_to = |at_most: Option<usize>| {
        at_most.map_or(order.len(), |at_most| {
            order.steps_to_triangles(leaves, at_most).max(least)
        })
    };
    let Some(held_by) = held_by else {
        let steps = steps_to(triangles_at_most);
        order.truncate(steps);
        return steps;
    };
    let mut best: Option<(usize, Vec<LeafId>)> = None;
    let mut at_most = triangles_at_most;
    for _ in 0..MOST_CUTS {
        let steps = steps_to(at_most);
        if best.as_ref().is_some_and(|(known, _)| *known == steps) {
            break;
        }
        let lod = Lod::after(order, steps);
        let hanging = held_by.hanging(leaves, &lod);
        let triangles_of = |leaf: &LeafId| match leaf.index().checked_sub(leaves.leaves().len()) {
            None => leaves.triangles_of(*leaf).len(),
            Some(made) => order.made()[made].triangles.len(),
        };
        let of_hanging: usize = hanging.iter().map(triangles_of).sum();
        let all_triangles: usize = lod.all_leaves().map(|(leaf, _)| triangles_of(&leaf)).sum();
        let is_too_much = triangles_at_most.is_some_and(|most| all_triangles - of_hanging > most);
        if is_too_much && best.is_some() {
            break;
        }
        best = Some((steps, hanging));
        at_most = triangles_at_most.map(|at_most| at_most + of_hanging);
        if at_most.is_none() || of_hanging == 0 {
            break;
        }
    }
    let (steps, hanging) = best.expect("the first cut is always taken");
    order.truncate(steps);
    push_removals(order, &hanging);
    steps
}

/// A step more for each of these leaves.
pub(crate) fn push_removals(order: &mut RemovalOrder, leaves: &[LeafId]) {
    let survivors_area_scale = order.survivors_area_scale_after(order.len());
    for &leaf in leaves {
        order.push_step(Step {
            removed: &[leaf],
            grown: &[],
            made: &[],
            survivors_area_scale,
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    use super::*;

    /// Leaves of one triangle beside a wall of wood at x = 0, this far from it.
    fn leaves(distances: &[f64]) -> Foliage {
        let mut foliage = Foliage::default();
        for (index, x) in distances.iter().enumerate() {
            let at = DVec3::new(*x, index as f64, 0.0);
            let corners = [at, at + DVec3::X, at + DVec3::X + 0.5 * DVec3::Z];
            foliage
                .push_leaf(&[LeafTriangle::plain(corners)], None)
                .unwrap();
        }
        foliage
    }

    fn wall() -> HeldBy {
        let corners = [-9.0 * DVec3::Y, 99.0 * DVec3::Y, 99.0 * DVec3::Z];
        let mut wood = Foliage::default();
        wood.push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
        HeldBy::new(&wood, 0.9)
    }

    fn names(numbers: &[u32]) -> Vec<LeafId> {
        numbers.iter().map(|n| LeafId::new(*n).unwrap()).collect()
    }

    #[test]
    fn leaves_that_are_further_off_than_allowed_hang() {
        let foliage = leaves(&[0.0, 0.8, 1.5, 0.5]);
        let hanging = wall().hanging(&foliage, &Lod::original(4));
        assert_eq!(hanging, names(&[3]));
        let nothing = HeldBy::new(&Foliage::default(), 0.9);
        assert_eq!(nothing.hanging(&foliage, &Lod::original(4)).len(), 4);
    }

    /// Of six leaves three may stay; 5 and 6 hang, so that 3 stays, which the order takes away last.
    #[test]
    fn others_stay_for_those_that_hang() {
        let foliage = leaves(&[0.0, 0.0, 0.0, 0.0, 3.0, 3.0]);
        let mut order = RemovalOrder::new(6);
        for leaf in names(&[1, 2, 3, 4]) {
            order.push(leaf, &[]);
        }
        let mut three = order.clone();
        assert_eq!(cut(&mut three, &foliage, Some(&wall()), Some(3), 0), 1);
        assert_eq!(three.removed(), names(&[1, 5, 6]));
        // As many as were asked for, of leaves that hang on something.
        let left = Lod::after(&three, three.len());
        assert!(left.leaves().map(|(leaf, _)| leaf).eq(names(&[2, 3, 4])));
        // Without a bound on triangles the whole order is made.
        cut(&mut order, &foliage, Some(&wall()), None, 0);
        assert_eq!(order.removed(), names(&[1, 2, 3, 4, 5, 6]));
    }
}
