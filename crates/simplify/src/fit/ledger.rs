//! Areas of all leaves in all views, and how far the VMI of the views is from that of
//! the original.

use secateur_raster::AreaTable;

use super::screen::{Moved, Seen};
use crate::lg::LgTable;
use crate::vmi::Vmi;

/// See the module.
pub(super) struct Ledger {
    table: LgTable,
    /// By view and leaf, the background first.
    areas_px: Vec<Vec<u32>>,
    totals_px: Vec<u32>,
    /// By view and leaf, lg(a/S), scaled: by how much the VMI of all views together
    /// changes with a pixel of this area, to the first order; 0 where there is none.
    lg_shares: Vec<Vec<i64>>,
    /// `P * (I(v;F') - I(v;F))`, scaled.
    deviations: Vec<i64>,
}

impl Ledger {
    /// For views that show this of the original, and this of what is left; rows of areas
    /// in pixels, the background first.
    pub(super) fn new(original_px: &[Vec<u32>], left_px: Vec<Vec<u32>>) -> Self {
        let table = LgTable::new();
        let vmi = |rows_px: &[Vec<u32>]| {
            let leaf_count = rows_px[0].len() - 1;
            let areas = AreaTable::from_rows(leaf_count, rows_px.concat());
            Vmi::of(&areas, &table)
        };
        let (original, left) = (vmi(original_px), vmi(&left_px));
        let pairs = left.scaled().iter().zip(original.scaled());
        let deviations = pairs.map(|(now, then)| now - then).collect();
        let mut totals_px = vec![0; left_px[0].len()];
        for row in &left_px {
            for (total, area_px) in totals_px.iter_mut().zip(row) {
                *total += area_px;
            }
        }
        let lg_shares = left_px.iter().map(|row| {
            let pairs = row.iter().zip(&totals_px);
            pairs.map(|(&a, &s)| lg_share(&table, a, s)).collect()
        });
        Self {
            lg_shares: lg_shares.collect(),
            table,
            areas_px: left_px,
            totals_px,
            deviations,
        }
    }

    /// `P * (I(v;F') - I(v;F))` per view, scaled.
    pub(super) fn deviations(&self) -> &[i64] {
        &self.deviations
    }

    /// By how much the VMI changes with each pixel of a leaf in a view, to the first order,
    /// scaled; the background first, 0 for leaves that are not seen.
    pub(super) fn pixel_values(&self, view: usize) -> &[i64] {
        &self.lg_shares[view]
    }

    /// By how much less J is, scaled, if a leaf takes the size of this number of those
    /// at which the views saw it, of which it has the first; with the weight of a pixel
    /// of outline.
    pub(super) fn gain(&self, seen: &[&[Seen; 3]], size: usize, outline_unit: i64) -> i128 {
        let total = |size: usize| seen.iter().map(|view| view[size].area_px).sum::<u32>();
        let totals = [total(0), total(size)];
        let value = |seen: &Seen, total: u32| self.term(seen.area_px, total) - seen.worth_to_others;
        let mut gain = 0i128;
        for (view, &deviation) in seen.iter().zip(&self.deviations) {
            let [now, then] = [&view[0], &view[size]];
            let change = value(then, totals[1]) - value(now, totals[0]);
            gain += i128::from(then.outline_px - now.outline_px) * i128::from(outline_unit);
            gain += i128::from(deviation.abs()) - i128::from((deviation + change).abs());
        }
        gain
    }

    /// Areas that changed, view by view.
    pub(super) fn apply(&mut self, moved: &[Moved]) {
        let leaves = moved.iter().flatten().map(|(leaf, _)| *leaf as usize);
        let mut leaves: Vec<usize> = leaves.collect();
        leaves.sort_unstable();
        leaves.dedup();
        self.add_terms(&leaves, -1);
        for (row, moved) in self.areas_px.iter_mut().zip(moved) {
            for &(leaf, px) in moved {
                let leaf = leaf as usize;
                let area_px = row[leaf].wrapping_add_signed(px);
                self.totals_px[leaf] = self.totals_px[leaf] - row[leaf] + area_px;
                row[leaf] = area_px;
            }
        }
        self.add_terms(&leaves, 1);
        for (row, lg_shares) in self.areas_px.iter().zip(&mut self.lg_shares) {
            for &leaf in &leaves {
                lg_shares[leaf] = lg_share(&self.table, row[leaf], self.totals_px[leaf]);
            }
        }
    }

    fn add_terms(&mut self, leaves: &[usize], sign: i64) {
        for (view, row) in self.areas_px.iter().enumerate() {
            let terms = leaves
                .iter()
                .map(|&leaf| self.term(row[leaf], self.totals_px[leaf]));
            let sum: i64 = terms.sum();
            self.deviations[view] += sign * sum;
        }
    }

    /// a lg(a/S), scaled.
    fn term(&self, area_px: u32, total_px: u32) -> i64 {
        match area_px {
            0 => 0,
            _ => self.table.term(area_px, self.table.lg(total_px)),
        }
    }
}

/// lg(a/S), scaled; 0 for no area.
fn lg_share(table: &LgTable, area_px: u32, total_px: u32) -> i64 {
    match area_px {
        0 => 0,
        _ => table.lg(area_px) - table.lg(total_px),
    }
}
