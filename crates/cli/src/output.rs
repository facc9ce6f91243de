//! Output files: whether they can be written, found out before the work; and
//! written whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use secateur::{Document, StagedFiles, WriteOptions};
use secateur_gltf::{has_extension, is_gltf_name};

use super::failure::Failure;

/// Outputs of a command, each of which can be written as far as can be told before.
pub(crate) struct Outputs<'a> {
    inputs: Vec<&'a Path>,
    places: Vec<&'a Path>,
}

impl<'a> Outputs<'a> {
    /// No output yet; none may be one of these inputs.
    pub(crate) fn beside(inputs: impl IntoIterator<Item = &'a Path>) -> Self {
        Self {
            inputs: inputs.into_iter().collect(),
            places: Vec::new(),
        }
    }

    /// A file that this check lets pass.
    pub(crate) fn and(
        mut self,
        path: &'a Path,
        check: impl FnOnce(&Path, &[&Path]) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        check(path, &self.inputs)?;
        self.places.push(path);
        Ok(self)
    }

    /// A file that may be asked for.
    pub(crate) fn maybe(
        self,
        path: Option<&'a PathBuf>,
        check: impl FnOnce(&Path, &[&Path]) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        match path {
            Some(path) => self.and(path, check),
            None => Ok(self),
        }
    }

    /// All of them, no two of which are one file.
    pub(crate) fn distinct(self) -> Result<Vec<&'a Path>, Failure> {
        check_distinct(&self.places)?;
        Ok(self.places)
    }
}

/// Refuses an output tree that could not be written at the end.
pub(crate) fn check_tree(
    path: &Path,
    inputs: &[&Path],
    options: WriteOptions,
) -> Result<(), Failure> {
    if !is_gltf_name(path) {
        return refuse(path, "its name must end in .glb or .gltf");
    }
    check_file(path, inputs)?;
    Ok(options.check(path)?)
}

/// Refuses an output that could not be written as a single file at the end.
pub(crate) fn check_glb(path: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if !has_extension(path, &["glb"]) {
        return refuse(path, "its name must end in .glb");
    }
    check_file(path, inputs)
}

/// Refuses a picture that could not be written at the end.
pub(crate) fn check_picture(path: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if !has_extension(path, &["png"]) {
        return refuse(path, "pictures are PNG: its name must end in .png");
    }
    check_file(path, inputs)
}

/// Refuses an output file that could not be written at the end.
pub(crate) fn check_file(path: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        let reason = format!("its folder `{}` does not exist", folder.display());
        return refuse(path, &reason);
    }
    if path.is_dir() {
        return refuse(path, "it is a folder");
    }
    if path.exists() && !path.is_file() {
        // To rename a file over a device would destroy it for the whole machine.
        return refuse(path, "it is a device, a pipe or a socket; name a file");
    }
    if path.is_symlink() && !path.exists() {
        return refuse(path, "it is a link to a file that does not exist");
    }
    if inputs.iter().any(|input| is_same(path, input)) {
        let reason = "is the input; choose another name for the output";
        return Err(Failure::input(format!("{}: {reason}", path.display())));
    }
    check_name(path)?;
    StagedFiles::check_folder(&folder).map_err(|e| Failure::of_file(path, "cannot be written", &e))
}

/// Refuses a name that no file can have, as one that is too long.
pub(crate) fn check_name(path: &Path) -> Result<(), Failure> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(Failure::of_file(path, "cannot be written", &error))
        }
        _ => Ok(()),
    }
}

/// Refuses a folder for outputs that neither is there nor could be made, or
/// could not be written into.
pub(crate) fn check_folder(path: &Path) -> Result<(), Failure> {
    let mut there = path.to_owned();
    while !there.exists() {
        let above = folder_of(&there);
        if above == there {
            break;
        }
        there = above;
    }
    if !there.is_dir() {
        let reason = format!("`{}` is no folder", there.display());
        return refuse(path, &reason);
    }
    StagedFiles::check_folder(&there)
        .map_err(|e| Failure::of_file(path, "cannot be written into", &e))
}

