//! Figures: one stand drawn by each method beside full geometry, and what others measured.

use glam::DVec3;
use secateur_eval::pictures::FLIP_MEAN;
use secateur_scene::stand::{Instance, StandCamera};
use secateur_scene::view_dependent::ViewDependent;

use crate::clock::{Seconds, timed};
use crate::gpu::Gpu;
use crate::methods::{Method, Scheme, Stand};
use crate::pipelines::Pipelines;
use crate::placing;
use crate::renderer::{FrameCost, Renderer};
use crate::rows::{Row, Rows, Wanted};
use crate::species::Species;
use crate::uploaded::Uploaded;

/// Of the picture that methods are compared by.
const LARGE: [u32; 2] = [1280, 720];

/// Width and height in pixels of the frames along a path.
const SMALL: [u32; 2] = [640, 360];

/// Hybrid's Table 1, without 750 and 1500.
const COUNTS: [usize; 5] = [100, 250, 500, 1000, 2000];

const STAND_SEED: u64 = 1;

/// Places on the circle, and of full geometry, whose frames take up to hundreds of times as long.
const PLACES: usize = 8;
const FULL_PLACES: usize = 1;

/// Steps of a path over which levels are seen to pop.
const POP_STEPS: usize = 24;

/// All that figures are taken with.
pub(crate) struct Figures<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pipelines: &'a Pipelines,
    pub(crate) species: &'a Species,
    pub(crate) uploaded: &'a Uploaded,
    pub(crate) cut: ViewDependent,
    pub(crate) leaf_indices: u32,
    pub(crate) rows: Rows,
}

