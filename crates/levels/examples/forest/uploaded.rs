//! A plant on the GPU: its prefix buffers, the meshes of its chains, the pictures of its boxes.

use rayon::prelude::*;
use secateur_levels::leaf_boxes::{PLANES, PlanePicture, diagonal_planes, picture};

use crate::geometry::{Mesh, PlantPart};
use crate::gpu::Gpu;
use crate::pipelines::{COLOR, Pipelines};
use crate::species::Species;

/// Texels a side of a box's picture (Hybrid 4.2.3: 64 or 128).
pub(crate) const PICTURE_SIDE: u32 = 64;

/// A mesh on the GPU.
pub(crate) struct UploadedMesh {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) index_count: u32,
}

/// The leaves of a plant, or its wood, as buffers on the GPU.
pub(crate) struct UploadedPart {
    pub(crate) prefix: UploadedMesh,
    /// By places, and one more.
    pub(crate) first_index: Vec<u32>,
    /// For each original leaf its place.
    pub(crate) place_of: Vec<u32>,
    pub(crate) tables: wgpu::BindGroup,
    pub(crate) material: wgpu::BindGroup,
}

/// A level of a chain.
pub(crate) struct ChainLevel {
    /// Leaves that it has.
    pub(crate) leaf_count: usize,
    pub(crate) leaves: UploadedMesh,
    pub(crate) wood: UploadedMesh,
}

/// Bytes on the GPU, by what they are for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bytes {
    pub(crate) full: u64,
    pub(crate) chain: u64,
    pub(crate) prefix: u64,
    pub(crate) boxes: u64,
    pub(crate) pictures: u64,
}

/// All of a plant.
pub(crate) struct Uploaded {
    pub(crate) leaves: UploadedPart,
    pub(crate) wood: UploadedPart,
    /// The original first, then a half of the leaves, a quarter and so on.
    pub(crate) halvings: Vec<ChainLevel>,
    /// With three quarters, a half, a quarter and an eighth of the leaves.
    pub(crate) shares: Vec<ChainLevel>,
    pub(crate) boxes: Option<wgpu::BindGroup>,
    pub(crate) bytes: Bytes,
}

/// Of L-plants' schemes: what their levels have left.
pub(crate) const SHARES: [f64; 4] = [0.75, 0.5, 0.25, 0.125];

impl UploadedMesh {
    fn new(gpu: &Gpu, mesh: &Mesh) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            vertices: gpu.buffer(&mesh.vertices, wgpu::BufferUsages::VERTEX | storage),
            indices: gpu.buffer(&mesh.indices, wgpu::BufferUsages::INDEX | storage),
            index_count: mesh.indices.len() as u32,
        }
    }
}

fn entries<'a>(bound: &'a [(u32, &'a wgpu::Buffer)]) -> Vec<wgpu::BindGroupEntry<'a>> {
    let entry = |(binding, buffer): &(u32, &'a wgpu::Buffer)| wgpu::BindGroupEntry {
        binding: *binding,
        resource: buffer.as_entire_binding(),
    };
    bound.iter().map(entry).collect()
}

impl UploadedPart {
    fn new(gpu: &Gpu, pipelines: &Pipelines, part: &PlantPart, bytes: &mut Bytes) -> Self {
        let before = gpu.bytes_made();
        let (mesh, first_index) = part.prefix_mesh();
        let prefix = UploadedMesh::new(gpu, &mesh);
        let storage = wgpu::BufferUsages::STORAGE;
        let sizes = part.prefix.sizes().iter();
        let sizes: Vec<u32> = sizes.flat_map(|s| [s.step, s.scale_bits]).collect();
        let first_size = gpu.buffer(part.prefix.first_size(), storage);
        let sizes = gpu.buffer(&sizes, storage);
        let gone_after = gpu.buffer(part.prefix.gone_after(), storage);
        let centres = gpu.buffer(&part.centres(), storage);
        let bound = [
            (1, &first_size),
            (2, &sizes),
            (3, &gone_after),
            (5, &centres),
            (6, &prefix.vertices),
            (7, &prefix.indices),
        ];
        let tables = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipelines.model,
            entries: &entries(&bound),
        });
        bytes.prefix += gpu.bytes_made() - before;
        let before = gpu.bytes_made();
        let picture = gpu.picture(part.surface.material.texture.as_deref());
        let material = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipelines.material,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&picture),
            }],
        });
        bytes.pictures += gpu.bytes_made() - before;
        let mut place_of = vec![0; part.foliage.leaves().len()];
        for (place, leaf) in part.prefix.leaves().iter().enumerate() {
            if let Some(of) = place_of.get_mut(leaf.index()) {
                *of = place as u32;
            }
        }
        Self {
            prefix,
            first_index,
            place_of,
            tables,
            material,
        }
    }
}

