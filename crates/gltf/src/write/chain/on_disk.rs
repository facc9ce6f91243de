//! Putting a chain on disk.

use std::path::{Path, PathBuf};

use super::super::problem::WriteProblem;
use super::{Layout, Level};
use crate::Document;
use crate::error::{GltfError, Problem};
use crate::inspection::Inspection;
use crate::tree::Tree;
use secateur_model::{Foliage, Lod};

/// The files of a chain that were written, and what they hold.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct WrittenChain {
    /// Triangles of each level, finest first, each instance counted.
    pub triangles: Vec<u64>,
    /// Bytes of all files that were written.
    pub bytes: u64,
    /// The files of the levels, then what they need beside them.
    pub files: Vec<PathBuf>,
    /// What is not as one might expect, a sentence each.
    pub notes: Vec<String>,
}

impl Tree {
    /// Writes a chain: to the folder `path` in the layout of files, to the file
    /// `path` in the others. Its name ends in .glb or .gltf.
    ///
    /// As [`chain_to_bytes`](Self::chain_to_bytes) and
    /// [`write_lod`](Self::write_lod).
    ///
    /// # Errors
    /// [`GltfError`] as these.
    ///
    /// # Panics
    /// If a level is of another number of leaves.
    pub fn write_chain(
        &self,
        name: &str,
        levels: &[Level],
        layout: Layout,
        path: &Path,
    ) -> Result<WrittenChain, GltfError> {
        let chain = self.chain_to_bytes(name, levels, layout)?;
        let mut written = WrittenChain {
            triangles: chain.triangles,
            bytes: 0,
            files: Vec::new(),
            notes: chain.notes,
        };
        let mut beside = Vec::new();
        for file in chain.files {
            let path = match layout {
                Layout::Files => path.join(&file.name),
                Layout::Siblings | Layout::Msft => path.to_owned(),
            };
            self.check_no_buffer(&path)?;
            let one = self.as_written(file.bytes)?;
            let one = one.write_lod(&Lod::original(0), &path)?;
            written.bytes += one.bytes;
            let mut files = one.files.into_iter();
            written.files.extend(files.next());
            beside.extend(files);
            written.notes.extend(one.notes);
        }
        beside.retain(|file| !written.files.contains(file));
        beside.dedup();
        written.files.extend(beside);
        written.notes = super::without_repeats(written.notes);
        Ok(written)
    }

    /// A file of the chain as a tree without foliage, which the writer of levels
    /// writes as it is. It has the name of the input, whose files the writer
    /// therefore knows.
    fn as_written(&self, glb: Vec<u8>) -> Result<Tree, GltfError> {
        let document =
            Document::from_bytes(&self.document.name, glb, self.document.base_dir.as_deref())?;
        let parts = document.parts().map_err(|fault| document.error(fault))?;
        Ok(Tree {
            document,
            parts,
            foliage: Foliage::new(Vec::new()),
            leaf_sources: Vec::new(),
            leaf_triangles: Vec::new(),
            inspection: Inspection::default(),
        })
    }

    /// The writer knows the input's buffers no more: they are in the chain now.
    fn check_no_buffer(&self, path: &Path) -> Result<(), GltfError> {
        let inputs: Vec<PathBuf> = self
            .document
            .files()
            .iter()
            .filter_map(|file| std::fs::canonicalize(file).ok())
            .collect();
        let is_input = |path: &Path| std::fs::canonicalize(path).is_ok_and(|p| inputs.contains(&p));
        if is_input(path) || is_input(&path.with_extension("bin")) {
            let problem = Problem::from(WriteProblem::IsInput);
            return Err(GltfError::new(&path.display().to_string(), problem));
        }
        Ok(())
    }
}
