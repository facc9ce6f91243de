//! Areas of all leaves in all views, and how far the VMI of the views is from that of
//! the original.

use secateur_raster::AreaTable;
use smallvec::SmallVec;

use super::screen::{Moved, Seen};
use crate::lg::LgTable;
use crate::vmi::Vmi;

/// Of the information of a view one part in so many is free.
const FREE: i64 = 400;

/// Much is one part in so many of all information, or what was missing at first if that
/// is more.
const MUCH: i128 = 10;

/// Each bit above much counts so many times more.
const DEAR: i128 = 3;

/// See the module.
pub(super) struct Ledger {
    table: LgTable,
    /// By view and leaf, the background first.
    areas_px: Vec<Vec<u32>>,
    /// By view the set that it is of.
    set_of: Vec<usize>,
    /// By set and leaf.
    totals_px: Vec<Vec<u32>>,
    /// By view and leaf, lg(a/S), scaled: by how much the VMI of all views of its set together
    /// changes with a pixel of this area, to the first order; 0 where there is none.
    lg_shares: Vec<Vec<i64>>,
    /// `P * (I(v;F') - I(v;F))`, scaled.
    deviations: Vec<i64>,
    price: Price,
}

/// What it costs that information is missing, or too much.
struct Price {
    /// How much of each view's is free.
    free: Vec<i64>,
    /// Above which all together is dear.
    much: i128,
}

impl Price {
    fn new(original: &[i64], deviations: &[i64]) -> Self {
        let information: i128 = original.iter().map(|bits| i128::from(*bits)).sum();
        Self {
            // Rounding may leave next to nothing below 0.
            free: original.iter().map(|bits| bits.max(&0) / FREE).collect(),
            much: magnitude(deviations).max(information / MUCH),
        }
    }

    fn of(&self, deviations: &[i64]) -> i128 {
        let pairs = deviations.iter().zip(&self.free);
        let costs = pairs.map(|(deviation, free)| i128::from((deviation.abs() - free).max(0)));
        costs.sum::<i128>() + DEAR * (magnitude(deviations) - self.much).max(0)
    }
}

impl Ledger {
    /// For views that show this of the original, and this of what is left; rows of areas
    /// in pixels, the background first. Each set has so many of the views.
    pub(super) fn new(
        set_lengths: &[usize],
        original_px: &[Vec<u32>],
        left_px: Vec<Vec<u32>>,
    ) -> Self {
        let table = LgTable::new();
        let sets = set_lengths.iter().enumerate();
        let set_of: Vec<usize> = sets
            .flat_map(|(set, length)| std::iter::repeat_n(set, *length))
            .collect();
        let vmi = |rows_px: &[Vec<u32>]| {
            let leaf_count = rows_px[0].len() - 1;
            let mut left = rows_px;
            let mut scaled: Vec<i64> = Vec::with_capacity(rows_px.len());
            for length in set_lengths {
                let (set, others) = left.split_at(*length);
                let areas = AreaTable::from_rows(leaf_count, set.concat());
                scaled.extend_from_slice(Vmi::of(&areas, &table).scaled());
                left = others;
            }
            scaled
        };
        let (original, left) = (vmi(original_px), vmi(&left_px));
        let pairs = left.iter().zip(&original);
        let deviations: Vec<i64> = pairs.map(|(now, then)| now - then).collect();
        let mut totals_px = vec![vec![0; left_px[0].len()]; set_lengths.len()];
        for (row, set) in left_px.iter().zip(&set_of) {
            for (total, area_px) in totals_px[*set].iter_mut().zip(row) {
                *total += area_px;
            }
        }
        let lg_shares = left_px.iter().zip(&set_of).map(|(row, set)| {
            let pairs = row.iter().zip(&totals_px[*set]);
            pairs.map(|(&a, &s)| lg_share(&table, a, s)).collect()
        });
        Self {
            lg_shares: lg_shares.collect(),
            table,
            areas_px: left_px,
            set_of,
            totals_px,
            price: Price::new(&original, &deviations),
            deviations,
        }
    }

