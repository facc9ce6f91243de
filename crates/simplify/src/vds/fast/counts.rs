//! Areas, and what they say about pruning each leaf.
//!
//! With `f(a, S) = a (lg a - lg S)`, P times the VMI of view v is
//! `P lg V + sum_o f(a_o(v), S_o)`. If leaf l goes, it hands `r_o(v)` of its
//! pixels in view v to leaf o behind it, `s_o` over all views, and P times the
//! VMI of *every* view changes by
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

use super::changes::BackgroundDrift;
use super::events::Event;
use super::prefetch::prefetch;
use super::terms::Target;
use crate::lg::{LG_FRACTION_BITS, LgTable};

const UNTOUCHED: u32 = u32::MAX;

/// Pixels of a view for which what the background gains by them is kept.
const GAINS: usize = 8;

#[derive(Clone)]
struct TouchedLeaf {
    leaf: u32,
    total_before: u32,
    lg_total_before: i64,
}

/// A leaf of which the step changed the area in some view.
#[derive(Clone, Copy)]
pub(super) struct ChangedArea<'a> {
    pub leaf: u32,
    pub before: Target<'a>,
    pub after: Target<'a>,
    /// By how much its own term changed, by view.
    pub own_term: &'a [i64],
}

#[derive(Clone)]
pub(super) struct Counts<'t> {
    pub table: &'t LgTable,
    view_count: usize,
    /// Pixels of all views together, background included.
    pixels: u32,
    /// Areas by leaf number, then view.
    areas: Vec<u32>,
    totals: Vec<u32>,
    lg_totals: Vec<i64>,
    /// P times VMI less that of the original foliage, by view.
    deviations: Vec<i64>,
    background_drift: BackgroundDrift,
    /// `n lg n` of the background with 1, 2, ... pixels more, less without, by
    /// view.
    background_gains: Vec<[i64; GAINS]>,
    /// The areas of the background that those are for.
    gains_at: Vec<u32>,
    background_jumps: u32,

    touched_leaves: Vec<TouchedLeaf>,
    /// By touched leaf, then view.
    areas_before: Vec<u32>,
    own_terms: Vec<i64>,
    /// Where the touched leaves hold a leaf, by leaf number.
    touched: Vec<u32>,
}

