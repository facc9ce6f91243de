//! Which leaf stands in which lane of which block, and how that is kept up to date with
//! what a step changed.

use secateur_raster::prefetch::prefetch;

use super::super::changes::Change;
use super::super::deltas::Sight;
use super::super::switches::{Mechanism, is_on};
use super::blocks::{Figures, NO_FIRST};
use super::epochs::along_signs;
use super::excess::{LANES, Lanes};
use super::{Candidates, NOWHERE};

/// What is known of a block's leaves beside their deltas.
#[derive(Clone)]
pub(super) struct BlockLanes {
    /// 0 where none is.
    pub leaves: [u32; LANES],
    /// Pixels that each would hand to the background.
    pub background_px: [u32; LANES],
    /// The step in which each was read.
    pub read_in: [u32; LANES],
    /// Drift of the background where it is revealed, when the leaf was read.
    pub drift: Lanes,
    /// What the deltas of each sum to with the block's signs, exactly, if it
    /// is solid.
    pub along: [i64; LANES],
}

impl BlockLanes {
    pub(super) const EMPTY: Self = Self {
        leaves: [0; LANES],
        background_px: [0; LANES],
        read_in: [0; LANES],
        drift: Lanes::ZERO,
        along: [i64::MAX; LANES],
    };
}

impl Candidates {
    /// Takes a leaf of any shard out for good.
    pub(in super::super) fn remove(&mut self, leaf: u32) {
        self.all_left -= 1;
        if self.place_of[leaf as usize] == NOWHERE {
            return;
        }
        self.leave(leaf);
        self.place_of[leaf as usize] = NOWHERE;
        let rank = self.rank_of[leaf as usize];
        self.without_effect.remove(&(rank, leaf));
    }

    pub(super) fn leave(&mut self, leaf: u32) {
        let place = self.place_of[leaf as usize] as usize;
        let (block, lane) = (place / LANES, place % LANES);
        if self.lanes[block].leaves[lane] == 0 {
            return;
        }
        let lanes = &mut self.lanes[block];
        lanes.leaves[lane] = 0;
        self.blocks[block].present &= !(1 << lane);
        lanes.background_px[lane] = 0;
        lanes.along[lane] = i64::MAX;
        if self.blocks[block].first.2 == leaf {
            self.find_first(block);
        }
        for row in &mut self.deltas[block * self.view_count..(block + 1) * self.view_count] {
            row.0[lane] = 0.0;
        }
    }

    pub(super) fn find_first(&mut self, index: usize) {
        let lanes = &self.lanes[index];
        let lanes = lanes.along.iter().zip(lanes.leaves);
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
                self.filter.set(index, block.bounds());
                self.tops[index] = block.top();
            }
            _ => self.enter(sight, leaf),
        }
    }

    /// Notes the exact sum of a leaf's deltas with the signs that the deviations
    /// have now, and what that makes of its block's first.
    pub(super) fn note_sum(&mut self, (index, lane): (usize, usize), leaf: u32, along_now: i64) {
        let block = &mut self.blocks[index];
        let lanes = &mut self.lanes[index];
        let is_known = lanes.background_px[lane] == 0 && block.signs == self.signs;
        let along = if is_known { along_now } else { i64::MAX };
        lanes.along[lane] = along;
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

    /// Puts a leaf where its deltas say.
    pub(super) fn enter(&mut self, sight: Sight<'_>, leaf: u32) {
        let place = self.place_of[leaf as usize] as usize;
        let rank = self.rank_of[leaf as usize];
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
        if self.lanes[index].leaves[lane] == 0 {
            self.without_effect.remove(&(rank, leaf));
        }
        let rise = sight.counts.background_rise(background_px);
        let block = &mut self.blocks[index];
        let epoch = usize::from(block.epoch);
        let then = self.epochs.deviations(epoch);
        let (mut excess, mut n, mut magnitude, mut widest) = (0, 0, 0, 0);
        let background = sight.counts.areas(0);
        let widths = &mut self.widths[index * self.view_count..][..self.view_count];
        let views = self.row.iter().zip(then).zip(background).zip(widths);
        let mut along = 0;
        for (((d, e), area), width) in views {
            let risen = (u64::from(*area) * rise) as i64;
            magnitude += d.abs() + risen;
            let d = d - risen;
            excess += (d + e).abs() - e.abs();
            n += d.abs();
            widest = widest.max(d.abs());
            *width = width.with(d as f32);
            along += if *e < 0 { -d } else { d };
        }
        let figures = Figures {
            along: along as f32,
            excess: excess as f32,
            n: n as f32,
            magnitude: magnitude as f32,
            widest: widest as f32,
            background_px,
        };
        block.include(&figures, self.rounding);
        block.present |= 1 << lane;
        self.filter.set(index, block.bounds());
        self.tops[index] = block.top();
        let lanes = &mut self.lanes[index];
        lanes.leaves[lane] = leaf;
        lanes.background_px[lane] = background_px;
        self.write_row((index, lane));
        if is_on(Mechanism::ExactFirst) {
            let along_now = along_signs(&self.row, &self.deviations);
            self.note_sum((index, lane), leaf, along_now);
        }
    }

    /// The exact sums of a block's deltas with the signs that the deviations
    /// have now.
    pub(super) fn renew_firsts(&mut self, sight: Sight<'_>, index: usize) {
        for lane in 0..LANES {
            let leaf = self.lanes[index].leaves[lane];
            if leaf != 0 && self.lanes[index].background_px[lane] == 0 {
                sight.deltas_but_rise(leaf, &mut self.row);
                self.lanes[index].along[lane] = along_signs(&self.row, &self.deviations);
            }
        }
        self.blocks[index].signs = self.signs;
        self.find_first(index);
    }
}
