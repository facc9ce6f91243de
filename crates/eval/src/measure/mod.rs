//! How far a simplified foliage is from its original, in numbers.
//!
//! Both are drawn as leaf-ID images from views that drove no simplifier; every
//! [`Metric`] of [`METRICS`] is then a function of what was counted in them.

mod metric;
mod scores;
mod seen;

pub use metric::{
    COVERAGE_RATIO, Direction, METRICS, Metric, PRECISION, RECALL, SILHOUETTE_IOU,
    VMI_ERROR_PERCENT,
};
pub use scores::{Measurement, Scores};
pub use seen::SeenView;

use secateur_model::{Foliage, Lod};
use secateur_raster::{MAX_RESOLUTION, MAX_TOTAL_PIXELS, Scene, ViewSet};

/// From where, and how finely, one judges.
#[derive(Clone, Debug, PartialEq)]
pub struct Judging {
    /// The cameras, the same for the original and the simplified foliage.
    pub views: ViewSet,
    /// Image width and height in pixels, 1 to [`MAX_RESOLUTION`].
    pub resolution: u32,
}

impl Judging {
    /// Image side of [`held_out`](Self::held_out), in pixels.
    pub const RESOLUTION: u32 = 512;

    /// The held-out views: the 12 vertices of an icosahedron about the
    /// original's bounding sphere (Entropy 2018, 20, 213, section 4.2) at
    /// 512 x 512.
    ///
    /// # Errors
    /// [`MeasureError::NoFoliage`] if the original has no leaf.
    pub fn held_out(original: &Foliage) -> Result<Self, MeasureError> {
        let sphere = original.bounding_sphere().ok_or(MeasureError::NoFoliage)?;
        Ok(Self {
            views: ViewSet::icosahedron(sphere),
            resolution: Self::RESOLUTION,
        })
    }

    fn check(&self) -> Result<(), MeasureError> {
        if self.views.is_empty() {
            return Err(MeasureError::NoView);
        }
        if !(1..=MAX_RESOLUTION).contains(&self.resolution) {
            return Err(MeasureError::Resolution(self.resolution));
        }
        let pixels = u64::from(self.resolution).pow(2) * self.views.len() as u64;
        if pixels > MAX_TOTAL_PIXELS {
            return Err(MeasureError::TooManyPixels(pixels));
        }
        Ok(())
    }
}

/// Why nothing can be measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeasureError {
    /// The original has no leaf to stand in the middle of the views.
    #[error("the original has no leaves to measure against")]
    NoFoliage,
    /// An empty view set.
    #[error("there is no view to measure from")]
    NoView,
    /// An image side out of range.
    #[error("resolution {0} is not in 1 to {MAX_RESOLUTION}")]
    Resolution(u32),
    /// More pixels over all views than can be counted.
    #[error("the views have {0} pixels, at most {MAX_TOTAL_PIXELS}: choose a lower resolution")]
    TooManyPixels(u64),
}

/// Measures a simplified foliage against its original. Leaf numbers need not
/// correspond: each foliage is drawn and counted on its own.
///
/// Draws on rayon's current thread pool, both foliages once in each view; holds
/// two images a thread.
///
/// # Errors
/// [`MeasureError`] if the judging has no view or a resolution out of range.
pub fn measure(
    original: &Foliage,
    simplified: &Foliage,
    judging: &Judging,
) -> Result<Measurement, MeasureError> {
    let all = |foliage: &Foliage| Lod::original(foliage.leaves().len());
    compare(
        (original, &all(original)),
        (simplified, &all(simplified)),
        judging,
    )
}

/// Measures a level of detail of a foliage against the whole foliage, as
/// [`measure`] does.
///
/// # Errors
/// As [`measure`].
///
/// # Panics
/// If the level is one of another foliage.
pub fn measure_lod(
    foliage: &Foliage,
    lod: &Lod,
    judging: &Judging,
) -> Result<Measurement, MeasureError> {
    if !lod.is_of_originals() {
        return measure(foliage, &lod.foliage(foliage), judging);
    }
    let original = Lod::original(foliage.leaves().len());
    compare((foliage, &original), (foliage, lod), judging)
}

fn compare(
    original: (&Foliage, &Lod),
    simplified: (&Foliage, &Lod),
    judging: &Judging,
) -> Result<Measurement, MeasureError> {
    judging.check()?;
    let [original, simplified] = [original, simplified].map(|(foliage, lod)| Scene {
        foliage,
        lod,
        views: &judging.views,
        resolution: judging.resolution,
    });
    let seen = seen::see(&original, &simplified);
    Ok(Measurement::of(&seen, judging.resolution))
}

#[cfg(test)]
mod tests;
