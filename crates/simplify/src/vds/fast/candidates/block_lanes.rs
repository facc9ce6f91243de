//! Which leaf stands in which lane of which block, and how that is kept up to date with
//! what a step changed.

use secateur_raster::prefetch::prefetch;

use super::super::changes::Change;
use super::super::deltas::Sight;
use super::super::switches::{Mechanism, is_on};
use super::blocks::{Block, Figures, NO_FIRST};
use super::epochs::along_signs;
use super::excess::{LANES, Lanes};
use super::widths::Width;
use super::{Candidates, FIRST_GROUP, NOWHERE, WAITING};

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
    /// is solid; without signs where costs do not depend on deviations.
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
        self.move_to(leaf, NOWHERE);
    }

    /// Gives a leaf a place outside the blocks, instead of its own.
    pub(super) fn move_to(&mut self, leaf: u32, place: u32) {
        let before = std::mem::replace(&mut self.place_of[leaf as usize], place);
        if before == place {
            return;
        }
        self.has_moved_out |= place != NOWHERE;
        let ranked = (self.rank_of[leaf as usize], leaf);
        match before {
            NOWHERE => {}
            WAITING => {
                self.without_effect.remove(&ranked);
            }
            group if group >= FIRST_GROUP => self.alike.remove(group, ranked),
            lane => self.leave(lane),
        }
        match place {
            NOWHERE => {}
            WAITING => {
                self.without_effect.insert(ranked);
            }
            group => self.alike.insert(group, ranked),
        }
    }

    fn leave(&mut self, place: u32) {
        let (block, lane) = (place as usize / LANES, place as usize % LANES);
        let leaf = self.lanes[block].leaves[lane];
        if leaf == 0 {
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
        if place < FIRST_GROUP {
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
        match place {
            NOWHERE => return,
            outside if outside >= FIRST_GROUP => return self.enter(sight, leaf),
            _ => {}
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
        let background_px = sight.deltas_but_rise(leaf, &mut self.row);
        if let Some(place) = self.place_outside(sight, leaf, background_px) {
            return self.move_to(leaf, place);
        }
        if self.place_of[leaf as usize] >= FIRST_GROUP {
            self.move_to(leaf, NOWHERE);
            self.add_place(leaf);
        }
        let place = self.place_of[leaf as usize] as usize;
        let (index, lane) = (place / LANES, place % LANES);
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
            along: if self.has_deviations { along } else { n } as f32,
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
            self.note_sum((index, lane), leaf, self.along_now());
        }
    }

    /// The place of the leaf that was just read, if it is outside the blocks.
    pub(super) fn place_outside(
        &self,
        sight: Sight<'_>,
        leaf: u32,
        background_px: u32,
    ) -> Option<u32> {
        match self.is_without_effect(background_px) {
            true => Some(WAITING),
            false => self.place_of_alike(sight, leaf),
        }
    }

    /// Gives a leaf the place after the last, in a block that may be new.
    fn add_place(&mut self, leaf: u32) {
        self.place_of[leaf as usize] = self.order.len() as u32;
        self.order.push(leaf);
        if self.order.len() <= self.blocks.len() * LANES {
            return;
        }
        let empty = Block::empty(self.epochs.current(), self.signs);
        self.filter.push(empty.bounds());
        self.tops.push(empty.top());
        self.lanes.push(BlockLanes::EMPTY);
        self.blocks.push(empty);
        let views = self.blocks.len() * self.view_count;
        self.deltas.resize(views, Lanes::ZERO);
        self.widths.resize(views, Width::ZERO);
    }

    /// The excess of the solid leaf that was just read, if no delta is larger than the deviation of its view; exactly.
    pub(super) fn along_now(&self) -> i64 {
        match self.has_deviations {
            true => along_signs(&self.row, &self.deviations),
            false => self.row.iter().map(|d| d.abs()).sum(),
        }
    }

    /// The exact sums of a block's deltas with the signs that the deviations
    /// have now.
    pub(super) fn renew_firsts(&mut self, sight: Sight<'_>, index: usize) {
        for lane in 0..LANES {
            let leaf = self.lanes[index].leaves[lane];
            if leaf != 0 && self.lanes[index].background_px[lane] == 0 {
                sight.deltas_but_rise(leaf, &mut self.row);
                self.lanes[index].along[lane] = self.along_now();
            }
        }
        self.blocks[index].signs = self.signs;
        self.find_first(index);
    }
}
