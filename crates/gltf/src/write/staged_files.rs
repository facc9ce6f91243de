//! Several files that appear together: written and on the disk before the first
//! of them gets its name, so that whatever fails before leaves nothing behind.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use super::temporary_name;

/// Files that are written under temporary names beside their places.
///
/// [`commit`](Self::commit) gives them their names. Dropped before that, nothing
/// of them is left, and folders that were made for them go too.
///
/// A symbolic link in the place of a file is followed by [`add`](Self::add) and replaced by
/// [`add_derived`](Self::add_derived); a file that is replaced keeps its permissions.
#[derive(Debug, Default)]
pub struct StagedFiles {
    steps: Vec<Step>,
    made_folders: Vec<PathBuf>,
}

/// What [`StagedFiles::commit`] does, one after the other.
#[derive(Debug)]
enum Step {
    Rename {
        temporary: TempPath,
        place: PathBuf,
    },
    /// Makes sure that the names given so far are on the disk before the next.
    SyncFolders,
    Remove(PathBuf),
}

/// A file that could not be given its name.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {error}", .path.display())]
pub struct CommitError {
    /// Where the file should be.
    pub path: PathBuf,
    /// What the operating system says.
    pub error: io::Error,
}

impl StagedFiles {
    /// A set without files; [`Self::add`] puts some in.
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes a file under a temporary name beside its place, and makes sure that
    /// it is on the disk. Folders on the way to it are made.
    ///
    /// # Errors
    /// What the operating system says, and if its place is one of something else
    /// than a file.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let place = match path.is_symlink() {
            true => fs::canonicalize(path)?,
            false => path.to_owned(),
        };
        self.add_from(place, &mut { bytes })?;
        Ok(())
    }

    /// As [`add`](Self::add), of a file whose name comes from that of another: a symbolic link in its place is
    /// replaced, so that what it leads to stays as it is.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_derived(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.add_from(path.to_owned(), &mut { bytes })?;
        Ok(())
    }

    /// [`add_derived`](Self::add_derived) with the bytes of a reader. Returns how many they were.
    pub(super) fn add_from(&mut self, place: PathBuf, source: &mut dyn Read) -> io::Result<u64> {
        let there = fs::symlink_metadata(&place).ok();
        let there = there.filter(|there| !there.is_symlink());
        match &there {
            Some(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Some(there) if !there.is_file() => {
                // To rename a file over a device would destroy it for everyone.
                return Err(io::Error::other("it is a device, a pipe or a socket"));
            }
            _ => {}
        }
        let folder = folder_of(&place);
        self.make_folders(&folder)?;
        let mut file = temporary_name::new_file(&folder).map_err(without_temporary_path)?;
        let count = io::copy(source, file.as_file_mut())?;
        if let Some(there) = there {
            file.as_file().set_permissions(there.permissions())?;
        }
        file.as_file().sync_all()?;
        self.steps.push(Step::Rename {
            // Closed: there may be more files than a process may have open.
            temporary: file.into_temp_path(),
            place,
        });
        Ok(count)
    }

    /// Whether files can be written into a folder. What killed runs have left in it goes.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn check_folder(folder: &Path) -> io::Result<()> {
        temporary_name::remove_leftovers(folder);
        let file = temporary_name::new_file(folder);
        file.map(drop).map_err(without_temporary_path)
    }

    /// Makes a folder and those above it, as far as they are not there. They go
    /// again if nothing is committed.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn make_folder(&mut self, folder: &Path) -> io::Result<()> {
        self.make_folders(folder)
    }

    /// Has the names given so far on the disk before the next is given.
    pub(super) fn sync_folders(&mut self) {
        self.steps.push(Step::SyncFolders);
    }

    /// Has a file removed at this point, if it is there.
    pub(super) fn remove(&mut self, path: PathBuf) {
        self.steps.push(Step::Remove(path));
    }

    /// Adds the files of another set, to be named after these.
    pub fn append(&mut self, mut others: StagedFiles) {
        self.steps.append(&mut others.steps);
        self.made_folders.append(&mut others.made_folders);
    }

    /// The places of the files, and where each is until it gets its name, in the order in which they were
    /// added.
    pub fn pending(&self) -> impl Iterator<Item = (&Path, &Path)> {
        self.steps.iter().filter_map(|step| match step {
            Step::Rename { temporary, place } => Some((place.as_path(), &**temporary)),
            Step::SyncFolders | Step::Remove(_) => None,
        })
    }

    /// Where the file that was added last is until it gets its name.
    pub(super) fn last_temporary(&self) -> Option<&Path> {
        self.steps.iter().rev().find_map(|step| match step {
            Step::Rename { temporary, .. } => Some(&**temporary),
            Step::SyncFolders | Step::Remove(_) => None,
        })
    }

    /// Gives all files their names, in the order in which they were added.
    ///
    /// # Errors
    /// [`CommitError`] at the first file that can't have its name. Files that
    /// were named before and took no other file's place are removed.
    pub fn commit(mut self) -> Result<(), CommitError> {
        let steps = std::mem::take(&mut self.steps);
        let mut new_files = Vec::new();
        let named = name_all(steps, &mut new_files);
        match named {
            Ok(()) => self.made_folders.clear(),
            Err(_) => new_files
                .iter()
                .for_each(|file| drop(fs::remove_file(file))),
        }
        named
    }

    /// The first steps of a commit, as if the program were killed then; whether
    /// there are as many.
    #[cfg(test)]
    pub(super) fn be_killed_after(mut self, steps: usize) -> bool {
        let are_all = steps >= self.steps.len();
        self.steps.truncate(steps);
        self.commit().unwrap();
        !are_all
    }

    /// Makes a folder and those above it, to be removed again if nothing is
    /// committed.
    fn make_folders(&mut self, folder: &Path) -> io::Result<()> {
        let missing = folder.ancestors().take_while(|above| {
            let is_here = above.as_os_str().is_empty();
            !is_here && !above.exists()
        });
        let mut missing: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        while let Some(next) = missing.pop() {
            if let Err(error) = fs::create_dir(&next)
                && !next.is_dir()
            {
                return Err(error);
            }
            self.made_folders.push(next);
        }
        Ok(())
    }
}

