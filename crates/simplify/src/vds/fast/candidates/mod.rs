//! The cheapest leaf, and the largest cost, without evaluating every leaf.
//!
//! The cost of leaf l is `sum_v |D_v + d_v|`: D the deviations of the current
//! foliage, which change with every step, d the leaf's deltas, which mostly do
//! not. Costs differ by little against `sum |D|`, so everything here is about
//! the *excess* `sum_v (|D_v + d_v| - |D_v|)`. Leaves of about the same
//! `n = sum |d|` share a *block*, whose deltas are kept as f32, so that its
//! excesses are a few vector instructions. A block that was evaluated when the
//! deviations were E, with signs g = sgn E (an *epoch*), remembers the least and
//! largest of
//!
//! - `h = sum g d`: since `|x| >= g x`, `excess >= sum (g D - |D|) + h`, which is
//!   exact while no `D_v + d_v` changes sign, however far D moves;
//! - the excess then, from which an excess now differs by no more than what
//!   [`Epochs`] says;
//! - `n`: `excess >= n - 2 sum |D|`, which rules out all but the least visible
//!   leaves while the deviations are small, and `excess <= n`.
//!
//! Most blocks are ruled out by their [gates], many at a time. A block is
//! evaluated again only where these do not rule it out, and an exact
//! integer cost is computed only for leaves that their f32 excess does not rule
//! out. Epochs are forgotten after a while; bounds are carried over to a later
//! one, with less to spare. Nearly every step changes the background, and with it the deltas of
//! every leaf at the silhouette, so those are kept without what its total takes
//! away in all views, which is added as it is now; and all bounds are widened by
//! how far its terms may have [moved](background). What decides in the end are
//! exact costs: bounds may be loose but never wrong.
//!
//! Each shard has candidates of its own, and lets the others know what it has
//! found ([`Limits`]).
//!
//! A leaf whose deltas are all zero costs `sum |D|`. Those wait, ordered by
//! rank, outside the blocks: mostly leaves that no view sees. So do leaves for
//! which a [twin](twins) stands.

mod along;
mod background;
mod blocks;
mod drift;
mod epochs;
mod evaluate;
mod excess;
mod gates;
mod limits;
mod rounding;
mod search;
mod twins;
mod widths;

use std::collections::BTreeSet;
use std::sync::Arc;

use super::changes::{BackgroundDrift, Change};
use super::counts::Counts;
use super::deltas::Sight;
use super::prefetch::prefetch;
use background::Background;
use blocks::{Block, Figures, NO_FIRST, Now, Top};
use epochs::{Epochs, along_signs};
use excess::{LANES, Lanes, ViewNow};
use gates::Gates;
use rounding::Rounding;
use twins::Twins;
use widths::Width;

pub(super) use limits::Limits;
pub(super) use twins::Silhouette;

const NOWHERE: u32 = u32::MAX;
/// Steps without a change of sign after which exact sums are worth their time.
const STEADY: u32 = 32;
/// Pixels for which a step knows beforehand how the logarithm of the
/// background's total would rise.
const RISES: usize = 256;

/// What is known of a block's leaves beside their deltas.
#[derive(Clone)]
struct Residents {
    /// 0 where none is.
    leaves: [u32; LANES],
    /// Pixels that each would hand to the background.
    background_px: [u32; LANES],
    /// The most of them in a view, or more than anybody asks for.
    most_revealed: [u8; LANES],
    /// The step in which each was read.
    read_in: [u32; LANES],
    /// Drift of the background where it is revealed, when the leaf was read.
    drift: Lanes,
    /// What the deltas of each sum to with the block's signs, exactly, if it
    /// is solid.
    along: [i64; LANES],
}

/// A leaf and its cost; of equals the least rank comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Found {
    pub cost: i64,
    pub rank: u32,
    pub leaf: u32,
}

impl Found {
    pub(super) const NONE: Self = Self {
        cost: i64::MAX,
        rank: u32::MAX,
        leaf: 0,
    };
}

