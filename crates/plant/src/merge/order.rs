//! Merging as the order in which a foliage loses its leaves.

use glam::DVec3;
use secateur_model::{
    Foliage, LeafId, NewCorner, NewLeaf, Place, PlantSkeleton, RemovalOrder, Step,
};

use super::clusters::{Card, ClusterSize, Disc};
use super::merging::{ClusterPart, Merging};
use super::sticks::{in_order, replaced_below};
use super::thresholds::StickSize;

/// Merges leaves until `leaves` are left: stick by stick, the largest HR first, two
/// leaves or clusters at a time into one, so that every step is one leaf less.
/// Every prefix is the order to more leaves. Wood is not part of it.
///
/// Where a cluster only moves, with the top of its stick, it does so in the step
/// before. When no stick can be replaced any more, what is left goes in the order
/// of its names, single leaves first.
///
/// Time: leaves and segments times depth.
///
/// # Panics
/// If the skeleton does not pass its check for this foliage.
pub fn merge_order(
    foliage: &Foliage,
    skeleton: &PlantSkeleton,
    size: ClusterSize,
    leaves: usize,
) -> RemovalOrder {
    let sticks = in_order(&replaced_below(
        &skeleton.segments,
        StickSize::HeightOverRadius,
    ));
    let mut builder = Builder::new(foliage, skeleton, size);
    // To the end, whatever the target: where the last step leaves its clusters
    // depends on what moves after it.
    for (_, stick) in sticks {
        builder.replace(stick);
    }
    let mut order = builder.finish();
    order.truncate(foliage.leaves().len().saturating_sub(leaves));
    order
}

struct Builder<'a> {
    foliage: &'a Foliage,
    merging: Merging<'a>,
    discs: Vec<Disc>,
    order: RemovalOrder,
    /// The name of the cluster on each stick.
    names: Vec<Option<LeafId>>,
    /// How many leaves have been made, the last step's included.
    made: usize,
    /// The last step, which may still move clusters.
    last: Option<LastStep>,
    /// Sticks whose cluster is not where its leaf is yet.
    moved: Vec<u32>,
    is_left: Vec<bool>,
}

#[derive(Default)]
struct LastStep {
    removed: Vec<LeafId>,
    made: Vec<NewLeaf>,
}

impl<'a> Builder<'a> {
    fn new(foliage: &'a Foliage, skeleton: &'a PlantSkeleton, size: ClusterSize) -> Self {
        let count = foliage.leaves().len();
        skeleton.check(count).expect("a skeleton of this foliage");
        let discs: Vec<Disc> = (0..count)
            .map(|leaf| disc_of(foliage, skeleton, LeafId::from_index(leaf)))
            .collect();
        let leaf_sticks = skeleton.leaf_segments.iter().copied();
        Self {
            foliage,
            merging: Merging::new(&skeleton.segments, discs.clone(), size, leaf_sticks),
            discs,
            order: RemovalOrder::new(count as u32),
            names: vec![None; skeleton.segments.len()],
            made: 0,
            last: None,
            moved: Vec::new(),
            is_left: vec![true; count],
        }
    }

    fn name_of(&self, part: ClusterPart) -> LeafId {
        match part {
            ClusterPart::Leaf(leaf) => LeafId::from_index(leaf as usize),
            ClusterPart::ClusterOf(stick) => {
                self.names[stick as usize].expect("a cluster has a name")
            }
        }
    }

    fn replace(&mut self, stick: u32) {
        let parts = self.merging.parts(stick);
        if parts.len() > 1 {
            self.flush();
        }
        let names: Vec<LeafId> = parts.iter().map(|&part| self.name_of(part)).collect();
        let mut cards = Vec::with_capacity(parts.len());
        let parent = self.merging.replace(stick, &mut |card| cards.push(card));
        self.names[stick as usize] = None;
        self.names[parent as usize] = None;
        let Some((&first, others)) = names.split_first() else {
            return;
        };
        let mut name = first;
        for (&other, card) in others.iter().zip(&cards[1..]) {
            self.flush();
            self.last = Some(LastStep {
                removed: vec![name, other],
                made: vec![self.leaf_of(card)],
            });
            name = self.next_name();
        }
        self.names[parent as usize] = Some(name);
        if others.is_empty() {
            self.moved.push(parent);
        }
    }

