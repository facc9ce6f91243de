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
//! Most blocks are ruled out by a [filter](block_filter) over these bounds, sixteen
//! blocks at a time. A block is evaluated again only where the filter and then the
//! block itself do not rule it out, and an exact integer cost is computed only for
//! leaves that their f32 excess does not rule out. Epochs are forgotten after a while;
//! bounds are carried over to a later one, with less to spare. Nearly every step changes
//! the background, and with it the deltas of every leaf at the silhouette, so those are
//! kept without what its total takes away in all views, which is added as it is now;
//! and all bounds are widened by how far its terms may have [moved](drift). What decides
//! in the end are exact costs: bounds may be loose but never wrong.
//!
//! What each short cut is worth is measured by `cargo bench --bench ablation` and stands
//! in `docs/benchmarks.md`; one that wins less than 3 % on every tree goes.
//!
//! Each shard has candidates of its own, and lets the others know what it has
//! found ([`Limits`]).
//!
//! A leaf whose deltas are all zero costs `sum |D|`. Those wait, ordered by
//! rank, outside the blocks: mostly leaves that no view sees. Of a million leaves they are most, and
//! no step looks at them.

mod alike;
mod block_filter;
mod block_lanes;
mod blocks;
mod drift;
mod epochs;
mod evaluate;
mod excess;
mod limits;
mod rounding;
mod search;
mod widths;

use std::collections::BTreeSet;
use std::sync::Arc;

use super::changes::BackgroundDrift;
use super::counts::Counts;
use super::deltas::Sight;
use super::switches::{Mechanism, is_on};
use alike::Alike;
use block_filter::BlockFilter;
use block_lanes::BlockLanes;
use blocks::{Block, Top};
use epochs::{Epochs, Now};
use excess::{LANES, Lanes, ViewNow};
use rounding::Rounding;
use widths::Width;

pub(super) use limits::Limits;

/// The place of a leaf that is gone, or of another shard.
const NOWHERE: u32 = u32::MAX;
/// The place of a leaf without effect.
const WAITING: u32 = u32::MAX - 1;
/// The places of leaves [alike](alike) begin here, one for each group; below are those in blocks.
const FIRST_GROUP: u32 = u32::MAX - (1 << 16);
/// Steps without a change of sign after which exact sums are worth their time.
const STEADY: u32 = 32;
/// Pixels for which a step knows beforehand how the logarithm of the
/// background's total would rise.
const RISES: usize = 256;

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
    alike: Alike,
    blocks: Vec<Block>,
    /// By block, what is looked at first.
    filter: BlockFilter,
    tops: Vec<Top>,
    lanes: Vec<BlockLanes>,
    /// Deltas by block, then view, without what the background's total takes
    /// away.
    deltas: Vec<Lanes>,
    /// How wide they are, likewise, but with that.
    widths: Vec<Width>,
    /// Leaves keep their place, `LANES` to a block, until the next rebuild; those outside the blocks have places that
    /// say why.
    place_of: Vec<u32>,
    /// By place, the leaf that got it: those with an effect at the last rebuild, then those that got one since.
    order: Vec<u32>,
    /// How many places there were at the last rebuild.
    places_at_rebuild: usize,
    /// The leaves that are left to all shards, now and at the last rebuild: all
    /// rebuild in the same step, so that none waits for another.
    all_left: usize,
    all_at_rebuild: usize,

    epochs: Epochs,
    /// Whether costs depend on deviations: without, a cost is `n`.
    has_deviations: bool,
    /// The current deviations; zeros where costs do not depend on them.
    deviations: Vec<i64>,
    deviation_sum: i64,
    views: Vec<ViewNow>,
    /// How the logarithm of the background's total would rise, by pixels.
    rises: [u32; RISES],
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
    /// Whether a leaf has left the blocks, but not for good, since that was last asked.
    has_moved_out: bool,
    /// The cheapest leaf with an effect that the search has come across.
    cheapest_with_effect: Found,
    row: Vec<i64>,
}

