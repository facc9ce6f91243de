//! One interface for both twins.

use crate::occluders::Occlusion;
use crate::{AreaTable, Fragments, Scene, ViewSet, cpu};

/// Why a rasteriser could not do its work: the device failed. The CPU never
/// does.
pub type RasterError = Box<dyn std::error::Error + Send + Sync>;

/// Makes fragments and areas of scenes; all implementations give the same bits.
pub trait Rasteriser {
    /// The A-buffer of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError>;

    /// The area table of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError>;

    /// What hides leaves in each of the views, where scenes have more in them than leaves.
    fn occlusions(&self, views: &ViewSet, resolution: u32) -> Option<Vec<Occlusion>> {
        let _ = (views, resolution);
        None
    }
}

/// Rasterises on the CPU, on rayon's current thread pool.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuRasteriser;

impl Rasteriser for CpuRasteriser {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        Ok(cpu::fragments(scene))
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        Ok(cpu::areas(scene))
    }
}
