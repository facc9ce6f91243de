//! From world space to the pixels of a picture or of a light's depth map.

use glam::{DVec3, Vec2};

use crate::Camera;
use crate::camera::ViewAxes;

/// A projection to a raster of `width` x `height` samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) axes: ViewAxes,
    pub(crate) origin: DVec3,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Where the axis of the view meets the raster, in samples.
    centre: [f64; 2],
    /// Samples per unit of tangent (perspective) or of length (parallel).
    samples_per_unit: f64,
    /// The depth in front of which nothing is drawn; `None`: parallel rays.
    near: Option<f64>,
}

/// A projected point. `nearness` and `inverse_w` are linear over the raster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projected {
    /// In samples, y downwards.
    pub(crate) at: Vec2,
    /// Grows towards the eye.
    pub(crate) nearness: f32,
    pub(crate) inverse_w: f32,
}

impl Lens {
    /// What a camera sees.
    pub(crate) fn perspective(camera: &Camera, width: u32, height: u32) -> Self {
        let forward = camera.target - camera.eye;
        Self {
            axes: ViewAxes::looking(forward, camera.up),
            origin: camera.eye,
            width,
            height,
            centre: middle([width, height]),
            samples_per_unit: 0.5 * f64::from(height) / (0.5 * camera.fov_y_rad).tan(),
            near: Some((1e-3 * forward.length()).max(f64::MIN_POSITIVE)),
        }
    }

    /// A part of what an eye sees: a raster of `size` samples, `samples_per_tangent` samples for each unit of the
    /// tangent, whose upper left corner lies at `corner`, in tangents to the right and upwards.
    pub(crate) fn window(
        axes: ViewAxes,
        eye: DVec3,
        near: f64,
        (corner, size, samples_per_tangent): ([f64; 2], [u32; 2], f64),
    ) -> Self {
        Self {
            axes,
            origin: eye,
            width: size[0],
            height: size[1],
            centre: [
                -corner[0] * samples_per_tangent,
                corner[1] * samples_per_tangent,
            ],
            samples_per_unit: samples_per_tangent,
            near: Some(near),
        }
    }

    /// A square raster on which a sphere just fits, seen along `forward`.
    pub(crate) fn parallel(centre: DVec3, radius: f64, forward: DVec3, size: u32) -> Self {
        Self {
            axes: ViewAxes::looking(forward, DVec3::Y),
            origin: centre,
            width: size,
            height: size,
            centre: middle([size; 2]),
            samples_per_unit: 0.5 * f64::from(size) / radius,
            near: None,
        }
    }

    /// A raster of any size, seen along parallel rays.
    pub(crate) fn parallel_along(
        axes: ViewAxes,
        centre: DVec3,
        [width, height]: [u32; 2],
        samples_per_unit: f64,
    ) -> Self {
        Self {
            axes,
            origin: centre,
            width,
            height,
            centre: middle([width, height]),
            samples_per_unit,
            near: None,
        }
    }

    /// A world-space point along right, up and forward from the eye.
    pub(crate) fn to_view(self, world: DVec3) -> DVec3 {
        self.axes.parts(world - self.origin)
    }

    /// How far in front of the near plane a point in view space is; negative
    /// behind it. Always positive for parallel rays.
    pub(crate) fn in_front(&self, view: DVec3) -> f64 {
        self.near.map_or(1.0, |near| view.z - near)
    }

    /// A point in view space, in front of the near plane, on the raster.
    pub(crate) fn project(&self, view: DVec3) -> Projected {
        let inverse_w = if self.near.is_some() {
            1.0 / view.z
        } else {
            1.0
        };
        let scale = self.samples_per_unit * inverse_w;
        let at = Vec2::new(
            (self.centre[0] + scale * view.x) as f32,
            (self.centre[1] - scale * view.y) as f32,
        );
        let nearness = match self.near {
            Some(near) => (near * inverse_w) as f32,
            None => -view.z as f32,
        };
        Projected {
            at,
            nearness,
            inverse_w: inverse_w as f32,
        }
    }

    /// The world-space direction, not of unit length, from the eye through a
    /// point of the raster (perspective only).
    pub(crate) fn ray(&self, x: f64, y: f64) -> DVec3 {
        let right = (x - self.centre[0]) / self.samples_per_unit;
        let up = (self.centre[1] - y) / self.samples_per_unit;
        self.axes.forward + self.axes.right * right + self.axes.up * up
    }
}

fn middle(size: [u32; 2]) -> [f64; 2] {
    size.map(|samples| 0.5 * f64::from(samples))
}
