//! How far a simplified tree looks from its original, in plainly shaded,
//! textured pictures.
//!
//! Both are drawn by [`render`](crate::render()) from the views that judge; every
//! [`PictureMetric`] of [`PICTURE_METRICS`] is then a function of two pictures
//! of one view.

mod frame;
mod ssim;
mod whole;

use std::borrow::Borrow;
use std::sync::OnceLock;

use image::{RgbImage, RgbaImage};
use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::cut_mask::CutMasks;
use crate::flip::{FlipPicture, error_map};
use crate::measure::Direction;
use crate::render::draw;
use crate::surface_references::references;
use crate::visibility::AlphaFrom;
use crate::{Camera, RenderOptions};

pub use frame::share_of_tight_frame;
pub use whole::{WholeMeasurement, WholePictures};

/// A number that says how far a picture is from another.
#[derive(Clone, Copy, Debug)]
pub struct PictureMetric {
    /// Its name in reports.
    pub key: &'static str,
    /// Its name for readers.
    pub title: &'static str,
    /// The unit of its values; empty for a ratio.
    pub unit: &'static str,
    /// Which values are good.
    pub direction: Direction,
    /// Its value for the picture of an original and that of what it became.
    of: fn(Seen<'_>, Seen<'_>) -> f64,
}

/// A picture, and what FLIP sees of it.
#[derive(Clone, Copy)]
struct Seen<'a> {
    image: &'a RgbaImage,
    for_flip: &'a FlipPicture,
}

/// All metrics of pictures, in the order of reports.
pub const PICTURE_METRICS: &[PictureMetric] = &[SSIM, FLIP_MEAN];

/// Structural similarity (Wang et al. 2004), Gaussian window, on luma. -1 to 1.
pub const SSIM: PictureMetric = PictureMetric {
    key: "ssim",
    title: "SSIM",
    unit: "",
    direction: Direction::Higher,
    of: |original, other| ssim::ssim(original.image, other.image),
};

/// Mean of the FLIP error (Andersson et al. 2020) at its reference's default of
/// about 67 pixels a degree. 0 to 1. What is done to a picture for it is done once, however often it is
/// compared; the values are those of the reference implementation to 1e-6.
pub const FLIP_MEAN: PictureMetric = PictureMetric {
    key: "flip_mean",
    title: "FLIP",
    unit: "",
    direction: Direction::Lower,
    of: |original, other| original.for_flip.mean_error(other.for_flip),
};

/// [`FLIP_MEAN`] of two pictures.
///
/// # Panics
/// If the sizes differ or are zero.
pub fn flip_mean(original: &RgbaImage, other: &RgbaImage) -> f64 {
    FlipPicture::of(original).mean_error(&FlipPicture::of(other))
}

/// Where two pictures differ: the FLIP error of every pixel on the magma colour
/// map, from black (none) through purple and orange to pale yellow (1).
///
/// # Panics
/// If the sizes differ or are zero.
pub fn flip_map(original: &RgbaImage, other: &RgbaImage) -> RgbImage {
    error_map(original, other)
}

/// A value for each of [`PICTURE_METRICS`]. Serialises as a map from their keys.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureScores(Vec<f64>);

impl PictureScores {
    fn pooled<'s>(
        several: impl Iterator<Item = &'s Self> + Clone,
        pool: impl Fn(&PictureMetric, &[f64]) -> f64,
    ) -> Self {
        let of = |(index, metric): (usize, &PictureMetric)| {
            let values: Vec<f64> = several.clone().map(|scores| scores.0[index]).collect();
            pool(metric, &values)
        };
        Self(PICTURE_METRICS.iter().enumerate().map(of).collect())
    }

    fn mean<'s>(several: impl Iterator<Item = &'s Self> + Clone) -> Self {
        Self::pooled(several, |_, values| {
            values.iter().sum::<f64>() / values.len() as f64
        })
    }

    fn worst<'s>(several: impl Iterator<Item = &'s Self> + Clone) -> Self {
        Self::pooled(several, |metric, values| {
            let badness = |v: &f64| metric.direction.badness(*v);
            let worst = values
                .iter()
                .copied()
                .max_by(|a, b| badness(a).total_cmp(&badness(b)));
            worst.expect("at least one view")
        })
    }

    /// Every metric with its value, in the order of [`PICTURE_METRICS`].
    pub fn iter(&self) -> impl Iterator<Item = (&'static PictureMetric, f64)> + '_ {
        PICTURE_METRICS.iter().zip(self.0.iter().copied())
    }

    /// The value of the metric with this key, if there is such a metric.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.iter()
            .find_map(|(metric, value)| (metric.key == key).then_some(value))
    }
}

