//! What the encoder's own file holds: format `.basis`, version 0x13, of one image.

use std::ops::Range;

/// The parts of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Basis<'a> {
    /// How many endpoints and selectors the palettes have.
    pub(crate) counts: [u16; 2],
    pub(crate) endpoints: &'a [u8],
    pub(crate) selectors: &'a [u8],
    /// Huffman tables of the slices.
    pub(crate) tables: &'a [u8],
    pub(crate) has_alpha: bool,
    /// Of each mip level, the largest first: its colours, and its alpha or nothing.
    pub(crate) levels: Vec<[&'a [u8]; 2]>,
}

/// Bytes of a slice's description.
const DESCRIPTION_BYTES: usize = 23;

/// The flag of a file, of some slices with alpha.
const FILE_HAS_ALPHA: u64 = 4;

/// The flag of a slice, of alpha in place of colours.
const SLICE_IS_ALPHA: u64 = 1;

impl<'a> Basis<'a> {
    /// The parts of a file; nothing if it is none of one image.
    pub(crate) fn read(bytes: &'a [u8]) -> Option<Self> {
        let number = |at, count| number(bytes, at, count);
        let part = |start: Range<usize>, length: Range<usize>| {
            let start = number(start.start, start.len())? as usize;
            bytes.get(start..start.checked_add(number(length.start, length.len())? as usize)?)
        };
        if bytes.get(..2)? != b"sB" || number(17, 3)? != 1 {
            return None;
        }
        let descriptions = number(65, 4)? as usize;
        let mut levels: Vec<[&[u8]; 2]> = Vec::new();
        for slice in 0..number(14, 3)? as usize {
            let at = descriptions + slice * DESCRIPTION_BYTES;
            let level = number(at + 3, 1)? as usize;
            let is_alpha = number(at + 4, 1)? & SLICE_IS_ALPHA != 0;
            if level >= levels.len() {
                levels.resize(level + 1, [&[]; 2]);
            }
            levels[level][usize::from(is_alpha)] = part(at + 13..at + 17, at + 17..at + 21)?;
        }
        Some(Self {
            counts: [number(39, 2)? as u16, number(48, 2)? as u16],
            endpoints: part(41..45, 45..48)?,
            selectors: part(50..54, 54..57)?,
            tables: part(57..61, 61..65)?,
            has_alpha: number(21, 2)? & FILE_HAS_ALPHA != 0,
            levels,
        })
    }
}

/// The little-endian number of up to eight bytes from here on.
fn number(bytes: &[u8], at: usize, count: usize) -> Option<u64> {
    let part = bytes.get(at..at.checked_add(count)?)?;
    Some(
        part.iter()
            .rev()
            .fold(0, |number, byte| number << 8 | u64::from(*byte)),
    )
}
