//! What leaves of a plant hang on: wood that bears them stays, and what would still hang in the air goes.

use secateur_model::{Foliage, LeafId, Lod};

use super::{Budget, WholePlant, WoodLevel};
use crate::hanging_leaves::HeldBy;

/// What a leaf that hangs in the air loses, as a share of what the views show of leaves for each
/// triangle of the budget. It goes, and another stays for it, which shows less.
const HANGING_WEIGHT: f64 = 0.7;

/// More wood that bears leaves, and leaves that go since they hang in the air, may together take this
/// share of the triangles of a level. `ez_oak_20k` at a tenth needs .08 to hold all as at first.
const MOST_HOLDING: f64 = 0.1;

/// The share of the triangles of a level's leaves that may go since they hang in the air: they are at
/// the outline. Where .043 went, FLIP of a willow at a tenth was .0201 instead of .0110;
/// where .019 did, of `ez_oak_20k`, .0239 instead of .0227.
const MOST_GOING: f64 = 0.02;

/// How far leaves may hang in the air where that is too little: less than this power of two times as
/// far as at first.
const MOST_DOUBLED: u32 = 8;

impl WholePlant<'_> {
    /// The wood of a plant of a budget, with what its leaves are to hang on: wood that bears them
    /// within the largest distance that one has from the wood, or else within twice of it, four times
    /// and so on, where that takes at most [`MOST_HOLDING`] of the budget. `sketch` are leaves that are
    /// left beside `plain` wood. How often that distance was doubled, at least `least_doubled` times, comes last.
    pub(super) fn held(
        &self,
        plain: WoodLevel,
        sketch: &Lod,
        budget: Budget,
        least_doubled: u32,
    ) -> (WoodLevel, Option<HeldBy>, u32) {
        let triangles = budget.triangles;
        let most = (MOST_HOLDING * triangles as f64) as usize;
        let of_leaves = triangles.saturating_sub(plain.triangles);
        let most_going = (MOST_GOING * of_leaves as f64) as usize;
        let left = sketch.foliage(&self.leaves);
        let sketch = (sketch, &left);
        let Some(beside) = self.held_by(&plain.lod) else {
            return (plain, None, MOST_DOUBLED);
        };
        for doubled in least_doubled..MOST_DOUBLED {
            let largest_gap = self.levels.leaf_gap() * f64::from(1 << doubled);
            let beside = beside.with_gap(largest_gap);
            let mut hanging_px = vec![0.0; self.leaves.leaves().len()];
            let hanging = self.add_hanging(sketch, &beside, triangles, &mut hanging_px);
            if hanging == 0 {
                return (plain, Some(beside), doubled);
            }
            let wood = self.wood_of(&hanging_px, budget);
            let more = wood.triangles.saturating_sub(plain.triangles);
            let held_by = match wood.lod == plain.lod {
                true => beside,
                false => match self.held_by(&wood.lod) {
                    Some(held_by) => held_by.with_gap(largest_gap),
                    None => break,
                },
            };
            if more <= most {
                let going = self.add_hanging(sketch, &held_by, triangles, &mut hanging_px);
                if more + going <= most && going <= most_going {
                    return (wood, Some(held_by), doubled);
                }
            }
        }
        (plain, None, MOST_DOUBLED)
    }

    /// For leaves that hang in the air in a plant of `triangles` triangles: adds to each, in `hanging_px`, the
    /// pixels of all leaves that rest on it. Returns the number of their triangles.
    fn add_hanging(
        &self,
        (leaves, left): (&Lod, &Foliage),
        held_by: &HeldBy,
        triangles: usize,
        hanging_px: &mut [f64],
    ) -> usize {
        let lowest = held_by.lowest(left);
        let originals = leaves.leaves().map(|(leaf, _)| leaf.index());
        let donors = leaves.made().map(|(made, _)| made.donor.index());
        let names: Vec<usize> = originals.chain(donors).collect();
        let px_a_triangle = HANGING_WEIGHT * self.px_a_leaf_triangle(triangles);
        let mut hanging = 0;
        for (leaf, lowest) in lowest.into_iter().enumerate() {
            if let Some(lowest) = lowest {
                let count = left.triangles_of(LeafId::from_index(leaf)).len();
                hanging_px[names[lowest]] += px_a_triangle * count as f64;
                hanging += count;
            }
        }
        hanging
    }

    /// What leaves hang on beside this wood; nothing where there is none.
    fn held_by(&self, wood: &Lod) -> Option<HeldBy> {
        let gap = self.levels.leaf_gap();
        (wood.leaf_count() > 0).then(|| HeldBy::new(&wood.foliage(&self.wood), gap))
    }
}
