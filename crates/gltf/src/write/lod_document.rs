//! A LOD as a document, to be looked at.

use std::sync::Arc;

use super::content::lod_content;
use super::cutoffs::Cutoffs;
use crate::binary_chunk::BinaryChunk;
use crate::container::Unpacked;
use crate::document::Document;
use crate::error::{ALLOW_MORE, Fault, GltfError, Problem};
use crate::tree::Tree;
use secateur_model::{Budget, Lod};

impl Tree {
    /// The tree with the leaves of a LOD as a document: that of [`lod_to_bytes`](Self::lod_to_bytes),
    /// without writing and reading it. Images that this tree's document [keeps](Document::keep_images)
    /// are not decoded again.
    ///
    /// # Errors
    /// As [`lod_to_bytes`](Self::lod_to_bytes), and if it takes more memory than the document was opened
    /// with.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn lod_document(&self, lod: &Lod) -> Result<Document, GltfError> {
        self.lod_document_with(lod, &Cutoffs::default())
    }

    /// [`lod_document`](Self::lod_document) with alpha cutoffs and textures of its own.
    ///
    /// # Errors
    /// As [`lod_document`](Self::lod_document).
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn lod_document_with(&self, lod: &Lod, changes: &Cutoffs) -> Result<Document, GltfError> {
        let original = &self.document;
        let made = || -> Result<Document, Fault> {
            let content = lod_content(self, lod, changes)?;
            let mut budget = Budget::new(original.memory);
            let bytes = content.buffer.len() as u64;
            let taken = budget.take(bytes, || "the level".to_owned(), ALLOW_MORE);
            taken.map_err(Problem::from)?;
            let unpacked = Unpacked {
                root: content.root,
                chunk: (bytes > 0).then_some(BinaryChunk::Memory(content.buffer)),
                memory: original.memory,
                budget,
            };
            let folder = original.base_dir.as_deref();
            let mut document = Document::from_unpacked(&original.name, unpacked, folder)?;
            // Images keep their numbers, unless some are others.
            if changes.is_empty() {
                document.kept_images = Arc::clone(&original.kept_images);
            }
            document.selectors.clone_from(&original.selectors);
            document.vertex_alpha_counts = original.vertex_alpha_counts;
            Ok(document)
        };
        made().map_err(|fault| original.error(fault))
    }
}
