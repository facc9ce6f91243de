//! The blocks that may hold a leaf as cheap as the best so far: bounds of all blocks,
//! sixteen of them compared at a time.
//!
//! A group is compared with what holds for bounds of any age, then each block that is
//! left with what holds for its own.

use super::super::switches::{Mechanism, is_on};
use super::epochs::{Epochs, Now};

/// BlockFilter that are looked at together.
const TOGETHER: usize = 16;

/// Lower bounds on the excesses of a block's leaves. Leaves that would hand pixels to the background are *open*, the others
/// *solid*.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// The least `sum g d` of solid leaves, less what rounding may have done.
    pub solid: f32,
    /// The figure of `solid`, of open leaves; negative infinity if that is not known.
    pub open: f32,
    /// The least `n` of any, less what rounding may have done.
    pub n: f32,
    pub epoch: u16,
    /// The most pixels that an open leaf would hand to the background.
    pub largest_px: u16,
}

impl Bounds {
    /// Whether no leaf has an excess up to a limit.
    #[inline(always)]
    pub(super) fn is_excluded(&self, limit: f32, now: &Now<'_>) -> bool {
        self.floor(now) > limit
            || self.floor_of_solid(now.epochs) > limit && self.floor_of_open(now.epochs) > limit
    }

    /// Not above the excess of any leaf: by `n`.
    #[inline(always)]
    fn floor(&self, now: &Now<'_>) -> f32 {
        let moved = now.epochs.drifted(self.epoch.into());
        self.n - now.twice_deviation_sum - f32::from(self.largest_px) * moved
    }

    /// Not above the excess of any solid leaf: by `sum g d`.
    #[inline(always)]
    fn floor_of_solid(&self, epochs: &Epochs) -> f32 {
        epochs.flipped(self.epoch.into()) + self.solid
    }

    /// Not above the excess of any open leaf: by `sum g d`, less how far the
    /// background has drifted since then.
    #[inline(always)]
    pub(super) fn floor_of_open(&self, epochs: &Epochs) -> f32 {
        if self.largest_px == 0 {
            return f32::INFINITY;
        }
        let epoch = self.epoch.into();
        let moved = f32::from(self.largest_px) * epochs.drifted(epoch);
        epochs.flipped(epoch) + self.open - moved
    }
}

/// The bounds of all blocks, small, so that all of them stay in the cache.
#[derive(Default)]
pub(super) struct BlockFilter {
    count: usize,
    /// By block, with room for whole groups that are looked at together.
    solid: Vec<f32>,
    open: Vec<f32>,
    n: Vec<f32>,
    largest_px: Vec<u16>,
    epochs: Vec<u16>,
}

impl BlockFilter {
    pub(super) fn new(bounds: Bounds, count: usize) -> Self {
        let room = count.next_multiple_of(TOGETHER);
        let mut filter = Self {
            count,
            solid: vec![f32::INFINITY; room],
            open: vec![f32::INFINITY; room],
            n: vec![f32::INFINITY; room],
            largest_px: vec![0; room],
            epochs: vec![bounds.epoch; room],
        };
        (0..count).for_each(|index| filter.set(index, bounds));
        filter
    }

    /// One block more.
    pub(super) fn push(&mut self, bounds: Bounds) {
        self.count += 1;
        if self.count > self.solid.len() {
            let room = self.count.next_multiple_of(TOGETHER);
            for list in [&mut self.solid, &mut self.open, &mut self.n] {
                list.resize(room, f32::INFINITY);
            }
            self.largest_px.resize(room, 0);
            self.epochs.resize(room, bounds.epoch);
        }
        self.set(self.count - 1, bounds);
    }

