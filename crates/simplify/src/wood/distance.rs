//! How far a piece of wood is from a level of it.

use glam::DVec3;
use secateur_model::LeafTriangle;

use super::nearest::nearest;

/// Largest number of corners of a piece of which the distance from a level is taken.
const MOST_CORNERS: usize = 192;

/// The mean distance of corners of a piece from a level, in world units.
pub(super) fn mean_distance(all: &[LeafTriangle], level: &[[u32; 3]]) -> f64 {
    let level = corners_of(all, level);
    let step = (3 * all.len()).div_ceil(MOST_CORNERS);
    let samples = all.iter().flat_map(|t| t.corners).step_by(step);
    let (mut sum, mut count) = (0.0, 0);
    for corner in samples {
        sum += distance_from(&level, corner);
        count += 1;
    }
    sum / f64::from(count)
}

/// The distance of a point from the nearest of some triangles, in world units.
pub(super) fn distance_from(triangles: &[[DVec3; 3]], point: DVec3) -> f64 {
    let to = |t: &[DVec3; 3]| nearest(*t, point).point.distance_squared(point);
    triangles
        .iter()
        .map(to)
        .fold(f64::INFINITY, f64::min)
        .sqrt()
}

/// Where the corners of a level are.
pub(super) fn corners_of(all: &[LeafTriangle], level: &[[u32; 3]]) -> Vec<[DVec3; 3]> {
    let at = |corner: u32| all[corner as usize / 3].corners[corner as usize % 3];
    level.iter().map(|t| t.map(at)).collect()
}
