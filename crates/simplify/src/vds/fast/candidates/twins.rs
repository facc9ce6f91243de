//! Leaves that cost the same.
//!
//! Crowns have thousands of leaves that cover a pixel or two before the
//! background. Where two of them cover as many pixels in the same views, with
//! nothing but the background behind, their costs are equal whatever becomes of
//! the background. Of such twins only the one of the lowest rank can be picked,
//! so the others need no looking at until it is gone.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// Areas by view, packed; for leaves with nothing but the background behind.
pub(in super::super) type Silhouette = SmallVec<[u32; 4]>;

#[derive(Default)]
pub(super) struct Twins {
    /// By rank, then leaf number.
    families: FxHashMap<Silhouette, BTreeSet<(u32, u32)>>,
    /// By leaf number: empty for those without.
    silhouettes: Vec<Silhouette>,
}

impl Twins {
    pub(super) fn new(leaf_count: usize) -> Self {
        Self {
            families: FxHashMap::default(),
            silhouettes: vec![Silhouette::new(); leaf_count + 1],
        }
    }

    /// Whether a twin of lower rank stands for this leaf.
    pub(super) fn is_hidden(&self, rank: u32, leaf: u32) -> bool {
        let family = self.families.get(&self.silhouettes[leaf as usize]);
        family
            .and_then(BTreeSet::first)
            .is_some_and(|first| *first < (rank, leaf))
    }

    /// Takes note of a leaf's silhouette, empty for none. Returns a leaf that
    /// must come forth, since this one stood for it, and one that this one now
    /// stands for.
    pub(super) fn set(
        &mut self,
        rank: u32,
        leaf: u32,
        silhouette: Silhouette,
    ) -> (Option<u32>, Option<u32>) {
        if self.silhouettes[leaf as usize] == silhouette {
            return (None, None);
        }
        let comes_forth = self.leave(rank, leaf);
        if silhouette.is_empty() {
            return (comes_forth, None);
        }
        let family = self.families.entry(silhouette.clone()).or_default();
        let first_before = family.first().copied();
        family.insert((rank, leaf));
        self.silhouettes[leaf as usize] = silhouette;
        let hides = first_before.filter(|first| (rank, leaf) < *first);
        (comes_forth, hides.map(|(_, leaf)| leaf))
    }

    /// Takes a leaf away; returns one that must come forth.
    pub(super) fn leave(&mut self, rank: u32, leaf: u32) -> Option<u32> {
        let silhouette = std::mem::take(&mut self.silhouettes[leaf as usize]);
        if silhouette.is_empty() {
            return None;
        }
        let family = self.families.get_mut(&silhouette)?;
        let was_first = family.first() == Some(&(rank, leaf));
        family.remove(&(rank, leaf));
        let next = family.first().map(|(_, leaf)| *leaf);
        if next.is_none() {
            self.families.remove(&silhouette);
        }
        next.filter(|_| was_first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_rank_stands_for_its_twins() {
        let mut twins = Twins::new(9);
        let one: Silhouette = [1].into_iter().collect();
        assert_eq!(twins.set(50, 5, one.clone()), (None, None));
        assert_eq!(twins.set(70, 7, one.clone()), (None, None));
        assert!(twins.is_hidden(70, 7) && !twins.is_hidden(50, 5));
        assert_eq!(twins.set(20, 2, one.clone()), (None, Some(5)));
        assert!(twins.is_hidden(50, 5));
        assert_eq!(twins.leave(20, 2), Some(5));
        let other: Silhouette = [2].into_iter().collect();
        assert_eq!(twins.set(50, 5, other), (Some(7), None));
        assert_eq!(twins.leave(70, 7), None);
        assert!(!twins.is_hidden(90, 9));
    }
}
