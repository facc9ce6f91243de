//! Putting a LOD on disk: all of its files or none.

mod output;

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde_json::Value;

use super::content::{Content, lod_content};
use super::cutoffs::Cutoffs;
use super::images::{self, Copy};
use super::staged_files::StagedFiles;
use crate::binary_chunk::BinaryChunk;
use crate::container::{self, glb_bytes};
use crate::document::Document;
use crate::error::{Fault, GltfError, Problem};
use crate::tree::Tree;
use crate::uri;
use crate::write_problem::WriteProblem;
use secateur_model::{Lod, Memory};

use output::Output;

/// The files of a LOD that were written, and what they hold.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Written {
    /// Triangles that the file's nodes draw, each instance counted, wood and
    /// leaves.
    pub triangles: u64,
    /// Bytes of all files that were written.
    pub bytes: u64,
    /// The files: the one that was asked for first, then what it needs beside
    /// it.
    pub files: Vec<PathBuf>,
    /// What is not as one might expect, a sentence each: instances that became
    /// meshes of their own, quantised positions that became floats; and, where
    /// the output goes to another folder, of each image in a file of its own
    /// whether it was copied, and if not, why.
    pub notes: Vec<String>,
}

/// What images become in a compressed file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ImageFormat {
    /// PNG becomes lossless WebP (`EXT_texture_webp`) where that saves a twentieth.
    #[default]
    WebP,
    /// Colours become KTX2 (`KHR_texture_basisu`): ETC1S with mip maps, which a GPU keeps in a quarter of the bytes or
    /// less. Other PNG images become WebP.
    #[cfg(feature = "ktx2")]
    Ktx2,
}

/// A format that images of a compressed file do not become.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoImageFormat {
    /// Its name is none.
    #[error("images become webp or ktx2")]
    Unknown,
    /// Its encoder is left out.
    #[error("this build has no encoder for KTX2: build it with `--features ktx2`")]
    NotBuilt,
}

impl FromStr for ImageFormat {
    type Err = NoImageFormat;

    fn from_str(name: &str) -> Result<Self, NoImageFormat> {
        match name {
            "webp" => Ok(Self::WebP),
            #[cfg(feature = "ktx2")]
            "ktx2" => Ok(Self::Ktx2),
            #[cfg(not(feature = "ktx2"))]
            "ktx2" => Err(NoImageFormat::NotBuilt),
            _ => Err(NoImageFormat::Unknown),
        }
    }
}

/// How files may be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct WriteOptions {
    /// Whether the buffer beside a .gltf may take the place of a file that is no
    /// buffer of the .gltf that is there, and levels of a chain that of files that
    /// are there.
    pub overwrite: bool,
    /// Where there is a format, geometry gets fewer bits and is compressed: `EXT_meshopt_compression`, and
    /// `KHR_mesh_quantization` for normals. Positions keep 14 bits of the longest side of what they span. Images become
    /// of this format, where that is smaller.
    pub compress: Option<ImageFormat>,
    /// Whether triangles with indices are written as strips (mode 5) in place of lists, one strip for each primitive. A note
    /// says how many indices either takes.
    pub strips: bool,
}

impl WriteOptions {
    /// These options, with `overwrite` as given.
    pub fn overwrite(self, overwrite: bool) -> Self {
        Self { overwrite, ..self }
    }

    /// These options, with `compress` as given.
    pub fn compress(self, compress: impl Into<Option<ImageFormat>>) -> Self {
        let compress = compress.into();
        Self { compress, ..self }
    }

    /// These options, with `strips` as given.
    pub fn strips(self, strips: bool) -> Self {
        Self { strips, ..self }
    }

    /// Whether a finished file is written otherwise than it is.
    pub(super) fn rewrite(self) -> bool {
        self.compress.is_some() || self.strips
    }

    /// Refuses a path that [`Tree::prepare_lod`] could not write to, to know before
    /// the work.
    ///
    /// # Errors
    /// [`WriteProblem`] within [`GltfError`]: another extension, a folder that is
    /// not there, an unrelated file where the buffer must go.
    pub fn check(self, path: &Path) -> Result<(), GltfError> {
        let output = Output::of_user(path);
        let checked = output.and_then(|output| output.old_buffers(self).map(drop));
        checked
            .map_err(|problem| GltfError::new(&path.display().to_string(), Problem::from(problem)))
    }
}

