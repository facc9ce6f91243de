//! `--scene` and `--occluder`: from where a plant is seen, and what stands before it.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use secateur::{Document, Memory, Problem, Surroundings, scene_views};
use serde::Serialize;

use super::args::SceneArgs;
use super::failure::Failure;
use super::output;
use super::record::{shown, shown_if};

impl SceneArgs {
    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.scene.iter().chain(&self.occluder);
        files.map(PathBuf::as_path)
    }

    /// Reads them; none of the outputs may be in the way of a buffer or an image of theirs.
    pub(crate) fn read(&self, memory: Memory, outputs: &[&Path]) -> Result<Surroundings, Failure> {
        let mut surroundings = Surroundings::default();
        for path in self.files() {
            let failed = |error: &dyn std::error::Error| {
                Failure::input(format!("{}: {error}", path.display()))
            };
            tracing::info!("reading {}", path.display());
            let document = Document::open_within(path, memory)?;
            output::check_spares(&document, outputs)?;
            let is_scene = self.scene.as_deref() == Some(path);
            if is_scene && surroundings.cameras.is_none() {
                let cameras = scene_views(&document.cameras()?);
                surroundings.cameras = Some(cameras.map_err(|e| failed(&e))?);
            }
            let occluders = document.occluders()?;
            if !is_scene && occluders.leaves().is_empty() {
                return Err(failed(&Problem::NoOccluder));
            }
            let added = surroundings.add_occluders(occluders);
            added.map_err(|e| failed(&e))?;
        }
        Ok(surroundings)
    }

    /// These surroundings with what is drawn of the files, for levels.
    pub(crate) fn drawn(
        &self,
        surroundings: &Surroundings,
        memory: Memory,
    ) -> Result<Surroundings, Failure> {
        let mut drawn = surroundings.clone();
        for path in self.files() {
            drawn.add_obstacles(&Document::open_within(path, memory)?)?;
        }
        Ok(drawn)
    }

    /// What a record says of them.
    pub(crate) fn record(&self, surroundings: &Surroundings) -> SurroundingsRecord {
        let occluders = surroundings.occluders.as_ref();
        SurroundingsRecord {
            scene: shown_if(self.scene.as_deref()),
            occluders: shown(&self.occluder),
            occluder_triangles: occluders.map_or(0, |all| all.triangles().len()),
        }
    }
}

/// What stands about a plant.
#[derive(Serialize, JsonSchema)]
pub(crate) struct SurroundingsRecord {
    /// The file of `--scene`.
    scene: Option<String>,
    /// The files of `--occluder`.
    occluders: Vec<String>,
    /// Triangles that hide leaves.
    occluder_triangles: usize,
}
