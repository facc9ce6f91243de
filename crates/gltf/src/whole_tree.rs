//! A tree whose wood can be edited too, piece by piece.

use std::path::Path;

use secateur_model::{Foliage, Lod, Memory, PlantSkeleton};

use super::{GltfError, Selector, Tree};

/// A glTF file with its leaves found, and the pieces of its wood: the sets of triangles of
/// everything else that hang together by edges.
#[derive(Clone, Debug)]
pub struct WholeTree {
    /// Of leaves and then pieces of wood, all as leaves.
    pub(crate) tree: Tree,
    pub(crate) leaves: Foliage,
    pub(crate) wood: Foliage,
}

impl WholeTree {
    /// Reads a .glb or .gltf file and finds its leaves and its pieces of wood.
    ///
    /// # Errors
    /// [`GltfError`] as [`Tree::open`].
    pub fn open(path: &Path, selectors: &[Selector]) -> Result<Self, GltfError> {
        super::Document::open(path)?.into_whole_tree(selectors)
    }

    /// [`open`](Self::open), with this much memory.
    ///
    /// # Errors
    /// [`GltfError`] as [`Tree::open_within`].
    pub fn open_within(
        path: &Path,
        selectors: &[Selector],
        memory: Memory,
    ) -> Result<Self, GltfError> {
        super::Document::open_within(path, memory)?.into_whole_tree(selectors)
    }

    /// The leaves alone, in world space.
    pub fn leaves(&self) -> &Foliage {
        &self.leaves
    }

    /// The pieces of wood, in world space.
    pub fn wood(&self) -> &Foliage {
        &self.wood
    }

    /// The tree in which pieces of wood are leaves too, after the leaves: what a [`Lod`] of
    /// [`Self::joined`] is written with.
    pub fn items(&self) -> &Tree {
        &self.tree
    }

    /// [`Self::items`], to change what it is written with.
    pub fn items_mut(&mut self) -> &mut Tree {
        &mut self.tree
    }

    /// The skeleton of the plant, if the file has one: see [`Tree::skeleton`].
    ///
    /// # Errors
    /// As [`Tree::skeleton`].
    pub fn skeleton(&self) -> Result<Option<PlantSkeleton>, GltfError> {
        let document = self.tree.document();
        document.skeleton_of(self.leaves.leaves().len())
    }

    /// A LOD of [`Self::items`] from one of the leaves and one of the wood.
    ///
    /// # Panics
    /// If they are of others.
    pub fn joined(&self, leaves: &Lod, wood: &Lod) -> Lod {
        leaves.followed_by(wood)
    }
}