impl Serialize for PictureScores {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(PICTURE_METRICS.len()))?;
        for (metric, value) in self.iter() {
            map.serialize_entry(metric.key, &value)?;
        }
        map.end()
    }
}

#[cfg(feature = "cli")]
impl schemars::JsonSchema for PictureScores {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "PictureScores".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        crate::schema::of_metrics(PICTURE_METRICS.iter().map(|m| (m.key, m.title, m.unit)))
    }
}

/// How far a simplified tree looks from its original by one set of views. Serialises with the
/// overall scores at the top level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PictureRigMeasurement {
    /// Mean over the views of the set.
    #[serde(flatten)]
    pub overall: PictureScores,
    /// The worst view's value of each metric (not always the same view's).
    pub worst: PictureScores,
    /// Of each view alone, in the order of the view set.
    pub per_view: Vec<PictureScores>,
}

/// How far a simplified tree looks from its original. Serialises with the
/// overall scores at the top level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PictureMeasurement {
    /// Mean over the sets of views.
    #[serde(flatten)]
    pub overall: PictureScores,
    /// The worst set's value of each metric (not always the same set's); of one set alone its
    /// worst view's.
    pub worst: PictureScores,
    /// Of each view alone, set by set.
    pub per_view: Vec<PictureScores>,
    /// Each set by itself.
    pub rigs: Vec<PictureRigMeasurement>,
}

impl PictureMeasurement {
    /// Of the scores of each view of each set.
    fn of(scores: Vec<Vec<PictureScores>>) -> Self {
        let per_view = scores.concat();
        let rig = |per_view: Vec<PictureScores>| PictureRigMeasurement {
            overall: PictureScores::mean(per_view.iter()),
            worst: PictureScores::worst(per_view.iter()),
            per_view,
        };
        let rigs: Vec<PictureRigMeasurement> = scores.into_iter().map(rig).collect();
        Self {
            overall: PictureScores::mean(rigs.iter().map(|rig| &rig.overall)),
            worst: match &rigs[..] {
                [alone] => alone.worst.clone(),
                rigs => PictureScores::worst(rigs.iter().map(|rig| &rig.overall)),
            },
            per_view,
            rigs,
        }
    }
}

/// The pictures of one tree from the views that judge, set by set.
#[derive(Clone, Debug)]
pub struct Pictures {
    sets: Vec<Vec<RgbaImage>>,
    /// What FLIP sees of them, set after set, once they were compared.
    for_flip: OnceLock<Vec<FlipPicture>>,
}

impl Pictures {
    /// Image side in pixels, each the mean of 2 x 2 samples: the samples of
    /// [`Judging::RESOLUTION`](crate::Judging::RESOLUTION).
    pub const RESOLUTION: u32 = 256;

    /// Draws everything, wood and leaves, from every view of every set, without shadows.
    pub fn of<S: Borrow<Surface> + Sync>(surfaces: &[S], rigs: &[ViewSet]) -> Self {
        let surfaces = &references(surfaces)[..];
        Self::of_size(surfaces, rigs, Self::RESOLUTION)
    }

    /// Samples along a side: of smaller pictures each pixel is the mean of more, as far as the
    /// rasteriser goes. What is far off would else be judged by which leaf a sample happens to hit.
    const SAMPLES: u32 = 2 * Self::RESOLUTION;

    /// As [`Self::of`], of another number of pixels a side.
    pub fn of_size<S: Borrow<Surface> + Sync>(
        surfaces: &[S],
        rigs: &[ViewSet],
        resolution: u32,
    ) -> Self {
        let surfaces = &references(surfaces)[..];
        let options = Self::options(resolution);
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        let picture = |view: &View| draw(surfaces, &camera_of(view), &options, alpha).image;
        // Parallel over the views, as each has parts that are not.
        let of_rig = |rig: &ViewSet| rig.views().par_iter().map(picture).collect();
        Self::of_sets(rigs.iter().map(of_rig).collect())
    }

