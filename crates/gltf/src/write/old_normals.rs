//! Normals of new triangles of solid surfaces: each has its own where the old ones are flat-shaded, and where those of
//! its corners say nothing of it.

use std::sync::{Arc, OnceLock};

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

/// The least part of its corners' mean normal that lies along the normal of a new triangle of a smooth surface. A prism of
/// three sides has .5; a flat strip of a twig has 0, and would be lit as if from its edges.
const LEAST_ALONG: f64 = 0.4;

/// The least share of the old triangles that have [`LEAST_ALONG`] where normals follow the surface. Of `quat_commontree_1`
/// .85 have: its bark is shaded as it is on purpose.
const LEAST_FOLLOWING: f64 = 0.95;

/// The normals of the parts of a tree that levels asked for: the same for every level.
#[derive(Clone, Debug)]
pub(crate) struct NormalsOfParts(Vec<OnceLock<Option<Arc<OldNormals>>>>);

impl NormalsOfParts {
    /// A tree of this number of parts, of none of which a level asked for the normals yet.
    pub(crate) fn of(parts: usize) -> Self {
        Self(vec![OnceLock::new(); parts])
    }

    /// Normals of a part, which is this primitive of the document; nothing where there are none.
    pub(super) fn of_part(
        &self,
        part: usize,
        document: &Document,
        primitive: &Value,
        triangles: &[[u32; 3]],
    ) -> Result<Option<Arc<OldNormals>>, Fault> {
        if let Some(known) = self.0[part].get() {
            return Ok(known.clone());
        }
        let found = OldNormals::of(document, primitive, triangles)?.map(Arc::new);
        Ok(self.0[part].get_or_init(|| found).clone())
    }
}

/// The normals of a primitive.
#[derive(Debug)]
pub(crate) struct OldNormals {
    /// The normal of each vertex, of unit length.
    normals: Vec<DVec3>,
    /// Whether the corners of each triangle have the normal of the triangle itself.
    is_flat: Vec<bool>,
    /// Whether facets are meant.
    is_faceted: bool,
    /// Whether normals of smooth triangles follow the surface.
    is_following: bool,
    /// 1 where triangles face as their normals do, for the most part, else -1.
    facing: f64,
}

impl OldNormals {
    /// Nothing where there are no normals.
    fn of(
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
        let along = |corners: &[u32; 3]| {
            let of = |vectors: &[DVec3]| corners.map(|k| vectors.get(k as usize).copied());
            let ([Some(a), Some(b), Some(c)], of_corners) = (of(&positions), of(&normals)) else {
                return [0.0; 3];
            };
            let own = of_triangle([a, b, c]).unwrap_or_default();
            of_corners.map(|normal| normal.map_or(0.0, |n| n.dot(own)))
        };
        let along: Vec<[f64; 3]> = triangles.iter().map(along).collect();
        let is_flat = |along: &[f64; 3]| along.iter().all(|cosine| cosine.abs() >= SAME);
        let is_flat: Vec<bool> = along.iter().map(is_flat).collect();
        let flat = is_flat.iter().filter(|is_flat| **is_flat).count();
        let along = along.iter().map(|of| of.iter().sum::<f64>() / 3.0);
        let along: Vec<f64> = along.collect();
        let facing = along.iter().sum::<f64>().signum();
        let following = along.iter().filter(|along| facing * **along >= LEAST_ALONG);
        let share = following.count() as f64 / triangles.len() as f64;
        Ok(Some(Self {
            normals,
            is_faceted: flat > 0 && flat as f64 >= LEAST * triangles.len() as f64,
            is_flat,
            is_following: share >= LEAST_FOLLOWING,
            facing,
        }))
    }

    /// Whether facets are meant, and these vertices are of several.
    pub(super) fn are_facets(&self, vertices: [u32; 3]) -> bool {
        let [a, b, c] = vertices.map(|k| self.normals.get(k as usize).copied().unwrap_or_default());
        self.is_faceted && (a.dot(b).abs() < SAME || a.dot(c).abs() < SAME)
    }

    /// The normal of a new triangle with these corners, each of which has the normal of a vertex, of an old triangle;
    /// nothing where it keeps those, or has no area.
    pub(super) fn normal_of(
        &self,
        corners: [DVec3; 3],
        of_triangles: [u32; 3],
        of_vertices: [u32; 3],
    ) -> Option<DVec3> {
        let normals = of_vertices
            .iter()
            .filter_map(|&k| self.normals.get(k as usize));
        let of_corners: DVec3 = normals.sum();
        let normal = of_triangle(corners)?;
        let is_flat = |triangle: &u32| self.is_flat[*triangle as usize];
        if self.is_faceted && of_triangles.iter().all(is_flat) {
            let cosine = normal.dot(of_corners.normalize_or_zero());
            return (cosine.abs() >= LEAST_ALIKE).then_some(normal * cosine.signum());
        }
        let outward = normal * self.facing;
        let is_lost = self.is_following && outward.dot(of_corners) < 3.0 * LEAST_ALONG;
        is_lost.then_some(outward)
    }
}

fn of_triangle([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}
