//! How a level looks where it is seen, beside the original.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use secateur_eval::{Judging, MeasureError, Pictures};
use secateur_gltf::{Detail, Document, GltfError};
use secateur_model::{BoundingSphere, Foliage, Surface};
use secateur_raster::{View, ViewSet};

use super::error::ChainError;
use super::level_surfaces::LevelSurfaces;
use super::scene_look::{SceneLook, tight_cameras, walk_around};
use crate::Screen;
use crate::impostor::judge::{self, Judge};

/// Pictures that levels are judged by have at most this many pixels a side, those of `measure`: to
/// draw larger ones would take longer than to make the level.
const MOST_PICTURE_PX: f64 = 256.0;

/// Least height of such a picture in pixels: in fewer, FLIP has no room for its filters.
const LEAST_PICTURE_PX: f64 = 48.0;

/// The tangent of half the field of view that just holds a sphere from 3 radii away: 1 / sqrt 8.
const TIGHT_TANGENT: f64 = 0.353_553_390_593_273_8;

/// Every how many of the 48 held-out views a level is judged from: six, of all four sets.
const VIEW_STEP: usize = 8;

/// Every how many of these its leaves are judged from: three.
const LEAF_VIEW_STEP: usize = 2;

/// What a level looks like, and how far that is from the original.
#[derive(Clone)]
pub(super) struct Drawn {
    pub(super) level: LevelSurfaces,
    /// Mean FLIP by the side of the pictures in pixels, as far as it is known.
    flips: RefCell<BTreeMap<u32, f64>>,
}

impl Drawn {
    /// All that is drawn of a file.
    pub(super) fn of(document: &Document) -> Result<Self, GltfError> {
        Ok(Self {
            level: surfaces(document)?,
            flips: RefCell::default(),
        })
    }
}

/// The original, and from where levels are held against it.
pub(super) struct Look {
    pub(super) original: Vec<Surface>,
    /// Pictures of that by their side in pixels: most heights need the same.
    originals: RefCell<BTreeMap<u32, Pictures>>,
    /// For pictures: one set of some of the held-out views, or of the cameras of a scene, each as
    /// narrow as holds the plant.
    pub(super) views: [ViewSet; 1],
    /// Whether these are the cameras of a scene.
    is_of_scene: bool,
    /// What of a scene is drawn with the plant.
    obstacles: Vec<Arc<Surface>>,
    /// Where the plant stands.
    low: f64,
    pub(super) sphere: BoundingSphere,
    /// The plant's height in units of the file.
    pub(super) height: f64,
    /// How much of a picture's height it takes, as a share of the side.
    picture_share: f64,
}

impl Look {
    /// The look of a plant of these items, drawn as the file has them; and the held-out views that
    /// its leaves are judged from.
    pub(super) fn new(
        document: &Document,
        items: &Foliage,
        scene: Option<&SceneLook>,
    ) -> Result<(Self, Judging), ChainError> {
        let sphere = items.bounding_sphere().ok_or(MeasureError::NoFoliage)?;
        // Not with exact textures, as `measure` has them: they would take three times as long, and in
        // so few pixels a leaf is off by a quarter of one at most.
        let held_out = ViewSet::held_out(sphere);
        let held_out = held_out.iter().flat_map(ViewSet::views);
        let held_out: Vec<View> = held_out.step_by(VIEW_STEP).copied().collect();
        let views: Vec<View> = held_out.iter().map(tight).collect();
        let judging = Judging {
            rigs: vec![ViewSet::new(
                held_out.into_iter().step_by(LEAF_VIEW_STEP).collect(),
            )],
            resolution: MOST_PICTURE_PX as u32,
        };
        let corners = items.triangles().iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c.y), high.max(c.y))
        });
        let cameras = scene.and_then(|scene| scene.cameras.as_ref());
        let cameras = cameras.map(|cameras| tight_cameras(cameras, sphere));
        let cameras = cameras.filter(|cameras| !cameras.is_empty());
        let is_of_scene = cameras.is_some();
        let views = cameras.unwrap_or(views);
        // What pictures show at the plant's middle, from one end to the other; held-out views
        // stand at 3 radii.
        let width = |view: &View| 2.0 * view.eye().distance(sphere.centre) * view.tan_half_fov();
        let seen = views.iter().map(width).sum::<f64>() / views.len() as f64;
        let obstacles = scene.map_or(&[][..], |scene| &scene.obstacles);
        let look = Self {
            original: surfaces(document)?.surfaces,
            originals: RefCell::default(),
            views: [ViewSet::new(views)],
            is_of_scene,
            obstacles: obstacles.iter().cloned().map(Arc::new).collect(),
            low,
            sphere,
            height: high - low,
            picture_share: (high - low) / seen,
        };
        Ok((look, judging))
    }

    /// Mean FLIP of a level where the screen shows the plant at this height in pixels.
    pub(super) fn flip(&self, drawn: &Drawn, pixels_high: f64) -> f64 {
        let side = (pixels_high / self.picture_share).clamp(LEAST_PICTURE_PX, MOST_PICTURE_PX);
        let side = side.round() as u32;
        if let Some(flip) = drawn.flips.borrow().get(&side) {
            return *flip;
        }
        let mut originals = self.originals.borrow_mut();
        let original = originals
            .entry(side)
            .or_insert_with(|| self.pictures(&self.original, side));
        let of_level = self.pictures(&drawn.level.surfaces, side);
        let flip = judge::flip(original, &of_level);
        drawn.flips.borrow_mut().insert(side, flip);
        flip
    }

    /// Pictures of what is drawn among the obstacles.
    fn pictures(&self, surfaces: &[Surface], side: u32) -> Pictures {
        let obstacles = self.obstacles.iter().map(Arc::as_ref);
        let all: Vec<&Surface> = surfaces.iter().chain(obstacles).collect();
        Pictures::of_size(&all, &self.views, side)
    }

    /// What judges impostors where the screen shows the plant at this height.
    pub(super) fn judge(&self, screen: Screen, pixels_high: f64) -> Judge {
        self.judge_from(&self.views[0], screen, pixels_high)
    }

    /// What judges switches there: the cameras of the scene, or eyes that walk around the plant.
    pub(super) fn judge_of_switches(&self, screen: Screen, pixels_high: f64) -> Judge {
        if self.is_of_scene {
            return self.judge(screen, pixels_high);
        }
        let distance = screen.distance(self.height, pixels_high);
        let distance = distance.max(Judge::LEAST_RADII * self.sphere.radius);
        let walk = walk_around(self.sphere, self.low, distance);
        self.judge_from(&ViewSet::new(walk), screen, pixels_high)
    }

    fn judge_from(&self, directions: &ViewSet, screen: Screen, pixels_high: f64) -> Judge {
        let judge = Judge::new(directions, self.sphere, self.height, screen, pixels_high);
        judge.among(self.obstacles.clone())
    }
}

/// The same view with a field of view that just holds the plant: what is far from it on the screen
/// is no part of how it looks.
fn tight(view: &View) -> View {
    let ahead = view.eye() + view.forward() * (view.near() * 1e3);
    let tight = View::look_at(view.eye(), ahead, view.up(), TIGHT_TANGENT, view.near());
    tight.unwrap_or(*view)
}

/// All that is drawn of a file.
fn surfaces(document: &Document) -> Result<LevelSurfaces, GltfError> {
    let drawn = document.drawn_as_one(Detail::Color)?;
    let materials = drawn.iter().map(|drawn| drawn.material).collect();
    let surfaces = drawn.into_iter().map(|drawn| drawn.surface).collect();
    Ok(LevelSurfaces {
        surfaces,
        materials,
    })
}
