//! Areas, and what they say about pruning each leaf.
//!
//! If leaf l goes, it hands `r_o(v)` of its pixels in view v to leaf o behind it, `s_o` over
//! all views, and with `f(a, S) = a (lg a - lg S)`, the terms of VMI
//! ([`incremental`](secateur_raster::measure::incremental)), P times the VMI of *every* view
//! changes by
//!
//! ```text
//! -f(a_l(v), S_l) + sum_o [ f(a_o(v) + r_o(v), S_o + s_o) - f(a_o(v), S_o) ]
//! ```
//!
//! The pairs (l, o) with s_o > 0 are few: *reveal edges*, kept in
//! [`Edges`](super::edges::Edges). Here are the areas, as they are and as they
//! were before the step; [`Deltas`](super::deltas::Deltas) keeps those sums.
//!
//! The background is apart: nearly every step changes its area, and nearly
//! every leaf at the silhouette has an edge to it. Its term is evaluated fresh, with
//! [`Counts::background_gain`]; [`Counts::background_drift`] bounds how far it has
//! moved.

use std::ops::Deref;

use secateur_raster::AreaTable;
use secateur_raster::abuffer::Event;
use secateur_raster::measure::incremental::{IncrementalVmi, LeafAreas};
use secateur_raster::measure::rows::Rows;
use secateur_raster::measure::vmi::Vmi;

use super::changes::BackgroundDrift;
use super::switches::{Mechanism, is_on};
use crate::lg::{LG_FRACTION_BITS, LgTable};

/// Pixels of a view for which what the background gains by them is kept.
const GAINS: usize = 8;

/// Leaves times views up to which tables have rows for all leaves, most of which are zeros where
/// there are very many: rows of some take a look-up more.
const MOST_ROWS_OF_ALL: usize = 1 << 22;

/// Areas and VMI, measured from that of the original foliage, with what bounds need to know
/// of the background.
#[derive(Clone)]
pub(super) struct Counts<'t> {
    pub table: &'t LgTable,
    has_rows_of_all: bool,
    vmi: IncrementalVmi<'t>,
    /// Pixels of all views together, background included.
    pixels: u32,
    background_drift: BackgroundDrift,
    /// `n lg n` of the background with 1, 2, ... pixels more, less without, by
    /// view.
    background_gains: Vec<[i64; GAINS]>,
    /// The areas of the background that those are for.
    gains_at: Vec<u32>,
    background_jumps: u32,
}

/// Areas are read as they are there, and changed by [`Counts`] alone.
impl<'t> Deref for Counts<'t> {
    type Target = IncrementalVmi<'t>;

    #[inline]
    fn deref(&self) -> &IncrementalVmi<'t> {
        &self.vmi
    }
}

impl<'t> Counts<'t> {
    /// The counts of areas in views of `pixels_per_view` pixels.
    pub(super) fn new(areas: &AreaTable, pixels_per_view: u32, table: &'t LgTable) -> Self {
        let view_count = areas.view_count();
        let has_rows_of_all = is_on(Mechanism::RowsOfAll)
            && (areas.leaf_count() + 1) * view_count <= MOST_ROWS_OF_ALL;
        let mut counts = Self {
            table,
            has_rows_of_all,
            vmi: match has_rows_of_all {
                true => IncrementalVmi::new(areas, table),
                false => IncrementalVmi::of_seen(areas, table),
            },
            pixels: pixels_per_view * view_count as u32,
            background_drift: BackgroundDrift::default(),
            background_gains: vec![[0; GAINS]; view_count],
            gains_at: vec![u32::MAX; view_count],
            background_jumps: 0,
        };
        counts.note_gains();
        counts
    }

    /// The rows of another table by leaves or some of them, up to `count`.
    pub(super) fn rows(&self, count: usize) -> Rows {
        match self.has_rows_of_all {
            true => Rows::of_all(count),
            false => Rows::of_some(count),
        }
    }

