//! The GLB container: a header and two chunks, JSON and bytes (glTF 2.0,
//! section 4.4); and telling it from bare JSON.
//!
//! Reading and writing it takes less code than calling the `gltf` crate for it
//! would, whose parser trusts the header's length and refuses the chunks of
//! unknown type that the specification says to ignore; and nothing else of that
//! crate could be used here: it turns the JSON into its own structures, which
//! loses what it does not know.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use serde_json::Value;

use super::binary_chunk::{BinaryChunk, ChunkOnDisk};
use super::error::{ALLOW_MORE, Problem};
use super::property;
use secateur_model::{Budget, Memory};

const MAGIC: &[u8; 4] = b"glTF";
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;
/// Chunks start and end at multiples of this many bytes.
const ALIGNMENT: usize = 4;
const JSON_CHUNK: [u8; 4] = *b"JSON";
const BYTES_CHUNK: [u8; 4] = *b"BIN\0";

/// The pieces of a file.
pub(crate) struct Unpacked {
    pub(crate) root: Value,
    /// The bytes of the GLB's second chunk, if there is one.
    pub(crate) chunk: Option<BinaryChunk>,
    /// How much memory the file may take.
    pub(crate) memory: Memory,
    /// What is left of it.
    pub(crate) budget: Budget,
}

/// Tells GLB from JSON and parses the JSON.
pub(crate) fn unpack(mut file: Vec<u8>, memory: Memory) -> Result<Unpacked, Problem> {
    let mut budget = Budget::new(memory);
    budget.take(file.len() as u64, || "the file".to_owned(), ALLOW_MORE)?;
    let (json, chunk) = if file.starts_with(MAGIC) {
        let four_bytes = |at: usize| file.get(at..at + 4)?.try_into().ok();
        chunks(file.len(), &mut |at| Ok(four_bytes(at)))?
    } else {
        (0..file.len(), None)
    };
    let root = parse(&file[json], &mut budget)?;
    // In the file's own memory: the chunk is nearly all of a large file.
    let chunk = chunk.map(|range| {
        file.truncate(range.end);
        file.drain(..range.start);
        BinaryChunk::Memory(file)
    });
    Ok(Unpacked {
        root,
        chunk,
        memory,
        budget,
    })
}

/// What a value in a list takes when it is parsed, with room for more behind it.
const BYTES_A_VALUE: u64 = 2 * size_of::<Value>() as u64;

/// What a property of an object takes besides its value: the name, an allocation for
/// that, and the place in its table.
const BYTES_A_NAME: u64 = 128;

/// What JSON takes at most when it is parsed, from the marks in it: values are
/// parted by commas and brackets, names are followed by colons. Marks in texts count
/// too.
fn parsed_bytes(json: &[u8]) -> u64 {
    let (mut values, mut names) = (1, 0);
    for byte in json {
        values += u64::from(matches!(byte, b',' | b'[' | b'{'));
        names += u64::from(*byte == b':');
    }
    values * BYTES_A_VALUE + names * BYTES_A_NAME + json.len() as u64
}

/// Parses the JSON of a file, with memory for it.
fn parse(json: &[u8], budget: &mut Budget) -> Result<Value, Problem> {
    budget.take(parsed_bytes(json), || "its JSON".to_owned(), ALLOW_MORE)?;
    let root = parse_json(json)?;
    check_version(&root)?;
    Ok(root)
}

/// [`unpack`] of a GLB of at least `least_bytes` whose second chunk stays in its file; `None` for
/// any other file.
///
/// # Errors
/// [`Problem`] if it can't be read or is no glTF that can be used.
pub(crate) fn unpack_on_disk(
    path: &Path,
    memory: Memory,
    least_bytes: u64,
) -> Result<Option<Unpacked>, Problem> {
    let there = fs::metadata(path).map_err(Problem::Unreadable)?;
    // A pipe can be read but once.
    if !there.is_file() || there.len() < least_bytes {
        return Ok(None);
    }
    let mut file = File::open(path).map_err(Problem::Unreadable)?;
    let length = there.len() as usize;
    let mut four_bytes = |at: usize| {
        let is_there = at.checked_add(4).is_some_and(|end| end <= length);
        let read = || -> io::Result<[u8; 4]> {
            let mut bytes = [0; 4];
            file.seek(SeekFrom::Start(at as u64))?;
            file.read_exact(&mut bytes)?;
            Ok(bytes)
        };
        is_there.then(read).transpose().map_err(Problem::Unreadable)
    };
    if four_bytes(0)?.as_ref() != Some(MAGIC) {
        return Ok(None);
    }
    let (json, chunk) = chunks(length, &mut four_bytes)?;
    let mut budget = Budget::new(memory);
    budget.take(json.len() as u64, || "its JSON".to_owned(), ALLOW_MORE)?;
    let mut whole = || -> io::Result<(Vec<u8>, Option<ChunkOnDisk>)> {
        let mut text = vec![0; json.len()];
        file.seek(SeekFrom::Start(json.start as u64))?;
        file.read_exact(&mut text)?;
        let of_chunk = |range| ChunkOnDisk::new(file.try_clone()?, range);
        Ok((text, chunk.clone().map(of_chunk).transpose()?))
    };
    let (json, chunk) = whole().map_err(Problem::Unreadable)?;
    Ok(Some(Unpacked {
        root: parse(&json, &mut budget)?,
        chunk: chunk.map(BinaryChunk::Disk),
        memory,
        budget,
    }))
}

