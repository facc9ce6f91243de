//! The encoder, in C++.

use std::sync::Mutex;

use basis_universal::encoding::{ColorSpace, Compressor, CompressorParams};
use basis_universal::{BasisTextureFormat, ETC1S_QUALITY_MAX};
use image::RgbaImage;

use crate::basis::Basis;
use crate::file;
use crate::mips::mip_levels;

/// The largest side of an image in texels: that of the format of the encoder.
const LARGEST_SIDE: u32 = 1 << 14;

/// The encoder makes its tables when it is first asked, and takes no care that it is asked once.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// An image of sRGB colours as a KTX2 file: ETC1S texels at the encoder's best quality, with alpha where some texel is
/// not opaque, and all mip levels. The same image gives the same bytes.
///
/// Nothing for an image that `KHR_texture_basisu` does not allow, whose sides are no multiples of four texels, for one of
/// more than 16,384 texels a side, and where the encoder fails.
pub fn etc1s(image: &RgbaImage) -> Option<Vec<u8>> {
    let sides = [image.width(), image.height()];
    if !sides
        .iter()
        .all(|side| (4..=LARGEST_SIDE).contains(side) && side.is_multiple_of(4))
    {
        return None;
    }
    let levels = mip_levels(image);
    let basis = compressed(&levels)?;
    file::of(&Basis::read(&basis)?, sides, levels.len())
}

/// The levels of an image as a file of the encoder's own kind.
fn compressed(levels: &[RgbaImage]) -> Option<Vec<u8>> {
    let mut params = CompressorParams::new();
    params.set_basis_format(BasisTextureFormat::ETC1S);
    params.set_etc1s_quality_level(ETC1S_QUALITY_MAX);
    params.set_color_space(ColorSpace::Srgb);
    params.set_generate_mipmaps(false);
    for (level, image) in levels.iter().enumerate() {
        let mut place = match level {
            0 => params.source_image_mut(0),
            _ => params.source_mipmap_image_mut(0, level as u32 - 1),
        };
        place.init(image.as_raw(), image.width(), image.height(), 4);
    }
    let _alone = ONE_AT_A_TIME
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    let mut compressor = Compressor::new(1);
    // SAFETY: the images are whole and within the encoder's limits, and all else is as it is by default.
    let processed = unsafe { compressor.init(&params) && compressor.process().is_ok() };
    processed.then(|| compressor.basis_file().to_vec())
}

#[cfg(test)]
mod tests {
    use basisu::{DecodeFlags, TargetFormat, Transcoder};

    use super::*;

    /// A leaf: a disc of greens on nothing.
    fn leaf(width: u32, height: u32, clear: u8) -> RgbaImage {
        RgbaImage::from_fn(width, height, |x, y| {
            let [x, y] =
                [(x, width), (y, height)].map(|(at, of)| 2.0 * (at as f32 + 0.5) / of as f32 - 1.0);
            let alpha = if x * x + y * y < 0.8 { 255 } else { clear };
            image::Rgba([40, (120.0 + 60.0 * x) as u8, (30.0 + 20.0 * y) as u8, alpha])
        })
    }

    /// A level of a file as another decoder reads it.
    fn decoded(file: &[u8], level: u32) -> Vec<u8> {
        let reader = Transcoder::new(file).unwrap();
        reader
            .transcode(level, TargetFormat::Rgba32, DecodeFlags::NONE)
            .unwrap()
    }

    fn mean_difference(a: &[u8], b: &[u8], channels: std::ops::Range<usize>) -> f64 {
        let texels = a.chunks(4).zip(b.chunks(4));
        let of_texel = |(a, b): (&[u8], &[u8])| {
            let all = a[channels.clone()].iter().zip(&b[channels.clone()]);
            all.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>()
        };
        texels.map(of_texel).sum::<f64>() / (a.len() / 4 * channels.len()) as f64
    }

    #[test]
    fn another_decoder_reads_all_levels() {
        for clear in [0, 255] {
            let image = leaf(64, 32, clear);
            let file = etc1s(&image).unwrap();
            assert_eq!(file, etc1s(&image).unwrap());
            assert!(file.len() < image.len() / 4, "{}", file.len());
            let reader = Transcoder::new(&file).unwrap();
            assert_eq!(reader.level_count(), 7);
            for (level, image) in mip_levels(&image).iter().enumerate() {
                let texels = decoded(&file, level as u32);
                assert_eq!(texels.len(), image.as_raw().len());
                // Of the smallest levels a block holds all, in two colours and what lies between them.
                if image.height() >= 8 {
                    assert!(mean_difference(&texels, image, 0..3) < 6.0);
                    assert!(mean_difference(&texels, image, 3..4) < 5.0);
                }
            }
        }
    }

    #[test]
    fn sides_are_multiples_of_four() {
        for size in [(6, 8), (8, 2), (0, 0), (LARGEST_SIDE + 4, 4)] {
            assert_eq!(etc1s(&RgbaImage::new(size.0, size.1)), None, "{size:?}");
        }
    }
}
