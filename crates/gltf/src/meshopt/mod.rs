//! EXT_meshopt_compression and KHR_meshopt_compression: compressed views.
//!
//! Written from the bitstream appendices of the two extensions' specifications
//! (Khronos glTF registry). KHR is EXT with a second version of the attribute
//! stream and one more filter; each is recognised by its own header, so that
//! both names lead here.
//!
//! The library of the format's authors, which other crates of this workspace
//! simplify with, decodes too, but in C++: who only edits glTF would need a C++
//! compiler, and hostile streams would meet code that no bounds check guards.
//! This decoder is safe Rust, agrees with theirs on streams of every mode and
//! filter (see the tests), and is the only one that is linked here.

mod attributes;
mod filters;
mod indices;
mod triangles;
mod varint;

use std::borrow::Cow;
use std::sync::atomic::Ordering;

use serde_json::Value;

use super::Document;
use super::error::{ALLOW_MORE, At, Fault, Problem, shortened};
use super::property;
use filters::Filter;
pub(crate) use filters::octahedral_of_bytes;

/// What kind of stream it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// A compressed view, as its extension describes it.
#[derive(Clone, Copy, Debug)]
struct Compressed {
    buffer: usize,
    byte_offset: u64,
    byte_length: u64,
    stride: usize,
    count: usize,
    mode: Mode,
    filter: Filter,
}

/// Decompressed bytes allowed however small the file: 16 MiB.
const FREE_BYTES: u64 = 16 << 20;

/// Decompressed bytes allowed for each byte of the file's buffers. The first
/// version can't do better; the second can, on nothing but zeros.
const BYTES_PER_BYTE: u64 = 64;

/// The compression of a view, if it has one.
fn extension(view: &Value) -> Option<&Value> {
    property::extension(view, "EXT_meshopt_compression")
        .or_else(|| property::extension(view, "KHR_meshopt_compression"))
}

impl Document {
    /// The decompressed bytes of `bufferViews[index]`, or `None` where it isn't
    /// compressed. Decompresses once.
    pub(super) fn decompressed(&self, index: usize, view: &Value) -> Result<Option<&[u8]>, Fault> {
        let Some(json) = extension(view) else {
            return Ok(None);
        };
        let cell = &self.decompressed_views[index];
        if cell.get().is_none() {
            let place = || self.place("bufferViews", index);
            let bytes = self.decompress(json, view).at(place)?;
            // Another thread may have been first; its bytes are the same.
            let _ = cell.set(bytes);
        }
        Ok(cell.get().map(Vec::as_slice))
    }

    /// The stream that the extension of `bufferViews[index]` names.
    pub(super) fn stream_bytes(&self, index: usize, json: &Value) -> Result<Cow<'_, [u8]>, Fault> {
        let read = || {
            let compressed = Compressed::read(json)?;
            let (buffer, range) = self.buffer_range(
                compressed.buffer,
                compressed.byte_offset,
                compressed.byte_length,
            )?;
            buffer.bytes(range)
        };
        read().at(|| self.place("bufferViews", index))
    }

    fn decompress(&self, json: &Value, view: &Value) -> Result<Vec<u8>, Problem> {
        let compressed = Compressed::read(json)?;
        compressed.check(view)?;
        let Compressed { stride, count, .. } = compressed;
        let size = count as u64 * stride as u64;
        let limit = FREE_BYTES.saturating_add(BYTES_PER_BYTE.saturating_mul(self.data_bytes));
        if self
            .decompressed_bytes
            .load(Ordering::Relaxed)
            .saturating_add(size)
            > limit
        {
            return Err(Problem::TooMuch {
                what: "decompressed bytes",
                limit,
            });
        }
        let held = self.decompressed_bytes.load(Ordering::Relaxed);
        let what = || format!("{count} elements of {stride} bytes that are compressed");
        let mut budget = self.budget;
        budget.take(held.saturating_add(size), what, ALLOW_MORE)?;
        let (buffer, range) = self.buffer_range(
            compressed.buffer,
            compressed.byte_offset,
            compressed.byte_length,
        )?;
        let bytes = compressed
            .decode(&buffer.bytes(range)?)
            .map_err(|error| Problem::Meshopt(error.0))?;
        self.decompressed_bytes.fetch_add(size, Ordering::Relaxed);
        Ok(bytes)
    }
}

impl Compressed {
    fn read(json: &Value) -> Result<Self, Problem> {
        let bad = |property, expected, found: &str| Problem::BadProperty {
            property,
            expected,
            found: shortened(found),
        };
        let mode = match property::text(json, "mode")?.ok_or(Problem::Missing("mode"))? {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => {
                return Err(bad("mode", "ATTRIBUTES, TRIANGLES or INDICES", other));
            }
        };
        let filter = property::text(json, "filter")?.unwrap_or("NONE");
        let filter = Filter::from_name(filter).ok_or_else(|| {
            let known = "NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR";
            bad("filter", known, filter)
        })?;
        Ok(Self {
            buffer: property::required_index(json, "buffer")?,
            byte_offset: property::whole(json, "byteOffset")?.unwrap_or(0),
            byte_length: property::whole(json, "byteLength")?
                .ok_or(Problem::Missing("byteLength"))?,
            stride: property::required_index(json, "byteStride")?,
            count: property::required_index(json, "count")?,
            mode,
            filter,
        })
    }

