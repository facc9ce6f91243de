//! The paths of a chain: which branches each level adds.
//!
//! Lluch et al. (Hybrid), section 4.1.3: see [`chain`](crate::chain).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::branches::{BranchIndex, Branches, Metric};

/// The branches that each level adds, the coarsest level first.
pub(crate) fn paths(branches: &Branches, metric: Metric) -> Vec<Vec<BranchIndex>> {
    Extraction::new(branches, metric).paths()
}

/// A branch that waits at its fork: the heaviest comes first, then the earliest.
struct Waiting {
    weight: f64,
    branch: BranchIndex,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_weight = self.weight.total_cmp(&other.weight);
        by_weight.then_with(|| other.branch.cmp(&self.branch))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

struct Extraction<'a> {
    branches: &'a Branches,
    lengths_fall: bool,
    weights: Vec<f64>,
    is_out: Vec<bool>,
    /// For each branch its children with something still to come.
    waiting: Vec<BinaryHeap<Waiting>>,
    roots: BinaryHeap<Waiting>,
}

impl<'a> Extraction<'a> {
    fn new(branches: &'a Branches, metric: Metric) -> Self {
        let weights = branches.weights(metric);
        let waiting = |branch: BranchIndex| Waiting {
            weight: weights[branch.index()],
            branch,
        };
        let all = branches.all();
        let roots = (0..all.len()).filter(|&b| all[b].parent.is_none());
        Self {
            branches,
            lengths_fall: metric == Metric::BranchingLength,
            is_out: vec![false; all.len()],
            waiting: all
                .iter()
                .map(|b| b.children.iter().map(|&c| waiting(c)).collect())
                .collect(),
            roots: roots.map(|b| waiting(BranchIndex::from_index(b))).collect(),
            weights,
        }
    }

    fn paths(mut self) -> Vec<Vec<BranchIndex>> {
        let mut paths = Vec::new();
        while let Some(root) = self.roots.pop() {
            let route = self.route(root.branch);
            let path = self.put_out(&route);
            self.wait_again(&route);
            paths.push(path);
        }
        paths
    }

    /// Down from a root by the heaviest child at each fork, to a tip; those
    /// passed are taken from their forks.
    fn route(&mut self, root: BranchIndex) -> Vec<BranchIndex> {
        let mut route = vec![root];
        let mut at = root;
        while let Some(next) = self.waiting[at.index()].pop() {
            at = next.branch;
            route.push(at);
        }
        route
    }

    /// Marks what is new on the route and takes its length from every weight
    /// above it.
    fn put_out(&mut self, route: &[BranchIndex]) -> Vec<BranchIndex> {
        let mut length_m = 0.0;
        for branch in route.iter().rev().map(|branch| branch.index()) {
            if !self.is_out[branch] {
                length_m += self.branches.all()[branch].length_m;
            }
            if self.lengths_fall {
                self.weights[branch] -= length_m;
            }
        }
        let is_out = &mut self.is_out;
        let new = |branch: &&BranchIndex| !std::mem::replace(&mut is_out[branch.index()], true);
        route.iter().filter(new).copied().collect()
    }

    /// Branches of the route with something still to come go back to their forks.
    fn wait_again(&mut self, route: &[BranchIndex]) {
        for (depth, &branch) in route.iter().enumerate() {
            if self.waiting[branch.index()].is_empty() && !self.returns(&route[depth + 1..]) {
                continue;
            }
            let waiting = Waiting {
                weight: self.weights[branch.index()],
                branch,
            };
            match depth {
                0 => self.roots.push(waiting),
                _ => self.waiting[route[depth - 1].index()].push(waiting),
            }
        }
    }

    fn returns(&self, below: &[BranchIndex]) -> bool {
        below.iter().any(|b| !self.waiting[b.index()].is_empty())
    }
}
