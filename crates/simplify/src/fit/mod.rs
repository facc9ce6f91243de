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
mod outlined_view;
mod price;
mod rounds;
mod sized_view;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use rayon::prelude::*;
use secateur_model::{Budget, Foliage, Lod, OverMemory, Remedy};
use secateur_raster::cpu::{draw_leaf_ids, draw_leaf_ids_among};
use secateur_raster::occluders::Occlusion;
use secateur_raster::{
    CpuRasteriser, LeafIdImage, Rasteriser, Scene, TooManyFragments, View, ViewSet,
};

use self::coverage::{Coverage, is_covered_alike};
use self::information::Information;
use self::rounds::{Trial, fit_in_rounds};
use self::sized_view::SizedView;
use crate::lg::LgTable;
use crate::memory::Room;

/// Why the CPU is not asked whether it can draw.
const DRAWN: &str = "the CPU draws whatever there is memory for";

/// The largest weight of the outline: there VMI counts for next to nothing.
pub const MAX_OUTLINE_WEIGHT: f64 = 100.0;

/// The weight of the outline of a fit that is asked for without one.
pub const DEFAULT_OUTLINE_WEIGHT: f64 = 0.95;

/// The weight of the outline in [`Preset::Information`](crate::Preset::Information): less information is lost, and more of
/// the outline (`benches/judges.rs`; a bush at a tenth of its leaves: VMI error of the worst of four
/// judges 6.6 instead of 8.0 %, IoU .449 instead of .464).
pub const INFORMATION_OUTLINE_WEIGHT: f64 = 0.3;

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
    /// What hides leaves, if anything does.
    pub occluders: Option<&'a Foliage>,
}

impl<'a> Fit<'a> {
    /// What `of` makes of each view of what is left, of its number in its set, and of the
    /// original's leaf IDs in it; by set.
    fn of_views<T: Send>(
        &self,
        budget: &mut Budget,
        originals: Option<&DrawnOriginals>,
        of: impl Fn(SizedView<'a>, usize, &LeafIdImage) -> T + Sync,
    ) -> Result<Vec<Vec<T>>, OverMemory> {
        let all_left = Lod::original(self.left.leaves().len());
        let all = Lod::original(self.original.leaves().len());
        let of_set = |(set, views): (usize, &'a ViewSet)| {
            let left = self.scene(self.left, &all_left, views);
            let original = self.scene(self.original, &all, views);
            let room = Room::for_lists(budget, &left, FIT_NOT)?;
            let fragments = CpuRasteriser.fragments_within(&left, room.most());
            let fragments = fragments.map_err(|error| {
                let too_many = error.downcast::<TooManyFragments>().expect(DRAWN);
                room.lacks(&too_many, &left)
            })?;
            // Fragments of one set stay while the others are looked at.
            *budget = room.after(fragments.len() as u64)?;
            let fragments = fragments.into_views();
            let views = fragments.into_par_iter().zip(views.views()).enumerate();
            let made = views.map(|(number, (fragments, view))| {
                let known = originals.map(|originals| &originals.sets[set][number]);
                let own_occlusion = match known {
                    Some(_) => None,
                    None => self.occlusion(view),
                };
                let occlusion =
                    known.map_or(own_occlusion.as_ref(), |known| known.occlusion.as_ref());
                let fragments = match occlusion {
                    Some(occlusion) => occlusion.cut(&fragments),
                    None => fragments,
                };
                let hiding = occlusion.map_or(&[][..], std::slice::from_ref);
                let sized = SizedView::new(self.left, view, fragments, hiding, self.resolution);
                match known {
                    Some(known) => of(sized, number, &known.leaf_ids),
                    None => of(sized, number, &leaf_ids(&original, view, occlusion)),
                }
            });
            Ok(made.collect())
        };
        self.views.iter().enumerate().map(of_set).collect()
    }

    fn scene<'s>(&self, foliage: &'s Foliage, lod: &'s Lod, views: &'s ViewSet) -> Scene<'s> {
        Scene {
            foliage,
            lod,
            views,
            resolution: self.resolution,
        }
    }

    /// What hides leaves in a view.
    fn occlusion(&self, view: &View) -> Option<Occlusion> {
        let occluders = self.occluders?;
        Some(Occlusion::of(occluders, view, self.resolution))
    }

    /// Whether what is left covers the views as the original does, so that no size is to be sought.
    fn covers_alike(&self, originals: &DrawnOriginals) -> bool {
        let all_left = Lod::original(self.left.leaves().len());
        let pairs = self.views.par_iter().zip(&originals.sets);
        let pairs = pairs.flat_map(|(views, originals)| {
            let scene = self.scene(self.left, &all_left, views);
            let pairs = views.views().par_iter().zip(originals);
            let drawn = pairs.map(|(view, original)| {
                let left = leaf_ids(&scene, view, original.occlusion.as_ref());
                (&original.leaf_ids, left)
            });
            drawn.collect::<Vec<_>>()
        });
        is_covered_alike(pairs)
    }

    /// The original in all views, unless that would take more than [`MOST_SHARED_BYTES`].
    fn draw_originals(&self) -> Option<DrawnOriginals> {
        let views: u64 = self.views.iter().map(|set| set.len() as u64).sum();
        let bytes_a_pixel = 4 + 4 * u64::from(self.occluders.is_some());
        if bytes_a_pixel * views * u64::from(self.resolution).pow(2) > MOST_SHARED_BYTES {
            return None;
        }
        let all = Lod::original(self.original.leaves().len());
        let of_set = |views: &ViewSet| {
            let scene = self.scene(self.original, &all, views);
            let drawn = views.views().par_iter().map(|view| {
                let occlusion = self.occlusion(view);
                DrawnOriginal {
                    leaf_ids: leaf_ids(&scene, view, occlusion.as_ref()),
                    occlusion,
                }
            });
            drawn.collect()
        };
        Some(DrawnOriginals {
            views: self.views.to_vec(),
            resolution: self.resolution,
            sets: self.views.iter().map(of_set).collect(),
        })
    }
}

