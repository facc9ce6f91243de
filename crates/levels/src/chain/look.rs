//! How a level looks where it is seen, beside the original.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use glam::DVec3;
use secateur_eval::pictures::share_of_tight_frame;
use secateur_eval::{
    Difference, DifferenceJudge, Enlargement, Judging, Limits, MeasureError, Pictures, ViewCount,
};
use secateur_gltf::{Detail, Document, GltfError, WholeTree};
use secateur_model::{BoundingSphere, Note, Surface};
use secateur_raster::{View, ViewSet};

use super::error::ChainError;
use super::level::ChainLevel;
use super::level_surfaces::LevelSurfaces;
use super::options::ChainOptions;
use super::scene_look::tight_cameras;
use super::stage_clock::{ChainStage, StageClock};
use crate::impostor::Impostor;
use crate::impostor::judge::Judge;
use secateur_runtime::Screen;

/// Leaves are judged in pictures of this many pixels a side.
const LEAF_PICTURE_PX: u32 = 256;

/// The tangent of half the field of view that just holds a sphere from 3 radii away: 1 / sqrt 8.
const TIGHT_TANGENT: f64 = 0.353_553_390_593_273_8;

/// Every how many of the 48 held-out views FLIP of a level is taken from: six, of all four sets.
const VIEW_STEP: usize = 8;

/// Every how many of these its leaves are judged from: three.
const LEAF_VIEW_STEP: usize = 2;

/// A plant of fewer leaves, or none, is looked at as surfaces, not as a texture of leaves.
const FEW_LEAVES: usize = 50;

/// What of the limits cards may use where a plant is surfaces: torn ones are told at once. With the default this is
/// the difference that cannot be told, .18.
const SHARE_FOR_SURFACES: f64 = 0.18 / 0.28;

/// What twigs and blades that are thinner than a pixel may use: cards beyond it have gaps in their trunks.
const SHARE_FOR_TWIGS: f64 = 0.24 / 0.28;

/// What surfaces may use where they are small. Ten public plants 16 pixels high, within a difference of .22, were graded
/// 1.5 to 2.5; of another, within .24, a branch was half gone.
const SHARE_WHERE_SMALL: f64 = 0.22 / 0.28;

/// A plant is small up to this height in pixels. Of eight that were 32 pixels high, within a difference of .24, three had
/// gaps between cards.
const SMALL_PX: f64 = 20.0;

/// What a level looks like, and how far that is from the original.
#[derive(Clone)]
pub(super) struct Drawn {
    pub(super) level: LevelSurfaces,
    /// By height in pixels, as bits, how many times the limits the level is, as far as it is known; one for all that are
    /// equal.
    overs: Rc<RefCell<BTreeMap<u64, f64>>>,
}

impl Drawn {
    /// All that is drawn of a file.
    pub(super) fn of(document: &Document) -> Result<Self, GltfError> {
        Ok(Self {
            level: LevelSurfaces::of(document.drawn_as_one(Detail::Color)?),
            overs: Rc::default(),
        })
    }
}

/// The original, and from where levels are held against it.
pub(super) struct Look {
    pub(super) original: LevelSurfaces,
    judge: DifferenceJudge,
    /// The judge of impostors, whose normals are turned to the viewer.
    judge_of_impostors: OnceCell<DifferenceJudge>,
    /// Of the surfaces of the original, which are wood.
    is_wood: Vec<bool>,
    /// Whether all of the file is one plant.
    as_one: bool,
    /// How high the plant is at most in the pictures of a search, in pixels.
    search_px: f64,
    /// How far off levels are that are seen higher than this many pixels is estimated.
    exact_up_to_px: f64,
    /// How much levels may differ.
    pub(super) limits: Limits,
    /// Whether the plant has so few leaves, or none, that it is looked at as surfaces.
    has_few_leaves: bool,
    /// For FLIP over a frame and what clients draw: one set of some of the held-out views, or of the cameras of a
    /// scene, each as narrow as holds the plant.
    pub(super) views: [ViewSet; 1],
    /// The cameras of a scene, if there are any.
    cameras: Option<Vec<View>>,
    /// What of a scene is drawn with the plant.
    obstacles: Vec<Arc<Surface>>,
    pub(super) sphere: BoundingSphere,
    /// What the time of the chain goes to.
    pub(super) clock: StageClock,
    /// The largest extent of the largest plant in units of the file: what is so many pixels high.
    pub(super) size: f64,
    /// From the lowest to the highest point, in units of the file.
    pub(super) height: f64,
    /// Half of the larger side of the largest plant as seen from above, in units of the file.
    pub(super) reach: f64,
    /// By what FLIP over a picture is multiplied to be that over the frame of `measure`.
    frame_share: f64,
}

