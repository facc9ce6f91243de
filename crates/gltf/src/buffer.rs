//! Buffers: fetching their bytes.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use super::binary_chunk::BinaryChunk;
use super::error::{ALLOW_MORE, At, Fault, Problem, shortened};
use super::folder;
use super::property;
use super::uri::{self, Target};
use secateur_model::Budget;

/// Where the bytes of a buffer came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BufferSource {
    /// The binary chunk of the GLB.
    Chunk,
    /// A data URI in the JSON.
    DataUri,
    /// A file beside the glTF.
    File,
    /// Nowhere: a placeholder for views whose data is compressed elsewhere.
    Placeholder,
}

/// The bytes of an entry of `buffers`.
#[derive(Clone, Debug)]
pub(crate) struct Buffer {
    /// At least `length` bytes, shared by all buffers of one file.
    shared: Arc<BinaryChunk>,
    /// `byteLength`, or 0 for a placeholder.
    length: usize,
    pub(crate) source: BufferSource,
}

impl Buffer {
    /// `byteLength`, or 0 for a placeholder.
    pub(crate) fn len(&self) -> usize {
        self.length
    }

    /// Some of its bytes.
    ///
    /// # Errors
    /// As [`BinaryChunk::bytes`].
    ///
    /// # Panics
    /// If the range ends beyond the buffer.
    pub(crate) fn bytes(&self, range: Range<usize>) -> Result<Cow<'_, [u8]>, Problem> {
        assert!(range.end <= self.length, "the range is within the buffer");
        self.shared.bytes(range)
    }

    /// Appends some of its bytes to others.
    ///
    /// # Errors
    /// As [`BinaryChunk::bytes`].
    ///
    /// # Panics
    /// If the range ends beyond the buffer.
    pub(crate) fn append_to(
        &self,
        others: &mut Vec<u8>,
        range: Range<usize>,
    ) -> Result<(), Problem> {
        assert!(range.end <= self.length, "the range is within the buffer");
        self.shared.append_to(others, range)
    }

    #[cfg(test)]
    pub(crate) fn is_on_disk(&self) -> bool {
        matches!(*self.shared, BinaryChunk::Disk(_))
    }

    /// A buffer that no file has, of these bytes.
    pub(crate) fn of(bytes: Vec<u8>) -> Self {
        Self {
            length: bytes.len(),
            shared: in_memory(bytes),
            source: BufferSource::DataUri,
        }
    }
}

/// How many bytes there are.
pub(crate) fn distinct_bytes(buffers: &[Buffer]) -> u64 {
    let all = buffers
        .iter()
        .map(|b| (Arc::as_ptr(&b.shared), b.shared.len() as u64));
    all.collect::<HashMap<_, _>>().values().sum()
}

/// Fetches the bytes of all buffers.
pub(crate) fn load_all(
    root: &Value,
    mut chunk: Option<BinaryChunk>,
    base_dir: Option<&Path>,
    budget: &mut Budget,
) -> Result<Vec<Buffer>, Fault> {
    let list = property::list(root, "buffers")?;
    let mut files = Files::new(base_dir);
    for json in list {
        files.announce(json);
    }
    let mut buffers = Vec::with_capacity(list.len());
    for (index, json) in list.iter().enumerate() {
        let chunk = if index == 0 { chunk.take() } else { None };
        let buffer = load(json, chunk, &mut files, budget);
        buffers.push(buffer.at(|| property::place(root, "buffers", index))?);
    }
    Ok(buffers)
}

fn load(
    json: &Value,
    chunk: Option<BinaryChunk>,
    files: &mut Files,
    budget: &mut Budget,
) -> Result<Buffer, Problem> {
    let length = property::whole(json, "byteLength")?.ok_or(Problem::Missing("byteLength"))?;
    if is_fallback(json) {
        return Ok(placeholder());
    }
    let (shared, source) = match (property::text(json, "uri")?, chunk) {
        (Some(uri), _) => {
            if uri::file(uri).is_none() {
                // At most as long as it is written.
                let what = || "the data within its URI".to_owned();
                budget.take(uri.len() as u64, what, ALLOW_MORE)?;
            }
            match uri::resolve(uri)? {
                Target::Data(bytes) => (in_memory(bytes), BufferSource::DataUri),
                Target::File { relative, uri } => {
                    let file = files.read(&relative, uri, length, budget)?;
                    (file, BufferSource::File)
                }
            }
        }
        (None, Some(chunk)) => (Arc::new(chunk), BufferSource::Chunk),
        (None, None) => return Ok(placeholder()),
    };
    if (shared.len() as u64) < length {
        return Err(Problem::ShortBuffer {
            expected: length,
            found: shared.len() as u64,
        });
    }
    Ok(Buffer {
        shared,
        length: length as usize,
        source,
    })
}

