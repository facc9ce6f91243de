//! Where leaves have their places, and how those are kept up to date.

use super::super::changes::Change;
use super::super::deltas::Sight;
use super::super::prefetch::prefetch;
use super::super::switches::{Mechanism, is_on};
use super::blocks::{Figures, NO_FIRST};
use super::epochs::{along, along_signs};
use super::excess::{LANES, Lanes};
use super::{Candidates, NOWHERE};

/// What is known of a block's leaves beside their deltas.
#[derive(Clone)]
pub(super) struct Residents {
    /// 0 where none is.
    pub leaves: [u32; LANES],
    /// Pixels that each would hand to the background.
    pub background_px: [u32; LANES],
    /// The most of them in a view, or more than anybody asks for.
    pub most_revealed: [u8; LANES],
    /// The step in which each was read.
    pub read_in: [u32; LANES],
    /// Drift of the background where it is revealed, when the leaf was read.
    pub drift: Lanes,
    /// What the deltas of each sum to with the block's signs, exactly, if it
    /// is solid.
    pub along: [i64; LANES],
}

impl Residents {
    pub(super) const NOBODY: Self = Self {
        leaves: [0; LANES],
        background_px: [0; LANES],
        most_revealed: [0; LANES],
        read_in: [0; LANES],
        drift: Lanes::ZERO,
        along: [i64::MAX; LANES],
    };
}

impl Candidates {
    /// Takes a leaf of any shard out for good.
    pub(in super::super) fn remove(&mut self, sight: Sight<'_>, leaf: u32) {
        self.all_left -= 1;
        if self.place_of[leaf as usize] == NOWHERE {
            return;
        }
        self.leave(leaf);
        self.place_of[leaf as usize] = NOWHERE;
        let rank = self.rank_of[leaf as usize];
        self.without_effect.remove(&(rank, leaf));
        if let Some(twin) = self.twins.leave(rank, leaf) {
            self.enter(sight, twin);
        }
    }

    pub(super) fn leave(&mut self, leaf: u32) {
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

    pub(super) fn find_first(&mut self, index: usize) {
        let residents = &self.residents[index];
        let lanes = residents.along.iter().zip(residents.leaves);
        let known = lanes.filter(|(along, _)| **along != i64::MAX);
        let firsts = known.map(|(&along, leaf)| (along, self.rank_of[leaf as usize], leaf));
        self.blocks[index].first = firsts.fold(NO_FIRST, std::cmp::min);
    }

    /// Asks for where a leaf has its place.
    pub(in super::super) fn prefetch_place(&self, leaf: Option<u32>) {
        if !is_on(Mechanism::PrefetchBlocks) {
            return;
        }
        if let Some(leaf) = leaf {
            prefetch(&self.place_of, leaf as usize);
        }
    }

    /// Asks for the memory that [`note`](Self::note) of a leaf will need.
    pub(in super::super) fn prefetch(&self, leaf: Option<u32>) {
        if !is_on(Mechanism::PrefetchBlocks) {
            return;
        }
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
    pub(in super::super) fn note(&mut self, sight: Sight<'_>, leaf: u32, change: Change) {
        let place = self.place_of[leaf as usize];
        if place == NOWHERE {
            return;
        }
        let (index, lane) = (place as usize / LANES, place as usize % LANES);
        let block = &mut self.blocks[index];
        match change.of_others() {
            Some(change) if block.present >> lane & 1 == 1 && is_on(Mechanism::LazyReading) => {
                block.outdate(lane, change);
                self.gates.set(index, block.gate());
                self.tops[index] = block.top();
            }
            _ => self.update(sight, leaf),
        }
    }

    /// Notes the exact sum of a leaf's deltas with the signs that the deviations
    /// have now, and what that makes of its block's first.
    pub(super) fn stand(&mut self, (index, lane): (usize, usize), leaf: u32, along_now: i64) {
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
    pub(super) fn enter(&mut self, sight: Sight<'_>, leaf: u32) {
        let place = self.place_of[leaf as usize] as usize;
        let rank = self.rank_of[leaf as usize];
        if self.twins.is_hidden(rank, leaf) {
            self.leave(leaf);
            self.without_effect.remove(&(rank, leaf));
            return;
        }
        let (index, lane) = (place / LANES, place % LANES);
        let background_px = sight.deltas_but_rise(leaf, &mut self.row);
        if is_on(Mechanism::ZeroLeavesWait)
            && background_px == 0
            && self.row.iter().all(|d| *d == 0)
        {
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
        let along_then = match is_on(Mechanism::BackgroundAlong) {
            true => {
                along_signs(&self.row, then)
                    - self
                        .epochs
                        .risen_along(epoch, background_px, sight.counts.table)
            }
            false => along_signs(&self.row, then) - along(then, background) * rise as i64,
        };
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
        if is_on(Mechanism::ExactFirst) {
            let along_now = along_signs(&self.row, &self.deviations);
            self.stand((index, lane), leaf, along_now);
        }
    }

    /// The exact sums of a block's deltas with the signs that the deviations
    /// have now.
    pub(super) fn renew_firsts(&mut self, sight: Sight<'_>, index: usize) {
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
