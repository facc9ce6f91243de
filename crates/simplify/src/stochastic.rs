//! Stochastic pruning: leaves go in a random order, and those that are left
//! grow alike.
//!
//! Cook and Halstead, Stochastic Pruning (2005; Stochastic Simplification of
//! Aggregate Detail, SIGGRAPH 2007). With u the share of the area that is left,
//! every survivor's area is multiplied by
//!
//! ```text
//! s(u) = 1 + w (1/u - 1)
//! ```
//!
//! With a weight w of 1 the area of the foliage is kept, with 0 no leaf grows.

use secateur_model::{Foliage, LeafId, PlantSkeleton, Random, RemovalOrder, Step};
use serde::{Deserialize, Serialize};

use crate::Error;
#[cfg(feature = "cli")]
use crate::option_numbers::share;
use crate::select::{Select, Selection, Steps, Task, refuse};

/// What can be chosen about stochastic pruning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct StochasticOptions {
    /// The seed of methods that choose at random.
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = 0))]
    pub seed: u64,
    /// stochastic: the share of the lost area that the survivors regain, 0 to 1.
    #[cfg_attr(feature = "cli", arg(long, value_name = "W", default_value_t = 1.0))]
    #[cfg_attr(feature = "cli", arg(allow_negative_numbers = true, value_parser = share))]
    pub area_weight: f64,
}

impl Default for StochasticOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            area_weight: 1.0,
        }
    }
}

impl Select for StochasticOptions {
    fn check(&self, _: &Foliage, _: Option<&PlantSkeleton>) -> Result<(), Error> {
        match (0.0..=1.0).contains(&self.area_weight) {
            true => Ok(()),
            false => refuse("area weight", self.area_weight, "from 0 to 1"),
        }
    }

    fn select(&self, task: &Task<'_>, _: &mut Steps<'_>) -> Result<Selection, Error> {
        let leaves = task.target.leaves_to_stop_at(task.foliage);
        Ok(Selection::unseen(simplify(task.foliage, leaves, self)))
    }
}

/// Removes leaves until `leaves` are left. Every prefix is the order to more
/// leaves. Takes n log n time.
///
/// # Panics
/// If the weight is not in 0 to 1.
pub fn simplify(foliage: &Foliage, leaves: usize, options: &StochasticOptions) -> RemovalOrder {
    let weight = options.area_weight;
    assert!(
        (0.0..=1.0).contains(&weight),
        "weight {weight} is not in 0 to 1"
    );
    let count = foliage.leaves().len();
    let shuffled = shuffled(count as u32, options.seed);
    // Summed from the last survivor up, so that no rounding is left at the end.
    let mut left_area = vec![0.0; count + 1];
    for (k, leaf) in shuffled.iter().enumerate().rev() {
        left_area[k] = left_area[k + 1] + foliage.leaf(*leaf).area();
    }
    let mut order = RemovalOrder::new(count as u32);
    for (k, &leaf) in shuffled
        .iter()
        .enumerate()
        .take(count.saturating_sub(leaves))
    {
        let grown = 1.0 + weight * (left_area[0] / left_area[k + 1] - 1.0);
        order.push_step(Step {
            removed: &[leaf],
            grown: &[],
            made: &[],
            survivors_area_scale: if grown.is_finite() { grown } else { 1.0 },
        });
    }
    order
}

/// The leaves in the order of their lots, of equals the first.
fn shuffled(count: u32, seed: u64) -> Vec<LeafId> {
    // Seeds near each other would otherwise share most of their lots.
    let start = Random::new(seed).bits();
    let mut lots = Random::new(start);
    let mut drawn: Vec<(u64, u32)> = (0..count).map(|index| (lots.bits(), index)).collect();
    drawn.sort_unstable();
    let name = |(_, index): &(u64, u32)| LeafId::from_index(*index as usize);
    drawn.iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::{LeafTriangle, Lod};

    /// Leaf k has area k.
    fn foliage(count: u32) -> Foliage {
        let mut foliage = Foliage::default();
        for k in 1..=count {
            let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * f64::from(k)];
            foliage
                .push_leaf(&[LeafTriangle::plain(corners)], None)
                .unwrap();
        }
        foliage
    }

    fn with(seed: u64, area_weight: f64) -> StochasticOptions {
        StochasticOptions { seed, area_weight }
    }

    #[test]
    fn the_area_is_kept_at_every_level() {
        let foliage = foliage(20);
        let order = simplify(&foliage, 0, &with(7, 1.0));
        for steps in 0..20 {
            let lod = Lod::after(&order, steps);
            let area: f64 = lod
                .leaves()
                .map(|(leaf, s)| s * foliage.leaf(leaf).area())
                .sum();
            assert_eq!(lod.leaf_count(), 20 - steps);
            assert!((area - 210.0).abs() < 1e-9, "{area}");
        }
        assert_eq!(Lod::after(&order, 20).leaf_count(), 0);
    }

    /// Of areas 1 and 2 one goes: the other is 2/3 or 1/3 of all, so it grows
    /// by 1/2 or 2 of itself, of which the weight takes its share.
    #[test]
    fn the_weight_lies_between_no_growth_and_all_of_it() {
        let scale = |weight| {
            let order = simplify(&foliage(2), 1, &with(3, weight));
            Lod::after(&order, 1).max_area_scale()
        };
        let all = scale(1.0);
        assert!([1.5, 3.0].iter().any(|s| (s - all).abs() < 1e-12), "{all}");
        assert_eq!(scale(0.0), 1.0);
        assert!((scale(0.25) - (1.0 + 0.25 * (all - 1.0))).abs() < 1e-12);
    }

    #[test]
    fn seeds_differ_and_prefixes_agree() {
        let foliage = foliage(100);
        let order = |seed, leaves| simplify(&foliage, leaves, &with(seed, 1.0));
        assert_eq!(order(1, 10), order(1, 10));
        assert_ne!(order(1, 10).removed(), order(2, 10).removed());
        let mut coarse = order(1, 10);
        coarse.truncate(50);
        assert_eq!(coarse, order(1, 50));
        assert!(order(1, 200).is_empty());
    }

    #[test]
    fn leaves_without_area_do_not_grow_without_bound() {
        let mut flat = foliage(1);
        flat.push_leaf(&[LeafTriangle::plain([DVec3::ZERO; 3])], None)
            .unwrap();
        for seed in 0..8 {
            let lod = Lod::after(&simplify(&flat, 1, &with(seed, 1.0)), 1);
            assert_eq!(lod.max_area_scale(), 1.0);
        }
    }
}
