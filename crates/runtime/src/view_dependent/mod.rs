//! A crown in several levels at once: full detail where a view wants it, coarse elsewhere.
//!
//! Remolar, Chover, Ribelles, Belmonte: View-Dependent Multiresolution Model for Foliage (WSCG
//! 2003). There the forest of collapses is that of their simplification by leaf collapse; here it is
//! that of any removal order ([`Forest`]), of viewpoint-driven ones too. The leaves that are drawn
//! are a doubly linked list of active nodes. A refinement goes through it (their Fig. 5): a node
//! outside the zone of interest is collapsed with its sisters, which are collapsed themselves as far
//! as they must be (ForceCollapse); a node within it is split down to where what it stands for
//! reaches the zone (CheckSplit, Fig. 6, and ForceSplit).
//!
//! Where they leave it open: new nodes come where the traversal stands and are looked at in the same
//! pass, so that one pass is a whole refinement, and another one with the same criterion changes
//! nothing; a criterion that answers differently each time ends it after at most
//! [`MOST_CHANGES_A_COLLAPSE`] changes for each collapse of the forest. A step of several results
//! (several neighbours that grow) is split only when all of them are active, which forces splits
//! above them.

mod criterion;
mod heirs;
mod region;

pub use criterion::{
    Both, Criterion, InFrontOf, InFrustum, InSphere, LargerThan, OnSilhouette, OutsideSphere,
};
pub use region::Region;

use heirs::Nearest;
use secateur_model::{CollapseIndex, Foliage, Forest, LeafId, Lod, LodModel, NodeIndex};

/// A criterion that does not change its mind makes and splits each collapse at most once.
pub const MOST_CHANGES_A_COLLAPSE: usize = 2;

/// What a refinement did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refined {
    /// Collapses that were made.
    pub collapses: usize,
    /// Collapses that were split.
    pub splits: usize,
    /// Whether it was broken off, since the criterion does not settle.
    pub is_broken_off: bool,
}

/// The neighbours of a node in the list of active nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Links {
    before: u32,
    after: u32,
}

/// A cut through a forest of collapses: the nodes that are drawn.
#[derive(Clone, Debug)]
pub struct ViewDependent {
    forest: Forest,
    regions: Vec<Region>,
    /// By nodes; one more, which is before the first and after the last active node.
    links: Vec<Links>,
    is_active: Vec<bool>,
    /// By collapses: whether it is made.
    is_made: Vec<bool>,
    active_count: usize,
    leaf_count: usize,
    /// The node that a refinement is at: it stays in the list until it goes on from there, and new
    /// nodes come behind it.
    at: Option<NodeIndex>,
}

impl ViewDependent {
    /// The original, of which any part can be made coarser along the steps of a model.
    ///
    /// A leaf that goes without another growing for it takes the nearest that is left as its heir.
    ///
    /// # Panics
    /// If the model is one of another foliage.
    pub fn new(model: &LodModel, foliage: &Foliage) -> Self {
        let order = model.order();
        let forest = Forest::new(order, &mut Nearest::new(order, foliage));
        let regions = regions(&forest, model, foliage);
        let (nodes, leaves) = (forest.nodes().len() as u32, forest.leaf_count());
        let unlinked = Links {
            before: nodes,
            after: nodes,
        };
        let mut cut = Self {
            is_active: vec![false; nodes as usize],
            is_made: vec![false; forest.collapse_count()],
            links: vec![unlinked; nodes as usize + 1],
            active_count: 0,
            leaf_count: 0,
            at: None,
            regions,
            forest,
        };
        for index in 0..leaves {
            let last = cut.links[nodes as usize].before;
            cut.activate(NodeIndex::from_index(index), last);
        }
        cut
    }

    /// The nodes and the collapses between them.
    pub fn forest(&self) -> &Forest {
        &self.forest
    }

