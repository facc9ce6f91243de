//! Buffer views: ranges of buffers.

use super::Document;
use super::buffer::BufferSource;
use super::error::{At, Fault, Problem};
use super::property;

impl Document {
    /// The bytes of `bufferViews[index]`, decompressed.
    pub(crate) fn view_bytes(&self, index: usize) -> Result<&[u8], Fault> {
        let json = property::entry(&self.root, "bufferViews", index)?;
        let place = || self.place("bufferViews", index);
        if let Some(bytes) = self.decompressed(index, json)? {
            return Ok(bytes);
        }
        let buffer = property::required_index(json, "buffer").at(place)?;
        let offset = property::whole(json, "byteOffset").at(place)?.unwrap_or(0);
        let length = self.view_length(index)?;
        self.buffer_range(buffer, offset, length).at(place)
    }

    /// A range of a buffer's bytes.
    pub(crate) fn buffer_range(
        &self,
        buffer: usize,
        offset: u64,
        length: u64,
    ) -> Result<&[u8], Problem> {
        let data = self.buffers.get(buffer).ok_or(Problem::NoSuch {
            list: "buffers",
            index: buffer,
            count: self.buffers.len(),
        })?;
        if data.source == BufferSource::Placeholder {
            return Err(Problem::NoBytes);
        }
        let (start, end) = (u128::from(offset), u128::from(offset) + u128::from(length));
        if end > data.bytes().len() as u128 {
            return Err(Problem::OutOfRange {
                start,
                end,
                container: self.place("buffers", buffer),
                length: data.bytes().len() as u64,
            });
        }
        Ok(&data.bytes()[start as usize..end as usize])
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
