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
pub use scores::{Measurement, RigMeasurement, Scores};
use seen::SeenScene;
pub use seen::SeenView;

use glam::DVec3;
use secateur_model::{BoundingSphere, Foliage, Lod};
use secateur_raster::{MAX_RESOLUTION, MAX_TOTAL_PIXELS, Scene, View, ViewSet};

/// The sets of views that are at hand to judge by.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    serde::Serialize,
    serde::Deserialize,
)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JudgingViews {
    /// Four sets of 12, none near a view that drives: the mean over the four, and the worst.
    ///
    /// [`Judging::held_out`].
    #[default]
    HeldOut,
    /// The paper's one set of 12, each 11 degrees from a view that drives.
    ///
    /// [`Judging::icosahedron`].
    Icosahedron,
}

impl JudgingViews {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out",
            Self::Icosahedron => "icosahedron",
        }
    }

    /// These views about an original.
    ///
    /// # Errors
    /// [`MeasureError::NoFoliage`] if the original has no leaf.
    pub fn about(self, original: &Foliage) -> Result<Judging, MeasureError> {
        match self {
            Self::HeldOut => Judging::held_out(original),
            Self::Icosahedron => Judging::icosahedron(original),
        }
    }
}

/// From where, and how finely, one judges.
#[derive(Clone, Debug, PartialEq)]
pub struct Judging {
    /// Sets of cameras, the same for the original and the simplified foliage. Each is judged by
    /// itself: VMI is of the views of one set.
    pub rigs: Vec<ViewSet>,
    /// Image width and height in pixels, 1 to [`MAX_RESOLUTION`].
    pub resolution: u32,
}

impl Judging {
    /// Image side of [`held_out`](Self::held_out), in pixels.
    pub const RESOLUTION: u32 = 512;

    /// The held-out views: four icosahedra about the original's bounding sphere
    /// ([`ViewSet::held_out`]) at 512 x 512, with exact textures: else a card that is another
    /// triangle of the same picture would count as another outline.
    ///
    /// # Errors
    /// [`MeasureError::NoFoliage`] if the original has no leaf.
    pub fn held_out(original: &Foliage) -> Result<Self, MeasureError> {
        Ok(Self::usual(ViewSet::held_out(sphere_of(original)?).into()))
    }

    /// The paper's way (Entropy 2018, 20, 213, section 4.2): one icosahedron, near the views
    /// that drive; else as [`held_out`](Self::held_out).
    ///
    /// # Errors
    /// [`MeasureError::NoFoliage`] if the original has no leaf.
    pub fn icosahedron(original: &Foliage) -> Result<Self, MeasureError> {
        Ok(Self::usual(vec![ViewSet::icosahedron(sphere_of(
            original,
        )?)]))
    }

    fn usual(rigs: Vec<ViewSet>) -> Self {
        let exact = rigs.into_iter().map(ViewSet::with_exact_textures);
        Self {
            rigs: exact.collect(),
            resolution: Self::RESOLUTION,
        }
    }

    /// How many of these views, all about one centre, one of the judging views stands beside: in
    /// a direction from that centre less than half a degree away, however far off.
    pub fn views_that_judge(&self, driving: &ViewSet, centre: DVec3) -> usize {
        let direction = |view: &View| (view.eye() - centre).normalize_or_zero();
        let judges: Vec<DVec3> = self
            .rigs
            .iter()
            .flat_map(ViewSet::views)
            .map(direction)
            .collect();
        let is_judge = |view: &&View| {
            let own = direction(view);
            judges
                .iter()
                .any(|judge| own.dot(*judge) > COSINE_OF_THE_SAME)
        };
        driving.views().iter().filter(is_judge).count()
    }

    fn check(&self) -> Result<(), MeasureError> {
        if self.rigs.is_empty() || self.rigs.iter().any(ViewSet::is_empty) {
            return Err(MeasureError::NoView);
        }
        if !(1..=MAX_RESOLUTION).contains(&self.resolution) {
            return Err(MeasureError::Resolution(self.resolution));
        }
        let most_views = self.rigs.iter().map(ViewSet::len).max().unwrap_or(0);
        let pixels = u64::from(self.resolution).pow(2) * most_views as u64;
        if pixels > MAX_TOTAL_PIXELS {
            return Err(MeasureError::TooManyPixels(pixels));
        }
        Ok(())
    }
}

/// The cosine of half a degree: views nearer than that are one.
const COSINE_OF_THE_SAME: f64 = 0.999_962;

fn sphere_of(original: &Foliage) -> Result<BoundingSphere, MeasureError> {
    original.bounding_sphere().ok_or(MeasureError::NoFoliage)
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
    /// More pixels over all views of a set than can be counted.
    #[error("the views have {0} pixels, at most {MAX_TOTAL_PIXELS}: choose a lower resolution")]
    TooManyPixels(u64),
}

/// An original foliage, drawn once for any number of measurements against it.
#[derive(Clone, Debug)]
pub struct Original<'f> {
    foliage: &'f Foliage,
    judging: Judging,
    /// For each set of views.
    drawn: Vec<SeenScene>,
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
        let drawn = scenes(foliage, &all, &judging);
        let drawn = drawn.map(|scene| seen::draw(&scene)).collect();
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
        let scenes = scenes(foliage, lod, &self.judging);
        let seen = self.drawn.iter().zip(scenes);
        let seen: Vec<Vec<SeenView>> = seen
            .map(|(original, scene)| seen::compare(original, &seen::draw(&scene)))
            .collect();
        Measurement::of(&seen, self.judging.resolution)
    }
}

/// A scene for each set of views.
fn scenes<'a>(
    foliage: &'a Foliage,
    lod: &'a Lod,
    judging: &'a Judging,
) -> impl Iterator<Item = Scene<'a>> {
    judging.rigs.iter().map(move |views| Scene {
        foliage,
        lod,
        views,
        resolution: judging.resolution,
    })
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
