//! Mode 2: any sequence of indices, as deltas against one of two baselines.

use super::varint::Bytes;
use super::{ENDS_EARLY, GOES_ON, StreamError, WRONG_HEADER};

const HEADER: u8 = 0xd1;
const TAIL_BYTES: usize = 4;

/// Decodes a stream of `count` indices in any order.
pub(super) fn decode(source: &[u8], count: usize) -> Result<Vec<u32>, StreamError> {
    let (&header, rest) = source.split_first().ok_or(ENDS_EARLY)?;
    if header != HEADER {
        return Err(WRONG_HEADER);
    }
    let data = rest.len().checked_sub(TAIL_BYTES).ok_or(ENDS_EARLY)?;
    // At least a byte for each index: also the bound of the allocation.
    if data < count {
        return Err(ENDS_EARLY);
    }
    let mut bytes = Bytes::new(&rest[..data]);
    let mut last = [0u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let code = bytes.varint()?;
        let baseline = &mut last[(code & 1) as usize];
        let magnitude = code >> 2;
        let delta = if code & 2 == 0 { magnitude } else { !magnitude };
        *baseline = baseline.wrapping_add(delta);
        indices.push(*baseline);
    }
    if bytes.is_empty() {
        Ok(indices)
    } else {
        Err(GOES_ON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_runs_spliced_together() {
        // Baseline 0: +5, +1, -2; baseline 1: +100, -1. A code is the
        // zigzagged delta times two plus the baseline; -2 zigzags to 3.
        let codes = [20, 4 * 100 + 1, 4, 3, 6];
        let mut source = vec![HEADER];
        for code in codes {
            let code: u32 = code;
            if code < 128 {
                source.push(code as u8);
            } else {
                source.extend([code as u8 | 0x80, (code >> 7) as u8]);
            }
        }
        source.extend([0; TAIL_BYTES]);
        assert_eq!(decode(&source, 5).unwrap(), [5, 100, 6, 99, 4]);
        assert_eq!(decode(&source, 4), Err(GOES_ON));
        assert_eq!(decode(&source, 6), Err(ENDS_EARLY));
    }
}
