//! The deviations that blocks were evaluated with, and where the current ones
//! stand against them.

/// Steps whose deviations are remembered; a block that was not evaluated for so
/// long is evaluated then.
pub(super) const EPOCHS: usize = 64;
/// Classes of widths, half an octave each.
const CLASSES: usize = 64;
/// The bits of the width, as f32, that ends the first class: 2^16.
const FIRST_CLASS_BITS: u32 = (127 + 16) << 1;

/// An epoch and a class of widths, as one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(u16);

impl Slot {
    pub(super) fn new(epoch: usize, widest: f32) -> Self {
        // The half octave above the one that the width is in.
        let half_octave = (widest.to_bits() >> 22) + 1;
        let class = half_octave.saturating_sub(FIRST_CLASS_BITS) as usize;
        Self((epoch * CLASSES + class.min(CLASSES - 1)) as u16)
    }

    pub(super) fn epoch(self) -> usize {
        usize::from(self.0) / CLASSES
    }

    fn class(self) -> usize {
        usize::from(self.0) % CLASSES
    }
}

/// The least width that no member of a class reaches; infinite for the last.
fn width_above(class: usize) -> f32 {
    match class {
        last if last == CLASSES - 1 => f32::INFINITY,
        class => f32::from_bits((FIRST_CLASS_BITS + class as u32) << 22),
    }
}

/// The deviations of the last [`EPOCHS`] steps.
///
/// With the deviations D now and E then, and a leaf none of whose deltas d is
/// wider than m, the excess `sum_v (|D + d| - |D|)` is less than what it was by
/// at most the sum over the views of `2 max(0, min(m, |D|) - |E|)`, or of
/// `2 min(m, |D|)` where E and D differ in sign: the difference of
/// `|E + d| - |E|` and `|D + d| - |D|` is piecewise linear in d, zero on the
/// side of D and E's own sign, and that is its largest value. Nothing, then,
/// wherever both deviations are larger than every delta.
pub(super) struct Epochs {
    views: usize,
    current: usize,
    /// By epoch, then view.
    deviations: Vec<i64>,
    /// Sum of g D - |D| by epoch, g the signs of E: zero while no deviation
    /// changed its sign.
    flipped: [f32; EPOCHS],
    /// Sum of |D - E| - |D| + |E| by epoch.
    risen: [f32; EPOCHS],
    /// Sum of g times the area of the background now, by epoch.
    background_along: [f32; EPOCHS],
    /// The areas of the background by view in pixels.
    background: Vec<u32>,
    /// What an excess may have lost, by epoch, then class.
    lost: Vec<[f32; CLASSES]>,
    /// `min(m, |D|)` by view, then class.
    within: Vec<[f32; CLASSES]>,
    /// The classes that are used: the only ones looked after.
    first_class: usize,
    end_class: usize,
}

impl Epochs {
    pub(super) fn new(deviations: &[i64]) -> Self {
        let mut epochs = Self {
            views: deviations.len(),
            current: 0,
            deviations: deviations.repeat(EPOCHS),
            flipped: [0.0; EPOCHS],
            risen: [0.0; EPOCHS],
            background_along: [0.0; EPOCHS],
            background: vec![0; deviations.len()],
            lost: vec![[0.0; CLASSES]; EPOCHS],
            within: vec![[0.0; CLASSES]; deviations.len()],
            first_class: 0,
            end_class: 0,
        };
        epochs.stand_against(deviations);
        epochs
    }

    pub(super) fn current(&self) -> usize {
        self.current
    }

    /// The deviations of an epoch, by view.
    pub(super) fn deviations(&self, epoch: usize) -> &[i64] {
        &self.deviations[epoch * self.views..][..self.views]
    }

    /// Begins a new epoch in the place of the oldest.
    pub(super) fn begin(&mut self, deviations: &[i64], background: &[u32]) {
        self.background.copy_from_slice(background);
        self.current = (self.current + 1) % EPOCHS;
        self.deviations[self.current * self.views..][..self.views].copy_from_slice(deviations);
        self.stand_against(deviations);
    }

    /// Says how the background stands before the first step.
    pub(super) fn background_is(&mut self, background: &[u32]) {
        self.background.copy_from_slice(background);
        let now = self.deviations(self.current).to_vec();
        self.stand_against(&now);
    }

    /// Forgets which classes are used.
    pub(super) fn forget_classes(&mut self) {
        (self.first_class, self.end_class) = (0, 0);
    }

