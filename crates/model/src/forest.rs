//! A removal order as a forest of collapses.
//!
//! Each version of a leaf is a node: as it was, and larger after each growth. A step of the order
//! takes some nodes and puts others in their place:
//!
//! | method | sources | results |
//! |---|---|---|
//! | VDS | the pruned leaf and its neighbour | the neighbour, grown |
//! | VDS, where nothing grows; stochastic | the leaf and its heir | the heir, as it is then |
//! | FSA, merging | two leaves | the new one |
//! | coarser leaves, fitted sizes | a leaf | the same, coarser or of another size |
//! | VDS with several neighbours | the leaf and these | these, grown |
//!
//! This is the "forest" of binary trees of Remolar, Chover, Ribelles, Belmonte: View-Dependent
//! Multiresolution Model for Foliage (WSCG 2003, section 4), their father nodes being results and
//! their children sources; of steps with several results it is a forest no longer, but a graph in
//! which every node is made and taken at most once.

use std::ops::Range;

use crate::{LeafId, NewLeaf, RemovalOrder, Step};

/// A version of a leaf, or the place of one that went without a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// The leaf; nothing where none is left in this place.
    pub leaf: Option<LeafId>,
    /// Its area as a multiple of its original one, or of that of its triangles if it was made.
    pub area_scale: f64,
}

/// The place of a node in [`Forest::nodes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeIndex(u32);

impl NodeIndex {
    /// Its place, from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The node at a place.
    ///
    /// # Panics
    /// If it does not fit 32 bits.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("a node index fits 32 bits"))
    }
}

/// A collapse, by its place in the order in which they happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CollapseIndex(u32);

impl CollapseIndex {
    /// Its place, from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The collapse at a place.
    ///
    /// # Panics
    /// If it does not fit 32 bits.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("a collapse index fits 32 bits"))
    }
}

/// Knows which leaf takes the place of one that goes without another growing for it.
pub trait Heirs {
    /// A leaf is there no longer.
    fn take(&mut self, leaf: LeafId);

    /// A leaf that was made is there.
    fn add(&mut self, leaf: LeafId);

    /// The leaf that takes the place of this one, which is there no longer; one that is there.
    fn heir_of(&mut self, leaf: LeafId) -> Option<LeafId>;
}

/// No leaf takes another's place.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHeirs;

impl Heirs for NoHeirs {
    fn take(&mut self, _: LeafId) {}

    fn add(&mut self, _: LeafId) {}

    fn heir_of(&mut self, _: LeafId) -> Option<LeafId> {
        None
    }
}

/// What stands for "no collapse" in [`Forest`]'s lists.
const NONE: u32 = u32::MAX;

/// Nodes, and the collapses between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forest {
    /// The original leaves first, in their order; then results, collapse by collapse.
    nodes: Vec<Node>,
    /// For each node the collapse that makes it, and the one that takes it.
    maker: Vec<u32>,
    taker: Vec<u32>,
    /// The sources of all collapses, and where those of each end.
    sources: Vec<NodeIndex>,
    source_ends: Vec<u32>,
    /// Where the results of each collapse end among the nodes.
    result_ends: Vec<u32>,
    /// How many collapses the first steps have, for each number of steps from 0.
    collapses_after: Vec<u32>,
    leaf_count: u32,
}

impl Forest {
    /// The forest of an order that passed its [check](RemovalOrder::check).
    pub fn new(order: &RemovalOrder, heirs: &mut dyn Heirs) -> Self {
        let original = |index| Node {
            leaf: Some(LeafId::from_index(index)),
            area_scale: 1.0,
        };
        let leaf_count = order.leaf_count() as usize;
        let mut builder = Builder {
            forest: Self {
                nodes: (0..leaf_count).map(original).collect(),
                maker: vec![NONE; leaf_count],
                taker: vec![NONE; leaf_count],
                collapses_after: vec![0],
                leaf_count: order.leaf_count(),
                ..Self::default()
            },
            node_of: (0..leaf_count).map(NodeIndex::from_index).collect(),
            own_scales: vec![1.0; leaf_count],
            donors: Vec::new(),
            heirs,
        };
        for step in order.steps() {
            builder.step(&step);
        }
        builder.forest
    }

