//! What records say of each level.

use schemars::JsonSchema;
use secateur_gltf::chain::{Layout, WrittenChain};
use secateur_scene::chain::{Chain, ChainLevel, LevelReport};
use serde::Serialize;

use super::job::Job;

/// A level, and where it is.
#[derive(Clone, Serialize, JsonSchema)]
pub(crate) struct LevelRow {
    #[serde(flatten)]
    pub(crate) place: Place,
    /// Where the level is that casts its shadow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shadow: Option<Place>,
    #[serde(flatten)]
    pub(crate) report: LevelReport,
}

/// Where a level is: a file of its own, or a node of the file of all levels.
#[derive(Clone, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Place {
    /// The level's file.
    File(String),
    /// The name of the level's node.
    Node(String),
}

/// The record of each level, finest first.
pub(crate) fn rows(job: &Job<'_>, made: &Chain, written: &WrittenChain) -> Vec<LevelRow> {
    let place = |k: usize| match job.layout {
        Layout::Files => Place::File(written.files[k].display().to_string()),
        Layout::Siblings | Layout::Msft => Place::Node(format!("{}_LOD{k}", job.name)),
    };
    let row = |(k, level): (usize, &ChainLevel)| LevelRow {
        place: place(k),
        shadow: Some(place(level.shadow)),
        report: level.report.clone(),
    };
    made.levels.iter().enumerate().map(row).collect()
}
