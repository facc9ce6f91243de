//! What a step looks at first, of every block.

use super::super::switches::{Mechanism, is_on};
use super::blocks::Now;
use super::epochs::Epochs;

/// Gates that are looked at together.
const TOGETHER: usize = 16;

/// What tells of a block, at little cost, that none of its leaves need be looked
/// at. Leaves that would hand pixels to the background are *open*, the others
/// *solid*.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    /// The least `sum g d` of solid leaves, less what rounding may have done.
    pub solid: f32,
    /// The same of open leaves, with the background's total as it was; negative
    /// infinity if that is not known.
    pub open: f32,
    /// The least `n` of any, less what rounding may have done.
    pub n: f32,
    pub epoch: u16,
    /// Pixels that an open leaf would hand to the background.
    pub least_px: u16,
    pub largest_px: u16,
}

impl Gate {
    /// Whether no leaf has an excess up to a limit.
    #[inline(always)]
    pub(super) fn is_shut(&self, limit: f32, now: &Now<'_>) -> bool {
        self.floor(now) > limit
            || self.floor_of_solid(now.epochs) > limit && self.floor_of_open(now.epochs) > limit
    }

    /// Not above the excess of any leaf: by `n`.
    #[inline(always)]
    fn floor(&self, now: &Now<'_>) -> f32 {
        let moved = now.epochs.drifted(self.epoch.into()).everywhere;
        self.n - now.twice_deviation_sum - f32::from(self.largest_px) * moved
    }

    /// Not above the excess of any solid leaf: by `sum g d`.
    #[inline(always)]
    fn floor_of_solid(&self, epochs: &Epochs) -> f32 {
        epochs.flipped(self.epoch.into()) + self.solid
    }

    /// Not above the excess of any open leaf: by `sum g d`, with what the
    /// background's total takes away since then.
    #[inline(always)]
    pub(super) fn floor_of_open(&self, epochs: &Epochs) -> f32 {
        if self.largest_px == 0 {
            return f32::INFINITY;
        }
        let epoch = self.epoch.into();
        let (least_px, largest_px) = (f32::from(self.least_px), f32::from(self.largest_px));
        if !is_on(Mechanism::BackgroundAlong) {
            return epochs.flipped(epoch) + self.open
                - largest_px * epochs.drifted(epoch).everywhere;
        }
        let risen = epochs.background_moved(epoch);
        let risen = risen.at_most(least_px, largest_px);
        let moved = largest_px * epochs.drifted(epoch).revealed;
        epochs.flipped(epoch) + self.open - risen - moved
    }
}

/// The gates of all blocks, small, so that all of them stay in the cache.
#[derive(Default)]
pub(super) struct Gates {
    count: usize,
    /// By gate, with room for whole groups that are looked at together.
    solid: Vec<f32>,
    open: Vec<f32>,
    n: Vec<f32>,
    largest_px: Vec<f32>,
    epochs: Vec<u16>,
    px: Vec<[u16; 2]>,
}

impl Gates {
    pub(super) fn new(gate: Gate, count: usize) -> Self {
        let room = count.next_multiple_of(TOGETHER);
        let mut gates = Self {
            count,
            solid: vec![f32::INFINITY; room],
            open: vec![f32::INFINITY; room],
            n: vec![f32::INFINITY; room],
            largest_px: vec![0.0; room],
            epochs: vec![gate.epoch; room],
            px: vec![[0; 2]; room],
        };
        (0..count).for_each(|index| gates.set(index, gate));
        gates
    }

