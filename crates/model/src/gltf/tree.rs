//! A glTF tree whose leaves are known.

use std::ops::Range;

use glam::DMat4;

use super::Document;
use crate::Foliage;

/// A glTF file with its leaves found.
#[derive(Debug)]
pub struct Tree {
    pub(crate) document: Document,
    /// Every drawn primitive, in traversal order.
    pub(crate) parts: Vec<Part>,
    pub(crate) foliage: Foliage,
    /// Where each leaf comes from, leaf 1 first.
    pub(crate) leaf_sources: Vec<LeafSource>,
    /// Triangle numbers that `leaf_sources` point into.
    pub(crate) leaf_triangles: Vec<u32>,
}

/// One primitive as one node (or one instance of it) draws it.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Index in `nodes`.
    pub(crate) node: usize,
    /// Which instance, where the node has EXT_mesh_gpu_instancing.
    pub(crate) instance: Option<usize>,
    /// Index in `meshes`.
    pub(crate) mesh: usize,
    /// Index in the mesh's `primitives`.
    pub(crate) primitive: usize,
    /// From the primitive's own space to world space.
    pub(crate) world_from_local: DMat4,
    pub(crate) is_foliage: bool,
}

/// The triangles of a leaf: numbers within the triangle list of its part's
/// primitive (`Document::triangles`), ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LeafSource {
    /// Index in [`Tree::parts`].
    pub(crate) part: u32,
    /// Range of [`Tree::leaf_triangles`].
    pub(crate) triangles: Range<u32>,
}

impl Tree {
    /// The leaves in world space.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// The triangles of a leaf, as numbers in the triangle list of its part's
    /// primitive.
    pub(crate) fn triangles_of(&self, source: &LeafSource) -> &[u32] {
        &self.leaf_triangles[source.triangles.start as usize..source.triangles.end as usize]
    }
}
