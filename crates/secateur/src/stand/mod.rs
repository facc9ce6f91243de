//! A stand: many plants of a few kinds, what stands about them, and the cameras that see it.

mod choice;
mod kinds;
mod pictures;
mod read;
mod report;
mod rounds;
mod written;

use glam::DMat4;
use secateur_eval::{StandCamera, StandKind};
use secateur_gltf::Document;
use secateur_levels::chain::ChainOptions as LevelsOptions;

use crate::Plant;

pub use kinds::{KindLevel, KindLevels};
pub use read::drawn;
pub use report::{KindLevelReport, KindReport, PlaceReport, StandReport};
pub use rounds::{CameraFigures, StandLevels};
pub use written::StandFigures;

/// A stand is seen by at most this many cameras, spread evenly over their list.
pub const MOST_CAMERAS: usize = 12;

/// Many plants of a few kinds, what stands about them, and the cameras that see it.
#[derive(Debug)]
pub struct Stand {
    /// The kinds of plants.
    pub kinds: Vec<PlantKind>,
    /// Where plants stand.
    pub places: Vec<PlantPlace>,
    /// From where the stand is seen: 1 to [`MOST_CAMERAS`].
    pub cameras: Vec<StandCamera>,
    /// What is no plant and hides them, each kind with its places.
    obstacles: Vec<(StandKind, Vec<DMat4>)>,
    /// What has to be said of the scene, a sentence each.
    pub notes: Vec<String>,
}

/// A kind of plants.
#[derive(Debug)]
pub struct PlantKind {
    /// What its levels are called after; unlike those of other kinds.
    pub name: String,
    plant: Plant,
    /// The plant as its file has it.
    document: Document,
    drawn: StandKind,
}

/// Where a plant stands.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantPlace {
    /// The number of its kind.
    pub kind: usize,
    /// What its node is called.
    pub name: String,
    /// From the plant's own space to the stand's.
    pub world_from_own: DMat4,
}

/// What a stand may differ by and cost. Levels are the cheapest within the limits on pictures; where only a budget is
/// given, those nearest to the plants that it pays for.
#[derive(Clone, Debug)]
pub struct StandOptions {
    /// How the levels of each kind are made; heights are those that the cameras ask for. Its `cost` weighs the scene.
    pub levels: LevelsOptions,
    /// The largest difference of a camera's picture, over the pixels of plants.
    pub max_difference: Option<f64>,
    /// The largest mean FLIP over a camera's picture.
    pub max_flip: Option<f64>,
    /// The most triangles of all plants together.
    pub triangles: Option<u64>,
    /// The most bytes that all levels take on the GPU.
    pub gpu_bytes: Option<u64>,
}

/// Why a stand can't be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct StandError {
    /// The file of the stand.
    pub file: String,
    /// What is wrong, and where.
    pub reason: String,
}
