//! Areas, reveal edges, and what they say about pruning each leaf.
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
//! The pairs (l, o) with s_o > 0 are few: *reveal edges*, kept with the counts
//! `r_o(v)` and, for each o, the list of its l. When a step changes some areas
//! and edges, the terms they enter are subtracted as they were and added as
//! they are; integers make that equal to computing anew.
//!
//! The background is apart: nearly every step changes its area, and nearly
//! every leaf at the silhouette has an edge to it. [`Counts::deltas`] evaluates
//! its term fresh; [`Counts::background_drift`] bounds how far it has moved.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::candidates::Silhouette;
use super::changes::{BackgroundDrift, Change};
use super::pixels::Ends;
use super::prefetch::{prefetch, prefetch_range};
use super::terms::{Target, add_revealed, add_term, move_term, replace_term};
use crate::lg::{LG_FRACTION_BITS, LgTable};

const NONE: u32 = u32::MAX;

/// Most pixels of a leaf that is worth comparing with others; fits 8 bits.
const SILHOUETTE_MAX: u32 = 16;

/// Pixels by view, only those that are not zero.
pub(super) type Reveals = SmallVec<[(u32, u32); 3]>;

#[repr(align(64))]
struct Edge {
    from: u32,
    to: u32,
    /// Pixels over all views.
    total: u32,
    /// Where `incoming[to]` holds this edge.
    place: u32,
    /// Where `touched_edges` holds it during a step.
    touched: u32,
    reveals: Reveals,
}

struct TouchedLeaf {
    leaf: u32,
    total_before: u32,
    lg_total_before: i64,
}

struct TouchedEdge {
    edge: u32,
    total_before: u32,
    reveals_before: Reveals,
}

pub(super) struct Counts<'t> {
    table: &'t LgTable,
    view_count: usize,
    /// Areas by leaf number, then view.
    areas: Vec<u32>,
    totals: Vec<u32>,
    lg_totals: Vec<i64>,
    /// P times the change of VMI by leaf number, then view, without the term of
    /// the background.
    deltas: Vec<i64>,
    /// P times VMI less that of the original foliage, by view.
    deviations: Vec<i64>,
    edges: Vec<Edge>,
    free_edges: Vec<u32>,
    edge_of: FxHashMap<(u32, u32), u32>,
    /// The edge that each pixel belongs to, if it has a front leaf.
    edge_at: Vec<u32>,
    incoming: Vec<Vec<u32>>,
    /// Edge to the background by leaf number.
    background_edge: Vec<u32>,
    background_drift: BackgroundDrift,
    background_jumps: u32,

    touched_leaves: Vec<TouchedLeaf>,
    areas_before: Vec<u32>,
    touched: Vec<u32>,
    touched_edges: Vec<TouchedEdge>,
    changed: Vec<u32>,
    /// By leaf number, while it is among the changed.
    change: Vec<Change>,
}

impl<'t> Counts<'t> {
    /// From the first two leaves of every pixel, `pixels_per_view` a view, and
    /// P times VMI less that of the original foliage.
    pub(super) fn new(
        ends: &[Ends],
        pixels_per_view: usize,
        leaf_count: usize,
        table: &'t LgTable,
    ) -> Self {
        let view_count = ends.len() / pixels_per_view;
        let mut counts = Self {
            table,
            view_count,
            areas: vec![0; (leaf_count + 1) * view_count],
            totals: vec![0; leaf_count + 1],
            lg_totals: vec![0; leaf_count + 1],
            deltas: vec![0; (leaf_count + 1) * view_count],
            deviations: vec![0; view_count],
            edges: Vec::new(),
            free_edges: Vec::new(),
            edge_of: FxHashMap::default(),
            edge_at: vec![NONE; ends.len()],
            incoming: vec![Vec::new(); leaf_count + 1],
            background_edge: vec![NONE; leaf_count + 1],
            background_drift: BackgroundDrift::default(),
            background_jumps: 0,
            touched_leaves: Vec::new(),
            areas_before: Vec::new(),
            touched: vec![NONE; leaf_count + 1],
            touched_edges: Vec::new(),
            changed: Vec::new(),
            change: vec![Change::NONE; leaf_count + 1],
        };
        counts.fill(ends, pixels_per_view);
        counts
    }

