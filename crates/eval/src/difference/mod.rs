//! How far a level looks from its plant at a height on the screen: the figure that levels are chosen by.
//!
//! 1. *What is drawn*: the plant alone. [Plants that stand apart](plants) are judged each by itself, and the worst
//!    one speaks.
//! 2. *Size*: as high as the screen shows the plant, longest side at most 1,024 pixels. *Views*: six
//!    ([`VIEWS`]; the first four while searching), perspective from 3 radii; none of them drives. Pixels are means
//!    of at least 2 x 2 samples, textures are read without mip maps, and each file's own cutoff tests alpha.
//! 3. *Backgrounds*: one drawing, composed by coverage in linear light on sRGB .92 and .08.
//! 4. *Mask U*: coverage of a tenth or more in either picture, grown by 2 pixels. *FLIP*: at 67 pixels a degree.
//! 5. *B* of a view: the [worst block](blocks) of mean FLIP over U. *M*: mean FLIP over U. Each on the worse
//!    background. *W*: as B over pixels whose front surface is wood, in blocks with a twentieth of wood. *C*: the
//!    largest relative difference of covered area in a block with a tenth of plant. Means over the views, W over the
//!    two that show most of it.
//! 6. **difference = max(B, 1.75 M, .45 W)**, with C as its companion `block_coverage`.
//!
//! B, M and C were found on 97 pairs of plants and levels that were graded by eye; W on the 52 of them that the test
//! `graded` prints.

mod blocks;
mod frame;
mod mask;
mod picture;
mod plants;

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;
use secateur_model::{BoundingSphere, Surface};
use secateur_raster::View;
use serde::Serialize;

use blocks::ViewScores;
use frame::{Eye, Frame, Samples};
use picture::{DrawnPlant, PlantPicture, draw};
use plants::Plants;

use crate::cut_mask::CutMasks;
use crate::surface_references::references;

/// Azimuth and elevation of the views in degrees: azimuth 0 is +z, 90 is +x.
const VIEWS: [[f64; 2]; 6] = [
    [25.0, 6.0],
    [145.0, 6.0],
    [265.0, 6.0],
    [85.0, 30.0],
    [205.0, 30.0],
    [325.0, 55.0],
];

/// The views while searching: one level, one level from another side, and both raised ones.
const SEARCH_VIEWS: [usize; 4] = [0, 3, 1, 5];

/// How many of these a glance takes: one level, one level from another side.
const GLANCE_VIEWS: usize = 2;

/// Where eyes stand, in radii of the plant's bounding sphere.
const RADII: f64 = 3.0;

/// By what the mean over the plant is multiplied to be held against its worst block.
const OF_MEAN: f64 = 1.75;

/// By what the worst block of wood is multiplied: boughs within a crown are few pixels, and everyone misses them.
const OF_WOOD: f64 = 0.45;

/// Of how many views, those that show most, the worst block of wood is the mean.
const WOOD_VIEWS: usize = 2;

/// After how many views a level may be given up: enough for what is far beyond the limits.
const FIRST_VIEWS: usize = 2;

/// What these views may show, as a multiple of the limits, before a level is given up: of plants of [`ALIKE_FROM_PX`] and
/// more, by ten plants whose levels it did not change; and of smaller ones, whose views differ more, by which a mean of four
/// views falls if the other two show nothing.
const SURELY_BEYOND: [f64; 2] = [1.3, 2.0];

/// The height in pixels from which on the views of one level are about alike.
const ALIKE_FROM_PX: f64 = 200.0;

pub(crate) use mask::judged_pixels;

/// max(B, 1.75 M) of one picture, of FLIP errors at the pixels that are judged, of a picture of this width and height.
pub(crate) fn of_picture(judged: &[u32], errors: &[f32], [width, height]: [usize; 2]) -> f64 {
    let side = (width.max(height) / 8).max(8);
    let columns = width.div_ceil(side);
    let block_of =
        |pixel: u32| pixel as usize / width / side * columns + pixel as usize % width / side;
    let count = columns * height.div_ceil(side);
    let least = blocks::LEAST_JUDGED;
    let [worst, mean] =
        blocks::worst_and_mean(least, (judged, errors), side as u32, count, block_of);
    worst.max(OF_MEAN * mean)
}

