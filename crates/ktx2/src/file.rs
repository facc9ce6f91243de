//! A KTX2 file (Khronos, KTX File Format 2.0) with BasisLZ, of one image of sRGB colours.

use crate::basis::Basis;

const MAGIC: &[u8; 12] = b"\xabKTX 20\xbb\r\n\x1a\n";
const HEADER_BYTES: usize = 80;
const LEVEL_BYTES: usize = 24;

/// BasisLZ, as the scheme of supercompression.
const BASIS_LZ: u32 = 1;

/// What programs ask for where a file says who wrote it.
const WRITER: &[u8] = b"KTXwriter\0secateur\0";

/// Of a data format descriptor (Khronos, Data Format 1.3): ETC1S, BT.709 primaries, the transfer of sRGB, blocks of 4 x 4.
const MODEL: [u8; 8] = [163, 1, 2, 0, 3, 3, 0, 0];

/// The channels of a slice: colours, and alpha.
const CHANNELS: [u8; 2] = [0, 15];

/// The KTX2 file of what an encoder made; `size` is width and height of the largest level in texels. Nothing where the
/// encoder made another number of levels than `level_count`, or the file would take 4 GiB.
pub(crate) fn of(basis: &Basis<'_>, size: [u32; 2], level_count: usize) -> Option<Vec<u8>> {
    if basis.levels.len() != level_count {
        return None;
    }
    let descriptor = descriptor(basis.has_alpha);
    let metadata = entry(WRITER);
    let shared = shared(basis)?;
    let descriptor_at = HEADER_BYTES + LEVEL_BYTES * level_count;
    let metadata_at = descriptor_at + descriptor.len();
    let shared_at = (metadata_at + metadata.len()).next_multiple_of(8);

    let mut file = MAGIC.to_vec();
    let words = |file: &mut Vec<u8>, words: &[u32]| {
        words
            .iter()
            .for_each(|word| file.extend(word.to_le_bytes()))
    };
    // No format of Vulkan, texels of a byte, no depth, layers; one face.
    words(
        &mut file,
        &[
            0,
            1,
            size[0],
            size[1],
            0,
            0,
            1,
            level_count as u32,
            BASIS_LZ,
        ],
    );
    for (at, part) in [(descriptor_at, &descriptor), (metadata_at, &metadata)] {
        words(&mut file, &[at as u32, part.len() as u32]);
    }
    for number in [shared_at, shared.len()] {
        file.extend((number as u64).to_le_bytes());
    }
    // The smallest level comes first, so that a client can show it while the rest arrives.
    let lengths = basis.levels.iter().map(|slices| slices.concat().len());
    let lengths: Vec<usize> = lengths.collect();
    for (level, length) in lengths.iter().enumerate() {
        let smaller: usize = lengths[level + 1..].iter().sum();
        for number in [shared_at + shared.len() + smaller, *length, 0] {
            file.extend((number as u64).to_le_bytes());
        }
    }
    file.extend(descriptor);
    file.extend(metadata);
    file.resize(shared_at, 0);
    file.extend(shared);
    file.extend(basis.levels.iter().rev().flatten().copied().flatten());
    u32::try_from(file.len()).is_ok().then_some(file)
}

/// What a decoder must know of the texels.
fn descriptor(has_alpha: bool) -> Vec<u8> {
    let channels = &CHANNELS[..if has_alpha { 2 } else { 1 }];
    let block_bytes = 24 + 16 * channels.len() as u32;
    let mut bytes = (block_bytes + 4).to_le_bytes().to_vec();
    bytes.extend([0, 0, 0, 0, 2, 0]);
    bytes.extend((block_bytes as u16).to_le_bytes());
    bytes.extend(MODEL);
    // No bytes in planes, as they are compressed further.
    bytes.extend([0; 8]);
    for (number, channel) in channels.iter().enumerate() {
        // Half a block of 128 bits each, as the format counts it; values from 0 to all bits set.
        bytes.extend((64 * number as u16).to_le_bytes());
        bytes.extend([63, *channel]);
        bytes.extend([0; 8]);
        bytes.extend([0xff; 4]);
    }
    bytes
}

/// A key with its value, and the length before them.
fn entry(text: &[u8]) -> Vec<u8> {
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// What all levels share: how long the palettes and each level's slices are, then the palettes and tables.
fn shared(basis: &Basis<'_>) -> Option<Vec<u8>> {
    let parts = [basis.endpoints, basis.selectors, basis.tables];
    let mut lengths: Vec<usize> = parts.map(<[u8]>::len).to_vec();
    // No bytes of extensions.
    lengths.push(0);
    for [colors, alpha] in &basis.levels {
        let alpha_at = if basis.has_alpha { colors.len() } else { 0 };
        lengths.extend([0, 0, colors.len(), alpha_at, alpha.len()]);
    }
    let counts = basis.counts.iter().flat_map(|count| count.to_le_bytes());
    let mut bytes: Vec<u8> = counts.collect();
    for length in lengths {
        bytes.extend(u32::try_from(length).ok()?.to_le_bytes());
    }
    bytes.extend(parts.concat());
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which numbers the format has for ETC1S: its colours first, then alpha in the other half of a block.
    #[test]
    fn a_descriptor_names_its_channels() {
        for (has_alpha, bytes) in [(false, 44), (true, 60)] {
            let descriptor = descriptor(has_alpha);
            assert_eq!(descriptor.len(), bytes);
            assert_eq!(descriptor[..4], (bytes as u32).to_le_bytes());
            let samples: Vec<&[u8]> = descriptor[28..].chunks(16).collect();
            assert_eq!(samples[0][..4], [0, 0, 63, 0]);
            assert!(
                samples[1..]
                    .iter()
                    .all(|sample| sample[..4] == [64, 0, 63, 15])
            );
        }
    }
}
