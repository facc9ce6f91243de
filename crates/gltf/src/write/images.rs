//! Images in files of their own: which of them go along to another folder.
//!
//! A glTF may call any file beside it an image, `.envrc` or `.git/hooks/x` as
//! well, and in the folder of the output such a file may do something. So only
//! what a texture needs and what looks like an image, by its name and by its
//! first bytes, is copied, and only to where it was said to go: not through
//! links that lie there.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use super::references::as_index;
use crate::error::{Problem, shortened};
use crate::write_problem::WriteProblem;
use crate::{folder, uri};

/// A file to be copied.
pub(super) struct Copy {
    pub(super) from: PathBuf,
    pub(super) to: PathBuf,
}

/// The images of a glTF in the folder `from` that go along to the folder `to`.
/// `notes` gets a sentence for each image file: that it was copied, or why not.
///
/// # Errors
/// [`WriteProblem::Occupied`] if something else is where an image must go;
/// [`WriteProblem::Io`] if it can't be read.
pub(super) fn to_copy(
    root: &Value,
    from: &Path,
    to: &Path,
    notes: &mut Vec<String>,
) -> Result<Vec<Copy>, WriteProblem> {
    let mut copies = Vec::new();
    for file in image_files(root) {
        let name = file.name();
        match file.plan(from, to)? {
            Ok(copy) => {
                let place = copy.to.display();
                notes.push(format!("the image `{name}` was copied to `{place}`"));
                copies.push(copy);
            }
            Err(why) => notes.push(format!("the image `{name}` was not copied: {why}")),
        }
    }
    Ok(copies)
}

/// A file that is named as an image.
struct ImageFile {
    /// Below the folder of the glTF; names only.
    relative: PathBuf,
    /// Whether a texture needs it.
    is_used: bool,
}

/// All files that are named as images, each once.
fn image_files(root: &Value) -> Vec<ImageFile> {
    let used = images_of_textures(root);
    let mut files: Vec<ImageFile> = Vec::new();
    let mut known: HashMap<PathBuf, usize> = HashMap::new();
    let images = root.get("images").and_then(Value::as_array);
    for (number, image) in images.into_iter().flatten().enumerate() {
        let uri = image.get("uri").and_then(Value::as_str);
        let Some(path) = uri.and_then(uri::file) else {
            continue;
        };
        // `./a.png` is `a.png`.
        let is_name = |part: &Component| matches!(part, Component::Normal(_));
        let relative: PathBuf = path.components().filter(is_name).collect();
        let is_used = used.contains(&number);
        match known.get(&relative) {
            Some(&index) => files[index].is_used |= is_used,
            None => {
                known.insert(relative.clone(), files.len());
                files.push(ImageFile { relative, is_used });
            }
        }
    }
    files
}

/// The numbers of the images that textures name, themselves or in an extension
/// (`KHR_texture_basisu`, `EXT_texture_webp` and their like).
fn images_of_textures(root: &Value) -> HashSet<usize> {
    let textures = root.get("textures").and_then(Value::as_array);
    let mut used = HashSet::new();
    for texture in textures.into_iter().flatten() {
        let extensions = texture.get("extensions").and_then(Value::as_object);
        let extensions = extensions.into_iter().flat_map(|all| all.values());
        let holders = extensions.chain([texture]);
        used.extend(holders.filter_map(|holder| as_index(holder.get("source")?)));
    }
    used
}

impl ImageFile {
    fn name(&self) -> String {
        shortened(&self.relative.display().to_string())
    }

    /// From where to where it is copied; the inner error says why it is not.
    fn plan(&self, from: &Path, to: &Path) -> Result<Result<Copy, String>, WriteProblem> {
        let stays = |why: &str| Ok(Err(why.to_owned()));
        if !self.is_used {
            return stays("no texture uses it");
        }
        if self.is_hidden() {
            return stays("a part of its path begins with a dot");
        }
        if !self.is_named_as_image() {
            return stays("its name does not end in .png, .jpg, .jpeg, .webp or .ktx2");
        }
        let from = match folder::find(Some(from), &self.relative, &self.name()) {
            Ok(file) => file,
            // The input did not have it either.
            Err(Problem::MissingFile { .. }) => return stays("it is not there"),
            Err(problem) => return stays(&problem.to_string()),
        };
        if !begins_as_image(&from)? {
            return stays("it does not begin as a PNG, JPEG, WebP or KTX2 image");
        }
        if let Some(link) = link_on_the_way(to, &self.relative) {
            let link = link.display();
            return stays(&format!(
                "`{link}` is a symbolic link, and nothing is written through links"
            ));
        }
        let to = to.join(&self.relative);
        match fs::symlink_metadata(&to) {
            Err(_) => Ok(Ok(Copy { from, to })),
            // The content of a pipe is not asked for: that could take forever.
            Ok(there) if there.is_file() && fs::read(&from)? == fs::read(&to)? => {
                stays("it is there already")
            }
            Ok(_) => Err(WriteProblem::Occupied(to)),
        }
    }

    /// Whether it, or a folder on the way to it, is one that programs hide and
    /// take their settings from.
    fn is_hidden(&self) -> bool {
        let starts_with_dot = |part: Component| {
            let name = part.as_os_str().as_encoded_bytes();
            name.starts_with(b".")
        };
        self.relative.components().any(starts_with_dot)
    }

    /// Its first bytes alone would not do: `RIFF=1; WEBP=2` is WebP to them, and
    /// a line of Python.
    fn is_named_as_image(&self) -> bool {
        let extension = self.relative.extension().and_then(OsStr::to_str);
        let extension = extension.unwrap_or_default().to_ascii_lowercase();
        ["png", "jpg", "jpeg", "webp", "ktx2"].contains(&extension.as_str())
    }
}

fn begins_as_image(path: &Path) -> io::Result<bool> {
    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
    const JPEG: &[u8] = b"\xff\xd8\xff";
    const KTX2: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";
    let mut start = Vec::new();
    File::open(path)?.take(12).read_to_end(&mut start)?;
    let is_webp = start.starts_with(b"RIFF") && start.get(8..12) == Some(b"WEBP");
    Ok(is_webp
        || [PNG, JPEG, KTX2]
            .iter()
            .any(|magic| start.starts_with(magic)))
}

/// The first symbolic link among the folders below `folder` and the file that
/// `relative` leads through and to. The folder itself may be one: the user
/// named it.
fn link_on_the_way(folder: &Path, relative: &Path) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    for part in relative.components() {
        path.push(part);
        if fs::symlink_metadata(&path).is_ok_and(|there| there.is_symlink()) {
            return Some(path);
        }
    }
    None
}
