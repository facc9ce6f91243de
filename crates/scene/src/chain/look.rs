//! How a level looks where it is seen, beside the original.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use secateur_eval::pictures::share_of_tight_frame;
use secateur_eval::{Judging, MeasureError, Pictures};
use secateur_gltf::{Detail, Document, GltfError};
use secateur_model::{BoundingSphere, Foliage, Surface};
use secateur_raster::{View, ViewSet};

use super::error::ChainError;
use super::level_surfaces::LevelSurfaces;
use super::options::{ChainOptions, Wanted};
use super::scene_look::{tight_cameras, walk_around};
use crate::Screen;
use crate::impostor::judge::Judge;

/// Pictures that levels are judged by have at most this many pixels a side, those of `measure`: to
/// draw larger ones would take longer than to make the level.
const MOST_PICTURE_PX: f64 = 256.0;

/// Levels for distances are judged by pictures of up to this many where the screen shows the plant so
/// large: of small pictures, FLIP does not see what is lost of single leaves and twigs.
const MOST_LARGE_PICTURE_PX: f64 = 1024.0;

/// What is this many times what is allowed, or less, or that many times, or more, is judged from every other
/// view: from side to side FLIP differs by less.
const PLAIN: [f64; 2] = [0.8, 1.25];

/// From how many views FLIP is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Enough {
    /// As many as tell on which side of a bound it is.
    ToDecide,
    /// All: what is put down should be near what `measure` says.
    AllViews,
}

/// Some of the views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    /// Views 0, 2, 4 and so on.
    Even,
    /// Views 1, 3, 5 and so on.
    Odd,
    /// The first, of which there is a picture that is larger than the usual ones: it takes longer than these
    /// together. What it shows is by how much FLIP is above that of the usual one of this view.
    First,
}

impl Part {
    fn of<T: Clone>(self, all: &[T]) -> Vec<T> {
        let (skipped, step) = match self {
            Self::Even => (0, 2),
            Self::Odd => (1, 2),
            Self::First => (0, usize::MAX),
        };
        all.iter().skip(skipped).step_by(step).cloned().collect()
    }
}

/// A level whose FLIP in the usual pictures is this many times what is allowed is beyond it in larger ones.
const HOPELESS: f64 = 1.1;

/// Least height of a picture in pixels: in fewer, FLIP has no room for its filters.
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
    /// FLIP of each view by the side of the pictures in pixels, as far as it is known.
    flips: RefCell<BTreeMap<(u32, Part), Vec<f64>>>,
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
    originals: RefCell<BTreeMap<(u32, Part), Pictures>>,
    /// Pixels a side of the largest pictures.
    most_picture_px: f64,
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
    /// By what FLIP over a picture is multiplied to be that over the frame of `measure`.
    frame_share: f64,
}

impl Look {
    /// The look of a plant of these items and leaves, drawn as the file has them; and the held-out
    /// views that its leaves are judged from.
    pub(super) fn new(
        document: &Document,
        items: &Foliage,
        leaves: &Foliage,
        options: &ChainOptions,
    ) -> Result<(Self, Judging), ChainError> {
        let (wanted, scene) = (&options.wanted, options.scene.as_ref());
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
            most_picture_px: match wanted {
                Wanted::Distances(_) => MOST_LARGE_PICTURE_PX,
                Wanted::Heights(_) | Wanted::Triangles(_) => MOST_PICTURE_PX,
            },
            views: [ViewSet::new(views)],
            is_of_scene,
            obstacles: obstacles.iter().cloned().map(Arc::new).collect(),
            low,
            sphere,
            height: high - low,
            picture_share: (high - low) / seen,
            frame_share: share_of_tight_frame(sphere, leaves.bounding_sphere().unwrap_or(sphere)),
        };
        Ok((look, judging))
    }

    /// Mean FLIP of a level, over the frame of `measure`, where the screen shows the plant at this height in pixels. Of a plant that
    /// is higher than the screen no more is seen at once than fills it. A level whose FLIP is above
    /// `most` by more than a tenth even in the usual pictures is not looked at in larger ones.
    /// What is plainly within it, or beyond, is judged from half of the views if that is `enough`.
    pub(super) fn flip(
        &self,
        drawn: &Drawn,
        (pixels_high, screen): (f64, Screen),
        most: f64,
        enough: Enough,
    ) -> f64 {
        let side = pixels_high.min(screen.height_px) / self.picture_share;
        let usual = side.clamp(LEAST_PICTURE_PX, MOST_PICTURE_PX).round() as u32;
        let mut of_usual = self.flips(drawn, usual, Part::Even);
        let seen = of_usual[0];
        let over = mean(&of_usual) / most;
        if enough == Enough::AllViews || (over > PLAIN[0] && over < PLAIN[1]) {
            of_usual.extend(self.flips(drawn, usual, Part::Odd));
        }
        let flip = mean(&of_usual);
        let Some(large) = large_side(side.min(self.most_picture_px)) else {
            return flip;
        };
        if flip > HOPELESS * most {
            return flip;
        }
        let of_large = mean(&self.flips(drawn, large, Part::First));
        match seen > 0.0 {
            true => flip * of_large / seen,
            // A level that is the tree differs in no picture.
            false => of_large,
        }
    }

    /// FLIP of some of the views of a level in pictures of this many pixels a side.
    fn flips(&self, drawn: &Drawn, side: u32, part: Part) -> Vec<f64> {
        let key = (side, part);
        if let Some(flips) = drawn.flips.borrow().get(&key) {
            return flips.clone();
        }
        let views = part.of(self.views[0].views());
        if views.is_empty() {
            return Vec::new();
        }
        let views = ViewSet::new(views);
        let mut originals = self.originals.borrow_mut();
        let original = originals
            .entry(key)
            .or_insert_with(|| self.pictures(&self.original, &views, side));
        let flips = original.flips(&self.pictures(&drawn.level.surfaces, &views, side));
        let flips: Vec<f64> = flips.into_iter().map(|f| f * self.frame_share).collect();
        drawn.flips.borrow_mut().insert(key, flips.clone());
        flips
    }

    /// Pictures of what is drawn among the obstacles.
    fn pictures(&self, surfaces: &[Surface], views: &ViewSet, side: u32) -> Pictures {
        let obstacles = self.obstacles.iter().map(Arc::as_ref);
        let all: Vec<&Surface> = surfaces.iter().chain(obstacles).collect();
        Pictures::of_size(&all, std::slice::from_ref(views), side)
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
        (judge.with_frame_share(self.frame_share)).among(self.obstacles.clone())
    }
}

