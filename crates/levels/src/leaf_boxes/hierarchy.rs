//! Which branches have boxes.

use glam::{DVec3, Vec3Swizzles as _};
use secateur_model::{Foliage, LeafId, PlantSkeleton};

use super::{LeafBox, OrientedBox};

/// How far down boxes are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxLimits {
    /// The paper's top detail level: branches from the trunk's, which is the whole plant's, to the
    /// last that has a box.
    pub top_level: u32,
    /// A branch whose box has less than this share of the whole plant's volume has none, nor has what
    /// grows from it.
    pub least_volume: f64,
}

/// A run of segments that continue each other.
struct Branch {
    parent: Option<usize>,
    direction: DVec3,
    /// Leaves of it alone.
    leaves: Vec<LeafId>,
}

/// The boxes of a plant, parents before children, the whole plant's first; none without leaves.
///
/// A leaf that grows on no segment is in the whole plant's box only.
///
/// # Panics
/// If the skeleton is not one of this foliage ([`PlantSkeleton::check`]).
pub fn leaf_boxes(foliage: &Foliage, skeleton: &PlantSkeleton, limits: &BoxLimits) -> Vec<LeafBox> {
    assert_eq!(skeleton.leaf_segments.len(), foliage.leaves().len());
    let (branches, loose) = branches(skeleton);
    let all: Vec<LeafId> = (0..foliage.leaves().len())
        .map(LeafId::from_index)
        .collect();
    let Some(bounds) = about(foliage, &all, DVec3::Y) else {
        return Vec::new();
    };
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); branches.len()];
    for (index, branch) in branches.iter().enumerate() {
        if let Some(parent) = branch.parent {
            below[parent].push(index);
        }
    }
    let with_all_below = |branch: usize| {
        let mut leaves = Vec::new();
        let mut open = vec![branch];
        while let Some(branch) = open.pop() {
            leaves.extend(&branches[branch].leaves);
            open.extend(&below[branch]);
        }
        leaves.sort_unstable();
        leaves
    };
    // Several branches may start at the ground; the whole plant is the box of all of them.
    let roots = (0..branches.len()).filter(|b| branches[*b].parent.is_none());
    let mut own = loose;
    let mut children = Vec::new();
    for root in roots {
        own.extend(&branches[root].leaves);
        children.extend(&below[root]);
    }
    let whole_volume = bounds.volume();
    let mut boxes = vec![LeafBox {
        bounds,
        level: 0,
        children: Vec::new(),
        leaves: all,
        own,
    }];
    let mut open = vec![(0, children)];
    while let Some((parent, candidates)) = open.pop() {
        for branch in candidates {
            let leaves = with_all_below(branch);
            let bounds = about(foliage, &leaves, branches[branch].direction);
            let level = boxes[parent].level + 1;
            let is_large = |b: &OrientedBox| {
                b.volume() >= limits.least_volume * whole_volume && level <= limits.top_level
            };
            match bounds.filter(is_large) {
                Some(bounds) => {
                    let this = boxes.len();
                    boxes[parent].children.push(this);
                    boxes.push(LeafBox {
                        bounds,
                        level,
                        children: Vec::new(),
                        leaves,
                        own: branches[branch].leaves.clone(),
                    });
                    open.push((this, below[branch].clone()));
                }
                None => boxes[parent].own.extend(leaves),
            }
        }
        boxes[parent].own.sort_unstable();
    }
    boxes
}

/// The branches, parents before children, and the leaves that grow on no segment.
fn branches(skeleton: &PlantSkeleton) -> (Vec<Branch>, Vec<LeafId>) {
    let mut branches: Vec<Branch> = Vec::new();
    let mut branch_of = Vec::with_capacity(skeleton.segments.len());
    let mut is_continued = vec![false; skeleton.segments.len()];
    for segment in &skeleton.segments {
        let parent = segment.parent.map(|parent| parent.index());
        let continued = parent.filter(|p| segment.continues_parent && !is_continued[*p]);
        let branch = match continued {
            Some(before) => {
                is_continued[before] = true;
                branch_of[before]
            }
            None => {
                branches.push(Branch {
                    parent: parent.map(|p| branch_of[p]),
                    direction: segment.end - segment.start,
                    leaves: Vec::new(),
                });
                branches.len() - 1
            }
        };
        branch_of.push(branch);
    }
    let mut loose = Vec::new();
    for (index, segment) in skeleton.leaf_segments.iter().enumerate() {
        let leaf = LeafId::from_index(index);
        match segment {
            Some(segment) => branches[branch_of[segment.index()]].leaves.push(leaf),
            None => loose.push(leaf),
        }
    }
    (branches, loose)
}

/// The box along a direction about leaves; `None` without any.
fn about(foliage: &Foliage, leaves: &[LeafId], direction: DVec3) -> Option<OrientedBox> {
    let ahead = direction.normalize_or(DVec3::Y);
    // Level where that can be, so that boxes of like branches are alike.
    let aside = match ahead.xz().length() > 1e-6 {
        true => DVec3::Y.cross(ahead).normalize(),
        false => DVec3::X,
    };
    let axes = [aside, ahead, aside.cross(ahead)];
    let corners = leaves.iter().flat_map(|leaf| foliage.triangles_of(*leaf));
    let corners = corners.flat_map(|triangle| triangle.corners);
    let (low, high) = corners.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), corner| {
            let at = DVec3::from_array(axes.map(|axis| axis.dot(corner)));
            (low.min(at), high.max(at))
        },
    );
    let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
    middle.is_finite().then(|| OrientedBox {
        centre: axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z,
        axes,
        half,
    })
}
