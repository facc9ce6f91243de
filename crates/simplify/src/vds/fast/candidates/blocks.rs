//! A block: what bounds the costs of sixteen leaves at once, until it is evaluated
//! again.

use super::super::switches::{Mechanism, is_on};
use super::block_filter::Bounds;
use super::epochs::Now;
use super::excess::Excesses;
use super::rounding::Rounding;
use super::widths::Width;

/// A leaf's figures against the deviations of an epoch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figures {
    /// The sum over the views of `g d`: the leaf's deltas along the signs of the deviations.
    pub along: f32,
    pub excess: f32,
    /// Sum of the deltas without their signs.
    pub n: f32,
    /// What was added up for them: sum of the parts' sizes.
    pub magnitude: f32,
    /// The largest delta without its sign.
    pub widest: f32,
    pub background_px: u32,
}

/// A leaf by which a block is known: what its deltas sum to with the signs of
/// the deviations, exactly, its rank and its number.
pub(super) type First = (i64, u32, u32);

pub(super) const NO_FIRST: First = (i64::MAX, u32::MAX, 0);

#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub epoch: u16,
    least_along_solid: f32,
    least_along_open: f32,
    least: f32,
    least_open: f32,
    largest: f32,
    least_n: f32,
    largest_n: f32,
    magnitude: f32,
    pub widest: f32,
    /// The most pixels that one of them would hand to the background.
    largest_px: u32,
    /// How far bounds may be off, but for the background's drift: those of solid
    /// leaves by `along`, and the others.
    rounding_solid: f32,
    rounding: f32,
    /// By lane: leaves there are, and those whose deltas have changed since they
    /// were looked at, by no more than `slack` each.
    pub present: u16,
    pub outdated: u16,
    slack: f32,
    /// Which signs of the deviations `first` is for.
    pub signs: u32,
    /// The least of its solid leaves.
    pub first: First,
}

impl Block {
    pub(super) fn empty(epoch: usize, signs: u32) -> Self {
        Self {
            epoch: epoch as u16,
            least_along_solid: f32::INFINITY,
            least_along_open: f32::INFINITY,
            least: f32::INFINITY,
            least_open: f32::INFINITY,
            largest: f32::NEG_INFINITY,
            least_n: f32::INFINITY,
            largest_n: 0.0,
            magnitude: 0.0,
            widest: 0.0,
            largest_px: 0,
            rounding_solid: 0.0,
            rounding: 0.0,
            present: 0,
            outdated: 0,
            slack: 0.0,
            signs,
            first: NO_FIRST,
        }
    }

    pub(super) fn bounds(&self) -> Bounds {
        // Beyond 16 bits nothing is known.
        let px = u16::try_from(self.largest_px);
        let unless_wide = |bound: f32| match px {
            Ok(_) => bound - self.rounding - self.slack,
            Err(_) => f32::NEG_INFINITY,
        };
        let unless_off = |mechanism, bound: f32| match is_on(mechanism) {
            true => bound,
            false => f32::NEG_INFINITY,
        };
        let solid = self.least_along_solid - self.rounding_solid - self.slack;
        Bounds {
            solid: unless_off(Mechanism::FilterBySignedSum, solid),
            open: unless_off(
                Mechanism::FilterBySignedSum,
                unless_wide(self.least_along_open),
            ),
            n: unless_off(Mechanism::FilterBySize, unless_wide(self.least_n)),
            epoch: self.epoch,
            largest_px: px.unwrap_or(u16::MAX),
        }
    }

    /// Takes a leaf's new figures into account.
    #[inline]
    pub(super) fn include(&mut self, figures: &Figures, rounding: Rounding) {
        if figures.background_px > 0 {
            self.least_along_open = self.least_along_open.min(figures.along);
            self.least_open = self.least_open.min(figures.excess);
            self.largest_px = self.largest_px.max(figures.background_px);
        } else {
            self.least_along_solid = self.least_along_solid.min(figures.along);
        }
        self.least = self.least.min(figures.excess);
        self.largest = self.largest.max(figures.excess);
        self.least_n = self.least_n.min(figures.n);
        self.largest_n = self.largest_n.max(figures.n);
        self.magnitude = self.magnitude.max(figures.magnitude);
        self.widest = self.widest.max(figures.widest);
        self.allow_for(rounding);
    }

    fn allow_for(&mut self, rounding: Rounding) {
        let px = self.largest_px as f32;
        self.rounding_solid = rounding.of_f32(self.magnitude);
        self.rounding = self.rounding_solid + rounding.of_background(px);
    }

    /// Widens the bounds by how much the deltas of the leaf in this lane changed in all, without signs.
    #[inline]
    pub(super) fn outdate(&mut self, lane: usize, change: f32) {
        self.outdated |= 1 << lane;
        self.slack = (self.slack + change) * (1.0 + 4.0 * f32::EPSILON);
    }

    /// None of its leaves is outdated any more.
    #[inline]
    pub(super) fn is_up_to_date(&mut self) {
        self.outdated = 0;
        self.slack = 0.0;
    }

