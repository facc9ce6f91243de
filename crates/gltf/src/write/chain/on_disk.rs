//! Putting a chain on disk.

use std::path::{Path, PathBuf};

use super::super::cutoffs::Cutoffs;
use super::super::files::WriteOptions;
use super::super::old_normals::NormalsOfParts;
use super::super::staged_files::{CommitError, StagedFiles};
use super::{ChainFiles, Layout, Level};
use crate::Document;
use crate::cost::LevelCost;
use crate::error::{GltfError, Problem};
use crate::file_kind::has_extension;
use crate::inspection::Inspection;
use crate::levels_inside::LevelsInside;
use crate::tree::Tree;
use crate::write_problem::WriteProblem;
use secateur_model::{Foliage, LeafId, Lod};

/// The files of a chain that were written, and what they hold.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct WrittenChain {
    /// Triangles of each level, finest first, each instance counted.
    pub triangles: Vec<u64>,
    /// What it costs to draw each level, finest first.
    pub costs: Vec<LevelCost>,
    /// Bytes of all files that were written.
    pub bytes: u64,
    /// The files of the levels, then what they need beside them.
    pub files: Vec<PathBuf>,
    /// What is not as one might expect, a sentence each.
    pub notes: Vec<String>,
}

/// A chain whose files are written, under temporary names; see
/// [`Tree::prepare_chain`].
#[derive(Debug)]
pub struct PreparedChain {
    written: WrittenChain,
    staged: StagedFiles,
}

impl PreparedChain {
    /// What is going to be there after [`commit`](Self::commit).
    pub fn written(&self) -> &WrittenChain {
        &self.written
    }

    /// Gives the files their names.
    ///
    /// # Errors
    /// [`WriteProblem`] within [`GltfError`] if one can't have its name.
    pub fn commit(self) -> Result<WrittenChain, GltfError> {
        let failed = |failure: CommitError| {
            let problem = Problem::from(WriteProblem::Io(failure.error));
            GltfError::new(&failure.path.display().to_string(), problem)
        };
        self.staged.commit().map_err(failed)?;
        Ok(self.written)
    }

    /// Its files, to be committed together with others.
    pub fn into_files(self) -> (WrittenChain, StagedFiles) {
        (self.written, self.staged)
    }
}