/// How far a level looks from its plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Difference {
    /// max(B, 1.75 M, .45 W), 0 to 1.75: the greater the worse.
    pub difference: f64,
    /// C: the largest relative difference of covered area in a block with a tenth of plant, 0 or more.
    pub block_coverage: f64,
    /// B: mean FLIP over the worst block, 0 to 1.
    pub worst_block: f64,
    /// M: mean FLIP over the plant's pixels, 0 to 1.
    pub mean: f64,
    /// W: mean FLIP over the wood of the worst block, of the two views that show most, 0 to 1; 0 where wood is not
    /// known.
    pub worst_wood: f64,
}

impl Difference {
    /// A level with a larger difference is another plant: coarser than for backgrounds.
    pub const ANOTHER_PLANT: f64 = 0.5;

    /// The mean over views.
    fn of_views(views: &[ViewScores]) -> Self {
        let mean = |of: fn(&ViewScores) -> f64| {
            views.iter().map(of).sum::<f64>() / views.len().max(1) as f64
        };
        let (worst_block, mean_flip) = (mean(|v| v.worst_block), mean(|v| v.mean));
        // A bough that is gone hides behind leaves from most sides.
        let mut woods: Vec<f64> = views.iter().map(|v| v.worst_wood).collect();
        woods.sort_by(|a, b| b.total_cmp(a));
        woods.truncate(WOOD_VIEWS);
        let worst_wood = woods.iter().sum::<f64>() / woods.len().max(1) as f64;
        Self {
            difference: Self::of_figures(worst_block, mean_flip, worst_wood),
            block_coverage: mean(|v| v.block_coverage),
            worst_block,
            mean: mean_flip,
            worst_wood,
        }
    }

    /// What this, of small pictures, would about be in pictures so many times as large.
    pub fn enlarged(self, times_as_large: f64, by: &Enlargement) -> Self {
        let [small, large] = &by.of_two_views;
        let power = match by.times_as_large > 1.0 {
            true => times_as_large.ln() / by.times_as_large.ln(),
            false => 0.0,
        };
        let figure = |of: fn(&Self) -> f64| match of(small) > 0.0 {
            true => of(&self) * (of(large) / of(small)).powf(power),
            false => of(&self).max(of(large)),
        };
        let (worst_block, mean) = (figure(|d| d.worst_block), figure(|d| d.mean));
        let worst_wood = figure(|d| d.worst_wood);
        Self {
            difference: Self::of_figures(worst_block, mean, worst_wood),
            block_coverage: figure(|d| d.block_coverage),
            worst_block,
            mean,
            worst_wood,
        }
    }

    fn of_figures(worst_block: f64, mean: f64, worst_wood: f64) -> f64 {
        worst_block.max(OF_MEAN * mean).max(OF_WOOD * worst_wood)
    }

    /// Each figure the larger one.
    fn worse(self, other: Self) -> Self {
        Self {
            difference: self.difference.max(other.difference),
            block_coverage: self.block_coverage.max(other.block_coverage),
            worst_block: self.worst_block.max(other.worst_block),
            mean: self.mean.max(other.mean),
            worst_wood: self.worst_wood.max(other.worst_wood),
        }
    }

    /// How many times the limits this is: above 1 it is beyond one of them.
    pub fn over(&self, limits: Limits) -> f64 {
        let of_difference = self.difference / limits.difference;
        of_difference.max(self.block_coverage / limits.block_coverage)
    }
}

/// By how much more of a level's difference large pictures show than small ones, as far as two views tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enlargement {
    /// Of small pictures, and of large ones.
    of_two_views: [Difference; 2],
    times_as_large: f64,
}

impl Enlargement {
    /// How many times as far beyond the limits the level is in the large pictures; nothing where that is no number above
    /// 0.
    pub fn times(&self, limits: Limits) -> Option<f64> {
        let [small, large] = self.of_two_views.map(|difference| difference.over(limits));
        let times = large / small;
        (times.is_finite() && times > 0.0).then_some(times)
    }
}

