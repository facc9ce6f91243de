//! How plants and impostors look from as far off as they are seen from.

use std::borrow::Borrow;
use std::sync::Arc;

use secateur_eval::Pictures;
use secateur_eval::pictures::share_of_tight_frame;
use secateur_model::{BoundingSphere, Surface};
use secateur_raster::{View, ViewSet};

use super::Impostor;
use super::crossed::Planes;
use secateur_runtime::Screen;

/// The least and the largest side of a judging picture, in pixels. What the screen shows larger is judged in pictures of
/// that size, in which single leaves hardly count.
const PICTURE_PX: [f64; 2] = [48.0, 256.0];

/// Views from one distance.
pub struct Judge {
    views: ViewSet,
    /// Pixels a side of a picture.
    side: u32,
    obstacles: Vec<Arc<Surface>>,
    /// By what FLIP over a picture is multiplied to be that over the frame of `measure`.
    frame_share: f64,
}

impl Judge {
    /// Views stand at least this many radii off: nearer ones look between the planes of an impostor.
    pub const LEAST_RADII: f64 = 3.0;

    /// Views along the same directions as these, from where the screen shows a plant of this height
    /// at this number of pixels.
    pub fn new(
        directions: &ViewSet,
        sphere: BoundingSphere,
        plant_height: f64,
        screen: Screen,
        pixels_high: f64,
    ) -> Self {
        let distance = screen
            .distance(plant_height, pixels_high)
            .max(Self::LEAST_RADII * sphere.radius);
        let aside = (distance * distance - sphere.radius * sphere.radius).sqrt();
        let tangent = sphere.radius / aside;
        let from_afar = |view: &View| {
            let eye = sphere.centre - view.forward() * distance;
            let near = 0.5 * (distance - sphere.radius);
            View::look_at(eye, sphere.centre, view.up(), tangent, near).unwrap_or(*view)
        };
        let share = plant_height / (2.0 * distance * tangent);
        let whole_px = pixels_high.min(screen.height_px) / share;
        let [least, most] = PICTURE_PX;
        Self {
            views: ViewSet::new(directions.views().iter().map(from_afar).collect()),
            side: whole_px.clamp(least, most).round() as u32,
            obstacles: Vec::new(),
            frame_share: share_of_tight_frame(sphere, sphere),
        }
    }

    /// This judge, with these drawn wherever a plant or an impostor is.
    pub fn among(mut self, obstacles: Vec<Arc<Surface>>) -> Self {
        self.obstacles = obstacles;
        self
    }

    /// This judge for a plant of which FLIP over a picture is multiplied by this to be that over the frame of
    /// `measure` ([`share_of_tight_frame`]), by default 3/8, as where leaves are all around the plant.
    pub fn with_frame_share(mut self, share: f64) -> Self {
        self.frame_share = share;
        self
    }

    /// Pictures of a mesh that is held against other meshes, with normals as the file has them: those that
    /// `measure` draws.
    pub fn of_mesh(&self, surfaces: &[Surface]) -> Pictures {
        let obstacles = self.obstacles.iter().map(Arc::as_ref);
        let all: Vec<&Surface> = surfaces.iter().chain(obstacles).collect();
        Pictures::of_size(&all, std::slice::from_ref(&self.views), self.side)
    }

    /// Pictures of a mesh that is held against an impostor, with the normals of double-sided materials turned to
    /// the viewer, as those that an impostor is baked from are.
    pub fn of_surfaces(&self, surfaces: &[Surface]) -> Pictures {
        let obstacles = self.obstacles.iter().map(Arc::as_ref);
        let all: Vec<&Surface> = surfaces.iter().chain(obstacles).collect();
        Pictures::of_seen(|_: &View| all.clone(), &self.views, self.side)
    }

    /// Pictures of an impostor.
    pub fn of_impostor(&self, impostor: &Impostor) -> Pictures {
        let seen = |view: &View| {
            let mut all = vec![Arc::new(impostor.seen_from(view.eye()))];
            all.extend(self.obstacles.iter().cloned());
            all
        };
        Pictures::of_seen(seen, &self.views, self.side)
    }

    /// FLIP of pictures against others over the frame of `measure`: the mean of all views.
    pub fn flip(&self, a: &Pictures, b: &Pictures) -> f64 {
        let flips = a.flips(b).into_iter();
        let flips: Vec<f64> = flips.map(|flip| flip * self.frame_share).collect();
        flips.iter().sum::<f64>() / flips.len() as f64
    }
}

/// The crossed planes that look most like the plant by a figure that is the less the nearer they look, lit by baked
/// normals or flat; and that figure.
pub fn best_crossed<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    pixels_high: f64,
    figure: impl Fn(&Impostor) -> f64,
) -> Option<(Impostor, f64)> {
    let of = |made: Impostor| {
        let far = figure(&made);
        (made, far)
    };
    let made = Planes::ALL
        .iter()
        .filter_map(|planes| Impostor::crossed(surfaces, *planes, pixels_high));
    let (best, far) = made.map(of).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let flat = of(best.flat());
    Some(match flat.1 <= far {
        true => flat,
        false => (best, far),
    })
}