    #[inline(always)]
    pub(super) fn set(&mut self, index: usize, bounds: Bounds) {
        self.solid[index] = bounds.solid;
        self.open[index] = bounds.open;
        self.n[index] = bounds.n;
        self.largest_px[index] = bounds.largest_px;
        self.epochs[index] = bounds.epoch;
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Bounds {
        Bounds {
            solid: self.solid[index],
            open: self.open[index],
            n: self.n[index],
            epoch: self.epochs[index],
            largest_px: self.largest_px[index],
        }
    }

    /// Groups of blocks that are looked at together.
    pub(super) fn groups(&self) -> usize {
        self.count.div_ceil(TOGETHER)
    }

    /// The blocks of a group that may contain a leaf with an excess up to a limit: all
    /// that are not [excluded](Bounds::is_excluded), and some that are.
    #[inline]
    pub(super) fn may_contain(&self, group: usize, limit: f32, now: &Now<'_>) -> Indices {
        let lowered = Lowered {
            flipped: -now.epochs.flipped_most(),
            n: now.twice_deviation_sum,
            per_px: now.epochs.drifted_most(),
        };
        let first = group * TOGETHER;
        let bits = match is_on(Mechanism::FilterGroups) {
            true => self.bits(first, limit, &lowered),
            false => u16::MAX,
        };
        let is_there = ((1u32 << (self.count - first).min(TOGETHER)) - 1) as u16;
        Indices {
            first,
            bits: bits & is_there,
        }
    }

    #[inline(always)]
    fn bits(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideFilter) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.bits_by_avx2(first, limit, lowered) };
        }
        self.bits_plainly(first, limit, lowered)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn bits_by_avx2(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        self.bits_plainly(first, limit, lowered)
    }

    #[inline(always)]
    fn bits_plainly(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        let blocks = first..first + TOGETHER;
        let (solid, open) = (&self.solid[blocks.clone()], &self.open[blocks.clone()]);
        let (n, px) = (&self.n[blocks.clone()], &self.largest_px[blocks]);
        let (limit_along, limit_n) = (limit + lowered.flipped, limit + lowered.n);
        let mut bits = 0;
        for k in 0..TOGETHER {
            let moved = f32::from(px[k]) * lowered.per_px;
            let is_excluded = (n[k] - moved > limit_n)
                | (solid[k] > limit_along) & (open[k] - moved > limit_along);
            bits |= u16::from(!is_excluded) << k;
        }
        bits
    }

    /// The first block whose bounds are of an epoch, from an index on.
    pub(super) fn of_epoch(&self, epoch: usize, from: usize) -> Option<usize> {
        let mut start = from;
        while start < self.count {
            let end = (start + 4 * TOGETHER).min(self.count);
            let epochs = &self.epochs[start..end];
            let is_of = |e: &u16| usize::from(*e) == epoch;
            // Without a way out in the middle it is a vector instruction or two.
            if epochs.iter().fold(false, |any, e| any | is_of(e)) {
                return epochs.iter().position(is_of).map(|at| start + at);
            }
            start = end;
        }
        None
    }
}

/// What lowers bounds at most, whatever their epoch.
struct Lowered {
    flipped: f32,
    n: f32,
    per_px: f32,
}

/// Some blocks of a group, in turn.
pub(super) struct Indices {
    first: usize,
    bits: u16,
}

impl Iterator for Indices {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let at = self.bits.trailing_zeros();
        (self.bits != 0).then(|| {
            self.bits &= self.bits - 1;
            self.first + at as usize
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::super::changes::BackgroundDrift;
    use super::*;

    fn drift(step: u32, scale: f64) -> BackgroundDrift {
        BackgroundDrift {
            revealed: f64::from(step) * scale,
            rise: f64::from(step) * 3.0 * scale,
        }
    }

    proptest! {
        #[test]
        fn what_may_not_contain_a_leaf_is_excluded(
            steps in prop::collection::vec(
                (-1f64..10.0, -10f64..1.0), 1..40),
            bounds in prop::collection::vec(
                (-1f32..1.0, -1f32..1.0, 0f32..1.0, 0usize..40, 0u16..100), 1..70),
            limit in -0.1f32..0.1,
            scale in prop_oneof![Just(1e7), Just(1e9)],
            drift_scale in prop_oneof![Just(0.0), Just(1e5)],
        ) {
            let deviations = [1000, -1000];
            let mut epochs = Epochs::new(&deviations, drift(0, drift_scale));
            let deviation = |part: f64| (part * f64::from(scale) / 30.0) as i64;
            for (step, (d, e)) in (1..).zip(&steps) {
                let deviations = [deviation(*d), deviation(*e)];
                epochs.begin(&deviations, drift(step, drift_scale));
            }
            let limit = limit * scale;
            let bounds = bounds.into_iter().map(|(solid, open, n, age, largest_px)| Bounds {
                solid: solid * scale,
                // Some have none.
                open: if largest_px == 0 { f32::INFINITY } else { open * scale },
                n: n * scale,
                epoch: epochs.of_step(epochs.step() - age.min(steps.len()) as u32).unwrap() as u16,
                largest_px,
            });
            let bounds: Vec<Bounds> = bounds.collect();
            let mut all = BlockFilter::new(bounds[0], bounds.len());
            for (index, one) in bounds.iter().enumerate() {
                all.set(index, *one);
                prop_assert_eq!(all.get(index).floor_of_open(&epochs), one.floor_of_open(&epochs));
            }
            let now = Now::new(&epochs, steps.last().map_or(2000, |(d, e)| {
                deviation(*d).abs() + deviation(*e).abs()
            }));
            let found: Vec<usize> = (0..all.groups())
                .flat_map(|group| all.may_contain(group, limit, &now))
                .collect();
            for (index, one) in bounds.iter().enumerate() {
                let rounding = 1e3;
                prop_assert!(found.contains(&index) || one.is_excluded(limit - rounding, &now));
            }
            prop_assert!(found.is_sorted() && found.iter().all(|index| *index < bounds.len()));
            for epoch in [epochs.current(), 0, 7] {
                let known: Vec<usize> = (0..bounds.len())
                    .filter(|index| usize::from(bounds[*index].epoch) == epoch)
                    .collect();
                let found: Vec<usize> = std::iter::successors(all.of_epoch(epoch, 0), |last| {
                    all.of_epoch(epoch, last + 1)
                })
                .collect();
                prop_assert_eq!(found, known);
            }
        }
    }
}