/// This content with its geometry written in another way, such as strips.
pub(super) fn rewritten(
    document: &Document,
    content: Content,
    how: impl Fn(&Document) -> Result<Content, Fault>,
) -> Result<Content, GltfError> {
    let glb = glb_bytes(&content.root, content.buffer)
        .ok_or_else(|| document.error(Problem::from(WriteProblem::TooLarge)))?;
    let folder = document.base_dir.as_deref();
    let read = Document::from_bytes_within(&document.name, glb, folder, document.memory)?;
    let written = how(&read).map_err(|fault| read.error(fault))?;
    Ok(Content {
        triangles: content.triangles,
        notes: content.notes.into_iter().chain(written.notes).collect(),
        ..written
    })
}

/// This content compressed by Draco, where the document that it is made of was.
pub(super) fn compressed_as(document: &Document, content: Content) -> Result<Content, GltfError> {
    match document.draco_bits {
        Some(bits) => rewritten(document, content, |read| {
            super::draco::compressed(read, bits)
        }),
        None => Ok(content),
    }
}

/// A LOD whose files are written, under temporary names; see [`Tree::prepare_lod`].
#[derive(Debug)]
pub struct PreparedLod {
    written: Written,
    staged: StagedFiles,
    /// Where the .glb or .gltf is for the time being.
    main: PathBuf,
    /// Where the .bin beside a .gltf is for the time being.
    buffer: Option<PathBuf>,
    /// The folder of the input, which has the images.
    images: Option<PathBuf>,
    /// With which the input was opened.
    memory: Memory,
}

impl PreparedLod {
    /// What is going to be there after [`commit`](Self::commit).
    pub fn written(&self) -> &Written {
        &self.written
    }

    /// The written file, read again, with the images of the input.
    ///
    /// # Errors
    /// [`GltfError`] if it can't be read.
    pub fn document(&self) -> Result<Document, GltfError> {
        let name = self.written.files[0].display().to_string();
        let read = || -> Result<Document, Fault> {
            let file = fs::read(&self.main).map_err(Problem::Unreadable)?;
            let mut unpacked = container::unpack(file, self.memory)?;
            if let Some(buffer) = &self.buffer {
                super::drop_unreferenced::remove_field(&mut unpacked.root["buffers"][0], "uri");
                let bytes = fs::read(buffer).map_err(Problem::Unreadable)?;
                unpacked.chunk = Some(BinaryChunk::Memory(bytes));
            }
            Document::from_unpacked(&name, unpacked, self.images.as_deref())
        };
        read().map_err(|fault| GltfError::new(&name, fault))
    }

    /// Gives the files their names.
    ///
    /// # Errors
    /// [`WriteProblem`] within [`GltfError`] if one can't have its name.
    pub fn commit(self) -> Result<Written, GltfError> {
        let name = self.written.files[0].display().to_string();
        let failed = |error| GltfError::new(&name, Problem::from(WriteProblem::Io(error)));
        self.staged
            .commit()
            .map_err(|failure| failed(failure.error))?;
        Ok(self.written)
    }

    /// Its files, to be committed together with others.
    pub fn into_files(self) -> (Written, StagedFiles) {
        (self.written, self.staged)
    }
}