    fn of_sets(sets: Vec<Vec<RgbaImage>>) -> Self {
        Self {
            sets,
            for_flip: OnceLock::new(),
        }
    }

    /// As [`Self::of_size`], of surfaces that may be others for each view, with the normals of
    /// double-sided materials turned to the viewer as glTF asks clients to: the judge of impostors,
    /// whose normals are those that a client would see.
    pub fn of_seen<S: Borrow<Surface> + Sync>(
        surfaces: impl Fn(&View) -> Vec<S> + Sync,
        views: &ViewSet,
        resolution: u32,
    ) -> Self {
        let options = RenderOptions {
            turns_normals: true,
            ..Self::options(resolution)
        };
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        let picture = |view: &View| {
            let surfaces = surfaces(view);
            draw(&references(&surfaces), &camera_of(view), &options, alpha).image
        };
        // Parallel over the views, as each has parts that are not.
        Self::of_sets(vec![views.views().par_iter().map(picture).collect()])
    }

    /// Pictures have at least one pixel.
    fn options(resolution: u32) -> RenderOptions {
        let resolution = resolution.max(1);
        RenderOptions {
            width: resolution,
            height: resolution,
            samples: (Self::SAMPLES / resolution).clamp(2, 8),
            shadows: false,
            turns_normals: false,
        }
    }

    /// The pictures, set after set.
    pub fn images(&self) -> impl Iterator<Item = &RgbaImage> {
        self.sets.iter().flatten()
    }

    /// [`FLIP_MEAN`] of each view of a simplified tree against these of its original, set after set:
    /// where the other metrics are not needed.
    ///
    /// # Panics
    /// If the views differ in number.
    pub fn flips(&self, simplified: &Self) -> Vec<f64> {
        let [ours, theirs] = [self, simplified].map(Self::for_flip);
        assert_eq!(ours.len(), theirs.len(), "the same views");
        let pairs = ours.par_iter().zip(theirs);
        pairs.map(|(a, b)| a.mean_error(b)).collect()
    }

    fn for_flip(&self) -> &[FlipPicture] {
        if let Some(known) = self.for_flip.get() {
            return known;
        }
        // Not within the lock: a thread that waits for the others may come by here again.
        let images: Vec<&RgbaImage> = self.images().collect();
        let made = images.into_par_iter().map(FlipPicture::of).collect();
        self.for_flip.get_or_init(|| made)
    }

    /// Measures pictures of a simplified tree against these of its original.
    ///
    /// # Panics
    /// If the views differ in number or a set has none.
    pub fn measure(&self, simplified: &Self) -> PictureMeasurement {
        assert_eq!(
            self.sets.len(),
            simplified.sets.len(),
            "the same sets of views"
        );
        assert!(!self.sets.is_empty(), "at least one set");
        let of_pair = |((image, for_flip), other): ((&RgbaImage, &FlipPicture), &RgbaImage)| {
            let original = Seen { image, for_flip };
            // Dropped again: it takes five times the memory of the picture.
            let for_flip = &FlipPicture::of(other);
            let other = Seen {
                image: other,
                for_flip,
            };
            let scores = PICTURE_METRICS
                .iter()
                .map(|metric| (metric.of)(original, other));
            PictureScores(scores.collect())
        };
        let mut for_flip = self.for_flip();
        let mut of_rig = |(a, b): (&Vec<RgbaImage>, &Vec<RgbaImage>)| {
            assert_eq!(a.len(), b.len(), "the same views");
            assert!(!a.is_empty(), "at least one view");
            let (of_set, of_others) = for_flip.split_at(a.len());
            for_flip = of_others;
            a.par_iter().zip(of_set).zip(b).map(of_pair).collect()
        };
        let sets = self.sets.iter().zip(&simplified.sets);
        PictureMeasurement::of(sets.map(&mut of_rig).collect())
    }
}

