//! Sizes fitted to the outline and the information of the original.
//!
//! A leaf takes the size at which
//!
//! ```text
//! J = w sum_v X_v + sum_v max(0, D_v - P I(v;F) / 400) + 3 max(0, sum_v D_v - L)
//! D_v = P |I(v;F') - I(v;F)|
//! L = max(sum_v P I(v;F) / 10, sum_v D_v before the fit)
//! ```
//!
//! is least, where `X_v` are the pixels of view v that show foliage in only one of the
//! two, F being the original and F' what is left, I the VMI in bits, P the pixels of a
//! view, and w the weight of the outline. A quarter of a hundredth of a view's information
//! is free: other views differ by more. And outlines do not cost information without end: above a
//! tenth of it, or what was missing before, it counts four times. All of it is integers, so
//! the sizes are the same on every machine.
//!
//! What a size would do to the outline is counted exactly; to the information, for the leaf
//! itself exactly, for those from which it takes pixels to the first order, all of it put
//! down to the view where it happens. J itself is counted after each batch.
//!
//! Where the two look the same, to half a hundredth of the outline and of the information,
//! none is tried.

use rayon::prelude::*;
use secateur_model::{Foliage, LeafId};
use secateur_raster::{ViewSet, cpu};

use super::Fit;
use super::ledger::Ledger;
use super::rounds::{Trial, chance_px};
use super::screen::{Change, Screen, Seen};
use crate::lg::LG_FRACTION_BITS;

/// Sizes stay where outlines differ by at most one pixel in this number, and the views tell as much:
/// next to nothing could be gained.
const SAME: u64 = 200;

/// A bit of VMI times a pixel, scaled.
const ONE_BIT: i64 = 1 << LG_FRACTION_BITS;

/// The views and what is counted in them.
pub(super) struct Information<'a> {
    pub(super) left: &'a Foliage,
    pub(super) screens: Vec<Screen<'a>>,
    pub(super) ledger: Ledger,
    /// Factors of area, leaf by leaf.
    pub(super) scales: Vec<f64>,
    /// What a pixel of outline counts, scaled as VMI is.
    pub(super) outline_unit: i64,
}

impl<'a> Information<'a> {
    pub(super) fn new(fit: &Fit<'a>, outline_weight: f64) -> Self {
        let count = fit.left.leaves().len();
        let original_count = fit.original.leaves().len();
        let screens = fit.of_views(|view, image| {
            let mut screen = Screen::new(view, &image);
            screen.draw(fit.left);
            let areas_px = screen.areas_px(count);
            (screen, (cpu::histogram(&image, original_count), areas_px))
        });
        let (screens, areas_px): (Vec<Screen<'_>>, Vec<_>) = screens.into_iter().unzip();
        let (original_px, left_px): (Vec<_>, Vec<_>) = areas_px.into_iter().unzip();
        let set_lengths: Vec<usize> = fit.views.iter().map(ViewSet::len).collect();
        Self {
            left: fit.left,
            screens,
            ledger: Ledger::new(&set_lengths, &original_px, left_px),
            scales: vec![1.0; count],
            outline_unit: (outline_weight * ONE_BIT as f64) as i64,
        }
    }

    /// Pixels, over all views, that show foliage in only one of the two.
    fn outline_error_px(&self) -> u64 {
        let screens = self.screens.iter();
        screens.map(|s| u64::from(s.outline_error_px())).sum()
    }

    pub(super) fn change(&mut self, changes: &[Change]) {
        let left = self.left;
        let screens = self.screens.par_iter_mut();
        let moved = screens.map(|screen| screen.change(left, changes));
        self.ledger.apply(&moved.collect::<Vec<_>>());
        for change in changes {
            self.scales[change.leaf.index()] = change.to;
        }
    }
}

impl Trial for Information<'_> {
    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn is_there_nothing_to_gain(&self) -> bool {
        let outline_px: u64 = self.screens.iter().map(|s| u64::from(s.outline_px())).sum();
        self.outline_error_px() * SAME <= outline_px && self.ledger.tells_as_much()
    }

    /// J in units of 2^-27 bits times pixels.
    fn objective(&self) -> i128 {
        i128::from(self.outline_error_px()) * i128::from(self.outline_unit) + self.ledger.cost()
    }

    fn try_batch(&mut self, members: &[usize], factor: f64) {
        let Self {
            left,
            screens,
            ledger,
            scales,
            outline_unit,
        } = self;
        let sizes_of = |k: usize| [scales[k], scales[k] * factor, scales[k] / factor];
        let seen = screens.par_iter_mut().enumerate().map(|(view, screen)| {
            let values = ledger.pixel_values(view);
            let of = |&k: &usize| screen.seen(left, LeafId::from_index(k), sizes_of(k), values);
            members.iter().map(of).collect::<Vec<_>>()
        });
        let seen: Vec<Vec<[Seen; 3]>> = seen.collect();
        let choose = |(member, &k): (usize, &usize)| {
            let sizes = sizes_of(k);
            let of_leaf: Vec<&[Seen; 3]> = seen.iter().map(|view| &view[member]).collect();
            let gain = |size: usize| {
                let chance =
                    i128::from(chance_px(of_leaf.iter().map(|view| view[size].changed_px)))
                        * i128::from((*outline_unit).max(ONE_BIT));
                ledger.gain(&of_leaf, size, *outline_unit) - chance
            };
            let gains = [1, 2].map(|size| (gain(size), size));
            let (_, size) = gains.into_iter().filter(|(gain, _)| *gain > 0).max()?;
            Some(Change {
                leaf: LeafId::from_index(k),
                from: sizes[0],
                to: sizes[size],
            })
        };
        let changes = members.iter().enumerate().filter_map(choose);
        let changes: Vec<Change> = changes.collect();
        if changes.is_empty() {
            return;
        }
        let before = self.objective();
        self.change(&changes);
        if self.objective() > before {
            let back = |change: &Change| Change {
                leaf: change.leaf,
                from: change.to,
                to: change.from,
            };
            self.change(&changes.iter().map(back).collect::<Vec<_>>());
        }
    }
}
