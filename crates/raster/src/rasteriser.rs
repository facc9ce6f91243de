//! One interface for both twins.

use crate::{AreaTable, Fragments, Scene, TooManyFragments, cpu};

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

    /// The A-buffer of all views, if it has at most so many fragments: to be asked
    /// where memory is limited.
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

    /// The area table of all views.
    ///
    /// # Errors
    /// [`RasterError`] if the device fails.
    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError>;
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
