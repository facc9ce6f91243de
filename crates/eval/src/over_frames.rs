//! What a client with temporal anti-aliasing shows: the mean of frames whose samples lie at different places in
//! each pixel. Each frame reads the mip levels that a single one would; some clients read sharper levels with
//! anti-aliasing, which fade less.
//!
//! A picture of one sample a pixel shows each pixel whole or not at all. Where a crown covers parts of many
//! pixels, that error is larger than what is wrong with a level, and a crown that is too dense overlaps more
//! of the half covered pixels than the original itself does. Over frames the error averages out, and what
//! is wrong with the level stays.

use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::ViewSet;
use serde::Serialize;

use crate::averaged::{AveragedPicture, Overlap, SAMPLES};
use crate::mips::MipChains;
use crate::truth::{Truth, coverage_over_truth, covered_px};
use crate::visibility::AlphaFrom;

/// How the mean of a client's frames compares with what the original truly looks like; means over the
/// views. Each frame is a picture of one sample a pixel, with the mip levels of such a picture; all frames
/// together have the samples of the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct OverFrames {
    /// How many frames there are.
    pub frames: u32,
    /// Pixels that the plant covers over those that the original truly covers, parts of pixels counted.
    pub coverage_over_truth: f64,
    /// Overlap with what the original truly covers, 0 to 1: of each pixel the smaller share that one of the two
    /// covers, over the larger, summed over all pixels.
    pub truth_iou: f64,
    /// FLIP against the truth, 0 to 1.
    pub flip_mean: f64,
    /// Pixels that show the plant in one of two frames and not in the other, mean of all pairs of frames, over
    /// the pixels that the original truly covers; 0 or more. What flickers where nothing smooths over frames and
    /// the camera moves a little.
    pub flicker: f64,
    /// Flicker of the truth: what one sample a pixel can't avoid.
    pub truth_flicker: f64,
}

impl OverFrames {
    /// Of surfaces with these mip chains, from the views of `truth`.
    pub(crate) fn of(
        surfaces: &[&Surface],
        mips: &MipChains,
        views: &ViewSet,
        width_px: u32,
        truth: &[Truth],
    ) -> Self {
        let mips = mips.for_pixels_of(SAMPLES);
        let alpha = AlphaFrom::mips(Some(&mips));
        let (mut covered, mut changing, mut overlap) = (0.0, 0.0, Overlap::default());
        // One after another, as the truth.
        let images = views.views().iter().zip(truth).map(|(view, truth)| {
            let drawn = AveragedPicture::of(surfaces, view, width_px, alpha);
            covered += drawn.covered_px();
            changing += drawn.changing_px();
            overlap.add(&truth.picture.shares, drawn.shares.iter().copied());
            drawn.image
        });
        let images: Vec<RgbaImage> = images.collect();
        let flips = truth.par_iter().zip(&images);
        let flips: Vec<f64> = flips.map(|(truth, image)| truth.flip(image)).collect();
        let truly_covered = covered_px(truth);
        let truly_changing = truth.iter().map(|truth| truth.picture.changing_px());
        let flicker = |changing: f64| match truly_covered > 0.0 {
            true => changing / truly_covered,
            false => 0.0,
        };
        Self {
            frames: SAMPLES * SAMPLES,
            coverage_over_truth: coverage_over_truth(covered, truly_covered),
            truth_iou: overlap.iou(),
            flip_mean: flips.iter().sum::<f64>() / truth.len() as f64,
            flicker: flicker(changing),
            truth_flicker: flicker(truly_changing.sum()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AsDrawn;
    use crate::as_drawn::tests::{card_view, striped};
    use secateur_model::{AlphaMode, Mips};
    use std::sync::Arc;

    fn over_frames(mips: Mips, width_px: u32) -> OverFrames {
        let [truth, drawn] = [Mips::None, mips].map(|mips| [striped(mips)]);
        let original = AsDrawn::new(&truth, &card_view(), width_px).over_frames(&truth);
        original.measure(&drawn).over_frames.unwrap()
    }

    /// What a sample shows without mip maps is true, so that nothing is left of the error of one sample a
    /// pixel, however little of a pixel is covered.
    #[test]
    fn the_original_without_mips_is_the_truth_over_frames() {
        for width_px in [64, 24, 16, 5] {
            let found = over_frames(Mips::None, width_px);
            let expected = OverFrames {
                frames: 16,
                coverage_over_truth: 1.0,
                truth_iou: 1.0,
                flip_mean: 0.0,
                flicker: found.truth_flicker,
                truth_flicker: found.truth_flicker,
            };
            assert_eq!(found, expected, "{width_px}");
        }
    }

    /// Frames read the mip levels of pixels, not those of samples: in pixels of four texels nothing is left of
    /// stripes of a quarter, in pixels of a texel all of them.
    #[test]
    fn frames_fade_as_a_single_one_does() {
        assert_eq!(over_frames(Mips::Blended, 64).truth_iou, 1.0);
        assert_eq!(over_frames(Mips::Blended, 16).coverage_over_truth, 0.0);
    }

    /// Of pixels of four texels each frame shows those whose sample lies in the one texel with a stripe: 4 of 16.
    /// 48 of the 120 pairs of frames differ then, in each of the pixels, a quarter of which is covered. In pixels
    /// of a texel all frames are alike, and what fades away does not flicker.
    #[test]
    fn pixels_that_are_partly_covered_flicker() {
        let sharp = over_frames(Mips::None, 16);
        assert!(
            (sharp.flicker - 4.0 * 48.0 / 120.0).abs() < 1e-12,
            "{sharp:?}"
        );
        assert_eq!(over_frames(Mips::None, 64).flicker, 0.0);
        let faded = over_frames(Mips::Blended, 16);
        assert_eq!((faded.flicker, faded.truth_flicker), (0.0, sharp.flicker));
    }

    /// Half of each pixel is truly there. A client that shows half of the pixels, each whole, has a third of the
    /// overlap in one frame, and one that shows all of them a half; over frames of samples that meet what is
    /// there the first is right.
    #[test]
    fn what_is_too_dense_is_no_longer_nearer_to_the_truth() {
        let stripes = [striped(Mips::None)];
        let mut full = striped(Mips::None);
        Arc::make_mut(&mut full.material).alpha_mode = AlphaMode::Opaque;
        // Pixels of 3.2 texels, whose middles meet some of the stripes.
        let original = AsDrawn::new(&stripes, &card_view(), 20).over_frames(&stripes);
        let [own, dense] = [&stripes[0], &full].map(|surface| original.measure(&[surface]));
        assert!(dense.truth_iou > own.truth_iou, "{own:?} {dense:?}");
        let [own, dense] = [own, dense].map(|found| found.over_frames.unwrap());
        assert!(own.truth_iou > dense.truth_iou, "{own:?} {dense:?}");
        let plain = AsDrawn::new(&stripes, &card_view(), 20).measure(&stripes);
        assert_eq!(
            (plain.over_frames, plain.original_over_frames),
            (None, None)
        );
    }
}
