//! `--scene` and `--occluder`: from where a plant is seen, and what stands before it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use schemars::JsonSchema;
use secateur::{Detail, Document, Foliage, Memory, Options, Problem, Views, scene_views};
use secateur_levels::chain::SceneLook;
use serde::Serialize;

use super::args::SceneArgs;
use super::failure::Failure;
use super::output;
use super::record::{shown, shown_if};

/// What a scene and further files hold.
#[derive(Default)]
pub(crate) struct Surroundings {
    views: Option<Views>,
    occluders: Option<Arc<Foliage>>,
}

impl SceneArgs {
    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.scene.iter().chain(&self.occluder);
        files.map(PathBuf::as_path)
    }

    /// Reads them; none of the outputs may be in the way of a buffer or an image of theirs.
    pub(crate) fn read(&self, memory: Memory, outputs: &[&Path]) -> Result<Surroundings, Failure> {
        let mut views = None;
        let mut all: Option<Foliage> = None;
        for path in self.files() {
            tracing::info!("reading {}", path.display());
            let document = Document::open_within(path, memory)?;
            output::check_spares(&document, outputs)?;
            let is_scene = self.scene.as_deref() == Some(path);
            if is_scene && views.is_none() {
                let of_scene = scene_views(&document.cameras()?);
                let of_scene =
                    of_scene.map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
                views = Some(Views::Cameras(of_scene));
            }
            let occluders = document.occluders()?;
            if !is_scene && occluders.leaves().is_empty() {
                let nothing = Problem::NoOccluder;
                return Err(Failure::input(format!("{}: {nothing}", path.display())));
            }
            all = Some(match all {
                None => occluders,
                Some(all) => all
                    .followed_by(&occluders)
                    .map_err(|e| Failure::input(format!("{}: {e}", path.display())))?,
            });
        }
        Ok(Surroundings {
            views,
            occluders: all.map(Arc::new),
        })
    }
}

impl Surroundings {
    /// The options of a run within them.
    pub(crate) fn apply(&self, options: &mut Options) {
        if let Some(views) = &self.views {
            options.views = views.clone();
        }
        options.occluders.clone_from(&self.occluders);
    }

    /// How levels are judged in them; none where nothing is about the plant.
    pub(crate) fn look(
        &self,
        args: &SceneArgs,
        memory: Memory,
    ) -> Result<Option<SceneLook>, Failure> {
        let mut obstacles = Vec::new();
        for path in args.files() {
            let drawn = Document::open_within(path, memory)?.drawn_scene(Detail::Color)?;
            obstacles.extend(drawn.into_iter().map(|drawn| drawn.surface));
        }
        let cameras = match &self.views {
            Some(Views::Cameras(cameras)) => Some(cameras.clone()),
            _ => None,
        };
        let is_any = cameras.is_some() || !obstacles.is_empty();
        Ok(is_any.then_some(SceneLook { cameras, obstacles }))
    }

    /// What they leave of the memory of a run.
    pub(crate) fn left_of(&self, memory: Memory) -> Memory {
        let Some(occluders) = &self.occluders else {
            return memory;
        };
        let triangles = size_of_val(occluders.triangles());
        let pieces = size_of_val(occluders.leaves());
        // The run has a copy of its own where holes or sides do not count.
        let held = 2 * (triangles + pieces) as u64;
        Memory::Bytes(memory.bytes().saturating_sub(held))
    }

    /// What a record says of them.
    pub(crate) fn record(&self, args: &SceneArgs) -> SurroundingsRecord {
        let occluders = self.occluders.as_ref();
        SurroundingsRecord {
            scene: shown_if(args.scene.as_deref()),
            occluders: shown(&args.occluder),
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
