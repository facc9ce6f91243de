//! The leaves that one core answers for.
//!
//! Each shard has areas of all leaves to itself: to bring them up to date once for each
//! core costs less than to hand them from core to core in every step.

use std::borrow::Cow;
use std::ops::Deref;
use std::sync::Arc;

use rayon::prelude::*;

use super::candidates::{Candidates, Found, Limits};
use super::counts::Counts;
use super::deltas::{Deltas, Sight};
use super::edges::Edges;
use super::split::Split;
use super::switches::{Mechanism, is_on};
use super::view_slice::ViewSlice;

/// What a shard finds in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finds {
    pub cheapest: Found,
    /// The cheapest leaf that has an effect on what views show, if none without costs less.
    pub cheapest_with_effect: Found,
    /// The largest cost; MIN if nobody asked.
    pub largest: i64,
}

impl Finds {
    pub(super) const NONE: Self = Self {
        cheapest: Found::NONE,
        cheapest_with_effect: Found::NONE,
        largest: i64::MIN,
    };

    /// What two shards find together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            cheapest: self.cheapest.min(other.cheapest),
            cheapest_with_effect: self.cheapest_with_effect.min(other.cheapest_with_effect),
            largest: self.largest.max(other.largest),
        }
    }
}

pub(super) struct Shard<'t> {
    counts: Counts<'t>,
    /// The leaf pruned by the last step that the areas know of; 0 before the
    /// first.
    settled: u32,
    has_deviations: bool,
    edges: Edges,
    deltas: Deltas,
    candidates: Candidates,
    pub finds: Finds,
}

/// The deviations that costs are measured with: none against the previous foliage.
fn cost_deviations<'c>(counts: &'c Counts<'_>, has_deviations: bool) -> Cow<'c, [i64]> {
    match has_deviations {
        true => counts.deviations().into(),
        false => vec![0; counts.view_count()].into(),
    }
}

/// How far ahead the areas that an event changes are asked for.
const EVENTS_AHEAD: usize = 6;

impl<'t> Shard<'t> {
    /// The events of `slices` are what leads from nothing but background to what
    /// is there; `leaves` are those of all shards that are left; `rank_of` their ranks among
    /// equals, by leaf number; `has_deviations`
    /// whether costs are measured with those of VMI from that of the original foliage.
    pub(super) fn all(
        counts: Counts<'t>,
        slices: &[ViewSlice],
        split: Split,
        leaves: &[u32],
        rank_of: &Arc<[u32]>,
        pixels_per_view: usize,
        has_deviations: bool,
    ) -> Vec<Self> {
        // The last is the one that is here.
        let counts = vec![counts; split.shards()];
        let shards = counts.into_par_iter().enumerate().map(|(shard, counts)| {
            Self::new(
                counts,
                slices,
                (split, shard),
                leaves,
                rank_of.clone(),
                pixels_per_view,
                has_deviations,
            )
        });
        shards.collect()
    }

    fn new(
        counts: Counts<'t>,
        slices: &[ViewSlice],
        (split, shard): (Split, usize),
        leaves: &[u32],
        rank_of: Arc<[u32]>,
        pixels_per_view: usize,
        has_deviations: bool,
    ) -> Self {
        let events = slices.iter().flat_map(ViewSlice::events);
        let edges = Edges::new(events, &counts, pixels_per_view as u32, (split, shard));
        let deltas = Deltas::new(&counts, &edges, (split, shard));
        let sight = Sight {
            counts: &counts,
            edges: &edges,
            deltas: &deltas,
        };
        let own = leaves.iter().copied();
        let own = own.filter(|leaf| split.shard(*leaf) == shard).collect();
        let deviations = cost_deviations(&counts, has_deviations);
        let candidates = Candidates::new(
            sight,
            (own, leaves.len()),
            rank_of,
            pixels_per_view,
            (has_deviations, &deviations),
        );
        Self {
            counts,
            settled: 0,
            has_deviations,
            edges,
            deltas,
            candidates,
            finds: Finds::NONE,
        }
    }

