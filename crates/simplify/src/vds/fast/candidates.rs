//! The cheapest leaf, and the largest cost, without evaluating every leaf.
//!
//! The cost of leaf l is `sum_v |D_v + d_v|`: D the deviations of the current
//! foliage, which change with every step, d the leaf's deltas, which mostly do
//! not. Costs differ by little against `sum |D|`, so everything here is about
//! the *excess* `sum_v (|D_v + d_v| - |D_v|)`. Leaves of about the same `n = sum |d|` share a *block*, whose deltas are
//! kept as f32, so that its costs are a few vector instructions. A block
//! that was evaluated when the deviations were E, with signs g = sgn E (an
//! *epoch*), remembers the least and largest of
//!
//! - `h = sum g d`: since `|x| >= g x`, `excess >= sum (g D - |D|) + h`, which is
//!   exact while no `D_v + d_v` changes sign, however far D moves;
//! - `c = sum (|E + d| - |E|)`: `excess >= c - sum (|D - E| + |D| - |E|)` and
//!   `excess <= c + sum (|D - E| - |D| + |E|)`, good while D stays near;
//! - `n`: `excess >= n - 2 sum |D|`, which rules out all but the least visible
//!   leaves while the deviations are small, and `excess <= n`.
//!
//! A block is evaluated again only where these do not rule it out, and an exact
//! integer cost is computed only for leaves that their f32 cost does not rule
//! out. Both are widened by [`Candidates::margin`] for what rounding and the
//! moving background may have changed. What decides in the end are exact costs:
//! bounds may be loose but never wrong.
//!
//! A leaf whose deltas are all zero costs `sum |D|`. Those wait, ordered by
//! rank, outside the blocks: mostly leaves that no view sees.

use std::collections::BTreeSet;

use super::counts::Counts;
use super::prefetch::prefetch;

/// Leaves of a block.
const LANES: usize = 16;
/// Steps whose deviations are remembered; a block that was not evaluated for so
/// long is evaluated then.
const EPOCHS: usize = 64;
const NOWHERE: u32 = u32::MAX;
/// Bound of the error of an excess computed in f32, as a part of n: for each of
/// up to a thousand views the roundings of a delta, a deviation and a sum.
const F32_ERROR: f64 = 1e-4;
/// What a lane without a leaf holds.
const ABSENT: f32 = 0.0;

/// One cache line.
#[repr(align(64))]
#[derive(Clone, Copy)]
struct Lanes([f32; LANES]);

/// The deviations of a step, and where the current ones stand against them.
#[derive(Clone)]
struct Epoch {
    deviations: Vec<i64>,
    /// Sum of g D - |D|: zero while no deviation changed its sign.
    flipped: f64,
    /// Sum of |D - E| + |D| - |E|.
    drift_down: f64,
    /// Sum of |D - E| - |D| + |E|.
    drift_up: f64,
}

impl Epoch {
    fn stand_against(&mut self, deviations: &[i64]) {
        let (mut flipped, mut moved, mut risen) = (0i64, 0i64, 0i64);
        for (d, e) in deviations.iter().zip(&self.deviations) {
            flipped += (if *e < 0 { -d } else { *d }) - d.abs();
            moved += (d - e).abs();
            risen += d.abs() - e.abs();
        }
        self.flipped = flipped as f64;
        self.drift_down = (moved + risen) as f64;
        self.drift_up = (moved - risen) as f64;
    }
}

/// What bounds a block's leaves. In f32, because a step looks at all of them;
/// [`Candidates::margin`] covers the rounding.
#[derive(Clone, Copy)]
struct Block {
    epoch: u32,
    least_h: f32,
    least_c: f32,
    largest_c: f32,
    /// Least and largest n since the last rebuild.
    least_n: f32,
    largest_n: f32,
    /// Most pixels, since the last rebuild, that one of its leaves would hand
    /// to the background.
    background_px: f32,
    /// Background drift when the leaf evaluated longest ago was, or earlier.
    background_drift: f64,
}

impl Block {
    fn empty(epoch: usize, background_drift: f64) -> Self {
        Self {
            epoch: epoch as u32,
            least_h: f32::INFINITY,
            least_c: f32::INFINITY,
            largest_c: f32::NEG_INFINITY,
            least_n: f32::INFINITY,
            largest_n: f32::NEG_INFINITY,
            background_px: 0.0,
            background_drift,
        }
    }
}