/// The files that buffers name, each read at most once: a small glTF can name a
/// large file many times.
struct Files<'a> {
    base_dir: Option<&'a Path>,
    /// By the file, links followed, how much of it some buffer needs.
    longest: HashMap<PathBuf, u64>,
    read: HashMap<PathBuf, Arc<BinaryChunk>>,
}

impl<'a> Files<'a> {
    fn new(base_dir: Option<&'a Path>) -> Self {
        Self {
            base_dir,
            longest: HashMap::new(),
            read: HashMap::new(),
        }
    }

    /// Notes what a buffer needs. What is wrong with it is left to its reading.
    fn announce(&mut self, json: &Value) {
        let uri = json.get("uri").and_then(Value::as_str);
        let length = property::whole(json, "byteLength").ok().flatten();
        let (Some(uri), Some(length), false) = (uri, length, is_fallback(json)) else {
            return;
        };
        if let Some(relative) = uri::file(uri)
            && let Ok(file) = folder::find(self.base_dir, &relative, uri)
        {
            let longest = self.longest.entry(file).or_insert(0);
            *longest = length.max(*longest);
        }
    }

    fn read(
        &mut self,
        relative: &Path,
        uri: &str,
        length: u64,
        budget: &mut Budget,
    ) -> Result<Arc<BinaryChunk>, Problem> {
        let file = folder::find(self.base_dir, relative, uri)?;
        if let Some(known) = self.read.get(&file) {
            return Ok(Arc::clone(known));
        }
        let longest = self
            .longest
            .get(&file)
            .map_or(length, |&all| all.max(length));
        let there = std::fs::metadata(&file).map_or(longest, |there| there.len());
        let what = || format!("the file `{}`", shortened(uri));
        budget.take(there.min(longest), what, ALLOW_MORE)?;
        let bytes = in_memory(folder::read_file(&file, uri, longest)?);
        self.read.insert(file, Arc::clone(&bytes));
        Ok(bytes)
    }
}

fn in_memory(bytes: Vec<u8>) -> Arc<BinaryChunk> {
    Arc::new(BinaryChunk::Memory(bytes))
}

fn placeholder() -> Buffer {
    Buffer {
        shared: in_memory(Vec::new()),
        length: 0,
        source: BufferSource::Placeholder,
    }
}

/// Whether a buffer only serves readers without meshopt decompression.
fn is_fallback(json: &Value) -> bool {
    let flagged = |name| {
        property::extension(json, name)
            .and_then(|e| e.get("fallback"))
            .and_then(Value::as_bool)
            == Some(true)
    };
    flagged("EXT_meshopt_compression") || flagged("KHR_meshopt_compression")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_file_that_is_named_often_is_in_memory_once() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("big.bin"), [1, 2, 3, 4, 5, 6, 7, 8]).unwrap();
        // One file under several names, and more or less of it.
        let named = [("big.bin", 2), ("./big.bin", 6), ("big%2Ebin", 6)];
        let json = named.map(|(uri, length)| json!({"uri": uri, "byteLength": length}));
        let root = json!({ "buffers": json });
        let mut budget = Budget::new(secateur_model::Memory::Bytes(7));
        let loaded = load_all(&root, None, Some(folder.path()), &mut budget).unwrap();
        assert_eq!(budget.left(), 1);
        let bytes = loaded.iter().map(|b| b.bytes(0..b.len()).unwrap());
        let expected: [&[u8]; 3] = [&[1, 2], &[1, 2, 3, 4, 5, 6], &[1, 2, 3, 4, 5, 6]];
        assert!(bytes.eq(expected));
        assert_eq!(distinct_bytes(&loaded), 6);
    }
}
