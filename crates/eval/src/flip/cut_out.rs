//! FLIP of a plant before grey backgrounds, from one drawing of it.
//!
//! A background shows through by what the plant leaves of each pixel: `plant + (1 - coverage) * grey`, in linear
//! light. The filters of FLIP are linear, and a grey has no chroma, so the plant and its coverage are filtered
//! once, whatever the grey.

use super::color::{ColorScale, Colors, HypotOf};
use super::filters::{Grid, LIGHTNESS_WIDTH, RED_GREEN_WIDTH, blue_yellow, gaussian, responses};
use super::{FlipPicture, FlipPixel};

/// A plant as FLIP sees it before each of some greys.
#[derive(Clone, Debug)]
pub(crate) struct CutOutFlip {
    before: Vec<FlipPicture>,
}

impl CutOutFlip {
    /// Of a picture of `size` pixels, row by row: linear RGB times coverage, and coverage, 0 to 1; before these
    /// greys, in linear light.
    pub(crate) fn of(size: [u32; 2], rgb: &[[f32; 3]], coverage: &[f32], greys: &[f32]) -> Self {
        let grid = Grid::about(size[0] as usize, size[1] as usize, coverage);
        let colors = Colors::new();
        let mut planes = [(); 3].map(|()| vec![0.0; rgb.len()]);
        for (y, run) in grid.rows() {
            for k in run.map(|x| y * size[0] as usize + x) {
                let [x, y, z] = colors.relative_xyz(rgb[k]);
                (planes[0][k], planes[1][k], planes[2][k]) = (y, 500.0 * (x - y), 200.0 * (y - z));
            }
        }
        let [luminance, red_green, yellow_blue] = planes;
        let of_plant = responses(&grid, &luminance);
        let of_coverage = responses(&grid, coverage);
        let eye = gaussian(LIGHTNESS_WIDTH);
        let [luminance, coverage] = [&luminance[..], coverage].map(|p| grid.filtered(p, &eye));
        let red_green = grid.filtered(&red_green, &gaussian(RED_GREEN_WIDTH));
        let yellow_blue = blue_yellow(&grid, &yellow_blue);
        let before = |grey: &f32| {
            // Far from the plant all pixels are alike.
            let bare = FlipPixel {
                lab: colors.hunt_lab([*grey; 3]),
                edge: 0.0,
                point: 0.0,
            };
            let mut pixels = vec![bare; rgb.len()];
            for (y, run) in grid.rows() {
                for k in run.map(|x| y * size[0] as usize + x) {
                    if coverage[k] != 0.0 {
                        let y = luminance[k] + (1.0 - coverage[k]) * grey;
                        let opponent = [116.0 * y - 16.0, red_green[k], yellow_blue[k]];
                        pixels[k].lab = colors.hunt_lab(colors.rgb_of_opponent(opponent));
                    }
                    let [edge, point] = [0, 1].map(|feature| {
                        let (plant, cover) = (&of_plant[feature], &of_coverage[feature]);
                        let across = plant.across[k] - grey * cover.across[k];
                        across.hypot_of(plant.down[k] - grey * cover.down[k])
                    });
                    (pixels[k].edge, pixels[k].point) = (edge, point);
                }
            }
            FlipPicture { size, pixels }
        };
        Self {
            before: greys.iter().map(before).collect(),
        }
    }

    /// FLIP against another plant before each of the greys, at these pixels.
    ///
    /// # Panics
    /// If their sizes or greys differ.
    pub(crate) fn errors<'a>(
        &'a self,
        other: &'a Self,
        pixels: &'a [u32],
    ) -> impl Iterator<Item = Vec<f32>> + 'a {
        assert_eq!(self.before.len(), other.before.len(), "the same greys");
        let scale = ColorScale::new();
        self.before.iter().zip(&other.before).map(move |(a, b)| {
            assert_eq!(a.size, b.size, "one size");
            let error = |k: &u32| {
                let [a, b] = [a, b].map(|picture| &picture.pixels[*k as usize]);
                scale.error(a, b)
            };
            pixels.iter().map(error).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use image::{Rgba, RgbaImage};

    use super::*;
    use crate::srgb_byte;

    /// A disc and a bar that do not quite fill their pixels, in greens of 0 to 1.
    fn plant(shift: f32) -> (Vec<[f32; 3]>, Vec<f32>) {
        let coverage: Vec<f32> = (0..48 * 40)
            .map(|k| {
                let (x, y) = ((k % 48) as f32, (k / 48) as f32);
                let disc = 9.0 - (x - 20.0 - shift).hypot(y - 18.0);
                let bar = if (30.0..34.0).contains(&x) { 0.6 } else { 0.0 };
                disc.clamp(0.0, 1.0).max(bar)
            })
            .collect();
        let rgb = coverage.iter().enumerate().map(|(k, share)| {
            let light = 0.2 + 0.3 * ((k % 7) as f32 / 7.0);
            [0.3 * light * share, light * share, 0.1 * light * share]
        });
        (rgb.collect(), coverage)
    }

    fn composed((rgb, coverage): &(Vec<[f32; 3]>, Vec<f32>), grey: f32) -> RgbaImage {
        RgbaImage::from_fn(48, 40, |x, y| {
            let k = (y * 48 + x) as usize;
            let of = |c: usize| srgb_byte(rgb[k][c] + (1.0 - coverage[k]) * grey);
            Rgba([of(0), of(1), of(2), 255])
        })
    }

    /// As the picture that a client composes, but for the rounding of its bytes.
    #[test]
    fn errors_are_those_of_composed_pictures() {
        let greys = [0.8, 0.007];
        let plants = [0.0, 2.5].map(plant);
        let flips = plants
            .each_ref()
            .map(|(rgb, coverage)| CutOutFlip::of([48, 40], rgb, coverage, &greys));
        let all: Vec<u32> = (0..48 * 40).collect();
        let found = flips[0].errors(&flips[1], &all);
        for (errors, grey) in found.zip(greys) {
            let [a, b] = plants
                .each_ref()
                .map(|plant| FlipPicture::of(&composed(plant, grey)));
            let mean = errors.iter().map(|e| f64::from(*e)).sum::<f64>() / errors.len() as f64;
            let expected = a.mean_error(&b);
            assert!(
                expected > 0.02 && (mean / expected - 1.0).abs() < 0.01,
                "{mean} {expected}"
            );
        }
    }
}
