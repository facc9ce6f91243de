//! The cheapest leaf, and the largest cost, without evaluating every leaf.
//!
//! The cost of leaf l is `sum_v |D_v + d_v|`: D the deviations of the current
//! foliage, which change with every step, d the leaf's deltas, which mostly do
//! not. Against a snapshot E of D with signs g = sgn E (an *epoch*):
//!
//! - `|x| >= g x` gives `cost >= sum g D + h`, `h = sum g d`: exact while no
//!   `D_v + d_v` changes sign, however far D moves;
//! - the triangle inequality gives `|cost - c| <= sum |D - E|`, `c = sum |E + d|`:
//!   good while D stays near;
//! - and `cost <= sum |D| + n`, `n = sum |d|`.
//!
//! Leaves near each other share a *block*, which keeps the least and largest h,
//! c and n of its leaves. A block, and then a leaf, is looked at only where
//! these bounds, widened by what the background's term may have moved, do not
//! rule it out. What decides in the end are exact costs, so bounds may be loose
//! but never wrong.
//!
//! A leaf whose deltas are all zero costs `sum |D|`. Those wait, ordered by
//! rank, outside the blocks: mostly leaves that no view sees.

use std::collections::BTreeSet;

use super::counts::Counts;

const BLOCK: usize = 16;
const EPOCHS: usize = 32;
/// A new epoch begins after this many steps.
const STEPS_PER_EPOCH: u32 = 8;
const NOWHERE: u32 = u32::MAX;

/// A snapshot of the deviations, and where the current ones stand against it.
#[derive(Clone)]
struct Epoch {
    snapshot: Vec<i64>,
    /// Sum of g D.
    signed: i64,
    /// Sum of |D - E|.
    drift: i64,
}

#[derive(Clone, Copy)]
struct Entry {
    leaf: u32,
    is_in: bool,
    background_px: u32,
    h: i64,
    c: i64,
    n: i64,
}

#[derive(Clone, Copy)]
struct Block {
    epoch: u32,
    /// Background drift when its entries were evaluated, or earlier.
    background_drift: f64,
    background_px: u32,
    least_h: i64,
    least_c: i64,
    largest_c: i64,
    largest_n: i64,
}

impl Block {
    const EMPTY: Self = Self {
        epoch: 0,
        background_drift: 0.0,
        background_px: 0,
        least_h: i64::MAX / 4,
        least_c: i64::MAX / 4,
        largest_c: i64::MIN / 4,
        largest_n: i64::MIN / 4,
    };

    fn include(&mut self, entry: &Entry) {
        self.background_px = self.background_px.max(entry.background_px);
        self.least_h = self.least_h.min(entry.h);
        self.least_c = self.least_c.min(entry.c);
        self.largest_c = self.largest_c.max(entry.c);
        self.largest_n = self.largest_n.max(entry.n);
    }
}

/// The leaf that a step prunes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cheapest {
    pub leaf: u32,
    pub cost: i64,
}

pub(super) struct Candidates {
    rank_of: Vec<u32>,
    /// By rank, then leaf number: leaves whose deltas are all zero.
    without_effect: BTreeSet<(u32, u32)>,
    /// Blocks of [`BLOCK`] entries; leaves keep their place until the next
    /// rebuild.
    entries: Vec<Entry>,
    blocks: Vec<Block>,
    place_of: Vec<u32>,
    epochs: Vec<Epoch>,
    current_epoch: usize,
    steps_in_epoch: u32,
    /// Bound of what rounded logarithms do to the background's term.
    rounding: i64,
    /// The current deviations; zeros where costs do not depend on them.
    deviations: Vec<i64>,
    deviation_sum: i64,
    background_drift: f64,
    /// The leaf of the largest cost of the last step that asked.
    last_largest: u32,
    bounds: Vec<i64>,
    row: Vec<i64>,
    left: usize,
    left_at_build: usize,
    /// Leaves in the order that blocks are filled in.
    order: Vec<u32>,
}

