//! How far the background's terms have moved since an epoch.
//!
//! A [drift](super::super::changes::BackgroundDrift) holds for any leaf, since
//! any step, and allows for the rounding of every logarithm, which is most of
//! it. Blocks near the least cost were evaluated a few steps ago, and their
//! leaves would hand few pixels to the background: for those, the very terms of
//! then and now are compared.

use std::ops::Range;

use super::super::counts::{Counts, GAINS};
use super::super::switches::{Mechanism, is_on};
use super::epochs::EPOCHS;

/// Pixels handed to the background for which its rise is known by epoch.
const RISES_KEPT: usize = 64;

/// Views that are looked at together.
const VIEWS_AT_ONCE: usize = 8;

type Views = [f32; VIEWS_AT_ONCE];

/// The background of the last [`EPOCHS`] steps.
pub(super) struct Background {
    views: usize,
    current: usize,
    /// By epoch, then view, in pixels.
    areas: Vec<u32>,
    /// By epoch, then `VIEWS_AT_ONCE` views, then pixels.
    gains: Vec<[Views; GAINS]>,
    /// By pixels: how far rounding to 24 bits may have put two of them, each
    /// summed over the views, from each other.
    gains_rounding: [f32; GAINS],
    /// By epoch, then pixels.
    rises: Vec<[u32; RISES_KEPT]>,
    lg_totals: [i64; EPOCHS],
    /// Now, in pixels.
    total: f32,
    moved: Vec<Moved>,
}

/// Between an epoch and now, over all views; NAN while nobody asked.
#[derive(Clone, Copy)]
struct Moved {
    /// For leaves that reveal up to one, two, ... pixels in a view.
    by_gains: [f32; GAINS],
    /// Of the areas, in pixels.
    areas: f32,
}

impl Moved {
    const UNKNOWN: Self = Self {
        by_gains: [f32::NAN; GAINS],
        areas: f32::NAN,
    };
}

impl Background {
    /// As if it had always been as it is.
    pub(super) fn new(counts: &Counts<'_>) -> Self {
        let views = counts.view_count();
        let mut background = Self {
            views,
            current: 0,
            areas: vec![0; EPOCHS * views],
            gains: vec![[[0.0; VIEWS_AT_ONCE]; GAINS]; EPOCHS * views.div_ceil(VIEWS_AT_ONCE)],
            gains_rounding: [0.0; GAINS],
            rises: vec![[0; RISES_KEPT]; EPOCHS],
            lg_totals: [0; EPOCHS],
            total: 0.0,
            moved: vec![Moved::UNKNOWN; EPOCHS],
        };
        for epoch in (0..EPOCHS).rev() {
            background.begin(epoch, counts);
        }
        background
    }

    /// Notes how it is in a new epoch.
    pub(super) fn begin(&mut self, epoch: usize, counts: &Counts<'_>) {
        let views = epoch * self.views..(epoch + 1) * self.views;
        self.areas[views].copy_from_slice(counts.areas(0));
        self.gains_rounding = [0.0; GAINS];
        let groups = self.views.div_ceil(VIEWS_AT_ONCE);
        let own = &mut self.gains[epoch * groups..][..groups];
        let gains = counts.background_gains().chunks(VIEWS_AT_ONCE);
        for (own, gains) in own.iter_mut().zip(gains) {
            for (view, gains) in gains.iter().enumerate() {
                for k in 0..GAINS {
                    let gain = gains[k] as f32;
                    own[k][view] = gain;
                    // Gains grow with the pixels.
                    self.gains_rounding[k] += gain * (2.0 * f32::EPSILON);
                }
            }
        }
        counts.background_rises(&mut self.rises[epoch]);
        self.lg_totals[epoch] = counts.target(0).lg_total;
        self.total = counts.target(0).total as f32;
        self.current = epoch;
        self.moved.fill(Moved::UNKNOWN);
    }

