//! KTX2 images with Basis Universal texels, which KHR_texture_basisu asks for.
//!
//! The texels are decoded by the crate `basisu`. What it allocates follows from the header, which is
//! checked here first; where it panics all the same, the image counts as one that can't be decoded.

mod texels;

use std::panic::{AssertUnwindSafe, catch_unwind};

use image::RgbaImage;

const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Zstandard, as the header's supercompression scheme.
const ZSTANDARD: u32 = 2;

/// A window of this many bytes is never refused, however small the image.
const SMALLEST_WINDOW_LIMIT: u64 = 1 << 20;

/// The two colour models of Basis Universal that KHR_texture_basisu allows.
const ETC1S: u8 = 163;
const UASTC: u8 = 166;

/// Bytes of a block of 4 x 4 texels in UASTC, the only format that Zstandard compresses here.
const BLOCK_BYTES: u64 = 16;

/// The command that makes all KTX2 images of a file PNG.
const CONVERT: &str = "convert it with `npx @gltf-transform/cli ktxdecompress IN.glb OUT.glb`";

/// Whether these bytes begin as a KTX2 file.
pub(crate) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Width and height of an image, which its header says.
///
/// # Errors
/// A sentence if the header is damaged or is one of something other than a plain image.
pub(crate) fn dimensions(bytes: &[u8]) -> Result<[u32; 2], String> {
    let header = Header::read(bytes).ok_or("its KTX2 header is damaged")?;
    if !header.is_plain {
        return Err("its KTX2 file holds no single plain image".to_owned());
    }
    if ![ETC1S, UASTC].contains(&header.model) {
        return Err(format!(
            "its KTX2 texels are neither ETC1S nor UASTC; {CONVERT}"
        ));
    }
    match header.is_compressed_within_reason() && metadata_is_sound(bytes).is_some() {
        true => Ok(header.size),
        false => Err("its KTX2 data is damaged".to_owned()),
    }
}

/// The pixels of the largest level of an image whose [`dimensions`] are good.
///
/// # Errors
/// A sentence if it can't be decoded.
pub(crate) fn decode(bytes: &[u8]) -> Result<RgbaImage, String> {
    // The decoder is no code of ours, and hostile files must not end the program.
    let decoded = catch_unwind(AssertUnwindSafe(|| texels::pixels(bytes)));
    let damaged = || "its KTX2 image cannot be decoded, its data is damaged".to_owned();
    decoded.ok().flatten().ok_or_else(damaged)
}

/// What of a KTX2 header decides how much is decoded.
struct Header<'a> {
    /// Width and height in texels.
    size: [u32; 2],
    /// Whether it is one image, no array, cube or volume.
    is_plain: bool,
    /// The colour model of its data format descriptor.
    model: u8,
    /// How its levels are compressed.
    scheme: u32,
    /// The bytes of its largest level.
    level: &'a [u8],
    /// How many bytes these are without compression.
    level_bytes: u64,
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Option<Self> {
        let word = |at| Some(number(bytes, at, 4)? as u32);
        let [depth, layers, faces] = [word(28)?, word(32)?, word(36)?];
        let model_at = (word(48)? as usize).checked_add(12)?;
        let start = usize::try_from(number(bytes, 80, 8)?).ok()?;
        let length = usize::try_from(number(bytes, 88, 8)?).ok()?;
        Some(Self {
            size: [word(20)?, word(24)?],
            is_plain: depth == 0 && layers <= 1 && faces == 1,
            model: *bytes.get(model_at)?,
            scheme: word(44)?,
            level: bytes.get(start..start.checked_add(length)?)?,
            level_bytes: number(bytes, 96, 8)?,
        })
    }

    /// Whether a level that Zstandard compresses is as long as its texels ask for, and asks for no
    /// much larger window to decompress it in.
    fn is_compressed_within_reason(&self) -> bool {
        if self.scheme != ZSTANDARD {
            return true;
        }
        let [wide, high] = self.size.map(|texels| u64::from(texels.div_ceil(4)));
        let needed = wide.saturating_mul(high).saturating_mul(BLOCK_BYTES);
        let allowed = needed.saturating_mul(2).max(SMALLEST_WINDOW_LIMIT);
        self.level_bytes == needed && zstandard_window(self.level).is_some_and(|w| w <= allowed)
    }
}

/// Whether the entries of key and value data end where their list does: the decoder trusts that.
fn metadata_is_sound(bytes: &[u8]) -> Option<()> {
    let start = number(bytes, 56, 4)? as usize;
    let end = start.checked_add(number(bytes, 60, 4)? as usize)?;
    let mut at = start;
    while at < end {
        let length = number(bytes, at, 4)? as usize;
        at = at.checked_add(4)?.checked_add(length)?.next_multiple_of(4);
    }
    (start == end || at == end && end <= bytes.len()).then_some(())
}

/// The bytes of the window that a Zstandard frame asks for (RFC 8878, 3.1.1.1).
fn zstandard_window(frame: &[u8]) -> Option<u64> {
    let descriptor = *frame.get(4)?;
    let is_single_segment = descriptor & 0x20 != 0;
    if !is_single_segment {
        let window = *frame.get(5)?;
        let base = 1u64 << (10 + (window >> 3));
        return Some(base + base / 8 * u64::from(window & 7));
    }
    let dictionary_bytes = [0, 1, 2, 4][usize::from(descriptor & 3)];
    let size_bytes = [1, 2, 4, 8][usize::from(descriptor >> 6)];
    let size = number(frame, 5 + dictionary_bytes, size_bytes)?;
    Some(size.saturating_add(if size_bytes == 2 { 256 } else { 0 }))
}

/// The little-endian number of up to eight bytes from here on.
fn number(bytes: &[u8], at: usize, count: usize) -> Option<u64> {
    let part = bytes.get(at..at.checked_add(count)?)?;
    let bytes = part.iter().rev();
    Some(bytes.fold(0, |number, byte| number << 8 | u64::from(*byte)))
}