impl Look {
    /// The look of a plant, drawn as the file has it; and the held-out views that its leaves are judged from.
    pub(super) fn new(
        tree: &WholeTree,
        options: &ChainOptions,
        clock: StageClock,
    ) -> Result<(Self, Judging), ChainError> {
        let (items, leaves) = (tree.items().foliage(), tree.leaves());
        let (scene, work) = (options.scene.as_ref(), options.leaves.effort.work());
        let sphere = items.bounding_sphere().ok_or(MeasureError::NoFoliage)?;
        // Not with exact textures, as `measure` has them: they would take longer, and in
        // so few pixels a leaf is off by a quarter of one at most.
        let held_out = ViewSet::held_out(sphere);
        let held_out = held_out.iter().flat_map(ViewSet::views);
        let held_out: Vec<View> = held_out.step_by(VIEW_STEP).copied().collect();
        let views: Vec<View> = held_out.iter().map(tight).collect();
        let judging = Judging {
            rigs: vec![ViewSet::new(
                held_out.into_iter().step_by(LEAF_VIEW_STEP).collect(),
            )],
            resolution: LEAF_PICTURE_PX,
        };
        let corners = items.triangles().iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| {
            (low.min(c), high.max(c))
        });
        let extent = high - low;
        let cameras = scene.and_then(|scene| scene.cameras.as_ref());
        let cameras = cameras.map(|cameras| tight_cameras(cameras, sphere));
        let cameras = cameras.filter(|cameras| !cameras.is_empty());
        let obstacles = scene.map_or(&[][..], |scene| &scene.obstacles);
        let obstacles: Vec<Arc<Surface>> = obstacles.iter().cloned().map(Arc::new).collect();
        let drawn = tree.items().drawn(Detail::Color)?;
        let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
        let original = LevelSurfaces::of(drawn);
        let judge = judge_of(original.surfaces.clone(), &is_wood, options.as_one)
            .in_scene(cameras.clone(), obstacles.clone());
        let judge = match work.exact_up_to_px.is_finite() {
            true => judge.with_coarse_samples(),
            false => judge,
        };
        let size = judge.size();
        let look = Self {
            clock,
            size,
            judge,
            judge_of_impostors: OnceCell::new(),
            is_wood,
            as_one: options.as_one,
            search_px: work.search_px,
            exact_up_to_px: work.exact_up_to_px,
            limits: options.limits(),
            has_few_leaves: leaves.leaves().len() < FEW_LEAVES,
            original,
            views: [ViewSet::new(cameras.clone().unwrap_or(views))],
            cameras,
            obstacles,
            sphere,
            height: extent.y,
            reach: 0.5 * extent.x.max(extent.z).min(size),
            frame_share: share_of_tight_frame(sphere, leaves.bounding_sphere().unwrap_or(sphere)),
        };
        Ok((look, judging))
    }

    /// How many times the limits a level is, from few views and in pictures that are not large: to search by.
    pub(super) fn over_in_search(&self, drawn: &Drawn, pixels_high: f64) -> f64 {
        let pixels_high = pixels_high.min(self.search_px);
        let key = pixels_high.to_bits();
        if let Some(over) = drawn.overs.borrow().get(&key) {
            return *over;
        }
        let over = self.over_of_surfaces(&drawn.level.surfaces, pixels_high);
        drawn.overs.borrow_mut().insert(key, over);
        over
    }

    /// As [`Self::over_in_search`], of surfaces that are looked at once.
    pub(super) fn over_of_surfaces(&self, surfaces: &[Surface], pixels_high: f64) -> f64 {
        let (px, count) = (pixels_high.min(self.search_px), ViewCount::Search);
        let judge = || {
            self.judge
                .difference_within(surfaces, px, count, self.limits)
        };
        let difference = self.clock.time(ChainStage::Difference, judge);
        difference.over(self.limits)
    }

    /// How many times as far off a level is in pictures of its size as in those of a search, at a glance; nothing where
    /// that is no number.
    pub(super) fn times_in_search(&self, drawn: &Drawn, pixels_high: f64) -> Option<f64> {
        let by = self.enlargement(&drawn.level.surfaces, pixels_high);
        by.times(self.limits)
    }

    fn enlargement(&self, surfaces: &[Surface], pixels_high: f64) -> Enlargement {
        let small_px = pixels_high.min(self.search_px);
        let judge = || self.judge.enlargement(surfaces, small_px, pixels_high);
        self.clock.time(ChainStage::Difference, judge)
    }

    /// How far a level with its own textures looks from the original, as it is put down; of fewer views if it is
    /// beyond the limits, and about so if it is large and the effort asks for no more.
    pub(super) fn difference(&self, surfaces: &[Surface], pixels_high: f64) -> Difference {
        let all_views = |px: f64| {
            let (judge, count) = (&self.judge, ViewCount::All);
            let look = || judge.difference_within(surfaces, px, count, self.limits);
            self.clock.time(ChainStage::Difference, look)
        };
        if pixels_high <= self.exact_up_to_px.max(self.search_px) {
            return all_views(pixels_high);
        }
        let small = all_views(self.search_px);
        match small.over(self.limits) > 1.0 {
            true => small,
            false => small.enlarged(&self.enlargement(surfaces, pixels_high)),
        }
    }

    /// Says of levels whose difference is an estimate.
    pub(super) fn note_of_estimates(&self, levels: &[ChainLevel]) -> Option<Note> {
        let (exact_px, small_px) = (self.exact_up_to_px, self.search_px);
        let is_estimate = |level: &ChainLevel| level.report.pixels_high > exact_px;
        let note = || {
            format!(
                "differences of levels that begin above {exact_px} pixels are estimates, as little effort is asked for: from six views of at most {small_px} pixels with few samples, and two of full size"
            )
        };
        levels.iter().any(is_estimate).then(|| note().into())
    }

    /// How far one level looks from another that it takes the place of.
    pub(super) fn difference_of_switch(
        &self,
        before: &LevelPicture,
        after: &LevelPicture,
        pixels_high: f64,
    ) -> f64 {
        // The picture of an impostor depends on where the eye stands: it is held against the mesh.
        let (fixed, other) = match (before, after) {
            (LevelPicture::Mesh(mesh), other) | (other, LevelPicture::Mesh(mesh)) => {
                (mesh.surfaces.clone(), other)
            }
            (LevelPicture::Impostor(impostor), other) => (vec![impostor.surface.clone()], other),
        };
        let judge = judge_of(fixed, &[], self.as_one)
            .in_scene(self.cameras.clone(), self.obstacles.clone());
        let px = pixels_high * judge.size() / self.size;
        let no_limit = Limits::of_difference(f64::INFINITY);
        let count = ViewCount::Search;
        let difference = match other {
            LevelPicture::Mesh(mesh) => judge.difference(&mesh.surfaces, px, count),
            LevelPicture::Impostor(impostor) => judge.with_turned_normals().difference_of_seen(
                |eye| vec![impostor.seen_from(eye)],
                px,
                count,
                no_limit,
            ),
        };
        difference.difference
    }

    /// How many pixels the plant covers where the screen shows it at this height.
    pub(super) fn covered_px(&self, pixels_high: f64) -> f64 {
        let px = pixels_high.min(self.search_px);
        self.judge.covered_px(px) * (pixels_high / px).powi(2)
    }

    /// What of the limits impostors may use where the screen shows the plant at this height.
    pub(super) fn limits_of_impostors(&self, pixels_high: f64) -> Limits {
        let judge = self.judge_of_impostors();
        let share = match self.has_few_leaves {
            true if judge.is_thin(pixels_high.min(self.search_px)) => SHARE_FOR_TWIGS,
            true if pixels_high <= SMALL_PX => SHARE_WHERE_SMALL,
            true => SHARE_FOR_SURFACES,
            false => 1.0,
        };
        Limits {
            difference: share * self.limits.difference,
            block_coverage: share * self.limits.block_coverage,
        }
    }

    /// What tells the plants of the file apart, and judges levels of them.
    pub(super) fn judge(&self) -> &DifferenceJudge {
        &self.judge
    }

    /// What judges impostors.
    pub(super) fn judge_of_impostors(&self) -> &DifferenceJudge {
        self.judge_of_impostors.get_or_init(|| {
            judge_of(self.original.surfaces.clone(), &self.is_wood, self.as_one)
                .in_scene(self.cameras.clone(), self.obstacles.clone())
                .with_turned_normals()
        })
    }

    /// Mean FLIP over the frame of `measure`, where the screen shows the plant at this height.
    pub(super) fn flip_mean(
        &self,
        picture: &LevelPicture,
        (pixels_high, screen): (f64, Screen),
    ) -> f64 {
        let pixels_high = pixels_high.min(screen.height_px);
        let judge = Judge::new(&self.views[0], self.sphere, self.size, screen, pixels_high);
        let judge = judge.with_frame_share(self.frame_share);
        let judge = judge.among(self.obstacles.clone());
        let flip = |[original, level]: [Pictures; 2]| judge.flip(&original, &level);
        let original = &self.original.surfaces;
        match picture {
            LevelPicture::Mesh(level) => {
                flip([original, &level.surfaces].map(|surfaces| judge.of_mesh(surfaces)))
            }
            LevelPicture::Impostor(impostor) => {
                flip([judge.of_surfaces(original), judge.of_impostor(impostor)])
            }
        }
    }

    /// How many pixels high the plant's height is where its largest extent is so many.
    pub(super) fn of_height(&self, pixels_high: f64) -> f64 {
        pixels_high * self.height / self.size
    }
}

/// The judge of a file whose parts that stand apart are plants, or one.
fn judge_of(surfaces: Vec<Surface>, is_wood: &[bool], as_one: bool) -> DifferenceJudge {
    match as_one {
        true => DifferenceJudge::of_one_plant(surfaces, is_wood),
        false => DifferenceJudge::new(surfaces, is_wood),
    }
}

/// What represents a level in pictures.
pub(super) enum LevelPicture {
    Mesh(LevelSurfaces),
    Impostor(Impostor),
}

/// A view with a field of view that just holds the plant: a picture of as many pixels shows more of it.
fn tight(view: &View) -> View {
    let ahead = view.eye() + view.forward() * (view.near() * 1e3);
    let tight = View::look_at(view.eye(), ahead, view.up(), TIGHT_TANGENT, view.near());
    tight.unwrap_or(*view)
}