fn chain_level(gpu: &Gpu, species: &Species, leaves: usize) -> ChainLevel {
    let steps = species.leaves.model.steps_to(leaves);
    ChainLevel {
        leaf_count: leaves,
        leaves: UploadedMesh::new(gpu, &species.leaves.lod_mesh(steps)),
        wood: UploadedMesh::new(gpu, &species.wood.lod_mesh(species.wood_steps(leaves))),
    }
}

impl Uploaded {
    pub(crate) fn new(gpu: &Gpu, pipelines: &Pipelines, species: &Species) -> Self {
        let mut bytes = Bytes::default();
        let leaves = UploadedPart::new(gpu, pipelines, &species.leaves, &mut bytes);
        let wood = UploadedPart::new(gpu, pipelines, &species.wood, &mut bytes);
        let (most, fewest) = {
            let model = &species.leaves.model;
            (model.most_leaves(), model.fewest_leaves())
        };
        let mut halvings = Vec::new();
        let mut left = most;
        let before = gpu.bytes_made();
        while left >= fewest.max(1) {
            halvings.push(chain_level(gpu, species, left));
            if halvings.len() == 1 {
                bytes.full = gpu.bytes_made() - before;
            }
            left /= 2;
        }
        bytes.chain = gpu.bytes_made() - before;
        let shares = SHARES.map(|share| chain_level(gpu, species, (share * most as f64) as usize));
        let before = gpu.bytes_made();
        let boxes = boxes(gpu, pipelines, species);
        bytes.boxes = gpu.bytes_made() - before;
        Self {
            leaves,
            wood,
            halvings,
            shares: shares.into(),
            boxes,
            bytes,
        }
    }
}

fn boxes(gpu: &Gpu, pipelines: &Pipelines, species: &Species) -> Option<wgpu::BindGroup> {
    if species.boxes.is_empty() {
        return None;
    }
    let planes: Vec<_> = species
        .boxes
        .iter()
        .flat_map(|this| diagonal_planes(&this.bounds).map(|plane| (this, plane)))
        .collect();
    let pictures: Vec<PlanePicture> = planes
        .par_iter()
        .map(|(this, plane)| {
            let surface = species.leaves.surface_of(&this.leaves);
            picture(&[surface], plane, PICTURE_SIDE)
        })
        .collect();
    let words: Vec<[f32; 20]> = planes
        .iter()
        .zip(&pictures)
        .map(|((_, plane), picture)| {
            let mut words = [0.0; 20];
            let vectors = [plane.centre, plane.right, plane.up, plane.toward];
            for (k, vector) in vectors.iter().enumerate() {
                words[4 * k..4 * k + 3].copy_from_slice(&vector.as_vec3().to_array());
            }
            words[16] = picture.extent[0] as f32;
            words[17] = picture.extent[1] as f32;
            words
        })
        .collect();
    debug_assert_eq!(pictures.len(), PLANES * species.boxes.len());
    let planes = gpu.buffer(&words, wgpu::BufferUsages::STORAGE);
    let side = [PICTURE_SIDE; 2];
    let colors: Vec<Vec<u8>> = pictures.iter().map(|p| p.rgba.clone()).collect();
    let normals: Vec<Vec<u8>> = pictures.iter().map(|p| p.normals.clone()).collect();
    let colors = gpu.layers(side, &colors, COLOR);
    let normals = gpu.layers(side, &normals, wgpu::TextureFormat::Rgba8Unorm);
    let resources = [
        wgpu::BindingResource::TextureView(&colors),
        wgpu::BindingResource::TextureView(&normals),
        planes.as_entire_binding(),
    ];
    let entries: Vec<wgpu::BindGroupEntry<'_>> = resources
        .into_iter()
        .zip(0..)
        .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    let descriptor = wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipelines.box_pictures,
        entries: &entries,
    };
    Some(gpu.device.create_bind_group(&descriptor))
}