impl Drop for StagedFiles {
    fn drop(&mut self) {
        self.steps.clear();
        for folder in self.made_folders.iter().rev() {
            // One that holds something now is somebody else's too.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Does the steps; `new_files` gets those that were not there before.
fn name_all(steps: Vec<Step>, new_files: &mut Vec<PathBuf>) -> Result<(), CommitError> {
    let mut unsynced = BTreeSet::new();
    for step in steps {
        match step {
            Step::Rename { temporary, place } => {
                let is_new = !place.exists();
                temporary.persist(&place).map_err(|failure| CommitError {
                    path: place.clone(),
                    error: without_temporary_path(failure.error),
                })?;
                unsynced.insert(folder_of(&place));
                if is_new {
                    new_files.push(place);
                }
            }
            Step::SyncFolders => std::mem::take(&mut unsynced).iter().for_each(sync_folder),
            // What is left over does no harm.
            Step::Remove(path) => drop(fs::remove_file(path)),
        }
    }
    unsynced.iter().for_each(sync_folder);
    Ok(())
}

/// Has the names in a folder on the disk, where the system can do that.
fn sync_folder(folder: &PathBuf) {
    if cfg!(unix)
        && let Ok(folder) = File::open(folder)
    {
        let _ = folder.sync_all();
    }
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// An error without the name of the temporary file, which tells nobody
/// anything.
fn without_temporary_path(error: io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(_) => error,
        None => error.kind().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_not_committed_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut staged = StagedFiles::new();
        staged.add(&folder.path().join("a"), b"1").unwrap();
        staged.add(&folder.path().join("b/c/d"), b"2").unwrap();
        drop(staged);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn all_files_get_their_names_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        let stage = || {
            let mut staged = StagedFiles::new();
            staged.add(&a, b"1").unwrap();
            staged.add(&b, b"2").unwrap();
            staged
        };
        let staged = stage();
        // In the meantime somebody makes a folder in the way.
        fs::create_dir(&b).unwrap();
        fs::write(b.join("in the way"), "").unwrap();
        let error = staged.commit().unwrap_err();
        assert_eq!(error.path, b);
        assert!(!error.to_string().contains(".secateur-"), "{error}");
        assert!(!a.exists());

        fs::remove_dir_all(&b).unwrap();
        stage().commit().unwrap();
        assert_eq!(
            (fs::read(a).unwrap(), fs::read(b).unwrap()),
            (b"1".to_vec(), b"2".to_vec())
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
        symlink("file", &link).unwrap();
        let mut staged = StagedFiles::new();
        staged.add(&link, b"new").unwrap();
        staged.commit().unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert_eq!(
            fs::metadata(&file).unwrap().permissions().mode() & 0o777,
            0o600
        );

        let refused = StagedFiles::new().add(Path::new("/dev/null"), b"1");
        assert!(refused.unwrap_err().to_string().contains("device"));

        let mut staged = StagedFiles::new();
        staged.add_derived(&link, b"beside").unwrap();
        staged.commit().unwrap();
        assert!(!link.is_symlink());
        assert_eq!(
            [&file, &link].map(|file| fs::read(file).unwrap()),
            [&b"new"[..], b"beside"]
        );
    }
}