impl Candidates {
    /// `leaves` are the numbers of the shard's leaves that are there, neighbours
    /// close together, of `all_left` of all shards; `rank_of` their ranks among
    /// equals, by leaf number.
    pub(super) fn new(
        sight: Sight<'_>,
        (leaves, all_left): (Vec<u32>, usize),
        rank_of: Arc<[u32]>,
        pixels_per_view: usize,
        (has_deviations, deviations): (bool, &[i64]),
    ) -> Self {
        let views = sight.counts.view_count();
        let mut candidates = Self {
            view_count: views,
            place_of: vec![NOWHERE; rank_of.len()],
            rank_of,
            without_effect: BTreeSet::new(),
            alike: Alike::none(views),
            blocks: Vec::new(),
            filter: BlockFilter::default(),
            tops: Vec::new(),
            lanes: Vec::new(),
            deltas: Vec::new(),
            widths: Vec::new(),
            all_left,
            all_at_rebuild: all_left,
            order: leaves,
            places_at_rebuild: 0,
            has_deviations,
            epochs: Epochs::new(deviations, sight.counts.background_drift()),
            deviations: deviations.to_vec(),
            deviation_sum: 0,
            views: Vec::new(),
            rises: [0; RISES],
            signs: 0,
            signs_age: 0,
            least_deviation: 0.0,
            drift: sight.counts.background_drift(),
            drift_at_rebuild: sight.counts.background_drift(),
            background_jumps: sight.counts.background_jumps(),
            rounding: Rounding::new(views, pixels_per_view),
            last_largest: 0,
            seeds: [0; 2],
            has_moved_out: false,
            cheapest_with_effect: Found::NONE,
            row: vec![0; views],
        };
        candidates.note_step(sight.counts, deviations);
        candidates.build(sight);
        candidates
    }

    fn build(&mut self, sight: Sight<'_>) {
        self.all_at_rebuild = self.all_left;
        // Not there together with the new ones: of a million leaves they take 200 MB.
        self.tops = Vec::new();
        self.lanes = Vec::new();
        self.blocks = Vec::new();
        self.deltas = Vec::new();
        self.widths = Vec::new();
        let order = std::mem::take(&mut self.order);
        let mut waiting = Vec::new();
        let mut keyed: Vec<u64> = Vec::new();
        for (at, &leaf) in (0u32..).zip(&order) {
            prefetch_ahead(sight, &order[at as usize..]);
            match self.key(sight, leaf) {
                Ok(key) => keyed.push(u64::from(key) << 32 | u64::from(at)),
                Err(WAITING) => {
                    self.place_of[leaf as usize] = WAITING;
                    waiting.push((self.rank_of[leaf as usize], leaf));
                }
                Err(group) => {
                    // Its block is no more.
                    self.place_of[leaf as usize] = NOWHERE;
                    self.move_to(leaf, group);
                }
            }
        }
        match self.without_effect.is_empty() {
            true => self.without_effect = waiting.into_iter().collect(),
            false => self.without_effect.extend(waiting),
        }
        keyed.sort_unstable();
        let order: Vec<u32> = keyed
            .iter()
            .map(|key| order[*key as u32 as usize])
            .collect();
        drop(keyed);
        let block_count = order.len().div_ceil(LANES);
        self.drift_at_rebuild = sight.counts.background_drift();
        let empty = Block::empty(self.epochs.current(), self.signs);
        self.filter = BlockFilter::new(empty.bounds(), block_count);
        self.tops = vec![empty.top(); block_count];
        self.lanes = vec![BlockLanes::EMPTY; block_count];
        self.blocks = vec![empty; block_count];
        self.deltas = vec![Lanes::ZERO; block_count * self.view_count];
        self.widths = vec![Width::ZERO; block_count * self.view_count];
        self.places_at_rebuild = order.len();
        for (place, &leaf) in order.iter().enumerate() {
            self.place_of[leaf as usize] = place as u32;
        }
        for (at, &leaf) in order.iter().enumerate() {
            prefetch_ahead(sight, &order[at..]);
            self.enter(sight, leaf);
        }
        self.order = order;
    }