    /// All nodes: the original leaves, then the results of the collapses.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// How many of the nodes are original leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count as usize
    }

    /// How many collapses there are.
    pub fn collapse_count(&self) -> usize {
        self.source_ends.len()
    }

    /// How many collapses the first `steps` steps of the order are.
    ///
    /// # Panics
    /// If there are fewer steps.
    pub fn collapses_after(&self, steps: usize) -> usize {
        self.collapses_after[steps] as usize
    }

    /// The nodes that a collapse takes, at least one.
    ///
    /// # Panics
    /// If there is no such collapse.
    pub fn sources(&self, collapse: CollapseIndex) -> &[NodeIndex] {
        let index = collapse.index();
        let start = index.checked_sub(1).map_or(0, |k| self.source_ends[k]);
        &self.sources[start as usize..self.source_ends[index] as usize]
    }

    /// The nodes that a collapse puts in their place, at least one.
    ///
    /// # Panics
    /// If there is no such collapse.
    pub fn results(
        &self,
        collapse: CollapseIndex,
    ) -> impl ExactSizeIterator<Item = NodeIndex> + use<> {
        self.result_range(collapse).map(NodeIndex)
    }

    fn result_range(&self, collapse: CollapseIndex) -> Range<u32> {
        let index = collapse.index();
        let before = index.checked_sub(1).map(|k| self.result_ends[k]);
        before.unwrap_or(self.leaf_count)..self.result_ends[index]
    }

    /// The collapse whose result a node is; none of an original leaf.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    pub fn maker(&self, node: NodeIndex) -> Option<CollapseIndex> {
        Some(self.maker[node.index()])
            .filter(|maker| *maker != NONE)
            .map(CollapseIndex)
    }

    /// The collapse whose source a node is; none of a root.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    pub fn taker(&self, node: NodeIndex) -> Option<CollapseIndex> {
        Some(self.taker[node.index()])
            .filter(|taker| *taker != NONE)
            .map(CollapseIndex)
    }
}

struct Builder<'a> {
    forest: Forest,
    /// By names: the node that a leaf is now, and its own scale.
    node_of: Vec<NodeIndex>,
    own_scales: Vec<f64>,
    /// By names after those of original leaves: what a leaf was made of.
    donors: Vec<LeafId>,
    heirs: &'a mut dyn Heirs,
}

