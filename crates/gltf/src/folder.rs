//! The folder of a glTF file, and the files in it.
//!
//! A URI can't climb out of the folder (see [`uri`]), but a
//! symbolic link that came with the glTF could: its file would be read, and an
//! image even be copied to the output. So links are followed first, and the
//! file that they lead to must lie in the folder.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::error::{At, Fault, Problem, shortened};
use super::property;
use super::uri;

/// The folder of the glTF file at `path`. If `path` is a link it is that of the
/// file it leads to: the user named it, and what belongs to that file is there.
pub(crate) fn of(path: &Path) -> PathBuf {
    // What has no place of its own, such as a pipe, is taken as it is named.
    let file = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// The file that a URI names, without links on the way to it.
///
/// # Errors
/// [`Problem::MissingFile`] if it is no file, [`Problem::LinkOutside`] if it
/// lies outside `base_dir`.
pub(crate) fn find(
    base_dir: Option<&Path>,
    relative: &Path,
    uri: &str,
) -> Result<PathBuf, Problem> {
    let missing = |error| Problem::MissingFile {
        uri: shortened(uri),
        error,
    };
    let base_dir = match base_dir {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => {
            let error = io::Error::new(io::ErrorKind::NotFound, "the glTF itself is in no folder");
            return Err(missing(error));
        }
    };
    let folder = fs::canonicalize(base_dir).map_err(missing)?;
    let file = fs::canonicalize(base_dir.join(relative)).map_err(missing)?;
    if !file.starts_with(&folder) {
        return Err(Problem::LinkOutside(shortened(uri)));
    }
    // Asked before opening: opening a pipe would wait for its other end.
    if !fs::metadata(&file).map_err(missing)?.is_file() {
        return Err(missing(io::Error::other("it is not a file")));
    }
    Ok(file)
}

/// At most `longest` bytes of a file that was found for a URI.
///
/// # Errors
/// [`Problem::MissingFile`] if it can't be read.
pub(crate) fn read_file(file: &Path, uri: &str, longest: u64) -> Result<Vec<u8>, Problem> {
    let read = || {
        let mut bytes = Vec::new();
        File::open(file)?.take(longest).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error| Problem::MissingFile {
        uri: shortened(uri),
        error,
    })
}

/// Checks that no image leads out of the folder: also those that are never
/// decoded, as they would be copied. What else is wrong with an image is left
/// to its readers.
///
/// # Errors
/// [`Problem::LinkOutside`], at the image.
pub(crate) fn check_images(root: &Value, base_dir: Option<&Path>) -> Result<(), Fault> {
    let images = root.get("images").and_then(Value::as_array);
    for (index, image) in images.into_iter().flatten().enumerate() {
        let Some(uri) = image.get("uri").and_then(Value::as_str) else {
            continue;
        };
        let Some(relative) = uri::file(uri) else {
            continue;
        };
        if let Err(problem @ Problem::LinkOutside(_)) = find(base_dir, &relative, uri) {
            return Err(problem).at(|| property::place(root, "images", index));
        }
    }
    Ok(())
}
