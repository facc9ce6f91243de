//! What is drawn of a plant from a view, and how far a level's picture is from it.

use std::sync::Arc;

use secateur_model::Surface;

use super::blocks::{
    LEAST_JUDGED, LEAST_OF_PART, ViewScores, largest_coverage_difference, worst_and_mean,
};
use super::frame::Frame;
use super::mask::{LEAST_COVERAGE, judged_pixels, near_difference};
use super::spots::spots;
use crate::cut_mask::CutMasks;
use crate::flip::{CutOutFlip, FilteredCutOut, reach_px};
use crate::render::{CutOut, CutOutRoles, draw_cut_out};
use crate::visibility::AlphaFrom;

/// The backgrounds, sRGB .92 and .08, in linear light.
const BACKGROUNDS: [f32; 2] = [0.827_79, 0.007_27];

/// A pixel shows wood where this share of it does.
const MOSTLY: f32 = 0.5;

/// A plant from one view: what pictures of its levels are compared with.
#[derive(Debug)]
pub(super) struct PlantPicture {
    rgb: Vec<[f32; 3]>,
    coverage: Vec<f32>,
    /// By pixel, the share of its samples that show wood.
    wood: Vec<f32>,
    /// Which pixels show a flower, a fruit or the like.
    spots: Vec<bool>,
    flip: CutOutFlip,
}

/// A plant or a level, drawn from one view.
pub(super) struct DrawnPlant(CutOut);

/// Draws surfaces, of which the first `wood` are wood, behind occluders.
pub(super) fn draw(
    surfaces: &[&Surface],
    wood: usize,
    occluders: &[Arc<Surface>],
    frame: &Frame,
    (turns_normals, masks): (bool, &CutMasks),
) -> DrawnPlant {
    let roles = CutOutRoles {
        core: wood,
        occluders: surfaces.len(),
    };
    let occluders = occluders.iter().map(|surface| &**surface);
    let all: Vec<&Surface> = surfaces.iter().copied().chain(occluders).collect();
    let how = (frame.samples, turns_normals);
    let alpha = AlphaFrom::masks(masks);
    DrawnPlant(draw_cut_out(&all, roles, frame.lens, how, alpha))
}

impl PlantPicture {
    pub(super) fn of(DrawnPlant(drawn): DrawnPlant) -> Self {
        let filtered = FilteredCutOut::of(drawn.size, &drawn.rgb, &drawn.coverage);
        Self {
            flip: CutOutFlip::of(&filtered, &BACKGROUNDS),
            spots: spots(&drawn.rgb, &drawn.coverage, drawn.size[0] as usize),
            rgb: drawn.rgb,
            coverage: drawn.coverage,
            wood: drawn.core,
        }
    }

    /// How many pixels the plant covers, parts of pixels counted.
    pub(super) fn covered_px(&self) -> f64 {
        self.coverage.iter().map(|part| f64::from(*part)).sum()
    }

    /// How many pixels show a tenth of plant or more.
    pub(super) fn touched_px(&self) -> f64 {
        let is_touched = |part: &&f32| **part >= LEAST_COVERAGE;
        self.coverage.iter().filter(is_touched).count() as f64
    }

    /// By pixel, whether a level, drawn in the same frame, has another colour or coverage there.
    fn differs(&self, level: &CutOut) -> Vec<bool> {
        let coverage = self.coverage.iter().zip(&level.coverage);
        let pixels = self.rgb.iter().zip(&level.rgb).zip(coverage);
        pixels.map(|((a, b), (c, d))| a != b || c != d).collect()
    }

    /// FLIP of a level, drawn in the same frame, at these pixels, before each background. It is found near what differs;
    /// elsewhere it is 0.
    fn errors(&self, level: &CutOut, pixels: &[u32]) -> Vec<Vec<f32>> {
        let width = level.size[0] as usize;
        let near = near_difference(pixels, &self.differs(level), width, reach_px());
        let filtered = FilteredCutOut::at(&near, level.size, &level.rgb, &level.coverage);
        let before = self.flip.errors(&filtered, &near);
        before
            .map(|errors| with_zeros(pixels, &near, errors))
            .collect()
    }

