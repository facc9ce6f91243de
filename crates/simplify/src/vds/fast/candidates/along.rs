//! The background along the signs of deviations, and how far it has moved.

use super::super::switches::{Mechanism, is_on};
use super::epochs::EPOCHS;
use crate::lg::LG_FRACTION_BITS;

/// Epochs that are looked at together; divides them.
const AT_ONCE: usize = 8;

/// The background's areas, summed with the signs of deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    pub areas: i64,
    pub total: u32,
    /// The areas without their sign.
    size: f32,
    /// What `areas (lg (total + px) - lg total)` is for few pixels, as multiples
    /// of the pixels and, at most, of their square.
    first: f64,
    second: f64,
}

impl Along {
    pub(super) fn new(areas: i64, total: u32) -> Self {
        let unit = f64::from(1u32 << LG_FRACTION_BITS) / std::f64::consts::LN_2;
        // x - x^2 / 2 <= ln (1 + x) <= x.
        let (first, second) = match total {
            0 => (0.0, f64::INFINITY),
            total => {
                let first = areas as f64 / f64::from(total) * unit;
                (first, first.abs() / f64::from(total) / 2.0)
            }
        };
        Self {
            areas,
            total,
            size: areas.unsigned_abs() as f32,
            first,
            second,
        }
    }
}

/// What the background's total takes away along the signs of an epoch from a
/// leaf that hands it some pixels, now less then: with B the background's areas
/// along these signs and S its total, `B (lg (S + px) - lg S)`, bounded by what
/// is proportional to the pixels, to their square, and by rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct BackgroundMoved {
    pub slope: f32,
    pub curvature: f32,
    pub rounding: f32,
}

impl BackgroundMoved {
    pub(super) const NONE: Self = Self {
        slope: 0.0,
        curvature: 0.0,
        rounding: 0.0,
    };

    /// Not below it for any number of pixels in a range, which is not 0.
    #[inline(always)]
    pub(super) fn at_most(&self, least_px: f32, largest_px: f32) -> f32 {
        let (a, b) = (self.slope * least_px, self.slope * largest_px);
        let linear = if a > b { a } else { b };
        linear + self.curvature * largest_px * largest_px + self.rounding
    }
}

/// An [`Along`] for each epoch, as vector instructions read them.
#[derive(Clone)]
pub(super) struct Alongs {
    size: [f32; EPOCHS],
    first: [f64; EPOCHS],
    second: [f64; EPOCHS],
}

impl Alongs {
    pub(super) fn all(along: &Along) -> Self {
        Self {
            size: [along.size; EPOCHS],
            first: [along.first; EPOCHS],
            second: [along.second; EPOCHS],
        }
    }

    pub(super) fn set(&mut self, epoch: usize, along: &Along) {
        self.size[epoch] = along.size;
        self.first[epoch] = along.first;
        self.second[epoch] = along.second;
    }
}

/// A [`BackgroundMoved`] for each epoch.
pub(super) struct AllMoved {
    slope: [f32; EPOCHS],
    curvature: [f32; EPOCHS],
    rounding: [f32; EPOCHS],
}

impl AllMoved {
    pub(super) const NONE: Self = Self {
        slope: [0.0; EPOCHS],
        curvature: [0.0; EPOCHS],
        rounding: [0.0; EPOCHS],
    };

    #[inline(always)]
    pub(super) fn of(&self, epoch: usize) -> BackgroundMoved {
        BackgroundMoved {
            slope: self.slope[epoch],
            curvature: self.curvature[epoch],
            rounding: self.rounding[epoch],
        }
    }

    /// Compares then and now; what is not below any, and its slope not below 0.
    pub(super) fn compare(&mut self, then: &Alongs, now: &Alongs) -> BackgroundMoved {
        #[cfg(target_arch = "x86_64")]
        if is_on(Mechanism::WideAlong) && std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.compare_by_avx2(then, now) };
        }
        self.compare_plainly(then, now)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn compare_by_avx2(&mut self, then: &Alongs, now: &Alongs) -> BackgroundMoved {
        self.compare_plainly(then, now)
    }

    #[inline(always)]
    fn compare_plainly(&mut self, then: &Alongs, now: &Alongs) -> BackgroundMoved {
        for k in 0..EPOCHS {
            let (was, is) = (then.first[k], now.first[k]);
            // Slopes are of the size of what they are the difference of, at most.
            let slope_rounding = (was.abs() + is.abs()) * 1e-7;
            let curvature = then.second[k] + now.second[k] + slope_rounding;
            self.slope[k] = (is - was) as f32;
            self.curvature[k] = (curvature * 1.000_001) as f32;
            // Two logarithms each, rounded down within 1.2 units.
            self.rounding[k] = 1.25 * (then.size[k] + now.size[k]);
        }
        BackgroundMoved {
            slope: largest(&self.slope),
            curvature: largest(&self.curvature),
            rounding: largest(&self.rounding),
        }
    }
}

/// The largest, at least 0. Several at a time are what vector instructions
/// compare.
#[inline(always)]
fn largest(numbers: &[f32; EPOCHS]) -> f32 {
    let mut largest = [0f32; AT_ONCE];
    for numbers in numbers.chunks_exact(AT_ONCE) {
        for k in 0..AT_ONCE {
            largest[k] = if numbers[k] > largest[k] {
                numbers[k]
            } else {
                largest[k]
            };
        }
    }
    largest.into_iter().fold(0.0, f32::max)
}
