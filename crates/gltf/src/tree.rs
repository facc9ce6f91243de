//! A glTF tree whose leaves are known.

use std::ops::Range;
use std::path::Path;

use super::levels_inside::LevelsInside;
use super::parts::Part;
use super::write::old_normals::NormalsOfParts;
use super::{Document, GltfError, Inspection, Selector};
use secateur_model::{Foliage, Leaf, LeafId, Memory};

/// A glTF file with its leaves found.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(crate) document: Document,
    /// Every drawn primitive of the plant, in traversal order.
    pub(crate) parts: Vec<Part>,
    /// What is drawn and not the plant, likewise.
    pub(crate) others: Vec<Part>,
    /// The coarser levels that the file has, which are left out.
    pub(crate) levels_inside: LevelsInside,
    pub(crate) foliage: Foliage,
    /// Where each leaf comes from, leaf 1 first.
    pub(crate) leaf_sources: Vec<LeafSource>,
    /// Triangle numbers that `leaf_sources` point into.
    pub(crate) leaf_triangles: Vec<u32>,
    /// From this leaf on they are pieces of wood.
    pub(crate) first_of_wood: LeafId,
    /// What writing a level found out about the normals of parts.
    pub(crate) old_normals: NormalsOfParts,
    pub(crate) inspection: Inspection,
}

/// The triangles of a leaf: numbers within the triangle list of its part's
/// primitive (`Document::triangles`), ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LeafSource {
    /// The part that it belongs to, as an index in [`Tree::parts`].
    pub(crate) part: u32,
    /// The range of [`Tree::leaf_triangles`] that names its triangles.
    pub(crate) triangles: Range<u32>,
}

impl Tree {
    /// Reads a .glb or .gltf file and finds its leaves.
    ///
    /// # Errors
    /// [`GltfError`] as [`Document::open`] and [`Document::into_tree`].
    pub fn open(path: &Path, selectors: &[Selector]) -> Result<Self, GltfError> {
        Document::open(path)?.into_tree(selectors)
    }

    /// [`open`](Self::open), with this much memory.
    ///
    /// # Errors
    /// [`GltfError`] as [`Document::open_within`] and [`Document::into_tree`].
    pub fn open_within(
        path: &Path,
        selectors: &[Selector],
        memory: Memory,
    ) -> Result<Self, GltfError> {
        Document::open_within(path, memory)?.into_tree(selectors)
    }

    /// What the tree leaves of the memory that it was opened with: what its
    /// simplification may take.
    pub fn memory_left(&self) -> Memory {
        let triangles = size_of_val(self.foliage.triangles());
        let leaves = self.foliage.leaves().len() * (size_of::<Leaf>() + size_of::<LeafSource>());
        let parts = self.parts.len() * size_of::<Part>();
        let held = (triangles + leaves + parts) as u64;
        Memory::Bytes(self.document.budget.left().saturating_sub(held))
    }

    /// The file as it was found.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The leaves in world space, in file order: parts in the scene's
    /// depth-first order, within a part by lowest triangle.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// What is in the file, and what was taken for foliage and why.
    pub fn inspection(&self) -> &Inspection {
        &self.inspection
    }

    /// Triangles of leaves, every instance counted.
    pub fn leaf_triangle_count(&self) -> u64 {
        self.foliage.triangles().len() as u64
    }

    /// Triangles of everything else, every instance counted.
    pub fn wood_triangle_count(&self) -> u64 {
        self.inspection.wood_triangles
    }

    /// All triangles of the plant, every instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.leaf_triangle_count() + self.wood_triangle_count()
    }

    /// The triangles of a leaf, as numbers in the triangle list of its part's
    /// primitive.
    pub(crate) fn triangles_of(&self, source: &LeafSource) -> &[u32] {
        &self.leaf_triangles[source.triangles.start as usize..source.triangles.end as usize]
    }
}
