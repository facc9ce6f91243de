//! What the parts of a plant hang on: for shaders that sway it.

use glam::Vec3;

use crate::SegmentIndex;

/// What a leaf, or a vertex of wood, hangs on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// The piece of wood, if there is one.
    pub segment: Option<SegmentIndex>,
    /// The point of that piece's axis that it hangs on, in metres: of a leaf where it grows, of
    /// wood the middle of the ring that the vertex is on.
    pub pivot: Vec3,
    /// From the ground to the pivot along the wood, in metres.
    pub along_m: f32,
}

/// What all of a plant hangs on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlantHolds {
    /// For each vertex of the wood.
    pub wood: Vec<Hold>,
    /// What each leaf hangs on, in the order of the foliage.
    pub leaves: Vec<Hold>,
}
