//! Which shard of the engine answers for a leaf.
//!
//! Every core keeps the sums and bounds of its own leaves, so that none waits
//! for another within a step.

/// Leaves that follow each other and stay together: neighbours, mostly.
const TOGETHER_LOG2: u32 = 4;

/// Leaves in turn to a power of two of shards, a few neighbours at a time: what
/// a step changes is near the pruned leaf, and all shards shall have part in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    shards_log2: u32,
}

impl Split {
    /// A split over the largest power of two of shards that `cores` cores can serve.
    pub(super) fn over(cores: usize) -> Self {
        Self {
            shards_log2: cores.clamp(1, 1 << 8).ilog2(),
        }
    }

    pub(super) fn shards(self) -> usize {
        1 << self.shards_log2
    }

    /// The shard of a leaf, by its number.
    #[inline(always)]
    pub(super) fn shard(self, leaf: u32) -> usize {
        (leaf >> TOGETHER_LOG2) as usize & (self.shards() - 1)
    }

    /// Where a leaf stands among those of its shard.
    #[inline(always)]
    pub(super) fn row(self, leaf: u32) -> usize {
        let group = leaf >> (TOGETHER_LOG2 + self.shards_log2);
        (group << TOGETHER_LOG2 | leaf & ((1 << TOGETHER_LOG2) - 1)) as usize
    }

    /// Rows that a shard needs for leaves numbered to `last`.
    pub(super) fn rows(self, last: usize) -> usize {
        self.row(last as u32 | ((self.shards() as u32 - 1) << TOGETHER_LOG2)) + (1 << TOGETHER_LOG2)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn each_leaf_has_a_row_of_its_own() {
        for (cores, shards) in [(1, 1), (2, 2), (3, 2), (4, 4), (9, 8)] {
            let split = Split::over(cores);
            assert_eq!(split.shards(), shards);
            for last in [0, 1, 15, 16, 17, 31, 32, 100, 1000] {
                let rows = split.rows(last);
                let places = (0..=last as u32).map(|leaf| (split.shard(leaf), split.row(leaf)));
                let places: HashSet<_> = places.collect();
                assert_eq!(places.len(), last + 1);
                assert!(places.iter().all(|(s, r)| *s < shards && *r < rows));
                assert!(rows <= last / shards + 32);
            }
        }
    }
}
