//! Buffer views: ranges of buffers.

use std::borrow::Cow;
use std::ops::Range;

use super::Document;
use super::buffer::{Buffer, BufferSource};
use super::error::{At, Fault, Problem};
use super::property;

/// Where the bytes of a view are.
pub(crate) enum Held<'a> {
    Decompressed(&'a [u8]),
    /// A range that is within the buffer.
    InBuffer(&'a Buffer, Range<usize>),
}

impl<'a> Held<'a> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Decompressed(bytes) => bytes.len(),
            Self::InBuffer(_, range) => range.len(),
        }
    }

    /// Some of the view's bytes.
    ///
    /// # Errors
    /// As [`Buffer::bytes`].
    ///
    /// # Panics
    /// If the range ends beyond the view.
    pub(crate) fn bytes(&self, part: Range<usize>) -> Result<Cow<'a, [u8]>, Problem> {
        assert!(part.end <= self.len(), "the range is within the view");
        match self {
            Self::Decompressed(bytes) => Ok(Cow::Borrowed(&bytes[part])),
            Self::InBuffer(buffer, range) => {
                buffer.bytes(range.start + part.start..range.start + part.end)
            }
        }
    }
}

impl Document {
    /// The bytes of `bufferViews[index]`, decompressed.
    pub(crate) fn view_bytes(&self, index: usize) -> Result<Cow<'_, [u8]>, Fault> {
        let held = self.held_view(index)?;
        let bytes = held.bytes(0..held.len());
        bytes.at(|| self.place("bufferViews", index))
    }

    /// Where the bytes of `bufferViews[index]` are, decompressed.
    pub(crate) fn held_view(&self, index: usize) -> Result<Held<'_>, Fault> {
        let json = property::entry(&self.root, "bufferViews", index)?;
        let place = || self.place("bufferViews", index);
        if let Some(bytes) = self.decompressed(index, json)? {
            return Ok(Held::Decompressed(bytes));
        }
        let buffer = property::required_index(json, "buffer").at(place)?;
        let offset = property::whole(json, "byteOffset").at(place)?.unwrap_or(0);
        let length = self.view_length(index)?;
        let (buffer, range) = self.buffer_range(buffer, offset, length).at(place)?;
        Ok(Held::InBuffer(buffer, range))
    }

    /// A range of a buffer, which is within it.
    pub(crate) fn buffer_range(
        &self,
        buffer: usize,
        offset: u64,
        length: u64,
    ) -> Result<(&Buffer, Range<usize>), Problem> {
        let data = self.buffers.get(buffer).ok_or(Problem::NoSuch {
            list: "buffers",
            index: buffer,
            count: self.buffers.len(),
        })?;
        if data.source == BufferSource::Placeholder {
            return Err(Problem::NoBytes);
        }
        let (start, end) = (u128::from(offset), u128::from(offset) + u128::from(length));
        if end > data.len() as u128 {
            return Err(Problem::OutOfRange {
                start,
                end,
                container: self.place("buffers", buffer),
                length: data.len() as u64,
            });
        }
        Ok((data, start as usize..end as usize))
    }

    /// Whether a range lies within a view's `length` bytes.
    pub(super) fn check_range(
        &self,
        view: usize,
        start: u128,
        end: u128,
        length: u64,
    ) -> Result<(), Problem> {
        if end <= u128::from(length) {
            return Ok(());
        }
        Err(Problem::OutOfRange {
            start,
            end,
            container: self.place("bufferViews", view),
            length,
        })
    }

    /// What `bufferViews[view]` says its length is.
    pub(super) fn view_length(&self, view: usize) -> Result<u64, Fault> {
        let json = property::entry(&self.root, "bufferViews", view)?;
        property::whole(json, "byteLength")
            .and_then(|length| length.ok_or(Problem::Missing("byteLength")))
            .at(|| self.place("bufferViews", view))
    }
}