/// How much a level may differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// The largest [`Difference::difference`].
    pub difference: f64,
    /// The largest [`Difference::block_coverage`].
    pub block_coverage: f64,
}

impl Limits {
    /// .28 with .20: of 97 graded pairs all that cannot be told, 18 of 22 that are hard to tell, and none that is
    /// plainly coarser.
    pub const GOOD: Self = Self::of_difference(0.28);

    /// A difference with its share of coverage: .20 for .28, and as much more or less for others.
    pub const fn of_difference(difference: f64) -> Self {
        Self {
            difference,
            block_coverage: difference * (0.20 / 0.28),
        }
    }
}

/// From how many views a level is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ViewCount {
    /// Two, to learn how much more large pictures show.
    Glance,
    /// Four, while searching.
    Search,
    /// All: what is printed.
    All,
}

/// A plant, from where its levels are judged, and what was drawn of it.
#[derive(Debug)]
pub struct DifferenceJudge {
    plants: Plants,
    occluders: Vec<Arc<Surface>>,
    /// Cameras of a scene in place of [`VIEWS`].
    cameras: Option<Vec<View>>,
    turns_normals: bool,
    samples: Samples,
    /// Pictures of the plants at the heights that were asked for last, the latest first.
    drawn: Mutex<Vec<DrawnAt>>,
    /// Of the textures of the plants, and of the level that was looked at last.
    masks: CutMasks,
}

/// Pictures of the plants are kept of the heights that were asked for last, as long as squares of these sides have no
/// more pixels: all heights of a default chain, as a search comes back to the largest when it is known where its level
/// ends.
const MOST_KEPT_SQUARE_PX: f64 = 2.0 * 1024.0 * 1024.0;

/// Larger pictures are kept of a few plants only: one takes up to 60 MB, and there are six of each plant.
const MOST_KEPT_PX: f64 = 400.0;
const MOST_PLANTS_KEPT: usize = 2;

/// The pictures of the plants at a height in pixels, by plant and view.
#[derive(Debug)]
struct DrawnAt {
    pixels_high: f64,
    pictures: BTreeMap<(usize, usize), Arc<(Frame, PlantPicture)>>,
}

impl DifferenceJudge {
    /// The judge of a plant of these surfaces, of which `is_wood` says which are wood (none, where that is not
    /// known).
    pub fn new(original: Vec<Surface>, is_wood: &[bool]) -> Self {
        Self::of_plants(Plants::of(original, is_wood))
    }

    /// As [`new`](Self::new), but all of it is one plant, such as a hedge, though parts of it stand apart.
    pub fn of_one_plant(original: Vec<Surface>, is_wood: &[bool]) -> Self {
        Self::of_plants(Plants::as_one(original, is_wood))
    }

    fn of_plants(plants: Plants) -> Self {
        Self {
            plants,
            occluders: Vec::new(),
            cameras: None,
            turns_normals: false,
            samples: Samples::default(),
            drawn: Mutex::default(),
            masks: CutMasks::default(),
        }
    }

    /// This judge with the normals of double-sided materials turned to the viewer as glTF asks clients to: for
    /// impostors, whose normals are those that a client would see.
    #[must_use]
    pub fn with_turned_normals(mut self) -> Self {
        self.turns_normals = true;
        self
    }

    /// This judge with pictures of hardly more samples than pixels need: for a first look, in a third of the time where
    /// they are small.
    #[must_use]
    pub fn with_coarse_samples(mut self) -> Self {
        self.samples = Samples::Coarse;
        self
    }

    /// This judge, looking from the cameras of a scene, each as narrow as holds the plant, behind what stands before it.
    #[must_use]
    pub fn in_scene(mut self, cameras: Option<Vec<View>>, occluders: Vec<Arc<Surface>>) -> Self {
        self.cameras = cameras.filter(|cameras| !cameras.is_empty());
        self.occluders = occluders;
        self
    }

