//! The levels of a chain.

use std::ops::{Deref, DerefMut};

use secateur_gltf::chain::{LevelTexture, Morph};
use secateur_model::{Lod, Note, RemovalOrder};

use super::level_report::{ImpostorReport, LevelReport};
use crate::impostor::Impostor;

/// A level of a chain: what is drawn, and the figures of its report.
#[derive(Clone, Debug)]
pub struct ChainLevel {
    /// The mesh or the impostor that is drawn.
    pub shape: Shape,
    /// Its figures; a level dereferences to them.
    pub report: LevelReport,
    /// The level that casts its shadow, counted from 0.
    pub shadow: usize,
    /// All that was done to the leaves, as one order; none for impostors.
    pub order: Option<RemovalOrder>,
    /// Base colour textures of its own; empty where it has those of the tree.
    pub textures: Vec<LevelTexture>,
    /// Where its vertices go on the way to the next level, where that was asked for and both are meshes.
    pub morph: Option<Morph>,
}

impl Deref for ChainLevel {
    type Target = LevelReport;

    fn deref(&self) -> &LevelReport {
        &self.report
    }
}

impl DerefMut for ChainLevel {
    fn deref_mut(&mut self) -> &mut LevelReport {
        &mut self.report
    }
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

impl ImpostorLevel {
    /// What records say of it.
    pub(super) fn report(&self) -> ImpostorReport {
        let same_cost = self.same_cost;
        ImpostorReport {
            facts: self.impostor.facts(),
            mesh_triangles: self.mesh_triangles,
            mesh_difference: self.mesh_difference,
            same_cost_triangles: same_cost.map(|(triangles, _)| triangles),
            same_cost_difference: same_cost.map(|(_, difference)| difference),
        }
    }
}

/// A chain, finest level first.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The levels, finest first; at most 8.
    pub levels: Vec<ChainLevel>,
    /// What was asked for and left out, and the like, a sentence each.
    pub notes: Vec<Note>,
    /// How long it took, in seconds by stage: together all of the time.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Chain {
    /// The largest difference that a switch shows; none where there is none.
    pub fn largest_pop(&self) -> Option<f64> {
        let pops = self.levels.iter().filter_map(|level| level.pop);
        pops.reduce(f64::max)
    }

    /// SHA-256 of all that was done to the leaves of the coarsest level that has any; none where no level does.
    pub fn coarsest_order_sha256(&self) -> Option<String> {
        let orders = self.levels.iter().rev();
        orders
            .map(|level| level.order_sha256.clone())
            .find_map(|of| of)
    }
}