    /// Who need not be looked at last; by n to within a quarter; by what would go
    /// to the background. Among those, neighbours stay together. For a leaf outside the blocks its place there.
    fn key(&mut self, sight: Sight<'_>, leaf: u32) -> Result<u32, u32> {
        let background_px = sight.deltas_but_rise(leaf, &mut self.row);
        if let Some(place) = self.place_outside(sight, leaf, background_px) {
            return Err(place);
        }
        if !is_on(Mechanism::SortedBlocks) {
            return Ok(0);
        }
        let rise = sight.counts.background_rise(background_px);
        let deltas = self.row.iter().zip(sight.counts.areas(0));
        let n: u64 = deltas
            .map(|(d, &area)| (d - (u64::from(area) * rise) as i64).unsigned_abs())
            .sum();
        let exponent = n.max(4).ilog2();
        // The quarter is below 8.
        let quarter = (n >> (exponent - 2)) as u32;
        let by_size = u32::from(n == 0) << 6 | exponent;
        Ok((by_size << 3 | quarter) << 5 | background_px.min(16))
    }

    /// Whether the leaf that was just read has no effect, and waits outside the blocks.
    fn is_without_effect(&self, background_px: u32) -> bool {
        is_on(Mechanism::ZeroLeavesWait) && background_px == 0 && self.row.iter().all(|d| *d == 0)
    }

    /// Begins a step: `deviations` are those that costs are measured with.
    pub(super) fn begin_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.rebase_oldest();
        let drift = counts.background_drift();
        self.epochs.begin(deviations, drift);
        self.note_step(counts, deviations);
    }

    /// Has blocks that are about to lose their epoch stand against the current
    /// one, where no deviation has changed its sign in between.
    fn rebase_oldest(&mut self) {
        let oldest = self.epochs.oldest();
        if !self.epochs.is_of_this_run(oldest) || !is_on(Mechanism::Rebase) {
            return;
        }
        let now = Now::new(&self.epochs, self.deviation_sum);
        let mut from = 0;
        while let Some(index) = self.filter.of_epoch(oldest, from) {
            let block = &mut self.blocks[index];
            let widths = &self.widths[index * self.view_count..][..self.view_count];
            block.rebase(&now, widths);
            self.filter.set(index, block.bounds());
            self.tops[index] = block.top();
            from = index + 1;
        }
    }

    /// Builds the blocks anew when many leaves are gone, and evaluates those
    /// that were not for long.
    pub(super) fn rebuild_if_stale(&mut self, sight: Sight<'_>) {
        let has_jumped = sight.counts.background_jumps() != self.background_jumps;
        self.background_jumps = sight.counts.background_jumps();
        let are_many = |changed: usize, of: usize| changed > of / 8 + 4 * LANES;
        let has_changed = are_many(self.all_at_rebuild - self.all_left, self.all_at_rebuild)
            || are_many(
                self.order.len() - self.places_at_rebuild,
                self.places_at_rebuild,
            );
        if has_jumped || has_changed && is_on(Mechanism::Rebuild) {
            let order = std::mem::take(&mut self.order);
            let is_there = |(place, leaf): &(u32, u32)| self.place_of[*leaf as usize] == *place;
            let order = (0..).zip(order).filter(is_there).map(|(_, leaf)| leaf);
            self.order = order.collect();
            self.build(sight);
        } else {
            // Their epoch is forgotten now.
            let renewed = self.epochs.current();
            let mut from = 0;
            while let Some(index) = self.filter.of_epoch(renewed, from) {
                self.evaluate(sight, index);
                from = index + 1;
            }
        }
    }

    /// Notes how things stand at the beginning of a step.
    fn note_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
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
        if is_on(Mechanism::RiseTable) {
            counts.background_rises(&mut self.rises);
        }
    }
}

/// How many leaves ahead what is known of them is asked for, and where that is.
const LEAVES_AHEAD: usize = 4;
const PLACES_AHEAD: usize = 8;

/// Asks for what is known of leaves that follow the first.
#[inline(always)]
fn prefetch_ahead(sight: Sight<'_>, leaves: &[u32]) {
    if !is_on(Mechanism::PrefetchBlocks) {
        return;
    }
    if let Some(leaf) = leaves.get(PLACES_AHEAD) {
        sight.prefetch_place(*leaf);
    }
    if let Some(leaf) = leaves.get(LEAVES_AHEAD) {
        sight.prefetch(*leaf);
    }
}
