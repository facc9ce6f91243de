//! Reveal edges: which leaf would hand how many pixels to which, view by view.
//!
//! A leaf hides few others, so edges are few; each is found by its two leaves and in the
//! list of those that lead to the same leaf.

use secateur_raster::measure::rows::Rows;
use secateur_raster::prefetch::prefetch;

use super::counts::Counts;
use super::edge_map::EdgeMap;
use super::reveals::Reveals;
use super::split::Split;
use super::switches::{Mechanism, is_on};
use secateur_raster::abuffer::Event;

const NO_EDGE: u32 = u32::MAX;

/// How many events ahead edges are asked for.
const EVENTS_AHEAD: usize = 8;

/// What leaf `from` would hand to leaf `to` behind it if it went.
#[repr(align(64))]
pub(super) struct Edge {
    pub from: u32,
    pub to: u32,
    /// Pixels over all views.
    pub total: u32,
    /// Where the list of those that lead to `to` holds this edge.
    place: u32,
    /// Whether the step changed it.
    pub is_touched: bool,
    pub reveals: Reveals,
}

impl Edge {
    fn add(&mut self, view: u32, by: i32) {
        self.total = self.total.wrapping_add_signed(by);
        self.reveals.add(view, by);
    }
}

/// An edge of the step, as it was before.
pub(super) struct TouchedEdge {
    pub edge: u32,
    pub total_before: u32,
    pub reveals_before: Reveals,
}

/// The edges from the leaves of a shard; those that lead to the background are
/// apart.
pub(super) struct Edges {
    split: Split,
    shard: usize,
    pixels_per_view: u32,
    all: Vec<Edge>,
    free: Vec<u32>,
    by_ends: EdgeMap,
    /// By row of the leaf they lead to.
    incoming: Vec<Vec<u32>>,
    rows: Rows,
    /// By row of the leaf they come from.
    to_background: Vec<u32>,
    touched: Vec<TouchedEdge>,
    /// Edge, view, and pixels more or fewer: what a step is about to change.
    changes: Vec<(u32, u32, i32)>,
}