/// Refuses two outputs in the same place, however their paths are written; the buffer beside
/// a .gltf is an output too.
pub(crate) fn check_distinct(paths: &[&Path]) -> Result<(), Failure> {
    let with_buffers: Vec<PathBuf> = paths.iter().flat_map(|path| files_of(path)).collect();
    for (k, path) in with_buffers.iter().enumerate() {
        if with_buffers[..k].iter().any(|other| is_same(path, other)) {
            return refuse(path, "two outputs are this file");
        }
    }
    Ok(())
}

/// Refuses an output that would take the place of a buffer or an image of an input.
pub(crate) fn check_spares(document: &Document, paths: &[&Path]) -> Result<(), Failure> {
    let inputs = document.files();
    for path in paths.iter().flat_map(|path| files_of(path)) {
        if inputs.iter().any(|input| is_same(&path, input)) {
            return refuse(&path, "it is a buffer or an image of the input");
        }
    }
    Ok(())
}

/// An output and the buffer that is written beside it, or, if it is a link, beside the
/// file that it leads to.
fn files_of(path: &Path) -> Vec<PathBuf> {
    let place = match path.is_symlink() {
        true => fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        false => path.to_owned(),
    };
    let path = place.as_path();
    let mut files = vec![path.to_owned()];
    if has_extension(path, &["gltf"]) {
        files.push(path.with_extension("bin"));
    }
    files
}

fn refuse(path: &Path, reason: &str) -> Result<(), Failure> {
    let path = path.display();
    Err(Failure::input(format!(
        "{path}: cannot be written: {reason}"
    )))
}

/// Writes a file whole or not at all.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut staged = StagedFiles::new();
    stage(&mut staged, path, bytes)?;
    Ok(staged.commit()?)
}

/// As [`write_file`], of a file whose name nobody gave: a link in its place is replaced.
pub(crate) fn write_derived(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut staged = StagedFiles::new();
    stage_derived(&mut staged, path, bytes)?;
    Ok(staged.commit()?)
}

/// As [`stage`], of a file whose name nobody gave: a link in its place is replaced.
pub(crate) fn stage_derived(
    staged: &mut StagedFiles,
    path: &Path,
    bytes: &[u8],
) -> Result<(), Failure> {
    let added = staged.add_derived(path, bytes);
    added.map_err(|e| Failure::of_file(path, "cannot be written", &e))
}

/// Writes a file that appears with the others of `staged`.
pub(crate) fn stage(staged: &mut StagedFiles, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let added = staged.add(path, bytes);
    added.map_err(|e| Failure::of_file(path, "cannot be written", &e))
}

/// Makes a folder for files of `staged`, if it is not there.
pub(crate) fn make_folder(staged: &mut StagedFiles, path: &Path) -> Result<(), Failure> {
    let made = staged.make_folder(path);
    made.map_err(|e| Failure::of_file(path, "cannot be made", &e))
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        Some(_) => PathBuf::from("."),
        None => path.to_owned(),
    }
}

/// Whether two paths are one file, or would be.
fn is_same(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b || is_one_inode(&a, &b),
        (Err(_), Err(_)) => match (resolved(a), resolved(b)) {
            (Some(a), Some(b)) => a == b,
            _ => a == b,
        },
        _ => false,
    }
}

/// Where a file will be that is not there yet.
fn resolved(path: &Path) -> Option<PathBuf> {
    let folder = fs::canonicalize(folder_of(path)).ok()?;
    Some(folder.join(path.file_name()?))
}

/// Whether two names are hard links to one file.
#[cfg(unix)]
fn is_one_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |path: &Path| fs::metadata(path).map(|m| (m.dev(), m.ino()));
    matches!((inode(a), inode(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn is_one_inode(_: &Path, _: &Path) -> bool {
    false
}
