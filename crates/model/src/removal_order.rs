//! What a simplification method decided, step by step.

use std::ops::Range;

use sha2::{Digest, Sha256};

use crate::{Foliage, LeafId, NewLeaf};

/// A leaf that a step makes larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// The leaf that grows about its centre.
    pub leaf: LeafId,
    /// Its area after the step, as a multiple of its original area, or of that of
    /// its triangles if it was made. The linear scale is the square root.
    pub area_scale: f64,
}

/// One step: leaves disappear, and what is named beside them takes their place; or
/// leaves change their size.
///
/// | method | removed | grown | made | survivors |
/// |---|---|---|---|---|
/// | VDS | one | its neighbours | none | as they were |
/// | VDS on coarser leaves, first step | all that get coarser | none | as many | as they were |
/// | FSA | two | none | one | as they were |
/// | stochastic | one | none | none | all of one scale |
/// | VDS, needles that grow across, before sizes | those | none | as many | as they were |
/// | fitted sizes, last step | none | any, or less than they were | none | as they were |
/// | meshoptimizer, in one step | any | none | any | as they were |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a> {
    /// The leaves that disappear.
    pub removed: &'a [LeafId],
    /// The leaves that fill their gap, grown; original or made ones.
    pub grown: &'a [Growth],
    /// New leaves. Their names count on from the last leaf's: the first that an
    /// order makes is leaf [`RemovalOrder::leaf_count`] + 1.
    pub made: &'a [NewLeaf],
    /// By what the area of every original leaf that is left is multiplied,
    /// beside its own growth, until another step says otherwise; 1 for methods
    /// that know no common scale.
    pub survivors_area_scale: f64,
}

/// How far the lists of an order go at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StepEnd {
    removed: u32,
    grown: u32,
    made: u32,
    survivors_area_scale: f64,
}

/// The steps that take a foliage of [`leaf_count`](Self::leaf_count) leaves
/// apart. Each leaf, made ones included, is removed at most once, and none
/// grows after its removal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RemovalOrder {
    leaf_count: u32,
    removed: Vec<LeafId>,
    growths: Vec<Growth>,
    made: Vec<NewLeaf>,
    ends: Vec<StepEnd>,
}

impl RemovalOrder {
    /// An order without steps over this many leaves.
    pub fn new(leaf_count: u32) -> Self {
        Self {
            leaf_count,
            ..Self::default()
        }
    }

    /// Appends the removal of one leaf for which others grow.
    pub fn push(&mut self, removed: LeafId, grown: &[Growth]) {
        self.push_step(Step {
            removed: &[removed],
            grown,
            made: &[],
            survivors_area_scale: 1.0,
        });
    }

    /// Appends a step of an order that someone else wrote: [`check`](Self::check) it in the end.
    pub fn push_unchecked(&mut self, step: Step<'_>) {
        self.append(step);
    }

    /// Appends a step of any kind: several leaves may go, grow or be made.
    pub fn push_step(&mut self, step: Step<'_>) {
        let named = self.leaf_count as usize + self.made.len();
        debug_assert!(step.removed.iter().all(|leaf| leaf.index() < named));
        debug_assert!(
            step.made
                .iter()
                .all(|leaf| leaf.donor.get() <= self.leaf_count)
        );
        self.append(step);
    }

    fn append(&mut self, step: Step<'_>) {
        self.removed.extend_from_slice(step.removed);
        self.growths.extend_from_slice(step.grown);
        self.made.extend_from_slice(step.made);
        self.ends.push(StepEnd {
            removed: self.removed.len() as u32,
            grown: self.growths.len() as u32,
            made: self.made.len() as u32,
            survivors_area_scale: step.survivors_area_scale,
        });
    }

    /// Keeps the first `steps` steps.
    pub fn truncate(&mut self, steps: usize) {
        self.ends.truncate(steps);
        let end = self.end_of(self.len());
        self.removed.truncate(end.removed as usize);
        self.growths.truncate(end.grown as usize);
        self.made.truncate(end.made as usize);
    }

