//! The records of `secateur lods`.

use std::path::Path;

use schemars::JsonSchema;
use secateur::{Effort, PlacedLevel, Preset, WoodMode};
use secateur_gltf::chain::Layout;
use secateur_levels::chain::Textures;
use serde::Serialize;

use super::super::failure::Failure;
use super::super::record::OfOriginal;
use super::super::surroundings::SurroundingsRecord;

/// The levels of a plant.
#[derive(Serialize, JsonSchema)]
pub(crate) struct LodsRecord {
    /// Path of the plant's file as the call gives it.
    pub(super) input: String,
    /// What nodes and files of the levels are called after.
    pub(super) name: String,
    pub(super) layout: Layout,
    /// The files that were written, those of levels first.
    pub(super) files: Vec<String>,
    /// Bytes of all files.
    pub(super) bytes: u64,
    /// The page to look at the levels, if one was asked for.
    pub(super) preview: Option<String>,
    pub(super) leaves: OfOriginal,
    /// Triangles of the whole plant.
    pub(super) triangles: OfOriginal,
    /// How many of these are leaves.
    pub(super) foliage_triangles: OfOriginal,
    /// How many of these are wood.
    pub(super) wood_triangles: OfOriginal,
    pub(super) surroundings: SurroundingsRecord,
    pub(super) screen: ScreenRecord,
    /// The largest difference that a level may have.
    pub(super) max_difference: f64,
    /// The largest `block_coverage` that a level may have.
    pub(super) max_block_coverage: f64,
    pub(super) plant_height_m: Option<f64>,
    /// The largest difference that a switch may show.
    pub(super) max_pop: Option<f64>,
    pub(super) wood: WoodMode,
    pub(super) textures: Textures,
    /// The largest difference that a switch shows.
    pub(super) largest_pop: Option<f64>,
    pub(super) preset: Preset,
    pub(super) effort: Effort,
    /// Where leaves were drawn: `cpu` or `gpu`.
    pub(super) engine: &'static str,
    /// The GPU and its driver; none on the CPU.
    pub(super) adapter: Option<String>,
    /// The levels, finest first.
    pub(super) levels: Vec<PlacedLevel>,
    /// SHA-256 of all that was done to the leaves of the coarsest level that has any.
    pub(super) order_sha256: Option<String>,
    /// What was asked for and left out, and the like, a sentence each.
    pub(super) notes: Vec<String>,
    /// What has to be said of plant and levels, a sentence each.
    pub(super) warnings: Vec<String>,
    /// Whether the levels are those of an earlier call: neither plant nor options have changed.
    pub(super) kept: bool,
}

/// A plant that could not be done.
#[derive(Serialize, JsonSchema)]
pub(crate) struct FailureRecord {
    /// Path of the plant's file as the call gives it.
    input: String,
    /// Why, in a sentence.
    error: String,
}

impl FailureRecord {
    /// Why a tree could not be done.
    pub(crate) fn of(tree: &Path, failure: &Failure) -> Self {
        Self {
            input: tree.display().to_string(),
            error: failure.to_string(),
        }
    }
}

/// The screen that levels are for.
#[derive(Serialize, JsonSchema)]
pub(super) struct ScreenRecord {
    pub(super) height_px: f64,
    pub(super) fov_degrees: f64,
}
