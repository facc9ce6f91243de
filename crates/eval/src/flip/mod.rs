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

use color::{ColorScale, Colors, HypotOf, power};
pub(crate) use cut_out::{CutOutFlip, FilteredCutOut};
pub(crate) use error_map::error_map;
pub(crate) use filters::reach_px;
use filters::{Grid, LIGHTNESS_WIDTH, RED_GREEN_WIDTH, blue_yellow, features, gaussian};

/// Pixels a degree of the viewer's sight, the default of the reference implementation: a screen .7 m wide with 3,840
/// pixels, seen from .7 m.
pub(crate) const PIXELS_PER_DEGREE: f32 = 67.0;

/// A picture as FLIP sees it.
#[derive(Clone, Debug)]
pub(crate) struct FlipPicture {
    size: [u32; 2],
    /// Row by row: L*, a* and b* as far as the eye tells them apart at that lightness (Hunt), and how strong edges
    /// and points are.
    planes: [Vec<f32>; 5],
}

/// What some pixels that follow each other have of the planes of a [`FlipPicture`].
type FlipPixels = [[f32; RUN]; 5];

/// So many pixels are looked at together: the processor does several in the time of one.
const RUN: usize = 16;

impl FlipPicture {
    /// Of a picture without transparency, at the usual 67 pixels a degree.
    pub(crate) fn of(image: &RgbaImage) -> Self {
        let size = [image.width(), image.height()];
        let grid = Grid::whole(size[0] as usize, size[1] as usize);
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
        let mut lab = [(); 3].map(|()| vec![0.0; y.len()]);
        for first in (0..y.len()).step_by(RUN) {
            let opponent = [&y, &cx, &cz].map(|plane| run_of(plane, first));
            let found = colors.hunt_lab(colors.rgb_of_opponent(opponent));
            for (plane, values) in lab.iter_mut().zip(found) {
                set_run(plane, first, &values);
            }
        }
        let [lightness, a, b] = lab;
        Self {
            size,
            planes: [lightness, a, b, edges, points],
        }
    }

    /// FLIP of one against the other, pixel by pixel, row by row.
    ///
    /// # Panics
    /// If they are of other sizes.
    pub(crate) fn errors(&self, other: &Self) -> Vec<f32> {
        assert_eq!(self.size, other.size, "one size");
        let all: Vec<u32> = (0..self.planes[0].len() as u32).collect();
        self.errors_at(&all, |first| other.run(first))
    }

    /// FLIP at pixels, in order, against what `other` has from some pixel on.
    fn errors_at(&self, pixels: &[u32], other: impl Fn(usize) -> FlipPixels) -> Vec<f32> {
        let scale = ColorScale::new();
        let mut errors = Vec::with_capacity(pixels.len());
        for of_run in pixels.chunk_by(|a, b| *a as usize / RUN == *b as usize / RUN) {
            let first = of_run[0] as usize / RUN * RUN;
            let found = scale.errors(&self.run(first), &other(first));
            errors.extend(of_run.iter().map(|k| found[*k as usize - first]));
        }
        errors
    }

    fn run(&self, first: usize) -> FlipPixels {
        self.planes.each_ref().map(|plane| run_of(plane, first))
    }

    /// Mean FLIP of one against the other.
    ///
    /// # Panics
    /// If they are of other sizes, or of none.
    pub(crate) fn mean_error(&self, other: &Self) -> f64 {
        let errors = self.errors(other);
        assert!(!errors.is_empty(), "at least one pixel");
        let count = errors.len() as f64;
        errors.into_iter().map(f64::from).sum::<f64>() / count
    }
}

/// A run of a plane from a pixel on, 0 beyond its end.
fn run_of(plane: &[f32], first: usize) -> [f32; RUN] {
    let rest = &plane[first..];
    rest.first_chunk().copied().unwrap_or_else(|| {
        let mut run = [0.0; RUN];
        run[..rest.len()].copy_from_slice(rest);
        run
    })
}

/// Puts a run into a plane, as far as that reaches.
fn set_run(plane: &mut [f32], first: usize, values: &[f32; RUN]) {
    let end = plane.len().min(first + RUN);
    plane[first..end].copy_from_slice(&values[..end - first]);
}

impl ColorScale {
    /// FLIP of pixels against others, 0 to 1 each.
    #[inline(never)]
    fn errors(&self, a: &FlipPixels, b: &FlipPixels) -> [f32; RUN] {
        let mut errors = [0.0; RUN];
        for (k, error) in errors.iter_mut().enumerate() {
            let [lightness, red_green, blue_yellow, edge, point] =
                [0, 1, 2, 3, 4].map(|plane: usize| a[plane][k] - b[plane][k]);
            let difference = lightness.abs() + red_green.hypot_of(blue_yellow);
            let feature = (edge.abs().max(point.abs()) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            let found = power(self.of(difference), 1.0 - feature);
            // Where colours are the same FLIP is 0, whatever the edges are.
            *error = if difference == 0.0 { 0.0 } else { found };
        }
        errors
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
