//! Where the files of a LOD go, and what is there already.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use secateur_model::Memory;
use serde_json::Value;

use super::{PreparedLod, WriteOptions, Written, uris};
use crate::container::{self, glb_bytes};
use crate::uri;
use crate::write::content::Content;
use crate::write::images::Copy;
use crate::write::staged_files::StagedFiles;
use crate::write_problem::WriteProblem;

/// Where a LOD goes.
pub(super) struct Output {
    path: PathBuf,
    pub(super) folder: PathBuf,
    /// The .bin beside a .gltf.
    bin: Option<PathBuf>,
}

/// What is in the way of a .gltf and its buffer.
#[derive(Default)]
pub(super) struct OldBuffers {
    /// Whether the .gltf that is there names the buffer that is there.
    is_named: bool,
    /// Buffers that a run which was killed left under names of their own.
    stranded: Vec<PathBuf>,
}

impl Output {
    /// A path that a user gave: where it is a link, what it leads to is written, and the buffer beside that.
    pub(super) fn of_user(path: &Path) -> Result<Self, WriteProblem> {
        match path.is_symlink() {
            true => Self::new(fs::canonicalize(path)?),
            false => Self::new(path.to_owned()),
        }
    }

    /// A path that takes the place of a link.
    pub(super) fn new(path: PathBuf) -> Result<Self, WriteProblem> {
        let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
        let bin = match extension.to_ascii_lowercase().as_str() {
            "glb" => None,
            // The JSON names the buffer.
            "gltf" if path.file_name().and_then(OsStr::to_str).is_none() => {
                return Err(WriteProblem::Name);
            }
            "gltf" => Some(path.with_extension("bin")),
            _ => return Err(WriteProblem::Extension),
        };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(WriteProblem::NoFolder(folder));
        }
        Ok(Self { path, folder, bin })
    }

    pub(super) fn paths(&self) -> Vec<PathBuf> {
        self.bin.iter().chain([&self.path]).cloned().collect()
    }

    /// Writes everything under temporary names.
    pub(super) fn stage(
        self,
        mut content: Content,
        images: &[Copy],
        options: WriteOptions,
        mut written: Written,
    ) -> Result<PreparedLod, WriteProblem> {
        let mut staged = StagedFiles::new();
        for copy in images {
            let mut source = fs::File::open(&copy.from)?;
            written.bytes += staged.add_from(copy.to.clone(), &mut source)?;
        }
        staged.sync_folders();
        let mut buffer = None;
        let mut stranded = Vec::new();
        let has_buffer = !content.buffer.is_empty();
        let file = match &self.bin {
            Some(bin) => {
                if has_buffer {
                    let old = self.old_buffers(options)?;
                    let is_new = fs::symlink_metadata(&self.path).is_err();
                    if is_new || (old.is_named && !has_content(bin, &content.buffer)) {
                        let other = self.unused_buffer_name();
                        staged.add_derived(&other, &content.buffer)?;
                        staged.sync_folders();
                        staged.add_derived(&self.path, &json_naming(&mut content.root, &other)?)?;
                        staged.sync_folders();
                        stranded.push(other);
                    }
                    stranded.extend(old.stranded);
                    staged.add_derived(bin, &content.buffer)?;
                    buffer = staged.last_temporary().map(Path::to_owned);
                    staged.sync_folders();
                    written.bytes += content.buffer.len() as u64;
                    written.files.push(bin.clone());
                }
                match has_buffer {
                    true => json_naming(&mut content.root, bin)?,
                    false => json_bytes(&content.root)?,
                }
            }
            None => glb_bytes(&content.root, content.buffer).ok_or(WriteProblem::TooLarge)?,
        };
        staged.add_derived(&self.path, &file)?;
        let main = staged.last_temporary().map(Path::to_owned);
        staged.sync_folders();
        stranded
            .into_iter()
            .for_each(|buffer| staged.remove(buffer));
        written.bytes += file.len() as u64;
        written.files.insert(0, self.path);
        written
            .files
            .extend(images.iter().map(|copy| copy.to.clone()));
        Ok(PreparedLod {
            written,
            staged,
            main: main.expect("it was added"),
            buffer,
            images: None,
            memory: Memory::Auto,
        })
    }

    /// # Errors
    /// [`WriteProblem::UnrelatedBuffer`] if a file that is no buffer of the .gltf
    /// is where the buffer goes, and may not be overwritten.
    pub(super) fn old_buffers(&self, options: WriteOptions) -> Result<OldBuffers, WriteProblem> {
        let Some(bin) = &self.bin else {
            return Ok(OldBuffers::default());
        };
        let named = buffers_of(&self.path);
        let in_folder = |name: &PathBuf| self.folder.join(name);
        let is_bin = |name: &PathBuf| Some(name.as_os_str()) == bin.file_name();
        let stranded = named.iter().filter(|name| self.is_of_a_killed_run(name));
        let old = OldBuffers {
            is_named: named.iter().any(is_bin) && bin.exists(),
            stranded: stranded.map(in_folder).collect(),
        };
        let is_own = old.is_named || !old.stranded.is_empty();
        match bin.exists() && !is_own && !options.overwrite {
            true => Err(WriteProblem::UnrelatedBuffer(bin.clone())),
            false => Ok(old),
        }
    }

    /// Names of a buffer that only the new .gltf knows, until the old buffer is
    /// not needed any more.
    fn other_buffer_name(&self, number: u32) -> PathBuf {
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        self.folder.join(format!("{stem}.secateur-{number}.bin"))
    }

    fn unused_buffer_name(&self) -> PathBuf {
        let names = (1..).map(|number| self.other_buffer_name(number));
        let is_free = |name: &PathBuf| fs::symlink_metadata(name).is_err();
        names.clone().find(is_free).expect("a folder has an end")
    }

    fn is_of_a_killed_run(&self, name: &Path) -> bool {
        let number = || {
            let stem = self.path.file_stem()?.to_str()?;
            let rest = name.to_str()?.strip_prefix(stem)?;
            let digits = rest.strip_prefix(".secateur-")?.strip_suffix(".bin")?;
            digits.parse::<u32>().ok()
        };
        number().is_some_and(|n| self.other_buffer_name(n) == self.folder.join(name))
    }
}

