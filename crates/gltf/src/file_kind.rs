//! What a file's name says that it holds.

use std::ffi::OsStr;
use std::path::Path;

/// Whether a file's name ends in one of these extensions, such as `glb`, in letters of any size.
pub fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let own = path.extension().and_then(OsStr::to_str);
    own.is_some_and(|own| extensions.iter().any(|one| own.eq_ignore_ascii_case(one)))
}

/// Whether a file's name is one of a glTF: it ends in .glb or .gltf.
pub fn is_gltf_name(path: &Path) -> bool {
    has_extension(path, &["glb", "gltf"])
}
