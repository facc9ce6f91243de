//! The leaves that are left, and which two of them cost least.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, VecDeque};

use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use secateur_model::{Foliage, LeafId, NewLeaf};

use super::leaf::{ActiveLeaf, Shape};
use super::{Corners, Cost, SLACK};

/// A pair as the heap sorts it: cost bits (costs are not negative, so they sort
/// as numbers do), lower and higher leaf index. The last is the group whose
/// entry it is.
type Entry = (u64, u32, u32, u32);

/// Two leaves that cost least.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    a: u32,
    b: u32,
    owner: u32,
}

impl Pair {
    pub(super) fn leaves(self) -> [LeafId; 2] {
        [self.a, self.b].map(|index| LeafId::from_index(index as usize))
    }
}

/// Leaves of one shape at one place. They cost the same with any other leaf, so
/// one search does for all of them: a thousand leaves at one place are one
/// group, not a thousand that each look through a thousand.
#[derive(Default)]
struct Group {
    /// Ascending. Of pairs of equal cost the lowest numbers go first, so members
    /// leave from the front; new leaves have the highest numbers.
    members: VecDeque<u32>,
    /// The cheapest pair when the group last looked. None if it is alone.
    entry: Option<Entry>,
}

type Site = GeomWithData<[f64; 3], u32>;

/// The leaves that are left, in groups, and for each group its cheapest pair
/// when it last looked. Partners only go, and a new leaf looks for itself: so no
/// entry is dearer than what its group would find now, or else the entry of a
/// newer leaf's group is for that pair.
pub(super) struct Pairs {
    cost: Cost,
    corners: Corners,
    leaves: Vec<Option<ActiveLeaf>>,
    group_of: Vec<u32>,
    groups: Vec<Group>,
    by_shape: HashMap<Shape, u32>,
    /// Groups that have members, by the middle of their boxes.
    index: RTree<Site>,
    heap: BinaryHeap<Reverse<Entry>>,
}

impl Pairs {
    pub(super) fn new(foliage: &Foliage, cost: Cost, corners: Corners) -> Self {
        let count = foliage.leaves().len();
        let leaves: Vec<Option<ActiveLeaf>> = (0..count)
            .into_par_iter()
            .map(|k| {
                let leaf = LeafId::from_index(k);
                Some(ActiveLeaf::original(foliage, leaf, cost.hausdorff))
            })
            .collect();
        let shapes: Vec<Shape> = leaves.par_iter().flatten().map(ActiveLeaf::shape).collect();
        let mut pairs = Self {
            cost,
            corners,
            leaves,
            group_of: Vec::with_capacity(count),
            groups: Vec::new(),
            by_shape: HashMap::with_capacity(count),
            index: RTree::new(),
            heap: BinaryHeap::new(),
        };
        for (leaf, shape) in (0..).zip(shapes) {
            let group = pairs.group_for(shape);
            pairs.groups[group as usize].members.push_back(leaf);
            pairs.group_of.push(group);
        }
        let groups = 0..pairs.groups.len() as u32;
        let sites = groups.clone().filter_map(|group| pairs.site(group));
        pairs.index = RTree::bulk_load(sites.collect());
        let entries: Vec<Option<Entry>> = groups
            .into_par_iter()
            .map(|group| pairs.best_of(group))
            .collect();
        for (group, entry) in pairs.groups.iter_mut().zip(&entries) {
            group.entry = *entry;
        }
        pairs.heap = entries.into_iter().flatten().map(Reverse).collect();
        pairs
    }

    /// A leaf that is left.
    pub(super) fn any(&self) -> Option<LeafId> {
        let first = self.leaves.iter().position(Option::is_some);
        first.map(LeafId::from_index)
    }

    /// The cheapest pair of all. It has to be collapsed before the next is asked
    /// for.
    pub(super) fn cheapest(&mut self) -> Option<Pair> {
        while let Some(Reverse(entry)) = self.heap.pop() {
            let (_, a, b, owner) = entry;
            // What a group has offered since takes the place of this entry.
            if self.groups[owner as usize].entry != Some(entry) {
                continue;
            }
            let is_left = |k: u32| self.leaves[k as usize].is_some();
            if is_left(a) && is_left(b) {
                return Some(Pair { a, b, owner });
            }
            self.look_again(owner);
        }
        None
    }