impl<'t> Counts<'t> {
    /// Of what `events` lead to from nothing but background.
    pub(super) fn new<'e>(
        events: impl Iterator<Item = &'e Event>,
        view_count: usize,
        pixels_per_view: u32,
        leaf_count: usize,
        table: &'t LgTable,
    ) -> Self {
        let mut areas = vec![0; (leaf_count + 1) * view_count];
        let mut totals = vec![0; leaf_count + 1];
        areas[..view_count].fill(pixels_per_view);
        totals[0] = pixels_per_view * view_count as u32;
        for event in events {
            let view = event.view as usize;
            for (leaf, pixels) in [
                (0, event.pixels.wrapping_neg()),
                (event.after[0] as usize, event.pixels),
            ] {
                let area: &mut u32 = &mut areas[leaf * view_count + view];
                *area = area.wrapping_add(pixels);
                let total: &mut u32 = &mut totals[leaf];
                *total = total.wrapping_add(pixels);
            }
        }
        let mut counts = Self {
            table,
            view_count,
            pixels: pixels_per_view * view_count as u32,
            areas,
            lg_totals: totals.iter().map(|total| table.lg(*total)).collect(),
            totals,
            deviations: vec![0; view_count],
            background_drift: BackgroundDrift::default(),
            background_gains: vec![[0; GAINS]; view_count],
            gains_at: vec![u32::MAX; view_count],
            background_jumps: 0,
            touched_leaves: Vec::new(),
            areas_before: Vec::new(),
            own_terms: Vec::new(),
            touched: vec![UNTOUCHED; leaf_count + 1],
        };
        counts.note_gains();
        counts
    }

    pub(super) fn view_count(&self) -> usize {
        self.view_count
    }

    pub(super) fn leaf_count(&self) -> usize {
        self.totals.len() - 1
    }

    /// Areas of a leaf by view in pixels; of the background for 0.
    #[inline]
    pub(super) fn areas(&self, leaf: u32) -> &[u32] {
        &self.areas[leaf as usize * self.view_count..][..self.view_count]
    }

    /// A leaf as edges lead to it; the background for 0.
    #[inline]
    pub(super) fn target(&self, leaf: u32) -> Target<'_> {
        Target {
            areas: self.areas(leaf),
            total: self.totals[leaf as usize],
            lg_total: self.lg_totals[leaf as usize],
        }
    }

    /// Pixels over all views that show foliage.
    pub(super) fn covered_px(&self) -> u64 {
        u64::from(self.pixels - self.totals[0])
    }

    /// P times VMI less that of the original foliage, by view.
    pub(super) fn deviations(&self) -> &[i64] {
        &self.deviations
    }

    /// Sets where deviations start.
    pub(super) fn set_deviations(&mut self, deviations: Vec<i64>) {
        self.deviations = deviations;
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
                let area = self.areas[view as usize];
                self.table.n_lg_n(area + pixels) - self.table.n_lg_n(area)
            }
        }
    }

    fn note_gains(&mut self) {
        let background = &self.areas[..self.view_count];
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

    /// Takes note of a change at the front of some pixels.
    #[inline]
    pub(super) fn record(&mut self, event: &Event) {
        let (view, pixels) = (event.view as usize, event.pixels as i32);
        if event.before[0] != event.after[0] {
            self.add_area(event.before[0], view, -pixels);
            self.add_area(event.after[0], view, pixels);
        }
    }

    /// Asks for the memory that [`record`](Self::record) of an event will need.
    #[inline(always)]
    pub(super) fn prefetch(&self, event: &Event) {
        for leaf in [event.before[0], event.after[0]] {
            let leaf = leaf as usize;
            prefetch(&self.touched, leaf);
            prefetch(&self.totals, leaf);
            prefetch(&self.areas, leaf * self.view_count + event.view as usize);
        }
    }

    fn add_area(&mut self, leaf: u32, view: usize, by: i32) {
        let row = leaf as usize * self.view_count;
        if self.touched[leaf as usize] == UNTOUCHED {
            self.touched[leaf as usize] = self.touched_leaves.len() as u32;
            self.touched_leaves.push(TouchedLeaf {
                leaf,
                total_before: self.totals[leaf as usize],
                lg_total_before: self.lg_totals[leaf as usize],
            });
            self.areas_before
                .extend_from_slice(&self.areas[row..row + self.view_count]);
        }
        let area = &mut self.areas[row + view];
        *area = area.wrapping_add_signed(by);
        let total = &mut self.totals[leaf as usize];
        *total = total.wrapping_add_signed(by);
    }

    /// Ends the recording of a step: brings the deviations up to date.
    pub(super) fn settle(&mut self) {
        self.note_background();
        if self.touched[0] != UNTOUCHED {
            self.note_gains();
        }
        for slot in 0..self.touched_leaves.len() {
            let TouchedLeaf {
                leaf,
                lg_total_before,
                ..
            } = self.touched_leaves[slot];
            let lg_total = self.table.lg(self.totals[leaf as usize]);
            self.lg_totals[leaf as usize] = lg_total;
            let after = &self.areas[leaf as usize * self.view_count..][..self.view_count];
            let before = &self.areas_before[slot * self.view_count..][..self.view_count];
            for ((&a, &b), deviation) in after.iter().zip(before).zip(&mut self.deviations) {
                // Mostly neither is there.
                let change = match a | b {
                    0 => 0,
                    _ => self.table.term(a, lg_total) - self.table.term(b, lg_total_before),
                };
                *deviation += change;
                self.own_terms.push(change);
            }
        }
    }

    /// The leaves of which the step changed the area, and the background.
    pub(super) fn changed_areas(&self) -> impl Iterator<Item = ChangedArea<'_>> {
        (0..self.touched_leaves.len()).map(|slot| self.changed_area(slot))
    }

    fn changed_area(&self, slot: usize) -> ChangedArea<'_> {
        let touched = &self.touched_leaves[slot];
        let views = slot * self.view_count..(slot + 1) * self.view_count;
        ChangedArea {
            leaf: touched.leaf,
            before: Target {
                areas: &self.areas_before[views.clone()],
                total: touched.total_before,
                lg_total: touched.lg_total_before,
            },
            after: self.target(touched.leaf),
            own_term: &self.own_terms[views],
        }
    }

    /// A leaf as it was before the step.
    pub(super) fn target_before(&self, leaf: u32) -> Target<'_> {
        match self.touched[leaf as usize] {
            UNTOUCHED => self.target(leaf),
            slot => self.changed_area(slot as usize).before,
        }
    }

    /// Forgets what was before the step.
    pub(super) fn forget_step(&mut self) {
        for leaf in self.touched_leaves.drain(..) {
            self.touched[leaf.leaf as usize] = UNTOUCHED;
        }
        self.areas_before.clear();
        self.own_terms.clear();
    }

    /// Bounds the change of the background's terms by their derivatives.
    fn note_background(&mut self) {
        let slot = self.touched[0];
        if slot == UNTOUCHED {
            return;
        }
        let before = &self.areas_before[slot as usize * self.view_count..][..self.view_count];
        let (mut steepest, mut sum) = (0f64, 0u64);
        for (&b, &a) in before.iter().zip(&self.areas[..self.view_count]) {
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
        let (before, after) = (
            self.touched_leaves[slot as usize].total_before,
            self.totals[0],
        );
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
