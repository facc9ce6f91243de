//! A plant while its sticks are replaced, one after another.

use glam::DVec3;

use super::clusters::{Card, ClusterSize, Disc, Gathered};
use crate::{Segment, SegmentIndex};

const NONE: u32 = u32::MAX;

/// What a cluster is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ClusterPart {
    /// A single leaf, from 0.
    Leaf(u32),
    /// The cluster on top of this stick.
    ClusterOf(u32),
}

/// Sticks and leaves, and what has become of them.
pub(super) struct Merging<'a> {
    sticks: &'a [Segment],
    discs: Vec<Disc>,
    size: ClusterSize,
    /// The y of the plant's highest end.
    height_m: f64,
    /// The latest child of a stick, and for each the one before it.
    last_child: Vec<u32>,
    sibling_before: Vec<u32>,
    is_kept: Vec<bool>,
    kept_children: Vec<u32>,
    /// How many kept children continue a stick.
    continued_by: Vec<u32>,
    tops: Vec<Top>,
    /// The single leaves of each stick.
    own: Vec<Vec<u32>>,
    /// The original leaves of the cluster on top of each stick: none, no cluster; one
    /// stays where it stands.
    clusters: Vec<Vec<u32>>,
}

/// The upper end of a stick and what it may grow to.
#[derive(Clone, Copy)]
struct Top {
    end: DVec3,
    end_radius_m: f64,
    /// How far from the stick's start the ends are that it stands for.
    reach_m: f64,
    /// The highest of them.
    highest: DVec3,
    least_radius_m: f64,
}

impl<'a> Merging<'a> {
    /// Nothing replaced yet. `leaf_sticks` has for each leaf its stick, if any.
    pub(super) fn new(
        sticks: &'a [Segment],
        discs: Vec<Disc>,
        size: ClusterSize,
        leaf_sticks: impl Iterator<Item = Option<SegmentIndex>>,
    ) -> Self {
        let count = sticks.len();
        let mut merging = Self {
            sticks,
            discs,
            size,
            height_m: sticks
                .iter()
                .map(|stick| stick.end.y)
                .fold(f64::NEG_INFINITY, f64::max),
            last_child: vec![NONE; count],
            sibling_before: vec![NONE; count],
            is_kept: vec![true; count],
            kept_children: vec![0; count],
            continued_by: vec![0; count],
            tops: sticks.iter().map(Top::of).collect(),
            own: vec![Vec::new(); count],
            clusters: vec![Vec::new(); count],
        };
        for (index, stick) in sticks.iter().enumerate() {
            if let Some(parent) = stick.parent.map(SegmentIndex::index) {
                merging.sibling_before[index] = merging.last_child[parent];
                merging.last_child[parent] = index as u32;
                merging.kept_children[parent] += 1;
                merging.continued_by[parent] += u32::from(stick.continues_parent);
            }
        }
        for (leaf, stick) in leaf_sticks.enumerate() {
            if let Some(stick) = stick {
                merging.own[stick.index()].push(leaf as u32);
            }
        }
        merging
    }

    fn parent_of(&self, stick: u32) -> usize {
        let parent = self.sticks[stick as usize].parent;
        parent.expect("roots are not replaced").index()
    }

    /// What becomes one cluster on the parent when this stick is replaced.
    pub(super) fn parts(&self, stick: u32) -> Vec<ClusterPart> {
        let parent = self.parent_of(stick);
        let cluster = |of: usize| {
            let is_there = !self.clusters[of].is_empty();
            is_there.then_some(ClusterPart::ClusterOf(of as u32))
        };
        let own = |of: usize| self.own[of].iter().copied().map(ClusterPart::Leaf);
        let mut parts: Vec<ClusterPart> = cluster(parent).into_iter().collect();
        parts.extend(cluster(stick as usize));
        parts.extend(own(stick as usize));
        if self.kept_children[parent] == 1 {
            parts.extend(own(parent));
        }
        parts
    }