/// A place in a block.
#[derive(Clone, Copy)]
struct Lane {
    leaf: u32,
    is_in: bool,
    background_px: u32,
    background_drift: f64,
}

/// The leaf that a step prunes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cheapest {
    pub leaf: u32,
    pub cost: i64,
}

pub(super) struct Candidates {
    view_count: usize,
    rank_of: Vec<u32>,
    /// By rank, then leaf number: leaves whose deltas are all zero.
    without_effect: BTreeSet<(u32, u32)>,
    blocks: Vec<Block>,
    /// `LANES` to a block; leaves keep their place until the next rebuild.
    lanes: Vec<Lane>,
    /// Deltas by block, then view.
    deltas: Vec<Lanes>,
    /// By block, 0 where a lane holds a leaf, infinity where not.
    absent: Vec<Lanes>,
    place_of: Vec<u32>,
    /// The leaves that were left at the last rebuild.
    order: Vec<u32>,
    left: usize,

    epochs: Vec<Epoch>,
    current_epoch: usize,
    /// The current deviations; zeros where costs do not depend on them.
    deviations: Vec<i64>,
    /// Twice the deviation without its sign, and its sign, by view.
    deviations_f32: Vec<(f32, f32)>,
    deviation_sum: i64,
    background_drift: f64,
    background_jumps: u32,
    /// Bound of what rounded logarithms do to the background's term.
    rounding: f64,
    /// The leaf of the largest cost of the last step that asked.
    last_largest: u32,
    bounds: Vec<f64>,
    row: Vec<i64>,
}

impl Candidates {
    /// `leaves` are the numbers of the leaves that are there, neighbours close
    /// together; `rank_of` their ranks among equals, by leaf number;
    /// `total_pixels` the pixels over all views.
    pub(super) fn new(
        counts: &Counts<'_>,
        leaves: Vec<u32>,
        rank_of: Vec<u32>,
        total_pixels: f64,
        deviations: &[i64],
    ) -> Self {
        let epoch = Epoch {
            deviations: deviations.to_vec(),
            flipped: 0.0,
            drift_down: 0.0,
            drift_up: 0.0,
        };
        let mut candidates = Self {
            view_count: counts.view_count(),
            place_of: vec![NOWHERE; rank_of.len()],
            rank_of,
            without_effect: BTreeSet::new(),
            blocks: Vec::new(),
            lanes: Vec::new(),
            deltas: Vec::new(),
            absent: Vec::new(),
            left: leaves.len(),
            order: leaves,
            epochs: vec![epoch; EPOCHS],
            current_epoch: 0,
            deviations: deviations.to_vec(),
            deviations_f32: Vec::new(),
            deviation_sum: 0,
            background_drift: counts.background_drift(),
            background_jumps: counts.background_jumps(),
            // Two differences of logarithms off by at most 1.2 units, before
            // and now, times areas that sum to at most the pixels of all views.
            rounding: 5.0 * total_pixels,
            last_largest: 0,
            bounds: Vec::new(),
            row: vec![0; counts.view_count()],
        };
        candidates.take_deviations(deviations);
        candidates.build(counts);
        candidates
    }

    /// How many leaves the foliage had.
    pub(super) fn leaf_count(&self) -> usize {
        self.rank_of.len() - 1
    }

    fn build(&mut self, counts: &Counts<'_>) {
        self.without_effect.clear();
        let mut order = std::mem::take(&mut self.order);
        // By n to within a quarter; among those, neighbours stay together.
        order.sort_by_cached_key(|&leaf| {
            counts.deltas(leaf, &mut self.row);
            let n: u64 = self.row.iter().map(|d| d.unsigned_abs()).sum();
            let exponent = n.max(4).ilog2();
            (exponent, n >> (exponent - 2))
        });
        let block_count = order.len().div_ceil(LANES);
        let absent = Lane {
            leaf: 0,
            is_in: false,
            background_px: 0,
            background_drift: 0.0,
        };
        let empty = Block::empty(self.current_epoch, counts.background_drift());
        self.lanes = vec![absent; block_count * LANES];
        self.blocks = vec![empty; block_count];
        self.absent = vec![Lanes([f32::INFINITY; LANES]); block_count];
        self.deltas = vec![Lanes([ABSENT; LANES]); block_count * self.view_count];
        for (place, &leaf) in order.iter().enumerate() {
            self.place_of[leaf as usize] = place as u32;
            self.lanes[place].leaf = leaf;
        }
        for &leaf in &order {
            self.update(counts, leaf);
        }
        self.order = order;
    }

