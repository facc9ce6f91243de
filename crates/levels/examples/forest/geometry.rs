//! What of a plant goes to the GPU: leaves, or pieces of wood, as vertices and indices.

use std::collections::HashMap;

use glam::DVec3;
use secateur_model::{Foliage, LeafId, LodModel, Surface};
use secateur_runtime::prefix_buffers::PrefixBuffers;

/// As the shader reads it: 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Vertex {
    position: [f32; 3],
    normal: [i8; 4],
    color: [u8; 4],
    uv: [f32; 2],
    /// The place of its leaf among [`PrefixBuffers::leaves`].
    place: u32,
}

/// An indexed triangle mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) indices: Vec<u32>,
}

/// A triangle by the bits of its corners.
type TriangleKey = [[u64; 3]; 3];

fn key(corners: [DVec3; 3]) -> TriangleKey {
    corners.map(|corner| corner.to_array().map(f64::to_bits))
}

/// The leaves of a plant, or its pieces of wood, with all their levels.
#[derive(Debug)]
pub(crate) struct PlantPart {
    pub(crate) foliage: Foliage,
    pub(crate) model: LodModel,
    pub(crate) prefix: PrefixBuffers,
    pub(crate) surface: Surface,
    /// For each corner of each triangle of the foliage its vertex in the surface.
    vertex_of: Vec<[u32; 3]>,
    /// Where the triangles of each leaf begin there.
    first_triangle: Vec<usize>,
}

impl PlantPart {
    /// Finds the triangles of the foliage in the surface that they are drawn as.
    pub(crate) fn new(foliage: Foliage, model: LodModel, surface: Surface) -> Result<Self, String> {
        let drawn: HashMap<TriangleKey, [u32; 3]> = surface
            .triangles
            .iter()
            .map(|t| (key(t.map(|corner| surface.positions[corner as usize])), *t))
            .collect();
        let vertex_of: Option<Vec<[u32; 3]>> = foliage
            .triangles()
            .iter()
            .map(|triangle| drawn.get(&key(triangle.corners)).copied())
            .collect();
        let vertex_of = vertex_of.ok_or("a leaf is drawn in another material than the rest")?;
        let mut first_triangle = vec![0];
        for index in 0..foliage.leaves().len() {
            let count = foliage.triangles_of(LeafId::from_index(index)).len();
            first_triangle.push(first_triangle[index] + count);
        }
        Ok(Self {
            prefix: PrefixBuffers::new(&model, &foliage),
            foliage,
            model,
            surface,
            vertex_of,
            first_triangle,
        })
    }

    fn vertex(&self, position: DVec3, like: u32, place: usize) -> Vertex {
        let like = like as usize;
        let surface = &self.surface;
        let normal = surface.normals.get(like).copied().unwrap_or(glam::Vec3::Y);
        let color = surface.colors.get(like).copied().unwrap_or(glam::Vec4::ONE);
        let base = glam::Vec4::from_array(surface.material.base_color);
        let uv = surface.uvs.get(like).copied().unwrap_or_default();
        let [x, y, z] = normal.to_array().map(|v| (v * 127.0).round() as i8);
        Vertex {
            position: position.as_vec3().to_array(),
            normal: [x, y, z, 0],
            color: (color * base)
                .to_array()
                .map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8),
            uv: uv.to_array(),
            place: place as u32,
        }
    }

    /// A leaf, original or made, at a size; adds it to a mesh.
    fn push(&self, mesh: &mut Mesh, leaf: LeafId, area_scale: f64, place: usize) {
        let originals = self.foliage.leaves().len();
        let mut known: HashMap<(u32, [u64; 3]), u32> = HashMap::new();
        let mut push = |position: DVec3, like: u32| {
            let bits = position.to_array().map(f64::to_bits);
            let index = *known.entry((like, bits)).or_insert_with(|| {
                mesh.vertices.push(self.vertex(position, like, place));
                mesh.vertices.len() as u32 - 1
            });
            mesh.indices.push(index);
        };
        match leaf.index().checked_sub(originals) {
            None => {
                let triangles = self.foliage.triangles_of(leaf);
                let centre = self.foliage.leaf(leaf).centre();
                let vertices = &self.vertex_of[self.first_triangle[leaf.index()]..];
                let scale = area_scale.sqrt();
                for (triangle, vertices) in triangles.iter().zip(vertices) {
                    for (corner, like) in triangle.corners.iter().zip(vertices) {
                        push(centre + (*corner - centre) * scale, *like);
                    }
                }
            }
            Some(made) => {
                let made = &self.model.order().made()[made];
                let first = self.first_triangle[made.donor.index()];
                let triangles = made.triangles_in(&self.foliage, area_scale);
                for (triangle, corners) in triangles.iter().zip(&made.triangles) {
                    for (position, corner) in triangle.corners.iter().zip(corners) {
                        let like = corner.like as usize;
                        push(*position, self.vertex_of[first + like / 3][like % 3]);
                    }
                }
            }
        }
    }

    /// All leaves in the order of [`PrefixBuffers::leaves`], and for each place where its indices
    /// begin, and one more.
    pub(crate) fn prefix_mesh(&self) -> (Mesh, Vec<u32>) {
        let mut mesh = Mesh::default();
        let mut first_index = vec![0];
        for (place, leaf) in self.prefix.leaves().iter().enumerate() {
            self.push(&mut mesh, *leaf, 1.0, place);
            first_index.push(mesh.indices.len() as u32);
        }
        (mesh, first_index)
    }

    /// The centre of each leaf by its place; that of a made one about which it grows.
    pub(crate) fn centres(&self) -> Vec<[f32; 4]> {
        let originals = self.foliage.leaves().len();
        let centre = |leaf: &LeafId| match leaf.index().checked_sub(originals) {
            None => self.foliage.leaf(*leaf).centre(),
            Some(made) => {
                let made = &self.model.order().made()[made];
                let mut alone = Foliage::new(self.foliage.cutouts().to_vec());
                let triangles = made.triangles_in(&self.foliage, 1.0);
                let pushed = alone.push_leaf_like(&triangles, self.foliage.leaf(made.donor));
                pushed.map_or(DVec3::ZERO, |leaf| alone.leaf(leaf).centre())
            }
        };
        let centres = self.prefix.leaves().iter().map(centre);
        centres
            .map(|c| c.as_vec3().extend(0.0).to_array())
            .collect()
    }

    /// A level as a mesh of its own, every leaf at its size.
    pub(crate) fn lod_mesh(&self, steps: usize) -> Mesh {
        let lod = self.model.lod_after(steps);
        let mut mesh = Mesh::default();
        for (leaf, area_scale) in lod.all_leaves() {
            self.push(&mut mesh, leaf, area_scale, 0);
        }
        mesh
    }

    /// The triangles of some leaves as they are, as a surface.
    pub(crate) fn surface_of(&self, leaves: &[LeafId]) -> Surface {
        let mut surface = self.surface.clone();
        let triangles = leaves.iter().flat_map(|leaf| {
            let range = self.first_triangle[leaf.index()]..self.first_triangle[leaf.index() + 1];
            self.vertex_of[range].iter().copied()
        });
        surface.triangles = triangles.collect();
        surface
    }

    /// Three for each triangle of the largest leaf.
    pub(crate) fn most_indices(&self) -> u32 {
        let counts = self.first_triangle.windows(2).map(|w| w[1] - w[0]);
        3 * counts.max().unwrap_or(1) as u32
    }
}
