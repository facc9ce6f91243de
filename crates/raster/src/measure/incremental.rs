//! VMI as areas change.
//!
//! With `f(a, S) = a (lg a - lg S)`, P times the VMI of view v is
//! `P lg V + sum_o f(a_o(v), S_o)` ([`vmi`](super::vmi)). When pixels pass from one leaf to
//! another, only the terms of these two change: they are taken away as they were and added as
//! they are. Integers make that equal to computing anew.

use super::lg::LgTable;
use super::rows::Rows;
use super::vmi::Vmi;
use crate::AreaTable;
use crate::abuffer::Event;
use crate::prefetch::prefetch;

const UNTOUCHED: u32 = u32::MAX;

/// A leaf, or the background, as the terms of VMI need it.
#[derive(Clone, Copy, Debug)]
pub struct LeafAreas<'a> {
    /// a, by view in pixels.
    pub areas: &'a [u32],
    /// S, the sum of `areas`, in pixels.
    pub total: u32,
    /// lg S, in units of 2^-27 bits.
    pub lg_total: i64,
}

impl LeafAreas<'_> {
    /// `lg (S + s) - lg S`, if `lg_after` is `lg (S + s)`. It is never negative and fits 32
    /// bits: factors of 32 bits are what vector instructions multiply.
    #[inline]
    pub fn rise(&self, lg_after: i64) -> u64 {
        u64::from((lg_after - self.lg_total) as u32)
    }
}

/// A leaf of which a step changed the area in some view.
#[derive(Clone, Copy, Debug)]
pub struct ChangedArea<'a> {
    /// Its number, 0 for the background.
    pub leaf: u32,
    /// Its areas before the step.
    pub before: LeafAreas<'a>,
    /// Its areas after the step.
    pub after: LeafAreas<'a>,
    /// By how much its term changed, by view.
    pub own_term: &'a [i64],
}

#[derive(Clone, Debug)]
struct TouchedLeaf {
    leaf: u32,
    total_before: u32,
    lg_total_before: i64,
}

/// Areas of all leaves in all views of a set, and the VMI of each view.
///
/// Areas change in steps: any number of [`record`](Self::record), then
/// [`settle`](Self::settle), after which the VMI is true again; what was before is known until
/// [`forget_step`](Self::forget_step) or [`undo`](Self::undo), one of which comes before the
/// next step.
///
/// Takes 4 bytes a leaf and view, where they are [kept for all](Self::new) leaves, and 16 to 20 a
/// leaf. A step takes time in proportion to the views
/// times the leaves of which it changes the area.
#[derive(Clone, Debug)]
pub struct IncrementalVmi<'t> {
    table: &'t LgTable,
    view_count: usize,
    /// By row of the leaf, then view.
    areas: Vec<u32>,
    rows: Rows,
    totals: Vec<u32>,
    lg_totals: Vec<i64>,
    /// P times VMI less that of the other, by view.
    deviations: Vec<i64>,

    touched_leaves: Vec<TouchedLeaf>,
    /// By touched leaf, then view.
    areas_before: Vec<u32>,
    own_terms: Vec<i64>,
    /// Where the touched leaves hold a leaf, by leaf number.
    touched: Vec<u32>,
}

impl<'t> IncrementalVmi<'t> {
    /// Of the areas in the views of a set.
    ///
    /// # Panics
    /// If there is no view.
    pub fn new(areas: &AreaTable, table: &'t LgTable) -> Self {
        Self::with_rows(areas, table, Rows::of_all(areas.leaf_count() + 1))
    }

    /// [`new`](Self::new), but leaves that no view shows take no memory by view: for many leaves,
    /// with a little more time.
    ///
    /// # Panics
    /// As [`new`](Self::new).
    pub fn of_seen(areas: &AreaTable, table: &'t LgTable) -> Self {
        Self::with_rows(areas, table, Rows::of_some(areas.leaf_count() + 1))
    }

