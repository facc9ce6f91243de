//! The deviations of the last steps, and how far bounds made with them may be off now.

use super::super::changes::BackgroundDrift;
use super::super::switches::{Mechanism, is_on};
use super::drift::{drift_now, drift_then};
use super::widths::Width;

/// Steps whose deviations are remembered; where a block was not evaluated for so
/// long, its bounds are carried over to a later one, or it is evaluated then.
pub(super) const EPOCHS: usize = 128;

/// The deviations of the last [`EPOCHS`] steps.
///
/// With the deviations D now and E then, and a leaf whose deltas d that point
/// against D are no wider than m, the excess `sum_v (|D + d| - |D|)` is less
/// than what it was by at most the sum over the views of
/// `2 max(0, min(m, |D|) - |E|)`, or of `2 min(m, |D|)` where E and D differ in
/// sign: the difference of `|E + d| - |E|` and `|D + d| - |D|` is piecewise
/// linear in d, not positive on the side of D, and that is its largest value.
/// Nothing, then, wherever both deviations are larger than every delta.
pub(super) struct Epochs {
    views: usize,
    step: u32,
    current: usize,
    /// By epoch, then view.
    deviations: Vec<i64>,
    /// Numbers the runs of steps in which no deviation changed its sign.
    run: u32,
    /// By epoch, the number of its run.
    runs: [u32; EPOCHS],
    /// Sum of g D - |D| by epoch, g the signs of E: zero while no deviation
    /// changed its sign.
    flipped: [f32; EPOCHS],
    /// |E| by epoch, then view; 0 where D has another sign.
    kept: Vec<f32>,
    /// A little less than the background's drift, by epoch, and a little more
    /// than it is now.
    drifts: [f32; EPOCHS],
    drift: f32,
    /// The least of `flipped`.
    flipped_most: f32,
    /// The deviations now without their signs, |D|, by view.
    sizes: Vec<f32>,
    /// By view, whether D is negative: 1 or 0.
    is_negative: Vec<u32>,
}

/// How a step stands, as bounds need to know it.
#[derive(Clone, Copy)]
pub(super) struct Now<'a> {
    pub epochs: &'a Epochs,
    pub twice_deviation_sum: f32,
}

impl<'a> Now<'a> {
    pub(super) fn new(epochs: &'a Epochs, deviation_sum: i64) -> Self {
        Self {
            epochs,
            twice_deviation_sum: 2.0 * deviation_sum as f32,
        }
    }
}

/// Views that are looked at together.
const VIEWS_AT_ONCE: usize = 4;

impl Epochs {
    /// As if deviations and background had always been like that.
    pub(super) fn new(deviations: &[i64], drift: BackgroundDrift) -> Self {
        let views = deviations.len();
        let mut epochs = Self {
            views,
            step: 0,
            current: 0,
            deviations: deviations.repeat(EPOCHS),
            run: 0,
            runs: [0; EPOCHS],
            flipped: [0.0; EPOCHS],
            drifts: [drift_then(everywhere(drift)); EPOCHS],
            drift: drift_now(everywhere(drift)),
            flipped_most: 0.0,
            kept: vec![0.0; EPOCHS * views],
            sizes: deviations.iter().map(size).collect(),
            is_negative: deviations.iter().map(is_negative).collect(),
        };
        (0..EPOCHS).for_each(|epoch| epochs.keep(epoch));
        epochs
    }

    pub(super) fn current(&self) -> usize {
        self.current
    }

    /// Counts the runs of steps in which no deviation changed its sign.
    pub(super) fn run(&self) -> u32 {
        self.run
    }

    /// Counts the epochs that there were.
    pub(super) fn step(&self) -> u32 {
        self.step
    }

    /// The epoch that the next step takes the place of.
    pub(super) fn oldest(&self) -> usize {
        (self.step + 1) as usize % EPOCHS
    }

    /// Whether no deviation has changed its sign since an epoch.
    pub(super) fn is_of_this_run(&self, epoch: usize) -> bool {
        self.runs[epoch] == self.run
    }

    /// The epoch of a step, if it is remembered.
    pub(super) fn of_step(&self, step: u32) -> Option<usize> {
        let is_known = ((self.step - step) as usize) < EPOCHS;
        is_known.then_some(step as usize % EPOCHS)
    }

