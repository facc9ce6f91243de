//! Normals of new triangles where the old ones are flat-shaded: each triangle has its own.

use glam::DVec3;
use serde_json::Value;

use super::references::as_index;
use crate::Document;
use crate::accessor::Shape;
use crate::error::Fault;

/// The cosine of the largest angle between normals that are taken for the same, 2.6 degrees.
const SAME: f64 = 0.999;

/// The share of its triangles that a flat-shaded primitive shows flat: points and slivers have no normal to compare.
const MOST: f64 = 0.95;

/// The normals of the vertices of a primitive whose triangles are each as flat as they look; nothing where they are
/// smooth, or not those of its triangles.
pub(super) fn if_flat(
    document: &Document,
    primitive: &Value,
    triangles: &[[u32; 3]],
) -> Result<Option<Vec<DVec3>>, Fault> {
    let accessor = |semantic: &str| primitive["attributes"].get(semantic).and_then(as_index);
    let (Some(position), Some(normal)) = (accessor("POSITION"), accessor("NORMAL")) else {
        return Ok(None);
    };
    let [positions, normals] = [document.elements(position)?, document.elements(normal)?];
    if [&positions, &normals].map(|read| read.accessor.shape) != [Shape::Vector(3); 2] {
        return Ok(None);
    }
    let positions: Vec<DVec3> = positions.vectors::<3>().map(DVec3::from).collect();
    let unit = |normal: [f64; 3]| DVec3::from(normal).normalize_or_zero();
    let normals: Vec<DVec3> = normals.vectors::<3>().map(unit).collect();
    let is_flat = |corners: &&[u32; 3]| {
        let of = |vectors: &[DVec3]| corners.map(|k| vectors.get(k as usize).copied());
        let ([Some(a), Some(b), Some(c)], of_corners) = (of(&positions), of(&normals)) else {
            return false;
        };
        let own = of_triangle([a, b, c]).unwrap_or_default();
        let is_own = |normal: Option<DVec3>| normal.is_some_and(|n| n.dot(own).abs() >= SAME);
        of_corners.into_iter().all(is_own)
    };
    let flat = triangles.iter().filter(is_flat).count();
    let is_flat = flat > 0 && flat as f64 >= MOST * triangles.len() as f64;
    Ok(is_flat.then_some(normals))
}

/// The cosine of the largest angle between a new triangle and the old ones of its corners, 73 degrees: a sliver
/// across them would show dark.
const LEAST_ALIKE: f64 = 0.3;

/// The normal of a triangle on the side of another vector; nothing where it has no area, or lies across that.
pub(super) fn on_side_of(corners: [DVec3; 3], side: DVec3) -> Option<DVec3> {
    let normal = of_triangle(corners)?;
    let cosine = normal.dot(side.normalize_or_zero());
    (cosine.abs() >= LEAST_ALIKE).then_some(normal * cosine.signum())
}

fn of_triangle([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}
