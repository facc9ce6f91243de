//! One study at a time in a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::Error;

/// The name of the lock's file within a study's folder.
const NAME: &str = ".secateur-study.lock";

/// The right to write into a study's folder.
///
/// The system's own lock on a file, which ends with the process however that ends: the file of
/// a killed study is left behind and is in nobody's way.
pub(crate) struct Lock {
    path: PathBuf,
    /// Locked as long as it is open.
    _file: File,
}

impl Lock {
    /// Takes the lock of a folder that is there.
    ///
    /// # Errors
    /// [`Error::Locked`] if another process has it, or the system's reason.
    pub(crate) fn take(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(NAME);
        loop {
            let file = OpenOptions::new()
                .create(true)
                .truncate(false)
                .write(true)
                .open(&path)
                .map_err(|e| Error::of_file(&path, "cannot be written", e))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(Error::Locked(folder.to_owned())),
                Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {
                    // Some network file systems have no locks; studies worked there before.
                    let folder = folder.display();
                    tracing::warn!("{folder}: cannot be locked: run one study at a time in it");
                }
                Err(TryLockError::Error(e)) => {
                    return Err(Error::of_file(&path, "cannot be locked", e));
                }
            }
            // Whoever had it may have removed the file after it was opened here: then the lock is
            // on a file without a name, which keeps nobody out.
            if is_at(&file, &path) {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked. A file that stays behind is in nobody's way.
        let _ = fs::remove_file(&self.path);
    }
}

/// Whether an open file is the one that a path names.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    let (open, named) = (file.metadata(), fs::metadata(path));
    matches!((open.map(inode), named.map(inode)), (Ok(open), Ok(named)) if open == named)
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two studies in one folder the second is refused, until the first is at its end; a file
    /// that a killed one left is no lock.
    #[test]
    fn a_folder_has_one_lock() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(NAME), b"").unwrap();
        let first = Lock::take(folder.path()).unwrap();
        let refused = Lock::take(folder.path()).err().unwrap().to_string();
        assert!(refused.contains("another study"), "{refused}");
        drop(first);
        assert!(!folder.path().join(NAME).exists());
        drop(Lock::take(folder.path()).unwrap());
    }
}
