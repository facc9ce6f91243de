//! A plant that was grown rather than read.

use crate::{PlantHolds, PlantSkeleton, Surface};

/// A grown plant: wood and leaves apart, ready to be written as glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// Its name, such as the species.
    pub name: String,
    /// Trunk and branches, in one mesh.
    pub wood: Surface,
    /// All leaves. No two leaves share a vertex.
    pub leaves: Surface,
    /// How many triangles each leaf has, in order of `leaves.triangles`.
    pub triangles_per_leaf: Vec<u32>,
    /// What it grew on, for methods that follow branches.
    pub skeleton: Option<PlantSkeleton>,
    /// What its leaves and wood hang on, for shaders that sway them.
    pub holds: Option<PlantHolds>,
}
