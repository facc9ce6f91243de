//! FLIP (Andersson et al., FLIP: A Difference Evaluator for Alternating Images, HPG 2020) of pictures
//! that are compared more than once.
//!
//! Most of FLIP is done to each picture by itself: it is filtered as an eye does at a distance, its
//! colours become those of a uniform space, and its edges and points are found. Here that is done once
//! a picture. All filters are sums of products of a filter along rows and one along columns, and
//! borders are repeated outwards. The reference implementation (`nv-flip`), which does all of it for
//! each pair, is the judge of the tests.

mod color;
mod cut_out;
mod error_map;
mod filters;

use image::RgbaImage;

pub(crate) use color::chroma;
use color::{ColorScale, Colors, HypotOf, power};
pub(crate) use cut_out::{CutOutFlip, FilteredCutOut};
pub(crate) use error_map::error_map;
pub(crate) use filters::reach_px;
use filters::{Grid, LIGHTNESS_WIDTH, RED_GREEN_WIDTH, blue_yellow, features, gaussian};

/// Pixels a degree of the viewer's sight, the default of the reference implementation: a screen .7 m wide with 3,840
/// pixels, seen from .7 m.
pub(crate) const PIXELS_PER_DEGREE: f32 = 67.0;

/// A picture as FLIP sees it, row by row.
#[derive(Clone, Debug)]
pub(crate) struct FlipPicture {
    size: [u32; 2],
    pixels: Vec<FlipPixel>,
}

impl FlipPicture {
    /// Of a picture without transparency, at the usual 67 pixels a degree.
    pub(crate) fn of(image: &RgbaImage) -> Self {
        let grid = Grid::whole(image.width() as usize, image.height() as usize);
        let colors = Colors::new();
        let [mut y, mut cx, mut cz] = colors.opponent(image);
        let mut grey = y.clone();
        for value in &mut grey {
            *value = (*value + 16.0) / 116.0;
        }
        let (edges, points) = features(&grid, &grey);
        y = grid.filtered(&y, &gaussian(LIGHTNESS_WIDTH));
        cx = grid.filtered(&cx, &gaussian(RED_GREEN_WIDTH));
        cz = blue_yellow(&grid, &cz);
        let pixel = |k: usize| FlipPixel {
            lab: colors.hunt_lab(colors.rgb_of_opponent([y[k], cx[k], cz[k]])),
            edge: edges[k],
            point: points[k],
        };
        Self {
            size: [image.width(), image.height()],
            pixels: (0..y.len()).map(pixel).collect(),
        }
    }

    /// FLIP of one against the other, pixel by pixel, row by row.
    ///
    /// # Panics
    /// If they are of other sizes.
    pub(crate) fn errors(&self, other: &Self) -> Vec<f32> {
        assert_eq!(self.size, other.size, "one size");
        let pairs = self
            .pixels
            .iter()
            .copied()
            .zip(other.pixels.iter().copied());
        ColorScale::new().errors(pairs)
    }

    /// Mean FLIP of one against the other.
    ///
    /// # Panics
    /// If they are of other sizes, or of none.
    pub(crate) fn mean_error(&self, other: &Self) -> f64 {
        assert!(!self.pixels.is_empty(), "at least one pixel");
        let sum: f64 = self.errors(other).into_iter().map(f64::from).sum();
        sum / self.pixels.len() as f64
    }
}

/// A pixel as FLIP sees it.
#[derive(Clone, Copy, Debug)]
struct FlipPixel {
    /// L*, and a* and b* as far as the eye tells them apart at that lightness (Hunt).
    lab: [f32; 3],
    edge: f32,
    point: f32,
}

/// So many pixels are compared at a time: the processor takes several powers in the time of one.
const PIXELS_AT_A_TIME: usize = 16;