pub(super) struct Candidates {
    view_count: usize,
    rank_of: Arc<[u32]>,
    /// By rank, then leaf number: leaves whose deltas are all zero.
    without_effect: BTreeSet<(u32, u32)>,
    twins: Twins,
    blocks: Vec<Block>,
    /// By block, what is looked at first.
    gates: Gates,
    tops: Vec<Top>,
    residents: Vec<Residents>,
    /// Deltas by block, then view, without what the background's total takes
    /// away.
    deltas: Vec<Lanes>,
    /// How wide they are, likewise, but with that.
    widths: Vec<Width>,
    /// Leaves keep their place, `LANES` to a block, until the next rebuild.
    place_of: Vec<u32>,
    /// The leaves that were left at the last rebuild.
    order: Vec<u32>,
    left: usize,

    epochs: Epochs,
    background: Background,
    /// The current deviations; zeros where costs do not depend on them.
    deviations: Vec<i64>,
    deviation_sum: i64,
    views: Vec<ViewNow>,
    rises: Vec<f32>,
    /// Numbers the runs of steps in which no deviation changed its sign.
    signs: u32,
    /// How many steps that is so.
    signs_age: u32,
    /// The least deviation without its sign.
    least_deviation: f32,
    drift: BackgroundDrift,
    drift_at_rebuild: BackgroundDrift,
    background_jumps: u32,
    rounding: Rounding,
    /// The leaf of the largest cost of the last step that asked.
    last_largest: u32,
    /// The leaves of the two least costs of the last step.
    seeds: [u32; 2],
    row: Vec<i64>,
}

impl Candidates {
    /// `leaves` are the numbers of the leaves that are there, neighbours close
    /// together; `rank_of` their ranks among equals, by leaf number.
    pub(super) fn new(
        sight: Sight<'_>,
        leaves: Vec<u32>,
        rank_of: Arc<[u32]>,
        pixels_per_view: usize,
        deviations: &[i64],
    ) -> Self {
        let views = sight.counts.view_count();
        let mut candidates = Self {
            view_count: views,
            place_of: vec![NOWHERE; rank_of.len()],
            twins: Twins::new(rank_of.len() - 1),
            rank_of,
            without_effect: BTreeSet::new(),
            blocks: Vec::new(),
            gates: Gates::default(),
            tops: Vec::new(),
            residents: Vec::new(),
            deltas: Vec::new(),
            widths: Vec::new(),
            left: leaves.len(),
            order: leaves,
            epochs: Epochs::new(
                deviations,
                sight.counts.areas(0),
                sight.counts.background_drift(),
            ),
            background: Background::new(sight.counts),
            deviations: deviations.to_vec(),
            deviation_sum: 0,
            views: Vec::new(),
            rises: Vec::new(),
            signs: 0,
            signs_age: 0,
            least_deviation: 0.0,
            drift: sight.counts.background_drift(),
            drift_at_rebuild: sight.counts.background_drift(),
            background_jumps: sight.counts.background_jumps(),
            rounding: Rounding::new(views, pixels_per_view),
            last_largest: 0,
            seeds: [0; 2],
            row: vec![0; views],
        };
        for leaf in candidates.order.clone() {
            let rank = candidates.rank_of[leaf as usize];
            candidates.twins.set(rank, leaf, sight.silhouette(leaf));
        }
        candidates.look(sight.counts, deviations);
        candidates.build(sight);
        candidates
    }