    /// How far a level, drawn in the same frame, is from this plant.
    pub(super) fn scores(&self, DrawnPlant(level): &DrawnPlant, frame: &Frame) -> ViewScores {
        let width = (frame.lens.width / frame.samples) as usize;
        let judged = judged_pixels(&self.coverage, &level.coverage, width);
        let [columns, rows] = frame.blocks();
        let block_of = |pixel: u32| frame.block_of(pixel);
        let is_wood = |pixel: &u32| self.wood[*pixel as usize] >= MOSTLY;
        let is_spot = |pixel: &u32| self.spots[*pixel as usize];
        let of_block = |least: f64, pixels: &[u32], errors: &[f32]| {
            let count = columns * rows;
            worst_and_mean(least, (pixels, errors), frame.block_px, count, block_of)
        };
        let (mut worst_block, mut mean, mut worst_wood) = (0.0f64, 0.0f64, 0.0f64);
        for errors in self.errors(level, &judged) {
            let (worst, of_all) = of_block(LEAST_JUDGED, &judged, &errors);
            let of_part = |is_part: &dyn Fn(&u32) -> bool| {
                let pairs = judged.iter().zip(&errors);
                let (pixels, errors): (Vec<u32>, Vec<f32>) =
                    pairs.filter(|(pixel, _)| is_part(pixel)).unzip();
                of_block(LEAST_OF_PART, &pixels, &errors)
            };
            let (of_wood, all_wood) = of_part(&is_wood);
            // Single spots of a pixel or two are not missed.
            let of_spots = of_part(&is_spot).0.unwrap_or(0.0);
            worst_wood = worst_wood.max(of_wood.unwrap_or(all_wood)).max(of_spots);
            let worst = worst.unwrap_or(of_all);
            worst_block = worst_block.max(worst);
            mean = mean.max(of_all);
        }
        let coverage = [&self.coverage[..], &level.coverage];
        ViewScores {
            worst_block,
            mean,
            worst_wood,
            block_coverage: largest_coverage_difference(
                coverage,
                frame.block_px,
                columns * rows,
                block_of,
            ),
        }
    }
}

/// FLIP at all `pixels`: `errors` at those of `near`, which is part of them in the same order, and 0 elsewhere.
fn with_zeros(pixels: &[u32], near: &[u32], errors: Vec<f32>) -> Vec<f32> {
    let mut known = near.iter().zip(errors).peekable();
    let error = |pixel: &u32| {
        let here = known.next_if(|(at, _)| *at == pixel);
        here.map_or(0.0, |(_, error)| error)
    };
    pixels.iter().map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A green square of 48 x 40 pixels' middle, with one pixel of this red and another of this coverage.
    fn drawn(red: f32, share: f32) -> CutOut {
        let at = |x: usize, y: usize| y * 48 + x;
        let mut coverage = vec![0.0; 48 * 40];
        for y in 8..32 {
            coverage[at(8, y)..at(40, y)].fill(1.0);
        }
        coverage[at(36, 12)] = share;
        let mut rgb: Vec<[f32; 3]> = coverage.iter().map(|c| [0.1 * c, 0.3 * c, 0.0]).collect();
        rgb[at(12, 28)][0] = red;
        CutOut {
            size: [48, 40],
            core: vec![0.0; coverage.len()],
            rgb,
            coverage,
        }
    }

    /// FLIP has the bits that it has where it is found at all pixels: with another colour, another coverage, or both.
    #[test]
    fn flip_is_zero_far_from_what_differs() {
        let plant = PlantPicture::of(DrawnPlant(drawn(0.1, 1.0)));
        let all: Vec<u32> = (0..48 * 40).collect();
        for (red, share) in [(0.1, 1.0), (0.6, 1.0), (0.1, 0.4), (0.6, 0.4)] {
            let level = drawn(red, share);
            let everywhere = FilteredCutOut::of(level.size, &level.rgb, &level.coverage);
            let expected: Vec<Vec<f32>> = plant.flip.errors(&everywhere, &all).collect();
            assert_eq!(plant.errors(&level, &all), expected);
            let told = expected[0].iter().filter(|error| **error > 0.0).count();
            assert!(told < all.len() / 2 && (told > 100) == (red > 0.1 || share < 1.0));
        }
    }
}