/// Four bytes of a file from here on; `None` where it ends before.
type FourBytes<'a> = dyn FnMut(usize) -> Result<Option<[u8; 4]>, Problem> + 'a;

/// Where the JSON of a GLB is, and its bytes, if it has any. `found` is the length of the file.
fn chunks(
    found: usize,
    four_bytes: &mut FourBytes<'_>,
) -> Result<(Range<usize>, Option<Range<usize>>), Problem> {
    let (Some(version), Some(length)) = (word(four_bytes, 4)?, word(four_bytes, 8)?) else {
        return Err(Problem::Truncated {
            expected: HEADER_BYTES as u64,
            found: found as u64,
        });
    };
    if version != 2 {
        return Err(Problem::Version(version.to_string()));
    }
    if length < HEADER_BYTES {
        let reason = format!("its header gives a length of {length} bytes");
        return Err(Problem::DamagedGlb(reason));
    }
    if length > found {
        return Err(Problem::Truncated {
            expected: length as u64,
            found: found as u64,
        });
    }
    let damaged = |reason: &str| Problem::DamagedGlb(reason.to_owned());
    let json = match chunk_at(length, four_bytes, HEADER_BYTES)? {
        Some(chunk) if chunk.kind == JSON_CHUNK => chunk.data,
        _ => return Err(damaged("its first chunk is not JSON")),
    };
    // Chunks of other types, and those that follow, are passed over: they are of
    // versions to come.
    match chunk_at(length, four_bytes, json.end)? {
        Some(chunk) if chunk.kind == BYTES_CHUNK => Ok((json, Some(chunk.data))),
        Some(chunk) if chunk.kind == JSON_CHUNK => Err(damaged("it has two JSON chunks")),
        _ => Ok((json, None)),
    }
}

struct Chunk {
    kind: [u8; 4],
    /// Where its data is in the file.
    data: Range<usize>,
}

/// The chunk that starts here; `None` at `end`, where the GLB ends.
fn chunk_at(
    end: usize,
    four_bytes: &mut FourBytes<'_>,
    start: usize,
) -> Result<Option<Chunk>, Problem> {
    if start == end {
        return Ok(None);
    }
    let data = start + CHUNK_HEADER_BYTES;
    let head = match data <= end {
        true => word(four_bytes, start)?.zip(four_bytes(start + 4)?),
        false => None,
    };
    let Some((length, kind)) = head else {
        let reason = "it ends within the header of a chunk";
        return Err(Problem::DamagedGlb(reason.to_owned()));
    };
    let left = end - data;
    if length > left {
        let reason = format!("a chunk of {length} bytes starts where only {left} are left");
        return Err(Problem::DamagedGlb(reason));
    }
    Ok(Some(Chunk {
        kind,
        data: data..data + length,
    }))
}

fn word(four_bytes: &mut FourBytes<'_>, at: usize) -> Result<Option<usize>, Problem> {
    Ok(four_bytes(at)?.map(|bytes| u32::from_le_bytes(bytes) as usize))
}

/// How the file begins that Git LFS leaves where it has not fetched the file itself.
const LFS_POINTER: &[u8] = b"version https://git-lfs";

fn parse_json(bytes: &[u8]) -> Result<Value, Problem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.is_empty() {
        return Err(Problem::NotGltf("it is empty".to_owned()));
    }
    if bytes.starts_with(LFS_POINTER) {
        let reason = "it is a pointer of Git LFS, not the file itself: `git lfs pull` fetches that";
        return Err(Problem::NotGltf(reason.to_owned()));
    }
    let root: Value = serde_json::from_slice(bytes)
        .map_err(|error| Problem::NotGltf(format!("its JSON cannot be parsed ({error})")))?;
    if root.get("asset").is_none_or(|asset| !asset.is_object()) {
        return Err(Problem::NotGltf("its JSON has no `asset`".to_owned()));
    }
    Ok(root)
}