    /// J without the outline, scaled.
    pub(super) fn cost(&self) -> i128 {
        self.price.of(&self.deviations)
    }

    /// Whether the views tell as much as the original, but for twice what is free.
    pub(super) fn tells_as_much(&self) -> bool {
        self.cost() <= self.price.free.iter().copied().map(i128::from).sum()
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
        let mut totals: SmallVec<[[u32; 2]; 4]> = SmallVec::from_elem([0; 2], self.totals_px.len());
        for (view, set) in seen.iter().zip(&self.set_of) {
            totals[*set][0] += view[0].area_px;
            totals[*set][1] += view[size].area_px;
        }
        let value = |seen: &Seen, total: u32| self.term(seen.area_px, total) - seen.worth_to_others;
        let outline_px = seen
            .iter()
            .map(|view| view[size].outline_px - view[0].outline_px);
        let views = seen.iter().zip(&self.deviations).zip(&self.set_of);
        let deviations = views.map(|((view, deviation), set)| {
            let [now, then] = totals[*set];
            deviation + value(&view[size], then) - value(&view[0], now)
        });
        let deviations: SmallVec<[i64; 64]> = deviations.collect();
        i128::from(outline_px.sum::<i64>()) * i128::from(outline_unit) + self.cost()
            - self.price.of(&deviations)
    }

    /// Areas that changed, view by view.
    pub(super) fn apply(&mut self, moved: &[Moved]) {
        let leaves = moved.iter().flatten().map(|(leaf, _)| *leaf as usize);
        let mut leaves: Vec<usize> = leaves.collect();
        leaves.sort_unstable();
        leaves.dedup();
        self.add_terms(&leaves, -1);
        let views = self.areas_px.iter_mut().zip(&self.set_of);
        for ((row, set), moved) in views.zip(moved) {
            let totals_px = &mut self.totals_px[*set];
            for &(leaf, px) in moved {
                let leaf = leaf as usize;
                let area_px = row[leaf].wrapping_add_signed(px);
                totals_px[leaf] = totals_px[leaf] - row[leaf] + area_px;
                row[leaf] = area_px;
            }
        }
        self.add_terms(&leaves, 1);
        let views = self.areas_px.iter().zip(&self.set_of);
        for ((row, set), lg_shares) in views.zip(&mut self.lg_shares) {
            for &leaf in &leaves {
                lg_shares[leaf] = lg_share(&self.table, row[leaf], self.totals_px[*set][leaf]);
            }
        }
    }

    fn add_terms(&mut self, leaves: &[usize], sign: i64) {
        let views = self.areas_px.iter().zip(&self.set_of).enumerate();
        for (view, (row, set)) in views {
            let terms = leaves
                .iter()
                .map(|&leaf| self.term(row[leaf], self.totals_px[*set][leaf]));
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

/// All of them together, whichever way they are.
fn magnitude(deviations: &[i64]) -> i128 {
    let sizes = deviations.iter().map(|d| i128::from(d.unsigned_abs()));
    sizes.sum()
}

/// lg(a/S), scaled; 0 for no area.
fn lg_share(table: &LgTable, area_px: u32, total_px: u32) -> i64 {
    match area_px {
        0 => 0,
        _ => table.lg(area_px) - table.lg(total_px),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_little_is_free_and_much_is_dear() {
        // Free: 10 and 20; much: 1201, a tenth of all, or what was missing.
        let information = [4000, 8020, -10];
        let price = Price::new(&information, &[-100, 0, 0]);
        assert_eq!(price.of(&[-10, 20, 0]), 0);
        assert_eq!(price.of(&[-11, 22, 3]), 1 + 2 + 3);
        assert_eq!(price.of(&[10, -1190, 0]), 1170);
        assert_eq!(price.of(&[-10, 1192, 0]), 1172 + 3);
        let price = Price::new(&information, &[-1300, 100, 0]);
        assert_eq!(price.of(&[-10, 1390, 0]), 1370);
        assert_eq!(price.of(&[-10, 1391, 1]), 1371 + 1 + 3 * 2);
    }
}
