//! The picture that a view takes of a plant: as large as the screen shows it, and no larger than it.

use glam::{DVec2, DVec3};
use secateur_model::{BoundingSphere, Surface};
use secateur_raster::View;

use crate::camera::ViewAxes;
use crate::lens::Lens;

/// Longest side of a plant in pictures, in pixels.
pub(super) const MOST_SIDE_PX: f64 = 1024.0;

/// Shortest longest side, in pixels: a block.
const LEAST_SIDE_PX: f64 = 8.0;

/// How many blocks the longest side of a plant has.
const BLOCKS: f64 = 8.0;

/// Least side of a block, in pixels.
const LEAST_BLOCK_PX: f64 = 8.0;

/// Least room about the plant in pixels: as far as the filters of FLIP reach, and what U grows by.
const LEAST_MARGIN_PX: u32 = 12;

/// Plants are drawn with as many samples along a side of a pixel as come to no more than this along the plant, but at
/// least 2 and at most 4.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Samples {
    #[default]
    Fine,
    /// For a first look.
    Coarse,
}

impl Samples {
    /// Samples along a side of a pixel, for a plant whose longest side is `longest_px` pixels long.
    fn a_side(self, longest_px: f64) -> u32 {
        let along_plant = match self {
            Self::Fine => 1024.0,
            Self::Coarse => 384.0,
        };
        (along_plant / longest_px).floor().clamp(2.0, 4.0) as u32
    }
}

/// What is nearer to an eye than this share of the plant's radius is not drawn.
const NEAR_RADII: f64 = 0.01;

/// Where a view is taken from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    /// The place of the view in its set.
    pub(super) number: usize,
    pub(super) at: DVec3,
    axes: ViewAxes,
    near: f64,
    /// From the eye to the middle of the plant, in world units.
    distance: f64,
    /// What is seen at most, as the tangent of the angle off the axis.
    most_tangent: f64,
}

impl Eye {
    /// An eye so many radii from the middle of a sphere, at these degrees of azimuth and elevation.
    pub(super) fn about(
        number: usize,
        [azimuth, elevation]: [f64; 2],
        sphere: BoundingSphere,
        radii: f64,
    ) -> Self {
        let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
        let level = elevation.cos();
        let away = DVec3::new(
            level * azimuth.sin(),
            elevation.sin(),
            level * azimuth.cos(),
        );
        // A plant of one point is looked at too.
        let radius = sphere.radius.max(f64::MIN_POSITIVE.sqrt());
        Self {
            number,
            at: sphere.centre + away * (radii * radius),
            axes: ViewAxes::looking(-away, DVec3::Y),
            // What stands before a plant may stand close before the eye.
            near: NEAR_RADII * radius,
            distance: radii * radius,
            most_tangent: 1.0,
        }
    }

    /// The eye of a camera that looks at a plant within this sphere.
    pub(super) fn of_camera(number: usize, view: &View, sphere: BoundingSphere) -> Self {
        Self {
            number,
            at: view.eye(),
            axes: ViewAxes::looking(view.forward(), view.up()),
            near: view.near(),
            distance: view.eye().distance(sphere.centre).max(view.near()),
            most_tangent: view.tan_half_fov(),
        }
    }
}

/// Where a plant lies in a picture, and how large.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) lens: Lens,
    /// Samples along a side of a pixel.
    pub(super) samples: u32,
    /// Side of a block in pixels.
    pub(super) block_px: u32,
    /// Room to the left of the plant and above it, in pixels.
    margin_px: u32,
    /// Width and height in pixels.
    size: [u32; 2],
}

impl Frame {
    /// The picture of these surfaces from an eye, a unit of length at the plant's middle as `px_per_unit` pixels,
    /// unless its longest side would be too large.
    pub(super) fn around(
        surfaces: &[&Surface],
        eye: &Eye,
        px_per_unit: f64,
        samples: Samples,
    ) -> Self {
        let [low, high] = tangents(surfaces, eye);
        let extent = (high - low).max(DVec2::ZERO);
        let longest = extent.max_element();
        let px_per_tangent = px_per_unit * eye.distance;
        let side = (longest * px_per_tangent).clamp(LEAST_SIDE_PX, MOST_SIDE_PX);
        let px_per_tangent = match longest > 0.0 {
            true => side / longest,
            false => 1.0,
        };
        let block = (side / BLOCKS).round().max(LEAST_BLOCK_PX) as u32;
        let margin = LEAST_MARGIN_PX.max(block / 2);
        let size = (extent * px_per_tangent).ceil();
        let size = [size.x, size.y].map(|side| side as u32 + 2 * margin);
        let samples = samples.a_side(side);
        let corner = [
            low.x - f64::from(margin) / px_per_tangent,
            high.y + f64::from(margin) / px_per_tangent,
        ];
        let raster = size.map(|side| side * samples);
        let scale = px_per_tangent * f64::from(samples);
        Self {
            lens: Lens::window(eye.axes, eye.at, eye.near, (corner, raster, scale)),
            samples,
            block_px: block,
            margin_px: margin,
            size,
        }
    }

    /// Blocks in a row and in a column.
    pub(super) fn blocks(&self) -> [usize; 2] {
        self.size.map(|side| self.block_at(side.max(1) - 1) + 1)
    }

    /// The block of a pixel.
    pub(super) fn block_of(&self, pixel: u32) -> usize {
        let (x, y) = (pixel % self.size[0], pixel / self.size[0]);
        self.block_at(y) * self.blocks()[0] + self.block_at(x)
    }

    /// The column or row of blocks at a column or row of pixels: a block begins where the plant does.
    fn block_at(&self, pixel: u32) -> usize {
        let before = self.margin_px.div_ceil(self.block_px) * self.block_px - self.margin_px;
        ((pixel + before) / self.block_px) as usize
    }
}

/// The box of all corners of triangles, as tangents to the right and upwards.
fn tangents(surfaces: &[&Surface], eye: &Eye) -> [DVec2; 2] {
    let most = DVec2::splat(eye.most_tangent);
    let mut bounds = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    for surface in surfaces {
        for &corner in surface.triangles.iter().flatten() {
            let at = eye.axes.parts(surface.positions[corner as usize] - eye.at);
            if at.z > eye.near && at.is_finite() {
                let tangent = (at.truncate() / at.z).clamp(-most, most);
                bounds = [bounds[0].min(tangent), bounds[1].max(tangent)];
            }
        }
    }
    match bounds[0].is_finite() {
        true => bounds,
        false => [DVec2::ZERO; 2],
    }
}
