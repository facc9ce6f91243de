//! The search for the cheapest and the dearest leaf: blocks that the filter lets
//! through, then what each block knows, then its leaves one by one.

use super::super::deltas::Sight;
use super::super::switches::{Mechanism, is_on};
#[cfg(test)]
use super::WAITING;
use super::drift::{drift_now, drift_then};
use super::epochs::Now;
use super::excess::{Excesses, LANES};
use super::limits::Limits;
use super::{Candidates, FIRST_GROUP, Found, NOWHERE, STEADY};

/// Tops that are looked at together.
const TOPS_AT_ONCE: usize = 32;

impl Candidates {
    fn cost(&mut self, sight: Sight<'_>, leaf: u32) -> i64 {
        sight.deltas(leaf, &mut self.row);
        let terms = self.row.iter().zip(&self.deviations);
        terms.map(|(d, deviation)| (d + deviation).abs()).sum()
    }

    /// A cost's excess over the sum of the deviations; MAX and MIN stand for
    /// costs beyond all others.
    #[inline]
    fn excess(&self, cost: i64) -> f32 {
        match cost {
            i64::MAX => f32::INFINITY,
            i64::MIN => f32::NEG_INFINITY,
            cost => (cost - self.deviation_sum) as f32,
        }
    }

    /// The leaf of least cost; of equals that of the lowest rank. If all of them
    /// cost more than a leaf of another shard, any or [`Found::NONE`].
    pub(in super::super) fn cheapest(&mut self, sight: Sight<'_>, limits: &Limits) -> Found {
        let mut best = Found::NONE;
        let mut runner_up = best;
        self.cheapest_with_effect = Found::NONE;
        self.consider_outside(sight, &mut best, &mut runner_up);
        // Mostly near the least.
        for leaf in self.seeds {
            if is_on(Mechanism::SeedCheapest) && self.place_of[leaf as usize] < FIRST_GROUP {
                self.consider(sight, leaf, &mut best, &mut runner_up);
            }
        }
        let mut limit = self.least_excess(best, limits);
        for group in 0..self.filter.groups() {
            let now = Now::new(&self.epochs, self.deviation_sum);
            for index in self.filter.may_contain(group, limit, &now) {
                limit = self.search_block(sight, index, (limits, limit), &mut best, &mut runner_up);
            }
        }
        self.seeds = [best.leaf, runner_up.leaf];
        best
    }

    /// Looks for the cheapest leaf in a block, unless that is ruled out; the
    /// excess that no leaf need be looked at above from here on.
    fn search_block(
        &mut self,
        sight: Sight<'_>,
        index: usize,
        (limits, mut limit): (&Limits, f32),
        best: &mut Found,
        runner_up: &mut Found,
    ) -> f32 {
        let bounds = self.filter.get(index);
        let now = Now::new(&self.epochs, self.deviation_sum);
        if is_on(Mechanism::FilterEach) && bounds.is_excluded(limit, &now) {
            return limit;
        }
        limit = self.least_excess(*best, limits);
        let knows_first = self.blocks[index].outdated == 0 && self.could_know_first(index);
        if knows_first {
            let (along, rank, leaf) = self.blocks[index].first;
            if leaf != 0 {
                let cost = self.deviation_sum + along;
                let found = Found { cost, rank, leaf };
                self.cheapest_with_effect = self.cheapest_with_effect.min(found);
                rank_in(found, best, runner_up);
            }
            limit = self.least_excess(*best, limits);
            if is_on(Mechanism::ExactFirstAsBound)
                && (leaf == 0 || self.excess(self.deviation_sum + along) > limit)
            {
                self.blocks[index].know_solid(along);
                self.filter.set(index, self.blocks[index].bounds());
            }
            if bounds.floor_of_open(&self.epochs) > limit {
                return limit;
            }
        }
        if self.is_ruled_out(index, knows_first, limit) {
            return limit;
        }
        self.scan_for_cheapest(sight, index, limits, best, runner_up);
        self.least_excess(*best, limits)
    }