impl Edges {
    /// `events` are what leads from nothing but background to what is there.
    pub(super) fn new<'e>(
        events: impl Iterator<Item = &'e Event>,
        counts: &Counts<'_>,
        pixels_per_view: u32,
        (split, shard): (Split, usize),
    ) -> Self {
        let leaf_count = counts.leaf_count();
        let rows = counts.rows(leaf_count + 1);
        let mut edges = Self {
            split,
            shard,
            pixels_per_view,
            all: Vec::new(),
            free: Vec::new(),
            by_ends: EdgeMap::new(),
            incoming: vec![Vec::new(); rows.count()],
            rows,
            to_background: vec![NO_EDGE; split.rows(leaf_count)],
            touched: Vec::new(),
            changes: Vec::new(),
        };
        for event in events {
            let [front, second] = event.after;
            if edges.is_own(front) {
                let index = edges.between(front, second);
                edges.all[index as usize].add(event.view, event.pixels as i32);
            }
        }
        edges
    }

    #[inline(always)]
    fn is_own(&self, leaf: u32) -> bool {
        leaf != 0 && self.split.shard(leaf) == self.shard
    }

    pub(super) fn all(&self) -> &[Edge] {
        &self.all
    }

    #[inline(always)]
    pub(super) fn get(&self, index: u32) -> &Edge {
        &self.all[index as usize]
    }

    /// What a leaf would hand to the background.
    #[inline]
    pub(super) fn to_background(&self, leaf: u32) -> Option<&Edge> {
        match self.to_background[self.split.row(leaf)] {
            NO_EDGE => None,
            index => Some(self.get(index)),
        }
    }

    /// Asks for the memory of [`to_background`](Self::to_background).
    #[inline(always)]
    pub(super) fn prefetch_to_background(&self, leaf: u32) {
        match self.to_background[self.split.row(leaf)] {
            NO_EDGE => {}
            index => prefetch(&self.all, index as usize),
        }
    }

    /// Asks for the memory of
    /// [`prefetch_to_background`](Self::prefetch_to_background).
    #[inline(always)]
    pub(super) fn prefetch_place_of_background(&self, leaf: u32) {
        prefetch(&self.to_background, self.split.row(leaf));
    }

    /// Asks for the memory of [`incoming`](Self::incoming).
    #[inline(always)]
    pub(super) fn prefetch_incoming(&self, to: u32) {
        prefetch(&self.incoming, self.rows.row(to as usize));
    }

    /// The edges that lead to a leaf.
    #[inline]
    pub(super) fn incoming(&self, to: u32) -> &[u32] {
        &self.incoming[self.rows.row(to as usize)]
    }

    /// The edges that the step changed.
    pub(super) fn touched(&self) -> &[TouchedEdge] {
        &self.touched
    }

    /// Takes note of what a step changed.
    pub(super) fn follow<'e>(&mut self, events: impl Iterator<Item = &'e Event> + Clone) {
        // All edges are looked up, and their memory asked for, before the first
        // is changed.
        let mut changes = std::mem::take(&mut self.changes);
        let mut ahead = events.clone().skip(EVENTS_AHEAD);
        for event in events {
            if is_on(Mechanism::PrefetchEdges)
                && let Some(ahead) = ahead.next()
            {
                for [from, to] in [ahead.before, ahead.after] {
                    self.by_ends.prefetch(from, to);
                }
            }
            let pixels = event.pixels as i32;
            for ([from, to], by) in [(event.before, -pixels), (event.after, pixels)] {
                if self.is_own(from) {
                    let index = self.between(from, to);
                    if is_on(Mechanism::PrefetchEdges) {
                        prefetch(&self.all, index as usize);
                    }
                    changes.push((index, event.view, by));
                }
            }
        }
        for (index, view, by) in changes.drain(..) {
            self.add(index, view, by);
        }
        self.changes = changes;
    }

    /// The edge between two leaves, which may be new.
    fn between(&mut self, from: u32, to: u32) -> u32 {
        let Self {
            split,
            pixels_per_view,
            all,
            free,
            by_ends,
            incoming,
            rows,
            to_background,
            ..
        } = self;
        by_ends.get_or_insert_with((from, to), || {
            let row = rows.own(to as usize);
            if row == incoming.len() {
                incoming.push(Vec::new());
            }
            let list = &mut incoming[row];
            let edge = Edge {
                from,
                to,
                total: 0,
                place: list.len() as u32,
                is_touched: false,
                reveals: Reveals::none(*pixels_per_view),
            };
            let index = match free.pop() {
                Some(index) => {
                    all[index as usize] = edge;
                    index
                }
                None => {
                    all.push(edge);
                    all.len() as u32 - 1
                }
            };
            match to {
                0 => to_background[split.row(from)] = index,
                _ => list.push(index),
            }
            index
        })
    }

    /// Adds pixels in a view, and remembers what was before.
    fn add(&mut self, index: u32, view: u32, by: i32) {
        let edge = &mut self.all[index as usize];
        if !std::mem::replace(&mut edge.is_touched, true) {
            self.touched.push(TouchedEdge {
                edge: index,
                total_before: edge.total,
                reveals_before: edge.reveals.clone(),
            });
        }
        edge.add(view, by);
    }

    /// Forgets what was before the step, and edges that have no pixels left.
    pub(super) fn forget_step(&mut self) {
        while let Some(touched) = self.touched.pop() {
            let edge = &mut self.all[touched.edge as usize];
            edge.is_touched = false;
            if edge.total == 0 {
                self.drop(touched.edge);
            }
        }
    }

    fn drop(&mut self, index: u32) {
        let Edge {
            from, to, place, ..
        } = self.all[index as usize];
        self.by_ends.remove(from, to);
        self.free.push(index);
        if to == 0 {
            self.to_background[self.split.row(from)] = NO_EDGE;
            return;
        }
        let list = &mut self.incoming[self.rows.row(to as usize)];
        list.swap_remove(place as usize);
        if list.is_empty() {
            self.rows.give_back(to as usize);
        }
        if let Some(&moved) = list.get(place as usize) {
            self.all[moved as usize].place = place;
        }
    }
}