    /// The bytes that a stream stands for.
    fn decode(&self, source: &[u8]) -> Result<Vec<u8>, StreamError> {
        let (count, stride) = (self.count, self.stride);
        let mut bytes = match self.mode {
            Mode::Attributes => attributes::decode(source, count, stride)?,
            Mode::Triangles => narrow(&triangles::decode(source, count)?, stride),
            Mode::Indices => narrow(&indices::decode(source, count)?, stride),
        };
        self.filter.apply(&mut bytes, stride);
        Ok(bytes)
    }

    /// The rules the specification sets for stride, count and filter.
    fn check(&self, view: &Value) -> Result<(), Problem> {
        let stride_fits = match self.mode {
            Mode::Attributes => (4..=256).contains(&self.stride) && self.stride.is_multiple_of(4),
            Mode::Triangles | Mode::Indices => matches!(self.stride, 2 | 4),
        };
        if !stride_fits || !self.filter.fits(self.stride) {
            return Err(Problem::Meshopt(
                "its stride doesn't suit its mode or filter",
            ));
        }
        if self.mode != Mode::Attributes && self.filter != Filter::None {
            return Err(Problem::Meshopt("indices can't have a filter"));
        }
        if self.mode == Mode::Triangles && !self.count.is_multiple_of(3) {
            return Err(Problem::Meshopt("its indices make no whole triangles"));
        }
        let size = self.count as u128 * self.stride as u128;
        let length = property::whole(view, "byteLength")?;
        if length.is_none_or(|length| u128::from(length) != size) {
            return Err(Problem::Meshopt(
                "its count and stride don't make up the view's length",
            ));
        }
        Ok(())
    }
}

/// What is wrong with a compressed stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StreamError(&'static str);

const ENDS_EARLY: StreamError = StreamError("it ends too early");
const GOES_ON: StreamError = StreamError("it goes on past its end");
const WRONG_HEADER: StreamError = StreamError("its first byte is of no known version");

/// Indices as bytes of two or four each.
fn narrow(indices: &[u32], stride: usize) -> Vec<u8> {
    match stride {
        2 => indices
            .iter()
            .flat_map(|&i| (i as u16).to_le_bytes())
            .collect(),
        _ => indices.iter().flat_map(|&i| i.to_le_bytes()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream of the reference encoder and what the reference decoder makes
    /// of it (see tests/data/README.md).
    struct Case {
        name: String,
        compressed: Compressed,
        encoded: &'static [u8],
        decoded: &'static [u8],
    }

    fn take(rest: &mut &'static [u8], count: usize) -> &'static [u8] {
        let (taken, after) = rest.split_at(count);
        *rest = after;
        taken
    }

    fn cases() -> Vec<Case> {
        const FILTERS: [&str; 5] = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];
        const MODES: [Mode; 3] = [Mode::Attributes, Mode::Triangles, Mode::Indices];
        let mut rest: &[u8] = include_bytes!("../../tests/data/meshopt_streams.bin");
        let mut cases = Vec::new();
        while !rest.is_empty() {
            let head = take(&mut rest, 16);
            let number = |at: usize| u32::from_le_bytes(head[at..at + 4].try_into().unwrap());
            let (count, stride) = (number(4) as usize, number(8) as usize);
            let name = take(&mut rest, usize::from(head[2]));
            let encoded = take(&mut rest, number(12) as usize);
            cases.push(Case {
                name: String::from_utf8(name.to_vec()).unwrap(),
                compressed: Compressed {
                    buffer: 0,
                    byte_offset: 0,
                    byte_length: encoded.len() as u64,
                    stride,
                    count,
                    mode: MODES[usize::from(head[0])],
                    filter: Filter::from_name(FILTERS[usize::from(head[1])]).unwrap(),
                },
                encoded,
                decoded: take(&mut rest, count * stride),
            });
        }
        cases
    }

    /// The greatest difference of two runs of components of 1 or 2 bytes, as
    /// signed numbers that wrap.
    fn difference(a: &[u8], b: &[u8], component_bytes: usize) -> i32 {
        let value = |bytes: &[u8]| match *bytes {
            [x] => i32::from(x),
            [x, y] => i32::from(u16::from_le_bytes([x, y])),
            _ => unreachable!(),
        };
        let range = 1 << (8 * component_bytes);
        let pairs = a.chunks(component_bytes).zip(b.chunks(component_bytes));
        let apart = pairs.map(|(a, b)| (value(a) - value(b)).rem_euclid(range));
        apart.map(|d| d.min(range - d)).max().unwrap_or(0)
    }

    #[test]
    fn streams_of_the_reference_encoder_decode_as_its_decoder_does() {
        let cases = cases();
        assert_eq!(cases.len(), 26);
        for case in cases {
            let decoded = case.compressed.decode(case.encoded).unwrap();
            // Filters through floats may round otherwise: the specification
            // allows one unit.
            let allowed = match case.compressed.filter {
                Filter::None | Filter::Exponential => 0,
                _ => 1,
            };
            let component_bytes = if case.compressed.stride == 8 { 2 } else { 1 };
            let apart = difference(&decoded, case.decoded, component_bytes);
            assert!(apart <= allowed, "{}: {apart}", case.name);
        }
    }

    #[test]
    fn damaged_streams_are_errors_or_other_numbers_but_never_more() {
        for case in cases() {
            for cut in 0..case.encoded.len().min(64) {
                let shorter = &case.encoded[..case.encoded.len() - 1 - cut];
                let _ = case.compressed.decode(shorter);
            }
            assert!(case.compressed.decode(&[]).is_err(), "{}", case.name);
            let longer = Compressed {
                count: 3 * (case.encoded.len() + 1) * 1024,
                ..case.compressed
            };
            assert_eq!(
                longer.decode(case.encoded),
                Err(ENDS_EARLY),
                "{}",
                case.name
            );
        }
    }
}
