//! How far alpha is above its cutoff in what a client draws: one drawing tells what it shows with
//! any other cutoff.

use std::borrow::Borrow;

use glam::Vec2;
use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};

use crate::lens::Lens;
use crate::mips::{MipChains, MipMaps};
use crate::outlines::Outlines;
use crate::pictures::camera_of;
use crate::point_in_triangle::{EDGE_SLACK, PointInTriangle};
use crate::screen_triangle::screen_triangles;
use crate::surface_references::references;
use crate::visibility::{Alpha, Cut, is_front, sample_range};

/// Pictures of a tree that hold, for each pixel, the greatest ratio of alpha to its cutoff among
/// all that lies there.
#[derive(Clone, Debug)]
pub struct Strengths {
    width_px: u32,
    /// For each view, row by row: 0 where nothing lies, infinite where something has no cutoff.
    views: Vec<Vec<f32>>,
}

impl Strengths {
    /// Of surfaces as a client draws them from views, in pictures of `width_px` x `width_px` pixels.
    /// Of surfaces that `is_free` does not name only what passes its test counts, as if it had no
    /// cutoff. A ratio of `enough` or more may be any such. Mip maps that are not `known` are made.
    ///
    /// # Panics
    /// If `width_px` is 0.
    pub fn new<S: Borrow<Surface> + Sync>(
        surfaces: &[S],
        is_free: impl Fn(usize) -> bool + Sync,
        views: &ViewSet,
        width_px: u32,
        enough: f32,
        known: &MipMaps,
    ) -> Self {
        let surfaces = &references(surfaces)[..];
        assert!(width_px > 0);
        let mips = MipChains::of_cut_outs(surfaces, known);
        let of_view = |view: &View| strengths(surfaces, &is_free, view, width_px, enough, &mips);
        Self {
            width_px,
            views: views.views().par_iter().map(of_view).collect(),
        }
    }

    /// What is shown with cutoffs `times` as high.
    pub fn shown(&self, times: f32) -> Outlines {
        let is_shown = |strength: &f32| *strength > 0.0 && *strength >= times;
        let of_view = |view: &Vec<f32>| view.iter().map(is_shown).collect();
        Outlines::new(self.width_px, self.views.iter().map(of_view).collect())
    }
}

fn strengths(
    surfaces: &[&Surface],
    is_free: impl Fn(usize) -> bool,
    view: &View,
    width_px: u32,
    enough: f32,
    mips: &MipChains,
) -> Vec<f32> {
    let width = width_px as usize;
    let lens = Lens::perspective(&camera_of(view), width_px, width_px);
    let mut strengths = vec![0.0; width * width];
    for triangle in screen_triangles(surfaces, &lens) {
        let number = triangle.face.surface as usize;
        let surface = surfaces[number];
        if !surface.material.double_sided && !is_front(&triangle) {
            continue;
        }
        let Some(place) = PointInTriangle::within(&triangle) else {
            continue;
        };
        let alpha = Alpha {
            mips: mips.of_surface(triangle.face.surface),
            ..Alpha::default()
        };
        let cut = Cut::of(&triangle, surface, alpha);
        let is_free = is_free(number);
        let [a, b, c] = triangle.corners.map(|corner| corner.at);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let columns = sample_range(low.x, high.x, 0..width);
        for row in sample_range(low.y, high.y, 0..width) {
            for column in columns.clone() {
                let strength: &mut f32 = &mut strengths[row * width + column];
                if *strength >= enough {
                    continue;
                }
                let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let weights = place.weights(at);
                if weights.iter().any(|weight| *weight < EDGE_SLACK) {
                    continue;
                }
                let found = cut.strength(&triangle, &place, at, weights);
                *strength = strength.max(match is_free {
                    true => found,
                    false if found >= 1.0 => f32::INFINITY,
                    false => 0.0,
                });
            }
        }
    }
    strengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AsDrawnCoverage;
    use crate::as_drawn::tests::{card_view, striped};
    use secateur_model::{AlphaMode, Mips};
    use std::sync::Arc;

    fn with_cutoff(cutoff: f32) -> Surface {
        let mut card = striped(Mips::Blended);
        Arc::make_mut(&mut card.material).alpha_mode = AlphaMode::Mask(cutoff);
        card
    }

    /// One drawing says what drawings with each cutoff show.
    #[test]
    fn cutoffs_show_what_they_would_if_drawn() {
        let views = card_view();
        let known = MipMaps::default();
        for width_px in [64, 32, 16] {
            let card = with_cutoff(0.5);
            let all = Strengths::new(&[&card], |_| true, &views, width_px, 9.0, &known);
            let drawn = AsDrawnCoverage::new(&[&card], &views, width_px, &known);
            let truth = drawn.original_shown();
            let own = all.shown(1.0).covered_px() as f64;
            for cutoff in [0.1, 0.2, 0.24, 0.3, 0.45, 0.6, 0.9] {
                let other = with_cutoff(cutoff);
                let shown = drawn.shown(&[&other], &known);
                let count = all.shown(cutoff / 0.5).covered_px() as f64;
                if own > 0.0 {
                    let ratio = shown.coverage_over_truth / truth.coverage_over_truth;
                    assert!((count / own - ratio).abs() < 1e-9, "{width_px} {cutoff}");
                }
                let nothing = shown.coverage_over_truth == 0.0;
                assert_eq!(count == 0.0, nothing, "{width_px} {cutoff}");
                assert_eq!(
                    all.shown(cutoff / 0.5).specks_per_view(),
                    shown.specks_per_view
                );
            }
        }
    }

    #[test]
    fn what_may_not_change_is_there_or_not() {
        let card = [striped(Mips::Blended)];
        let views = card_view();
        let known = MipMaps::default();
        // Four texels a pixel: a mean alpha of a quarter, where half is asked for.
        for (is_free, shown) in [(true, 16 * 16), (false, 0)] {
            let found = Strengths::new(&card, |_| is_free, &views, 16, 9.0, &known);
            assert_eq!(found.shown(0.4).covered_px(), shown);
            assert_eq!(found.shown(0.6).covered_px(), 0);
        }
    }
}