impl Candidates {
    /// `leaves` are the numbers of the leaves that are there, neighbours close
    /// together; `rank_of` their ranks among equals, by leaf number;
    /// `total_pixels` the pixels over all views.
    pub(super) fn new(
        counts: &Counts<'_>,
        leaves: Vec<u32>,
        rank_of: Vec<u32>,
        total_pixels: i64,
        deviations: &[i64],
    ) -> Self {
        let epoch = Epoch {
            snapshot: deviations.to_vec(),
            signed: 0,
            drift: 0,
        };
        let mut candidates = Self {
            place_of: vec![NOWHERE; rank_of.len()],
            rank_of,
            without_effect: BTreeSet::new(),
            entries: Vec::new(),
            blocks: Vec::new(),
            epochs: vec![epoch; EPOCHS],
            current_epoch: 0,
            steps_in_epoch: 0,
            // Four logarithms off by at most 1.2 units, before and now, times
            // areas that sum to at most the pixels of all views.
            rounding: 10 * total_pixels,
            deviations: deviations.to_vec(),
            deviation_sum: 0,
            background_drift: 0.0,
            last_largest: 0,
            bounds: Vec::new(),
            row: vec![0; counts.view_count()],
            left: leaves.len(),
            left_at_build: leaves.len(),
            order: leaves,
        };
        candidates.stand_against_epochs();
        candidates.build(counts);
        candidates
    }

    fn build(&mut self, counts: &Counts<'_>) {
        self.without_effect.clear();
        self.left_at_build = self.left;
        let order = std::mem::take(&mut self.order);
        let absent = Entry {
            leaf: 0,
            is_in: false,
            background_px: 0,
            h: 0,
            c: 0,
            n: 0,
        };
        self.entries.clear();
        self.entries
            .resize(order.len().next_multiple_of(BLOCK), absent);
        self.blocks.clear();
        self.blocks.resize(self.entries.len() / BLOCK, Block::EMPTY);
        for (place, &leaf) in order.iter().enumerate() {
            self.place_of[leaf as usize] = place as u32;
            self.entries[place].leaf = leaf;
        }
        for block in 0..self.blocks.len() {
            self.blocks[block].epoch = self.current_epoch as u32;
            self.blocks[block].background_drift = counts.background_drift();
        }
        for &leaf in &order {
            self.update(counts, leaf);
        }
        self.order = order;
    }

