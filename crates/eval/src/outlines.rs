//! Which pixels show a tree, in pictures without light.

use std::borrow::Borrow;

use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};

use crate::as_drawn::specks;
use crate::cut_mask::CutMasks;
use crate::pictures::camera_of;
use crate::render::is_covered;
use crate::surface_references::references;
use crate::visibility::AlphaFrom;

/// For each view which pixels show a tree.
#[derive(Clone, Debug)]
pub struct Outlines {
    width_px: u32,
    /// For each view, whether each pixel is covered, in rows from the top.
    views: Vec<Vec<bool>>,
}

impl Outlines {
    /// What is truly there at the middle of each pixel: textures are read as they are, without mip
    /// maps.
    ///
    /// # Panics
    /// If `width_px` is 0.
    pub fn of_truth<S: Borrow<Surface> + Sync>(
        surfaces: &[S],
        views: &ViewSet,
        width_px: u32,
    ) -> Self {
        let surfaces = &references(surfaces)[..];
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        let of = |view: &View| is_covered(surfaces, &camera_of(view), width_px, alpha);
        Self::new(width_px, views.views().par_iter().map(of).collect())
    }

    pub(crate) fn new(width_px: u32, views: Vec<Vec<bool>>) -> Self {
        assert!(width_px > 0);
        Self { width_px, views }
    }

    /// Pixels that show it, of all views together.
    pub fn covered_px(&self) -> usize {
        self.views.iter().flatten().filter(|is| **is).count()
    }

    /// Islands of up to 3 pixels in a view.
    pub fn specks_per_view(&self) -> f64 {
        let of_view = |view: &Vec<bool>| specks(view, self.width_px as usize);
        let sum: usize = self.views.iter().map(of_view).sum();
        sum as f64 / self.views.len().max(1) as f64
    }

    /// The outlines in pictures that are `step` times smaller: of each square of `step` x `step` pixels
    /// only the middle one.
    ///
    /// # Panics
    /// If the width is no multiple of `step`.
    pub fn every(&self, step: u32) -> Self {
        assert!(self.width_px.is_multiple_of(step));
        let (width, step) = (self.width_px as usize, step as usize);
        let of_view = |view: &Vec<bool>| {
            let rows = view.chunks(width).skip(step / 2).step_by(step);
            let of_row = |row: &[bool]| -> Vec<bool> {
                row.iter().skip(step / 2).step_by(step).copied().collect()
            };
            rows.flat_map(of_row).collect()
        };
        Self {
            width_px: self.width_px / step as u32,
            views: self.views.iter().map(of_view).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_pixels_show_the_same_in_small() {
        // A square of 6 x 6 of 12 pixels, and a pixel by itself.
        let is = |k: usize| (k / 12 < 6 && k % 12 < 6) || k == 10 * 12 + 10;
        let all = Outlines::new(12, vec![(0..144).map(is).collect()]);
        assert_eq!((all.covered_px(), all.specks_per_view()), (37, 1.0));
        let some = all.every(3);
        assert_eq!(
            some.covered_px(),
            2 * 2 + 1,
            "pixels in the middle of three"
        );
        assert_eq!(some.width_px, 4);
        // One pixel of the square, and the one by itself.
        assert_eq!(all.every(4).covered_px(), 2);
    }
}