    /// Begins a step: `deviations` are those that costs are measured with.
    pub(super) fn begin_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.background_drift = counts.background_drift();
        self.current_epoch = (self.current_epoch + 1) % EPOCHS;
        self.take_deviations(deviations);
        let has_jumped = counts.background_jumps() != self.background_jumps;
        self.background_jumps = counts.background_jumps();
        if has_jumped || self.order.len() - self.left > self.order.len() / 8 + 4 * LANES {
            self.order.retain(|l| self.place_of[*l as usize] != NOWHERE);
            self.build(counts);
        }
    }

    fn take_deviations(&mut self, deviations: &[i64]) {
        self.deviations.copy_from_slice(deviations);
        self.deviation_sum = deviations.iter().map(|d| d.abs()).sum();
        self.deviations_f32.clear();
        let with_sign = |d: &i64| (2.0 * d.abs() as f32, if *d < 0 { -1.0 } else { 1.0 });
        self.deviations_f32.extend(deviations.iter().map(with_sign));
        // The epoch that is forgotten now: its blocks are evaluated while the
        // new one takes its place.
        let renewed = self.current_epoch;
        self.epochs[renewed].deviations.copy_from_slice(deviations);
        for epoch in &mut self.epochs {
            epoch.stand_against(deviations);
        }
        for block in 0..self.blocks.len() {
            if self.blocks[block].epoch as usize == renewed {
                self.evaluate(block);
            }
        }
    }

    /// Takes a leaf out for good.
    pub(super) fn remove(&mut self, leaf: u32) {
        self.left -= 1;
        let place = std::mem::replace(&mut self.place_of[leaf as usize], NOWHERE);
        self.leave(place as usize);
        self.without_effect
            .remove(&(self.rank_of[leaf as usize], leaf));
    }

    fn leave(&mut self, place: usize) {
        self.lanes[place].is_in = false;
        self.absent[place / LANES].0[place % LANES] = f32::INFINITY;
        let (block, lane) = (place / LANES, place % LANES);
        for row in &mut self.deltas[block * self.view_count..(block + 1) * self.view_count] {
            row.0[lane] = ABSENT;
        }
    }

    /// Asks for the memory that [`update`](Self::update) of a leaf will need.
    pub(super) fn prefetch(&self, leaf: Option<u32>) {
        let Some(leaf) = leaf else { return };
        let place = self.place_of[leaf as usize];
        if place != NOWHERE {
            let block = place as usize / LANES;
            prefetch(&self.lanes, place as usize);
            for view in 0..self.view_count {
                prefetch(&self.deltas, block * self.view_count + view);
            }
        }
    }

    /// Takes note of a leaf's new deltas; leaves that are gone are ignored.
    pub(super) fn update(&mut self, counts: &Counts<'_>, leaf: u32) {
        let place = self.place_of[leaf as usize];
        if place == NOWHERE {
            return;
        }
        let place = place as usize;
        counts.deltas(leaf, &mut self.row);
        let was_in = self.lanes[place].is_in;
        if self.row.iter().all(|d| *d == 0) {
            if was_in {
                self.leave(place);
            }
            self.without_effect
                .insert((self.rank_of[leaf as usize], leaf));
            return;
        }
        if !was_in {
            self.without_effect
                .remove(&(self.rank_of[leaf as usize], leaf));
        }
        let background_px = counts.background_total(leaf);
        self.lanes[place] = Lane {
            leaf,
            is_in: true,
            background_px,
            background_drift: counts.background_drift(),
        };
        self.absent[place / LANES].0[place % LANES] = 0.0;
        let block = &mut self.blocks[place / LANES];
        let epoch = &self.epochs[block.epoch as usize];
        let (mut h, mut c, mut n) = (0, 0, 0);
        let rows = &mut self.deltas[place / LANES * self.view_count..][..self.view_count];
        for ((row, d), e) in rows.iter_mut().zip(&self.row).zip(&epoch.deviations) {
            row.0[place % LANES] = *d as f32;
            h += if *e < 0 { -d } else { *d };
            c += (d + e).abs() - e.abs();
            n += d.abs();
        }
        block.least_h = block.least_h.min(h as f32);
        block.least_c = block.least_c.min(c as f32);
        block.largest_c = block.largest_c.max(c as f32);
        block.least_n = block.least_n.min(n as f32);
        block.largest_n = block.largest_n.max(n as f32);
        block.background_px = block.background_px.max(background_px as f32);
    }

    /// Evaluates a block's leaves against the current epoch; their excesses.
    fn evaluate(&mut self, index: usize) -> Lanes {
        let rows = &self.deltas[index * self.view_count..(index + 1) * self.view_count];
        let (c, h) = excesses(rows, &self.deviations_f32);
        let absent = &self.absent[index];
        let block = &mut self.blocks[index];
        block.epoch = self.current_epoch as u32;
        block.least_h = least(&h, absent);
        block.least_c = least(&c, absent);
        block.largest_c = -least(&Lanes(c.0.map(|c| -c)), absent);
        // Looked up leaf by leaf only where it has come to matter.
        let px = f64::from(block.background_px);
        if px * (self.background_drift - block.background_drift) > self.rounding {
            let lanes = &self.lanes[index * LANES..(index + 1) * LANES];
            block.background_drift = lanes
                .iter()
                .filter(|lane| lane.is_in && lane.background_px > 0)
                .map(|lane| lane.background_drift)
                .fold(self.background_drift, f64::min);
        }
        c
    }

    fn cost(&mut self, counts: &Counts<'_>, leaf: u32) -> i64 {
        counts.deltas(leaf, &mut self.row);
        let terms = self.row.iter().zip(&self.deviations);
        terms.map(|(d, deviation)| (d + deviation).abs()).sum()
    }

    /// A cost's excess over the sum of the deviations; MAX and MIN stand for
    /// costs beyond all others.
    #[inline]
    fn excess(&self, cost: i64) -> f64 {
        match cost {
            i64::MAX => f64::INFINITY,
            i64::MIN => f64::NEG_INFINITY,
            cost => (cost - self.deviation_sum) as f64,
        }
    }

    /// How far a bound may be off: by how far the background's term of a leaf
    /// may have moved, and by f32.
    #[inline]
    fn margin(&self, n: f64, background_px: f64, background_drift: f64) -> f64 {
        let rounded = F32_ERROR * n;
        if background_px == 0.0 {
            return rounded;
        }
        rounded + self.rounding + background_px * (self.background_drift - background_drift)
    }

    #[inline]
    fn block_margin(&self, block: &Block) -> f64 {
        let (n, px) = (block.largest_n, block.background_px);
        self.margin(f64::from(n), f64::from(px), block.background_drift)
    }

    /// The leaf of least cost; of equals that of the lowest rank.
    ///
    /// # Panics
    /// If no leaf is left.
    pub(super) fn cheapest(&mut self, counts: &Counts<'_>) -> Cheapest {
        // Cost, rank, leaf.
        let mut best = (i64::MAX, u32::MAX, 0u32);
        if let Some(&(rank, leaf)) = self.without_effect.first() {
            best = (self.deviation_sum, rank, leaf);
        }
        self.bound_blocks();
        let bounds = std::mem::take(&mut self.bounds);
        let lowest = (bounds.iter().enumerate()).min_by(|a, b| a.1.total_cmp(b.1));
        let lowest = lowest.map_or(0, |(index, _)| index);
        if bounds
            .get(lowest)
            .is_some_and(|b| *b <= self.excess(best.0))
        {
            self.scan_for_cheapest(counts, lowest, &mut best);
        }
        for (index, bound) in bounds.iter().enumerate() {
            if *bound <= self.excess(best.0) && index != lowest {
                self.scan_for_cheapest(counts, index, &mut best);
            }
        }
        self.bounds = bounds;
        assert!(best.2 != 0, "a leaf is left");
        Cheapest {
            leaf: best.2,
            cost: best.0,
        }
    }

    /// Lower bounds of the excesses of each block's leaves.
    fn bound_blocks(&mut self) {
        let mut bounds = std::mem::take(&mut self.bounds);
        bounds.clear();
        let twice_sum = 2.0 * self.deviation_sum as f64;
        bounds.extend(self.blocks.iter().map(|block| {
            let epoch = &self.epochs[block.epoch as usize];
            (epoch.flipped + f64::from(block.least_h))
                .max(f64::from(block.least_c) - epoch.drift_down)
                .max(f64::from(block.least_n) - twice_sum)
                - self.block_margin(block)
        }));
        self.bounds = bounds;
    }

    fn scan_for_cheapest(&mut self, counts: &Counts<'_>, index: usize, best: &mut (i64, u32, u32)) {
        let excesses = self.evaluate(index);
        let block = self.blocks[index];
        if f64::from(block.least_c) - self.block_margin(&block) > self.excess(best.0) {
            return;
        }
        for (k, excess) in excesses.0.iter().enumerate() {
            let lane = self.lanes[index * LANES + k];
            let px = f64::from(lane.background_px);
            let margin = self.margin(f64::from(block.largest_n), px, lane.background_drift);
            if lane.is_in && f64::from(*excess) - margin <= self.excess(best.0) {
                let cost = self.cost(counts, lane.leaf);
                let rank = self.rank_of[lane.leaf as usize];
                *best = (*best).min((cost, rank, lane.leaf));
            }
        }
    }

    /// The largest cost of a leaf that is left.
    pub(super) fn largest_cost(&mut self, counts: &Counts<'_>) -> i64 {
        let mut best = (i64::MIN, 0);
        if !self.without_effect.is_empty() {
            best.0 = self.deviation_sum;
        }
        // Mostly the same leaf as in the step before.
        if self.place_of[self.last_largest as usize] != NOWHERE {
            let cost = self.cost(counts, self.last_largest);
            best = best.max((cost, self.last_largest));
        }
        for index in 0..self.blocks.len() {
            let block = &self.blocks[index];
            let epoch = &self.epochs[block.epoch as usize];
            let bound = f64::from(block.largest_n).min(f64::from(block.largest_c) + epoch.drift_up)
                + self.block_margin(block);
            if bound > self.excess(best.0) {
                self.scan_for_largest(counts, index, &mut best);
            }
        }
        self.last_largest = best.1;
        best.0
    }

    fn scan_for_largest(&mut self, counts: &Counts<'_>, index: usize, best: &mut (i64, u32)) {
        let excesses = self.evaluate(index);
        let block = self.blocks[index];
        let margin = self.block_margin(&block);
        for (k, excess) in excesses.0.iter().enumerate() {
            let lane = self.lanes[index * LANES + k];
            if lane.is_in && f64::from(*excess) + margin > self.excess(best.0) {
                *best = (*best).max((self.cost(counts, lane.leaf), lane.leaf));
            }
        }
    }
}

