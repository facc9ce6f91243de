//! The levels of a chain.

use secateur_eval::Difference;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{Lod, RemovalOrder};

use super::level_as_drawn::LevelAsDrawn;
use crate::impostor::Impostor;

/// A level of a chain, and from where it is to be seen.
#[derive(Clone, Debug)]
pub struct ChainLevel {
    /// The mesh or the impostor that is drawn.
    pub shape: Shape,
    /// Leaves that are left.
    pub leaves: u64,
    /// Triangles that leaves have in this level.
    pub foliage_triangles: u64,
    /// Triangles that wood has in this level.
    pub wood_triangles: u64,
    /// From how far off it is used, in metres: units of the file, unless the plant's height was given.
    pub distance: f64,
    /// How many pixels high the screen shows the plant's largest extent there; infinite at distance 0.
    pub pixels_high: f64,
    /// The least share of the screen's height at which it is drawn, before the next level takes
    /// over; 0 for the last.
    pub screen_coverage: f64,
    /// How far it looks from the original there, with its own textures.
    pub difference: Difference,
    /// Mean FLIP of the whole plant against the original at that height, over the frame of `measure`.
    pub flip_mean: f64,
    /// The difference between it and the level before where they switch; none for the first.
    pub pop: Option<f64>,
    /// The level that casts its shadow, counted from 0.
    pub shadow: usize,
    /// Outline of the leaves against the original's, by three of the held-out views in 256 x 256
    /// pixels, without exact textures; none for impostors.
    pub silhouette_iou: Option<f64>,
    /// VMI error of the leaves by the same, in per cent; none for impostors.
    pub vmi_error_percent: Option<f64>,
    /// SHA-256 of all that was done to the leaves; none for impostors.
    pub order_sha256: Option<String>,
    /// From how many views its leaves were chosen; none for impostors.
    pub view_count: Option<usize>,
    /// All that was done to the leaves, as one order; none for impostors.
    pub order: Option<RemovalOrder>,
    /// Base colour textures of its own; empty where it has those of the tree.
    pub textures: Vec<LevelTexture>,
    /// Whether its textures are those of the tree, but for the colours of clear texels.
    pub keeps_textures: bool,
    /// What all images of its materials take, four bytes a texel, with mips where they are read.
    pub texture_bytes: u64,
    /// How much of it a client shows; none for octahedral views, which only their sampler shows.
    pub as_drawn: Option<LevelAsDrawn>,
}

/// What a level is.
#[derive(Clone, Debug)]
pub enum Shape {
    /// The plant itself: the LOD of [`WholeTree::items`](secateur_gltf::WholeTree::items) that has all of it.
    Original(Lod),
    /// The plant with fewer triangles: a LOD of [`WholeTree::items`](secateur_gltf::WholeTree::items).
    Mesh(Lod),
    /// A picture of it.
    Impostor(Box<ImpostorLevel>),
}

/// An impostor, and what it was chosen against.
#[derive(Clone, Debug)]
pub struct ImpostorLevel {
    /// Its planes and pictures.
    pub impostor: Impostor,
    /// Triangles of the mesh that would be drawn there if it were left out.
    pub mesh_triangles: u64,
    /// How far that mesh looks from the original by the judge of the impostor.
    pub mesh_difference: f64,
    /// Triangles and difference of a mesh of as many triangles as the impostor has, by the same judge; none
    /// where the impostor is no lighter than the mesh above, or no such mesh can be made.
    pub same_cost: Option<(u64, f64)>,
}

impl ChainLevel {
    /// What it is, in a word: `original`, `mesh` or `impostor`.
    pub fn kind(&self) -> &'static str {
        match self.shape {
            Shape::Original(_) => "original",
            Shape::Mesh(_) => "mesh",
            Shape::Impostor(_) => "impostor",
        }
    }

    /// Triangles of the whole plant.
    pub fn triangles(&self) -> u64 {
        match &self.shape {
            Shape::Original(_) | Shape::Mesh(_) => self.foliage_triangles + self.wood_triangles,
            Shape::Impostor(level) => level.impostor.surface.triangles.len() as u64,
        }
    }
}

/// A chain, finest level first.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The levels, finest first; at most 8.
    pub levels: Vec<ChainLevel>,
    /// What was asked for and left out, and the like, a sentence each.
    pub notes: Vec<String>,
}
