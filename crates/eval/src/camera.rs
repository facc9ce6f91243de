//! Where a picture is taken from.

use crate::surface_references::references;
use std::borrow::Borrow;

use glam::DVec3;
use secateur_model::Surface;

/// A pinhole camera in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, in world units.
    pub eye: DVec3,
    /// What is in the middle of the picture.
    pub target: DVec3,
    /// A direction that is upward in the picture; need not be square to the view.
    pub up: DVec3,
    /// The angle from the lower to the upper edge of the picture, in radians.
    pub fov_y_rad: f64,
}

/// An orthonormal frame: right, up and forward of a view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewAxes {
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
}

impl ViewAxes {
    /// The frame that looks along `forward`. Any frame where the directions
    /// coincide or are zero.
    pub(crate) fn looking(forward: DVec3, up: DVec3) -> Self {
        let forward = forward.normalize_or(DVec3::NEG_Z);
        let right = forward.cross(up);
        let right = right.normalize_or(forward.any_orthonormal_vector());
        Self {
            right,
            up: right.cross(forward),
            forward,
        }
    }

    /// A vector's parts along right, up and forward.
    pub(crate) fn parts(&self, vector: DVec3) -> DVec3 {
        DVec3::new(
            vector.dot(self.right),
            vector.dot(self.up),
            vector.dot(self.forward),
        )
    }
}

const FRAMING_FOV_Y_DEGREES: f64 = 28.0;
const FRAMING_AZIMUTH_DEGREES: f64 = 32.0;
/// The share of the picture left free on each side.
const FRAMING_MARGIN: f64 = 0.05;

/// The camera that takes in all of these surfaces, y up: a three-quarter view
/// that looks slightly upwards, from the side of +z.
///
/// `aspect` is the picture's width over its height. Positions that are not finite
/// are passed over; without any, a camera that looks at the origin.
pub fn framing<S: Borrow<Surface>>(surfaces: &[S], aspect: f64) -> Camera {
    let surfaces = &references(surfaces)[..];
    let azimuth = FRAMING_AZIMUTH_DEGREES.to_radians();
    let forward = DVec3::new(-azimuth.sin(), 0.03, -azimuth.cos());
    let axes = ViewAxes::looking(forward, DVec3::Y);
    let fov_y_rad = FRAMING_FOV_Y_DEGREES.to_radians();
    let tan_y = (0.5 * fov_y_rad).tan();
    let eye = eye_that_sees_all(surfaces, axes, tan_y * aspect, tan_y);
    let (eye, distance) = eye.unwrap_or((-axes.forward, 1.0));
    Camera {
        eye,
        target: eye + axes.forward * distance,
        up: DVec3::Y,
        fov_y_rad,
    }
}

/// The nearest eye on whose frustum's planes the surfaces lean from inside, and
/// its distance to their middle.
///
/// A point is left of the right-hand plane where x - x_eye <= tan (z - z_eye): so
/// each plane asks only for the largest x - tan z of all points.
fn eye_that_sees_all(
    surfaces: &[&Surface],
    axes: ViewAxes,
    tan_x: f64,
    tan_y: f64,
) -> Option<(DVec3, f64)> {
    let keep = 1.0 - 2.0 * FRAMING_MARGIN;
    let (tan_x, tan_y) = (tan_x * keep, tan_y * keep);
    let mut planes = [f64::NEG_INFINITY; 4];
    let mut depths = [f64::INFINITY, f64::NEG_INFINITY];
    let positions = surfaces.iter().flat_map(|s| &s.positions);
    for p in positions.filter(|p| p.is_finite()) {
        let p = axes.parts(*p);
        let leans = [
            p.x - tan_x * p.z,
            -p.x - tan_x * p.z,
            p.y - tan_y * p.z,
            -p.y - tan_y * p.z,
        ];
        for (plane, lean) in planes.iter_mut().zip(leans) {
            *plane = plane.max(lean);
        }
        depths = [depths[0].min(p.z), depths[1].max(p.z)];
    }
    let [right, left, top, bottom] = planes;
    if !right.is_finite() {
        return None;
    }
    let nearest = f64::min(-0.5 * (right + left) / tan_x, -0.5 * (top + bottom) / tan_y);
    // Points in one line with the view would put the eye into the first.
    let z = if nearest < depths[0] {
        nearest
    } else {
        depths[0] - (depths[1] - depths[0]).max(1e-3 * depths[0].abs()).max(1.0)
    };
    let (x, y) = (0.5 * (right - left), 0.5 * (top - bottom));
    let eye = axes.right * x + axes.up * y + axes.forward * z;
    Some((eye, 0.5 * (depths[0] + depths[1]) - z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::Lens;
    use secateur_model::{AlphaMode, Material};
    use std::sync::Arc;

    fn points(positions: Vec<DVec3>) -> Surface {
        let material = Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            finish: secateur_model::Finish::default(),
        };
        Surface {
            positions,
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: Vec::new(),
            material: Arc::new(material),
        }
    }

    #[test]
    fn everything_is_inside_and_the_tightest_pair_of_edges_is_near() {
        // A tall box and a wide one, small and huge, far from the origin.
        for size in [
            DVec3::new(1.0, 5.0, 1.0),
            DVec3::new(9.0, 1.0, 2.0),
            DVec3::splat(1e-4),
            DVec3::splat(1e6),
        ] {
            let corner = |i: i32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
            let at = DVec3::new(7.0, -3.0, 2.0) * size.max_element();
            let surface = points((0..8).map(|i| at + corner(i) * size).collect());
            let camera = framing(&[&surface], 0.8);
            let lens = Lens::perspective(&camera, 80, 100);
            let on_raster = surface.positions.iter().map(|&p| {
                let view = lens.to_view(p);
                assert!(lens.in_front(view) > 0.0);
                lens.project(view).at
            });
            let (low, high) = on_raster.fold(
                (glam::Vec2::INFINITY, glam::Vec2::NEG_INFINITY),
                |(a, b), p| (a.min(p), b.max(p)),
            );
            // Five per cent of the picture stay free, on each side.
            let free = [
                low.x / 80.0,
                1.0 - high.x / 80.0,
                low.y / 100.0,
                1.0 - high.y / 100.0,
            ];
            assert!(free.iter().all(|&f| f > 0.045), "{size}: {free:?}");
            assert!(free.iter().any(|&f| f < 0.055), "{size}: {free:?}");
        }
    }

    #[test]
    fn nothing_and_a_point_have_a_camera_too() {
        for surface in [
            points(vec![]),
            points(vec![DVec3::ONE]),
            points(vec![DVec3::NAN]),
        ] {
            let camera = framing(&[surface], 1.0);
            assert!(camera.eye.is_finite() && camera.target.is_finite());
            assert!((camera.target - camera.eye).length() > 0.0);
        }
    }
}
