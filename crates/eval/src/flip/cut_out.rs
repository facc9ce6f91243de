//! FLIP of a plant before grey backgrounds, from one drawing of it.
//!
//! A background shows through by what the plant leaves of each pixel: `plant + (1 - coverage) * grey`, in linear
//! light. The filters of FLIP are linear, and a grey has no chroma, so the plant and its coverage are filtered
//! once, whatever the grey.

use super::color::{Colors, HypotOf};
use super::filters::{
    Grid, LIGHTNESS_WIDTH, RED_GREEN_WIDTH, Responses, blue_yellow, gaussian, responses,
};
use super::{FlipPicture, FlipPixels, RUN, run_of, set_run};

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
            let [[x], [y], [z]] = colors.relative_xyz(rgb[k].map(|channel| [channel]));
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

    /// Pixels before a grey, in linear light, which alone has these L*, a* and b*. Where the filters find nothing they
    /// are those of the grey.
    #[inline(never)]
    fn run(&self, first: usize, (grey, bare): (f32, [f32; 3]), colors: &Colors) -> FlipPixels {
        let of = |plane: &Vec<f32>| run_of(plane, first);
        let [luminance, coverage, red_green, yellow_blue] = self.seen.each_ref().map(of);
        let mut lightness = [0.0; RUN];
        for k in 0..RUN {
            lightness[k] = 116.0 * (luminance[k] + (1.0 - coverage[k]) * grey) - 16.0;
        }
        let opponent = [lightness, red_green, yellow_blue];
        let mut lab = colors.hunt_lab(colors.rgb_of_opponent(opponent));
        for (values, bare) in lab.iter_mut().zip(bare) {
            for (value, coverage) in values.iter_mut().zip(coverage) {
                *value = if coverage != 0.0 { *value } else { bare };
            }
        }
        let [edges, points] = [0, 1].map(|feature: usize| {
            let [plant, cover] = [&self.of_plant[feature], &self.of_coverage[feature]]
                .map(|found| [of(&found.across), of(&found.down)]);
            let mut strengths = [0.0; RUN];
            for (k, strength) in strengths.iter_mut().enumerate() {
                let [across, down] = [0, 1].map(|way: usize| plant[way][k] - grey * cover[way][k]);
                *strength = across.hypot_of(down);
            }
            strengths
        });
        let [lightness, a, b] = lab;
        [lightness, a, b, edges, points]
    }

    /// The picture before a grey, in linear light.
    fn before(&self, grey: f32) -> FlipPicture {
        let colors = Colors::new();
        let count = self.seen[0].len();
        // Far from the plant all pixels are alike.
        let bare = bare(grey, &colors);
        let [lightness, a, b] = bare;
        let mut planes = [lightness, a, b, 0.0, 0.0].map(|value| vec![value; count]);
        for (y, run) in self.grid.rows() {
            let row = y * self.size[0] as usize;
            for first in run.step_by(RUN).map(|x| row + x) {
                let found = self.run(first, (grey, bare), &colors);
                for (plane, values) in planes.iter_mut().zip(found) {
                    set_run(plane, first, &values);
                }
            }
        }
        FlipPicture {
            size: self.size,
            planes,
        }
    }
}

/// L*, a* and b* of a grey alone.
fn bare(grey: f32, colors: &Colors) -> [f32; 3] {
    colors.hunt_lab([[grey]; 3]).map(|[value]| value)
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
        let colors = Colors::new();
        self.before.iter().map(move |(grey, picture)| {
            assert_eq!(picture.size, other.size, "one size");
            let before = (*grey, bare(*grey, &colors));
            picture.errors_at(pixels, |first| other.run(first, before, &colors))
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

    /// Where one pixel differs, so do those that the filters reach it from, and no others, by whatever bits.
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
