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
use seen::Drawn;
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
    /// 512 x 512, with exact textures: else a card that is another triangle of the same
    /// picture would count as another outline.
    ///
    /// # Errors
    /// [`MeasureError::NoFoliage`] if the original has no leaf.
    pub fn held_out(original: &Foliage) -> Result<Self, MeasureError> {
        let sphere = original.bounding_sphere().ok_or(MeasureError::NoFoliage)?;
        Ok(Self {
            views: ViewSet::icosahedron(sphere).with_exact_textures(),
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
#[non_exhaustive]
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

/// An original foliage, drawn once for any number of measurements against it.
#[derive(Clone, Debug)]
pub struct Original<'f> {
    foliage: &'f Foliage,
    judging: Judging,
    drawn: Drawn,
}

impl<'f> Original<'f> {
    /// Draws it on rayon's current thread pool, once in each view; keeps a bit a
    /// pixel.
    ///
    /// # Errors
    /// [`MeasureError`] if the judging has no view or a resolution out of range.
    pub fn new(foliage: &'f Foliage, judging: Judging) -> Result<Self, MeasureError> {
        judging.check()?;
        let all = Lod::original(foliage.leaves().len());
        let drawn = seen::draw(&scene(foliage, &all, &judging));
        Ok(Self {
            foliage,
            judging,
            drawn,
        })
    }

    /// From where, and how finely, it is judged.
    pub fn judging(&self) -> &Judging {
        &self.judging
    }

    /// Measures a simplified foliage against it. Leaf numbers need not
    /// correspond: each foliage is drawn and counted on its own.
    pub fn measure(&self, simplified: &Foliage) -> Measurement {
        let all = Lod::original(simplified.leaves().len());
        self.measure_scene(simplified, &all)
    }

    /// Measures a level of detail of it against the whole.
    ///
    /// # Panics
    /// If the level is one of another foliage.
    pub fn measure_lod(&self, lod: &Lod) -> Measurement {
        match lod.is_of_originals() {
            true => self.measure_scene(self.foliage, lod),
            false => self.measure(&lod.foliage(self.foliage)),
        }
    }

    fn measure_scene(&self, foliage: &Foliage, lod: &Lod) -> Measurement {
        let drawn = seen::draw(&scene(foliage, lod, &self.judging));
        let seen = seen::compare(&self.drawn, &drawn);
        Measurement::of(&seen, self.judging.resolution)
    }
}

fn scene<'a>(foliage: &'a Foliage, lod: &'a Lod, judging: &'a Judging) -> Scene<'a> {
    Scene {
        foliage,
        lod,
        views: &judging.views,
        resolution: judging.resolution,
    }
}

/// [`Original::measure`] for one measurement alone.
///
/// # Errors
/// As [`Original::new`].
pub fn measure(
    original: &Foliage,
    simplified: &Foliage,
    judging: &Judging,
) -> Result<Measurement, MeasureError> {
    Ok(Original::new(original, judging.clone())?.measure(simplified))
}

/// [`Original::measure_lod`] for one measurement alone.
///
/// # Errors
/// As [`Original::new`].
///
/// # Panics
/// If the level is one of another foliage.
pub fn measure_lod(
    foliage: &Foliage,
    lod: &Lod,
    judging: &Judging,
) -> Result<Measurement, MeasureError> {
    Ok(Original::new(foliage, judging.clone())?.measure_lod(lod))
}

#[cfg(test)]
mod tests;
