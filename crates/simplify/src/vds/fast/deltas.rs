//! What pruning each leaf of a shard would change, kept up to date.
//!
//! When a step changes some areas and edges, the terms they enter are
//! subtracted as they were and added as they are; integers make that equal to
//! computing anew.

use secateur_raster::measure::incremental::ChangedArea;
use secateur_raster::measure::rows::Rows;
use secateur_raster::prefetch::{prefetch, prefetch_range};

use super::changes::Change;
use super::counts::Counts;
use super::edges::Edges;
use super::split::Split;
use super::switches::{Mechanism, is_on};
use super::terms::{add_term, move_term, replace_term};

/// How far ahead the edges that lead to a leaf, and the rows of the leaves they
/// come from, are asked for.
const EDGES_AHEAD: usize = 12;
const ROWS_AHEAD: usize = 4;

/// P times the change of VMI in each view if a leaf went, without the term of
/// the background, for the leaves of one shard.
pub(super) struct Deltas {
    split: Split,
    shard: usize,
    view_count: usize,
    /// Where `deltas` has what, by row of the leaf.
    rows: Rows,
    /// By those, then view.
    deltas: Vec<i64>,
    /// Leaves changed by the step.
    changed: Vec<u32>,
    /// By row, while the leaf is among the changed.
    change: Vec<Change>,
    /// The edges that lead to leaves of which the step changed the area, those of
    /// each leaf after those of the leaf before.
    incoming: Vec<u32>,
}

impl Deltas {
    pub(super) fn new(counts: &Counts<'_>, edges: &Edges, (split, shard): (Split, usize)) -> Self {
        let view_count = counts.view_count();
        let row_count = split.rows(counts.leaf_count());
        let mut deltas = Self {
            split,
            shard,
            view_count,
            deltas: Vec::new(),
            rows: counts.rows(row_count),
            changed: Vec::new(),
            change: vec![Change::NONE; row_count],
            incoming: Vec::new(),
        };
        let leaves = 1..=counts.leaf_count() as u32;
        let seen = leaves
            .filter(|leaf| split.shard(*leaf) == shard)
            .map(|leaf| (leaf, counts.target(leaf)))
            .filter(|(_, own)| own.total > 0);
        for (leaf, _) in seen.clone() {
            deltas.rows.own(split.row(leaf));
        }
        deltas.deltas = vec![0; deltas.rows.count() * view_count];
        for (leaf, own) in seen {
            for (delta, &area) in deltas.row_mut(leaf).iter_mut().zip(own.areas) {
                *delta = -counts.table.term(area, own.lg_total);
            }
        }
        for edge in edges.all() {
            if edge.to != 0 {
                let target = counts.target(edge.to);
                let row = deltas.row_mut(edge.from);
                add_term(counts.table, row, target, edge.total, &edge.reveals);
            }
        }
        deltas
    }

    #[inline(always)]
    fn row(&self, leaf: u32) -> &[i64] {
        let row = self.rows.row(self.split.row(leaf));
        &self.deltas[row * self.view_count..][..self.view_count]
    }

    #[inline(always)]
    fn row_mut(&mut self, leaf: u32) -> &mut [i64] {
        let start = self.rows.own(self.split.row(leaf)) * self.view_count;
        if start == self.deltas.len() {
            self.deltas.resize(start + self.view_count, 0);
        }
        &mut self.deltas[start..start + self.view_count]
    }

    /// Forgets the rows of leaves that no view shows any more.
    pub(super) fn forget_unseen(&mut self, counts: &Counts<'_>) {
        let unseen = counts.changed_areas().filter(|area| area.after.total == 0);
        for leaf in unseen.map(|area| area.leaf) {
            if leaf != 0 && self.split.shard(leaf) == self.shard {
                debug_assert!(self.row(leaf).iter().all(|delta| *delta == 0));
                self.rows.give_back(self.split.row(leaf));
            }
        }
    }

    #[inline(always)]
    fn prefetch_row(&self, leaf: u32) {
        if !is_on(Mechanism::PrefetchDeltas) {
            return;
        }
        let start = self.rows.row(self.split.row(leaf)) * self.view_count;
        prefetch_range(&self.deltas, start, self.view_count);
    }

    /// Brings the deltas up to date with what a step [settled](Counts::settle)
    /// and its edges [followed](Edges::follow).
    pub(super) fn follow(&mut self, counts: &Counts<'_>, edges: &Edges) {
        self.move_incoming(counts, edges);
        for (k, touched) in edges.touched().iter().enumerate() {
            if let Some(ahead) = edges.touched().get(k + ROWS_AHEAD) {
                self.prefetch_row(edges.get(ahead.edge).from);
            }
            let edge = edges.get(touched.edge);
            if edge.to != 0 {
                let before = counts.target_before(edge.to);
                let after = counts.target(edge.to);
                replace_term(
                    counts.table,
                    self.row_mut(edge.from),
                    (before, touched.total_before, &touched.reveals_before),
                    (after, edge.total, &edge.reveals),
                );
            }
            self.mark_changed(edge.from);
        }
    }

    fn mark_changed(&mut self, leaf: u32) {
        let change = &mut self.change[self.split.row(leaf)];
        if std::mem::replace(change, Change::OF_ITSELF) == Change::NONE {
            self.changed.push(leaf);
        }
    }

