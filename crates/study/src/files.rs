//! Folders that a study makes, and pictures that it wrote.

use std::fs;
use std::path::Path;

use crate::Error;

/// Makes a folder and those above it.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|e| Error::of_file(folder, "cannot be made", e))
}

/// Whether a path of a row is a picture that a study wrote: rows can come from elsewhere.
pub(crate) fn is_picture(path: &str) -> bool {
    let is_in = |folder: &str, ending: &str| {
        let name = path.strip_prefix(folder);
        name.is_some_and(|name| !name.contains(['/', '\\']) && name.ends_with(ending))
    };
    is_in("pictures/", ".jpg") || is_in("walk/", ".png")
}
