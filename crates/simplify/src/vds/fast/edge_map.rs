//! Which edge there is between two leaves.
//!
//! A step looks up hundreds of edges, known beforehand, in tables larger than
//! the caches: here their places can be [asked for](EdgeMap::prefetch), which
//! maps of others do not offer.

use secateur_raster::prefetch::prefetch;

/// Slots at first; a power of two.
const FEWEST_SLOTS: usize = 64;

#[derive(Clone, Copy)]
struct Slot {
    /// The leaf an edge comes from, then the one it leads to; 0 where none is, as
    /// no edge comes from the background.
    ends: u64,
    edge: u32,
}

const EMPTY: Slot = Slot { ends: 0, edge: 0 };

/// Numbers of edges by the leaves they come from and lead to: open addressing,
/// where each entry is found between the place that its hash names and the next
/// empty slot.
pub(super) struct EdgeMap {
    /// A power of two, at most three of four taken.
    slots: Vec<Slot>,
    len: usize,
}

impl EdgeMap {
    pub(super) fn new() -> Self {
        Self {
            slots: vec![EMPTY; FEWEST_SLOTS],
            len: 0,
        }
    }

    /// Asks for the memory that a look at an edge will need.
    #[inline(always)]
    pub(super) fn prefetch(&self, from: u32, to: u32) {
        prefetch(&self.slots, self.home(ends(from, to)));
    }

    /// The edge between two leaves, or `new` from now on.
    #[inline]
    pub(super) fn get_or_insert_with(
        &mut self,
        (from, to): (u32, u32),
        new: impl FnOnce() -> u32,
    ) -> u32 {
        let ends = ends(from, to);
        let mut at = self.home(ends);
        loop {
            let slot = &mut self.slots[at];
            if slot.ends == ends {
                return slot.edge;
            }
            if slot.ends == 0 {
                let edge = new();
                *slot = Slot { ends, edge };
                self.len += 1;
                if self.len > self.slots.len() / 4 * 3 {
                    self.grow();
                }
                return edge;
            }
            at = self.after(at);
        }
    }

    /// Forgets the edge between two leaves, which is there.
    pub(super) fn remove(&mut self, from: u32, to: u32) {
        let ends = ends(from, to);
        let mut gap = self.home(ends);
        while self.slots[gap].ends != ends {
            assert!(self.slots[gap].ends != 0, "the edge is there");
            gap = self.after(gap);
        }
        self.len -= 1;
        // Entries behind it that may stand here move up.
        let mut at = gap;
        loop {
            at = self.after(at);
            let slot = self.slots[at];
            if slot.ends == 0 {
                break;
            }
            let mask = self.slots.len() - 1;
            let from_home = |place: usize| place.wrapping_sub(self.home(slot.ends)) & mask;
            if from_home(gap) < from_home(at) {
                self.slots[gap] = slot;
                gap = at;
            }
        }
        self.slots[gap] = EMPTY;
    }

    /// Where an entry is looked for first.
    #[inline(always)]
    fn home(&self, ends: u64) -> usize {
        let mixed = ends.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (mixed >> (64 - self.slots.len().ilog2())) as usize
    }

    #[inline(always)]
    fn after(&self, at: usize) -> usize {
        (at + 1) & (self.slots.len() - 1)
    }

    #[cold]
    fn grow(&mut self) {
        let slots = vec![EMPTY; 2 * self.slots.len()];
        let old = std::mem::replace(&mut self.slots, slots);
        for slot in old.into_iter().filter(|slot| slot.ends != 0) {
            let mut at = self.home(slot.ends);
            while self.slots[at].ends != 0 {
                at = self.after(at);
            }
            self.slots[at] = slot;
        }
    }
}

#[inline(always)]
fn ends(from: u32, to: u32) -> u64 {
    u64::from(from) << 32 | u64::from(to)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Few slots, so that most entries stand behind others and around the end.
        #[test]
        fn edges_come_and_go_as_in_any_map(
            steps in prop::collection::vec((1u32..12, 0u32..12, any::<bool>()), 1..600),
        ) {
            let (mut map, mut expected) = (EdgeMap::new(), HashMap::new());
            for (edge, (from, to, goes)) in (0u32..).zip(steps) {
                if goes && expected.remove(&(from, to)).is_some() {
                    map.remove(from, to);
                } else {
                    let known = *expected.entry((from, to)).or_insert(edge);
                    prop_assert_eq!(map.get_or_insert_with((from, to), || edge), known);
                }
                prop_assert_eq!(map.len, expected.len());
                for (&ends, &edge) in &expected {
                    prop_assert_eq!(map.get_or_insert_with(ends, || u32::MAX), edge);
                }
            }
        }
    }
}