    /// Sees to it that the class of a slot is looked after.
    #[inline]
    pub(super) fn use_class(&mut self, slot: Slot) {
        let class = slot.class();
        if class >= self.first_class && class < self.end_class {
            return;
        }
        let is_first = self.first_class == self.end_class;
        self.first_class = if is_first {
            class
        } else {
            self.first_class.min(class)
        };
        self.end_class = self.end_class.max(class + 1);
        let now = self.deviations(self.current).to_vec();
        self.stand_against(&now);
    }

    #[inline]
    pub(super) fn flipped(&self, slot: Slot) -> f32 {
        self.flipped[slot.epoch()]
    }

    #[inline]
    pub(super) fn background_along(&self, slot: Slot) -> f32 {
        self.background_along[slot.epoch()]
    }

    #[inline]
    pub(super) fn risen(&self, slot: Slot) -> f32 {
        self.risen[slot.epoch()]
    }

    #[inline]
    pub(super) fn lost(&self, slot: Slot) -> f32 {
        self.lost[slot.epoch()][slot.class()]
    }

    fn stand_against(&mut self, now: &[i64]) {
        #[cfg(target_arch = "x86_64")]
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.stand_against_by_avx2(now) };
        }
        self.stand_against_plainly(now);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn stand_against_by_avx2(&mut self, now: &[i64]) {
        self.stand_against_plainly(now);
    }

    #[inline(always)]
    fn stand_against_plainly(&mut self, now: &[i64]) {
        // Whole vectors.
        let first = self.first_class / 8 * 8;
        let end = self.end_class.next_multiple_of(8);
        for (within, d) in self.within.iter_mut().zip(now) {
            let d = d.unsigned_abs() as f32;
            for (class, value) in (first..end).zip(&mut within[first..end]) {
                *value = width_above(class).min(d);
            }
        }
        for epoch in 0..EPOCHS {
            let then = &self.deviations[epoch * self.views..][..self.views];
            let lost = &mut self.lost[epoch][first..end];
            lost.fill(0.0);
            let (mut flipped, mut moved, mut risen) = (0i64, 0i64, 0i64);
            let mut along = 0i64;
            let views = now.iter().zip(then).zip(&self.background).zip(&self.within);
            for (((d, e), area), within) in views {
                along += if *e < 0 {
                    -i64::from(*area)
                } else {
                    i64::from(*area)
                };
                flipped += (if *e < 0 { -d } else { *d }) - d.abs();
                moved += (d - e).abs();
                risen += d.abs() - e.abs();
                let kept = match (*d < 0) == (*e < 0) {
                    true => e.unsigned_abs(),
                    false => 0,
                };
                let kept = kept as f32;
                let within = &within[first..end];
                if within.last().is_some_and(|widest| kept < *widest) {
                    for (lost, within) in lost.iter_mut().zip(within) {
                        let least = within - kept;
                        *lost += if least > 0.0 { 2.0 * least } else { 0.0 };
                    }
                }
            }
            self.background_along[epoch] = along as f32;
            self.flipped[epoch] = flipped as f32;
            self.risen[epoch] = (moved - risen) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn excess(deviations: &[i64], deltas: &[i64]) -> i64 {
        let terms = deviations.iter().zip(deltas);
        terms.map(|(d, x)| (d + x).abs() - d.abs()).sum()
    }

    #[test]
    fn a_class_ends_above_its_members() {
        for exponent in 10..60 {
            for part in [1.0f32, 1.2, 1.49, 1.5, 1.9] {
                let width = part * 2f32.powi(exponent);
                let class = Slot::new(3, width).class();
                assert!(width_above(class) > width, "{width}");
                assert!(class == 0 || width_above(class - 1) <= width, "{width}");
                assert_eq!(Slot::new(3, width).epoch(), 3);
            }
        }
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
            let mut epochs = Epochs::new(&then);
            let widest = deltas.iter().map(|d| d.unsigned_abs()).max().unwrap() as f32;
            let slot = Slot::new(epochs.current(), widest);
            epochs.use_class(slot);
            epochs.begin(&now, &[1, 2, 3, 4, 5]);
            let toward = |e: &i64, area: i64| if *e < 0 { -area } else { area };
            let background: i64 = then.iter().zip(1..).map(|(e, area)| toward(e, area)).sum();
            prop_assert_eq!(epochs.background_along(slot), background as f32);
            let (before, after) = (excess(&then, &deltas) as f64, excess(&now, &deltas) as f64);
            let rounding = 1e-5 * 5e9;
            prop_assert!(after >= before - f64::from(epochs.lost(slot)) - rounding);
            prop_assert!(after <= before + f64::from(epochs.risen(slot)) + rounding);
            let along: i64 = then.iter().zip(&deltas).map(|(e, d)| if *e < 0 { -d } else { *d }).sum();
            prop_assert!(after >= f64::from(epochs.flipped(slot)) + along as f64 - rounding);
        }
    }
}
