//! Where trees stand, and where cameras are.

use std::f64::consts::TAU;

use glam::DVec3;
use secateur_plant::Random;
use secateur_runtime::Screen;
use secateur_runtime::stand::{Instance, StandCamera};

/// Between two trees of a row, in radii of the plant's sphere.
const SPACING: f64 = 1.35;

/// Each tree is moved from its place in the rows by up to this share of the spacing.
const JITTER: f64 = 0.4;

/// The field of view of all cameras.
const FIELD_OF_VIEW_DEGREES: f64 = 50.0;

/// A square of trees about the origin, each turned and scaled by lot.
pub(crate) fn square(count: usize, radius: f64, seed: u64) -> Vec<Instance> {
    let mut random = Random::new(seed);
    let across = (count as f64).sqrt().ceil() as usize;
    let spacing = SPACING * radius;
    let middle = (across - 1) as f64 / 2.0;
    (0..count)
        .map(|index| {
            let (x, z) = ((index % across) as f64, (index / across) as f64);
            let [dx, dz] = [0, 1].map(|_| random.between(-JITTER, JITTER));
            Instance {
                position: spacing * DVec3::new(x - middle + dx, 0.0, z - middle + dz),
                yaw: random.between(0.0, TAU),
                scale: random.between(0.75, 1.2),
            }
        })
        .collect()
}

/// Half the side of such a square.
pub(crate) fn half_side(count: usize, radius: f64) -> f64 {
    (count as f64).sqrt().ceil() * SPACING * radius / 2.0
}

fn camera(eye: DVec3, target: DVec3, [width, height]: [u32; 2]) -> StandCamera {
    StandCamera {
        eye,
        forward: (target - eye).normalize(),
        screen: Screen {
            height_px: height.into(),
            field_of_view_degrees: FIELD_OF_VIEW_DEGREES,
        },
        aspect: f64::from(width) / f64::from(height),
    }
}

/// Above the corner of a square, along its diagonal.
pub(crate) fn overlook(count: usize, radius: f64, size: [u32; 2]) -> StandCamera {
    let corner = -half_side(count, radius) - 2.2 * radius;
    let eye = DVec3::new(corner, 2.1 * radius, corner);
    camera(eye, DVec3::new(0.0, -0.6 * radius, 0.0), size)
}

/// Higher above the corner, looking down on the square: its trees fill more of the picture.
pub(crate) fn from_above(count: usize, radius: f64, size: [u32; 2]) -> StandCamera {
    let corner = -half_side(count, radius) - 2.2 * radius;
    let eye = DVec3::new(corner, 3.6 * radius, corner);
    camera(eye, eye + DVec3::new(1.0, -0.27, 1.0), size)
}

/// A place on a circle around a square of trees, looking at its middle (VDF 6).
pub(crate) fn around(count: usize, radius: f64, share: f64, size: [u32; 2]) -> StandCamera {
    let reach = half_side(count, radius) * std::f64::consts::SQRT_2 + 2.5 * radius;
    let (sin, cos) = (TAU * share).sin_cos();
    let eye = DVec3::new(reach * cos, 2.0 * radius, reach * sin);
    camera(eye, 0.5 * radius * DVec3::Y, size)
}

/// A place on a walk straight into a square of trees, by its share.
pub(crate) fn walk(count: usize, radius: f64, share: f64, size: [u32; 2]) -> StandCamera {
    let half = half_side(count, radius);
    let eye = DVec3::new(
        0.05 * half,
        1.9 * radius,
        -half - 6.0 * radius + share * half,
    );
    camera(eye, eye + DVec3::new(0.0, -0.08, 1.0), size)
}

/// So far from a single tree in the origin, at half its height (VDF's Fig. 13).
pub(crate) fn towards(radius: f64, distance: f64, size: [u32; 2]) -> StandCamera {
    let eye = DVec3::new(0.0, 0.8 * radius, distance);
    camera(eye, 0.8 * radius * DVec3::Y, size)
}
