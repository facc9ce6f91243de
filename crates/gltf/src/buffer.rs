//! Buffers: fetching their bytes.

use std::path::Path;

use serde_json::Value;

use super::error::{At, Fault, Problem};
use super::folder;
use super::property;
use super::uri::{self, Target};

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
    /// Exactly `byteLength` bytes, or none for a placeholder.
    pub(crate) bytes: Vec<u8>,
    pub(crate) source: BufferSource,
}

/// Fetches the bytes of all buffers.
pub(crate) fn load_all(
    root: &Value,
    mut chunk: Option<Vec<u8>>,
    base_dir: Option<&Path>,
) -> Result<Vec<Buffer>, Fault> {
    let list = property::list(root, "buffers")?;
    let mut buffers = Vec::with_capacity(list.len());
    for (index, json) in list.iter().enumerate() {
        let chunk = if index == 0 { chunk.take() } else { None };
        let buffer = load(json, chunk, base_dir);
        buffers.push(buffer.at(|| property::place(root, "buffers", index))?);
    }
    Ok(buffers)
}

fn load(json: &Value, chunk: Option<Vec<u8>>, base_dir: Option<&Path>) -> Result<Buffer, Problem> {
    let length = property::whole(json, "byteLength")?.ok_or(Problem::Missing("byteLength"))?;
    if is_fallback(json) {
        return Ok(placeholder());
    }
    let (mut bytes, source) = match (property::text(json, "uri")?, chunk) {
        (Some(uri), _) => match uri::resolve(uri)? {
            Target::Data(bytes) => (bytes, BufferSource::DataUri),
            Target::File { relative, uri } => (
                folder::read(base_dir, &relative, uri, length)?,
                BufferSource::File,
            ),
        },
        (None, Some(chunk)) => (chunk, BufferSource::Chunk),
        (None, None) => return Ok(placeholder()),
    };
    if (bytes.len() as u64) < length {
        return Err(Problem::ShortBuffer {
            expected: length,
            found: bytes.len() as u64,
        });
    }
    bytes.truncate(length as usize);
    Ok(Buffer { bytes, source })
}

fn placeholder() -> Buffer {
    Buffer {
        bytes: Vec::new(),
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