    fn build(&mut self, sight: Sight<'_>) {
        self.without_effect.clear();
        let mut order = std::mem::take(&mut self.order);
        // Who need not be looked at last; by n to within a quarter; by what
        // would go to the background; among those, neighbours stay together.
        order.sort_by_cached_key(|&leaf| {
            sight.deltas(leaf, &mut self.row);
            let n: u64 = self.row.iter().map(|d| d.unsigned_abs()).sum();
            let exponent = n.max(4).ilog2();
            let waits = n == 0 || self.twins.is_hidden(self.rank_of[leaf as usize], leaf);
            let background_px = sight.deltas_but_rise(leaf, &mut self.row);
            (waits, exponent, n >> (exponent - 2), background_px.min(16))
        });
        let block_count = order.len().div_ceil(LANES);
        let nobody = Residents {
            leaves: [0; LANES],
            background_px: [0; LANES],
            most_revealed: [0; LANES],
            read_in: [0; LANES],
            drift: Lanes::ZERO,
            along: [i64::MAX; LANES],
        };
        self.drift_at_rebuild = sight.counts.background_drift();
        let empty = Block::empty(self.epochs.current(), self.signs);
        self.gates = Gates::new(empty.gate(), block_count);
        self.tops = vec![empty.top(); block_count];
        self.residents = vec![nobody; block_count];
        self.blocks = vec![empty; block_count];
        self.deltas = vec![Lanes::ZERO; block_count * self.view_count];
        self.widths = vec![Width::ZERO; block_count * self.view_count];
        for (place, &leaf) in order.iter().enumerate() {
            self.place_of[leaf as usize] = place as u32;
        }
        for &leaf in &order {
            self.enter(sight, leaf);
        }
        self.order = order;
    }