    /// Whether the excesses of a block's leaves, or of its open ones, are all
    /// above a limit.
    fn is_ruled_out(&self, index: usize, only_open: bool, limit: f32) -> bool {
        let now = Now::new(&self.epochs, self.deviation_sum);
        let widths = &self.widths[index * self.view_count..][..self.view_count];
        self.blocks[index].is_above(limit, &now, widths, only_open)
    }

    /// The excess that no leaf need be looked at above.
    #[inline]
    fn least_excess(&self, best: Found, limits: &Limits) -> f32 {
        self.excess(limits.lower_least(best.cost))
    }

    /// Whether the excesses of a block's solid leaves are what their deltas sum
    /// to with the signs of the deviations, and that is known exactly, but for
    /// outdated ones.
    fn could_know_first(&self, index: usize) -> bool {
        let block = &self.blocks[index];
        is_on(Mechanism::ExactFirst)
            && block.signs == self.signs
            && (!self.has_deviations || block.widest * (1.0 + 1e-6) < self.least_deviation)
    }

    /// The leaves outside the blocks.
    fn consider_outside(&mut self, sight: Sight<'_>, best: &mut Found, runner_up: &mut Found) {
        if let Some(found) = self.first_without_effect() {
            rank_in(found, best, runner_up);
        }
        let mut cheapest = self.cheapest_with_effect;
        for found in self.first_alike(sight) {
            cheapest = cheapest.min(found);
            rank_in(found, best, runner_up);
        }
        self.cheapest_with_effect = cheapest;
    }

    /// The first leaf without effect, with its cost.
    pub(in super::super) fn first_without_effect(&self) -> Option<Found> {
        let &(rank, leaf) = self.without_effect.first()?;
        let cost = self.deviation_sum;
        Some(Found { cost, rank, leaf })
    }

    /// The cheapest leaf with an effect that the last search found: of all, if no leaf without effect costs less.
    pub(in super::super) fn cheapest_with_effect(&self) -> Found {
        self.cheapest_with_effect
    }

    fn consider(&mut self, sight: Sight<'_>, leaf: u32, best: &mut Found, runner_up: &mut Found) {
        let cost = self.cost(sight, leaf);
        let rank = self.rank_of[leaf as usize];
        let found = Found { cost, rank, leaf };
        self.cheapest_with_effect = self.cheapest_with_effect.min(found);
        rank_in(found, best, runner_up);
    }

    fn scan_for_cheapest(
        &mut self,
        sight: Sight<'_>,
        index: usize,
        limits: &Limits,
        best: &mut Found,
        runner_up: &mut Found,
    ) {
        let mut found = self.evaluate(sight, index);
        if self.outdate_stale(index, &found, self.least_excess(*best, limits)) {
            found = self.evaluate(sight, index);
        }
        if std::mem::take(&mut self.has_moved_out) {
            self.consider_outside(sight, best, runner_up);
        }
        if is_on(Mechanism::ExactFirst)
            && self.blocks[index].signs != self.signs
            && (self.signs_age >= STEADY || !is_on(Mechanism::ExactFirstWhenSteady))
        {
            self.renew_firsts(sight, index);
        }
        let rounding = self.blocks[index].f32_rounding(self.rounding);
        for lane in 0..LANES {
            if found.at_least.0[lane] - rounding <= self.least_excess(*best, limits) {
                let leaf = self.lanes[index].leaves[lane];
                if leaf != 0 {
                    self.consider(sight, leaf, best, runner_up);
                }
            }
        }
    }

    /// Has those leaves read again that may cost as little as the limit, and of
    /// which it is not known how far their pixels' terms have moved since they
    /// were read; whether there are any.
    fn outdate_stale(&mut self, index: usize, found: &Excesses, limit: f32) -> bool {
        let rounding = self.blocks[index].f32_rounding(self.rounding);
        let lanes = &self.lanes[index];
        let block = &mut self.blocks[index];
        if !is_on(Mechanism::ReadAgain) {
            return false;
        }
        for lane in 0..LANES {
            let is_stale =
                lanes.background_px[lane] > 0 && self.epochs.of_step(lanes.read_in[lane]).is_none();
            if is_stale && found.at_least.0[lane] - rounding <= limit {
                block.outdate(lane, 0.0);
            }
        }
        block.outdated != 0
    }