/// The least of the lanes that hold a leaf.
fn least(lanes: &Lanes, absent: &Lanes) -> f32 {
    let present = lanes.0.iter().zip(&absent.0).map(|(value, a)| value + a);
    present.fold(f32::INFINITY, |least, v| if v < least { v } else { least })
}

/// Excesses of a block's leaves, and their deltas summed with the signs of the
/// deviations.
///
/// With g the sign of D, `|D + d| - |D|` is the larger of `g d` and
/// `-g d - 2 |D|`: no large numbers cancel.
#[inline(always)]
fn excesses_plainly(rows: &[Lanes], deviations: &[(f32, f32)]) -> (Lanes, Lanes) {
    let (mut c, mut h) = ([0f32; LANES], [0f32; LANES]);
    for (row, (twice_deviation, sign)) in rows.iter().zip(deviations) {
        for k in 0..LANES {
            let along = row.0[k] * sign;
            let across = -along - twice_deviation;
            c[k] += if along > across { along } else { across };
            h[k] += along;
        }
    }
    (Lanes(c), Lanes(h))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn excesses_by_avx2(rows: &[Lanes], deviations: &[(f32, f32)]) -> (Lanes, Lanes) {
    excesses_plainly(rows, deviations)
}

#[inline]
fn excesses(rows: &[Lanes], deviations: &[(f32, f32)]) -> (Lanes, Lanes) {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { excesses_by_avx2(rows, deviations) };
    }
    excesses_plainly(rows, deviations)
}
