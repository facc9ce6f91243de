//! One leaf as a mesh, and what collapses of its edges leave.

use glam::{DVec2, DVec3, Vec3};
use meshoptimizer_rs::SimplifyOptions;
use rustc_hash::FxHashMap;
use secateur_model::LeafTriangle;

use crate::edge_collapses::{IndexedTriangles, VertexAttributes};

/// How many more triangles than asked for are tried where collapses leave none.
const TRIES: usize = 4;

/// Largest number of corners at a vertex that are compared: in a fan of a million
/// triangles all meet at one, for each triangle that is left.
const MAX_CORNERS: usize = 256;

/// The corners, numbered as in [`secateur_model::CornerRef`], of the triangles that
/// collapses leave; nothing if they leave none, or all.
pub(super) fn collapsed(triangles: &[LeafTriangle], at_most: usize) -> Option<Vec<[u32; 3]>> {
    let mesh = Mesh::of(triangles)?;
    let counts = at_most..triangles.len().min(at_most + TRIES);
    let mut left = counts.map(|count| mesh.collapsed(count));
    let kept = left.find(|kept| !kept.is_empty())?;
    (kept.len() < triangles.len()).then(|| mesh.corners_of(triangles, &kept))
}

/// Vertices by corner: corners at one place of one texture coordinate are one vertex.
/// Nothing of a leaf that is a point.
pub(super) fn vertices(triangles: &[LeafTriangle]) -> Option<Vec<u32>> {
    Mesh::of(triangles).map(|mesh| mesh.indices)
}

/// What collapses of edges are to keep beside the surface.
#[derive(Clone, Copy)]
pub(crate) struct Kept<'a> {
    /// A texture that would be off by its whole width counts as much as a surface that is off by
    /// this share of the mesh's size.
    pub(crate) uv_weight: f32,
    /// A normal that would be off by its whole length counts as much as a surface that is off by
    /// this share of the mesh's size.
    pub(crate) normal_weight: f32,
    /// Which places stay.
    pub(crate) is_locked: &'a dyn Fn(DVec3) -> bool,
}

/// What collapses leave at ever fewer triangles, each half of the number before, as far down as
/// collapses get; finest first. Vertices stay where they are and keep their texture coordinates.
pub(crate) fn halvings(triangles: &[LeafTriangle], kept: Kept<'_>) -> Vec<Vec<[u32; 3]>> {
    let Some(mesh) = Mesh::of(triangles) else {
        return Vec::new();
    };
    let attributes = Attributes::of(&mesh, triangles, kept);
    let mut levels: Vec<Vec<[u32; 3]>> = Vec::new();
    let mut wanted = triangles.len() / 2;
    while wanted > 0 {
        let kept = mesh.collapsed_with(&attributes, wanted);
        let last = levels.last().map_or(triangles.len(), Vec::len);
        if !kept.is_empty() && kept.len() < last {
            levels.push(mesh.corners_of(triangles, &kept));
        }
        wanted /= 2;
    }
    levels
}

/// What collapses leave that are to get to this number of triangles, as [`halvings`] does; none if they leave
/// none, or all.
pub(crate) fn collapsed_within(
    triangles: &[LeafTriangle],
    kept: Kept<'_>,
    at_most: usize,
) -> Option<Vec<[u32; 3]>> {
    let mesh = Mesh::of(triangles)?;
    let attributes = Attributes::of(&mesh, triangles, kept);
    let kept = mesh.collapsed_with(&attributes, at_most);
    let is_coarser = !kept.is_empty() && kept.len() < triangles.len();
    is_coarser.then(|| mesh.corners_of(triangles, &kept))
}

/// A corner of what collapses leave whose vertices may move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovedCorner {
    /// The corner that it was, numbered as in [`secateur_model::CornerRef`].
    pub(crate) like: u32,
    /// Where it is, unless where it was.
    pub(crate) moved_to: Option<DVec3>,
}

/// As [`collapsed_within`], but vertices move to where the surface is off least.
pub(crate) fn collapsed_moving(
    triangles: &[LeafTriangle],
    kept: Kept<'_>,
    at_most: usize,
) -> Option<Vec<[MovedCorner; 3]>> {
    let mesh = Mesh::of(triangles)?;
    let attributes = Attributes::of(&mesh, triangles, kept);
    let (kept, positions) = mesh
        .as_indexed()
        .collapsed_moving(attributes.as_of_vertices(), 3 * at_most);
    let kept = kept.as_chunks().0;
    if kept.is_empty() || kept.len() >= triangles.len() {
        return None;
    }
    let moved = |vertex: u32| {
        let (from, to) = (mesh.positions[vertex as usize], positions[vertex as usize]);
        (from != to).then(|| mesh.place_of(to))
    };
    let corners = mesh.corners_of(triangles, kept).into_iter();
    let all = corners.zip(kept).map(|(corners, vertices)| {
        [0, 1, 2].map(|k| MovedCorner {
            like: corners[k],
            moved_to: moved(vertices[k]),
        })
    });
    Some(all.collect())
}

/// Texture coordinates and normal of a vertex.
const ATTRIBUTES: usize = 5;

/// What vertices have beside their positions.
struct Attributes {
    values: Vec<[f32; ATTRIBUTES]>,
    weights: [f32; ATTRIBUTES],
    is_locked: Vec<bool>,
}

