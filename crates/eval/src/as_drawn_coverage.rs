//! How much of a tree a client shows, where no pictures are compared: nothing is lit, which would
//! take most of the time.

use std::borrow::Borrow;

use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};
use serde::Serialize;

use crate::as_drawn::specks;
use crate::cut_mask::CutMasks;
use crate::mips::{MipChains, MipMaps};
use crate::pictures::camera_of;
use crate::render::is_covered;
use crate::surface_references::references;
use crate::truth::coverage_over_truth;
use crate::visibility::AlphaFrom;

/// How much of a tree a client shows; see [`AsDrawnMeasurement`](crate::AsDrawnMeasurement).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shown {
    /// Pixels that it covers over those that the original truly covers.
    pub coverage_over_truth: f64,
    /// Islands of up to 3 pixels in a view.
    pub specks_per_view: f64,
}

/// Of how many samples along a side the truth is at least, if a pixel has no more than four a side:
/// of 150,000 in a view a thousandth of what is covered is no more than chance.
const TRUTH_SIDE: u32 = 384;

/// How much of an original truly covers pictures of it, and how much of it a client shows there.
#[derive(Clone, Debug)]
pub struct AsDrawnCoverage {
    views: ViewSet,
    width_px: u32,
    /// For each view the pixels that truly show it, parts of pixels counted.
    truth_px: Vec<f64>,
    /// For each view what a client shows of it.
    original: Vec<Counted>,
}

/// What a client shows in a view.
#[derive(Clone, Copy, Debug)]
struct Counted {
    covered_px: usize,
    specks: usize,
}

impl AsDrawnCoverage {
    /// Of an original from views, in pictures of `width_px` x `width_px` pixels. Mip maps that are not
    /// `known` are made.
    ///
    /// # Panics
    /// If `width_px` is 0, or there is no view.
    pub fn new<S: Borrow<Surface> + Sync>(
        original: &[S],
        views: &ViewSet,
        width_px: u32,
        known: &MipMaps,
    ) -> Self {
        let original = &references(original)[..];
        assert!(width_px > 0 && !views.is_empty());
        let samples = (TRUTH_SIDE / width_px).clamp(1, 4);
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        let covered_px = |view: &View| {
            let is_covered = is_covered(original, &camera_of(view), width_px * samples, alpha);
            let covered = is_covered.iter().filter(|is| **is).count();
            covered as f64 / f64::from(samples * samples)
        };
        Self {
            truth_px: views.views().par_iter().map(covered_px).collect(),
            original: counted(original, views, width_px, known),
            views: views.clone(),
            width_px,
        }
    }

    /// How much a client shows of the original itself.
    pub fn original_shown(&self) -> Shown {
        self.shown_by(&self.original)
    }

    /// How much a client shows of a simplified tree. Mip maps that are not `known` are made.
    pub fn shown<S: Borrow<Surface> + Sync>(&self, simplified: &[S], known: &MipMaps) -> Shown {
        let simplified = &references(simplified)[..];
        let counted = counted(simplified, &self.views, self.width_px, known);
        self.shown_by(&counted)
    }

    fn shown_by(&self, counted: &[Counted]) -> Shown {
        let covered_px: usize = counted.iter().map(|view| view.covered_px).sum();
        let specks: usize = counted.iter().map(|view| view.specks).sum();
        let truth_px: f64 = self.truth_px.iter().sum();
        Shown {
            coverage_over_truth: coverage_over_truth(covered_px as f64, truth_px),
            specks_per_view: specks as f64 / counted.len() as f64,
        }
    }
}

fn counted(surfaces: &[&Surface], views: &ViewSet, width_px: u32, known: &MipMaps) -> Vec<Counted> {
    let mips = MipChains::of_cut_outs(surfaces, known);
    let of_view = |view: &View| {
        let alpha = AlphaFrom::mips(Some(&mips));
        let is_covered = is_covered(surfaces, &camera_of(view), width_px, alpha);
        Counted {
            covered_px: is_covered.iter().filter(|is| **is).count(),
            specks: specks(&is_covered, width_px as usize),
        }
    };
    views.views().par_iter().map(of_view).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AsDrawn;
    use crate::as_drawn::tests::{card_view, striped};
    use secateur_model::{AlphaMode, Mips};
    use std::sync::Arc;

    /// Stripes cover a quarter of a card. Its mip maps have an alpha of about .25, which no test at .5 passes; blended,
    /// a quarter of the card is seen all the same.
    #[test]
    fn what_blends_does_not_fade() {
        let views = card_view();
        let shown = |alpha_mode| {
            let mut card = [striped(Mips::Blended)];
            Arc::make_mut(&mut card[0].material).alpha_mode = alpha_mode;
            // 23 pixels: no whole number of stripes for each.
            let counted = AsDrawnCoverage::new(&card, &views, 23, &MipMaps::default());
            counted.original_shown().coverage_over_truth
        };
        assert_eq!(shown(AlphaMode::Mask(0.5)), 0.0);
        let blended = shown(AlphaMode::Blend);
        assert!((0.8..1.2).contains(&blended), "{blended}");
    }

    /// What is counted without light is what the pictures show.
    #[test]
    fn as_much_is_shown_as_in_pictures() {
        let views = card_view();
        for (mips, width_px) in [(Mips::Blended, 64), (Mips::None, 16), (Mips::Blended, 16)] {
            let card = [striped(mips)];
            let pictures = AsDrawn::new(&card, &views, width_px).measure(&card);
            let known = MipMaps::of_cut_outs(&card);
            let counted = AsDrawnCoverage::new(&card, &views, width_px, &MipMaps::default());
            let shown = counted.shown(&card, &known);
            assert_eq!(shown, counted.shown(&card, &MipMaps::default()));
            assert_eq!(shown.coverage_over_truth, pictures.coverage_over_truth);
            assert_eq!(shown.specks_per_view, pictures.specks_per_view);
            assert_eq!(counted.original_shown(), shown);
        }
    }
}