    /// The change since an epoch, summed over the views without signs, of what
    /// the views in which a leaf reveals the background gain: of any leaf that
    /// reveals up to `most` pixels in a view and up to `px` in all. Infinite
    /// where that is not known.
    #[inline]
    pub(super) fn moved_by_gains(&mut self, epoch: usize, most: u32, px: u32) -> f32 {
        if most == 0 || epoch == self.current {
            return 0.0;
        }
        if most as usize > GAINS || !is_on(Mechanism::BackgroundCompared) {
            return f32::INFINITY;
        }
        let most = most as usize;
        if self.moved[epoch].by_gains[most - 1].is_nan() {
            self.moved[epoch].by_gains = self.compare_gains(epoch, most);
        }
        let lg_moved = self.lg_totals[self.current] - self.lg_totals[epoch];
        // Either logarithm of the total with a leaf's pixels may be off by 1.2.
        let lg_moved = lg_moved.unsigned_abs() as f32 + 5.0;
        self.moved[epoch].by_gains[most - 1] + px as f32 * lg_moved
    }

    /// For up to `most` pixels; NAN beyond.
    fn compare_gains(&self, epoch: usize, most: usize) -> [f32; GAINS] {
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideBackground) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.compare_gains_by_avx2(epoch, most) };
        }
        self.compare_gains_plainly(epoch, most)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn compare_gains_by_avx2(&self, epoch: usize, most: usize) -> [f32; GAINS] {
        self.compare_gains_plainly(epoch, most)
    }

    #[inline(always)]
    fn compare_gains_plainly(&self, epoch: usize, most: usize) -> [f32; GAINS] {
        let most = most.min(GAINS);
        let groups = self.views.div_ceil(VIEWS_AT_ONCE);
        let then = &self.gains[epoch * groups..][..groups];
        let now = &self.gains[self.current * groups..][..groups];
        let mut sums = [[0.0; VIEWS_AT_ONCE]; GAINS];
        for (then, now) in then.iter().zip(now) {
            // The largest up to each.
            let mut moved = [0.0; VIEWS_AT_ONCE];
            for k in 0..most {
                for view in 0..VIEWS_AT_ONCE {
                    let other = (now[k][view] - then[k][view]).abs();
                    moved[view] = if other > moved[view] {
                        other
                    } else {
                        moved[view]
                    };
                    sums[k][view] += moved[view];
                }
            }
        }
        let mut all = [f32::NAN; GAINS];
        for k in 0..most {
            all[k] = (self.gains_rounding[k] + sum(&sums[k])) * (1.0 + 1e-5);
        }
        all
    }

    /// The change since an epoch, summed over the views without signs, of what
    /// the background's growing total takes away: of any leaf that reveals a
    /// number of pixels in a range. Infinite where that is not known.
    #[inline]
    pub(super) fn moved_by_rise(&mut self, epoch: usize, least_px: u32, largest_px: u32) -> f32 {
        if largest_px == 0 || epoch == self.current {
            return 0.0;
        }
        if largest_px as usize >= RISES_KEPT || !is_on(Mechanism::BackgroundCompared) {
            return f32::INFINITY;
        }
        if self.moved[epoch].areas.is_nan() {
            self.moved[epoch].areas = self.compare_areas(epoch);
        }
        self.compare_rises(epoch, least_px as usize..largest_px as usize + 1) * (1.0 + 1e-5)
    }

    fn compare_rises(&self, epoch: usize, px: Range<usize>) -> f32 {
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideBackground) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.compare_rises_by_avx2(epoch, px) };
        }
        self.compare_rises_plainly(epoch, px)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn compare_rises_by_avx2(&self, epoch: usize, px: Range<usize>) -> f32 {
        self.compare_rises_plainly(epoch, px)
    }

    #[inline(always)]
    fn compare_rises_plainly(&self, epoch: usize, px: Range<usize>) -> f32 {
        let then = &self.rises[epoch][px.clone()];
        let now = &self.rises[self.current][px];
        let areas_moved = self.moved[epoch].areas;
        // Several at a time, and without closures: those would not be compiled for
        // the wider instructions.
        let whole = then.len() - then.len() % VIEWS_AT_ONCE;
        let mut largest = [0f32; VIEWS_AT_ONCE];
        for at in (0..whole).step_by(VIEWS_AT_ONCE) {
            let then: &[u32; VIEWS_AT_ONCE] =
                then[at..at + VIEWS_AT_ONCE].try_into().expect("so many");
            let now: &[u32; VIEWS_AT_ONCE] =
                now[at..at + VIEWS_AT_ONCE].try_into().expect("so many");
            for k in 0..VIEWS_AT_ONCE {
                // They fit 31 bits, and signed numbers are what vector instructions
                // convert.
                let rise = now[k].abs_diff(then[k]) as i32 as f32;
                let moved = rise * self.total + then[k] as i32 as f32 * areas_moved;
                largest[k] = if moved > largest[k] {
                    moved
                } else {
                    largest[k]
                };
            }
        }
        for at in whole..then.len() {
            let rise = now[at].abs_diff(then[at]) as f32;
            let moved = rise * self.total + then[at] as f32 * areas_moved;
            largest[0] = if moved > largest[0] {
                moved
            } else {
                largest[0]
            };
        }
        let mut most = 0f32;
        for moved in largest {
            most = if moved > most { moved } else { most };
        }
        most
    }

    fn compare_areas(&self, epoch: usize) -> f32 {
        let then = &self.areas[epoch * self.views..][..self.views];
        let now = &self.areas[self.current * self.views..][..self.views];
        let moved = then.iter().zip(now).map(|(then, now)| now.abs_diff(*then));
        moved.sum::<u32>() as f32
    }
}

