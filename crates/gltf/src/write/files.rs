//! Putting a LOD on disk: all of its files or none.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::Value;
use tempfile::NamedTempFile;

use super::content::{Content, lod_content};
use super::images::{self, Copy};
use super::problem::WriteProblem;
use crate::container::glb_bytes;
use crate::error::{GltfError, Problem};
use crate::tree::Tree;
use crate::uri;
use secateur_model::Lod;

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

impl Tree {
    /// The tree with the leaves of a LOD, as a GLB.
    ///
    /// All that is no removed or resized leaf stays as it was. Images in files
    /// of their own stay there: the GLB names them by the same URIs. The same
    /// input gives the same bytes.
    ///
    /// # Errors
    /// [`GltfError`] if a part of the file that was not needed to find the
    /// leaves turns out to be damaged, or the result is beyond 4 GiB.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn lod_to_bytes(&self, lod: &Lod) -> Result<Vec<u8>, GltfError> {
        let content = lod_content(self, lod).map_err(|fault| self.document.error(fault))?;
        glb_bytes(&content.root, content.buffer)
            .ok_or_else(|| self.document.error(Problem::from(WriteProblem::TooLarge)))
    }

    /// Writes the tree with the leaves of a LOD to a file whose name ends in
    /// .glb (one file) or .gltf (JSON, with a .bin of the same name beside it).
    ///
    /// As [`lod_to_bytes`](Self::lod_to_bytes). Images in files of their own are
    /// copied if the output goes to another folder: those that a texture uses,
    /// that are PNG, JPEG, WebP or KTX2 by their names and first bytes, and no
    /// part of whose path begins with a dot. Nothing is written through symbolic
    /// links below that folder. An image that is not copied is still named, and
    /// the notes say why it was not. Each file is written beside
    /// its place and then renamed, so that a failure leaves nothing half-written.
    ///
    /// # Errors
    /// [`GltfError`] as above, or [`WriteProblem`] within it: another extension,
    /// a folder that is not there or not writable, a full disk, a path that
    /// belongs to the input, an image that would replace a different file.
    ///
    /// # Panics
    /// If the LOD is of another number of leaves.
    pub fn write_lod(&self, lod: &Lod, path: &Path) -> Result<Written, GltfError> {
        let failed = |problem: WriteProblem| {
            GltfError::new(&path.display().to_string(), Problem::from(problem))
        };
        let target = Output::new(path).map_err(failed)?;
        self.check_not_input(&target).map_err(failed)?;
        let content = lod_content(self, lod).map_err(|fault| self.document.error(fault))?;
        let (triangles, mut notes) = (content.triangles, content.notes.clone());
        let images = self.images_to_copy(&content.root, &target, &mut notes);
        let files = target.pack(content).map_err(failed)?;
        let (files, bytes) = write_all(files, images.map_err(failed)?).map_err(failed)?;
        Ok(Written {
            triangles,
            bytes,
            files,
            notes,
        })
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

/// Where a LOD goes.
struct Output {
    path: PathBuf,
    folder: PathBuf,
    /// The .bin beside a .gltf.
    bin: Option<PathBuf>,
}

impl Output {
    fn new(path: &Path) -> Result<Self, WriteProblem> {
        let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
        let bin = match extension.to_ascii_lowercase().as_str() {
            "glb" => None,
            "gltf" => Some(path.with_extension("bin")),
            _ => return Err(WriteProblem::Extension),
        };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(WriteProblem::NoFolder(folder));
        }
        Ok(Self {
            path: path.to_owned(),
            folder,
            bin,
        })
    }

    fn paths(&self) -> Vec<PathBuf> {
        self.bin.iter().chain([&self.path]).cloned().collect()
    }

    /// The bytes of each file, the one that names the others first.
    fn pack(self, mut content: Content) -> Result<Vec<(PathBuf, Vec<u8>)>, WriteProblem> {
        let Some(bin) = self.bin else {
            let glb = glb_bytes(&content.root, content.buffer).ok_or(WriteProblem::TooLarge)?;
            return Ok(vec![(self.path, glb)]);
        };
        let has_buffer = !content.buffer.is_empty();
        if has_buffer {
            let name = bin
                .file_name()
                .and_then(OsStr::to_str)
                .ok_or(WriteProblem::Name)?;
            let uri = utf8_percent_encode(name, ESCAPED).to_string();
            content.root["buffers"][0]["uri"] = uri.into();
        }
        let json = serde_json::to_vec_pretty(&content.root).map_err(io::Error::from)?;
        let mut files = vec![(self.path, json)];
        if has_buffer {
            files.push((bin, content.buffer));
        }
        Ok(files)
    }
}

/// All but what RFC 3986 (section 2.3) calls unreserved.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');

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

/// Writes all files beside their places, then renames them, what others need
/// first. Returns the paths, and the bytes in all.
fn write_all(
    files: Vec<(PathBuf, Vec<u8>)>,
    copies: Vec<Copy>,
) -> Result<(Vec<PathBuf>, u64), WriteProblem> {
    let mut waiting = Vec::new();
    let mut total = 0;
    for (path, bytes) in files {
        total += bytes.len() as u64;
        waiting.push((temporary_beside(&path, &mut bytes.as_slice())?, path));
    }
    for copy in copies {
        if let Some(folder) = copy.to.parent() {
            fs::create_dir_all(folder)?;
        }
        let mut source = fs::File::open(&copy.from)?;
        total += source.metadata()?.len();
        waiting.push((temporary_beside(&copy.to, &mut source)?, copy.to));
    }
    let paths = waiting.iter().map(|(_, path)| path.clone()).collect();
    for (temporary, path) in waiting.into_iter().rev() {
        temporary.persist(path).map_err(|failure| failure.error)?;
    }
    Ok((paths, total))
}

fn temporary_beside(path: &Path, source: &mut dyn io::Read) -> io::Result<NamedTempFile> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let mut builder = tempfile::Builder::new();
    builder.prefix(".secateur-").suffix(".tmp");
    #[cfg(unix)]
    {
        // The permissions of an ordinary new file; temporary ones are private.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    io::copy(source, &mut file)?;
    file.flush()?;
    Ok(file)
}
