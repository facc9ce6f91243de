//! The leaves that one core answers for.

use std::sync::Arc;

use rayon::prelude::*;

use super::candidates::{Candidates, Found, Limits};
use super::counts::Counts;
use super::deltas::{Deltas, Sight};
use super::edges::Edges;
use super::events::Event;
use super::pane::Pane;
use super::split::Split;

/// What a shard finds in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finds {
    pub cheapest: Found,
    /// The largest cost; MIN if nobody asked.
    pub largest: i64,
}

impl Finds {
    pub(super) const NONE: Self = Self {
        cheapest: Found::NONE,
        largest: i64::MIN,
    };

    /// What two shards find together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            cheapest: self.cheapest.min(other.cheapest),
            largest: self.largest.max(other.largest),
        }
    }
}

pub(super) struct Shard {
    edges: Edges,
    deltas: Deltas,
    candidates: Candidates,
    pub finds: Finds,
}

impl Shard {
    /// The events of `panes` are what leads from nothing but background to what
    /// is there; `leaves`, neighbours close together, are those of all shards that are
    /// left; `rank_of` their ranks among equals, by leaf number; `deviations`
    /// what costs are measured with.
    pub(super) fn all(
        counts: &Counts<'_>,
        panes: &[Pane],
        split: Split,
        leaves: &[u32],
        rank_of: &Arc<[u32]>,
        pixels_per_view: usize,
        deviations: &[i64],
    ) -> Vec<Self> {
        let shards = (0..split.shards()).into_par_iter();
        let shards = shards.map(|shard| {
            Self::new(
                counts,
                panes,
                (split, shard),
                leaves,
                rank_of.clone(),
                pixels_per_view,
                deviations,
            )
        });
        shards.collect()
    }

    fn new(
        counts: &Counts<'_>,
        panes: &[Pane],
        (split, shard): (Split, usize),
        leaves: &[u32],
        rank_of: Arc<[u32]>,
        pixels_per_view: usize,
        deviations: &[i64],
    ) -> Self {
        let events = panes.iter().flat_map(Pane::events);
        let edges = Edges::new(
            events,
            (counts.leaf_count(), pixels_per_view as u32),
            (split, shard),
        );
        let deltas = Deltas::new(counts, &edges, (split, shard));
        let sight = Sight {
            counts,
            edges: &edges,
            deltas: &deltas,
        };
        let own = leaves.iter().copied();
        let own = own.filter(|leaf| split.shard(*leaf) == shard).collect();
        let candidates = Candidates::new(sight, own, rank_of, pixels_per_view, deviations);
        Self {
            edges,
            deltas,
            candidates,
            finds: Finds::NONE,
        }
    }

    /// Begins a step: `deviations` are those that costs are measured with.
    pub(super) fn begin_step(&mut self, counts: &Counts<'_>, deviations: &[i64]) {
        self.candidates.begin_step(counts, deviations);
    }

    /// Takes note of the events of a step that pruned a leaf.
    pub(super) fn follow<'e>(
        &mut self,
        counts: &Counts<'_>,
        events: impl Iterator<Item = &'e Event>,
        pruned: u32,
    ) {
        let Self {
            edges,
            deltas,
            candidates,
            ..
        } = self;
        edges.follow(events);
        deltas.follow(counts, edges);
        edges.forget_step();
        let sight = Sight {
            counts,
            edges,
            deltas,
        };
        candidates.remove(sight, pruned);
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
    }

    /// Looks for the cheapest leaf and, if wanted, the largest cost.
    pub(super) fn search(&mut self, counts: &Counts<'_>, limits: &Limits, wants_largest: bool) {
        let sight = Sight {
            counts,
            edges: &self.edges,
            deltas: &self.deltas,
        };
        self.candidates.keep_up(sight);
        self.finds.cheapest = self.candidates.cheapest(sight, limits);
        self.finds.largest = match wants_largest {
            true => self.candidates.largest_cost(sight, limits),
            false => i64::MIN,
        };
    }

    /// P times the change of VMI over all views if a leaf of this shard went.
    pub(super) fn delta_sum(&self, counts: &Counts<'_>, leaf: u32) -> i64 {
        let mut row = vec![0; counts.view_count()];
        let sight = Sight {
            counts,
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
    pub(super) fn exhaustively(&mut self, counts: &Counts<'_>) -> Finds {
        let sight = Sight {
            counts,
            edges: &self.edges,
            deltas: &self.deltas,
        };
        let (cheapest, largest) = self.candidates.exhaustively(sight);
        Finds { cheapest, largest }
    }
}
