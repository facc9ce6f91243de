//! How far the background's terms have moved since an epoch.
//!
//! A [drift](super::super::changes::BackgroundDrift) holds for any leaf, since
//! any step, and allows for the rounding of every logarithm, which is most of
//! it. Blocks near the least cost were evaluated a few steps ago, and their
//! leaves would hand few pixels to the background: for those, the very terms of
//! then and now are compared.

use super::super::counts::{Counts, GAINS};
use super::epochs::EPOCHS;

/// Pixels handed to the background for which its rise is known by epoch.
const RISES_KEPT: usize = 64;

/// The background of the last [`EPOCHS`] steps.
pub(super) struct Background {
    views: usize,
    current: usize,
    /// By epoch, then view, in pixels.
    areas: Vec<u32>,
    /// By epoch, then view.
    gains: Vec<[f32; GAINS]>,
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
            gains: vec![[0.0; GAINS]; EPOCHS * views],
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
        self.areas[views.clone()].copy_from_slice(counts.areas(0));
        let gains = counts.background_gains().iter();
        for (own, gains) in self.gains[views].iter_mut().zip(gains) {
            *own = gains.map(|gain| gain as f32);
        }
        for (rise, px) in self.rises[epoch].iter_mut().zip(0..) {
            *rise = counts.background_rise(px) as u32;
        }
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
        if most as usize > GAINS {
            return f32::INFINITY;
        }
        if self.moved[epoch].by_gains[0].is_nan() {
            self.moved[epoch].by_gains = self.compare_gains(epoch);
        }
        let lg_moved = self.lg_totals[self.current] - self.lg_totals[epoch];
        // Either logarithm of the total with a leaf's pixels may be off by 1.2.
        let lg_moved = lg_moved.unsigned_abs() as f32 + 5.0;
        self.moved[epoch].by_gains[most as usize - 1] + px as f32 * lg_moved
    }

    fn compare_gains(&self, epoch: usize) -> [f32; GAINS] {
        #[cfg(target_arch = "x86_64")]
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.compare_gains_by_avx2(epoch) };
        }
        self.compare_gains_plainly(epoch)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn compare_gains_by_avx2(&self, epoch: usize) -> [f32; GAINS] {
        self.compare_gains_plainly(epoch)
    }

    #[inline(always)]
    fn compare_gains_plainly(&self, epoch: usize) -> [f32; GAINS] {
        let then = &self.gains[epoch * self.views..][..self.views];
        let now = &self.gains[self.current * self.views..][..self.views];
        let mut sums = [0.0; GAINS];
        for (then, now) in then.iter().zip(now) {
            let mut moved = [0.0; GAINS];
            for k in 0..GAINS {
                moved[k] = (now[k] - then[k]).abs();
            }
            // The largest up to each.
            for width in [1, 2, 4] {
                let narrower = moved;
                for k in width..GAINS {
                    let other = narrower[k - width];
                    moved[k] = if other > moved[k] { other } else { moved[k] };
                }
            }
            for k in 0..GAINS {
                // Gains grow with the pixels, and are rounded to 24 bits.
                sums[k] += moved[k] + now[k] * (2.0 * f32::EPSILON);
            }
        }
        sums.map(|sum| sum * (1.0 + 1e-5))
    }

    /// The change since an epoch, summed over the views without signs, of what
    /// the background's growing total takes away: of any leaf that reveals a
    /// number of pixels in a range. Infinite where that is not known.
    #[inline]
    pub(super) fn moved_by_rise(&mut self, epoch: usize, least_px: u32, largest_px: u32) -> f32 {
        if largest_px == 0 || epoch == self.current {
            return 0.0;
        }
        if largest_px as usize >= RISES_KEPT {
            return f32::INFINITY;
        }
        if self.moved[epoch].areas.is_nan() {
            self.moved[epoch].areas = self.compare_areas(epoch);
        }
        let (then, now) = (&self.rises[epoch], &self.rises[self.current]);
        let mut largest = 0f32;
        for px in least_px as usize..=largest_px as usize {
            let rise = now[px].abs_diff(then[px]) as f32;
            let moved = rise * self.total + then[px] as f32 * self.moved[epoch].areas;
            largest = if moved > largest { moved } else { largest };
        }
        largest * (1.0 + 1e-5)
    }

    fn compare_areas(&self, epoch: usize) -> f32 {
        let then = &self.areas[epoch * self.views..][..self.views];
        let now = &self.areas[self.current * self.views..][..self.views];
        let moved = then.iter().zip(now).map(|(then, now)| now.abs_diff(*then));
        moved.sum::<u32>() as f32
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::super::events::Event;
    use super::*;
    use crate::lg::LgTable;

    const VIEWS: usize = 3;

    /// Leaf 1 gains or loses pixels of a view.
    fn change(counts: &mut Counts<'_>, view: usize, by: i32) {
        let (before, after) = if by < 0 { (1, 0) } else { (0, 1) };
        counts.record(&Event {
            view: view as u32,
            pixels: by.unsigned_abs(),
            before: [before, 0],
            after: [after, 0],
        });
        counts.settle();
        counts.forget_step();
    }

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
            changes in prop::collection::vec((0..VIEWS, -40i32..40), 1..30),
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
                change(&mut counts, view, by);
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