impl Tree {
    /// Writes a chain: to the folder `path` in the layout of files, to the file
    /// `path` in the others. Its name ends in .glb or .gltf, in the layout of USD in .usda.
    ///
    /// [`prepare_chain`](Self::prepare_chain) with the usual options, and at once
    /// [`commit`](PreparedChain::commit).
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
        self.prepare_chain(name, levels, layout, path, WriteOptions::default())?
            .commit()
    }

    /// Writes all that [`write_chain`](Self::write_chain) writes, but under
    /// temporary names: a failure, at whichever level, leaves nothing. The folder
    /// of a chain of files is made.
    ///
    /// As [`chain_to_bytes`](Self::chain_to_bytes) and
    /// [`prepare_lod`](Self::prepare_lod).
    ///
    /// # Errors
    /// [`GltfError`] as these, and if a level's file is there already and
    /// `options` do not say that it may be overwritten.
    ///
    /// # Panics
    /// If a level is of another number of leaves.
    pub fn prepare_chain(
        &self,
        name: &str,
        levels: &[Level],
        layout: Layout,
        path: &Path,
        options: WriteOptions,
    ) -> Result<PreparedChain, GltfError> {
        // What they become is compressed, or written otherwise, file by file.
        let chain = self.chain_files(name, levels, layout, false)?;
        let place_of = |file: &str| match layout {
            Layout::Files => path.join(file),
            Layout::Siblings | Layout::Msft => path.to_owned(),
            Layout::Usd if is_usda(file) => path.to_owned(),
            Layout::Usd => path.with_file_name(file),
        };
        let places = chain.files.iter().map(|file| place_of(&file.name));
        let places: Vec<PathBuf> = places.collect();
        for place in &places {
            self.check_place(place, options)?;
        }
        if layout == Layout::Usd {
            return prepare_usd(chain, places);
        }
        let mut staged = StagedFiles::new();
        if layout == Layout::Files {
            let made = staged.make_folder(path);
            made.map_err(|error| refused(path, WriteProblem::Io(error)))?;
        }
        let mut written = WrittenChain {
            triangles: chain.triangles,
            costs: chain.costs,
            bytes: 0,
            files: places.clone(),
            notes: chain.notes,
        };
        for (number, (file, place)) in chain.files.into_iter().zip(places).enumerate() {
            if file.is_as_it_came && !options.rewrite() {
                let added = staged.add_derived(&place, &file.bytes);
                added.map_err(|error| refused(&place, WriteProblem::Io(error)))?;
                written.bytes += file.bytes.len() as u64;
                continue;
            }
            let level = self.as_written(file.bytes)?;
            // Levels share their images.
            let (lod, cutoffs) = (Lod::original(0), Cutoffs::default());
            let what = (&lod, &cutoffs);
            // Names of levels come from that of the plant.
            let at = (place.as_path(), layout != Layout::Files);
            let prepared = level.prepare_lod_beside(what, at, options, &written.files)?;
            let (one, files) = prepared.into_files();
            staged.append(files);
            written.bytes += one.bytes;
            if layout == Layout::Files {
                written.costs[number].bytes = one.bytes;
            }
            written.files.extend(one.files.into_iter().skip(1));
            written.notes.extend(one.notes);
        }
        written.notes = super::without_repeats(written.notes);
        Ok(PreparedChain { written, staged })
    }

    /// A file of the chain as a tree without foliage, which the writer of levels
    /// writes as it is. It has the name of the input, whose files the writer
    /// therefore knows.
    fn as_written(&self, glb: Vec<u8>) -> Result<Tree, GltfError> {
        let Document {
            name,
            base_dir,
            memory,
            ..
        } = &self.document;
        let mut document = Document::from_bytes_within(name, glb, base_dir.as_deref(), *memory)?;
        document.draco_bits = self.document.draco_bits;
        let parts = document.parts().map_err(|fault| document.error(fault))?;
        Ok(Tree {
            document,
            old_normals: NormalsOfParts::of(parts.len()),
            parts,
            others: Vec::new(),
            levels_inside: LevelsInside::default(),
            foliage: Foliage::new(Vec::new()),
            leaf_sources: Vec::new(),
            leaf_triangles: Vec::new(),
            first_of_wood: LeafId::from_index(0),
            inspection: Inspection::default(),
        })
    }

    /// Refuses a place of the input's (the writer knows its buffers no more: they
    /// are in the chain now), and one of a file that must stay.
    fn check_place(&self, path: &Path, options: WriteOptions) -> Result<(), GltfError> {
        let inputs: Vec<PathBuf> = self
            .document
            .files()
            .iter()
            .chain([&PathBuf::from(&self.document.name)])
            .filter_map(|file| std::fs::canonicalize(file).ok())
            .collect();
        let is_input = |path: &Path| std::fs::canonicalize(path).is_ok_and(|p| inputs.contains(&p));
        if is_input(path) || is_input(&path.with_extension("bin")) {
            return Err(refused(path, WriteProblem::IsInput));
        }
        if !options.overwrite && std::fs::symlink_metadata(path).is_ok() {
            return Err(refused(path, WriteProblem::Exists));
        }
        Ok(())
    }
}

fn is_usda(file: impl AsRef<Path>) -> bool {
    has_extension(file.as_ref(), &["usda"])
}

/// Writes the layer, which comes first, and its textures.
fn prepare_usd(chain: ChainFiles, places: Vec<PathBuf>) -> Result<PreparedChain, GltfError> {
    let layer = &places[0];
    if !is_usda(layer) {
        return Err(refused(layer, WriteProblem::NotUsda));
    }
    let folder = layer
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(refused(layer, WriteProblem::NoFolder(folder.to_owned())));
    }
    let mut staged = StagedFiles::new();
    // The layer last: what it names is there then.
    for (file, place) in chain.files.iter().zip(&places).rev() {
        let added = staged.add_derived(place, &file.bytes);
        added.map_err(|error| refused(place, WriteProblem::Io(error)))?;
        staged.sync_folders();
    }
    let written = WrittenChain {
        triangles: chain.triangles,
        costs: chain.costs,
        bytes: chain.files.iter().map(|file| file.bytes.len() as u64).sum(),
        files: places,
        notes: chain.notes,
    };
    Ok(PreparedChain { written, staged })
}

fn refused(path: &Path, problem: WriteProblem) -> GltfError {
    GltfError::new(&path.display().to_string(), Problem::from(problem))
}
