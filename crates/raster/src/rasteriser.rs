//! One interface for both twins.

use crate::{AreaTable, Fragments, Scene, cpu};

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

    /// The A-buffer of all views and, from the heads of its lists, the area table.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn fragments_and_areas(&self, scene: &Scene<'_>)
    -> Result<(Fragments, AreaTable), RasterError>;

    /// The area table of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError>;

    /// Whether a GPU does it.
    fn is_gpu(&self) -> bool {
        false
    }
}

/// Rasterises on the CPU, on rayon's current thread pool.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuRasteriser;

impl Rasteriser for CpuRasteriser {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        Ok(cpu::fragments(scene))
    }

    fn fragments_and_areas(
        &self,
        scene: &Scene<'_>,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        Ok(cpu::fragments_and_areas(scene))
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        Ok(cpu::areas(scene))
    }
}