    /// All its leaves were evaluated.
    #[inline]
    pub(super) fn renew(
        &mut self,
        epoch: usize,
        found: &Excesses,
        largest_px: u32,
        rounding: Rounding,
    ) {
        (self.least, self.largest) = (found.least, found.largest);
        self.least_open = found.least_open;
        self.least_along_solid = found.least_along_solid;
        self.least_along_open = found.least_along_open;
        (self.least_n, self.largest_n) = (found.least_n, found.largest_n);
        (self.magnitude, self.widest) = (found.magnitude, found.widest);
        self.largest_px = largest_px;
        self.epoch = epoch as u16;
        self.allow_for(rounding);
    }

    /// What the deltas of its solid leaves sum to at least, with the signs of
    /// its epoch, is known exactly.
    #[inline]
    pub(super) fn know_solid(&mut self, least_along: i64) {
        self.least_along_solid = match least_along {
            i64::MAX => f32::INFINITY,
            along => along as f32,
        };
    }

    /// How far the excesses of its leaves in f32 may be off by rounding.
    #[inline]
    pub(super) fn f32_rounding(&self, rounding: Rounding) -> f32 {
        rounding.of_f32(self.magnitude)
    }

    #[inline]
    fn margin(&self, now: &Now<'_>) -> f32 {
        self.rounding + self.slack + self.moved(now)
    }

    /// How far the background's terms have moved since it was evaluated, for any
    /// of its open leaves and but for rounding.
    #[inline]
    fn moved(&self, now: &Now<'_>) -> f32 {
        match self.largest_px {
            0 => 0.0,
            px => px as f32 * now.epochs.drifted(self.epoch.into()),
        }
    }

    /// Whether the excesses of its leaves, or of its open ones, are all above a
    /// limit: by `n`, by `sum g d`, and by what they were when they were
    /// evaluated.
    pub(super) fn is_above(
        &self,
        limit: f32,
        now: &Now<'_>,
        widths: &[Width],
        only_open: bool,
    ) -> bool {
        let epoch = usize::from(self.epoch);
        let margin = self.margin(now);
        let along_open = self.least_along_open - margin;
        let along_solid = self.least_along_solid - self.rounding_solid - self.slack;
        let (along, least) = match only_open {
            true => (along_open, self.least_open),
            false => (along_solid.min(along_open), self.least),
        };
        let least = least - margin;
        is_on(Mechanism::BlockBySize) && self.least_n - now.twice_deviation_sum - margin > limit
            || is_on(Mechanism::BlockBySignedSum) && now.epochs.flipped(epoch) + along > limit
            || is_on(Mechanism::BlockByLoss)
                && least > limit
                && least - now.epochs.lost_within(epoch, widths) > limit
    }

    /// Has its bounds stand against the current deviations, with less to spare,
    /// instead of those of its epoch, which have the same signs.
    pub(super) fn rebase(&mut self, now: &Now<'_>, widths: &[Width]) {
        let epoch = usize::from(self.epoch);
        debug_assert!(now.epochs.is_of_this_run(epoch), "signs are the same");
        let moved = self.moved(now);
        let (lost, risen) = (
            now.epochs.lost_within(epoch, widths),
            now.epochs.risen(epoch),
        );
        // Of the sums below.
        let spare = (self.magnitude + moved + lost + risen) * (4.0 * f32::EPSILON);
        self.least_along_solid -= spare;
        self.least_along_open -= moved + spare;
        self.least -= moved + lost + spare;
        self.least_open -= moved + lost + spare;
        self.largest += moved + risen + spare;
        self.least_n -= moved + spare;
        self.largest_n += moved + spare;
        self.epoch = now.epochs.current() as u16;
    }

    /// Not below the excess of any of its leaves.
    #[inline]
    pub(super) fn ceiling(&self, now: &Now<'_>) -> f32 {
        let since = self.largest + now.epochs.risen(self.epoch.into());
        self.largest_n.min(since) + self.margin(now)
    }

    /// Not below `n` of any of its leaves, when nothing is known of the
    /// background's drift but that it was less then.
    #[inline]
    pub(super) fn top(&self) -> Top {
        Top {
            largest_n: self.largest_n + self.rounding + self.slack,
            largest_px: self.largest_px as f32,
        }
    }
}

/// What rules out a block's leaves from being the dearest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    largest_n: f32,
    largest_px: f32,
}