    /// A leaf as edges lead to it; the background for 0.
    #[inline]
    pub(super) fn target(&self, leaf: u32) -> LeafAreas<'_> {
        self.vmi.leaf(leaf)
    }

    /// A leaf as it was before the step.
    pub(super) fn target_before(&self, leaf: u32) -> LeafAreas<'_> {
        let before = self.vmi.changed_from(leaf);
        before.unwrap_or_else(|| self.vmi.leaf(leaf))
    }

    /// Measures VMI from that of the original foliage.
    pub(super) fn measure_from(&mut self, original: &Vmi) {
        self.vmi.measure_from(original);
    }

    /// Takes note of a change at the front of some pixels.
    #[inline]
    pub(super) fn record(&mut self, event: &Event) {
        self.vmi.record(event);
    }

    /// Ends the recording of a step: brings VMI up to date.
    pub(super) fn settle(&mut self) {
        self.note_background();
        if self.vmi.changed_from(0).is_some() {
            self.note_gains();
        }
        self.vmi.settle();
    }

    /// Forgets what was before the step.
    pub(super) fn forget_step(&mut self) {
        self.vmi.forget_step();
    }

    /// Pixels over all views that show foliage.
    pub(super) fn covered_px(&self) -> u64 {
        u64::from(self.pixels - self.target(0).total)
    }

    /// How far the background's terms have moved since the beginning.
    pub(super) fn background_drift(&self) -> BackgroundDrift {
        self.background_drift
    }

    /// Counts the steps whose change of the background has no such bound: all
    /// of its terms must be evaluated anew.
    pub(super) fn background_jumps(&self) -> u32 {
        self.background_jumps
    }

    /// By how much the logarithm of the background's total would rise with so
    /// many pixels more.
    #[inline]
    pub(super) fn background_rise(&self, pixels: u32) -> u64 {
        match pixels {
            0 => 0,
            pixels => {
                let background = self.target(0);
                background.rise(self.table.lg(background.total + pixels))
            }
        }
    }

    /// [`background_rise`](Self::background_rise) of 0, 1, 2, ... pixels.
    pub(super) fn background_rises(&self, rises: &mut [u32]) {
        let background = self.target(0);
        let Some((none, some)) = rises.split_first_mut() else {
            return;
        };
        *none = 0;
        self.table.lg_from(background.total + 1, some);
        let lg_total = background.lg_total as u32;
        some.iter_mut().for_each(|rise| *rise -= lg_total);
    }

    /// What the term of the background gains by some pixels more in a view, but for
    /// its total: `n lg n` with them less without.
    #[inline]
    pub(super) fn background_gain(&self, view: u32, pixels: u32) -> i64 {
        match self.background_gains[view as usize].get(pixels as usize - 1) {
            Some(gain) => *gain,
            None => {
                let area = self.areas(0)[view as usize];
                self.table.n_lg_n(area + pixels) - self.table.n_lg_n(area)
            }
        }
    }

    fn note_gains(&mut self) {
        let background = self.vmi.areas(0);
        let views = self.gains_at.iter_mut().zip(&mut self.background_gains);
        for (&area, (gains_at, gains)) in background.iter().zip(views) {
            // Mostly a step changes it in few views.
            if std::mem::replace(gains_at, area) != area {
                let without = self.table.n_lg_n(area);
                let with = |pixels| self.table.n_lg_n(area + pixels);
                *gains = std::array::from_fn(|k| with(k as u32 + 1) - without);
            }
        }
    }

    /// Bounds the change of the background's terms by their derivatives.
    fn note_background(&mut self) {
        let (Some(before), after) = (self.vmi.changed_from(0), self.vmi.leaf(0)) else {
            return;
        };
        let (mut steepest, mut sum) = (0f64, 0u64);
        for (&b, &a) in before.areas.iter().zip(after.areas) {
            if a != b {
                steepest = steepest.max(f64::from(a.abs_diff(b)) / f64::from(a.min(b)));
                sum += u64::from(a.abs_diff(b));
            }
        }
        if steepest.is_infinite() {
            // Where the background comes or goes the derivatives have no bound.
            self.background_jumps += 1;
            return;
        }
        let (before, after) = (before.total, after.total);
        let least = f64::from(after.min(before));
        let change = f64::from(after.abs_diff(before)) / least;
        let unit = f64::from(1u32 << LG_FRACTION_BITS) / std::f64::consts::LN_2 * (1.0 + 1e-9);
        self.background_drift.revealed += (steepest + change) * unit;
        self.background_drift.rise += (sum as f64 / least + change * (1.0 + change)) * unit;
    }
}

#[cfg(test)]
impl Counts<'_> {
    /// A step in which leaf 1 hands pixels of a view to the background, or takes
    /// them from it.
    pub(super) fn hand_to_background(&mut self, view: usize, pixels: i32) {
        let (before, after) = if pixels < 0 { (0, 1) } else { (1, 0) };
        self.record(&Event {
            view: view as u32,
            pixels: pixels.unsigned_abs(),
            before: [before, 0],
            after: [after, 0],
        });
        self.settle();
        self.forget_step();
    }
}