    /// How many plants stand apart.
    pub fn plant_count(&self) -> usize {
        self.plants.len()
    }

    /// The number of the plant that stands at a point in world space, from 0 to one less than
    /// [`plant_count`](Self::plant_count).
    pub fn plant_at(&self, point: DVec3) -> usize {
        self.plants.at(point)
    }

    /// The largest extent of the largest plant along an axis, in world units: what is `pixels_high` on the screen.
    pub fn size(&self) -> f64 {
        self.plants.size()
    }

    /// How many pixels the plants cover together where the screen shows [size](Self::size) as `pixels_high` pixels: the
    /// mean over the views of a search.
    pub fn covered_px(&self, pixels_high: f64) -> f64 {
        let of_plant = |plant: usize| {
            let eyes = self.eyes(self.plants.sphere(plant), ViewCount::Search);
            let covered = |eye: &Eye| self.picture(plant, eye, pixels_high).1.covered_px();
            eyes.iter().map(covered).sum::<f64>() / eyes.len().max(1) as f64
        };
        (0..self.plants.len()).map(of_plant).sum()
    }

    /// How far a level looks from the plant where the screen shows the plant's [size](Self::size) as
    /// `pixels_high` pixels.
    pub fn difference(&self, level: &[Surface], pixels_high: f64, count: ViewCount) -> Difference {
        let no_limit = Limits::of_difference(f64::INFINITY);
        self.difference_within(level, pixels_high, count, no_limit)
    }

    /// [`difference`](Self::difference), but from no more views once it is as good as certain that the level is
    /// beyond the limits; the figures are then of the views that were looked from.
    pub fn difference_within(
        &self,
        level: &[Surface],
        pixels_high: f64,
        count: ViewCount,
        limits: Limits,
    ) -> Difference {
        let how = (pixels_high, count);
        if self.plants.len() == 1 {
            let whole = |_: usize, _: DVec3| level.iter().collect::<Vec<_>>();
            return self.judged(&whole, how, limits);
        }
        let parts = self.plants.parts(level);
        let part = |plant: usize, _: DVec3| parts[plant].iter().collect::<Vec<_>>();
        self.judged(&part, how, limits)
    }

    /// By how much more two views show of a level's difference in large pictures than in small ones, by how high the
    /// plant is in both in pixels.
    pub fn enlargement(&self, level: &[Surface], [small_px, large_px]: [f64; 2]) -> Enlargement {
        let at = |px: f64| self.difference(level, px, ViewCount::Glance);
        Enlargement {
            of_two_views: [small_px, large_px].map(at),
            times_as_large: large_px / small_px,
        }
    }

    /// As [`difference_within`](Self::difference_within), of a level whose surfaces depend on where the eye stands.
    pub fn difference_of_seen(
        &self,
        seen: impl Fn(DVec3) -> Vec<Surface> + Sync,
        pixels_high: f64,
        count: ViewCount,
        limits: Limits,
    ) -> Difference {
        let how = (pixels_high, count);
        if self.plants.len() == 1 {
            return self.judged(&|_, eye| seen(eye), how, limits);
        }
        let part = |plant: usize, eye| self.plants.parts(&seen(eye)).swap_remove(plant);
        self.judged(&part, how, limits)
    }

    fn judged<S: Borrow<Surface> + Sync>(
        &self,
        seen: &(impl Fn(usize, DVec3) -> Vec<S> + Sync),
        (pixels_high, count): (f64, ViewCount),
        limits: Limits,
    ) -> Difference {
        let of_plant = |plant: usize| {
            let eyes = self.eyes(self.plants.sphere(plant), count);
            let mut views: Vec<ViewScores> = Vec::new();
            let scores = |eye: &Eye| {
                let drawn = self.picture(plant, eye, pixels_high);
                let (frame, original) = &*drawn;
                let surfaces = seen(plant, eye.at);
                let level = self.draw(&references(&surfaces), 0, frame);
                original.scores(&level, frame)
            };
            let (first, rest) = eyes.split_at(FIRST_VIEWS.min(eyes.len()));
            views.par_extend(first.par_iter().map(scores));
            let so_far = Difference::of_views(&views);
            let is_small = usize::from(pixels_high < ALIKE_FROM_PX);
            if rest.is_empty() || so_far.over(limits) > SURELY_BEYOND[is_small] {
                return so_far;
            }
            views.par_extend(rest.par_iter().map(scores));
            Difference::of_views(&views)
        };
        let mut worst = Difference::default();
        for plant in 0..self.plants.len() {
            worst = worst.worse(of_plant(plant));
            if worst.over(limits) > 1.0 && count == ViewCount::Search {
                break;
            }
        }
        worst
    }