    fn with_rows(areas: &AreaTable, table: &'t LgTable, mut rows: Rows) -> Self {
        let (view_count, leaf_count) = (areas.view_count(), areas.leaf_count());
        let mut totals = vec![0; leaf_count + 1];
        for row in areas.rows() {
            for (leaf, &area) in row.iter().enumerate() {
                totals[leaf] += area;
                if area > 0 {
                    rows.own(leaf);
                }
            }
        }
        let mut by_row = vec![0; rows.count() * view_count];
        for (view, row) in areas.rows().enumerate() {
            for (leaf, &area) in row.iter().enumerate() {
                if area > 0 {
                    by_row[rows.row(leaf) * view_count + view] = area;
                }
            }
        }
        Self {
            table,
            view_count,
            areas: by_row,
            rows,
            lg_totals: totals.iter().map(|total| table.lg(*total)).collect(),
            totals,
            deviations: Vmi::of(areas, table).scaled().to_vec(),
            touched_leaves: Vec::new(),
            areas_before: Vec::new(),
            own_terms: Vec::new(),
            touched: vec![UNTOUCHED; leaf_count + 1],
        }
    }

    /// The logarithms that it is computed with.
    #[inline]
    pub fn table(&self) -> &'t LgTable {
        self.table
    }

    /// The number of views that areas are kept of.
    #[inline]
    pub fn view_count(&self) -> usize {
        self.view_count
    }

    /// Leaves, without the background.
    pub fn leaf_count(&self) -> usize {
        self.totals.len() - 1
    }

    /// Areas of a leaf by view in pixels; of the background for 0.
    #[inline]
    pub fn areas(&self, leaf: u32) -> &[u32] {
        &self.areas[self.rows.row(leaf as usize) * self.view_count..][..self.view_count]
    }

    /// A leaf with its areas; the background for 0.
    #[inline]
    pub fn leaf(&self, leaf: u32) -> LeafAreas<'_> {
        LeafAreas {
            areas: self.areas(leaf),
            total: self.totals[leaf as usize],
            lg_total: self.lg_totals[leaf as usize],
        }
    }

    /// The areas view by view.
    pub fn area_table(&self) -> AreaTable {
        let leaves = 0..=self.leaf_count() as u32;
        let row = |view: usize| leaves.clone().map(move |leaf| self.areas(leaf)[view]);
        let mut rows = Vec::with_capacity(self.areas.len());
        rows.extend((0..self.view_count).flat_map(row));
        AreaTable::from_rows(self.leaf_count(), rows)
    }

    /// P times VMI, by view, less that of [what it is measured from](Self::measure_from).
    #[inline]
    pub fn deviations(&self) -> &[i64] {
        &self.deviations
    }

    /// From now on VMI is told less that of another.
    ///
    /// # Panics
    /// If it is one of another number of views.
    pub fn measure_from(&mut self, other: &Vmi) {
        assert_eq!(self.deviations.len(), other.scaled().len());
        for (deviation, scaled) in self.deviations.iter_mut().zip(other.scaled()) {
            *deviation -= scaled;
        }
    }

    /// lg(a/S), scaled: by how much the VMI of all views together changes with each pixel that
    /// a leaf has more in a view, to the first order; 0 where it has none.
    #[inline]
    pub fn pixel_value(&self, leaf: u32, view: usize) -> i64 {
        match self.areas(leaf)[view] {
            0 => 0,
            area => self.table.lg(area) - self.lg_totals[leaf as usize],
        }
    }

    /// Takes note of a change at the front of some pixels.
    #[inline]
    pub fn record(&mut self, event: &Event) {
        let (view, pixels) = (event.view as usize, event.pixels as i32);
        if event.before[0] != event.after[0] {
            self.add_area(event.before[0], view, -pixels);
            self.add_area(event.after[0], view, pixels);
        }
    }

    /// Asks for the memory that [`record`](Self::record) of an event will need.
    #[inline(always)]
    pub fn prefetch(&self, event: &Event) {
        for leaf in [event.before[0], event.after[0]] {
            let leaf = leaf as usize;
            prefetch(&self.touched, leaf);
            prefetch(&self.totals, leaf);
            let row = self.rows.row(leaf) * self.view_count;
            prefetch(&self.areas, row + event.view as usize);
        }
    }

    #[inline]
    fn add_area(&mut self, leaf: u32, view: usize, by: i32) {
        let row = self.rows.own(leaf as usize) * self.view_count;
        if row == self.areas.len() {
            self.areas.resize(row + self.view_count, 0);
        }
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

    /// Ends the recording of a step: brings the VMI up to date.
    ///
    /// # Panics
    /// If the step before was neither forgotten nor taken back.
    pub fn settle(&mut self) {
        assert!(self.own_terms.is_empty(), "the step before is settled");
        for slot in 0..self.touched_leaves.len() {
            let TouchedLeaf {
                leaf,
                lg_total_before,
                ..
            } = self.touched_leaves[slot];
            let lg_total = self.table.lg(self.totals[leaf as usize]);
            self.lg_totals[leaf as usize] = lg_total;
            let row = self.rows.row(leaf as usize) * self.view_count;
            let after = &self.areas[row..row + self.view_count];
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
    pub fn changed_areas(&self) -> impl Iterator<Item = ChangedArea<'_>> {
        (0..self.touched_leaves.len()).map(|slot| self.changed_area(slot))
    }

    #[inline]
    fn changed_area(&self, slot: usize) -> ChangedArea<'_> {
        let leaf = self.touched_leaves[slot].leaf;
        ChangedArea {
            leaf,
            before: self.before(slot),
            after: self.leaf(leaf),
            own_term: &self.own_terms[slot * self.view_count..][..self.view_count],
        }
    }

    /// A touched leaf as it was.
    #[inline]
    fn before(&self, slot: usize) -> LeafAreas<'_> {
        let touched = &self.touched_leaves[slot];
        LeafAreas {
            areas: &self.areas_before[slot * self.view_count..][..self.view_count],
            total: touched.total_before,
            lg_total: touched.lg_total_before,
        }
    }

    /// A leaf as it was before the step, if the step changed its area.
    #[inline]
    pub fn changed_from(&self, leaf: u32) -> Option<LeafAreas<'_>> {
        match self.touched[leaf as usize] {
            UNTOUCHED => None,
            slot => Some(self.before(slot as usize)),
        }
    }

    /// Forgets what was before the step.
    pub fn forget_step(&mut self) {
        for leaf in self.touched_leaves.drain(..) {
            self.touched[leaf.leaf as usize] = UNTOUCHED;
            if self.totals[leaf.leaf as usize] == 0 {
                self.rows.give_back(leaf.leaf as usize);
            }
        }
        self.areas_before.clear();
        self.own_terms.clear();
    }

    /// Takes a step back.
    ///
    /// # Panics
    /// If it is not [settled](Self::settle).
    pub fn undo(&mut self) {
        let is_settled = self.own_terms.len() == self.areas_before.len();
        assert!(is_settled, "a step is settled before it is taken back");
        let Self {
            view_count,
            areas,
            rows: row_of,
            totals,
            lg_totals,
            deviations,
            touched_leaves,
            areas_before,
            own_terms,
            ..
        } = self;
        let rows = areas_before.chunks(*view_count);
        let rows = rows.zip(own_terms.chunks(*view_count));
        for (touched, (before, own_term)) in touched_leaves.iter().zip(rows) {
            let leaf = touched.leaf as usize;
            areas[row_of.row(leaf) * *view_count..][..*view_count].copy_from_slice(before);
            totals[leaf] = touched.total_before;
            lg_totals[leaf] = touched.lg_total_before;
            for (deviation, change) in deviations.iter_mut().zip(own_term) {
                *deviation -= change;
            }
        }
        self.forget_step();
    }
}
