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
//!    background. *W*: as B over pixels whose front surface is wood, in blocks with a twentieth of wood, or over
//!    [spots](spots) of another colour. *C*: the largest relative difference of covered area in a block with a tenth
//!    of plant. Means over the views, W over the two that show most of it.
//! 6. **difference = max(B, 1.75 M, .45 W)**, with C as its companion `block_coverage`.
//!
//! B, M and C were found on 97 pairs of plants and levels that were graded by eye; W on the 52 of them that the test
//! `graded` prints.

mod blocks;
mod figures;
mod frame;
mod mask;
mod picture;
mod plants;
mod spots;

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;
use secateur_model::{BoundingSphere, Surface};
use secateur_raster::View;

use blocks::ViewScores;
use figures::OF_MEAN;
pub use figures::{Difference, Enlargement, Limits};
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

/// What is thinner than a pixel covers less than this of the pixels that it touches, in the mean. Of public plants,
/// 16 pixels high, bare trees cover .33 to .44, sparse grass .39, bushes of thin leaves .51, solid ones .56 and more.
const MOST_OF_THIN: f64 = 0.5;

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
    let (worst, mean) =
        blocks::worst_and_mean(least, (judged, errors), side as u32, count, block_of);
    worst.unwrap_or(mean).max(OF_MEAN * mean)
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

    /// Whether nearly all that the plants show is thinner than a pixel, twigs or blades, where the screen shows
    /// [size](Self::size) as `pixels_high` pixels.
    pub fn is_thin(&self, pixels_high: f64) -> bool {
        let (mut covered, mut touched) = (0.0, 0.0);
        for plant in 0..self.plants.len() {
            for eye in self.eyes(self.plants.sphere(plant), ViewCount::Search) {
                let drawn = self.picture(plant, &eye, pixels_high);
                covered += drawn.1.covered_px();
                touched += drawn.1.touched_px();
            }
        }
        covered < MOST_OF_THIN * touched
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

    /// The difference of a level from two views, where the plant is `small_px` and `large_px` high, in pixels.
    pub fn enlargement(&self, level: &[Surface], small_px: f64, large_px: f64) -> Enlargement {
        let at = |px: f64| self.difference(level, px, ViewCount::Glance);
        Enlargement {
            small: at(small_px),
            large: at(large_px),
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
