//! The leaves that one core answers for.

use std::sync::Arc;

use rayon::prelude::*;

use super::candidates::{Candidates, Found, Limits};
use super::counts::Counts;
use super::deltas::{Deltas, Sight};
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
    deltas: Deltas,
    candidates: Candidates,
    pub finds: Finds,
}

impl Shard {
    /// `leaves`, neighbours close together, are those of all shards that are
    /// left; `rank_of` their ranks among equals, by leaf number; `deviations`
    /// what costs are measured with.
    pub(super) fn all(
        counts: &Counts<'_>,
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
        (split, shard): (Split, usize),
        leaves: &[u32],
        rank_of: Arc<[u32]>,
        pixels_per_view: usize,
        deviations: &[i64],
    ) -> Self {
        let deltas = Deltas::new(counts, split, shard);
        let sight = Sight {
            counts,
            deltas: &deltas,
        };
        let own = leaves.iter().copied();
        let own = own.filter(|leaf| split.shard(*leaf) == shard).collect();
        let candidates = Candidates::new(sight, own, rank_of, pixels_per_view, deviations);
        Self {
            deltas,
            candidates,
            finds: Finds::NONE,
        }
    }

    /// Takes note of a step that pruned a leaf.
    pub(super) fn follow(&mut self, counts: &Counts<'_>, pruned: u32) {
        let Self {
            deltas, candidates, ..
        } = self;
        deltas.follow(counts);
        let sight = Sight { counts, deltas };
        candidates.remove(sight, pruned);
        deltas.for_each_changed(|deltas, leaf, change, soon| {
            candidates.prefetch(soon);
            candidates.note(Sight { counts, deltas }, leaf, change);
        });
    }

    /// Looks for the cheapest leaf and, if wanted, the largest cost.
    pub(super) fn search(
        &mut self,
        counts: &Counts<'_>,
        deviations: &[i64],
        limits: &Limits,
        wants_largest: bool,
    ) {
        let sight = Sight {
            counts,
            deltas: &self.deltas,
        };
        self.candidates.begin_step(sight, deviations);
        self.finds.cheapest = self.candidates.cheapest(sight, limits);
        self.finds.largest = match wants_largest {
            true => self.candidates.largest_cost(sight, limits),
            false => i64::MIN,
        };
    }

    /// P times the change of VMI over all views if a leaf of this shard went.
    pub(super) fn delta_sum(&self, counts: &Counts<'_>, leaf: u32) -> i64 {
        let mut row = vec![0; counts.view_count()];
        let deltas = &self.deltas;
        Sight { counts, deltas }.deltas(leaf, &mut row);
        row.iter().sum()
    }

    #[cfg(test)]
    pub(super) fn exhaustively(&mut self, counts: &Counts<'_>) -> Finds {
        let deltas = &self.deltas;
        let (cheapest, largest) = self.candidates.exhaustively(Sight { counts, deltas });
        Finds { cheapest, largest }
    }
}
