//! Cameras that come nearer: how many triangles a tree has then, and how much levels pop.

use glam::DVec3;
use secateur_eval::pictures::flip_mean;
use secateur_runtime::stand::{Instance, StandCamera};

use super::{Figures, Frames, SMALL, stand};
use crate::clock::timed;
use crate::methods::{Method, Scheme};
use crate::placing;

/// Distances from a tree, in radii of its sphere.
const DISTANCES: [u32; 5] = [32, 16, 8, 4, 2];

/// Steps of a walk over which levels are seen to pop, and the trees that it goes into.
const POP_STEPS: usize = 8;
const POP_TREES: usize = 250;

impl Figures<'_> {
    /// Towards one tree: triangles and difference at distances that halve (VDF's Fig. 13).
    pub(super) fn towards(&mut self) {
        let instances = [Instance {
            position: DVec3::ZERO,
            yaw: 0.0,
            scale: 1.0,
        }];
        let radius = self.species.sphere.radius;
        let mut stand = stand(self, &instances);
        let renderer = self.renderer(SMALL);
        for times in DISTANCES {
            let camera = placing::towards(radius, radius * f64::from(times), SMALL);
            let mut full = None;
            for method in [
                Method::Full,
                Method::Continuous,
                Method::Spheres,
                Method::Boxes,
                Method::Mix,
            ] {
                let list = stand.frame(method, &camera, camera.eye);
                let drawn = renderer.draw(&list, &camera);
                let picture = renderer.picture();
                let case = format!("towards: {times} radii off, {}", method.name());
                let flip = flip_mean(full.get_or_insert_with(|| picture.clone()), &picture);
                self.note(&case, "triangles a frame", "", drawn.triangles as f64);
                self.note(&case, "FLIP against full geometry", "", flip);
            }
        }
    }

    /// L-plants' two schemes over a path, the chain and the continuous levels beside them: time, and
    /// how much a step of the path changes by levels alone.
    pub(super) fn schemes(&mut self) {
        let instances = self.instances(POP_TREES);
        let radius = self.species.sphere.radius;
        let mut all = [
            Method::Scheme(Scheme::Halving),
            Method::Scheme(Scheme::Even),
            Method::Chain,
            Method::Continuous,
            Method::Fading,
        ]
        .map(|method| (method, Frames::default(), Vec::new()));
        let mut stand = stand(self, &instances);
        let renderer = self.renderer(SMALL);
        let at = |step: usize| -> StandCamera {
            let share = step as f64 / POP_STEPS as f64;
            placing::walk(POP_TREES, radius, share, SMALL)
        };
        for step in 0..POP_STEPS {
            let camera = at(step + 1);
            for (method, frames, pops) in &mut all {
                let list = stand.frame(*method, &camera, at(step).eye);
                renderer.draw(&list, &camera);
                let before = renderer.picture();
                let (drawn, seconds) = timed(|| {
                    let list = stand.frame(*method, &camera, camera.eye);
                    renderer.draw(&list, &camera)
                });
                frames.add(drawn.triangles, seconds);
                pops.push(flip_mean(&before, &renderer.picture()));
            }
        }
        for (method, frames, pops) in &all {
            let case = format!("schemes: {POP_TREES} trees, {}", method.name());
            let mean = pops.iter().sum::<f64>() / POP_STEPS as f64;
            let most = pops.iter().copied().fold(0.0, f64::max);
            self.note_frames(&case, frames);
            self.note(&case, "mean pop (FLIP)", "", mean);
            self.note(&case, "largest pop (FLIP)", "", most);
        }
    }
}
