//! One interface for both twins.

use crate::occluders::Occlusion;
use crate::{AreaTable, Fragments, Scene, TooManyFragments, ViewSet, cpu};

/// Why a rasteriser could not do its work: the device failed, which the CPU never
/// does, or there are [`TooManyFragments`].
pub type RasterError = Box<dyn std::error::Error + Send + Sync>;

/// Makes fragments and areas of scenes; all implementations give the same bits.
pub trait Rasteriser {
    /// The A-buffer of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError>;

    /// The A-buffer of all views, if it has at most `most` fragments: to be asked where memory is
    /// limited.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails, or [`TooManyFragments`] in it.
    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        let fragments = self.fragments(scene)?;
        let found = fragments.len() as u64;
        match found > most {
            true => Err(TooManyFragments { found, most }.into()),
            false => Ok(fragments),
        }
    }

    /// [`Self::fragments_within`] and, from the heads of its lists, the area table.
    ///
    /// # Errors
    /// As [`Self::fragments_within`].
    fn fragments_and_areas_within(
        &self,
        scene: &Scene<'_>,
        most: u64,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        let fragments = self.fragments_within(scene, most)?;
        let areas = cpu::areas_of_heads(&fragments, scene.foliage.leaves().len());
        Ok((fragments, areas))
    }

    /// The A-buffer of all views and, from the heads of its lists, the area table.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn fragments_and_areas(
        &self,
        scene: &Scene<'_>,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        self.fragments_and_areas_within(scene, u64::from(u32::MAX))
    }

    /// The area table of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError>;

    /// Whether the lists of fragments of a scene, being edited, may take this many bytes: to be asked
    /// now and then where leaves grow, since larger leaves cover more pixels.
    ///
    /// # Errors
    /// [`RasterError`] if memory is limited and they take more.
    fn may_lists_take(&self, scene: &Scene<'_>, bytes: u64) -> Result<(), RasterError> {
        let _ = (scene, bytes);
        Ok(())
    }

    /// Whether a GPU does it.
    fn is_gpu(&self) -> bool {
        false
    }

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

    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        Ok(cpu::fragments_within(scene, most)?)
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        Ok(cpu::areas(scene))
    }
}