    fn fill(&mut self, ends: &[Ends], pixels_per_view: usize) {
        // Pixels side by side mostly show the same two leaves.
        let mut run = ([NONE; 2], NONE);
        for (view, pixels) in ends.chunks_exact(pixels_per_view).enumerate() {
            for (pixel, &[front, second]) in pixels.iter().enumerate() {
                self.areas[front as usize * self.view_count + view] += 1;
                self.totals[front as usize] += 1;
                if front == 0 {
                    continue;
                }
                if run.0 != [front, second] {
                    run = ([front, second], self.edge(front, second));
                }
                self.edge_at[view * pixels_per_view + pixel] = run.1;
                add_reveal(&mut self.edges[run.1 as usize], view as u32, 1);
            }
        }
        for leaf in 0..self.totals.len() {
            self.lg_totals[leaf] = self.table.lg(self.totals[leaf]);
        }
        for leaf in 1..self.totals.len() {
            let lg_total = self.lg_totals[leaf];
            for at in leaf * self.view_count..(leaf + 1) * self.view_count {
                self.deltas[at] = -self.table.term(self.areas[at], lg_total);
            }
        }
        for edge in &self.edges {
            if edge.to != 0 {
                let target = Target {
                    areas: &self.areas[edge.to as usize * self.view_count..][..self.view_count],
                    total: self.totals[edge.to as usize],
                    lg_total: self.lg_totals[edge.to as usize],
                };
                let deltas =
                    &mut self.deltas[edge.from as usize * self.view_count..][..self.view_count];
                add_term(self.table, deltas, target, edge.total, &edge.reveals);
            }
        }
    }

    pub(super) fn view_count(&self) -> usize {
        self.view_count
    }

    /// Areas of a leaf by view in pixels; of the background for 0.
    pub(super) fn areas(&self, leaf: u32) -> &[u32] {
        &self.areas[leaf as usize * self.view_count..][..self.view_count]
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

    /// P times the change of VMI in each view if the leaf went.
    #[inline]
    pub(super) fn deltas(&self, leaf: u32, out: &mut [i64]) {
        let rise = self.background_rise(self.deltas_but_rise(leaf, out));
        for (delta, &a) in out.iter_mut().zip(self.areas(0)) {
            *delta -= (u64::from(a) * rise) as i64;
        }
    }

    /// [`deltas`](Self::deltas) but for what the growing total of the background
    /// takes away in every view: its area there times
    /// [`background_rise`](Self::background_rise) of the pixels returned.
    #[inline]
    pub(super) fn deltas_but_rise(&self, leaf: u32, out: &mut [i64]) -> u32 {
        out.copy_from_slice(&self.deltas[leaf as usize * self.view_count..][..self.view_count]);
        let edge = self.background_edge[leaf as usize];
        if edge == NONE {
            return 0;
        }
        let edge = &self.edges[edge as usize];
        let background = self.background();
        add_revealed(
            self.table,
            out,
            background,
            self.table.lg(background.total + edge.total),
            &edge.reveals,
        );
        edge.total
    }

    /// Areas by view of a leaf that has nothing but the background behind it
    /// and covers few pixels; leaves with equal ones have equal deltas. Empty
    /// for others.
    #[inline]
    pub(super) fn silhouette(&self, leaf: u32) -> Silhouette {
        let total = self.totals[leaf as usize];
        if total > SILHOUETTE_MAX {
            return Silhouette::new();
        }
        let edge = self.background_edge[leaf as usize];
        if edge == NONE || self.edges[edge as usize].total != total {
            return Silhouette::new();
        }
        let by_view = self.areas(leaf).iter().zip(0u32..);
        let seen = by_view.filter(|(area, _)| **area > 0);
        seen.map(|(area, view)| view << 8 | area).collect()
    }

    /// By how much the logarithm of the background's total would rise with so
    /// many pixels more.
    #[inline]
    pub(super) fn background_rise(&self, pixels: u32) -> u64 {
        match pixels {
            0 => 0,
            pixels => {
                let background = self.background();
                background.rise(self.table.lg(background.total + pixels))
            }
        }
    }

    fn background(&self) -> Target<'_> {
        Target {
            areas: self.areas(0),
            total: self.totals[0],
            lg_total: self.lg_totals[0],
        }
    }

