//! Sizes of the leaves that are left, fitted to what the original shows.
//!
//! Whatever chose the leaves gave each its size one step at a time. What it came to
//! is seen at the end only: some stick out of the crown where another would have
//! closed the same gap unseen, and the crown is thin here and too dense there. So each leaf
//! is tried a little larger and a little smaller, and takes the size that makes an
//! [`Objective`] least: the coverage of small blocks of the views, which is what looks best
//! (`coverage.rs`), or the outline pixel by pixel and the information (`information.rs`).
//!
//! Leaves are tried a few at a time, far from each other in the order of the leaves,
//! against what the others of them were. The objective itself is counted after each batch,
//! and what made it worse is undone.
//!
//! A size must be better by more than chance: of n pixels that a leaf covers more or less
//! as many are right as wrong but for about the root of n, and in proportion to that it has
//! to gain. Else small leaves would fit the pixels of these views, and of no others.

mod coverage;
mod information;
mod ledger;
mod rounds;
mod screen;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use rayon::prelude::*;
use secateur_model::{Foliage, Lod};
use secateur_raster::{LeafIdImage, Scene, View, ViewSet, cpu};

use self::coverage::Coverage;
use self::information::Information;
use self::rounds::{Trial, fit_in_rounds};

/// The largest weight of the outline: there VMI counts for next to nothing.
pub const MAX_OUTLINE_WEIGHT: f64 = 100.0;

/// The weight of the outline that loses least information.
pub const DEFAULT_OUTLINE_WEIGHT: f64 = 0.95;

/// What sizes are fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Objective {
    /// The number of pixels that show foliage in each block of 8 x 8 pixels of the images, and in
    /// all.
    Coverage,
    /// The outline pixel by pixel, and the VMI of each view.
    Information {
        /// What a pixel of outline counts, in bits of VMI times pixels: from 0 to
        /// [`MAX_OUTLINE_WEIGHT`].
        outline_weight: f64,
    },
}

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
    /// What should be least.
    pub objective: Objective,
}

impl<'a> Fit<'a> {
    /// What `of` makes of each view and the original's leaf IDs in it; the views in the order of
    /// their sets.
    fn of_views<T: Send>(&self, of: impl Fn(&'a View, LeafIdImage) -> T + Sync) -> Vec<T> {
        let lod = Lod::original(self.original.leaves().len());
        let sets = self.views.iter();
        let views: Vec<_> = sets
            .flat_map(|set| set.views().iter().map(move |view| (set, view)))
            .collect();
        let drawn = views.par_iter().map(|&(views, view)| {
            let scene = Scene {
                foliage: self.original,
                lod: &lod,
                views,
                resolution: self.resolution,
            };
            of(view, cpu::draw_leaf_ids(&scene, view))
        });
        drawn.collect()
    }
}

/// Leaf by leaf the factor of its area that fits best (see the module).
///
/// A round over all leaves takes about the time of drawing them in all views three times,
/// and those that change, or are changed back, twice more; there are three, and at most seven
/// over fewer leaves, on the threads of the current rayon pool, with the same result for any
/// number of them. Memory for [`Objective::Coverage`]: 5 bytes a pixel over all views, and 64 a
/// view and leaf of a batch; for [`Objective::Information`] about 25 bytes a pixel over all
/// views, 8 to 16 a fragment, 12 a view and leaf that is left, and while it begins 8 a view and
/// original leaf. `progress` gets, after every few leaves, the number tried and that of those to
/// be tried at most, which gets smaller, and may break off.
///
/// # Panics
/// If there is no view, or a set of none, or the resolution, the pixels or the weight are out of range.
pub fn fit(
    fit: &Fit<'_>,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> ControlFlow<(), Vec<f64>> {
    let is_seen = fit.views.iter().all(|set| !set.is_empty());
    assert!(is_seen && !fit.views.is_empty(), "at least one view");
    match fit.objective {
        Objective::Coverage => fitted(Coverage::new(fit), progress),
        Objective::Information { outline_weight } => {
            assert!((0.0..=MAX_OUTLINE_WEIGHT).contains(&outline_weight));
            fitted(Information::new(fit, outline_weight), progress)
        }
    }
}

fn fitted(
    mut trial: impl Trial,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> ControlFlow<(), Vec<f64>> {
    fit_in_rounds(&mut trial, progress)?;
    ControlFlow::Continue(trial.scales().to_vec())
}