    pub(super) fn counts(&self) -> &Counts<'t> {
        &self.counts
    }

    /// Brings the areas up to date with the step that pruned a leaf, as the slices
    /// edited it; unless they are already.
    pub(super) fn settle(&mut self, slices: &[impl Deref<Target = ViewSlice>], pruned: u32) {
        if std::mem::replace(&mut self.settled, pruned) == pruned {
            return;
        }
        for slice in slices {
            let events = slice.events();
            for (k, event) in events.iter().enumerate() {
                if is_on(Mechanism::PrefetchAreas)
                    && let Some(ahead) = events.get(k + EVENTS_AHEAD)
                {
                    self.counts.prefetch(ahead);
                }
                self.counts.record(event);
            }
        }
        self.counts.settle();
    }

    /// Begins a step, whose areas are settled.
    pub(super) fn begin_step(&mut self) {
        let deviations = cost_deviations(&self.counts, self.has_deviations);
        self.candidates.begin_step(&self.counts, &deviations);
    }

    /// Takes note of a [settled](Self::settle) step.
    pub(super) fn follow(&mut self, slices: &[impl Deref<Target = ViewSlice>], pruned: u32) {
        let Self {
            counts,
            edges,
            deltas,
            candidates,
            ..
        } = self;
        edges.follow(slices.iter().flat_map(|slice| slice.events()));
        deltas.follow(counts, edges);
        edges.forget_step();
        deltas.forget_unseen(counts);
        candidates.remove(pruned);
        deltas.for_each_changed(|deltas, leaf, change, [soon, later]| {
            let sight = Sight {
                counts,
                edges,
                deltas,
            };
            candidates.prefetch_place(later);
            candidates.prefetch(soon);
            candidates.note(sight, leaf, change);
        });
        counts.forget_step();
    }

    /// Looks for the cheapest leaf and, if wanted, the largest cost.
    pub(super) fn search(&mut self, limits: &Limits, wants_largest: bool) {
        let sight = Sight {
            counts: &self.counts,
            edges: &self.edges,
            deltas: &self.deltas,
        };
        self.candidates.rebuild_if_stale(sight);
        self.finds.cheapest = self.candidates.cheapest(sight, limits);
        self.finds.cheapest_with_effect = self.candidates.cheapest_with_effect();
        self.finds.largest = match wants_largest {
            true => self.candidates.largest_cost(sight, limits),
            false => i64::MIN,
        };
    }

    /// The first of this shard's leaves without effect.
    pub(super) fn first_without_effect(&self) -> Option<Found> {
        self.candidates.first_without_effect()
    }

    /// Takes away a leaf of any shard that no pixel shows.
    pub(super) fn forget(&mut self, leaf: u32) {
        self.candidates.remove(leaf);
    }

    /// P times the change of VMI over all views if a leaf of this shard went.
    pub(super) fn delta_sum(&self, leaf: u32) -> i64 {
        let mut row = vec![0; self.counts.view_count()];
        let sight = Sight {
            counts: &self.counts,
            edges: &self.edges,
            deltas: &self.deltas,
        };
        sight.deltas(leaf, &mut row);
        row.iter().sum()
    }

    /// Pixels over all views that a leaf of this shard would hand to the
    /// background.
    pub(super) fn background_px(&self, leaf: u32) -> u32 {
        let edge = self.edges.to_background(leaf);
        edge.map_or(0, |edge| edge.total)
    }

    #[cfg(test)]
    pub(super) fn exhaustively(&mut self) -> Finds {
        let sight = Sight {
            counts: &self.counts,
            edges: &self.edges,
            deltas: &self.deltas,
        };
        let (cheapest, cheapest_with_effect, largest) = self.candidates.exhaustively(sight);
        Finds {
            cheapest,
            cheapest_with_effect,
            largest,
        }
    }
}