fn leaf_ids(scene: &Scene<'_>, view: &View, occlusion: Option<&Occlusion>) -> LeafIdImage {
    match occlusion {
        Some(occlusion) => draw_leaf_ids_among(scene, view, occlusion),
        None => draw_leaf_ids(scene, view),
    }
}

/// The most that is kept of an original from fit to fit.
const MOST_SHARED_BYTES: u64 = 32 << 20;

/// An original in the views in which sizes are fitted: fits of several levels of one plant share it.
#[derive(Clone, Debug)]
pub struct DrawnOriginals {
    views: Vec<ViewSet>,
    resolution: u32,
    sets: Vec<Vec<DrawnOriginal>>,
}

/// An original in one view: 4 bytes a pixel, and 4 more among occluders.
#[derive(Clone, Debug)]
struct DrawnOriginal {
    leaf_ids: LeafIdImage,
    /// What hides leaves there; nothing without occluders.
    occlusion: Option<Occlusion>,
}

impl DrawnOriginals {
    /// Whether these are what a fit would draw of the same original among the same occluders.
    fn is_for(&self, fit: &Fit<'_>) -> bool {
        self.resolution == fit.resolution && self.views == fit.views
    }
}

/// What to do where a fit takes too much memory.
const FIT_NOT: Remedy = Remedy::NoFit;

/// Leaf by leaf the factor of its area that fits best (see the module).
///
/// A round over all leaves takes about the time of drawing them in all views twice,
/// and those that change once more; there are three, and at most seven
/// over fewer leaves, on the threads of the current rayon pool, with the same result for any
/// number of them. Memory: 13 bytes a pixel over all views, 12 to 20 a fragment of what is left,
/// 9 a view and leaf that is left; for [`Objective::Information`] 4 more of these, and while it
/// begins 8 a view and original leaf. `progress` gets, after every few leaves, the number tried and that of those to
/// be tried at most, which gets smaller, and may break off.
///
/// # Panics
/// If there is no view, or a set of none, or the resolution, the pixels or the weight are out of range.
pub fn fit(
    fit: &Fit<'_>,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> ControlFlow<(), Vec<f64>> {
    match fit_within(fit, Budget::unlimited(), None, progress) {
        Ok(factors) => factors,
        Err(over) => unreachable!("nothing is too much: {over}"),
    }
}

/// [`fit`], with this much memory. `originals` are those that an earlier fit of coverage of the same
/// original among the same occluders drew, and then those of this one.
///
/// # Errors
/// [`OverMemory`] if what the views show takes more.
///
/// # Panics
/// As [`fit`].
pub fn fit_within(
    fit: &Fit<'_>,
    mut budget: Budget,
    originals: Option<&mut Option<DrawnOriginals>>,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<ControlFlow<(), Vec<f64>>, OverMemory> {
    let is_seen = fit.views.iter().all(|set| !set.is_empty());
    assert!(is_seen && !fit.views.is_empty(), "at least one view");
    match fit.objective {
        Objective::Coverage => {
            let originals = originals.and_then(|originals| {
                let known = originals.take().filter(|known| known.is_for(fit));
                *originals = known.or_else(|| fit.draw_originals());
                originals.as_ref()
            });
            if originals.is_some_and(|originals| fit.covers_alike(originals)) {
                return Ok(ControlFlow::Continue(vec![1.0; fit.left.leaves().len()]));
            }
            let coverage = Coverage::new(fit, &mut budget, originals)?;
            Ok(fitted(coverage, progress))
        }
        Objective::Information { outline_weight } => {
            assert!((0.0..=MAX_OUTLINE_WEIGHT).contains(&outline_weight));
            let table = LgTable::new();
            let information = Information::new(fit, outline_weight, &table, &mut budget)?;
            Ok(fitted(information, progress))
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