    /// The deviations of an epoch, by view.
    pub(super) fn deviations(&self, epoch: usize) -> &[i64] {
        &self.deviations[epoch * self.views..][..self.views]
    }

    /// Begins a new epoch in the place of the oldest.
    pub(super) fn begin(&mut self, deviations: &[i64], drift: BackgroundDrift) {
        self.step += 1;
        self.current = self.step as usize % EPOCHS;
        self.deviations[self.current * self.views..][..self.views].copy_from_slice(deviations);
        let mut has_flipped = false;
        for (view, d) in deviations.iter().enumerate() {
            self.sizes[view] = size(d);
            let is_negative = is_negative(d);
            has_flipped |=
                std::mem::replace(&mut self.is_negative[view], is_negative) != is_negative;
        }
        self.run += u32::from(has_flipped);
        self.runs[self.current] = self.run;
        match has_flipped {
            true => (0..EPOCHS).for_each(|epoch| self.keep(epoch)),
            false => self.keep(self.current),
        }
        self.drifts[self.current] = drift_then(everywhere(drift));
        self.drift = drift_now(everywhere(drift));
        self.flipped = [0.0; EPOCHS];
        self.flipped_most = 0.0;
        for epoch in 0..EPOCHS {
            if self.runs[epoch] != self.run {
                let then = self.deviations(epoch);
                let flipped =
                    along_signs(deviations, then) - deviations.iter().map(|d| d.abs()).sum::<i64>();
                self.flipped[epoch] = flipped as f32;
                self.flipped_most = self.flipped_most.min(flipped as f32);
            }
        }
    }

    fn keep(&mut self, epoch: usize) {
        let views = epoch * self.views..(epoch + 1) * self.views;
        let then = &self.deviations[views.clone()];
        for ((kept, e), is_negative_now) in
            self.kept[views].iter_mut().zip(then).zip(&self.is_negative)
        {
            *kept = if is_negative(e) == *is_negative_now {
                size(e)
            } else {
                0.0
            };
        }
    }

    #[inline]
    pub(super) fn flipped(&self, epoch: usize) -> f32 {
        self.flipped[epoch]
    }

    /// Not above any epoch's.
    #[inline]
    pub(super) fn flipped_most(&self) -> f32 {
        self.flipped_most
    }

    /// How far the background has drifted since an epoch, in all views together, for
    /// each pixel that a leaf would hand to it.
    #[inline]
    pub(super) fn drifted(&self, epoch: usize) -> f32 {
        match is_on(Mechanism::BackgroundDrift) {
            true => self.drift - self.drifts[epoch],
            false => 1e28,
        }
    }

    /// How far since any epoch.
    #[inline]
    pub(super) fn drifted_most(&self) -> f32 {
        self.drifted(self.oldest())
    }

    /// What an excess may have risen by since an epoch: the sum over the views of
    /// `|D - E| - |D| + |E|`.
    pub(super) fn risen(&self, epoch: usize) -> f32 {
        let (now, then) = (self.deviations(self.current), self.deviations(epoch));
        let views = now.iter().zip(then);
        views
            .map(|(d, e)| (d - e).abs() - d.abs() + e.abs())
            .sum::<i64>() as f32
    }

