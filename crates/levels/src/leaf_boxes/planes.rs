//! The six diagonal planes of a box, and pictures on them.

use std::array;
use std::borrow::Borrow;

use glam::{DVec3, Vec3};
use secateur_eval::{ParallelView, SeenTexel, seen_along, srgb_byte};
use secateur_model::Surface;

use super::OrientedBox;
use crate::dilate::dilated;

/// Two through each pair of opposite edges along each of three axes.
pub const PLANES: usize = 6;

/// Planes that are seen from the side by more than about 70 degrees do not count.
const LEAST_COSINE: f64 = 0.35;

/// Samples along a side of a texel.
const SAMPLES: u32 = 2;

/// A rectangle through a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagonalPlane {
    /// Its middle, that of the box.
    pub centre: DVec3,
    /// From its middle to the middle of its right side.
    pub right: DVec3,
    /// From its middle to the middle of its upper side.
    pub up: DVec3,
    /// Its normal, a unit vector.
    pub toward: DVec3,
}

/// The planes of a box: for each axis the two that hold two opposite edges along it.
pub fn diagonal_planes(bounds: &OrientedBox) -> [DiagonalPlane; PLANES] {
    array::from_fn(|plane| {
        let (k, side) = (plane / 2, [1.0, -1.0][plane % 2]);
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let along = |axis: usize| bounds.half[axis] * bounds.axes[axis];
        let (right, up) = (along(i) + side * along(j), along(k));
        let least = bounds.axes[i];
        DiagonalPlane {
            centre: bounds.centre,
            right,
            up,
            toward: right
                .normalize_or(least)
                .cross(bounds.axes[k])
                .normalize_or(bounds.axes[j]),
        }
    })
}

/// How much each plane counts for an eye in this direction, 1 together.
pub fn weights(planes: &[DiagonalPlane; PLANES], to_eye: DVec3) -> [f64; PLANES] {
    let squarely = planes.map(|plane| {
        let cosine = plane.toward.dot(to_eye).abs();
        (cosine - LEAST_COSINE).max(0.0).powi(2)
    });
    let sum: f64 = squarely.iter().sum();
    // Of six planes one is always seen squarely enough, but for a box without any width.
    match sum > 0.0 {
        true => squarely.map(|w| w / sum),
        false => [1.0 / PLANES as f64; PLANES],
    }
}

/// What is seen square to a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanePicture {
    /// sRGB colours, and as alpha the share of each texel that is covered; row by row from the top.
    pub rgba: Vec<u8>,
    /// Shading normals in the plant's own space, 0 to 255 for -1 to 1; turned to the side that is seen.
    pub normals: Vec<u8>,
    /// The share of width and height that the rectangle takes, about the middle: the longer side all.
    pub extent: [f64; 2],
}

/// The picture of surfaces on a plane, `side` texels wide and high, a power of two.
pub fn picture<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    plane: &DiagonalPlane,
    side: u32,
) -> PlanePicture {
    let (width, height) = (plane.right.length(), plane.up.length());
    let longer = width.max(height).max(f64::MIN_POSITIVE);
    let view = ParallelView {
        centre: plane.centre,
        toward: plane.toward,
        up: plane.up,
        texel: 2.0 * longer / f64::from(side),
    };
    let seen = seen_along(surfaces, &view, [side; 2], SAMPLES);
    let coverage: Vec<f32> = seen.iter().map(|texel| texel.coverage).collect();
    let weighted = |t: &SeenTexel| ([t.color * t.coverage, t.normal * t.coverage], t.coverage);
    let sums = seen.iter().map(weighted).collect();
    let filled = dilated(sums, [side as usize; 2], [Vec3::ZERO, Vec3::Z]);
    let axes = view.axes().map(|axis| axis.as_vec3());
    let mut picture = PlanePicture {
        rgba: Vec::with_capacity(4 * filled.len()),
        normals: Vec::with_capacity(4 * filled.len()),
        extent: [width / longer, height / longer],
    };
    for ([color, normal], coverage) in filled.iter().zip(coverage) {
        let [r, g, b] = color.to_array().map(srgb_byte);
        let alpha = (coverage * 255.0).round() as u8;
        picture.rgba.extend([r, g, b, alpha]);
        let own = axes[0] * normal.x + axes[1] * normal.y + axes[2] * normal.z;
        let byte = |x: f32| ((x.clamp(-1.0, 1.0) + 1.0) * 127.5).round() as u8;
        let [x, y, z] = own.normalize_or(axes[2]).to_array().map(byte);
        picture.normals.extend([x, y, z, 255]);
    }
    picture
}
