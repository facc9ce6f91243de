//! Normals of new triangles where the old ones are flat-shaded: each triangle has its own.

use glam::DVec3;
use serde_json::Value;

use super::references::as_index;
use crate::Document;
use crate::accessor::Shape;
use crate::error::Fault;

/// The cosine of the largest angle between normals that are taken for the same, 2.6 degrees.
const SAME: f64 = 0.999;

/// The least share of flat-shaded triangles of a primitive whose facets are meant: smooth ones have flat ends.
const LEAST: f64 = 0.5;

/// The cosine of the largest angle between a new triangle and the old ones of its corners, 73 degrees: a sliver
/// across them would show dark.
const LEAST_ALIKE: f64 = 0.3;

/// A primitive of which many triangles are flat-shaded.
pub(super) struct FlatShaded {
    /// The normal of each vertex, of unit length.
    normals: Vec<DVec3>,
    /// Whether the corners of each triangle have the normal of the triangle itself.
    is_flat: Vec<bool>,
}

impl FlatShaded {
    /// Nothing where most triangles are smooth, or have normals that are not their own.
    pub(super) fn of(
        document: &Document,
        primitive: &Value,
        triangles: &[[u32; 3]],
    ) -> Result<Option<Self>, Fault> {
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
        let is_flat = |corners: &[u32; 3]| {
            let of = |vectors: &[DVec3]| corners.map(|k| vectors.get(k as usize).copied());
            let ([Some(a), Some(b), Some(c)], of_corners) = (of(&positions), of(&normals)) else {
                return false;
            };
            let own = of_triangle([a, b, c]).unwrap_or_default();
            let is_own = |normal: Option<DVec3>| normal.is_some_and(|n| n.dot(own).abs() >= SAME);
            of_corners.into_iter().all(is_own)
        };
        let is_flat: Vec<bool> = triangles.iter().map(is_flat).collect();
        let flat = is_flat.iter().filter(|is_flat| **is_flat).count();
        let is_meant = flat > 0 && flat as f64 >= LEAST * triangles.len() as f64;
        Ok(is_meant.then_some(Self { normals, is_flat }))
    }

    /// Whether these vertices have one normal.
    pub(super) fn is_one_plane(&self, vertices: [u32; 3]) -> bool {
        let [a, b, c] = vertices.map(|k| self.normals[k as usize]);
        a.dot(b).abs() >= SAME && a.dot(c).abs() >= SAME
    }

    /// The normal of a new triangle with these corners that is like three old ones at these vertices; nothing where one
    /// of them is smooth, or it has no area or lies across them.
    pub(super) fn normal_of(
        &self,
        corners: [DVec3; 3],
        like: [u32; 3],
        vertices: [u32; 3],
    ) -> Option<DVec3> {
        if !like.iter().all(|&triangle| self.is_flat[triangle as usize]) {
            return None;
        }
        let side: DVec3 = vertices.iter().map(|&k| self.normals[k as usize]).sum();
        let normal = of_triangle(corners)?;
        let cosine = normal.dot(side.normalize_or_zero());
        (cosine.abs() >= LEAST_ALIKE).then_some(normal * cosine.signum())
    }
}

fn of_triangle([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}
