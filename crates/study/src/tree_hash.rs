//! The hashes by which rows know a tree, and files are known again.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use secateur_gltf::Document;
use secateur_model::Memory;
use sha2::{Digest, Sha256};

use crate::Error;

/// Bytes of a file that are held at once.
const CHUNK_BYTES: usize = 1 << 16;

/// The SHA-256 in hexadecimal of a tree's file, and behind it of the files that its buffers and
/// images name, each once; of a .glb that names none it is the file's own.
///
/// # Errors
/// [`Error::Gltf`] if the tree or a buffer of it can't be read.
pub fn tree_sha256(path: &Path, memory: Memory) -> Result<String, Error> {
    let document = Document::open_within(path, memory)?;
    let mut hasher = Sha256::new();
    let mut update = |path: &Path| {
        let read = update(&mut hasher, path);
        read.map_err(|e| Error::of_file(path, "cannot be read", e))
    };
    update(path)?;
    // An image that is missing is no part of the tree, and a pipe would never end.
    let files: BTreeSet<PathBuf> = document.files().into_iter().collect();
    for file in files.iter().filter(|file| file.is_file()) {
        update(file)?;
    }
    Ok(hex(hasher))
}

/// The SHA-256 in hexadecimal of a file, which is never held as a whole.
///
/// # Errors
/// What the operating system says, and if it is no ordinary file: others may have no end.
pub fn file_sha256(path: &Path) -> io::Result<String> {
    if !path.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let mut hasher = Sha256::new();
    update(&mut hasher, path)?;
    Ok(hex(hasher))
}

fn update(hasher: &mut Sha256, path: &Path) -> io::Result<()> {
    let mut file = File::open(path)?;
    let mut chunk = vec![0; CHUNK_BYTES];
    loop {
        match file.read(&mut chunk)? {
            0 => return Ok(()),
            read => hasher.update(&chunk[..read]),
        }
    }
}

fn hex(hasher: Sha256) -> String {
    secateur_model::hex(&hasher.finalize())
}