    /// What an excess may have lost since an epoch, of leaves whose deltas have
    /// these widths, by view.
    pub(super) fn lost_within(&self, epoch: usize, widths: &[Width]) -> f32 {
        if !is_on(Mechanism::LossByWidth) {
            // Whatever the deltas.
            let (now, then) = (self.deviations(self.current), self.deviations(epoch));
            let views = now.iter().zip(then);
            let lost = views.map(|(d, e)| (d - e).abs() + d.abs() - e.abs());
            return lost.sum::<i64>() as f32 * (1.0 + 4.0 * f32::EPSILON);
        }
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideLoss) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.lost_within_by_avx2(epoch, widths) };
        }
        self.lost_within_plainly(epoch, widths)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn lost_within_by_avx2(&self, epoch: usize, widths: &[Width]) -> f32 {
        self.lost_within_plainly(epoch, widths)
    }

    #[inline(always)]
    fn lost_within_plainly(&self, epoch: usize, widths: &[Width]) -> f32 {
        let kept = &self.kept[epoch * self.views..][..self.views];
        let beyond = |width: Width, kept: f32, size: f32, is_negative: bool| {
            let width = width.against(is_negative);
            let within = if width < size { width } else { size };
            let beyond = within - kept;
            if beyond > 0.0 { beyond } else { 0.0 }
        };
        let whole = self.views - self.views % VIEWS_AT_ONCE;
        // Sums of their own are what vector instructions add up.
        let mut sums = [0f32; VIEWS_AT_ONCE];
        for at in (0..whole).step_by(VIEWS_AT_ONCE) {
            let widths: &[Width; VIEWS_AT_ONCE] = widths[at..at + VIEWS_AT_ONCE]
                .try_into()
                .expect("as many as are read at once");
            let kept: &[f32; VIEWS_AT_ONCE] = kept[at..at + VIEWS_AT_ONCE]
                .try_into()
                .expect("as many as are read at once");
            let sizes: &[f32; VIEWS_AT_ONCE] = self.sizes[at..at + VIEWS_AT_ONCE]
                .try_into()
                .expect("as many as are read at once");
            let is_negative = &self.is_negative[at..at + VIEWS_AT_ONCE];
            let is_negative: &[u32; VIEWS_AT_ONCE] =
                is_negative.try_into().expect("as many as are read at once");
            for k in 0..VIEWS_AT_ONCE {
                sums[k] += beyond(widths[k], kept[k], sizes[k], is_negative[k] != 0);
            }
        }
        let mut sum: f32 = sums.iter().sum();
        for view in whole..self.views {
            let (size, is_negative) = (self.sizes[view], self.is_negative[view] != 0);
            sum += beyond(widths[view], kept[view], size, is_negative);
        }
        2.0 * sum
    }
}

fn everywhere(drift: BackgroundDrift) -> f64 {
    drift.rise + drift.revealed
}

fn is_negative(deviation: &i64) -> u32 {
    u32::from(*deviation < 0)
}

fn size(deviation: &i64) -> f32 {
    deviation.unsigned_abs() as f32
}

/// Sum of the deltas with the signs of the deviations.
pub(super) fn along_signs(deltas: &[i64], deviations: &[i64]) -> i64 {
    let terms = deltas.iter().zip(deviations);
    terms.map(|(d, e)| if *e < 0 { -d } else { *d }).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn excess(deviations: &[i64], deltas: &[i64]) -> i64 {
        let terms = deviations.iter().zip(deltas);
        terms.map(|(d, x)| (d + x).abs() - d.abs()).sum()
    }

    proptest! {
        #[test]
        fn bounds_hold(
            then in prop::collection::vec(-1_000_000_000i64..1_000_000_000, 5),
            moves in prop::collection::vec(-2_000_000_000i64..2_000_000_000, 5),
            deltas in prop::collection::vec(-1_500_000_000i64..1_500_000_000, 5),
            shrink in 0u32..12,
        ) {
            let deltas: Vec<i64> = deltas.iter().map(|d| d >> shrink).collect();
            let now: Vec<i64> = then.iter().zip(&moves).map(|(e, m)| e + m).collect();
            let mut epochs = Epochs::new(&then, BackgroundDrift::default());
            let epoch = epochs.current();
            let widths: Vec<Width> = deltas.iter().map(|d| Width::ZERO.with(*d as f32)).collect();
            epochs.begin(&now, BackgroundDrift::default());
            let (before, after) = (excess(&then, &deltas) as f64, excess(&now, &deltas) as f64);
            let rounding = 1e-5 * 5e9;
            prop_assert!(after >= before - f64::from(epochs.lost_within(epoch, &widths)) - rounding);
            prop_assert!(after <= before + f64::from(epochs.risen(epoch)) + rounding);
            let along: i64 = then.iter().zip(&deltas).map(|(e, d)| if *e < 0 { -d } else { *d }).sum();
            prop_assert!(after >= f64::from(epochs.flipped(epoch)) + along as f64 - rounding);
        }
    }
}
