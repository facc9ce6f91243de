//! What runs to several targets over one foliage share.
//!
//! An order of removals does not depend on where it ends, so a run to fewer triangles goes on where
//! one to more ended, and one to more takes the beginning of it: as long as their leaves became
//! coarser alike before. What is made is the same, bit for bit, as by runs of their own; but not in a
//! [search](Shared::for_search).

use secateur_raster::ViewSet;
use secateur_raster::measure::vmi::Vmi;

use crate::auto_views::ChosenViews;
use crate::coarsen::{Coarse, LossCurves};
use crate::fit::DrawnOriginals;
use crate::select::{Begun, Selection, Task};
use crate::{Amount, Error, Target, Views};

/// In a search leaves become coarser for a rounded target: the next of eight from one number of triangles to twice as
/// many, at most 9 % more. Levels between two such targets share an order. A default chain of `sap_birch_hex_9k` takes
/// 46 instead of 69 s of processor time by that, one of `ez_bush2` 20 instead of 18.
const TARGETS_A_DOUBLING: f64 = 8.0;

/// A plant of fewer leaves than this keeps the target it was given: 9 % more triangles can be a whole leaf, which is then
/// removed while the others stay as fine as they were. Of nine fronds of 1,024 triangles one went at the first step, and
/// a palm got no lighter level above 32 pixels. Other numbers than 100 were not tried.
const FEWEST_ROUNDED: usize = 100;

/// In a search an order of leaves that become no coarser goes on to this share of the triangles that are asked for: to
/// begin takes longer than to go on.
const SEARCHED_SHARE: f64 = 0.5;

/// What earlier runs over the same foliage, by the same options but for the target, found.
#[derive(Debug, Default)]
pub struct Shared {
    pub(crate) resolution: Option<(u32, String)>,
    /// What [`Views::Auto`] stands for with a budget of triangles.
    pub(crate) views: Option<ChosenViews>,
    pub(crate) curves: Option<LossCurves>,
    /// What the views showed of the original.
    pub(crate) original: Option<(ViewSet, Vmi)>,
    /// What the views in which sizes are fitted show of the original.
    pub(crate) originals: Option<DrawnOriginals>,
    found: Vec<KeptOrder>,
    is_search: bool,
    /// How often the gap that leaves may hang in the air was doubled for the level before.
    pub(crate) gap_doubled: u32,
}

/// An order, and what it is of.
#[derive(Clone, Debug)]
pub(crate) struct KeptOrder {
    /// The views that it was chosen from.
    pub(crate) views: Views,
    /// How many triangles each leaf could keep; nothing where they kept all.
    pub(crate) shares: Option<Vec<usize>>,
    pub(crate) coarse: Option<Coarse>,
    pub(crate) begun: Begun,
}

impl KeptOrder {
    /// Whether the order goes as far as a run of this task would.
    pub(crate) fn reaches(&self, task: &Task<'_>) -> bool {
        let order = &self.begun.order;
        let left = order.leaf_count() as usize - order.len();
        matches!(task.target, Target::Triangles(_) | Target::Leaves(_))
            && left <= task.target.fewest_leaves(task.foliage)
    }

    /// All of it, as a method that chose it again would hand it over.
    pub(crate) fn selection(&self) -> Selection {
        Selection {
            order: self.begun.order.clone(),
            costs: self.begun.costs.clone(),
            shown: None,
            is_at_max_error: false,
        }
    }
}

impl Shared {
    /// For many levels of about the same size: their leaves become coarser alike, for a target near to their own.
    pub fn for_search() -> Self {
        Self {
            is_search: true,
            ..Self::default()
        }
    }

    /// The target that the leaves of a plant become coarser for; `leaf_count` is how many it has.
    pub(crate) fn coarsening_target(&self, target: Target, leaf_count: usize) -> Target {
        let is_rounded = self.is_search && leaf_count >= FEWEST_ROUNDED;
        match target {
            Target::Triangles(Amount::Count(count)) if is_rounded => {
                let doubles = (count.max(1) as f64).log2();
                let next = (doubles * TARGETS_A_DOUBLING).ceil() / TARGETS_A_DOUBLING;
                Target::triangles(next.exp2().round() as u64)
            }
            target => target,
        }
    }

    /// The target that an order is chosen for. `is_as_coarse` says whether leaves become no coarser for one of fewer
    /// triangles.
    pub(crate) fn selection_target(
        &self,
        target: Target,
        is_as_coarse: impl FnOnce(Target) -> Result<bool, Error>,
    ) -> Result<Target, Error> {
        let Target::Triangles(Amount::Count(count)) = target else {
            return Ok(target);
        };
        if !self.is_search {
            return Ok(target);
        }
        let of = |share: f64| Target::triangles((count as f64 * share) as u64);
        let far = of(SEARCHED_SHARE);
        Ok(match is_as_coarse(far)? {
            true => far,
            // Fewer are asked of other leaves.
            false => of((-TARGETS_A_DOUBLING.recip()).exp2()),
        })
    }

    /// How often the gap that leaves may hang in the air is doubled at least: in a search once less than for the level
    /// before.
    pub(crate) fn least_gap_doubled(&self) -> u32 {
        match self.is_search {
            true => self.gap_doubled.saturating_sub(1),
            false => 0,
        }
    }

    /// Takes out the order of leaves that became coarser in this way, chosen from these views.
    pub(crate) fn take(&mut self, views: &Views, shares: &Option<Vec<usize>>) -> Option<KeptOrder> {
        let is_it = |found: &KeptOrder| found.views == *views && found.shares == *shares;
        let known = self.found.iter().position(is_it);
        known.map(|index| self.found.swap_remove(index))
    }

    /// Forgets the orders: those of later levels begin otherwise.
    pub fn forget_orders(&mut self) {
        self.found.clear();
    }

    /// Keeps an order for later runs.
    pub(crate) fn keep(&mut self, found: KeptOrder) {
        self.found.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_a_search_targets_near_each_other_have_leaves_as_coarse() {
        let alone = Shared::default();
        assert_eq!(
            alone.coarsening_target(Target::triangles(950), 100),
            Target::triangles(950)
        );
        let search = Shared::for_search();
        let coarsening = |count| search.coarsening_target(Target::triangles(count), 100);
        // 2^10 and the eighths of a double before it: 939 and 861.
        for count in [940, 950, 1_000, 1_024] {
            assert_eq!(coarsening(count), Target::triangles(1_024));
        }
        assert_eq!(coarsening(930), Target::triangles(939));
        assert_eq!(coarsening(0), Target::triangles(1));
        let leaves = Target::leaves(7);
        assert_eq!(search.coarsening_target(leaves, 100), leaves);
        let of_few = search.coarsening_target(Target::triangles(930), 99);
        assert_eq!(of_few, Target::triangles(930));
    }

    #[test]
    fn in_a_search_an_order_goes_on_beyond_its_target() {
        let target = Target::triangles(1_000);
        let never = |_| -> Result<bool, Error> { unreachable!("it is no search") };
        let alone = Shared::default().selection_target(target, never);
        assert_eq!(alone.unwrap(), target);
        let search = Shared::for_search();
        let to = |is_as_coarse| search.selection_target(target, |_| Ok(is_as_coarse));
        assert_eq!(to(true).unwrap(), Target::triangles(500));
        assert_eq!(to(false).unwrap(), Target::triangles(917));
    }
}