    /// Puts the new leaf in the place of the two.
    pub(super) fn collapse(&mut self, pair: Pair) -> NewLeaf {
        let [first, second] = [pair.a, pair.b].map(|k| self.take(k));
        let new = ActiveLeaf::collapse(&first, &second, self.corners, self.cost.hausdorff);
        let made = new.new_leaf();
        self.insert(new);
        self.look_again(pair.owner);
        made
    }

    fn take(&mut self, leaf: u32) -> ActiveLeaf {
        let group = self.group_of[leaf as usize];
        let members = &mut self.groups[group as usize].members;
        assert_eq!(members.front(), Some(&leaf), "members leave in turn");
        if members.len() == 1 {
            let site = self.site(group).expect("a group with a member");
            self.index.remove(&site);
        }
        self.groups[group as usize].members.pop_front();
        let taken = self.leaves[leaf as usize].take();
        taken.expect("a leaf that is left")
    }

    fn insert(&mut self, new: ActiveLeaf) {
        let leaf = self.leaves.len() as u32;
        let group = self.group_for(new.shape());
        let cost_within = self.cost.of(&new, &new).to_bits();
        self.leaves.push(Some(new));
        self.group_of.push(group);
        let members = &mut self.groups[group as usize].members;
        members.push_back(leaf);
        match (members.len(), members[0]) {
            (1, _) => {
                let site = self.site(group).expect("a group with a member");
                self.index.insert(site);
                self.look_again(group);
            }
            // The first pair within the group; to all others an older member
            // costs the same and has the lower number.
            (2, first) => self.offer((cost_within, first, leaf, group)),
            _ => {}
        }
    }

    /// The group of a shape, which may be new or without members.
    fn group_for(&mut self, shape: Shape) -> u32 {
        *self.by_shape.entry(shape).or_insert_with(|| {
            self.groups.push(Group::default());
            self.groups.len() as u32 - 1
        })
    }

    fn look_again(&mut self, group: u32) {
        let best = self.best_of(group);
        self.groups[group as usize].entry = best;
        self.heap.extend(best.map(Reverse));
    }

    /// Takes the place of the owner's entry if it is cheaper.
    fn offer(&mut self, entry: Entry) {
        let current = &mut self.groups[entry.3 as usize].entry;
        if current.is_none_or(|current| entry < current) {
            *current = Some(entry);
            self.heap.push(Reverse(entry));
        }
    }

    /// The member that goes first, for all of its group.
    fn first_of(&self, group: u32) -> Option<(u32, &ActiveLeaf)> {
        let first = *self.groups[group as usize].members.front()?;
        Some((first, self.leaves[first as usize].as_ref()?))
    }

    fn site(&self, group: u32) -> Option<Site> {
        let (_, leaf) = self.first_of(group)?;
        Some(Site::new(leaf.middle().to_array(), group))
    }

    /// The first two of the group itself, then neighbours by distance of their
    /// boxes' middles, until none further away can be cheaper: the middles are at
    /// most the square root of 3 times the Hausdorff distance apart, since along
    /// each axis they are at most once.
    fn best_of(&self, owner: u32) -> Option<Entry> {
        let (first, leaf) = self.first_of(owner)?;
        let second = self.groups[owner as usize].members.get(1);
        let mut best: Option<Entry> =
            second.map(|second| (self.cost.of(leaf, leaf).to_bits(), first, *second, owner));
        let neighbours = self
            .index
            .nearest_neighbor_iter_with_distance_2(leaf.middle().to_array());
        for (site, squared) in neighbours {
            let least = SLACK * self.cost.of_distance(squared / 3.0);
            if best.is_some_and(|best| least.to_bits() > best.0) {
                break;
            }
            if site.data == owner {
                continue;
            }
            let Some((other, partner)) = self.first_of(site.data) else {
                continue;
            };
            if best.is_some_and(|best| self.cost.at_least(leaf, partner).to_bits() > best.0) {
                continue;
            }
            let cost = self.cost.of(leaf, partner).to_bits();
            let entry = (cost, first.min(other), first.max(other), owner);
            best = Some(best.map_or(entry, |best| best.min(entry)));
        }
        best
    }
}