    /// The lengths of the lists after this number of steps.
    fn end_of(&self, steps: usize) -> StepEnd {
        let none = StepEnd {
            removed: 0,
            grown: 0,
            made: 0,
            survivors_area_scale: 1.0,
        };
        steps.checked_sub(1).map_or(none, |last| self.ends[last])
    }

    /// How many leaves there were before the first step.
    pub fn leaf_count(&self) -> u32 {
        self.leaf_count
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The removed leaves, first removed first.
    pub fn removed(&self) -> &[LeafId] {
        &self.removed
    }

    /// How many leaves are left after the first `steps` steps.
    ///
    /// # Panics
    /// If there are fewer steps.
    pub fn leaves_after(&self, steps: usize) -> usize {
        let end = self.end_of(steps);
        (self.leaf_count + end.made - end.removed) as usize
    }

    /// The number of steps until this foliage has this many triangles or fewer;
    /// all of them if it never has.
    ///
    /// # Panics
    /// If the order is one of another foliage.
    pub fn steps_to_triangles(&self, foliage: &Foliage, at_most: usize) -> usize {
        assert_eq!(self.leaf_count as usize, foliage.leaves().len());
        let triangles_of = |leaf: &LeafId| match leaf.get().checked_sub(self.leaf_count + 1) {
            None => foliage.triangles_of(*leaf).len(),
            Some(made) => self.made[made as usize].triangles.len(),
        };
        let mut left = foliage.triangles().len();
        let over = self.steps().take_while(|step| {
            let is_over = left > at_most;
            left += step.made.iter().map(|m| m.triangles.len()).sum::<usize>();
            left -= step.removed.iter().map(triangles_of).sum::<usize>();
            is_over
        });
        over.count()
    }

    /// The steps, first to last.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = Step<'_>> {
        (0..self.len()).map(|k| self.step(k))
    }

    /// One step, from 0.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn step(&self, index: usize) -> Step<'_> {
        Step {
            removed: &self.removed[self.removed_in(index)],
            grown: &self.growths[self.grown_in(index)],
            made: &self.made[self.made_in(index)],
            survivors_area_scale: self.ends[index].survivors_area_scale,
        }
    }

    /// Where the removed leaves of a step are in [`Self::removed`].
    pub(crate) fn removed_in(&self, step: usize) -> Range<usize> {
        self.end_of(step).removed as usize..self.ends[step].removed as usize
    }

    /// Where the growths of a step are among those of all steps.
    pub(crate) fn grown_in(&self, step: usize) -> Range<usize> {
        self.end_of(step).grown as usize..self.ends[step].grown as usize
    }

    /// Where the leaves that a step makes are in [`Self::made`].
    pub(crate) fn made_in(&self, step: usize) -> Range<usize> {
        self.end_of(step).made as usize..self.ends[step].made as usize
    }

    /// How many growths all steps have.
    pub(crate) fn growth_count(&self) -> usize {
        self.growths.len()
    }

    /// The leaves that the first `steps` steps make.
    pub(crate) fn made_in_first(&self, steps: usize) -> &[NewLeaf] {
        &self.made[..self.end_of(steps).made as usize]
    }

    /// The leaves that are made, in the order of their names.
    pub fn made(&self) -> &[NewLeaf] {
        &self.made
    }

    /// How many names there are: of original leaves, and of those that are made.
    pub fn name_count(&self) -> usize {
        self.leaf_count as usize + self.made.len()
    }

    /// The common scale of the survivors after the first `steps` steps.
    ///
    /// # Panics
    /// If there are fewer steps.
    pub fn survivors_area_scale_after(&self, steps: usize) -> f64 {
        self.end_of(steps).survivors_area_scale
    }

    /// SHA-256 over the removed leaf numbers as u32 little-endian, in order, as
    /// lower-case hexadecimal digits: equal orders have equal hashes on every
    /// platform.
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        for leaf in &self.removed {
            hash.update(leaf.get().to_le_bytes());
        }
        crate::hex(&hash.finalize())
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
