//! Sizes of the leaves that are left, fitted to the outline and the information of
//! the original.
//!
//! Whatever chose the leaves gave each its size one step at a time. What it came to
//! is seen at the end only: some stick out of the crown where another would have
//! closed the same gap unseen, and the information that is missing is missing in every
//! view. So each leaf is tried a little larger and a little smaller, and takes the
//! size at which
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
//! Leaves are tried a few at a time, far from each other in the order of the leaves,
//! against what the others of them were. What a size would do to the outline is counted
//! exactly; to the information, for the leaf itself exactly, for those from which it
//! takes pixels to the first order, all of it put down to the view where it happens. J
//! itself is counted after each few, and what made it worse is undone.
//!
//! Where the two look the same, to half a hundredth of the outline and of the information,
//! none is tried.
//!
//! A size must be better by more than chance: of n pixels that a leaf covers more or less
//! as many are right as wrong but for about the root of n, and so many it has to gain,
//! each counted as one of outline or a bit, whichever is more. Else small leaves would fit
//! the pixels of these views, and of no others.

mod ledger;
mod screen;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use rayon::prelude::*;
use secateur_model::{Foliage, LeafId, Lod};
use secateur_raster::{Scene, ViewSet, cpu};

use self::ledger::Ledger;
use self::screen::{Change, Screen, Seen};
use crate::lg::LG_FRACTION_BITS;

/// The largest weight of the outline: there VMI counts for next to nothing.
pub const MAX_OUTLINE_WEIGHT: f64 = 100.0;

/// The weight of the outline that serves most crowns.
pub const DEFAULT_OUTLINE_WEIGHT: f64 = 0.95;

/// By what areas are multiplied and divided in the rounds, each about the root of the one
/// before. The first is repeated while it pays, with those leaves that took another size.
const FACTORS: [f64; 3] = [2.0, 1.4, 1.2];

/// The first factor is tried again if it took one part in so many of J away.
const PAYS: i128 = 10;

/// But in no more rounds: all together make no leaf more than 431 times as large.
const MOST_ROUNDS: usize = 8;

/// Sizes stay where outlines differ by no more than one pixel in so many, and views tell as
/// much: there is next to nothing to be had.
const SAME: u64 = 200;

/// Leaves that are tried at a time.
const BATCH: usize = 64;

/// But of few leaves fewer, so that a round has so many batches: leaves of one do not see
/// each other's changes.
const BATCHES_AT_LEAST: usize = 16;

/// What is fitted to what.
#[derive(Clone, Copy)]
pub struct Fit<'a> {
    /// The foliage that should be seen.
    pub original: &'a Foliage,
    /// The leaves that are left of it, at the sizes that they have.
    pub left: &'a Foliage,
    /// Where they are looked at from: VMI is that of each set, of which each view is looked
    /// at by itself. It depends on how many views a set has.
    pub views: &'a [ViewSet],
    /// Image width and height in pixels.
    pub resolution: u32,
    /// What a pixel of outline counts, in bits of VMI times pixels: from 0 to
    /// [`MAX_OUTLINE_WEIGHT`].
    pub outline_weight: f64,
}

/// Leaf by leaf the factor of its area that fits best (see the module).
///
/// A round over all leaves takes about the time of drawing them in all views three times,
/// and those that change, or are changed back, twice more; there are three, and at most seven
/// over fewer leaves, on the threads of the current rayon pool, with the same result for any
/// number of them. Memory: about 25 bytes a pixel over all views, 8 to 16 a fragment, 12 a view and
/// leaf that is left, and while it begins 8 a view and original leaf. `progress` gets, after
/// every few leaves, the number tried and that of those to be tried at most, which gets
/// smaller, and may break off.
///
/// # Panics
/// If there is no view, or a set of none, or the resolution, the pixels or the weight are out of range.
pub fn fit(
    fit: &Fit<'_>,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> ControlFlow<(), Vec<f64>> {
    let is_seen = fit.views.iter().all(|set| !set.is_empty());
    assert!(is_seen && !fit.views.is_empty(), "at least one view");
    assert!((0.0..=MAX_OUTLINE_WEIGHT).contains(&fit.outline_weight));
    let mut stage = Stage::new(fit);
    if stage.shows_the_same() {
        return ControlFlow::Continue(stage.scales);
    }
    let all: Vec<usize> = (0..stage.scales.len()).collect();
    let mut done = 0;
    for (k, factor) in FACTORS.into_iter().enumerate() {
        let later = (FACTORS.len() - 1 - k) * all.len();
        let rounds = if k == 0 { MOST_ROUNDS } else { 1 };
        let mut tried = all.clone();
        for left in (0..rounds).rev() {
            let before = stage.objective();
            let scales = stage.scales.clone();
            let at_most = done + (left + 1) * tried.len() + later;
            stage.round(&tried, factor, &mut |leaves| {
                done += leaves;
                progress(done, at_most)
            })?;
            if (before - stage.objective()) * PAYS <= before {
                break;
            }
            tried.retain(|&leaf| stage.scales[leaf] != scales[leaf]);
        }
    }
    ControlFlow::Continue(stage.scales)
}

