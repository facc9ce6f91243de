//! Pictures of many samples a pixel: what truly is there, and what a client shows over several frames.

use image::RgbaImage;
use secateur_model::Surface;
use secateur_raster::View;

use crate::flip::FlipPicture;
use crate::pictures::camera_of;
use crate::render::{RenderOptions, draw};
use crate::visibility::AlphaFrom;

/// Samples along each side of a pixel.
pub(crate) const SAMPLES: u32 = 4;

/// Each pixel the mean of its samples.
#[derive(Debug)]
pub(crate) struct AveragedPicture {
    pub(crate) image: RgbaImage,
    /// By pixel, row by row, the share of it that shows the plant.
    pub(crate) shares: Vec<f32>,
}

impl AveragedPicture {
    /// Of [`SAMPLES`] x [`SAMPLES`] samples a pixel, `width_px` x `width_px` pixels.
    pub(crate) fn of(
        surfaces: &[&Surface],
        view: &View,
        width_px: u32,
        alpha: AlphaFrom<'_>,
    ) -> Self {
        let drawn = draw(
            surfaces,
            &camera_of(view),
            &options(width_px, SAMPLES),
            alpha,
        );
        Self {
            image: drawn.image,
            shares: shares(&drawn.is_covered, width_px as usize),
        }
    }

    /// Pixels that show the plant, parts of pixels counted.
    pub(crate) fn covered_px(&self) -> f64 {
        self.shares.iter().map(|share| f64::from(*share)).sum()
    }

    /// Pixels that one of two frames of a sample a pixel shows and the other does not, mean of all pairs of
    /// frames.
    pub(crate) fn changing_px(&self) -> f64 {
        let frames = f64::from(SAMPLES * SAMPLES);
        let differing = |share: &f32| {
            let share = f64::from(*share);
            2.0 * share * (1.0 - share) * frames / (frames - 1.0)
        };
        self.shares.iter().map(differing).sum()
    }

    /// What FLIP sees of it.
    pub(crate) fn for_flip(&self) -> FlipPicture {
        FlipPicture::of(&self.image)
    }
}

/// Pictures of a plant alone, without shadows.
pub(crate) fn options(width_px: u32, samples: u32) -> RenderOptions {
    RenderOptions {
        width: width_px,
        height: width_px,
        samples,
        shadows: false,
        turns_normals: false,
    }
}

/// By pixel, row by row, the share of its samples that are covered, in a picture of this width in pixels.
fn shares(is_covered: &[bool], width: usize) -> Vec<f32> {
    let samples = SAMPLES as usize;
    let mut counts = vec![0u32; is_covered.len() / (samples * samples)];
    for (row, line) in is_covered.chunks(width * samples).enumerate() {
        for (column, is) in line.iter().enumerate() {
            counts[row / samples * width + column / samples] += u32::from(*is);
        }
    }
    let all = (samples * samples) as f32;
    counts.iter().map(|count| *count as f32 / all).collect()
}

/// How much two coverings of the same pixels have in common.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Overlap {
    /// Of each pixel the smaller share, in pixels.
    both_px: f64,
    /// Of each pixel the larger share, in pixels.
    any_px: f64,
}

impl Overlap {
    /// Adds a view: by pixel the share that each of the two covers.
    pub(crate) fn add(&mut self, shares: &[f32], others: impl Iterator<Item = f32>) {
        for (share, other) in shares.iter().zip(others) {
            self.both_px += f64::from(share.min(other));
            self.any_px += f64::from(share.max(other));
        }
    }

    /// Intersection over union, 0 to 1; 1 if nothing is covered.
    pub(crate) fn iou(self) -> f64 {
        match self.any_px {
            0.0 => 1.0,
            any => self.both_px / any,
        }
    }
}