/// Of a picture that shows as much as one of `side` pixels a side, larger than the usual ones: a power of
/// two, so that few originals are drawn; none where the usual ones do.
fn large_side(side: f64) -> Option<u32> {
    let doublings = (side / MOST_PICTURE_PX).log2().round();
    (doublings > 0.0).then(|| (MOST_PICTURE_PX * doublings.exp2()) as u32)
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

/// The same view with a field of view that just holds the plant: a picture of as many pixels shows more of
/// it.
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::{AlphaMode, Finish, Material};

    /// A square of 2 x 2 with `count` upright stripes, which cover half of it.
    fn stripes(count: u32) -> Surface {
        let corner = |k: u32, y: f64| DVec3::new(f64::from(k) / f64::from(count) - 1.0, y, 0.0);
        let quad = |k: u32| [(k, -1.0), (k + 1, -1.0), (k + 1, 1.0), (k, 1.0)];
        let corners = (0..count).flat_map(|k| quad(2 * k));
        Surface {
            positions: corners.map(|(k, y)| corner(k, y)).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: (0..count)
                .flat_map(|k| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| 4 * k + c)))
                .collect(),
            material: Arc::new(Material {
                name: String::new(),
                base_color: [0.1, 0.3, 0.1, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    fn look(most_picture_px: f64) -> Look {
        let eye = DVec3::Z * 3.0;
        let view = View::look_at(eye, DVec3::ZERO, DVec3::Y, 1.0 / 3.0, 0.01).unwrap();
        Look {
            original: vec![stripes(128)],
            originals: RefCell::default(),
            most_picture_px,
            views: [ViewSet::new(vec![view])],
            is_of_scene: false,
            obstacles: Vec::new(),
            low: -1.0,
            sphere: BoundingSphere {
                centre: DVec3::ZERO,
                radius: 2f64.sqrt(),
            },
            height: 2.0,
            picture_share: 1.0,
            frame_share: 1.0,
        }
    }

    /// Fewer stripes that are as much wider look the same from afar, but not where each is seen.
    #[test]
    fn what_is_seen_large_is_judged_in_large_pictures() {
        let level = || Drawn {
            level: LevelSurfaces {
                surfaces: vec![stripes(64)],
                materials: vec![None],
            },
            flips: RefCell::default(),
        };
        let screen = Screen::default();
        let flip = |most_px: f64, pixels_high: f64, most: f64| {
            look(most_px).flip(&level(), (pixels_high, screen), most, Enough::ToDecide)
        };
        let [small, large] = [256.0, 1024.0].map(|high| flip(1024.0, high, 1.0));
        assert!(large > 1.2 * small, "{large} over {small}");
        assert_eq!(flip(256.0, 1024.0, 1.0), small);
        // No more than a screen is seen at once, and what is beyond anyhow is not looked at closely.
        assert_eq!(flip(1024.0, 9999.0, 1.0), large);
        assert_eq!(flip(1024.0, 1024.0, 0.5 * small), small);
    }

    /// Where a level is plainly within, or beyond, half of the views decide; what is put down is of all.
    #[test]
    fn few_views_decide_where_it_is_plain() {
        let from =
            |x: f64| View::look_at(DVec3::new(x, 0.0, 3.0), DVec3::ZERO, DVec3::Y, 0.4, 0.01);
        let look = Look {
            views: [ViewSet::new([0.0, 2.5].map(|x| from(x).unwrap()).into())],
            ..look(256.0)
        };
        let drawn = Drawn {
            level: LevelSurfaces {
                surfaces: vec![stripes(64)],
                materials: vec![None],
            },
            flips: RefCell::default(),
        };
        let at = (128.0, Screen::default());
        let flip = |most: f64, enough| look.flip(&drawn, at, most, enough);
        let first = flip(1.0, Enough::ToDecide);
        assert_eq!(drawn.flips.borrow().len(), 1);
        let all = flip(1.0, Enough::AllViews);
        assert!(first != all);
        let decided = [1.0, 1.3 * first, 1.2 * first, 0.9 * first, 0.7 * first];
        let decided = decided.map(|most| flip(most, Enough::ToDecide));
        assert_eq!(decided, [first, first, all, all, first]);
    }

    #[test]
    fn larger_pictures_are_powers_of_two() {
        let sides = [48.0, 256.0, 300.0, 400.0, 700.0, 800.0, 1024.0].map(large_side);
        let large = [512, 512, 1024, 1024].map(Some);
        assert_eq!(sides[..3], [None; 3]);
        assert_eq!(sides[3..], large);
    }
}