impl Top {
    /// Not below the excess of any of its leaves; `drift` the background's
    /// since the last rebuild.
    #[inline(always)]
    pub(super) fn ceiling(&self, drift: f32) -> f32 {
        self.largest_n + self.largest_px * drift
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::super::counts::Counts;
    use super::super::epochs::{Epochs, along_signs};
    use super::*;
    use crate::lg::LgTable;
    use secateur_raster::AreaTable;

    const VIEWS: usize = 4;
    const PIXELS_PER_VIEW: u32 = 1 << 16;

    /// A leaf and what it would hand to the background, by view.
    #[derive(Clone, Debug)]
    struct Leaf {
        others: Vec<i64>,
        revealed: Vec<u32>,
    }

    impl Leaf {
        fn background_px(&self) -> u32 {
            self.revealed.iter().sum()
        }

        /// Its deltas but for what the background's total takes away, and that.
        fn deltas(&self, counts: &Counts<'_>) -> (Vec<i64>, Vec<i64>) {
            let rise = counts.background_rise(self.background_px()) as i64;
            let lg_after = counts.target(0).lg_total + rise;
            let views = self.others.iter().zip(&self.revealed).zip(0..);
            let gained = views.map(|((other, r), view)| match r {
                0 => *other,
                r => other + counts.background_gain(view, *r) - i64::from(*r) * lg_after,
            });
            let risen = counts.areas(0).iter().map(|a| i64::from(*a) * rise);
            (gained.collect(), risen.collect())
        }

        fn all_deltas(&self, counts: &Counts<'_>) -> Vec<i64> {
            let (gained, risen) = self.deltas(counts);
            gained.iter().zip(&risen).map(|(d, r)| d - r).collect()
        }

        fn figures(&self, counts: &Counts<'_>, epochs: &Epochs) -> Figures {
            let (gained, risen) = self.deltas(counts);
            let deltas = self.all_deltas(counts);
            let then = epochs.deviations(epochs.current());
            let px = self.background_px();
            let size = |terms: &[i64]| terms.iter().map(|d| d.abs()).sum::<i64>() as f32;
            Figures {
                along: along_signs(&deltas, then) as f32,
                excess: excess(then, &deltas) as f32,
                n: size(&deltas),
                magnitude: size(&gained) + size(&risen),
                widest: deltas.iter().map(|d| d.abs()).max().unwrap() as f32,
                background_px: px,
            }
        }
    }

    fn excess(deviations: &[i64], deltas: &[i64]) -> i64 {
        let terms = deviations.iter().zip(deltas);
        terms.map(|(d, x)| (d + x).abs() - d.abs()).sum()
    }

    fn leaf() -> impl Strategy<Value = Leaf> {
        let others = prop::collection::vec(-30_000_000i64..30_000_000, VIEWS);
        let revealed = prop_oneof![Just(vec![0; VIEWS]), prop::collection::vec(0u32..6, VIEWS),];
        (others, revealed).prop_map(|(others, revealed)| Leaf { others, revealed })
    }

    proptest! {
        #[test]
        fn bounds_hold_also_against_a_later_epoch(
            first in prop::collection::vec(-400_000_000i64..400_000_000, VIEWS),
            steps in prop::collection::vec(
                (0..VIEWS, -15_000_000i64..15_000_000, 0..VIEWS, -500i32..900), 2..60),
            leaf in leaf(),
            rebases in prop::collection::vec(0usize..60, 1..4),
        ) {
            let table = LgTable::new();
            let areas = (0..VIEWS as u32).flat_map(|view| {
                let background_px = 9000 + 2000 * view;
                [background_px, PIXELS_PER_VIEW - background_px]
            });
            let areas = AreaTable::from_rows(1, areas.collect());
            let mut counts = Counts::new(&areas, PIXELS_PER_VIEW, &table);
            let mut deviations = first;
            let mut epochs = Epochs::new(&deviations, counts.background_drift());
            let rounding = Rounding::new(VIEWS, PIXELS_PER_VIEW as usize);
            let mut block = Block::empty(epochs.current(), 0);
            block.include(&leaf.figures(&counts, &epochs), rounding);
            let widths = leaf.all_deltas(&counts);
            let widths: Vec<Width> =
                widths.iter().map(|d| Width::ZERO.with(*d as f32)).collect();
            for (step, (view, by, view_of_background, px)) in steps.into_iter().enumerate() {
                let total: i64 = deviations.iter().map(|d| d.abs()).sum();
                let now = Now::new(&epochs, total);
                if rebases.contains(&step) && epochs.is_of_this_run(block.epoch.into()) {
                    block.rebase(&now, &widths);
                }
                deviations[view] += by;
                // Never all of it.
                if i64::from(counts.areas(0)[view_of_background]) + i64::from(px) > 500 {
                    counts.hand_to_background(view_of_background, px);
                }
                epochs.begin(&deviations, counts.background_drift());
                let total: i64 = deviations.iter().map(|d| d.abs()).sum();
                let now = Now::new(&epochs, total);
                let excess = excess(&deviations, &leaf.all_deltas(&counts)) as f32;
                prop_assert!(!block.is_above(excess, &now, &widths, false));
                let is_open = leaf.background_px() > 0;
                prop_assert!(
                    !is_open || !block.is_above(excess, &now, &widths, true)
                );
                prop_assert!(!block.bounds().is_excluded(excess, &now));
                prop_assert!(block.ceiling(&now) >= excess);
            }
        }
    }
}