fn check_version(root: &Value) -> Result<(), Problem> {
    let asset = &root["asset"];
    let major_minor = |text: &str| -> Option<(u32, u32)> {
        let (major, minor) = text.split_once('.')?;
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    let version = property::text(asset, "version")?.ok_or(Problem::Missing("asset.version"))?;
    if major_minor(version).is_none_or(|(major, _)| major != 2) {
        return Err(Problem::Version(super::error::shortened(version)));
    }
    if let Some(least) = property::text(asset, "minVersion")?
        && major_minor(least).is_none_or(|least| least > (2, 0))
    {
        return Err(Problem::Version(super::error::shortened(least)));
    }
    Ok(())
}

/// The bytes of a GLB with this JSON and, unless it is empty, this buffer, or
/// `None` if its length does not fit the format's 32 bits.
///
/// In the buffer's own memory, as it may be large.
pub(crate) fn glb_bytes(root: &Value, mut buffer: Vec<u8>) -> Option<Vec<u8>> {
    let mut json = serde_json::to_vec(root).expect("a JSON value can be written");
    json.resize(json.len().next_multiple_of(ALIGNMENT), b' ');
    let has_buffer = !buffer.is_empty();
    buffer.resize(buffer.len().next_multiple_of(ALIGNMENT), 0);
    let chunk_headers = if has_buffer { 2 } else { 1 } * CHUNK_HEADER_BYTES;
    let total = HEADER_BYTES + chunk_headers + json.len() + buffer.len();
    let total = u32::try_from(total).ok()?;

    let mut head = Vec::with_capacity(HEADER_BYTES + chunk_headers + json.len());
    head.extend_from_slice(b"glTF");
    head.extend_from_slice(&2u32.to_le_bytes());
    head.extend_from_slice(&total.to_le_bytes());
    push_chunk_header(&mut head, JSON_CHUNK, json.len());
    head.extend_from_slice(&json);
    if has_buffer {
        push_chunk_header(&mut head, BYTES_CHUNK, buffer.len());
    }
    buffer.splice(0..0, head);
    Some(buffer)
}

fn push_chunk_header(glb: &mut Vec<u8>, kind: [u8; 4], bytes: usize) {
    glb.extend_from_slice(&(bytes as u32).to_le_bytes());
    glb.extend_from_slice(&kind);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A GLB of these chunks.
    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let total: usize = chunks.iter().map(|(_, data)| 8 + data.len()).sum();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + total as u32).to_le_bytes());
        for (kind, data) in chunks {
            push_chunk_header(&mut file, **kind, data.len());
            file.extend_from_slice(data);
        }
        file
    }

    const ASSET: &[u8] = br#"{"asset":{"version":"2.0"}} "#;

    #[test]
    fn chunks_are_padded_and_counted() {
        // {"a":1} is 7 bytes, so one space; the buffer of 5 gets three zeros.
        let glb = glb_bytes(&json!({"a": 1}), vec![1, 2, 3, 4, 5]).unwrap();
        assert_eq!(glb.len(), 12 + 8 + 8 + 8 + 8);
        assert_eq!(glb[8..12], 44u32.to_le_bytes());
        assert_eq!(&glb[12..28], b"\x08\0\0\0JSON{\"a\":1} ");
        assert_eq!(&glb[28..], b"\x08\0\0\0BIN\0\x01\x02\x03\x04\x05\0\0\0");
    }

    #[test]
    fn no_buffer_no_chunk() {
        let glb = glb_bytes(&json!({}), Vec::new()).unwrap();
        assert_eq!(&glb[12..], b"\x04\0\0\0JSON{}  ");
    }

    #[test]
    fn what_was_written_is_read() {
        let root: Value = serde_json::from_slice(ASSET).unwrap();
        for bytes in [&[][..], &[1, 2, 3, 4]] {
            let read = unpack(glb_bytes(&root, bytes.to_vec()).unwrap(), Memory::Auto).unwrap();
            assert_eq!(read.root, root);
            let chunk = read.chunk.unwrap_or(BinaryChunk::Memory(Vec::new()));
            assert_eq!(chunk.bytes(0..chunk.len()).unwrap(), bytes);
        }
    }

    #[test]
    fn chunks_of_types_to_come_are_passed_over() {
        let with = |chunks: &[_]| {
            let chunk = unpack(glb(chunks), Memory::Auto).unwrap().chunk?;
            let bytes = chunk.bytes(0..chunk.len());
            Some(bytes.unwrap().into_owned())
        };
        let after = [(b"JSON", ASSET), (b"BIN\0", b"data"), (b"NEXT", b"abcd")];
        assert_eq!(with(&after), Some(b"data".to_vec()));
        assert_eq!(with(&[(b"JSON", ASSET), (b"NEXT", b"abcd")]), None);
    }

    #[test]
    fn chunks_that_do_not_fit_together_are_damage() {
        let refused = |file: Vec<u8>| match unpack(file, Memory::Auto) {
            Err(Problem::DamagedGlb(reason)) => reason,
            _ => panic!("not refused as a damaged GLB"),
        };
        let says = refused(glb(&[(b"BIN\0", b"data")]));
        assert_eq!(says, "its first chunk is not JSON");
        assert_eq!(refused(glb(&[])), "its first chunk is not JSON");
        let says = refused(glb(&[(b"JSON", ASSET), (b"JSON", ASSET)]));
        assert_eq!(says, "it has two JSON chunks");

        let mut longer = glb(&[(b"JSON", ASSET), (b"BIN\0", b"data")]);
        let at = longer.len() - 12;
        longer[at] = 5;
        let says = refused(longer);
        assert_eq!(says, "a chunk of 5 bytes starts where only 4 are left");

        let mut cut = glb(&[(b"JSON", ASSET), (b"BIN\0", b"")]);
        cut.pop();
        cut[8] -= 1;
        assert_eq!(refused(cut), "it ends within the header of a chunk");
    }
}
