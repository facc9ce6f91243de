//! What a turtle leaves behind: segments of wood and the places of leaves.

use glam::DVec3;

/// The place of a segment in [`Skeleton::segments`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SegmentIndex(u32);

impl SegmentIndex {
    /// The segment at this place, from 0.
    ///
    /// # Panics
    /// If it does not fit 32 bits.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("a segment index fits 32 bits"))
    }

    /// Its place, from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A tapered piece of wood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The segment it grows from; always an earlier one.
    pub parent: Option<SegmentIndex>,
    /// Whether it goes on where its parent ends, as the same branch.
    pub continues_parent: bool,
    /// Where it starts, in metres.
    pub start: DVec3,
    /// Where it ends, in metres.
    pub end: DVec3,
    /// The radius at its start, in metres.
    pub start_radius_m: f64,
    /// The radius at its end, in metres; 0 for a tip.
    pub end_radius_m: f64,
    /// How many sides it has, at least 3.
    pub sides: u32,
}

/// A leaf's place and pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafPose {
    /// The segment it grows on.
    pub segment: Option<SegmentIndex>,
    /// Its base, in metres.
    pub base: DVec3,
    /// The unit vector from base to tip.
    pub along: DVec3,
    /// The unit vector that its upper face looks in, at right angles to `along`.
    pub facing: DVec3,
    /// From base to tip, in metres.
    pub length_m: f64,
}

/// The branches and leaves of a plant, before they have any surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Pieces of wood, parents before children.
    pub segments: Vec<Segment>,
    /// Leaves, in the order they were drawn.
    pub leaves: Vec<LeafPose>,
}