impl Attributes {
    /// Normals are of the surface: those of the triangles that meet at a place, by area. A file may
    /// have normals for another shading; collapses drop them with their vertices or leave them.
    fn of(mesh: &Mesh, triangles: &[LeafTriangle], kept: Kept<'_>) -> Self {
        let is_sound = mesh.uvs.as_flattened().iter().all(|x| x.is_finite());
        let uv_weight = if is_sound { kept.uv_weight } else { 0.0 };
        let key = |place: DVec3| place.to_array().map(|v| (v + 0.0).to_bits());
        let mut normals: FxHashMap<[u64; 3], DVec3> = FxHashMap::default();
        for triangle in triangles {
            let [a, b, c] = triangle.corners;
            let by_area = (b - a).cross(c - a);
            for corner in triangle.corners {
                *normals.entry(key(corner)).or_default() += by_area;
            }
        }
        let mut values = vec![[0.0; ATTRIBUTES]; mesh.positions.len()];
        let mut is_locked = vec![false; mesh.positions.len()];
        let corners = triangles.iter().flat_map(|t| t.corners);
        for (&vertex, corner) in mesh.indices.iter().zip(corners) {
            let vertex = vertex as usize;
            let normal = normals[&key(corner)].normalize_or_zero().as_vec3();
            let [u, v] = mesh.uvs[vertex];
            values[vertex] = [u, v, normal.x, normal.y, normal.z];
            is_locked[vertex] = (kept.is_locked)(corner);
        }
        let n = kept.normal_weight;
        Self {
            values,
            weights: [uv_weight, uv_weight, n, n, n],
            is_locked,
        }
    }
}

impl Attributes {
    fn as_of_vertices(&self) -> VertexAttributes<'_, ATTRIBUTES> {
        VertexAttributes {
            values: &self.values,
            weights: &self.weights,
            is_locked: &self.is_locked,
        }
    }
}

/// A leaf by its vertices: corners at one place of one texture coordinate.
struct Mesh {
    origin: DVec3,
    /// How far the furthest corner is from the first, in world units.
    size: f64,
    /// Relative to the first corner, the furthest at 1.
    positions: Vec<[f32; 3]>,
    /// Texture coordinates, relative to those of the first corner.
    uvs: Vec<[f32; 2]>,
    /// For each corner of each triangle, the number of its vertex.
    indices: Vec<u32>,
}

impl Mesh {
    /// Nothing of a leaf that is a point.
    fn of(triangles: &[LeafTriangle]) -> Option<Self> {
        let corners = || triangles.iter().flat_map(|t| t.corners);
        let origin = triangles[0].corners[0];
        let size = corners()
            .map(|corner| (corner - origin).length())
            .fold(0.0, f64::max);
        let uv_origin = triangles[0].uvs[0];
        let mut positions: Vec<[f32; 3]> = Vec::new();
        let mut vertex_uvs: Vec<[f32; 2]> = Vec::new();
        let mut known: FxHashMap<[u64; 5], u32> = FxHashMap::default();
        let uvs = triangles.iter().flat_map(|t| t.uvs);
        let vertex = |(position, uv): (DVec3, DVec2)| {
            let DVec3 { x, y, z } = position;
            let key = [x, y, z, uv.x, uv.y].map(|v| (v + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                positions.push(((position - origin) / size).as_vec3().to_array());
                vertex_uvs.push((uv - uv_origin).as_vec2().to_array());
                positions.len() as u32 - 1
            })
        };
        let indices = corners().zip(uvs).map(vertex).collect();
        let is_sound = positions.as_flattened().iter().all(|x| x.is_finite());
        is_sound.then_some(Self {
            origin,
            size,
            positions,
            uvs: vertex_uvs,
            indices,
        })
    }

    /// A position in world space.
    fn place_of(&self, position: [f32; 3]) -> DVec3 {
        self.origin + self.size * Vec3::from(position).as_dvec3()
    }

    fn as_indexed(&self) -> IndexedTriangles<'_> {
        IndexedTriangles {
            positions: &self.positions,
            indices: &self.indices,
        }
    }

    /// As [`Self::collapsed`], but attributes count too.
    fn collapsed_with(&self, attributes: &Attributes, triangles: usize) -> Vec<[u32; 3]> {
        let options = SimplifyOptions::ERROR_ABSOLUTE;
        let mesh = self.as_indexed();
        let kept = mesh.collapsed_with(attributes.as_of_vertices(), 3 * triangles, options);
        kept.as_chunks().0.to_vec()
    }

    /// Triangles, as vertices, that collapses to this number leave.
    fn collapsed(&self, triangles: usize) -> Vec<[u32; 3]> {
        let mesh = self.as_indexed();
        let kept = mesh.collapsed(3 * triangles, SimplifyOptions::EMPTY);
        kept.as_chunks().0.to_vec()
    }

    /// For each vertex of each triangle that is left a corner of the leaf: of the first at
    /// that vertex, the one whose own triangle faces the most like it, so that fronts
    /// do not get the normals of backs.
    fn corners_of(&self, triangles: &[LeafTriangle], kept: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut corners_at: Vec<Vec<u32>> = vec![Vec::new(); self.positions.len()];
        for (vertex, corner) in self.indices.iter().zip(0..) {
            corners_at[*vertex as usize].push(corner);
        }
        let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let normals: Vec<DVec3> = triangles.iter().map(|t| normal(t.corners)).collect();
        let of_triangle = |t: &[u32; 3]| {
            let facing = normal(t.map(|vertex| position(corners_at[vertex as usize][0])));
            t.map(|vertex| {
                let mut best = (f64::NEG_INFINITY, 0);
                for &corner in corners_at[vertex as usize].iter().take(MAX_CORNERS) {
                    let likeness = facing.dot(normals[corner as usize / 3]);
                    if likeness > best.0 {
                        best = (likeness, corner);
                    }
                }
                best.1
            })
        };
        kept.iter().map(of_triangle).collect()
    }
}