impl ColorScale {
    /// FLIP of pixels against others, 0 to 1 each.
    fn errors(&self, pairs: impl Iterator<Item = (FlipPixel, FlipPixel)>) -> Vec<f32> {
        let mut errors = Vec::with_capacity(pairs.size_hint().0);
        let mut pairs = pairs.fuse();
        loop {
            let mut differences = [0.0; PIXELS_AT_A_TIME];
            let mut exponents = [0.0; PIXELS_AT_A_TIME];
            let mut count = 0;
            let places = differences.iter_mut().zip(&mut exponents);
            for ((difference, exponent), (a, b)) in places.zip(&mut pairs) {
                let [lightness, red_green, blue_yellow] = [0, 1, 2].map(|k| a.lab[k] - b.lab[k]);
                *difference = lightness.abs() + red_green.hypot_of(blue_yellow);
                let (edge, point) = ((a.edge - b.edge).abs(), (a.point - b.point).abs());
                let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
                *exponent = 1.0 - feature;
                count += 1;
            }
            let colors = self.of(differences);
            let found: [f32; PIXELS_AT_A_TIME] = std::array::from_fn(|k| {
                let error = power(colors[k], exponents[k]);
                // Where colours are the same FLIP is 0, whatever the edges are.
                if differences[k] == 0.0 { 0.0 } else { error }
            });
            errors.extend_from_slice(&found[..count]);
            if count < PIXELS_AT_A_TIME {
                return errors;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use image::Rgba;
    use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, flip};

    use super::*;

    /// Mean FLIP by the reference implementation, whose own mean, a sum of 32-bit floats, is off by up to 5e-5 in
    /// pictures of 512 x 512 pixels.
    fn reference(a: &RgbaImage, b: &RgbaImage) -> f64 {
        let [a, b] = [a, b].map(|picture| {
            let rgb = picture.pixels().flat_map(|p| [p.0[0], p.0[1], p.0[2]]);
            let rgb: Vec<u8> = rgb.collect();
            FlipImageRgb8::with_data(picture.width(), picture.height(), &rgb)
        });
        let errors = flip(a, b, DEFAULT_PIXELS_PER_DEGREE).to_vec();
        errors.iter().copied().map(f64::from).sum::<f64>() / errors.len() as f64
    }

    /// Blobs of any colours before a gradient.
    fn picture(seed: u32, [width, height]: [u32; 2]) -> RgbaImage {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 16
        };
        let mut image = RgbaImage::from_fn(width, height, |x, y| {
            Rgba([
                200 + (x * 40 / width) as u8,
                210,
                250 - (y * 90 / height) as u8,
                255,
            ])
        });
        for _ in 0..(width * height / 1000).max(60) {
            let (left, top, side) = (next() % width, next() % height, 1 + next() % 9);
            let color = Rgba([next() as u8, next() as u8, next() as u8, 255]);
            for (x, y) in (left..left + side).flat_map(|x| (top..top + side).map(move |y| (x, y))) {
                if x < width && y < height {
                    image.put_pixel(x, y, color);
                }
            }
        }
        image
    }

    #[test]
    fn means_are_those_of_the_reference_implementation() {
        for (seed, size) in [
            (1, [64, 64]),
            (2, [97, 41]),
            (3, [256, 256]),
            (4, [9, 7]),
            (5, [512, 512]),
        ] {
            let [a, b] = [picture(seed, size), picture(seed + 100, size)];
            let ours = FlipPicture::of(&a).mean_error(&FlipPicture::of(&b));
            let theirs = reference(&a, &b);
            assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
            assert!(theirs > 0.05);
        }
        let [black, white] = [0, 255].map(|v| RgbaImage::from_pixel(32, 32, Rgba([v, v, v, 255])));
        let [ours, theirs] = [
            FlipPicture::of(&black).mean_error(&FlipPicture::of(&white)),
            reference(&black, &white),
        ];
        assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
    }

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let one = FlipPicture::of(&picture(5, [48, 48]));
        assert_eq!(one.mean_error(&one), 0.0);
    }
}
