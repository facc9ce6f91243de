//! What a simplification method decided, step by step.

use sha2::{Digest, Sha256};

use crate::LeafId;

/// A leaf that a step makes larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// The leaf that grows about its centre.
    pub leaf: LeafId,
    /// Its area after the step, as a multiple of its original area. The linear
    /// scale is the square root.
    pub area_scale: f64,
}

/// One step: a leaf disappears, and the leaves named beside it fill its gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a> {
    /// The leaf that disappears.
    pub removed: LeafId,
    /// The leaves that take its place, grown; none for a plain removal.
    pub grown: &'a [Growth],
}

/// The steps that take a foliage of [`leaf_count`](Self::leaf_count) leaves
/// apart. Each leaf is removed at most once, and no leaf grows after its
/// removal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RemovalOrder {
    leaf_count: u32,
    removed: Vec<LeafId>,
    growths: Vec<Growth>,
    /// `growths[..ends[k]]` belong to the steps up to and with k.
    ends: Vec<u32>,
}

impl RemovalOrder {
    /// An order without steps over this many leaves.
    pub fn new(leaf_count: u32) -> Self {
        Self {
            leaf_count,
            ..Self::default()
        }
    }

    /// Appends a step.
    pub fn push(&mut self, removed: LeafId, grown: &[Growth]) {
        debug_assert!(removed.get() <= self.leaf_count);
        self.removed.push(removed);
        self.growths.extend_from_slice(grown);
        self.ends.push(self.growths.len() as u32);
    }

    /// Keeps the first `steps` steps.
    pub fn truncate(&mut self, steps: usize) {
        self.removed.truncate(steps);
        self.ends.truncate(steps);
        let growths = self.ends.last().copied().unwrap_or(0);
        self.growths.truncate(growths as usize);
    }

    /// How many leaves there were before the first step.
    pub fn leaf_count(&self) -> u32 {
        self.leaf_count
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.removed.len()
    }

    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty()
    }

    /// The removed leaves, first removed first.
    pub fn removed(&self) -> &[LeafId] {
        &self.removed
    }

    /// The steps, first to last.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = Step<'_>> {
        (0..self.len()).map(|k| {
            let start = if k == 0 { 0 } else { self.ends[k - 1] } as usize;
            Step {
                removed: self.removed[k],
                grown: &self.growths[start..self.ends[k] as usize],
            }
        })
    }

    /// SHA-256 over the removed leaf numbers as u32 little-endian, in order, as
    /// lower-case hexadecimal digits: equal orders have equal hashes on every
    /// platform.
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        for leaf in &self.removed {
            hash.update(leaf.get().to_le_bytes());
        }
        hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truncating_forgets_growth_too() {
        let leaf = |n| LeafId::new(n).unwrap();
        let grown = |n, area_scale| Growth {
            leaf: leaf(n),
            area_scale,
        };
        let mut order = RemovalOrder::new(4);
        order.push(leaf(2), &[grown(1, 1.5), grown(3, 1.25)]);
        order.push(leaf(3), &[]);
        order.push(leaf(4), &[grown(1, 2.0)]);
        let steps: Vec<usize> = order.steps().map(|s| s.grown.len()).collect();
        assert_eq!(steps, [2, 0, 1]);
        order.truncate(1);
        assert_eq!(order.len(), 1);
        assert_eq!(order.steps().next().unwrap().grown[1], grown(3, 1.25));
    }

    #[test]
    fn hash_is_of_the_little_endian_numbers() {
        let mut order = RemovalOrder::new(3);
        order.push(LeafId::new(1).unwrap(), &[]);
        // sha256 of the bytes 01 00 00 00.
        assert_eq!(
            order.sha256(),
            "67abdd721024f0ff4e0b3f4c2fc13bc5bad42d0b7851d456d88d203d15aaa450"
        );
    }
}
