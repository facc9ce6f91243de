//! Any number of leaves: a removal order as the page draws it.
//!
//! Leaves lie in the order in which they go, the last to go first, so that the level after some
//! steps is a prefix of one index buffer for each surface; a leaf's size there is looked up in the
//! vertex shader (`page/tree.vert`), in a texture of the steps that gave it another. Both are what
//! [`prefix_buffers`](secateur_runtime::prefix_buffers) says.

use glam::DVec3;
use secateur_gltf::LeafSurface;
use secateur_model::{Foliage, LeafId, LodModel};
use serde::Serialize;

use super::geometry::{Arrays, Packed, pack_arrays, push_words};
use super::page::Look;
use super::textures::Textures;
use super::{PreviewError, page};
use crate::stream::{Leaves, Part};
use secateur_runtime::prefix_buffers::PrefixBuffers;

/// A removal order to look at, and what it removes.
#[derive(Clone, Copy, Debug)]
pub struct Continuous<'a> {
    /// What is drawn of the foliage, with its leaves: [`Tree::leaf_surfaces`](secateur_gltf::Tree::leaf_surfaces).
    pub surfaces: &'a [LeafSurface],
    /// The foliage that the order is of.
    pub foliage: &'a Foliage,
    /// All levels along the removal order of these leaves.
    pub model: &'a LodModel,
}

/// The most leaves, made ones included, that the page's textures hold.
const MOST_LEAVES: usize = 1 << 20;

/// What the script is told. Offsets are in bytes, of words that are stored as differences.
#[derive(Debug, Serialize)]
pub(super) struct PackedOrder {
    /// Steps of the order.
    steps: usize,
    /// Leaves, made ones included: places in the prefix.
    places: usize,
    surfaces: Vec<PackedLeaves>,
    /// By place: three words, the bits of its centre as f32.
    centres: usize,
    /// By place: how many sizes it has in turn.
    size_counts: usize,
    /// By place: steps after which it is gone; 2^32 - 1 if never.
    gone_after: usize,
    sizes: usize,
    /// By size: from which step on, and the bits of the linear scale as f32.
    size_steps: usize,
    size_bits: usize,
}

/// The leaves of a surface, place after place.
#[derive(Debug, Serialize)]
struct PackedLeaves {
    #[serde(flatten)]
    surface: Packed,
    leaves: usize,
    /// By leaf of it: its place, its vertices, its triangles.
    leaf_places: usize,
    leaf_vertices: usize,
    leaf_triangles: usize,
}

/// `None` where the page cannot draw it: leaves scaled as one beside their own sizes, as stochastic
/// pruning has it, or very many leaves.
pub(super) fn pack(
    shown: &Continuous<'_>,
    materials: &mut Vec<Look>,
    textures: &mut Textures,
    bytes: &mut Vec<u8>,
) -> Result<Option<PackedOrder>, PreviewError> {
    let order = shown.model.order();
    let is_scaled_as_one = (0..=order.len()).any(|k| order.survivors_area_scale_after(k) != 1.0);
    if order.is_empty() || order.name_count() > MOST_LEAVES || is_scaled_as_one {
        return Ok(None);
    }
    let buffers = PrefixBuffers::new(shown.model, shown.foliage);
    let leaves = Leaves::new(shown.surfaces, shown.foliage);
    let mut of_surfaces: Vec<Vec<(u32, Part)>> = vec![Vec::new(); shown.surfaces.len()];
    let mut centres = Vec::new();
    let originals = order.leaf_count() as usize;
    for (place, leaf) in (0..).zip(buffers.leaves()) {
        let (surface, part) = part(&leaves, shown.model, originals, *leaf);
        centres.extend(part.centre.to_array().map(f32::to_bits));
        of_surfaces[surface].push((place, part));
    }
    let mut surfaces = Vec::new();
    for (of, parts) in shown.surfaces.iter().zip(&of_surfaces) {
        if parts.is_empty() {
            continue;
        }
        let material = page::material(&of.surface.material, materials, textures)?;
        let words = |of_leaf: &dyn Fn(&(u32, Part)) -> u32| parts.iter().map(of_leaf).collect();
        let [places, vertices, triangles]: [Vec<u32>; 3] = [
            words(&|(place, _)| *place),
            words(&|(_, part)| part.vertices.len() as u32),
            words(&|(_, part)| part.triangles.len() as u32),
        ];
        surfaces.push(PackedLeaves {
            surface: pack_arrays(&arrays(of, parts), true, material, bytes),
            leaves: parts.len(),
            leaf_places: push_words(bytes, &places, 1),
            leaf_vertices: push_words(bytes, &vertices, 1),
            leaf_triangles: push_words(bytes, &triangles, 1),
        });
    }
    let counts = buffers.first_size().windows(2).map(|w| w[1] - w[0]);
    let size_counts: Vec<u32> = counts.collect();
    let [steps, bits] = [
        buffers.sizes().iter().map(|size| size.step).collect(),
        buffers.sizes().iter().map(|size| size.scale_bits).collect(),
    ]
    .map(|words: Vec<u32>| push_words(bytes, &words, 1));
    Ok(Some(PackedOrder {
        steps: order.len(),
        places: buffers.leaves().len(),
        surfaces,
        centres: push_words(bytes, &centres, 1),
        size_counts: push_words(bytes, &size_counts, 1),
        gone_after: push_words(bytes, buffers.gone_after(), 1),
        sizes: buffers.sizes().len(),
        size_steps: steps,
        size_bits: bits,
    }))
}

fn part(leaves: &Leaves<'_>, model: &LodModel, originals: usize, leaf: LeafId) -> (usize, Part) {
    match leaf.index().checked_sub(originals) {
        None => leaves.original(leaf),
        Some(made) => leaves.made(&model.order().made()[made]),
    }
}

/// The parts one after the other, with what their surface has for every vertex.
fn arrays(of: &LeafSurface, parts: &[(u32, Part)]) -> Arrays {
    let of_every = |count: usize| count == of.surface.positions.len();
    let vertices = || parts.iter().flat_map(|(_, part)| &part.vertices);
    let mut triangles = Vec::new();
    let mut first = 0;
    for (_, part) in parts {
        triangles.extend(
            part.triangles
                .iter()
                .map(|t| t.map(|corner| first + corner)),
        );
        first += part.vertices.len() as u32;
    }
    Arrays {
        ends: None,
        positions: vertices().map(|v| DVec3::from(v.position)).collect(),
        normals: of_every(of.surface.normals.len())
            .then(|| vertices().flat_map(|v| v.normal).collect()),
        uvs: of_every(of.surface.uvs.len()).then(|| vertices().map(|v| v.uv).collect()),
        colors: of_every(of.surface.colors.len())
            .then(|| vertices().flat_map(|v| v.color).collect()),
        holds: (of_every(of.surface.holds.len()) && !of.surface.holds.is_empty())
            .then(|| vertices().map(|v| v.hold).collect()),
        triangles,
    }
}
