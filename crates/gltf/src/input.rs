//! Reading whole files whose length nobody has promised.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use secateur_model::{Budget, Memory};

use super::error::{ALLOW_MORE, GltfError, Problem};

/// All bytes of a file, a pipe or a device. Of what has no end no more is read than `memory` allows.
///
/// # Errors
/// [`GltfError`] with [`Problem::Unreadable`] if it can't be read, and with [`Problem::Memory`] if
/// it takes more than `memory`.
pub fn read_within(path: &Path, memory: Memory) -> Result<Vec<u8>, GltfError> {
    read(path, Budget::new(memory))
        .map_err(|problem| GltfError::new(&path.display().to_string(), problem))
}

fn read(path: &Path, mut budget: Budget) -> Result<Vec<u8>, Problem> {
    let there = fs::metadata(path).map_err(Problem::Unreadable)?;
    if there.is_dir() {
        let error = io::Error::from(io::ErrorKind::IsADirectory);
        return Err(Problem::Unreadable(error));
    }
    let what = || "the file".to_owned();
    budget.take(there.len(), what, ALLOW_MORE)?;
    let mut bytes = Vec::with_capacity(there.len() as usize);
    // A pipe or a device has no length, and a file may have grown. Half of what is left may come,
    // since the vector doubles when it is full.
    let most = there.len() + budget.left() / 2;
    let file = File::open(path).map_err(Problem::Unreadable)?;
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(Problem::Unreadable)?;
    let beyond = (bytes.len() as u64).saturating_sub(there.len());
    budget.take(2 * beyond, what, ALLOW_MORE)?;
    Ok(bytes)
}