impl Tree {
    /// The tree with the leaves of a LOD, as a GLB.
    ///
    /// All that is no removed or resized leaf stays as it was, but for the alpha
    /// cutoff and the wrap of materials whose cards became single triangles, where
    /// coarse mip maps would show specks beside them ([`Written::notes`] says so).
    /// Images in files of their own stay there: the GLB names them by the same
    /// URIs. The same input gives the same bytes.
    ///
    /// # Errors
    /// [`GltfError`] if a part of the file that was not needed to find the
    /// leaves turns out to be damaged, or the result is beyond 4 GiB.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn lod_to_bytes(&self, lod: &Lod) -> Result<Vec<u8>, GltfError> {
        self.lod_to_bytes_with(lod, &Cutoffs::default())
    }

    /// [`lod_to_bytes`](Self::lod_to_bytes) with alpha cutoffs of its own.
    ///
    /// # Errors
    /// As [`lod_to_bytes`](Self::lod_to_bytes).
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn lod_to_bytes_with(&self, lod: &Lod, cutoffs: &Cutoffs) -> Result<Vec<u8>, GltfError> {
        let content = lod_content(self, lod, cutoffs);
        let content = content.map_err(|fault| self.document.error(fault))?;
        let content = compressed_as(&self.document, content)?;
        glb_bytes(&content.root, content.buffer)
            .ok_or_else(|| self.document.error(Problem::from(WriteProblem::TooLarge)))
    }

    /// Writes the tree with the leaves of a LOD to a file whose name ends in
    /// .glb (one file) or .gltf (JSON, with a .bin of the same name beside it).
    ///
    /// [`prepare_lod`](Self::prepare_lod) with the usual options, and at once
    /// [`commit`](PreparedLod::commit).
    ///
    /// # Errors
    /// [`GltfError`] as these.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn write_lod(&self, lod: &Lod, path: &Path) -> Result<Written, GltfError> {
        self.prepare_lod(lod, path, WriteOptions::default())?
            .commit()
    }

    /// Writes all that [`write_lod`](Self::write_lod) writes, but under temporary
    /// names: a failure, now or before the files get their names, leaves nothing.
    ///
    /// As [`lod_to_bytes`](Self::lod_to_bytes). Images in files of their own are
    /// copied if the output goes to another folder: those that a texture uses,
    /// that are PNG, JPEG, WebP or KTX2 by their names and first bytes, and no
    /// part of whose path begins with a dot. Nothing is written through symbolic
    /// links below that folder. An image that is not copied is still named, and
    /// the notes say why it was not.
    ///
    /// Files are on the disk before they get their names. A .gltf knows its new
    /// buffer by a name of its own until the buffer has the final one: whenever the
    /// program is killed, what lies there is the old tree or the new one, and the
    /// next call takes its place.
    ///
    /// # Errors
    /// [`GltfError`] as above, or [`WriteProblem`] within it: another extension,
    /// a folder that is not there or not writable, a full disk, a path that
    /// belongs to the input, an image that would replace a different file, a
    /// buffer that would replace a file that is none of the .gltf there.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn prepare_lod(
        &self,
        lod: &Lod,
        path: &Path,
        options: WriteOptions,
    ) -> Result<PreparedLod, GltfError> {
        self.prepare_lod_with(lod, &Cutoffs::default(), path, options)
    }

    /// [`prepare_lod_with`](Self::prepare_lod_with) without the images that are among these
    /// files.
    pub(super) fn prepare_lod_beside(
        &self,
        (lod, cutoffs): (&Lod, &Cutoffs),
        (path, is_of_user): (&Path, bool),
        options: WriteOptions,
        beside: &[PathBuf],
    ) -> Result<PreparedLod, GltfError> {
        let failed = |problem: WriteProblem| {
            GltfError::new(&path.display().to_string(), Problem::from(problem))
        };
        let target = match is_of_user {
            true => Output::of_user(path),
            false => Output::new(path.to_owned()),
        };
        let target = target.map_err(failed)?;
        self.check_not_input(&target).map_err(failed)?;
        let content = lod_content(self, lod, cutoffs);
        let mut content = content.map_err(|fault| self.document.error(fault))?;
        if options.strips {
            content = rewritten(&self.document, content, super::strips::stripped)?;
        }
        content = match options.compress {
            Some(format) => {
                let quantised = |read: &Document| super::compress::quantised(read, format);
                rewritten(&self.document, content, quantised)?
            }
            None if options.strips => content,
            None => compressed_as(&self.document, content)?,
        };
        let (triangles, mut notes) = (content.triangles, content.notes.clone());
        let images = self.images_to_copy(&content.root, &target, &mut notes);
        let mut images = images.map_err(failed)?;
        images.retain(|copy| !beside.contains(&copy.to));
        let written = Written {
            triangles,
            bytes: 0,
            files: Vec::new(),
            notes,
        };
        let prepared = target.stage(content, &images, options, written);
        let mut prepared = prepared.map_err(failed)?;
        prepared.images = self.document.base_dir.clone();
        prepared.memory = self.document.memory;
        Ok(prepared)
    }

    fn check_not_input(&self, target: &Output) -> Result<(), WriteProblem> {
        let mut inputs = vec![PathBuf::from(&self.document.name)];
        if let Some(folder) = &self.document.base_dir {
            let named = uris(&self.document.root, "buffers")
                .chain(uris(&self.document.root, "images"))
                .filter_map(uri::file);
            inputs.extend(named.map(|relative| folder.join(relative)));
        }
        let inputs: Vec<PathBuf> = inputs
            .iter()
            .filter_map(|p| fs::canonicalize(p).ok())
            .collect();
        let is_input = |path: &PathBuf| fs::canonicalize(path).is_ok_and(|p| inputs.contains(&p));
        if target.paths().iter().any(is_input) {
            return Err(WriteProblem::IsInput);
        }
        Ok(())
    }

    /// The images that must go along; none where the output lies beside the
    /// input.
    fn images_to_copy(
        &self,
        root: &Value,
        target: &Output,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Copy>, WriteProblem> {
        match &self.document.base_dir {
            Some(folder) if !same_place(folder, &target.folder) => {
                images::to_copy(root, folder, &target.folder, notes)
            }
            _ => Ok(Vec::new()),
        }
    }
}

fn uris<'v>(root: &'v Value, list: &str) -> impl Iterator<Item = &'v str> {
    let items = root.get(list).and_then(Value::as_array);
    items
        .into_iter()
        .flatten()
        .filter_map(|item| item.get("uri")?.as_str())
}

fn same_place(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