#[inline(always)]
fn sum(views: &Views) -> f32 {
    let mut halves = *views;
    let mut width = VIEWS_AT_ONCE / 2;
    while width > 0 {
        for k in 0..width {
            halves[k] += halves[k + width];
        }
        width /= 2;
    }
    halves[0]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::super::events::Event;
    use super::*;
    use crate::lg::LgTable;

    const VIEWS: usize = 3;

    /// Gains of the background's term, and what its total takes away, by view.
    fn terms(counts: &Counts<'_>, revealed: &[u32]) -> Vec<(i64, i64)> {
        let px = revealed.iter().sum();
        let rise = counts.background_rise(px) as i64;
        let lg_after = counts.target(0).lg_total + rise;
        let views = revealed.iter().zip(0..).zip(counts.areas(0));
        let terms = views.map(|((r, view), area)| {
            let gain = match r {
                0 => 0,
                r => counts.background_gain(view, *r) - i64::from(*r) * lg_after,
            };
            (gain, i64::from(*area) * rise)
        });
        terms.collect()
    }

    proptest! {
        #[test]
        fn terms_move_no_farther(
            covered in prop::collection::vec(1000u32..60_000, VIEWS),
            changes in prop_oneof![
                prop::collection::vec((0..VIEWS, -40i32..40), 1..30),
                prop::collection::vec((0..VIEWS, -3i32..3), 1..3),
            ],
            revealed in prop::collection::vec(0u32..=GAINS as u32, VIEWS),
        ) {
            let table = LgTable::new();
            let first: Vec<Event> = covered.iter().zip(0..).map(|(pixels, view)| Event {
                view,
                pixels: *pixels,
                before: [0, 0],
                after: [1, 0],
            }).collect();
            let mut counts = Counts::new(first.iter(), VIEWS, 1 << 16, 1, &table);
            let mut background = Background::new(&counts);
            let then = terms(&counts, &revealed);
            for (view, by) in changes {
                counts.hand_to_background(view, -by);
            }
            background.begin(1, &counts);
            let now = terms(&counts, &revealed);
            let moved = |of: fn(&(i64, i64)) -> i64| -> u64 {
                let views = then.iter().zip(&now);
                views.map(|(then, now)| of(then).abs_diff(of(now))).sum()
            };
            let (px, most) = (revealed.iter().sum(), *revealed.iter().max().unwrap());
            let by_gains = background.moved_by_gains(0, most, px);
            prop_assert!(f64::from(by_gains) >= moved(|t| t.0) as f64, "{by_gains}");
            let by_rise = background.moved_by_rise(0, px, px);
            prop_assert!(f64::from(by_rise) >= moved(|t| t.1) as f64, "{by_rise}");
        }
    }
}