    /// Notes that the first two leaves of a pixel (over all views) in a view
    /// changed.
    #[inline]
    pub(super) fn record(&mut self, view: usize, pixel: u32, before: Ends, after: Ends) {
        if before[0] != after[0] {
            self.add_area(before[0], view, -1);
            self.add_area(after[0], view, 1);
        }
        if before[0] != 0 {
            let edge = self.edge_at[pixel as usize];
            self.touch_edge(edge);
            add_reveal(&mut self.edges[edge as usize], view as u32, -1);
        }
        if after[0] != 0 {
            let edge = self.edge(after[0], after[1]);
            self.edge_at[pixel as usize] = edge;
            self.touch_edge(edge);
            add_reveal(&mut self.edges[edge as usize], view as u32, 1);
        }
    }

    fn add_area(&mut self, leaf: u32, view: usize, by: i32) {
        let row = leaf as usize * self.view_count;
        if self.touched[leaf as usize] == NONE {
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

    fn edge(&mut self, from: u32, to: u32) -> u32 {
        let Self {
            edges,
            free_edges,
            edge_of,
            incoming,
            background_edge,
            ..
        } = self;
        *edge_of.entry((from, to)).or_insert_with(|| {
            let place = incoming[to as usize].len() as u32;
            let edge = Edge {
                from,
                to,
                total: 0,
                place,
                touched: NONE,
                reveals: Reveals::new(),
            };
            let index = match free_edges.pop() {
                Some(index) => {
                    edges[index as usize] = edge;
                    index
                }
                None => {
                    edges.push(edge);
                    edges.len() as u32 - 1
                }
            };
            if to == 0 {
                background_edge[from as usize] = index;
            } else {
                incoming[to as usize].push(index);
            }
            index
        })
    }

    fn touch_edge(&mut self, index: u32) {
        let edge = &mut self.edges[index as usize];
        if edge.touched == NONE {
            edge.touched = self.touched_edges.len() as u32;
            self.touched_edges.push(TouchedEdge {
                edge: index,
                total_before: edge.total,
                reveals_before: edge.reveals.clone(),
            });
        }
    }

    /// Ends a step: brings deviations and deltas up to date with what was
    /// recorded, and calls `changed` with each leaf whose deltas changed or may
    /// have, once, and with a leaf that will soon follow.
    pub(super) fn commit(&mut self, mut changed: impl FnMut(&Self, u32, Change, Option<u32>)) {
        self.note_background();
        for k in 0..self.touched_leaves.len() {
            let leaf = self.touched_leaves[k].leaf as usize;
            self.lg_totals[leaf] = self.table.lg(self.totals[leaf]);
        }
        for k in 0..self.touched_leaves.len() {
            self.update_own_term(k);
            self.update_incoming(k);
        }
        for k in 0..self.touched_edges.len() {
            self.update_touched_edge(k);
        }
        self.drop_empty_edges();
        for leaf in &self.touched_leaves {
            self.touched[leaf.leaf as usize] = NONE;
        }
        self.touched_leaves.clear();
        self.areas_before.clear();
        let leaves = std::mem::take(&mut self.changed);
        for (k, &leaf) in leaves.iter().enumerate() {
            if let Some(&ahead) = leaves.get(k + 4) {
                let row = ahead as usize * self.view_count;
                prefetch_range(&self.deltas, row, self.view_count);
            }
            let change = std::mem::replace(&mut self.change[leaf as usize], Change::NONE);
            changed(self, leaf, change, leaves.get(k + 2).copied());
        }
        self.changed = leaves;
        self.changed.clear();
    }

    fn mark_changed(&mut self, leaf: u32) {
        if std::mem::replace(&mut self.change[leaf as usize], Change::OF_ITSELF) == Change::NONE {
            self.changed.push(leaf);
        }
    }

    /// Bounds the change of the background's terms by their derivatives.
    fn note_background(&mut self) {
        let slot = self.touched[0];
        if slot == NONE {
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

    fn update_own_term(&mut self, slot: usize) {
        let TouchedLeaf {
            leaf,
            lg_total_before,
            ..
        } = self.touched_leaves[slot];
        let row = leaf as usize * self.view_count;
        let lg_total = self.lg_totals[leaf as usize];
        for view in 0..self.view_count {
            let before = self.areas_before[slot * self.view_count + view];
            let after = self.areas[row + view];
            let change =
                self.table.term(after, lg_total) - self.table.term(before, lg_total_before);
            self.deviations[view] += change;
            self.deltas[row + view] -= change;
        }
        if leaf != 0 {
            self.mark_changed(leaf);
        }
    }

    /// Terms of the edges that lead to a touched leaf and were not touched
    /// themselves.
    fn update_incoming(&mut self, slot: usize) {
        let TouchedLeaf {
            leaf,
            total_before,
            lg_total_before,
        } = self.touched_leaves[slot];
        let before = Target {
            areas: &self.areas_before[slot * self.view_count..][..self.view_count],
            total: total_before,
            lg_total: lg_total_before,
        };
        let after = Target {
            areas: &self.areas[leaf as usize * self.view_count..][..self.view_count],
            total: self.totals[leaf as usize],
            lg_total: self.lg_totals[leaf as usize],
        };
        let incoming = &self.incoming[leaf as usize];
        for &index in incoming.iter().take(8) {
            prefetch(&self.edges, index as usize);
        }
        for (k, &index) in incoming.iter().enumerate() {
            if let Some(&ahead) = incoming.get(k + 8) {
                prefetch(&self.edges, ahead as usize);
            }
            if let Some(&ahead) = incoming.get(k + 3) {
                let from = self.edges[ahead as usize].from as usize;
                prefetch_range(&self.deltas, from * self.view_count, self.view_count);
            }
            let edge = &self.edges[index as usize];
            if edge.touched != NONE {
                continue;
            }
            let deltas =
                &mut self.deltas[edge.from as usize * self.view_count..][..self.view_count];
            let moved = move_term(self.table, deltas, before, after, edge.total, &edge.reveals);
            let change = &mut self.change[edge.from as usize];
            if *change == Change::NONE {
                self.changed.push(edge.from);
            }
            change.add(moved);
        }
    }

    fn update_touched_edge(&mut self, k: usize) {
        let touched = &self.touched_edges[k];
        let edge = &self.edges[touched.edge as usize];
        let from = edge.from;
        if edge.to != 0 {
            let row = edge.to as usize * self.view_count;
            let after = Target {
                areas: &self.areas[row..row + self.view_count],
                total: self.totals[edge.to as usize],
                lg_total: self.lg_totals[edge.to as usize],
            };
            let before = match self.touched[edge.to as usize] {
                NONE => after,
                slot => {
                    let leaf = &self.touched_leaves[slot as usize];
                    Target {
                        areas: &self.areas_before[slot as usize * self.view_count..]
                            [..self.view_count],
                        total: leaf.total_before,
                        lg_total: leaf.lg_total_before,
                    }
                }
            };
            let deltas = &mut self.deltas[from as usize * self.view_count..][..self.view_count];
            replace_term(
                self.table,
                deltas,
                (before, touched.total_before, &touched.reveals_before),
                (after, edge.total, &edge.reveals),
            );
        }
        self.mark_changed(from);
    }

    fn drop_empty_edges(&mut self) {
        while let Some(touched) = self.touched_edges.pop() {
            let edge = &mut self.edges[touched.edge as usize];
            edge.touched = NONE;
            if edge.total > 0 {
                continue;
            }
            let (from, to, place) = (edge.from, edge.to, edge.place);
            self.edge_of.remove(&(from, to));
            self.free_edges.push(touched.edge);
            if to == 0 {
                self.background_edge[from as usize] = NONE;
            } else {
                let list = &mut self.incoming[to as usize];
                list.swap_remove(place as usize);
                if let Some(&moved) = list.get(place as usize) {
                    self.edges[moved as usize].place = place;
                }
            }
        }
    }
}

fn add_reveal(edge: &mut Edge, view: u32, by: i32) {
    edge.total = edge.total.wrapping_add_signed(by);
    let known = edge.reveals.iter().position(|(v, _)| *v == view);
    let at = known.unwrap_or_else(|| {
        edge.reveals.push((view, 0));
        edge.reveals.len() - 1
    });
    let pixels = &mut edge.reveals[at].1;
    *pixels = pixels.wrapping_add_signed(by);
    if *pixels == 0 {
        edge.reveals.swap_remove(at);
    }
}