    /// Begins a step: `deviations` are those that costs are measured with.
    pub(super) fn begin_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.rebase_oldest();
        let drift = counts.background_drift();
        self.epochs.begin(deviations, counts.areas(0), drift);
        self.background.begin(self.epochs.current(), counts);
        self.look(counts, deviations);
    }

    /// Has blocks that are about to lose their epoch stand against the current
    /// one, where no deviation has changed its sign in between.
    fn rebase_oldest(&mut self) {
        let oldest = self.epochs.oldest();
        if !self.epochs.is_of_this_run(oldest) {
            return;
        }
        let now = Now::new(&self.epochs, self.deviation_sum);
        let mut from = 0;
        while let Some(index) = self.gates.of_epoch(oldest, from) {
            let widths = &self.widths[index * self.view_count..][..self.view_count];
            let block = &mut self.blocks[index];
            block.rebase(&now, &mut self.background, widths);
            self.gates.set(index, block.gate());
            self.tops[index] = block.top();
            from = index + 1;
        }
    }

    /// Builds the blocks anew when many leaves are gone, and evaluates those
    /// that were not for long.
    pub(super) fn keep_up(&mut self, sight: Sight<'_>) {
        let has_jumped = sight.counts.background_jumps() != self.background_jumps;
        self.background_jumps = sight.counts.background_jumps();
        if has_jumped || self.order.len() - self.left > self.order.len() / 8 + 4 * LANES {
            self.order.retain(|l| self.place_of[*l as usize] != NOWHERE);
            self.build(sight);
        } else {
            // Their epoch is forgotten now.
            let renewed = self.epochs.current();
            let mut from = 0;
            while let Some(index) = self.gates.of_epoch(renewed, from) {
                self.evaluate(sight, index);
                from = index + 1;
            }
        }
    }

    /// Notes how things stand at the beginning of a step.
    fn look(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.drift = counts.background_drift();
        self.signs_age += 1;
        if self.epochs.run() != self.signs {
            self.signs = self.epochs.run();
            self.signs_age = 0;
        }
        let least = deviations.iter().map(|d| d.unsigned_abs()).min();
        self.least_deviation = least.unwrap_or(0) as f32;
        self.deviations.copy_from_slice(deviations);
        self.deviation_sum = deviations.iter().map(|d| d.abs()).sum();
        let now = deviations.iter().zip(counts.areas(0));
        self.views.clear();
        self.views.extend(now.map(|(d, &area)| ViewNow {
            twice_deviation: 2.0 * d.abs() as f32,
            sign: if *d < 0 { -1.0 } else { 1.0 },
            background_px: area as f32,
        }));
        self.rises.clear();
        let rises = (0..RISES as u32).map(|px| counts.background_rise(px) as f32);
        self.rises.extend(rises);
    }

    /// Takes a leaf out for good, if it is one of these.
    pub(super) fn remove(&mut self, sight: Sight<'_>, leaf: u32) {
        if self.place_of[leaf as usize] == NOWHERE {
            return;
        }
        self.left -= 1;
        self.leave(leaf);
        self.place_of[leaf as usize] = NOWHERE;
        let rank = self.rank_of[leaf as usize];
        self.without_effect.remove(&(rank, leaf));
        if let Some(twin) = self.twins.leave(rank, leaf) {
            self.enter(sight, twin);
        }
    }

    fn leave(&mut self, leaf: u32) {
        let place = self.place_of[leaf as usize] as usize;
        let (block, lane) = (place / LANES, place % LANES);
        if self.residents[block].leaves[lane] == 0 {
            return;
        }
        let residents = &mut self.residents[block];
        residents.leaves[lane] = 0;
        self.blocks[block].present &= !(1 << lane);
        residents.background_px[lane] = 0;
        residents.most_revealed[lane] = 0;
        residents.along[lane] = i64::MAX;
        if self.blocks[block].first.2 == leaf {
            self.find_first(block);
        }
        for row in &mut self.deltas[block * self.view_count..(block + 1) * self.view_count] {
            row.0[lane] = 0.0;
        }
    }

    fn find_first(&mut self, index: usize) {
        let residents = &self.residents[index];
        let lanes = residents.along.iter().zip(residents.leaves);
        let known = lanes.filter(|(along, _)| **along != i64::MAX);
        let firsts = known.map(|(&along, leaf)| (along, self.rank_of[leaf as usize], leaf));
        self.blocks[index].first = firsts.fold(NO_FIRST, std::cmp::min);
    }

    /// Asks for where a leaf has its place.
    pub(super) fn prefetch_place(&self, leaf: Option<u32>) {
        if let Some(leaf) = leaf {
            prefetch(&self.place_of, leaf as usize);
        }
    }

    /// Asks for the memory that [`note`](Self::note) of a leaf will need.
    pub(super) fn prefetch(&self, leaf: Option<u32>) {
        let Some(leaf) = leaf else { return };
        let place = self.place_of[leaf as usize];
        if place != NOWHERE {
            let block = place as usize / LANES;
            prefetch(&self.blocks, block);
            prefetch(&self.blocks, block + 1);
        }
    }

    /// Takes note that a leaf's deltas changed; leaves that are gone are ignored.
    ///
    /// Most changes are those of areas of leaves behind it, and small: then its
    /// block's bounds give way, and the deltas are read when they do not suffice.
    pub(super) fn note(&mut self, sight: Sight<'_>, leaf: u32, change: Change) {
        let place = self.place_of[leaf as usize];
        if place == NOWHERE {
            return;
        }
        let (index, lane) = (place as usize / LANES, place as usize % LANES);
        let block = &mut self.blocks[index];
        match change.of_others() {
            Some(change) if block.present >> lane & 1 == 1 => {
                block.outdate(lane, change);
                self.gates.set(index, block.gate());
                self.tops[index] = block.top();
            }
            _ => self.update(sight, leaf),
        }
    }

    /// Notes the exact sum of a leaf's deltas with the signs that the deviations
    /// have now, and what that makes of its block's first.
    fn stand(&mut self, (index, lane): (usize, usize), leaf: u32, along_now: i64) {
        let block = &mut self.blocks[index];
        let residents = &mut self.residents[index];
        let is_known = residents.background_px[lane] == 0 && block.signs == self.signs;
        let along = if is_known { along_now } else { i64::MAX };
        residents.along[lane] = along;
        let was_first = block.first.2 == leaf;
        if is_known && along <= block.first.0 {
            let first = (along, self.rank_of[leaf as usize], leaf);
            block.first = if was_first {
                first
            } else {
                block.first.min(first)
            };
        } else if was_first {
            self.find_first(index);
        }
    }

    /// Takes note of a leaf's new deltas.
    fn update(&mut self, sight: Sight<'_>, leaf: u32) {
        let rank = self.rank_of[leaf as usize];
        let (comes_forth, hides) = self.twins.set(rank, leaf, sight.silhouette(leaf));
        if let Some(other) = hides {
            self.leave(other);
        }
        self.enter(sight, leaf);
        if let Some(other) = comes_forth {
            self.enter(sight, other);
        }
    }

    /// Puts a leaf where its deltas say, unless a twin stands for it.
    fn enter(&mut self, sight: Sight<'_>, leaf: u32) {
        let place = self.place_of[leaf as usize] as usize;
        let rank = self.rank_of[leaf as usize];
        if self.twins.is_hidden(rank, leaf) {
            self.leave(leaf);
            self.without_effect.remove(&(rank, leaf));
            return;
        }
        let (index, lane) = (place / LANES, place % LANES);
        let background_px = sight.deltas_but_rise(leaf, &mut self.row);
        if background_px == 0 && self.row.iter().all(|d| *d == 0) {
            self.leave(leaf);
            self.without_effect.insert((rank, leaf));
            return;
        }
        if self.residents[index].leaves[lane] == 0 {
            self.without_effect.remove(&(rank, leaf));
        }
        let rise = sight.counts.background_rise(background_px);
        let most_revealed = sight.most_revealed(leaf);
        let block = &mut self.blocks[index];
        let epoch = usize::from(block.epoch);
        let then = self.epochs.deviations(epoch);
        let (mut excess, mut n, mut magnitude, mut widest) = (0, 0, 0, 0);
        let background = sight.counts.areas(0);
        let widths = &mut self.widths[index * self.view_count..][..self.view_count];
        for (view, (width, d)) in widths.iter_mut().zip(&self.row).enumerate() {
            let e = then[view];
            let risen = (u64::from(background[view]) * rise) as i64;
            magnitude += d.abs() + risen;
            let d = d - risen;
            excess += (d + e).abs() - e.abs();
            n += d.abs();
            widest = widest.max(d.abs());
            *width = width.with(d as f32);
        }
        let along_then = along_signs(&self.row, then)
            - self
                .epochs
                .risen_along(epoch, background_px, sight.counts.table);
        let now = &mut self.background;
        let by_gains = now.moved_by_gains(epoch, most_revealed, background_px);
        let by_rise = now.moved_by_rise(epoch, background_px, background_px);
        let figures = Figures {
            along: along_then as f32,
            excess: excess as f32,
            moved_by_gains: known_or_zero(by_gains),
            moved_by_rise: known_or_zero(by_rise),
            n: n as f32,
            magnitude: magnitude as f32,
            widest: widest as f32,
            background_px,
            most_revealed,
        };
        block.include(&figures, self.rounding);
        block.present |= 1 << lane;
        self.gates.set(index, block.gate());
        self.tops[index] = block.top();
        let residents = &mut self.residents[index];
        residents.leaves[lane] = leaf;
        residents.background_px[lane] = background_px;
        residents.most_revealed[lane] = most_revealed.try_into().unwrap_or(u8::MAX);
        self.write_row((index, lane));
        let along_now = along_signs(&self.row, &self.deviations);
        self.stand((index, lane), leaf, along_now);
    }

    /// The exact sums of a block's deltas with the signs that the deviations
    /// have now.
    fn renew_firsts(&mut self, sight: Sight<'_>, index: usize) {
        for lane in 0..LANES {
            let leaf = self.residents[index].leaves[lane];
            if leaf != 0 && self.residents[index].background_px[lane] == 0 {
                sight.deltas_but_rise(leaf, &mut self.row);
                self.residents[index].along[lane] = along_signs(&self.row, &self.deviations);
            }
        }
        self.blocks[index].signs = self.signs;
        self.find_first(index);
    }
}

/// Blocks whose leaves are like that know it of all of them.
fn known_or_zero(moved: f32) -> f32 {
    if moved.is_finite() { moved } else { 0.0 }
}
