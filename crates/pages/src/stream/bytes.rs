//! Numbers in a body, and bodies packed.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::MOST_UNPACKED;

pub(super) fn push_words(bytes: &mut Vec<u8>, words: impl IntoIterator<Item = u32>) {
    bytes.extend(words.into_iter().flat_map(u32::to_le_bytes));
}

pub(super) fn push_floats(bytes: &mut Vec<u8>, floats: impl IntoIterator<Item = f32>) {
    bytes.extend(floats.into_iter().flat_map(f32::to_le_bytes));
}

pub(super) fn push_shorts(bytes: &mut Vec<u8>, shorts: impl IntoIterator<Item = u16>) {
    bytes.extend(shorts.into_iter().flat_map(u16::to_le_bytes));
}

/// Fills up to whole words.
pub(super) fn align(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

/// A body in zlib's form; where it would get too small to be read, as it is within that form.
pub(super) fn packed(body: &[u8]) -> Vec<u8> {
    let by = |level| {
        let mut encoder = ZlibEncoder::new(Vec::new(), level);
        encoder
            .write_all(body)
            .and_then(|()| encoder.finish())
            .expect("a vector takes all that is written")
    };
    let small = by(Compression::best());
    match body.len() as u64 <= MOST_UNPACKED * small.len() as u64 {
        true => small,
        false => by(Compression::none()),
    }
}

/// A body of this number of bytes, or nothing where there is none. Takes no more memory than that, and
/// no more than the limit times what it is packed in.
pub(super) fn unpacked(packed: &[u8], bytes: u32) -> Option<Vec<u8>> {
    if u64::from(bytes) > MOST_UNPACKED * packed.len() as u64 {
        return None;
    }
    let mut body = Vec::new();
    let mut decoder = ZlibDecoder::new(packed).take(u64::from(bytes) + 1);
    decoder.read_to_end(&mut body).ok()?;
    (body.len() == bytes as usize).then_some(body)
}

/// Reads numbers one after another; nothing beyond the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
}

impl<'a> Numbers<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    pub(super) fn word(&mut self) -> Option<u32> {
        Some(self.words(1)?[0])
    }

    pub(super) fn words(&mut self, count: usize) -> Option<Vec<u32>> {
        let bytes = self.take(count.checked_mul(4)?)?;
        let words = bytes.as_chunks().0.iter();
        Some(words.map(|word| u32::from_le_bytes(*word)).collect())
    }

    /// The next numbers; none if the bytes end before, or one is not finite.
    pub(super) fn floats(&mut self, count: usize) -> Option<Vec<f32>> {
        let floats: Vec<f32> = self.words(count)?.into_iter().map(f32::from_bits).collect();
        floats.iter().all(|x| x.is_finite()).then_some(floats)
    }

    pub(super) fn shorts(&mut self, count: usize) -> Option<Vec<u16>> {
        let bytes = self.take(count.checked_mul(2)?)?;
        let shorts = bytes.as_chunks().0.iter();
        Some(shorts.map(|short| u16::from_le_bytes(*short)).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}
