//! The background along the signs of deviations, and how far it has moved.

use crate::lg::LG_FRACTION_BITS;

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

    pub(super) fn new(then: &Along, now: &Along) -> Self {
        // Slopes are of the size of what they are the difference of, at most.
        let slope_rounding = (then.first.abs() + now.first.abs()) * 1e-7;
        let curvature = then.second + now.second + slope_rounding;
        Self {
            slope: (now.first - then.first) as f32,
            curvature: (curvature * 1.000_001) as f32,
            // Two logarithms each, rounded down within 1.2 units.
            rounding: 1.25 * (then.size + now.size),
        }
    }

    /// Not below either.
    pub(super) fn or(self, other: Self) -> Self {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        Self {
            slope: larger(self.slope, other.slope),
            curvature: larger(self.curvature, other.curvature),
            rounding: larger(self.rounding, other.rounding),
        }
    }

    /// Not below it for any number of pixels in a range, which is not 0.
    #[inline(always)]
    pub(super) fn at_most(&self, least_px: f32, largest_px: f32) -> f32 {
        let (a, b) = (self.slope * least_px, self.slope * largest_px);
        let linear = if a > b { a } else { b };
        linear + self.curvature * largest_px * largest_px + self.rounding
    }
}
