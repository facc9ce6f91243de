//! FLIP of a plant before grey backgrounds, from one drawing of it.
//!
//! A background shows through by what the plant leaves of each pixel: `plant + (1 - coverage) * grey`, in linear
//! light. The filters of FLIP are linear, and a grey has no chroma, so the plant and its coverage are filtered
//! once, whatever the grey.

use super::color::{ColorScale, Colors, HypotOf};
use super::filters::{
    Grid, LIGHTNESS_WIDTH, RED_GREEN_WIDTH, Responses, blue_yellow, gaussian, responses,
};
use super::{FlipPicture, FlipPixel};

/// A plant as the filters of FLIP leave it, before any background.
#[derive(Clone, Debug)]
pub(crate) struct FilteredCutOut {
    size: [u32; 2],
    /// Where it is filtered.
    grid: Grid,
    /// Luminance, coverage, red against green, and yellow against blue, as an eye sees them.
    seen: [Vec<f32>; 4],
    /// Edges and points of the plant's luminance, and of its coverage.
    of_plant: [Responses; 2],
    of_coverage: [Responses; 2],
}

impl FilteredCutOut {
    /// Of a picture of `size` pixels, row by row: linear RGB times coverage, and coverage, 0 to 1.
    pub(crate) fn of(size: [u32; 2], rgb: &[[f32; 3]], coverage: &[f32]) -> Self {
        let [width, height] = size.map(|side| side as usize);
        Self::on(Grid::about(width, height, coverage), size, rgb, coverage)
    }

    /// As [`Self::of`], but as a plant is seen at these pixels alone.
    pub(crate) fn at(pixels: &[u32], size: [u32; 2], rgb: &[[f32; 3]], coverage: &[f32]) -> Self {
        let [width, height] = size.map(|side| side as usize);
        Self::on(Grid::at(width, height, pixels), size, rgb, coverage)
    }

    fn on(grid: Grid, size: [u32; 2], rgb: &[[f32; 3]], coverage: &[f32]) -> Self {
        let colors = Colors::new();
        let mut planes = [(); 3].map(|()| vec![0.0; rgb.len()]);
        for k in (0..rgb.len()).filter(|k| coverage[*k] != 0.0) {
            let [x, y, z] = colors.relative_xyz(rgb[k]);
            (planes[0][k], planes[1][k], planes[2][k]) = (y, 500.0 * (x - y), 200.0 * (y - z));
        }
        let [luminance, red_green, yellow_blue] = planes;
        let eye = gaussian(LIGHTNESS_WIDTH);
        Self {
            of_plant: responses(&grid, &luminance),
            of_coverage: responses(&grid, coverage),
            seen: [
                grid.filtered(&luminance, &eye),
                grid.filtered(coverage, &eye),
                grid.filtered(&red_green, &gaussian(RED_GREEN_WIDTH)),
                blue_yellow(&grid, &yellow_blue),
            ],
            size,
            grid,
        }
    }

    /// A pixel before a grey, in linear light. Where the filters find nothing it is that of the grey alone.
    fn pixel(&self, k: usize, grey: f32, colors: &Colors, bare: FlipPixel) -> FlipPixel {
        let [luminance, coverage, red_green, yellow_blue] = self.seen.each_ref().map(|p| p[k]);
        let lab = match coverage != 0.0 {
            true => {
                let y = luminance + (1.0 - coverage) * grey;
                let opponent = [116.0 * y - 16.0, red_green, yellow_blue];
                colors.hunt_lab(colors.rgb_of_opponent(opponent))
            }
            false => bare.lab,
        };
        let [edge, point] = [0, 1].map(|feature| {
            let (plant, cover) = (&self.of_plant[feature], &self.of_coverage[feature]);
            let across = plant.across[k] - grey * cover.across[k];
            across.hypot_of(plant.down[k] - grey * cover.down[k])
        });
        FlipPixel { lab, edge, point }
    }

    /// The picture before a grey, in linear light.
    fn before(&self, grey: f32) -> FlipPicture {
        let colors = Colors::new();
        // Far from the plant all pixels are alike.
        let bare = bare(grey, &colors);
        let mut pixels = vec![bare; self.seen[0].len()];
        for (y, run) in self.grid.rows() {
            for k in run.map(|x| y * self.size[0] as usize + x) {
                pixels[k] = self.pixel(k, grey, &colors, bare);
            }
        }
        FlipPicture {
            size: self.size,
            pixels,
        }
    }
}

/// A pixel of a grey alone.
fn bare(grey: f32, colors: &Colors) -> FlipPixel {
    FlipPixel {
        lab: colors.hunt_lab([grey; 3]),
        edge: 0.0,
        point: 0.0,
    }
}

/// A plant as FLIP sees it before each of some greys: what others are compared with.
#[derive(Clone, Debug)]
pub(crate) struct CutOutFlip {
    /// By grey, in linear light.
    before: Vec<(f32, FlipPicture)>,
}

impl CutOutFlip {
    /// Before these greys, in linear light.
    pub(crate) fn of(plant: &FilteredCutOut, greys: &[f32]) -> Self {
        let before = greys.iter().map(|grey| (*grey, plant.before(*grey)));
        Self {
            before: before.collect(),
        }
    }

    /// FLIP against another plant, which was filtered there, before each of the greys, at these pixels.
    ///
    /// # Panics
    /// If their sizes differ.
    pub(crate) fn errors<'a>(
        &'a self,
        other: &'a FilteredCutOut,
        pixels: &'a [u32],
    ) -> impl Iterator<Item = Vec<f32>> + 'a {
        let (scale, colors) = (ColorScale::new(), Colors::new());
        self.before.iter().map(move |(grey, picture)| {
            assert_eq!(picture.size, other.size, "one size");
            let bare = bare(*grey, &colors);
            let pair = |k: &u32| {
                let other = other.pixel(*k as usize, *grey, &colors, bare);
                (picture.pixels[*k as usize], other)
            };
            scale.errors(pixels.iter().map(pair))
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
        let filtered = plants
            .each_ref()
            .map(|(rgb, coverage)| FilteredCutOut::of([48, 40], rgb, coverage));
        let all: Vec<u32> = (0..48 * 40).collect();
        let flip = CutOutFlip::of(&filtered[0], &greys);
        let found = flip.errors(&filtered[1], &all);
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

    /// Where one pixel has another colour, FLIP is above 0 as far as the filters reach, and 0 beyond.
    #[test]
    fn errors_reach_as_far_as_filters_do() {
        let (rgb, coverage) = plant(0.0);
        let mut other = rgb.clone();
        let (x, y) = (21, 19);
        other[y * 48 + x] = [0.9, 0.1, 0.4];
        let [a, b] = [rgb, other].map(|rgb| FilteredCutOut::of([48, 40], &rgb, &coverage));
        let all: Vec<u32> = (0..48 * 40).collect();
        let flip = CutOutFlip::of(&a, &[0.8]);
        let errors = flip.errors(&b, &all).next().unwrap();
        let away = |k: usize| (k % 48).abs_diff(x).max((k / 48).abs_diff(y));
        let told = (0..errors.len()).filter(|k| errors[*k] > 0.0);
        assert_eq!(told.map(away).max(), Some(crate::flip::reach_px()));
    }
}
