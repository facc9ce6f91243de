//! The hash by which rows know a tree.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use secateur_gltf::Document;
use secateur_model::Memory;
use sha2::{Digest, Sha256};

use crate::Error;

/// The SHA-256 in hexadecimal of a tree's file, and behind it of the files that its buffers and
/// images name, each once; of a .glb that names none it is the file's own.
///
/// # Errors
/// [`Error::Gltf`] if the tree or a buffer of it can't be read.
pub fn tree_sha256(path: &Path, memory: Memory) -> Result<String, Error> {
    let document = Document::open_within(path, memory)?;
    let mut hasher = Sha256::new();
    let read = |path: &Path| fs::read(path).map_err(|e| Error::of_file(path, "cannot be read", e));
    hasher.update(read(path)?);
    // An image that is missing is no part of the tree, and a pipe would never end.
    let files: BTreeSet<PathBuf> = document.files().into_iter().collect();
    for file in files.iter().filter(|file| file.is_file()) {
        hasher.update(read(file)?);
    }
    Ok(secateur_model::hex(&hasher.finalize()))
}