    fn picture(&self, plant: usize, eye: &Eye, pixels_high: f64) -> Arc<(Frame, PlantPicture)> {
        let key = (plant, eye.number);
        if let Some(known) = self.kept(pixels_high, |pictures| pictures.get(&key).cloned()) {
            return known;
        }
        let (surfaces, wood) = self.plants.surfaces(plant);
        let px_per_unit = pixels_high / self.size();
        let surfaces = references(surfaces);
        let frame = Frame::around(&surfaces, eye, px_per_unit, self.samples);
        let drawn = self.draw(&surfaces, wood, &frame);
        let picture = PlantPicture::of(drawn);
        let made = Arc::new((frame, picture));
        if pixels_high > MOST_KEPT_PX && self.plants.len() > MOST_PLANTS_KEPT {
            return made;
        }
        self.kept(pixels_high, |pictures| {
            pictures.insert(key, Arc::clone(&made))
        });
        made
    }

    /// Looks at, or adds to, the pictures of a height.
    fn kept<T>(
        &self,
        pixels_high: f64,
        with: impl FnOnce(&mut BTreeMap<(usize, usize), Arc<(Frame, PlantPicture)>>) -> T,
    ) -> T {
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        let place = drawn.iter().position(|at| at.pixels_high == pixels_high);
        let latest = match place {
            Some(place) => drawn.remove(place),
            None => DrawnAt {
                pixels_high,
                pictures: BTreeMap::new(),
            },
        };
        drawn.insert(0, latest);
        let mut square_px = 0.0;
        let is_kept = |at: &DrawnAt| {
            square_px += at.pixels_high.min(frame::MOST_SIDE_PX).powi(2);
            square_px <= MOST_KEPT_SQUARE_PX
        };
        let kept = drawn
            .iter()
            .map(is_kept)
            .take_while(|is_kept| *is_kept)
            .count();
        drawn.truncate(kept.max(1));
        with(&mut drawn[0].pictures)
    }

    fn draw(&self, surfaces: &[&Surface], wood: usize, frame: &Frame) -> DrawnPlant {
        let how = (self.turns_normals, &self.masks);
        draw(surfaces, wood, &self.occluders, frame, how)
    }

    fn eyes(&self, sphere: BoundingSphere, count: ViewCount) -> Vec<Eye> {
        let most = match count {
            ViewCount::Glance => GLANCE_VIEWS,
            ViewCount::Search | ViewCount::All => usize::MAX,
        };
        match &self.cameras {
            Some(cameras) => {
                let step = match count {
                    ViewCount::Glance | ViewCount::Search => {
                        cameras.len().div_ceil(SEARCH_VIEWS.len())
                    }
                    ViewCount::All => 1,
                };
                let cameras = cameras.iter().enumerate().step_by(step);
                cameras
                    .take(most)
                    .map(|(number, view)| Eye::of_camera(number, view, sphere))
                    .collect()
            }
            None => {
                let search = SEARCH_VIEWS.iter().copied();
                let rest = (0..VIEWS.len()).filter(|k| !SEARCH_VIEWS.contains(k));
                let numbers = match count {
                    ViewCount::Glance | ViewCount::Search => search.collect::<Vec<_>>(),
                    ViewCount::All => search.chain(rest).collect(),
                };
                numbers
                    .into_iter()
                    .take(most)
                    .map(|number| Eye::about(number, VIEWS[number], sphere, RADII))
                    .collect()
            }
        }
    }
}

#[cfg(test)]
mod tests;