    /// Begins a step: `deviations` are those that costs are measured with.
    pub(super) fn begin_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.deviations.copy_from_slice(deviations);
        self.background_drift = counts.background_drift();
        if 2 * self.left < self.left_at_build && self.left_at_build > 4 * BLOCK {
            self.order.retain(|l| self.place_of[*l as usize] != NOWHERE);
            self.build(counts);
        }
        self.steps_in_epoch += 1;
        if self.steps_in_epoch >= STEPS_PER_EPOCH {
            self.begin_epoch(counts);
        }
        self.stand_against_epochs();
    }

    fn begin_epoch(&mut self, counts: &Counts<'_>) {
        self.steps_in_epoch = 0;
        let next = (self.current_epoch + 1) % EPOCHS;
        let still_in_use: Vec<usize> = (0..self.blocks.len())
            .filter(|b| self.blocks[*b].epoch as usize == next)
            .collect();
        self.epochs[next].snapshot.copy_from_slice(&self.deviations);
        self.current_epoch = next;
        self.stand_against_epochs();
        for block in still_in_use {
            self.refresh(counts, block);
        }
    }

    fn stand_against_epochs(&mut self) {
        for epoch in &mut self.epochs {
            (epoch.signed, epoch.drift) = (0, 0);
            for (d, e) in self.deviations.iter().zip(&epoch.snapshot) {
                epoch.signed += if *e < 0 { -d } else { *d };
                epoch.drift += (d - e).abs();
            }
        }
        self.deviation_sum = self.deviations.iter().map(|d| d.abs()).sum();
    }

    /// Takes a leaf out for good.
    pub(super) fn remove(&mut self, leaf: u32) {
        self.left -= 1;
        let place = std::mem::replace(&mut self.place_of[leaf as usize], NOWHERE);
        self.entries[place as usize].is_in = false;
        self.without_effect
            .remove(&(self.rank_of[leaf as usize], leaf));
    }

    /// Takes note of a leaf's new deltas; leaves that are gone are ignored.
    pub(super) fn update(&mut self, counts: &Counts<'_>, leaf: u32) {
        let place = self.place_of[leaf as usize];
        if place == NOWHERE {
            return;
        }
        let place = place as usize;
        let had_effect = self.entries[place].is_in;
        counts.deltas(leaf, &mut self.row);
        let has_effect = self.row.iter().any(|d| *d != 0);
        let key = (self.rank_of[leaf as usize], leaf);
        if has_effect {
            if !had_effect {
                self.without_effect.remove(&key);
            }
            let block = &mut self.blocks[place / BLOCK];
            let entry = &mut self.entries[place];
            entry.is_in = true;
            entry.background_px = counts.background_total(leaf);
            evaluate(entry, &self.row, &self.epochs[block.epoch as usize]);
            block.include(entry);
        } else {
            self.entries[place].is_in = false;
            self.without_effect.insert(key);
        }
    }

    /// Evaluates a block's leaves against the current epoch.
    fn refresh(&mut self, counts: &Counts<'_>, block: usize) {
        let mut fresh = Block {
            epoch: self.current_epoch as u32,
            background_drift: counts.background_drift(),
            ..Block::EMPTY
        };
        for entry in &mut self.entries[block * BLOCK..(block + 1) * BLOCK] {
            if entry.is_in {
                counts.deltas(entry.leaf, &mut self.row);
                evaluate(entry, &self.row, &self.epochs[self.current_epoch]);
                fresh.include(entry);
            }
        }
        self.blocks[block] = fresh;
    }

    fn cost(&mut self, counts: &Counts<'_>, leaf: u32) -> i64 {
        counts.deltas(leaf, &mut self.row);
        let terms = self.row.iter().zip(&self.deviations);
        terms.map(|(d, deviation)| (d + deviation).abs()).sum()
    }

    /// How far the background's term of a leaf may have moved.
    #[inline]
    fn slack(&self, block: &Block, background_px: u32) -> i64 {
        if background_px == 0 {
            return 0;
        }
        let drift = self.background_drift - block.background_drift;
        // Infinite drift saturates, which makes the bound say nothing.
        let moved = (f64::from(background_px) * drift).ceil() as i64;
        moved.saturating_add(self.rounding).min(i64::MAX / 4)
    }

    /// How many leaves the foliage had.
    pub(super) fn leaf_count(&self) -> usize {
        self.rank_of.len() - 1
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
        let mut bounds = std::mem::take(&mut self.bounds);
        bounds.clear();
        let mut lowest = (i64::MAX, 0);
        for (index, block) in self.blocks.iter().enumerate() {
            let epoch = &self.epochs[block.epoch as usize];
            let bound = (epoch.signed + block.least_h).max(block.least_c - epoch.drift)
                - self.slack(block, block.background_px);
            lowest = lowest.min((bound, index));
            bounds.push(bound);
        }
        if lowest.0 <= best.0 {
            self.scan_for_cheapest(counts, lowest.1, &mut best);
        }
        for (index, bound) in bounds.iter().enumerate() {
            if *bound <= best.0 && index != lowest.1 {
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

    fn scan_for_cheapest(&mut self, counts: &Counts<'_>, index: usize, best: &mut (i64, u32, u32)) {
        if self.blocks[index].epoch as usize != self.current_epoch {
            self.refresh(counts, index);
        }
        let block = self.blocks[index];
        let (signed, drift) = self.stand(&block);
        for at in index * BLOCK..(index + 1) * BLOCK {
            let entry = self.entries[at];
            if !entry.is_in {
                continue;
            }
            let bound =
                (signed + entry.h).max(entry.c - drift) - self.slack(&block, entry.background_px);
            if bound <= best.0 {
                let cost = self.cost(counts, entry.leaf);
                let rank = self.rank_of[entry.leaf as usize];
                *best = (*best).min((cost, rank, entry.leaf));
            }
        }
    }

    fn stand(&self, block: &Block) -> (i64, i64) {
        let epoch = &self.epochs[block.epoch as usize];
        (epoch.signed, epoch.drift)
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
            let bound = (self.deviation_sum + block.largest_n).min(block.largest_c + epoch.drift)
                + self.slack(block, block.background_px);
            if bound > best.0 {
                self.scan_for_largest(counts, index, &mut best);
            }
        }
        self.last_largest = best.1;
        best.0
    }

    fn scan_for_largest(&mut self, counts: &Counts<'_>, index: usize, best: &mut (i64, u32)) {
        if self.blocks[index].epoch as usize != self.current_epoch {
            self.refresh(counts, index);
        }
        let block = self.blocks[index];
        let (_, drift) = self.stand(&block);
        for at in index * BLOCK..(index + 1) * BLOCK {
            let entry = self.entries[at];
            let bound = (self.deviation_sum + entry.n).min(entry.c + drift)
                + self.slack(&block, entry.background_px);
            if entry.is_in && bound > best.0 {
                *best = (*best).max((self.cost(counts, entry.leaf), entry.leaf));
            }
        }
    }
}

/// h, c and n of a leaf with these deltas against an epoch.
fn evaluate(entry: &mut Entry, deltas: &[i64], epoch: &Epoch) {
    (entry.h, entry.c, entry.n) = (0, 0, 0);
    for (d, e) in deltas.iter().zip(&epoch.snapshot) {
        entry.h += if *e < 0 { -d } else { *d };
        entry.c += (d + e).abs();
        entry.n += d.abs();
    }
}