    /// The cheapest leaf, the cheapest that does not wait, and the largest cost, by looking at every leaf.
    #[cfg(test)]
    pub(in super::super) fn exhaustively(&mut self, sight: Sight<'_>) -> (Found, Found, i64) {
        let left =
            (1..self.place_of.len() as u32).filter(|l| self.place_of[*l as usize] != NOWHERE);
        let left: Vec<u32> = left.collect();
        let found = left.into_iter().map(|leaf| Found {
            cost: self.cost(sight, leaf),
            rank: self.rank_of[leaf as usize],
            leaf,
        });
        let found: Vec<Found> = found.collect();
        let waits = |found: &&Found| self.place_of[found.leaf as usize] == WAITING;
        let with_effect = found.iter().filter(|found| !waits(found)).min();
        let with_effect = with_effect.copied().unwrap_or(Found::NONE);
        let largest = found.iter().map(|f| f.cost).max().unwrap_or(i64::MIN);
        let cheapest = found.iter().min().copied().unwrap_or(Found::NONE);
        (cheapest, with_effect, largest)
    }

    /// The largest cost of a leaf that is left; if all of them cost less than a
    /// leaf of another shard, any cost that one has, or MIN.
    pub(in super::super) fn largest_cost(&mut self, sight: Sight<'_>, limits: &Limits) -> i64 {
        let mut best = (i64::MIN, 0);
        if !self.without_effect.is_empty() {
            best.0 = self.deviation_sum;
        }
        for found in self.first_alike(sight) {
            best = best.max((found.cost, found.leaf));
        }
        // Mostly the same leaf as in the step before.
        if is_on(Mechanism::SeedDearest) && self.place_of[self.last_largest as usize] != NOWHERE {
            let cost = self.cost(sight, self.last_largest);
            best = best.max((cost, self.last_largest));
        }
        let drift = drift_now(self.drift.rise + self.drift.revealed)
            - drift_then(self.drift_at_rebuild.rise + self.drift_at_rebuild.revealed);
        let mut limit = self.excess(limits.raise_largest(best.0));
        for first in (0..self.tops.len()).step_by(TOPS_AT_ONCE) {
            let last = (first + TOPS_AT_ONCE).min(self.tops.len());
            let tops = self.tops[first..last].iter();
            // Without a way out in the middle it is vector instructions.
            if is_on(Mechanism::Tops)
                && !tops.fold(false, |any, top| any | (top.ceiling(drift) > limit))
            {
                continue;
            }
            for index in first..last {
                if !is_on(Mechanism::Tops) || self.tops[index].ceiling(drift) > limit {
                    let now = Now::new(&self.epochs, self.deviation_sum);
                    if self.blocks[index].ceiling(&now) > limit {
                        self.scan_for_largest(sight, index, &mut best);
                    }
                    limit = self.excess(limits.raise_largest(best.0));
                }
            }
        }
        if best.1 != 0 {
            self.last_largest = best.1;
        }
        // Some may have been found out only now.
        let alike = self.first_alike(sight).map(|found| found.cost).max();
        let largest = best.0.max(alike.unwrap_or(i64::MIN));
        match self.without_effect.is_empty() {
            false => largest.max(self.deviation_sum),
            true => largest,
        }
    }

    fn scan_for_largest(&mut self, sight: Sight<'_>, index: usize, best: &mut (i64, u32)) {
        let found = self.evaluate(sight, index);
        let rounding = self.blocks[index].f32_rounding(self.rounding);
        for lane in 0..LANES {
            let leaf = self.lanes[index].leaves[lane];
            if leaf != 0 && found.at_most.0[lane] + rounding > self.excess(best.0) {
                *best = (*best).max((self.cost(sight, leaf), leaf));
            }
        }
    }
}

/// Keeps the best two.
fn rank_in(found: Found, best: &mut Found, runner_up: &mut Found) {
    if found < *best {
        *runner_up = std::mem::replace(best, found);
    } else if found < *runner_up && found.leaf != best.leaf {
        *runner_up = found;
    }
}
