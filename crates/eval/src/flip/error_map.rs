//! FLIP as a picture: where two pictures differ.

use image::{Rgb, RgbImage, RgbaImage};

use super::FlipPicture;

/// The magma colour map (van der Walt and Smith, matplotlib, CC0) at eighths of its range, sRGB.
const MAGMA: [[u8; 3]; 9] = [
    [0x00, 0x00, 0x04],
    [0x1d, 0x11, 0x47],
    [0x51, 0x12, 0x7c],
    [0x82, 0x26, 0x81],
    [0xb6, 0x36, 0x79],
    [0xe6, 0x51, 0x64],
    [0xfb, 0x88, 0x61],
    [0xfe, 0xc2, 0x87],
    [0xfc, 0xfd, 0xbf],
];

/// The FLIP error of every pixel on the magma colour map, from black (none) through purple and orange to pale
/// yellow (1).
///
/// # Panics
/// If the sizes differ.
pub(crate) fn error_map(original: &RgbaImage, other: &RgbaImage) -> RgbImage {
    let (width, height) = original.dimensions();
    let [a, b] = [original, other].map(FlipPicture::of);
    let bytes: Vec<u8> = a
        .errors(&b)
        .into_iter()
        .flat_map(|error| magma(error).0)
        .collect();
    RgbImage::from_raw(width, height, bytes).expect("three bytes a pixel")
}

/// The colour of an error of 0 to 1.
fn magma(error: f32) -> Rgb<u8> {
    let steps = MAGMA.len() - 1;
    let at = error.clamp(0.0, 1.0) * steps as f32;
    let low = (at as usize).min(steps - 1);
    let share = at - low as f32;
    let between = |channel: usize| {
        let [a, b] = [MAGMA[low], MAGMA[low + 1]].map(|color| f32::from(color[channel]));
        (a + (b - a) * share).round() as u8
    };
    Rgb([between(0), between(1), between(2)])
}
