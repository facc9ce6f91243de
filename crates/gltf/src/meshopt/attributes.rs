//! Mode 0: elements of any kind, as deltas byte by byte.
//!
//! Version 0 (EXT and KHR) and version 1 (KHR).

use super::varint::Bytes;
use super::{ENDS_EARLY, GOES_ON, StreamError, WRONG_HEADER};

const GROUP: usize = 16;
const BLOCK_BYTES: usize = 8192;
const MOST_BLOCK_ELEMENTS: usize = 256;

/// How the deltas of a channel of four bytes add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Bytes,
    Words,
    /// Exclusive or of 32 bits, rotated left by this many bits.
    Xor(u32),
}

impl Channel {
    fn from_code(code: u8) -> Result<Self, StreamError> {
        match (code & 15, code >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Words),
            (2, turn) => Ok(Self::Xor(u32::from(turn))),
            _ => Err(StreamError("a channel of it has an unknown mode")),
        }
    }

    /// The element after `previous`.
    fn add(self, previous: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                let undo = |d: u8| (d >> 1) ^ (d & 1).wrapping_neg();
                std::array::from_fn(|k| previous[k].wrapping_add(undo(delta[k])))
            }
            Self::Words => {
                let undo = |d: u16| (d >> 1) ^ (d & 1).wrapping_neg();
                let word = |b: [u8; 4], k: usize| u16::from_le_bytes([b[k], b[k + 1]]);
                let sum = |k| word(previous, k).wrapping_add(undo(word(delta, k)));
                let ([a, b], [c, d]) = (sum(0).to_le_bytes(), sum(2).to_le_bytes());
                [a, b, c, d]
            }
            Self::Xor(turn) => {
                let delta = u32::from_le_bytes(delta).rotate_left(turn);
                (u32::from_le_bytes(previous) ^ delta).to_le_bytes()
            }
        }
    }
}

/// The bit widths that the four header codes of a group stand for.
const WIDTHS_V0: [u32; 4] = [0, 2, 4, 8];
const WIDTHS_V1: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// Reads a group of sixteen deltas of `width` bits; those with all bits set
/// are followed by a byte of their own.
fn read_group(bytes: &mut Bytes<'_>, width: u32, deltas: &mut [u8]) -> Result<(), StreamError> {
    if width == 0 {
        deltas.fill(0);
        return Ok(());
    }
    let packed = bytes.take(GROUP * width as usize / 8)?;
    if width == 8 {
        deltas.copy_from_slice(packed);
        return Ok(());
    }
    let per_byte = 8 / width as usize;
    let sentinel = (1u8 << width) - 1;
    for (k, delta) in deltas.iter_mut().enumerate() {
        let place = (k % per_byte) as u32;
        // Single bits are stored lowest first, pairs and nibbles highest first.
        let shift = if width == 1 {
            place
        } else {
            8 - width * (place + 1)
        };
        let bits = packed[k / per_byte] >> shift & sentinel;
        *delta = if bits == sentinel {
            bytes.byte()?
        } else {
            bits
        };
    }
    Ok(())
}

/// Reads the deltas of one byte position over a block.
fn read_position(
    bytes: &mut Bytes<'_>,
    control: Option<u8>,
    deltas: &mut [u8],
    elements: usize,
) -> Result<(), StreamError> {
    let widths = match control {
        None => WIDTHS_V0,
        Some(2) => {
            deltas.fill(0);
            return Ok(());
        }
        Some(3) => {
            deltas[..elements].copy_from_slice(bytes.take(elements)?);
            return Ok(());
        }
        Some(mode) => WIDTHS_V1[usize::from(mode)],
    };
    let groups = deltas.len() / GROUP;
    let header = bytes.take(groups.div_ceil(4))?;
    for (k, group) in deltas.chunks_exact_mut(GROUP).enumerate() {
        let code = header[k / 4] >> (2 * (k % 4)) & 3;
        read_group(bytes, widths[usize::from(code)], group)?;
    }
    Ok(())
}

/// The end of a stream: the element before the first, and how channels add up.
struct Tail<'a> {
    baseline: &'a [u8],
    channels: Vec<Channel>,
}