impl Builder<'_> {
    /// The original leaf that one is, or was made of.
    fn donor(&self, leaf: LeafId) -> LeafId {
        let made = leaf.index().checked_sub(self.forest.leaf_count as usize);
        made.map_or(leaf, |made| self.donors[made])
    }

    fn step(&mut self, step: &Step<'_>) {
        let first = self.node_of.len();
        let made: Vec<LeafId> = (first..first + step.made.len())
            .map(LeafId::from_index)
            .collect();
        // Their nodes come with the collapse that makes them.
        self.node_of.resize(first + made.len(), NodeIndex(NONE));
        self.own_scales.resize(first + made.len(), 1.0);
        self.donors.extend(step.made.iter().map(|m| m.donor));
        step.removed.iter().for_each(|leaf| self.heirs.take(*leaf));
        made.iter().for_each(|leaf| self.heirs.add(*leaf));
        let common = step.survivors_area_scale;
        for growth in step.grown {
            self.own_scales[growth.leaf.index()] = growth.area_scale;
        }
        // A leaf may be named more than once; its last size counts.
        let mut grown: Vec<LeafId> = step.grown.iter().map(|growth| growth.leaf).collect();
        grown.sort_unstable();
        grown.dedup();
        if step.removed.is_empty() {
            for leaf in grown {
                self.collapse(&[leaf], &[leaf], common);
            }
        } else if let Some(pairs) = replaced_one_by_one(step, &made, |leaf| self.donor(leaf)) {
            for &(removed, made) in &pairs {
                self.collapse(&[removed], &[made], common);
            }
            let is_replaced = |leaf: &LeafId| pairs.binary_search_by_key(leaf, |p| p.0).is_ok();
            for &leaf in step.removed.iter().filter(|leaf| !is_replaced(leaf)) {
                self.vanish(leaf, common);
            }
        } else if grown.is_empty() && made.is_empty() {
            for &leaf in step.removed {
                self.vanish(leaf, common);
            }
        } else {
            let sources = [step.removed, &grown].concat();
            let results = [grown, made].concat();
            self.collapse(&sources, &results, common);
        }
        let collapses = self.forest.collapse_count() as u32;
        self.forest.collapses_after.push(collapses);
    }

    fn vanish(&mut self, leaf: LeafId, common: f64) {
        match self.heirs.heir_of(leaf) {
            Some(heir) => self.collapse(&[leaf, heir], &[heir], common),
            None => self.collapse(&[leaf], &[], common),
        }
    }

    fn collapse(&mut self, sources: &[LeafId], results: &[LeafId], common: f64) {
        let number = self.forest.source_ends.len() as u32;
        for leaf in sources {
            let node = self.node_of[leaf.index()];
            self.forest.taker[node.index()] = number;
            self.forest.sources.push(node);
        }
        for &leaf in results {
            let own = self.own_scales[leaf.index()];
            let is_original = leaf.get() <= self.forest.leaf_count;
            self.node_of[leaf.index()] = self.push(Node {
                leaf: Some(leaf),
                area_scale: if is_original { own * common } else { own },
            });
        }
        if results.is_empty() {
            self.push(Node {
                leaf: None,
                area_scale: 1.0,
            });
        }
        let nodes = self.forest.nodes.len();
        self.forest.maker.resize(nodes, number);
        self.forest.taker.resize(nodes, NONE);
        self.forest.result_ends.push(nodes as u32);
        let sources = self.forest.sources.len() as u32;
        self.forest.source_ends.push(sources);
    }

    fn push(&mut self, node: Node) -> NodeIndex {
        self.forest.nodes.push(node);
        NodeIndex::from_index(self.forest.nodes.len() - 1)
    }
}

