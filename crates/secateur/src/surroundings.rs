//! What is about a plant: from where it is seen, and what stands before it.

use std::sync::Arc;

use secateur_gltf::{Detail, Document, GltfError};
use secateur_levels::chain::{ChainOptions as LevelsOptions, SceneLook};
use secateur_model::{Foliage, FoliageError, Memory, PlantSkeleton, Surface};
use secateur_raster::ViewSet;
use secateur_simplify::{Options, Views};

/// What is about a plant, in its world space: see [`Plant::within`](crate::Plant::within). Where there is nothing, plants
/// are seen from all around.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// From where the plant is seen, such as [`scene_views`](crate::scene_views) has it.
    pub cameras: Option<ViewSet>,
    /// What hides leaves.
    pub occluders: Option<Arc<Foliage>>,
    /// Occluders as they are drawn, for levels, which are judged by pictures.
    pub obstacles: Vec<Surface>,
    /// What the plant has grown on, in place of the skeleton of its file.
    pub skeleton: Option<Arc<PlantSkeleton>>,
}

impl Surroundings {
    /// Adds what hides leaves.
    ///
    /// # Errors
    /// [`FoliageError`] if there is too much of it.
    pub fn add_occluders(&mut self, occluders: Foliage) -> Result<(), FoliageError> {
        self.occluders = Some(Arc::new(match &self.occluders {
            None => occluders,
            Some(all) => all.followed_by(&occluders)?,
        }));
        Ok(())
    }

    /// Adds all that is drawn of a file, for levels.
    ///
    /// # Errors
    /// [`GltfError`] if it can't be read.
    pub fn add_obstacles(&mut self, document: &Document) -> Result<(), GltfError> {
        let drawn = document.drawn_scene(Detail::Color)?;
        self.obstacles
            .extend(drawn.into_iter().map(|drawn| drawn.surface));
        Ok(())
    }

    /// Options of a run within them; what these have of their own stays where nothing is about the plant.
    pub(crate) fn apply(&self, options: &mut Options) {
        if let Some(cameras) = &self.cameras {
            options.views = Views::Cameras(cameras.clone());
        }
        if let Some(occluders) = &self.occluders {
            options.occluders = Some(Arc::clone(occluders));
        }
        if let Some(skeleton) = &self.skeleton {
            options.skeleton = Some(Arc::clone(skeleton));
        }
    }

    /// Options of levels within them.
    pub(crate) fn apply_to_levels(&self, options: &mut LevelsOptions) {
        self.apply(&mut options.leaves);
        if self.cameras.is_some() || !self.obstacles.is_empty() {
            options.scene = Some(SceneLook {
                cameras: self.cameras.clone(),
                obstacles: self.obstacles.clone(),
            });
        }
    }

    /// What they leave of the memory of a run.
    pub(crate) fn left_of(&self, memory: Memory) -> Memory {
        let Some(occluders) = &self.occluders else {
            return memory;
        };
        let held = size_of_val(occluders.triangles()) + size_of_val(occluders.leaves());
        // The run has a copy of its own where holes or sides do not count.
        Memory::Bytes(memory.bytes().saturating_sub(2 * held as u64))
    }
}