impl Figures<'_> {
    pub(crate) fn all(&mut self, wanted: &Wanted) {
        if wanted.has("memory") {
            self.memory();
        }
        if wanted.has("stand") {
            self.stand();
        }
        if wanted.has("towards") {
            self.towards();
        }
        if wanted.has("schemes") {
            self.schemes();
        }
        if wanted.has("counts") {
            self.counts();
        }
    }

    fn renderer(&self, size: [u32; 2]) -> Renderer<'_> {
        Renderer::new(
            self.gpu,
            self.pipelines,
            self.uploaded,
            self.leaf_indices,
            size,
        )
    }

    fn instances(&self, count: usize) -> Vec<Instance> {
        placing::square(count, self.species.sphere.radius, STAND_SEED)
    }

    fn note(&mut self, case: &str, quantity: &str, unit: &str, value: f64) {
        self.rows.add(&Row {
            case,
            quantity,
            unit,
            value,
            repeat: 0,
            adapter: &self.gpu.adapter,
            command: "cargo run -p secateur-scene --example forest -- figures",
        });
    }

    fn note_seconds(&mut self, case: &str, seconds: Seconds, frames: usize) {
        let a_frame = 1e3 / frames as f64;
        self.note(case, "time a frame", "ms", seconds.wall * a_frame);
        if let Some(cores) = seconds.cores {
            self.note(case, "core time a frame", "ms", cores * a_frame);
        }
    }

    /// Bytes on the GPU.
    fn memory(&mut self) {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let count = 2000;
        let instances = self.instances(count);
        let camera = placing::overlook(count, self.species.sphere.radius, LARGE);
        let mut stand = stand(self, &instances);
        let list = stand.frame(Method::Continuous, &camera, camera.eye);
        let renderer = self.renderer(LARGE);
        let drawn = renderer.draw(&list, &camera);
        let targets = renderer.target_bytes;
        let bytes = self.uploaded.bytes;
        let continuous = bytes.prefix + bytes.pictures + drawn.bytes;
        for (quantity, value) in [
            ("a plant as it is", bytes.full),
            ("a chain of halvings", bytes.chain),
            ("prefix buffers with their tables", bytes.prefix),
            ("pictures of materials", bytes.pictures),
            ("pictures of boxes", bytes.boxes),
            ("records of 2000 trees at continuous levels", drawn.bytes),
            ("2000 trees at continuous levels", continuous),
            ("these and the frame's targets", continuous + targets),
        ] {
            self.note("memory", quantity, "MiB", mib(value));
        }
    }

    /// 2,000 trees by each method, beside full geometry.
    fn stand(&mut self) {
        let count = 2000;
        let instances = self.instances(count);
        let camera = placing::overlook(count, self.species.sphere.radius, LARGE);
        let mut full = None;
        let methods = [
            Method::Full,
            Method::Chain,
            Method::Continuous,
            Method::Spheres,
            Method::Boxes,
            Method::Mix,
        ];
        for method in methods {
            let frames = if method == Method::Full { 1 } else { 3 };
            let (picture, drawn, seconds) = {
                let mut stand = stand(self, &instances);
                let renderer = self.renderer(LARGE);
                let mut draw = || {
                    let list = stand.frame(method, &camera, camera.eye);
                    renderer.draw(&list, &camera)
                };
                // The first frame makes what later ones find.
                if frames > 1 {
                    draw();
                }
                let (drawn, seconds) = timed(|| (0..frames).map(|_| draw()).last());
                (renderer.picture(), drawn.unwrap_or_default(), seconds)
            };
            let case = format!("stand: {count} trees, {}", method.name());
            self.note(&case, "triangles", "", drawn.triangles as f64);
            self.note(&case, "draw calls", "", drawn.calls as f64);
            self.note_seconds(&case, seconds, frames);
            let a_frame =
                |s: Seconds| [s.wall, s.cores.unwrap_or(s.wall)].map(|t| t / frames as f64);
            let own = a_frame(seconds);
            let (reference, of_full) = full.get_or_insert((picture.clone(), own));
            let (flip, ratios) = (
                (FLIP_MEAN.of)(reference, &picture),
                [of_full[0] / own[0], of_full[1] / own[1]],
            );
            self.note(&case, "FLIP against full geometry", "", flip);
            self.note(&case, "frame rate over full geometry's", "x", ratios[0]);
            self.note(&case, "the same by core time", "x", ratios[1]);
            let name = method.name().replace([' ', ','], "_");
            let path = std::env::temp_dir().join(format!("secateur_forest_{name}.png"));
            match picture.save(&path) {
                Ok(()) => eprintln!("{}", path.display()),
                Err(error) => eprintln!("{}: {error}", path.display()),
            }
        }
    }

    /// Towards one tree: triangles and difference at distances that halve (VDF's Fig. 13).
    fn towards(&mut self) {
        let instances = [Instance {
            position: DVec3::ZERO,
            yaw: 0.0,
            scale: 1.0,
        }];
        let radius = self.species.sphere.radius;
        for times in [32, 16, 8, 4, 2] {
            let camera = placing::towards(radius, radius * f64::from(times), SMALL);
            let mut full = None;
            for method in [
                Method::Full,
                Method::Continuous,
                Method::Spheres,
                Method::Boxes,
                Method::Mix,
            ] {
                let (picture, drawn) = {
                    let mut stand = stand(self, &instances);
                    let renderer = self.renderer(SMALL);
                    let list = stand.frame(method, &camera, camera.eye);
                    let drawn = renderer.draw(&list, &camera);
                    (renderer.picture(), drawn)
                };
                let case = format!("towards: {times} radii off, {}", method.name());
                let flip = (FLIP_MEAN.of)(full.get_or_insert_with(|| picture.clone()), &picture);
                self.note(&case, "triangles", "", drawn.triangles as f64);
                self.note(&case, "FLIP against full geometry", "", flip);
            }
        }
    }

    /// Frames around a stand, for numbers of trees (VDF's Fig. 9, Hybrid's Table 1).
    fn counts(&mut self) {
        for count in COUNTS {
            let instances = self.instances(count);
            let radius = self.species.sphere.radius;
            let mut of_full = None;
            for method in [
                Method::Full,
                Method::Continuous,
                Method::Spheres,
                Method::Boxes,
                Method::Mix,
            ] {
                let places = if method == Method::Full {
                    FULL_PLACES
                } else {
                    PLACES
                };
                let mut times = Vec::new();
                let mut triangles = 0;
                {
                    let mut stand = stand(self, &instances);
                    let renderer = self.renderer(SMALL);
                    for place in 0..places {
                        let share = place as f64 / places as f64;
                        let camera = placing::around(count, radius, share, SMALL);
                        let (drawn, seconds): (FrameCost, Seconds) = timed(|| {
                            let list = stand.frame(method, &camera, camera.eye);
                            renderer.draw(&list, &camera)
                        });
                        triangles += drawn.triangles;
                        times.push(seconds);
                    }
                }
                let case = format!("counts: {count} trees, {}", method.name());
                let wall = |pick: fn(f64, f64) -> f64, from: f64| {
                    1.0 / times.iter().map(|t| t.wall).fold(from, pick)
                };
                let sum = |of: fn(&Seconds) -> f64| times.iter().map(of).sum::<f64>();
                let mean = sum(|t| t.cores.unwrap_or(t.wall)) / places as f64;
                self.note(
                    &case,
                    "triangles a frame",
                    "",
                    triangles as f64 / places as f64,
                );
                self.note(&case, "least frame rate", "1/s", wall(f64::max, 0.0));
                self.note(
                    &case,
                    "most frame rate",
                    "1/s",
                    wall(f64::min, f64::INFINITY),
                );
                self.note(
                    &case,
                    "mean frame rate",
                    "1/s",
                    places as f64 / sum(|t| t.wall),
                );
                self.note(&case, "core time a frame", "ms", 1e3 * mean);
                let full = *of_full.get_or_insert(mean);
                self.note(&case, "full geometry's core time over it", "x", full / mean);
            }
        }
    }

    /// L-plants' two schemes over a path, the chain and the continuous levels beside them: time, and
    /// how much a step of the path changes by levels alone.
    fn schemes(&mut self) {
        let count = 250;
        let instances = self.instances(count);
        let radius = self.species.sphere.radius;
        for method in [
            Method::Scheme(Scheme::Halving),
            Method::Scheme(Scheme::Even),
            Method::Chain,
            Method::Continuous,
        ] {
            let (mut triangles, mut pops, mut total) = (0, Vec::new(), [0.0; 2]);
            {
                let mut stand = stand(self, &instances);
                let renderer = self.renderer(SMALL);
                let at = |step: usize| -> StandCamera {
                    let share = step as f64 / POP_STEPS as f64;
                    placing::walk(count, radius, share, SMALL)
                };
                for step in 0..POP_STEPS {
                    let camera = at(step + 1);
                    let before = {
                        let list = stand.frame(method, &camera, at(step).eye);
                        renderer.draw(&list, &camera);
                        renderer.picture()
                    };
                    let (drawn, seconds) = timed(|| {
                        let list = stand.frame(method, &camera, camera.eye);
                        renderer.draw(&list, &camera)
                    });
                    triangles += drawn.triangles;
                    total[0] += seconds.wall;
                    total[1] += seconds.cores.unwrap_or(seconds.wall);
                    pops.push((FLIP_MEAN.of)(&before, &renderer.picture()));
                }
            }
            let case = format!("schemes: {count} trees, {}", method.name());
            let steps = POP_STEPS as f64;
            let most = pops.iter().copied().fold(0.0, f64::max);
            self.note(&case, "triangles a frame", "", triangles as f64 / steps);
            self.note(&case, "time a frame", "ms", 1e3 * total[0] / steps);
            self.note(&case, "core time a frame", "ms", 1e3 * total[1] / steps);
            self.note(
                &case,
                "mean pop (FLIP)",
                "",
                pops.iter().sum::<f64>() / steps,
            );
            self.note(&case, "largest pop (FLIP)", "", most);
        }
    }
}

fn stand<'a>(figures: &Figures<'a>, instances: &'a [Instance]) -> Stand<'a> {
    Stand {
        species: figures.species,
        uploaded: figures.uploaded,
        instances,
        cut: figures.cut.clone(),
    }
}
