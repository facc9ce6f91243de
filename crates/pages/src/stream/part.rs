//! Parts of a plant, each by itself: leaves and connected pieces of wood.

use glam::{DVec3, Vec2, Vec3, Vec4};
use secateur_gltf::LeafSurface;
use secateur_model::{CornerRef, Foliage, Hold, LeafId, NewCorner, NewLeaf, Place, Surface};

use crate::preview::octahedral;
use secateur_runtime::wind::NOTHING;

/// A vertex as it is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vertex {
    pub(crate) position: Vec3,
    pub(crate) normal: [u16; 2],
    pub(crate) uv: Vec2,
    pub(crate) color: [u16; 4],
    pub(crate) hold: Hold,
}

/// A part of a plant at its own size.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// What it is scaled about.
    pub(crate) centre: Vec3,
    pub(crate) vertices: Vec<Vertex>,
    /// Corners among its own vertices.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A vertex of a surface; white, upward and hanging on nothing where it has no colours, normals or
/// holds.
pub(super) fn vertex_of(surface: &Surface, index: u32) -> Vertex {
    let index = index as usize;
    let color = surface.colors.get(index).copied().unwrap_or(Vec4::ONE);
    let unorm = |x: f32| (x.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16;
    Vertex {
        position: surface.positions[index].as_vec3(),
        normal: octahedral(surface.normals.get(index).copied().unwrap_or(Vec3::Y)),
        uv: surface.uvs.get(index).copied().unwrap_or_default(),
        color: color.to_array().map(unorm),
        hold: surface.holds.get(index).copied().unwrap_or(NOTHING),
    }
}

/// The part of these triangles of a surface.
pub(super) fn part_of(surface: &Surface, triangles: &[u32], centre: DVec3) -> Part {
    let mut numbers: Vec<u32> = Vec::new();
    let corners = triangles.iter().map(|t| surface.triangles[*t as usize]);
    // A leaf has few vertices, wood has many: sorted, both are found fast.
    numbers.extend(corners.clone().flatten());
    numbers.sort_unstable();
    numbers.dedup();
    let own = |corner: u32| numbers.partition_point(|n| *n < corner) as u32;
    Part {
        centre: centre.as_vec3(),
        triangles: corners.map(|t| t.map(own)).collect(),
        vertices: numbers.iter().map(|n| vertex_of(surface, *n)).collect(),
    }
}

/// Where leaves lie in surfaces.
pub(crate) struct Leaves<'a> {
    surfaces: &'a [LeafSurface],
    foliage: &'a Foliage,
    /// By leaf: its surface, and its place in that one's list.
    places: Vec<(u32, u32)>,
}

impl<'a> Leaves<'a> {
    /// # Panics
    /// If the surfaces are not those of this foliage.
    pub(crate) fn new(surfaces: &'a [LeafSurface], foliage: &'a Foliage) -> Self {
        let mut places = vec![(u32::MAX, 0); foliage.leaves().len()];
        for (number, surface) in surfaces.iter().enumerate() {
            for (place, leaf) in surface.leaves.iter().enumerate() {
                places[leaf.leaf.index()] = (number as u32, place as u32);
            }
        }
        assert!(places.iter().all(|place| place.0 != u32::MAX));
        Self {
            surfaces,
            foliage,
            places,
        }
    }

    /// The surface of an original leaf, and the leaf.
    pub(crate) fn original(&self, leaf: LeafId) -> (usize, Part) {
        let (number, place) = self.places[leaf.index()];
        let of = &self.surfaces[number as usize];
        let triangles = &of.leaves[place as usize].triangles;
        let centre = self.foliage.leaf(leaf).centre();
        (number as usize, part_of(&of.surface, triangles, centre))
    }

    /// The surface of a leaf that was made, its donor's, and the leaf.
    pub(crate) fn made(&self, made: &NewLeaf) -> (usize, Part) {
        let (number, place) = self.places[made.donor.index()];
        let of = &self.surfaces[number as usize];
        let donor = &of.leaves[place as usize];
        // Corners are counted in the foliage's order.
        let corners: Vec<u32> = donor
            .triangles
            .iter()
            .flat_map(|t| turned(of.surface.triangles[*t as usize], donor.is_mirrored))
            .collect();
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut number_of = |corner: &NewCorner| {
            let vertex = self.made_vertex(made.donor, corner, &of.surface, &corners);
            let known = vertices.iter().position(|other| *other == vertex);
            known.unwrap_or_else(|| {
                vertices.push(vertex);
                vertices.len() - 1
            }) as u32
        };
        let triangles: Vec<[u32; 3]> = made
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = [&t[0], &t[1], &t[2]].map(&mut number_of);
                turned([a, b, c], donor.is_mirrored)
            })
            .collect();
        let mut alone = Foliage::default();
        let placed = made.triangles_in(self.foliage, 1.0);
        let leaf = alone.push_leaf(&placed, None);
        let leaf = leaf.expect("a leaf of finite corners");
        let part = Part {
            centre: alone.leaf(leaf).centre().as_vec3(),
            vertices,
            triangles,
        };
        (number as usize, part)
    }

    /// As the writer of glTF places it: attributes are those of the corner that it is like, or sums
    /// of the donor's.
    fn made_vertex(
        &self,
        donor: LeafId,
        corner: &NewCorner,
        surface: &Surface,
        corners: &[u32],
    ) -> Vertex {
        let mut vertex = vertex_of(surface, corners[corner.like as usize]);
        match corner.place {
            Place::Of(at) => vertex.position = at.position(self.foliage).as_vec3(),
            Place::At(position) => vertex.position = position.as_vec3(),
            Place::InPlaneOf {
                corners: plane,
                weights,
            } => {
                let leaf = donor;
                let mut position = DVec3::ZERO;
                let mut uv = glam::DVec2::ZERO;
                let mut normal = DVec3::ZERO;
                for k in 0..3 {
                    let corner = plane[k];
                    let index = corners[corner as usize] as usize;
                    let at = CornerRef { leaf, corner }.position(self.foliage);
                    position += weights[k] * at;
                    if let Some(corner_uv) = surface.uvs.get(index) {
                        uv += weights[k] * corner_uv.as_dvec2();
                    }
                    if let Some(corner_normal) = surface.normals.get(index) {
                        normal += weights[k] * corner_normal.as_dvec3();
                    }
                }
                vertex.position = position.as_vec3();
                vertex.uv = uv.as_vec2();
                if let Some(normal) = normal.try_normalize() {
                    vertex.normal = octahedral(normal.as_vec3());
                }
            }
        }
        vertex
    }
}

fn turned([a, b, c]: [u32; 3], is_mirrored: bool) -> [u32; 3] {
    match is_mirrored {
        true => [a, c, b],
        false => [a, b, c],
    }
}