/// The camera of a view that judges. Its target is where the picture's near
/// plane becomes that of the view.
pub(crate) fn camera_of(view: &View) -> Camera {
    Camera {
        eye: view.eye(),
        target: view.eye() + view.forward() * 1e3 * view.near(),
        up: view.up(),
        fov_y_rad: 2.0 * view.tan_half_fov().atan(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn flat(color: [u8; 3]) -> RgbaImage {
        let [r, g, b] = color;
        RgbaImage::from_pixel(64, 64, Rgba([r, g, b, 255]))
    }

    /// FLIP is 1 for black against white: the greatest colour difference, and
    /// the feature term only raises it.
    #[test]
    fn flip_is_0_for_equal_pictures_and_1_for_black_on_white() {
        let of = flip_mean;
        let (black, white) = (flat([0; 3]), flat([255; 3]));
        assert_eq!(of(&white, &white), 0.0);
        let most = of(&black, &white);
        assert!((0.9..=1.0).contains(&most), "{most}");
        let little = of(&flat([100; 3]), &flat([104; 3]));
        assert!(little > 0.0 && little < 0.1, "{little}");
    }

    /// Black where nothing changed, bright where black became white; the picture
    /// keeps its orientation.
    #[test]
    fn a_difference_is_bright_where_pictures_differ() {
        let original = flat([0; 3]);
        let mut other = original.clone();
        for (x, y) in (0..32).flat_map(|x| (0..16).map(move |y| (x, y))) {
            other.put_pixel(x, y, Rgba([255; 4]));
        }
        let shown = flip_map(&original, &other);
        let light = |x, y| {
            shown
                .get_pixel(x, y)
                .0
                .iter()
                .map(|b| u32::from(*b))
                .sum::<u32>()
        };
        assert_eq!(shown.dimensions(), (64, 64));
        assert!(light(60, 60) < 20, "{}", light(60, 60));
        assert!(light(10, 5) > 400, "{}", light(10, 5));
        assert!(light(5, 40) < 20, "{}", light(5, 40));
    }

    #[test]
    fn the_worst_view_stands_beside_the_mean() {
        let grey = |v| flat([v; 3]);
        let original = Pictures::of_sets(vec![vec![grey(100), grey(100)]]);
        let simplified = Pictures::of_sets(vec![vec![grey(100), grey(200)]]);
        let found = original.measure(&simplified);
        let ssim = |scores: &PictureScores| scores.get("ssim").unwrap();
        assert!((ssim(&found.worst) - 0.800_026).abs() < 1e-5);
        assert!((ssim(&found.overall) - 0.900_013).abs() < 1e-5);
        assert_eq!(found.per_view[0].get("flip_mean"), Some(0.0));
        let flips = found.per_view.iter().map(|v| v.get("flip_mean").unwrap());
        assert_eq!(original.flips(&simplified), flips.collect::<Vec<_>>());
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!(json["per_view"][0]["ssim"], 1.0);
    }

    /// One set looks the same, of the other one view of two: the mean is of the sets' means, the
    /// worst is a set, and each set has its own worst view.
    #[test]
    fn sets_of_views_are_judged_one_by_one() {
        let grey = |v| flat([v; 3]);
        let original = Pictures::of_sets(vec![vec![grey(100)], vec![grey(100), grey(100)]]);
        let simplified = Pictures::of_sets(vec![vec![grey(100)], vec![grey(100), grey(200)]]);
        let found = original.measure(&simplified);
        let ssim = |scores: &PictureScores| scores.get("ssim").unwrap();
        assert!((ssim(&found.overall) - 0.95).abs() < 1e-3);
        assert_eq!(found.worst, found.rigs[1].overall);
        assert!((ssim(&found.rigs[1].worst) - 0.8).abs() < 1e-3);
        assert_eq!(found.per_view.len(), 3);
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!(json["rigs"][0]["flip_mean"], 0.0);
        assert_eq!(json["rigs"][1]["per_view"][0]["ssim"], 1.0);
    }

    /// The middle of the view is the middle of the picture, and a surface at an
    /// edge of the frustum touches the edge.
    #[test]
    fn pictures_are_taken_from_the_views_that_judge() {
        use glam::DVec3;
        let view = View::look_at(DVec3::Z * 2.0, DVec3::ZERO, DVec3::Y, 0.5, 0.1).unwrap();
        let camera = camera_of(&view);
        assert!(((0.5 * camera.fov_y_rad).tan() - 0.5).abs() < 1e-12);
        assert!((camera.target - camera.eye).normalize().distance(-DVec3::Z) < 1e-12);
        assert_eq!(camera.up, DVec3::Y);
    }
}
