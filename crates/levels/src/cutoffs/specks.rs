//! How many specks a crown may show that is read without mip maps.

use secateur_eval::{MipMaps, Outlines, Strengths};
use secateur_model::Surface;
use secateur_raster::ViewSet;

/// How many specks a view a level may show beyond the original.
const MOST_MORE: f64 = 2.0;

/// Pixels that a client shows of an original, over those that it truly covers, if it shows it well. With fewer
/// the original has faded, with more its holes have closed, and its specks have gone with them.
const SHOWN_WELL: [f64; 2] = [0.9, 1.05];

/// Pixels that a client shows of a level with mip maps and the best cutoffs, over the truth, if it is tolerable: a crown that vanishes or
/// closes is worse than one with specks.
const TOLERABLE: [f64; 2] = [0.5, 1.1];

/// The most specks without mip maps over those that there truly are: leaves that got larger or moved show
/// others, and alpha between texels is mixed, which the truth does not do.
const OVER_TRUTH: f64 = 1.25;

/// The most specks over those that there truly are, and how many more, where the level with mip maps is not tolerable.
const OVER_TRUTH_AT_WORST: f64 = 1.5;
const MOST_MORE_AT_WORST: f64 = 4.0;

/// Whether a level that covers this share of the truth with mip maps could stay so.
pub(super) fn is_tolerable(coverage: f64) -> bool {
    (TOLERABLE[0]..=TOLERABLE[1]).contains(&coverage)
}

/// An original as a client draws it.
pub(super) struct DrawnOriginal<'a> {
    surfaces: &'a [&'a Surface],
    views: &'a ViewSet,
    mips: MipMaps,
    /// Whether the level with mip maps is tolerable at all sizes.
    is_level_tolerable: bool,
}

impl<'a> DrawnOriginal<'a> {
    pub(super) fn new(
        surfaces: &'a [&'a Surface],
        views: &'a ViewSet,
        is_level_tolerable: bool,
    ) -> Self {
        Self {
            surfaces,
            views,
            mips: MipMaps::of_cut_outs(surfaces),
            is_level_tolerable,
        }
    }

    /// The most specks a view that a level without mip maps may show in pictures of `width_px` x `width_px`
    /// pixels, of an original that truly covers `truth` there. Where the level with mip maps is tolerable, two more than
    /// a client shows of the original, if it shows that well, or than a quarter above the truth's; else at least four more
    /// than half above the truth's.
    pub(super) fn most_specks(&self, truth: &Outlines, width_px: u32) -> f64 {
        let all = Strengths::new(
            self.surfaces,
            |_| false,
            self.views,
            width_px,
            1.0,
            &self.mips,
        );
        let drawn = all.shown(1.0);
        let coverage = drawn.covered_px() as f64 / truth.covered_px() as f64;
        let is_shown_well = (SHOWN_WELL[0]..=SHOWN_WELL[1]).contains(&coverage);
        let specks = match is_shown_well {
            true => drawn.specks_per_view(),
            false => truth.specks_per_view() * OVER_TRUTH,
        };
        let most = specks + MOST_MORE;
        match self.is_level_tolerable {
            true => most,
            false => most.max(truth.specks_per_view() * OVER_TRUTH_AT_WORST + MOST_MORE_AT_WORST),
        }
    }
}