/// The leaves that a step takes and makes, where it makes several, each in place of one of its donor; in the order of
/// those that it takes. `donor`: the original leaf that one is, or was made of.
fn replaced_one_by_one(
    step: &Step<'_>,
    made: &[LeafId],
    donor: impl Fn(LeafId) -> LeafId,
) -> Option<Vec<(LeafId, LeafId)>> {
    if made.len() < 2 || !step.grown.is_empty() {
        return None;
    }
    let mut removed: Vec<(LeafId, LeafId)> = step
        .removed
        .iter()
        .map(|&leaf| (donor(leaf), leaf))
        .collect();
    removed.sort_unstable();
    let are_different = |of: &[(LeafId, LeafId)]| of.is_sorted_by(|a, b| a.0 < b.0);
    if !are_different(&removed) {
        return None;
    }
    let pair = |(new, made): (&NewLeaf, &LeafId)| {
        let found = removed.binary_search_by_key(&new.donor, |of| of.0).ok()?;
        Some((removed[found].1, *made))
    };
    let mut pairs: Vec<(LeafId, LeafId)> = step
        .made
        .iter()
        .zip(made)
        .map(pair)
        .collect::<Option<_>>()?;
    pairs.sort_unstable();
    are_different(&pairs).then_some(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CornerRef, Growth, NewCorner, NewLeaf, Place};

    fn leaf(number: u32) -> LeafId {
        LeafId::new(number).unwrap()
    }

    fn made(donor: u32) -> NewLeaf {
        let at = CornerRef {
            leaf: leaf(donor),
            corner: 0,
        };
        let corner = NewCorner {
            place: Place::Of(at),
            like: 0,
        };
        NewLeaf {
            donor: leaf(donor),
            triangles: vec![[corner; 3]],
        }
    }

    fn step<'a>(removed: &'a [LeafId], grown: &'a [Growth], made: &'a [NewLeaf]) -> Step<'a> {
        Step {
            removed,
            grown,
            made,
            survivors_area_scale: 1.0,
        }
    }

    /// Sources and results of all collapses, by their places.
    fn collapses(forest: &Forest) -> Vec<(Vec<usize>, Vec<usize>)> {
        let all = (0..forest.collapse_count()).map(CollapseIndex::from_index);
        all.map(|collapse| {
            let sources = forest.sources(collapse).iter().map(|node| node.index());
            let results = forest.results(collapse).map(NodeIndex::index);
            (sources.collect(), results.collect())
        })
        .collect()
    }

    #[test]
    fn a_pruned_leaf_and_its_neighbour_become_the_neighbour_grown() {
        let mut order = RemovalOrder::new(3);
        let grown = |n, area_scale| Growth {
            leaf: leaf(n),
            area_scale,
        };
        order.push(leaf(1), &[grown(2, 1.5)]);
        order.push(leaf(2), &[grown(3, 2.5)]);
        let forest = Forest::new(&order, &mut NoHeirs);
        assert_eq!(
            collapses(&forest),
            [(vec![0, 1], vec![3]), (vec![3, 2], vec![4])]
        );
        let node = |n: usize| forest.nodes()[n];
        assert_eq!((node(3).leaf, node(3).area_scale), (Some(leaf(2)), 1.5));
        assert_eq!((node(4).leaf, node(4).area_scale), (Some(leaf(3)), 2.5));
        let of = |n| (forest.maker(n), forest.taker(n));
        let [first, second] = [0, 1].map(CollapseIndex::from_index);
        let nodes = [0, 3, 4].map(NodeIndex::from_index);
        assert_eq!(of(nodes[0]), (None, Some(first)));
        assert_eq!(of(nodes[1]), (Some(first), Some(second)));
        assert_eq!(of(nodes[2]), (Some(second), None));
        assert_eq!([0, 1, 2].map(|k| forest.collapses_after(k)), [0, 1, 2]);
    }

    #[test]
    fn what_goes_without_a_trace_has_an_heir_or_leaves_an_empty_place() {
        struct Next(Vec<LeafId>);
        impl Heirs for Next {
            fn take(&mut self, leaf: LeafId) {
                self.0.retain(|other| *other != leaf);
            }
            fn add(&mut self, leaf: LeafId) {
                self.0.push(leaf);
            }
            fn heir_of(&mut self, _: LeafId) -> Option<LeafId> {
                self.0.first().copied()
            }
        }
        let mut order = RemovalOrder::new(2);
        order.push(leaf(2), &[]);
        order.push(leaf(1), &[]);
        let forest = Forest::new(&order, &mut Next(vec![leaf(1), leaf(2)]));
        assert_eq!(
            collapses(&forest),
            [(vec![1, 0], vec![2]), (vec![2], vec![3])]
        );
        assert_eq!(forest.nodes()[2].leaf, Some(leaf(1)));
        assert_eq!(forest.nodes()[3].leaf, None);
    }

    #[test]
    fn leaves_that_are_made_one_for_one_are_collapses_of_their_own() {
        let mut order = RemovalOrder::new(4);
        let all = [1, 2, 3].map(leaf);
        order.push_step(step(&all, &[], &[made(3), made(1)]));
        order.push_step(step(&[leaf(5), leaf(6)], &[], &[made(4)]));
        let grown = Growth {
            leaf: leaf(7),
            area_scale: 3.0,
        };
        order.push_step(step(&[], &[grown], &[]));
        let forest = Forest::new(&order, &mut NoHeirs);
        // Leaf 6 looks like leaf 1, leaf 5 like leaf 3; leaf 2 has gone.
        assert_eq!(
            collapses(&forest),
            [
                (vec![0], vec![4]),
                (vec![2], vec![5]),
                (vec![1], vec![6]),
                (vec![5, 4], vec![7]),
                (vec![7], vec![8])
            ]
        );
        assert_eq!(forest.nodes()[8].area_scale, 3.0);
        assert_eq!(
            [0, 1, 2, 3].map(|k| forest.collapses_after(k)),
            [0, 3, 4, 5]
        );
    }
}