/// The buffers beside a .gltf that is there, as paths from its folder.
fn buffers_of(path: &Path) -> Vec<PathBuf> {
    // A pipe would be waited for.
    if !path.is_file() {
        return Vec::new();
    }
    let unpacked = fs::read(path)
        .ok()
        .and_then(|file| container::unpack(file, Memory::Auto).ok());
    unpacked.map_or_else(Vec::new, |old| {
        let files = uris(&old.root, "buffers").filter_map(uri::file);
        files.map(|relative| plain(&relative)).collect()
    })
}

/// A path without `.` in it.
fn plain(relative: &Path) -> PathBuf {
    let is_name = |part: &Component| matches!(part, Component::Normal(_));
    relative.components().filter(is_name).collect()
}

fn has_content(path: &Path, bytes: &[u8]) -> bool {
    let is_as_long = fs::metadata(path).is_ok_and(|there| there.len() == bytes.len() as u64);
    is_as_long && fs::read(path).is_ok_and(|there| there == bytes)
}

/// The JSON of a .gltf whose buffer is this file beside it.
fn json_naming(root: &mut Value, buffer: &Path) -> Result<Vec<u8>, WriteProblem> {
    let name = buffer.file_name().and_then(OsStr::to_str);
    let name = name.ok_or(WriteProblem::Name)?;
    root["buffers"][0]["uri"] = utf8_percent_encode(name, ESCAPED).to_string().into();
    json_bytes(root)
}

fn json_bytes(root: &Value) -> Result<Vec<u8>, WriteProblem> {
    Ok(serde_json::to_vec_pretty(root).map_err(io::Error::from)?)
}

/// All but what RFC 3986 (section 2.3) calls unreserved.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');
