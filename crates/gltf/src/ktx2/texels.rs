//! The texels of KTX2 images as plain pixels.
//!
//! The crate `basisu` also makes blocks for every kind of GPU. Its converter is not called, so that the tables of those
//! formats, a megabyte with their code, stay out of programs.

use basisu::basislz::etc1s::Etc1sTranscoder;
use basisu::ktx2::{BasisFormat, Ktx2Header};
use basisu::uastc::unpack::unpack_uastc;
use image::RgbaImage;
use ruzstd::StreamingDecoder;
use ruzstd::io::Read;

use super::{BLOCK_BYTES, ZSTANDARD, number};

/// The pixels of the largest level of an image; none if its data is damaged.
pub(super) fn pixels(bytes: &[u8]) -> Option<RgbaImage> {
    let header = Ktx2Header::parse(bytes)?;
    match header.format {
        BasisFormat::Etc1s => etc1s(bytes, &header),
        BasisFormat::Uastc => uastc(bytes, &header),
        _ => None,
    }
}

/// So many bytes from here on.
fn part(bytes: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

/// Endpoints and selectors that all images of the file share, and for each image where its slices are.
fn etc1s(bytes: &[u8], header: &Ktx2Header) -> Option<RgbaImage> {
    let shared = part(bytes, header.sgd_byte_offset, header.sgd_byte_length)?;
    let word = |at: usize| number(shared, at, 4);
    let images = header.levels.len() as u64
        * u64::from(header.layer_count.max(1))
        * u64::from(header.face_count.max(1));
    let [endpoints, selectors, tables] = [word(4)?, word(8)?, word(12)?];
    let start = 20 + 20 * images;
    let mut decoder = Etc1sTranscoder::new();
    let has_palettes = decoder.decode_palettes(
        number(shared, 0, 2)? as u32,
        part(shared, start, endpoints)?,
        number(shared, 2, 2)? as u32,
        part(shared, start + endpoints, selectors)?,
    );
    let tables = part(shared, start + endpoints + selectors, tables)?;
    if !has_palettes || !decoder.decode_tables(tables) {
        return None;
    }
    let level = header.levels.first()?.byte_offset;
    let slice = |at| part(bytes, level.checked_add(word(at)?)?, word(at + 4)?);
    let color = slice(24)?;
    let [wide, high] = [header.width, header.height].map(|texels| texels.div_ceil(4));
    let mut image = RgbaImage::new(header.width, header.height);
    match header.has_alpha {
        true => decoder.transcode_image_rgba32(
            color,
            slice(32)?,
            wide,
            high,
            header.width,
            header.height,
            None,
            &mut image,
        ),
        false => decoder.transcode_slice_rgba32(
            color,
            wide,
            high,
            header.width,
            header.height,
            None,
            &mut image,
        ),
    }?;
    Some(image)
}

/// Blocks of 4 x 4 texels, row by row.
fn uastc(bytes: &[u8], header: &Ktx2Header) -> Option<RgbaImage> {
    let level = header.levels.first()?;
    let stored = part(bytes, level.byte_offset, level.byte_length)?;
    let inflated;
    let blocks = match header.supercompression {
        0 => stored,
        ZSTANDARD => {
            inflated = inflated_to(stored, level.uncompressed_byte_length)?;
            &inflated
        }
        _ => return None,
    };
    let [wide, high] = [header.width, header.height].map(|texels| texels.div_ceil(4));
    let blocks = part(blocks, 0, u64::from(wide) * u64::from(high) * BLOCK_BYTES)?;
    let mut image = RgbaImage::new(header.width, header.height);
    for (block, number) in blocks.as_chunks().0.iter().zip(0..) {
        let texels = unpack_uastc(block, false)?;
        let [left, top] = [number % wide * 4, number / wide * 4];
        for (texel, k) in texels.iter().zip(0..) {
            if let Some(pixel) = image.get_pixel_mut_checked(left + k % 4, top + k / 4) {
                pixel.0 = [texel.r(), texel.g(), texel.b(), texel.a()];
            }
        }
    }
    Some(image)
}

/// What a Zstandard frame holds; none unless that is exactly `length` bytes.
fn inflated_to(frame: &[u8], length: u64) -> Option<Vec<u8>> {
    let mut decoder = StreamingDecoder::new(frame).ok()?;
    let mut bytes = vec![0; usize::try_from(length).ok()?];
    decoder.read_exact(&mut bytes).ok()?;
    (decoder.read(&mut [0]).ok()? == 0).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use basisu::{DecodeFlags, TargetFormat, Transcoder};

    use super::*;

    const IMAGES: [&[u8]; 3] = [
        include_bytes!("../../tests/data/half_etc1s.ktx2"),
        include_bytes!("../../tests/data/half_uastc.ktx2"),
        include_bytes!("../../tests/data/half_uastc_zstd.ktx2"),
    ];

    /// The pixels that the crate's own converter makes.
    fn converted(bytes: &[u8]) -> Option<Vec<u8>> {
        let transcoder = Transcoder::new(bytes).ok()?;
        let texels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
        texels.ok()
    }

    fn unless_it_panics<T>(decode: impl FnOnce() -> Option<T>) -> Option<T> {
        catch_unwind(AssertUnwindSafe(decode)).ok().flatten()
    }

    /// Whole images, and those of which one byte of what is compressed is another.
    #[test]
    fn pixels_are_those_of_the_crates_own_converter() {
        for image in IMAGES {
            let whole = pixels(image).map(RgbaImage::into_raw);
            assert!(whole.is_some());
            assert_eq!(whole, converted(image));
            let header = Ktx2Header::parse(image).unwrap();
            let level = header.levels[0];
            for (start, length) in [
                (header.sgd_byte_offset, header.sgd_byte_length),
                (level.byte_offset, level.byte_length),
            ] {
                for at in start..start + length {
                    let mut changed = image.to_vec();
                    changed[at as usize] ^= 0x55;
                    let own = unless_it_panics(|| pixels(&changed)).map(RgbaImage::into_raw);
                    assert_eq!(own, unless_it_panics(|| converted(&changed)), "byte {at}");
                }
            }
        }
    }
}