    fn change_own_term(&mut self, area: ChangedArea<'_>) {
        if area.leaf == 0 || self.split.shard(area.leaf) != self.shard {
            return;
        }
        for (delta, change) in self.row_mut(area.leaf).iter_mut().zip(area.own_term) {
            *delta -= change;
        }
        self.mark_changed(area.leaf);
    }

    /// Own terms of changed leaves, and those of the edges that lead to them and
    /// did not change themselves.
    fn move_incoming(&mut self, counts: &Counts<'_>, edges: &Edges) {
        let mut incoming = std::mem::take(&mut self.incoming);
        incoming.clear();
        let leaves = || counts.changed_areas().map(|area| area.leaf);
        if is_on(Mechanism::PrefetchDeltas) {
            leaves().for_each(|leaf| edges.prefetch_incoming(leaf));
            leaves().for_each(|leaf| prefetch(edges.incoming(leaf), 0));
        }
        leaves().for_each(|leaf| incoming.extend_from_slice(edges.incoming(leaf)));
        let mut at = 0;
        for area in counts.changed_areas() {
            self.change_own_term(area);
            let end = at + edges.incoming(area.leaf).len();
            while at < end {
                if is_on(Mechanism::PrefetchDeltas)
                    && let Some(&ahead) = incoming.get(at + EDGES_AHEAD)
                {
                    prefetch(edges.all(), ahead as usize);
                }
                if is_on(Mechanism::PrefetchDeltas)
                    && let Some(&ahead) = incoming.get(at + ROWS_AHEAD)
                {
                    let from = edges.get(ahead).from;
                    self.prefetch_row(from);
                    prefetch(&self.change, self.split.row(from));
                }
                let edge = edges.get(incoming[at]);
                at += 1;
                if edge.is_touched {
                    continue;
                }
                let moved = move_term(
                    counts.table,
                    self.row_mut(edge.from),
                    area.before,
                    area.after,
                    edge.total,
                    &edge.reveals,
                );
                let change = &mut self.change[self.split.row(edge.from)];
                if *change == Change::NONE {
                    self.changed.push(edge.from);
                }
                change.add(moved);
            }
        }
        self.incoming = incoming;
    }

    /// Calls `changed` with each leaf whose deltas changed or may have since the
    /// last call, once, and with leaves that will follow, one soon and one later.
    pub(super) fn for_each_changed(
        &mut self,
        mut changed: impl FnMut(&Self, u32, Change, [Option<u32>; 2]),
    ) {
        let leaves = std::mem::take(&mut self.changed);
        for (k, &leaf) in leaves.iter().enumerate() {
            if let Some(&ahead) = leaves.get(k + 4) {
                self.prefetch_row(ahead);
            }
            let change = &mut self.change[self.split.row(leaf)];
            let change = std::mem::replace(change, Change::NONE);
            let ahead = [k + 2, k + 8].map(|k| leaves.get(k).copied());
            changed(self, leaf, change, ahead);
        }
        self.changed = leaves;
        self.changed.clear();
    }
}

/// Everything there is to know about a shard's leaves.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    pub counts: &'a Counts<'a>,
    pub edges: &'a Edges,
    pub deltas: &'a Deltas,
}

impl Sight<'_> {
    /// P times the change of VMI in each view if the leaf went.
    #[inline]
    pub(super) fn deltas(&self, leaf: u32, out: &mut [i64]) {
        let px = self.deltas_but_rise(leaf, out);
        let rise = self.counts.background_rise(px);
        for (delta, &a) in out.iter_mut().zip(self.counts.areas(0)) {
            *delta -= (u64::from(a) * rise) as i64;
        }
    }

    /// [`deltas`](Self::deltas) but for what the growing total of the background
    /// takes away in every view: its area there times
    /// [`background_rise`](Counts::background_rise) of the pixels returned.
    #[inline]
    pub(super) fn deltas_but_rise(&self, leaf: u32, out: &mut [i64]) -> u32 {
        out.copy_from_slice(self.deltas.row(leaf));
        let Some(edge) = self.edges.to_background(leaf) else {
            return 0;
        };
        let background = self.counts.target(0);
        let lg_after = self.counts.table.lg(background.total + edge.total);
        for (view, r) in edge.reveals.iter() {
            let gain = self.counts.background_gain(view, r);
            out[view as usize] += gain - i64::from(r) * lg_after;
        }
        edge.total
    }

    /// View and pixels that a leaf would hand to the background, if that is in one view and all that it has an effect on.
    #[inline]
    pub(super) fn only_reveal(&self, leaf: u32) -> Option<(u32, u32)> {
        let edge = self.edges.to_background(leaf)?;
        let mut reveals = edge.reveals.iter();
        let only = reveals.next().filter(|_| reveals.next().is_none())?;
        let is_all = self.deltas.row(leaf).iter().all(|delta| *delta == 0);
        is_all.then_some(only)
    }

    /// Asks for the memory that [`prefetch`](Self::prefetch) of a leaf will need.
    #[inline(always)]
    pub(super) fn prefetch_place(&self, leaf: u32) {
        self.edges.prefetch_place_of_background(leaf);
    }

    /// Asks for the memory that [`deltas_but_rise`](Self::deltas_but_rise) of a
    /// leaf will need.
    #[inline(always)]
    pub(super) fn prefetch(&self, leaf: u32) {
        self.deltas.prefetch_row(leaf);
        self.edges.prefetch_to_background(leaf);
    }
}
