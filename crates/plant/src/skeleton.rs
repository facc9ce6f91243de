//! What a turtle leaves behind: segments of wood and the places of leaves.

use glam::DVec3;
use secateur_model::{PlantSkeleton, Segment, SegmentIndex};

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
        /// Number of its triangles.
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

impl Skeleton {
    /// What a file keeps of it: segments as they are, and for each leaf its own.
    pub fn into_plant_skeleton(self) -> PlantSkeleton {
        PlantSkeleton {
            leaf_segments: self.leaves.iter().map(|leaf| leaf.segment).collect(),
            segments: self.segments,
        }
    }
}
