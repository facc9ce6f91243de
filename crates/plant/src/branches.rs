//! The tree of a skeleton's branches and how much each of them matters.
//!
//! Lluch et al. (Hybrid): section 4.1.1 for the metrics, 4.1.2 for the tree.

use crate::{Segment, SegmentIndex, Skeleton};

/// The place of a branch in [`Branches`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BranchIndex(u32);

impl BranchIndex {
    pub(crate) fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("a branch index fits 32 bits"))
    }

    /// Its place, from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// How much a branch matters (section 4.1.1, a to d).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Metric {
    /// How many branches grow from the branch.
    Children,
    /// How many branches grow from the branch, from those, and so on.
    Descendants,
    /// The longest way from the branch's start to a tip.
    LongestPath,
    /// The length of the branch and of all its descendants.
    ///
    /// L(n): its length and that of all its descendants, in metres. What the
    /// paper prefers.
    #[default]
    BranchingLength,
}

/// A run of segments that continue each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branch {
    /// The branch it grows from; always an earlier one.
    pub parent: Option<BranchIndex>,
    /// Its segments, from its start to its tip; never none.
    pub segments: Vec<SegmentIndex>,
    /// The branches that grow from it, in the order they were drawn.
    pub children: Vec<BranchIndex>,
    /// The length of its segments, in metres.
    pub length_m: f64,
}

/// The branches of a skeleton, parents before children.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    branches: Vec<Branch>,
}

impl Branches {
    /// Finds the branches. Of several segments that continue the same one, the
    /// first stays in its branch and the others start their own.
    ///
    /// # Panics
    /// If a segment's parent is not an earlier one.
    pub fn of(skeleton: &Skeleton) -> Self {
        Self::of_segments(&skeleton.segments)
    }

    /// [`of`](Self::of) a skeleton with these segments.
    ///
    /// # Panics
    /// If a segment's parent is not an earlier one.
    pub fn of_segments(segments: &[Segment]) -> Self {
        let mut branches: Vec<Branch> = Vec::new();
        let mut branch_of: Vec<BranchIndex> = Vec::with_capacity(segments.len());
        for (index, segment) in segments.iter().enumerate() {
            let this = SegmentIndex::from_index(index);
            let parent = segment.parent.map(|p| (p, branch_of[p.index()]));
            let continued = parent.filter(|(segment_before, branch)| {
                segment.continues_parent
                    && branches[branch.index()].segments.last() == Some(segment_before)
            });
            let branch = match continued {
                Some((_, branch)) => branch,
                None => start_branch(&mut branches, parent.map(|(_, branch)| branch)),
            };
            let grown = &mut branches[branch.index()];
            grown.segments.push(this);
            grown.length_m += (segment.end - segment.start).length();
            branch_of.push(branch);
        }
        Self { branches }
    }

    /// All of them, parents before children.
    pub fn all(&self) -> &[Branch] {
        &self.branches
    }

    /// The metric of every branch, in the order of [`all`](Self::all).
    ///
    /// Time in proportion to the number of branches.
    pub fn weights(&self, metric: Metric) -> Vec<f64> {
        let own = |branch: &Branch| match metric {
            Metric::Children => branch.children.len() as f64,
            Metric::Descendants => 0.0,
            Metric::LongestPath | Metric::BranchingLength => branch.length_m,
        };
        let mut weights: Vec<f64> = self.branches.iter().map(own).collect();
        for (index, branch) in self.branches.iter().enumerate().rev() {
            let of_children = branch.children.iter().map(|child| weights[child.index()]);
            weights[index] += match metric {
                Metric::Children => 0.0,
                Metric::Descendants => of_children.map(|below| 1.0 + below).sum(),
                Metric::LongestPath => of_children.fold(0.0, f64::max),
                Metric::BranchingLength => of_children.sum(),
            };
        }
        weights
    }
}

fn start_branch(branches: &mut Vec<Branch>, parent: Option<BranchIndex>) -> BranchIndex {
    let branch = BranchIndex::from_index(branches.len());
    if let Some(parent) = parent {
        branches[parent.index()].children.push(branch);
    }
    branches.push(Branch {
        parent,
        ..Branch::default()
    });
    branch
}
