//! The search itself: through the gates, then the blocks, then the leaves.

use super::blocks::{Now, drift_now, drift_then};
use super::excess::{LANES, Lanes};
use super::{Candidates, Cheapest, Counts, NOWHERE, STEADY};

impl Candidates {
    fn cost(&mut self, counts: &Counts<'_>, leaf: u32) -> i64 {
        counts.deltas(leaf, &mut self.row);
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

    /// The leaf of least cost; of equals that of the lowest rank.
    ///
    /// # Panics
    /// If no leaf is left.
    pub(in super::super) fn cheapest(&mut self, counts: &Counts<'_>) -> Cheapest {
        // Cost, rank, leaf.
        let mut best = (i64::MAX, u32::MAX, 0u32);
        let mut runner_up = best;
        self.consider_without_effect(&mut best, &mut runner_up);
        // Mostly near the least.
        if self.place_of[self.runner_up as usize] != NOWHERE {
            self.consider(counts, self.runner_up, &mut best, &mut runner_up);
        }
        let mut limit = self.excess(best.0);
        for index in 0..self.gates.len() {
            let now = Now::new(&self.epochs, &self.rises, self.drift, self.deviation_sum);
            let gate = &self.gates[index];
            let mut floor_of_open = gate.floor_of_open(&now);
            if floor_of_open > limit && gate.floor_of_solid(&now) > limit {
                continue;
            }
            if self.blocks[index].outdated != 0 {
                if !self.could_know_first(index) && self.blocks[index].floor(&now) > limit {
                    continue;
                }
                self.bring_up_to_date(counts, index);
                self.consider_without_effect(&mut best, &mut runner_up);
                limit = self.excess(best.0);
                let now = Now::new(&self.epochs, &self.rises, self.drift, self.deviation_sum);
                let gate = &self.gates[index];
                floor_of_open = gate.floor_of_open(&now);
                if floor_of_open > limit && gate.floor_of_solid(&now) > limit {
                    continue;
                }
            }
            let now = Now::new(&self.epochs, &self.rises, self.drift, self.deviation_sum);
            let knows_first = self.could_know_first(index);
            if knows_first {
                let (along, rank, leaf) = self.blocks[index].first;
                if leaf != 0 {
                    let first = (self.deviation_sum + along, rank, leaf);
                    rank_in(first, &mut best, &mut runner_up);
                }
                limit = self.excess(best.0);
                if leaf == 0 || self.excess(self.deviation_sum + along) > limit {
                    self.blocks[index].know_solid(along);
                    self.gates[index] = self.blocks[index].gate();
                }
                if floor_of_open > limit || self.blocks[index].floor_of_open(&now) > limit {
                    continue;
                }
            } else if self.blocks[index].floor(&now) > limit {
                continue;
            }
            self.scan_for_cheapest(counts, index, knows_first, &mut best, &mut runner_up);
            limit = self.excess(best.0);
        }
        self.runner_up = runner_up.2;
        assert!(best.2 != 0, "a leaf is left");
        Cheapest {
            leaf: best.2,
            cost: best.0,
        }
    }

    /// Whether the excesses of a block's solid leaves are what their deltas sum
    /// to with the signs of the deviations, and that is known exactly, but for
    /// outdated ones.
    fn could_know_first(&self, index: usize) -> bool {
        let block = &self.blocks[index];
        block.signs == self.signs && block.widest * (1.0 + 1e-6) < self.least_deviation
    }

    fn consider_without_effect(&self, best: &mut (i64, u32, u32), runner_up: &mut (i64, u32, u32)) {
        if let Some(&(rank, leaf)) = self.without_effect.first() {
            rank_in((self.deviation_sum, rank, leaf), best, runner_up);
        }
    }

    fn consider(
        &mut self,
        counts: &Counts<'_>,
        leaf: u32,
        best: &mut (i64, u32, u32),
        runner_up: &mut (i64, u32, u32),
    ) {
        let cost = self.cost(counts, leaf);
        rank_in((cost, self.rank_of[leaf as usize], leaf), best, runner_up);
    }

    fn scan_for_cheapest(
        &mut self,
        counts: &Counts<'_>,
        index: usize,
        without_solid: bool,
        best: &mut (i64, u32, u32),
        runner_up: &mut (i64, u32, u32),
    ) {
        let found = self.evaluate(counts, index);
        if self.blocks[index].signs != self.signs && self.signs_age >= STEADY {
            self.renew_firsts(counts, index);
        }
        let margins = self.lane_margins(index);
        for lane in 0..LANES {
            if found.excess.0[lane] - margins.0[lane] <= self.excess(best.0) {
                let residents = &self.residents[index];
                let leaf = residents.leaves[lane];
                if leaf != 0 && !(without_solid && residents.background_px[lane] == 0) {
                    self.consider(counts, leaf, best, runner_up);
                }
            }
        }
    }

    /// The least cost with its leaf, and the largest, by looking at every leaf.
    #[cfg(test)]
    pub(in super::super) fn exhaustively(&mut self, counts: &Counts<'_>) -> (Cheapest, i64) {
        let left =
            (1..self.place_of.len() as u32).filter(|l| self.place_of[*l as usize] != NOWHERE);
        let left: Vec<u32> = left.collect();
        let costs = left.into_iter().map(|leaf| {
            let cost = self.cost(counts, leaf);
            (cost, self.rank_of[leaf as usize], leaf)
        });
        let costs: Vec<_> = costs.collect();
        let (cost, _, leaf) = *costs.iter().min().expect("a leaf is left");
        let largest = costs.iter().map(|c| c.0).max().expect("a leaf is left");
        (Cheapest { leaf, cost }, largest)
    }

    /// How far the excesses of a block's leaves in f32 may be off.
    #[inline]
    fn lane_margins(&self, index: usize) -> Lanes {
        let residents = &self.residents[index];
        let rounding = self.blocks[index].f32_rounding(self.rounding);
        let drift = drift_now(self.drift.revealed);
        Lanes(std::array::from_fn(|lane| {
            let px = residents.background_px[lane] as f32;
            rounding + self.rounding.of_revealed(px) + px * (drift - residents.drift.0[lane])
        }))
    }

    /// The largest cost of a leaf that is left.
    pub(in super::super) fn largest_cost(&mut self, counts: &Counts<'_>) -> i64 {
        let mut best = (i64::MIN, 0);
        if !self.without_effect.is_empty() {
            best.0 = self.deviation_sum;
        }
        // Mostly the same leaf as in the step before.
        if self.place_of[self.last_largest as usize] != NOWHERE {
            let cost = self.cost(counts, self.last_largest);
            best = best.max((cost, self.last_largest));
        }
        let drift = drift_now(self.drift.rise + self.drift.revealed)
            - drift_then(self.drift_at_rebuild.rise + self.drift_at_rebuild.revealed);
        let mut limit = self.excess(best.0);
        for index in 0..self.blocks.len() {
            if self.tops[index].ceiling(drift) > limit {
                let now = Now::new(&self.epochs, &self.rises, self.drift, self.deviation_sum);
                if self.blocks[index].ceiling(&now) > limit {
                    self.scan_for_largest(counts, index, &mut best);
                    limit = self.excess(best.0);
                }
            }
        }
        self.last_largest = best.1;
        match self.without_effect.is_empty() {
            // Some of them may have been found out only now.
            false => best.0.max(self.deviation_sum),
            true => best.0,
        }
    }

    fn scan_for_largest(&mut self, counts: &Counts<'_>, index: usize, best: &mut (i64, u32)) {
        let found = self.evaluate(counts, index);
        let margins = self.lane_margins(index);
        for lane in 0..LANES {
            let leaf = self.residents[index].leaves[lane];
            let ceiling = found.excess.0[lane] + margins.0[lane];
            if leaf != 0 && ceiling > self.excess(best.0) {
                *best = (*best).max((self.cost(counts, leaf), leaf));
            }
        }
    }
}

/// Keeps the best two: cost, rank, leaf.
fn rank_in(found: (i64, u32, u32), best: &mut (i64, u32, u32), runner_up: &mut (i64, u32, u32)) {
    if found < *best {
        *runner_up = std::mem::replace(best, found);
    } else if found < *runner_up && found.2 != best.2 {
        *runner_up = found;
    }
}