/// Splits a stream into its blocks and its tail.
fn split(source: &[u8], stride: usize) -> Result<(bool, &[u8], Tail<'_>), StreamError> {
    const LEAST_TAIL_V0: usize = 32;
    const LEAST_TAIL_V1: usize = 24;
    let (&header, rest) = source.split_first().ok_or(ENDS_EARLY)?;
    let (has_channels, tail_bytes, padded) = match header {
        0xa0 => (false, stride, stride.max(LEAST_TAIL_V0)),
        0xa1 => {
            let bytes = stride + stride / 4;
            (true, bytes, bytes.max(LEAST_TAIL_V1))
        }
        _ => return Err(WRONG_HEADER),
    };
    let blocks = rest.len().checked_sub(padded).ok_or(ENDS_EARLY)?;
    let tail = &rest[rest.len() - tail_bytes..];
    let (baseline, codes) = tail.split_at(stride);
    let channels = if has_channels {
        codes
            .iter()
            .map(|&code| Channel::from_code(code))
            .collect::<Result<_, _>>()?
    } else {
        vec![Channel::Bytes; stride / 4]
    };
    Ok((has_channels, &rest[..blocks], Tail { baseline, channels }))
}

/// `count` elements of `stride` bytes; `stride` is a multiple of 4 up to 256.
pub(super) fn decode(source: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, StreamError> {
    let (is_v1, blocks, tail) = split(source, stride)?;
    let block_elements = ((BLOCK_BYTES / stride) & !(GROUP - 1)).min(MOST_BLOCK_ELEMENTS);
    // Every block has at least this many bytes, which bounds the allocation.
    let least_block = if is_v1 { stride / 4 } else { stride };
    if blocks.len() / least_block < count.div_ceil(block_elements) {
        return Err(ENDS_EARLY);
    }
    let mut bytes = Bytes::new(blocks);
    let mut previous = tail.baseline.to_vec();
    let mut out = vec![0; count * stride];
    let mut deltas = vec![0; stride * block_elements];
    for block in out.chunks_mut(block_elements * stride) {
        let elements = block.len() / stride;
        let padded = elements.next_multiple_of(GROUP);
        let controls = if is_v1 {
            Some(bytes.take(stride / 4)?)
        } else {
            None
        };
        for (k, deltas) in deltas.chunks_exact_mut(block_elements).enumerate() {
            let control = controls.map(|c| c[k / 4] >> (2 * (k % 4)) & 3);
            read_position(&mut bytes, control, &mut deltas[..padded], elements)?;
        }
        for (e, element) in block.chunks_exact_mut(stride).enumerate() {
            for (c, channel) in tail.channels.iter().enumerate() {
                let at = 4 * c;
                let delta = std::array::from_fn(|k| deltas[(at + k) * block_elements + e]);
                let before = std::array::from_fn(|k| previous[at + k]);
                element[at..at + 4].copy_from_slice(&channel.add(before, delta));
            }
            previous.copy_from_slice(element);
        }
    }
    if bytes.is_empty() {
        Ok(out)
    } else {
        Err(GOES_ON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_specification() {
        let packed = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let mut bytes = Bytes::new(&packed);
        let mut deltas = [0; GROUP];
        read_group(&mut bytes, 4, &mut deltas).unwrap();
        assert!(bytes.is_empty());
        let undone = deltas.map(|d| Channel::Bytes.add([0; 4], [d; 4])[0] as i8);
        let expected = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
        assert_eq!(undone, expected);
    }

    #[test]
    fn zero_deltas_repeat_the_baseline() {
        // Two elements of four bytes: a header byte of zero for each byte
        // position, then the tail of 32 bytes with the baseline last.
        let mut source = vec![0xa0, 0, 0, 0, 0];
        source.extend([0; 28]);
        source.extend([1, 2, 3, 4]);
        assert_eq!(decode(&source, 2, 4).unwrap(), [1, 2, 3, 4, 1, 2, 3, 4]);
        assert_eq!(decode(&source[..36], 2, 4), Err(ENDS_EARLY));
        source.insert(5, 0);
        assert_eq!(decode(&source, 2, 4), Err(GOES_ON));
    }

    #[test]
    fn a_huge_count_is_refused_before_memory_is_asked_for() {
        let mut source = vec![0xa0; 100];
        source[1..].fill(0);
        assert_eq!(decode(&source, usize::MAX / 512, 256), Err(ENDS_EARLY));
    }

    #[test]
    fn channels_wrap_around() {
        // 0xffff + 1 wraps in words; bytes 0xff + 1 wrap each.
        let words = Channel::Words.add([0xff, 0xff, 1, 0], [2, 0, 1, 0]);
        assert_eq!(words, [0, 0, 0, 0]);
        assert_eq!(Channel::Bytes.add([0xff; 4], [2; 4]), [0; 4]);
        // One bit turned left by eight lands in the second byte.
        assert_eq!(Channel::Xor(8).add([0; 4], [1, 0, 0, 0]), [0, 1, 0, 0]);
        assert!(Channel::from_code(0x11).is_err());
        assert!(Channel::from_code(3).is_err());
    }
}