/// A bit of VMI times a pixel, scaled.
const ONE_BIT: i64 = 1 << LG_FRACTION_BITS;

/// By how many pixels a size must be better than what a leaf has, as the
/// views saw both: the root of those that only one of the two covers.
fn chance_px(seen: &[&[Seen; 3]], size: usize) -> u32 {
    let changed_px = seen.iter().map(|view| view[size].changed_px);
    changed_px.sum::<u32>().isqrt()
}

/// The views and what is counted in them.
struct Stage<'a> {
    left: &'a Foliage,
    screens: Vec<Screen<'a>>,
    ledger: Ledger,
    /// Factors of area, leaf by leaf.
    scales: Vec<f64>,
    /// What a pixel of outline counts, scaled as VMI is.
    outline_unit: i64,
}

impl<'a> Stage<'a> {
    fn new(fit: &Fit<'a>) -> Self {
        let original = Lod::original(fit.original.leaves().len());
        let count = fit.left.leaves().len();
        let sets = fit.views.iter();
        let views: Vec<_> = sets
            .flat_map(|set| set.views().iter().map(move |view| (set, view)))
            .collect();
        let screens = views.par_iter().map(|&(views, view)| {
            let scene = Scene {
                foliage: fit.original,
                lod: &original,
                views,
                resolution: fit.resolution,
            };
            let image = cpu::draw_leaf_ids(&scene, view);
            let mut screen = Screen::new(view, &image);
            screen.draw(fit.left);
            let areas_px = screen.areas_px(count);
            (
                screen,
                (cpu::histogram(&image, original.leaf_count()), areas_px),
            )
        });
        let (screens, areas_px): (Vec<Screen<'_>>, Vec<_>) = screens.unzip();
        let (original_px, left_px): (Vec<_>, Vec<_>) = areas_px.into_iter().unzip();
        let set_lengths: Vec<usize> = fit.views.iter().map(ViewSet::len).collect();
        Self {
            left: fit.left,
            screens,
            ledger: Ledger::new(&set_lengths, &original_px, left_px),
            scales: vec![1.0; count],
            outline_unit: (fit.outline_weight * ONE_BIT as f64) as i64,
        }
    }

    /// Whether no size is to be sought.
    fn shows_the_same(&self) -> bool {
        let outline_px: u64 = self.screens.iter().map(|s| u64::from(s.outline_px())).sum();
        self.outline_error_px() * SAME <= outline_px && self.ledger.tells_as_much()
    }

    /// Pixels, over all views, that show foliage in only one of the two.
    fn outline_error_px(&self) -> u64 {
        let screens = self.screens.iter();
        screens.map(|s| u64::from(s.outline_error_px())).sum()
    }

    /// J, scaled.
    fn objective(&self) -> i128 {
        i128::from(self.outline_error_px()) * i128::from(self.outline_unit) + self.ledger.cost()
    }

    /// Tries each of these leaves once.
    fn round(
        &mut self,
        leaves: &[usize],
        factor: f64,
        progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let count = leaves.len();
        let size = (count / BATCHES_AT_LEAST).clamp(1, BATCH);
        let stride = count.div_ceil(size);
        for first in 0..stride {
            let members: Vec<usize> = leaves.iter().copied().skip(first).step_by(stride).collect();
            self.try_batch(&members, factor);
            progress(members.len())?;
        }
        ControlFlow::Continue(())
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
                let chance = i128::from(chance_px(&of_leaf, size))
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

    fn change(&mut self, changes: &[Change]) {
        let left = self.left;
        let screens = self.screens.par_iter_mut();
        let moved = screens.map(|screen| screen.change(left, changes));
        self.ledger.apply(&moved.collect::<Vec<_>>());
        for change in changes {
            self.scales[change.leaf.index()] = change.to;
        }
    }
}