    #[inline(always)]
    pub(super) fn set(&mut self, index: usize, gate: Gate) {
        self.solid[index] = gate.solid;
        self.open[index] = gate.open;
        self.n[index] = gate.n;
        self.largest_px[index] = gate.largest_px.into();
        self.epochs[index] = gate.epoch;
        self.px[index] = [gate.least_px, gate.largest_px];
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Gate {
        let [least_px, largest_px] = self.px[index];
        Gate {
            solid: self.solid[index],
            open: self.open[index],
            n: self.n[index],
            epoch: self.epochs[index],
            least_px,
            largest_px,
        }
    }

    /// Groups of gates that are looked at together.
    pub(super) fn groups(&self) -> usize {
        self.count.div_ceil(TOGETHER)
    }

    /// The gates of a group that may not be [shut](Gate::is_shut): one bit for
    /// each.
    #[inline]
    pub(super) fn ajar(&self, group: usize, limit: f32, now: &Now<'_>) -> Ajar {
        let most = now.epochs.background_moved_most();
        let drifted = now.epochs.drifted_most();
        let lowered = Lowered {
            flipped: -now.epochs.flipped_most(),
            per_px: match is_on(Mechanism::BackgroundAlong) {
                true => most.slope + drifted.revealed,
                false => drifted.everywhere,
            },
            curvature: most.curvature,
            rounding: most.rounding,
            n: now.twice_deviation_sum,
            n_per_px: drifted.everywhere,
        };
        let first = group * TOGETHER;
        let bits = match is_on(Mechanism::FilterGroups) {
            true => self.bits_ajar(first, limit, &lowered),
            false => u16::MAX,
        };
        let is_there = ((1u32 << (self.count - first).min(TOGETHER)) - 1) as u16;
        Ajar {
            first,
            bits: bits & is_there,
        }
    }

    #[inline(always)]
    fn bits_ajar(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideFilter) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.bits_ajar_by_avx2(first, limit, lowered) };
        }
        self.bits_ajar_plainly(first, limit, lowered)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn bits_ajar_by_avx2(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        self.bits_ajar_plainly(first, limit, lowered)
    }

    #[inline(always)]
    fn bits_ajar_plainly(&self, first: usize, limit: f32, lowered: &Lowered) -> u16 {
        let gates = first..first + TOGETHER;
        let (solid, open) = (&self.solid[gates.clone()], &self.open[gates.clone()]);
        let (n, px) = (&self.n[gates.clone()], &self.largest_px[gates]);
        let (limit_along, limit_n) = (limit + lowered.flipped, limit + lowered.n);
        let mut bits = 0;
        for k in 0..TOGETHER {
            let moved = px[k] * (lowered.per_px + lowered.curvature * px[k]) + lowered.rounding;
            let is_shut = (n[k] - px[k] * lowered.n_per_px > limit_n)
                | (solid[k] > limit_along) & (open[k] - moved > limit_along);
            bits |= u16::from(!is_shut) << k;
        }
        bits
    }

    /// The first gate of an epoch from an index on.
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

/// What lowers the floors of gates at most, whatever their epoch.
struct Lowered {
    flipped: f32,
    per_px: f32,
    curvature: f32,
    rounding: f32,
    n: f32,
    n_per_px: f32,
}

/// Some of a group of gates, in turn.
pub(super) struct Ajar {
    first: usize,
    bits: u16,
}

impl Iterator for Ajar {
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
        fn what_is_not_ajar_is_shut(
            steps in prop::collection::vec(
                (-1f64..10.0, -10f64..1.0, 0u32..50, 0u32..50), 1..40),
            gates in prop::collection::vec(
                (-1f32..1.0, -1f32..1.0, 0f32..1.0, 0usize..40, 1u16..50, 0u16..50), 1..70),
            limit in -0.1f32..0.1,
            scale in prop_oneof![Just(1e7), Just(1e9)],
            drift_scale in prop_oneof![Just(0.0), Just(1e5)],
            background_scale in prop_oneof![Just(0), Just(1), Just(100)],
        ) {
            let (deviations, background) = ([1000, -1000], [50_000, 70_000]);
            let mut epochs = Epochs::new(&deviations, &background, drift(0, drift_scale));
            let deviation = |part: f64| (part * f64::from(scale) / 30.0) as i64;
            for (step, (d, e, a, b)) in (1..).zip(&steps) {
                let background = [50_000 + background_scale * a, 70_000 + background_scale * b];
                let deviations = [deviation(*d), deviation(*e)];
                epochs.begin(&deviations, &background, drift(step, drift_scale));
            }
            let limit = limit * scale;
            let gates = gates.into_iter().map(|(solid, open, n, age, least_px, more)| Gate {
                solid: solid * scale,
                // Some have none.
                open: if more == 0 { f32::INFINITY } else { open * scale },
                n: n * scale,
                epoch: epochs.of_step(epochs.step() - age.min(steps.len()) as u32).unwrap() as u16,
                least_px: if more == 0 { u16::MAX } else { least_px },
                largest_px: if more == 0 { 0 } else { least_px + more },
            });
            let gates: Vec<Gate> = gates.collect();
            let mut all = Gates::new(gates[0], gates.len());
            for (index, gate) in gates.iter().enumerate() {
                all.set(index, *gate);
                prop_assert_eq!(all.get(index).floor_of_open(&epochs), gate.floor_of_open(&epochs));
            }
            let now = Now::new(&epochs, steps.last().map_or(2000, |(d, e, ..)| {
                deviation(*d).abs() + deviation(*e).abs()
            }));
            let ajar: Vec<usize> = (0..all.groups())
                .flat_map(|group| all.ajar(group, limit, &now))
                .collect();
            for (index, gate) in gates.iter().enumerate() {
                let rounding = 1e3;
                prop_assert!(ajar.contains(&index) || gate.is_shut(limit - rounding, &now));
            }
            prop_assert!(ajar.is_sorted() && ajar.iter().all(|index| *index < gates.len()));
            for epoch in [epochs.current(), 0, 7] {
                let known: Vec<usize> = (0..gates.len())
                    .filter(|index| usize::from(gates[*index].epoch) == epoch)
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