    /// Replaces a stick by its parent, and returns the parent. `part_seen` is shown
    /// the cluster after each of its [`parts`](Self::parts), seen from its final
    /// centre.
    ///
    /// # Panics
    /// If it is a root, gone, or something still grows on it.
    pub(super) fn replace(&mut self, stick: u32, part_seen: &mut dyn FnMut(Card)) -> u32 {
        let s = stick as usize;
        assert!(
            self.is_kept[s] && self.kept_children[s] == 0,
            "sticks are replaced from the tips"
        );
        let parent = self.parent_of(stick);
        let parts = self.parts(stick);
        self.is_kept[s] = false;
        self.kept_children[parent] -= 1;
        self.continued_by[parent] -= u32::from(self.sticks[s].continues_parent);
        self.stand_for(parent, stick);
        if self.continued_by[parent] == 0 {
            let turns_to_m = (self.kept_children[parent] == 0).then_some(self.height_m);
            self.tops[parent].extend(&self.sticks[parent], turns_to_m);
        }

        let mut gathered = Gathered::at(self.tops[parent].end);
        let mut leaves = std::mem::take(&mut self.clusters[parent]);
        for part in parts {
            match part {
                ClusterPart::Leaf(leaf) => {
                    gathered.add(&[leaf], &self.discs);
                    leaves.push(leaf);
                }
                ClusterPart::ClusterOf(of) if of as usize == parent => {
                    gathered.add(&leaves, &self.discs);
                }
                ClusterPart::ClusterOf(of) => {
                    let more = std::mem::take(&mut self.clusters[of as usize]);
                    gathered.add(&more, &self.discs);
                    leaves.extend(more);
                }
            }
            part_seen(gathered.card(self.size));
        }
        self.own[s] = Vec::new();
        if self.kept_children[parent] == 0 {
            self.own[parent] = Vec::new();
        }
        self.clusters[parent] = leaves;
        parent as u32
    }

    /// Notes the ends of a subtree that a stick now stands for.
    fn stand_for(&mut self, parent: usize, subtree: u32) {
        let from = self.sticks[parent].start;
        let mut top = self.tops[parent];
        let mut stack = vec![subtree];
        while let Some(index) = stack.pop() {
            let stick = &self.sticks[index as usize];
            top.reach_m = top.reach_m.max((stick.end - from).length());
            if stick.end.y > top.highest.y {
                top.highest = stick.end;
            }
            top.least_radius_m = top.least_radius_m.min(stick.end_radius_m);
            let mut child = self.last_child[index as usize];
            while child != NONE {
                stack.push(child);
                child = self.sibling_before[child as usize];
            }
        }
        self.tops[parent] = top;
    }

    /// The cluster on top of a stick, if there is one of more than one leaf.
    pub(super) fn card(&self, stick: u32) -> Option<Card> {
        let leaves = &self.clusters[stick as usize];
        if leaves.len() < 2 {
            return None;
        }
        let mut gathered = Gathered::at(self.tops[stick as usize].end);
        gathered.add(leaves, &self.discs);
        Some(gathered.card(self.size))
    }

    pub(super) fn is_kept(&self, stick: usize) -> bool {
        self.is_kept[stick]
    }

    /// The leaves of a stick that stand as they did: its own, and one of what it
    /// replaced if that is all.
    pub(super) fn single(&self, stick: usize) -> impl Iterator<Item = u32> + '_ {
        let lone = Some(&self.clusters[stick]).filter(|leaves| leaves.len() == 1);
        let lone = lone.into_iter().flatten();
        self.own[stick].iter().chain(lone).copied()
    }

    /// A stick as it is now, its parent as it was.
    pub(super) fn stick(&self, index: usize) -> Segment {
        let top = &self.tops[index];
        Segment {
            end: top.end,
            end_radius_m: top.end_radius_m,
            ..self.sticks[index]
        }
    }
}

impl Top {
    fn of(stick: &Segment) -> Self {
        Self {
            end: stick.end,
            end_radius_m: stick.end_radius_m,
            reach_m: stick.length_m(),
            highest: stick.end,
            least_radius_m: stick.end_radius_m,
        }
    }

    /// Extends the stick to what it stands for. `turns_to_m` is the plant's height
    /// where nothing grows on the stick any more, so that it may turn.
    fn extend(&mut self, stick: &Segment, turns_to_m: Option<f64>) {
        let length_m = stick.length_m();
        let along = (stick.end - stick.start) / length_m;
        if !along.is_finite() {
            return;
        }
        let up_to_height_m = (self.highest.y - stick.start.y) / along.y;
        let extended_m = match along.y > 0.0 {
            true => self.reach_m.min(up_to_height_m),
            false => self.reach_m,
        };
        if extended_m > length_m {
            self.end = stick.start + along * extended_m;
        }
        let is_too_low = self.end.y < self.highest.y - 1e-6 * self.reach_m;
        if is_too_low && turns_to_m == Some(self.highest.y) {
            self.end = self.highest;
        }
        self.end_radius_m = self.least_radius_m;
    }
}
