//! Evaluating a block: reading what changed of its leaves, then all their excesses at
//! once, from which its bounds are renewed.

use secateur_raster::prefetch::{prefetch, prefetch_range};

use super::super::deltas::Sight;
use super::super::switches::{Mechanism, is_on};
use super::Candidates;
use super::drift::{drift_now, drift_then};
use super::excess::{Beside, Excesses, LANES, Lanes, excesses};

impl Candidates {
    /// Evaluates a block's leaves against the current epoch.
    pub(super) fn evaluate(&mut self, sight: Sight<'_>, index: usize) -> Excesses {
        if is_on(Mechanism::PrefetchBlocks) {
            prefetch(&self.lanes, index);
            prefetch_range(&self.deltas, index * self.view_count, self.view_count);
        }
        self.bring_up_to_date(sight, index);
        let (mut rises, mut moved) = (Lanes::ZERO, Lanes::ZERO);
        let (mut open, mut solid) = (Lanes::INFINITE, Lanes::INFINITE);
        let mut largest_px = 0;
        for lane in 0..LANES {
            if self.blocks[index].present >> lane & 1 == 0 {
                continue;
            }
            match self.lanes[index].background_px[lane] {
                0 => solid.0[lane] = 0.0,
                px => {
                    open.0[lane] = 0.0;
                    rises.0[lane] = match self.rises.get(px as usize) {
                        Some(rise) if is_on(Mechanism::RiseTable) => *rise as f32,
                        _ => sight.counts.background_rise(px) as f32,
                    };
                    moved.0[lane] = self.moved_since_read((index, lane));
                    largest_px = largest_px.max(px);
                }
            }
        }
        let views = index * self.view_count..(index + 1) * self.view_count;
        let beside = Beside {
            rises: &rises,
            moved: &moved,
            open: &open,
            solid: &solid,
        };
        let (rows, widths) = (&self.deltas[views.clone()], &mut self.widths[views]);
        let mut found = excesses(rows, beside, &self.views, widths);
        if !self.has_deviations {
            // Better bounds, as an excess is `n`.
            (found.least_along_solid, found.least_along_open) =
                (found.least_solid, found.least_open);
        }
        let block = &mut self.blocks[index];
        let epoch = self.epochs.current();
        block.renew(epoch, &found, largest_px, self.rounding);
        self.filter.set(index, block.bounds());
        self.tops[index] = block.top();
        found
    }

    /// How far the terms of the pixels that a leaf would hand to the background
    /// may have moved, in the views in which it does, since it was read.
    fn moved_since_read(&self, (index, lane): (usize, usize)) -> f32 {
        let lanes = &self.lanes[index];
        let px = lanes.background_px[lane];
        let drift = drift_now(self.drift.revealed) - lanes.drift.0[lane];
        self.rounding.of_revealed(px as f32) + px as f32 * drift
    }

    /// Reads the deltas of a block's outdated leaves: only those changed, neither
    /// the leaves nor their edges.
    fn bring_up_to_date(&mut self, sight: Sight<'_>, index: usize) {
        let mut outdated = std::mem::take(&mut self.blocks[index].outdated);
        if outdated == 0 {
            return;
        }
        self.blocks[index].is_up_to_date();
        let leaves = self.lanes[index].leaves.iter().enumerate();
        let leaves = leaves.filter(|(lane, leaf)| outdated >> lane & 1 == 1 && **leaf != 0);
        let leaves = leaves.map(|(_, leaf)| *leaf);
        if is_on(Mechanism::PrefetchBlocks) {
            leaves.clone().for_each(|leaf| sight.prefetch_place(leaf));
            leaves.for_each(|leaf| sight.prefetch(leaf));
        }
        while outdated != 0 {
            let lane = outdated.trailing_zeros() as usize;
            outdated &= outdated - 1;
            let leaf = self.lanes[index].leaves[lane];
            if leaf != 0 {
                self.read_again(sight, (index, lane), leaf);
            }
        }
    }

    fn read_again(&mut self, sight: Sight<'_>, (index, lane): (usize, usize), leaf: u32) {
        let background_px = sight.deltas_but_rise(leaf, &mut self.row);
        if let Some(place) = self.place_outside(sight, leaf, background_px) {
            return self.move_to(leaf, place);
        }
        self.write_row((index, lane));
        if is_on(Mechanism::ExactFirst) {
            self.note_sum((index, lane), leaf, self.along_now());
        }
    }

    /// Takes the deltas that were just read as those of a lane.
    pub(super) fn write_row(&mut self, (index, lane): (usize, usize)) {
        let rows = &mut self.deltas[index * self.view_count..][..self.view_count];
        for (row, d) in rows.iter_mut().zip(&self.row) {
            row.0[lane] = *d as f32;
        }
        let lanes = &mut self.lanes[index];
        lanes.read_in[lane] = self.epochs.step();
        lanes.drift.0[lane] = drift_then(self.drift.revealed);
    }
}