    /// Where a node is.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn region(&self, node: NodeIndex) -> &Region {
        &self.regions[node.index()]
    }

    /// Where all nodes are; the original leaves are the first [`Forest::leaf_count`] of them.
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// Whether a node is one of the cut.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn is_active(&self, node: NodeIndex) -> bool {
        self.is_active[node.index()]
    }

    /// The nodes of the cut.
    pub fn active(&self) -> impl Iterator<Item = NodeIndex> + '_ {
        let end = self.end();
        let first = self.links[end as usize].after;
        let next = move |node: &u32| {
            let after = self.links[*node as usize].after;
            (after != end).then_some(after)
        };
        let nodes = std::iter::successors(Some(first).filter(|n| *n != end), next);
        nodes.map(|node| NodeIndex::from_index(node as usize))
    }

    /// How many nodes the cut has; some may be empty places.
    pub fn active_count(&self) -> usize {
        self.active_count
    }

    /// How many leaves are drawn.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    /// The leaves that are drawn with their area scales, in no particular order.
    pub fn leaves(&self) -> impl Iterator<Item = (LeafId, f64)> + '_ {
        self.active().filter_map(|node| {
            let node = self.forest.nodes()[node.index()];
            Some((node.leaf?, node.area_scale))
        })
    }

    /// The cut as a level. Takes time in proportion to the forest.
    ///
    /// # Panics
    /// If the model is another.
    pub fn lod(&self, model: &LodModel) -> Lod {
        Lod::of_leaves(model.order(), self.leaves())
    }

    /// Puts the results of a collapse in the place of its sources. Whether it could: all of these
    /// must be active.
    ///
    /// # Panics
    /// If there is no such collapse.
    pub fn collapse(&mut self, collapse: CollapseIndex) -> bool {
        let sources = self.forest.sources(collapse);
        if !sources.iter().all(|source| self.is_active(*source)) {
            return false;
        }
        let mut last = self.place_behind(sources[0]);
        for result in self.forest.results(collapse) {
            self.activate(result, last);
            last = result.index() as u32;
        }
        for k in 0..self.forest.sources(collapse).len() {
            self.deactivate(self.forest.sources(collapse)[k]);
        }
        self.is_made[collapse.index()] = true;
        true
    }

    /// Puts the sources of a collapse in the place of its results. Whether it could: all of these
    /// must be active.
    ///
    /// # Panics
    /// If there is no such collapse.
    pub fn split(&mut self, collapse: CollapseIndex) -> bool {
        let mut results = self.forest.results(collapse);
        let first = results.next().expect("a collapse has a result");
        if !self.is_active(first) || !results.all(|result| self.is_active(result)) {
            return false;
        }
        let mut last = self.place_behind(first);
        for k in 0..self.forest.sources(collapse).len() {
            let source = self.forest.sources(collapse)[k];
            self.activate(source, last);
            last = source.index() as u32;
        }
        for result in self.forest.results(collapse) {
            self.deactivate(result);
        }
        self.is_made[collapse.index()] = false;
        true
    }

    /// Goes to the cut of the first `collapses` collapses: a uniform level, that of
    /// [`Forest::collapses_after`] some steps. Takes time in proportion to the forest.
    pub fn go_to_first(&mut self, collapses: usize) {
        let count = self.forest.collapse_count();
        for index in (collapses.min(count)..count).rev() {
            if self.is_made[index] {
                self.split(CollapseIndex::from_index(index));
            }
        }
        for index in 0..collapses.min(count) {
            if !self.is_made[index] {
                self.collapse(CollapseIndex::from_index(index));
            }
        }
    }

    /// Collapses what a criterion wants no detail of, and splits what it wants detail of. Another
    /// refinement by the same criterion changes nothing.
    ///
    /// Takes time in proportion to the active nodes before and after, where the criterion is
    /// [nested](Criterion::is_nested).
    pub fn refine<C: Criterion>(&mut self, criterion: &mut C) -> Refined {
        let most = MOST_CHANGES_A_COLLAPSE * self.forest.collapse_count();
        let mut refined = Refined::default();
        let mut node = self.links[self.end() as usize].after;
        while node != self.end() {
            let index = NodeIndex::from_index(node as usize);
            self.at = Some(index);
            self.look_at(index, criterion, &mut refined);
            self.at = None;
            let after = self.links[node as usize].after;
            if !self.is_active(index) {
                self.unlink(node);
            }
            if refined.collapses + refined.splits > most {
                refined.is_broken_off = true;
                break;
            }
            node = after;
        }
        refined
    }

    fn look_at<C: Criterion>(&mut self, node: NodeIndex, criterion: &mut C, refined: &mut Refined) {
        if criterion.wants_detail(&self.regions[node.index()]) {
            if let Some(collapse) = self.check_split(node, criterion) {
                self.force_split(collapse, refined);
            }
            return;
        }
        let Some(collapse) = self.forest.taker(node) else {
            return;
        };
        let sources = self.forest.sources(collapse);
        let mut sisters = sources.iter().filter(|source| **source != node);
        if !sisters.any(|sister| criterion.wants_detail(&self.regions[sister.index()])) {
            self.force_collapse(collapse, criterion, refined);
        }
    }

    /// The collapse below a node, the nearest found, one of whose sources is in the zone.
    fn check_split<C: Criterion>(
        &self,
        node: NodeIndex,
        criterion: &mut C,
    ) -> Option<CollapseIndex> {
        let is_nested = criterion.is_nested();
        let mut below = vec![self.forest.maker(node)?];
        while let Some(collapse) = below.pop() {
            let sources = self.forest.sources(collapse);
            let mut regions = sources.iter().map(|source| &self.regions[source.index()]);
            if regions.any(|region| criterion.wants_detail(region)) {
                return Some(collapse);
            }
            if !is_nested {
                let makers = sources.iter().rev();
                below.extend(makers.filter_map(|source| self.forest.maker(*source)));
            }
        }
        None
    }

    /// Splits a collapse, and before it all that stand on its results.
    fn force_split(&mut self, collapse: CollapseIndex, refined: &mut Refined) {
        let mut pending = vec![collapse];
        while let Some(&collapse) = pending.last() {
            let taken = |result: &NodeIndex| !self.is_active(*result);
            match self.forest.results(collapse).find(taken) {
                Some(result) => pending.extend(self.forest.taker(result)),
                None => {
                    self.split(collapse);
                    refined.splits += 1;
                    pending.pop();
                }
            }
        }
    }

    /// Makes a collapse, and before it all that make its sources; as far as none of what goes is in
    /// the zone.
    fn force_collapse<C: Criterion>(
        &mut self,
        collapse: CollapseIndex,
        criterion: &mut C,
        refined: &mut Refined,
    ) {
        let mut pending = vec![collapse];
        while let Some(&collapse) = pending.last() {
            let sources = self.forest.sources(collapse);
            match sources.iter().find(|source| !self.is_active(**source)) {
                Some(source) => pending.extend(self.forest.maker(*source)),
                None => {
                    let mut regions = sources.iter().map(|s| &self.regions[s.index()]);
                    // The node that is looked at is known to be outside.
                    if pending.len() > 1 && regions.any(|r| criterion.wants_detail(r)) {
                        return;
                    }
                    self.collapse(collapse);
                    refined.collapses += 1;
                    pending.pop();
                }
            }
        }
    }

    /// The link that is no node.
    fn end(&self) -> u32 {
        self.regions.len() as u32
    }

    /// Behind which node new ones come that take this one's place.
    fn place_behind(&self, node: NodeIndex) -> u32 {
        self.at.unwrap_or(node).index() as u32
    }

    fn activate(&mut self, node: NodeIndex, behind: u32) {
        let index = node.index();
        debug_assert!(!self.is_active[index], "a node is active once");
        self.is_active[index] = true;
        self.active_count += 1;
        self.leaf_count += usize::from(self.forest.nodes()[index].leaf.is_some());
        // The node is still in the list.
        if self.at == Some(node) {
            return;
        }
        let after = self.links[behind as usize].after;
        self.links[index] = Links {
            before: behind,
            after,
        };
        self.links[behind as usize].after = index as u32;
        self.links[after as usize].before = index as u32;
    }

    fn deactivate(&mut self, node: NodeIndex) {
        let index = node.index();
        self.is_active[index] = false;
        self.active_count -= 1;
        self.leaf_count -= usize::from(self.forest.nodes()[index].leaf.is_some());
        if self.at != Some(node) {
            self.unlink(index as u32);
        }
    }

    fn unlink(&mut self, node: u32) {
        let Links { before, after } = self.links[node as usize];
        self.links[before as usize].after = after;
        self.links[after as usize].before = before;
    }
}

fn regions(forest: &Forest, model: &LodModel, foliage: &Foliage) -> Vec<Region> {
    region::regions(forest, model, foliage)
}

#[cfg(test)]
mod tests;
