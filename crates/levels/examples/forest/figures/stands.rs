//! Stands in pictures: each method beside full geometry.

use image::RgbaImage;
use secateur_eval::pictures::flip_mean;
use secateur_runtime::stand::{LeavesByHeight, StandCamera};

use super::{Figures, Frames, LARGE, SMALL, stand};
use crate::clock::timed;
use crate::methods::{Method, RULE};
use crate::placing;

/// Trees in the large picture.
const TREES: usize = 2000;

/// How many frames of each method count: the number in the environment's `FRAMES`, 1 without. One more before them
/// makes what they find ready. Full geometry, whose frames take up to a hundred times as long, has one.
fn frames_that_count() -> usize {
    let asked = std::env::var("FRAMES").map(|n| n.parse().expect("FRAMES is a number"));
    asked.unwrap_or(1).max(1)
}

/// What [`RULE`] could be instead, in leaves for each pixel of a square as high as the tree.
const OTHER_RULES: [f64; 3] = [0.25, 0.5, 0.8];

/// Of Hybrid's Table 1, which goes on with 1,500 and 2,000.
const COUNTS: [usize; 4] = [100, 250, 500, 1000];

/// Places on the circle around a stand; full geometry is drawn at the first one only.
const PLACES: usize = 3;

/// How a stand is drawn, and what that took.
struct Shown {
    case: String,
    method: Method,
    rule: LeavesByHeight,
    frames: Frames,
    calls: usize,
    picture: RgbaImage,
}

impl Figures<'_> {
    /// 2,000 trees from low before them.
    pub(super) fn stand(&mut self) {
        let camera = placing::overlook(TREES, self.species.sphere.radius, LARGE);
        self.by_each_method("stand", &camera);
    }

    /// 2,000 trees from higher up, where they fill more of the picture.
    pub(super) fn above(&mut self) {
        let camera = placing::from_above(TREES, self.species.sphere.radius, LARGE);
        self.by_each_method("above", &camera);
    }

    fn by_each_method(&mut self, part: &str, camera: &StandCamera) {
        let methods = [
            Method::Full,
            Method::Chain,
            Method::Continuous,
            Method::Spheres,
            Method::Boxes,
            Method::Mix,
        ];
        let shown = |method: Method, rule: LeavesByHeight, case: String| Shown {
            case: format!("{part}: {TREES} trees, {case}"),
            method,
            rule,
            frames: Frames::default(),
            calls: 0,
            picture: RgbaImage::default(),
        };
        let mut all: Vec<Shown> = methods
            .map(|method| shown(method, RULE, method.name().to_owned()))
            .into();
        all.extend(OTHER_RULES.map(|leaves_a_px2| {
            let rule = LeavesByHeight {
                leaves_a_px2,
                ..RULE
            };
            let case = format!("continuous, {leaves_a_px2} leaves a pixel");
            shown(Method::Continuous, rule, case)
        }));
        self.draw_in_turns(&mut all, camera);
        let full = &all[0];
        for shown in &all {
            self.note_frames(&shown.case, &shown.frames);
            self.note(&shown.case, "draw calls", "", shown.calls as f64);
            let flip = flip_mean(&full.picture, &shown.picture);
            self.note(&shown.case, "FLIP against full geometry", "", flip);
            self.note_ratios(&shown.case, &shown.frames, &full.frames);
            keep(shown);
        }
    }

    fn draw_in_turns(&self, all: &mut [Shown], camera: &StandCamera) {
        let instances = self.instances(TREES);
        let mut stand = stand(self, &instances);
        let renderer = self.renderer(LARGE);
        for round in 0..=frames_that_count() {
            for shown in &mut *all {
                if shown.method == Method::Full && round != 1 {
                    continue;
                }
                stand.rule = shown.rule;
                let (drawn, seconds) = timed(|| {
                    let list = stand.frame(shown.method, camera, camera.eye);
                    renderer.draw(&list, camera)
                });
                if round == 0 {
                    shown.picture = renderer.picture();
                    continue;
                }
                if shown.method == Method::Full {
                    shown.picture = renderer.picture();
                }
                shown.frames.add(drawn.triangles, seconds);
                shown.calls = drawn.calls;
            }
        }
    }

    /// Frames around a stand, for numbers of trees (VDF's Fig. 9, Hybrid's Table 1).
    pub(super) fn counts(&mut self) {
        let methods = [
            Method::Full,
            Method::Continuous,
            Method::Spheres,
            Method::Boxes,
            Method::Mix,
        ];
        let radius = self.species.sphere.radius;
        for count in COUNTS {
            let instances = self.instances(count);
            let mut stand = stand(self, &instances);
            let renderer = self.renderer(SMALL);
            let mut all = methods.map(|method| (method, Frames::default()));
            let mut rates = [[f64::INFINITY, 0.0f64]; 5];
            for place in 0..PLACES {
                let share = place as f64 / PLACES as f64;
                let camera = placing::around(count, radius, share, SMALL);
                for ((method, frames), rate) in all.iter_mut().zip(&mut rates) {
                    if *method == Method::Full && place > 0 {
                        continue;
                    }
                    let (drawn, seconds) = timed(|| {
                        let list = stand.frame(*method, &camera, camera.eye);
                        renderer.draw(&list, &camera)
                    });
                    frames.add(drawn.triangles, seconds);
                    let a_second = 1.0 / seconds.wall;
                    *rate = [rate[0].min(a_second), rate[1].max(a_second)];
                }
            }
            for ((method, frames), rate) in all.iter().zip(&rates) {
                let case = format!("counts: {count} trees, {}", method.name());
                self.note_frames(&case, frames);
                self.note(&case, "least frame rate", "1/s", rate[0]);
                self.note(&case, "most frame rate", "1/s", rate[1]);
                self.note_ratios(&case, frames, &all[0].1);
            }
        }
    }
}

/// Leaves the picture in the folder for temporary files, to look at.
fn keep(shown: &Shown) {
    let name: String = shown
        .case
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let path = std::env::temp_dir().join(format!("secateur_forest_{name}.png"));
    match shown.picture.save(&path) {
        Ok(()) => eprintln!("{}", path.display()),
        Err(error) => eprintln!("{}: {error}", path.display()),
    }
}
