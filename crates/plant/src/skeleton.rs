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

/// What a leaf is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LeafKind {
    /// A card of two triangles.
    Quad,
    /// Two cards across each other, eight triangles that share the line where
    /// the cards meet: so they are one leaf.
    Crossed,
    /// A bent and folded strip of this many triangles, 2 to 18, an even number.
    Blade {
        /// How many triangles.
        triangles: u8,
    },
    /// Two long triangles that share their ridge.
    Needle,
}

impl LeafKind {
    /// How many triangles a leaf has.
    pub fn triangles(self) -> u32 {
        match self {
            Self::Quad | Self::Needle => 2,
            Self::Crossed => 8,
            Self::Blade { triangles } => u32::from(triangles),
        }
    }
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
    /// From side to side, in metres.
    pub width_m: f64,
    /// What it is made of.
    pub kind: LeafKind,
}

/// The branches and leaves of a plant, before they have any surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Pieces of wood, parents before children.
    pub segments: Vec<Segment>,
    /// Leaves, in the order they were drawn.
    pub leaves: Vec<LeafPose>,
}