    fn next_name(&mut self) -> LeafId {
        self.made += 1;
        LeafId::from_index(self.foliage.leaves().len() + self.made - 1)
    }

    /// Ends the last step: clusters that have moved are made anew in it.
    fn flush(&mut self) {
        let Some(mut step) = self.last.take() else {
            return;
        };
        let of_this_step = self.foliage.leaves().len() + self.made - step.made.len();
        let mut moved = std::mem::take(&mut self.moved);
        moved.sort_unstable();
        moved.dedup();
        for stick in moved {
            let (Some(name), Some(card)) = (self.names[stick as usize], self.merging.card(stick))
            else {
                continue;
            };
            let leaf = self.leaf_of(&card);
            match name.index().checked_sub(of_this_step) {
                Some(made) => step.made[made] = leaf,
                None => {
                    step.removed.push(name);
                    step.made.push(leaf);
                    self.names[stick as usize] = Some(self.next_name());
                }
            }
        }
        self.push(&step);
    }

    fn push(&mut self, step: &LastStep) {
        for leaf in &step.removed {
            if let Some(is_left) = self.is_left.get_mut(leaf.index()) {
                *is_left = false;
            }
        }
        self.order.push_step(Step {
            removed: &step.removed,
            grown: &[],
            made: &step.made,
            survivors_area_scale: 1.0,
        });
    }

    /// The donor's triangles about the card's centre, its farthest corner at its radius.
    fn leaf_of(&self, card: &Card) -> NewLeaf {
        let donor = LeafId::from_index(card.donor as usize);
        let disc = &self.discs[card.donor as usize];
        let scale = match disc.radius_m > 0.0 {
            true => card.radius_m / disc.radius_m,
            false => 1.0,
        };
        let triangles = self.foliage.triangles_of(donor).iter().enumerate();
        let place = |p: DVec3| Place::At(card.centre + (p - disc.centre) * scale);
        NewLeaf {
            donor,
            triangles: triangles
                .map(|(number, triangle)| {
                    [0, 1, 2].map(|k| NewCorner {
                        place: place(triangle.corners[k]),
                        like: (3 * number + k) as u32,
                    })
                })
                .collect(),
        }
    }

    /// The order, with the removal of what is left.
    fn finish(mut self) -> RemovalOrder {
        self.flush();
        let originals = self.is_left.iter().enumerate().filter(|(_, left)| **left);
        let mut names: Vec<LeafId> = originals.map(|(k, _)| LeafId::from_index(k)).collect();
        let count = self.foliage.leaves().len();
        let clusters = self.names.iter().flatten();
        names.extend(clusters.filter(|name| name.index() >= count));
        names.sort_unstable();
        let mut order = self.order;
        debug_assert_eq!(
            order.leaves_after(order.len()),
            names.len(),
            "every leaf that is left has a name"
        );
        for name in names {
            order.push(name, &[]);
        }
        order
    }
}

fn disc_of(foliage: &Foliage, skeleton: &PlantSkeleton, leaf: LeafId) -> Disc {
    let centre = foliage.leaf(leaf).centre();
    let stick = skeleton.leaf_segments[leaf.index()];
    let corners = foliage.triangles_of(leaf).iter().flat_map(|t| t.corners);
    let distances_m = corners.map(|corner| (corner - centre).length());
    Disc {
        anchor: stick.map_or(centre, |s| skeleton.segments[s.index()].end),
        centre,
        radius_m: distances_m.fold(0.0, f64::max),
    }
}
