//! What is drawn of a plant from a view, and how far a level's picture is from it.

use std::borrow::Borrow;
use std::sync::Arc;

use secateur_model::Surface;

use super::blocks::{ViewScores, largest_coverage_difference, worst_and_mean};
use super::frame::Frame;
use super::mask::judged_pixels;
use crate::cut_mask::CutMasks;
use crate::flip::CutOutFlip;
use crate::render::{CutOutRoles, draw_cut_out};
use crate::visibility::AlphaFrom;

/// The backgrounds, sRGB .92 and .08, in linear light.
const BACKGROUNDS: [f32; 2] = [0.827_79, 0.007_27];

/// A plant or a level from one view.
#[derive(Debug)]
pub(super) struct PlantPicture {
    coverage: Vec<f32>,
    /// By pixel, the share of its samples that show wood.
    wood: Vec<f32>,
    flip: CutOutFlip,
}

/// Draws surfaces, of which the first `wood` are wood, behind occluders.
pub(super) fn draw<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    wood: usize,
    occluders: &[Arc<Surface>],
    frame: &Frame,
    turns_normals: bool,
) -> PlantPicture {
    let roles = CutOutRoles {
        core: wood,
        occluders: surfaces.len(),
    };
    let occluders = occluders.iter().map(|surface| &**surface);
    let all: Vec<&Surface> = surfaces.iter().map(S::borrow).chain(occluders).collect();
    let masks = CutMasks::default();
    let how = (frame.samples, turns_normals);
    let drawn = draw_cut_out(&all, roles, frame.lens, how, AlphaFrom::masks(&masks));
    let flip = CutOutFlip::of(drawn.size, &drawn.rgb, &drawn.coverage, &BACKGROUNDS);
    PlantPicture {
        coverage: drawn.coverage,
        wood: drawn.core,
        flip,
    }
}

impl PlantPicture {
    /// How far another picture of the same frame is from this one.
    pub(super) fn scores(&self, level: &Self, frame: &Frame) -> ViewScores {
        let width = (frame.lens.width / frame.samples) as usize;
        let judged = judged_pixels(&self.coverage, &level.coverage, width);
        let [columns, rows] = frame.blocks();
        let block_of = |pixel: u32| frame.block_of(pixel);
        let (mut worst_block, mut mean) = (0.0f64, 0.0f64);
        for errors in self.flip.errors(&level.flip, &judged) {
            let of_errors = (&judged[..], &errors[..]);
            let [worst, of_all] =
                worst_and_mean(of_errors, frame.block_px, columns * rows, block_of);
            worst_block = worst_block.max(worst);
            mean = mean.max(of_all);
        }
        let coverage = [&self.coverage[..], &level.coverage];
        ViewScores {
            worst_block,
            mean,
            block_coverage: largest_coverage_difference(
                coverage,
                frame.block_px,
                columns * rows,
                block_of,
            ),
        }
    }
}
