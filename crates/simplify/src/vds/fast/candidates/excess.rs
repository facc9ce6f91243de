//! The excesses of a block's sixteen leaves, in f32, as vector instructions.

#[cfg(target_arch = "x86_64")]
use super::super::switches::{Mechanism, is_on};
use super::widths::Width;

/// Leaves of a block.
pub(super) const LANES: usize = 16;

/// A number for each leaf of a block, one cache line.
#[repr(align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes(pub [f32; LANES]);

impl Lanes {
    pub(super) const ZERO: Self = Self([0.0; LANES]);
    pub(super) const INFINITE: Self = Self([f32::INFINITY; LANES]);

    #[inline(always)]
    pub(super) fn least(&self) -> f32 {
        let mut halves = self.0;
        let mut width = LANES / 2;
        while width > 0 {
            for k in 0..width {
                let (a, b) = (halves[k], halves[k + width]);
                halves[k] = if a < b { a } else { b };
            }
            width /= 2;
        }
        halves[0]
    }

    #[inline(always)]
    pub(super) fn largest(&self) -> f32 {
        let mut halves = self.0;
        let mut width = LANES / 2;
        while width > 0 {
            for k in 0..width {
                let (a, b) = (halves[k], halves[k + width]);
                halves[k] = if a > b { a } else { b };
            }
            width /= 2;
        }
        halves[0]
    }
}

/// What a step knows of a view.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewNow {
    /// Twice the deviation, without its sign.
    pub twice_deviation: f32,
    /// The sign of the deviation: 1 or -1.
    pub sign: f32,
    /// Area of the background in pixels.
    pub background_px: f32,
}

/// A block's leaves as they stand now.
#[derive(Clone, Copy, Debug)]
pub(super) struct Excesses {
    /// `sum (|D + d| - |D|)` of each leaf, less and more what may have moved;
    /// infinite where none is.
    pub at_least: Lanes,
    pub at_most: Lanes,
    /// The least and the largest of them.
    pub least: f32,
    /// The least of leaves that would hand pixels to the background.
    pub least_open: f32,
    /// The least of the others.
    pub least_solid: f32,
    pub largest: f32,
    /// The least of `sum g d`, g the signs of D, of leaves that would hand
    /// nothing to the background.
    pub least_along_solid: f32,
    /// The least of the others.
    pub least_along_open: f32,
    /// The least and largest sum of the deltas without their signs.
    pub least_n: f32,
    pub largest_n: f32,
    /// The largest of what was added up for a leaf.
    pub magnitude: f32,
    /// The largest delta without its sign.
    pub widest: f32,
}

/// What is known of a block's leaves beside their rows.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    /// How the logarithm of the background's total rises with their pixels.
    pub rises: &'a Lanes,
    /// How far the terms of their pixels may have moved since the rows were read.
    pub moved: &'a Lanes,
    /// 0 where a lane holds a leaf that would hand pixels to the background,
    /// infinite elsewhere.
    pub open: &'a Lanes,
    /// Lanes of the other leaves.
    pub solid: &'a Lanes,
}

/// Evaluates a block: `rows` its leaves' deltas by view, but for what the
/// background's total takes away in every view, which is `rises` times the
/// background's area. `widths` become those of the deltas, by view.
///
/// With g the sign of D, `|D + d| - |D|` is the larger of `g d` and
/// `-g d - 2 |D|`: no large numbers cancel.
#[inline(always)]
fn plainly(
    rows: &[Lanes],
    beside: Beside<'_>,
    views: &[ViewNow],
    widths: &mut [Width],
) -> Excesses {
    let Beside {
        rises,
        moved,
        open,
        solid,
    } = beside;
    let (mut c, mut h) = ([0f32; LANES], [0f32; LANES]);
    let mut n = [0f32; LANES];
    let (mut widest, mut background_px) = (0f32, 0f32);
    for ((row, view), width) in rows.iter().zip(views).zip(widths) {
        let mut deltas = Lanes::ZERO;
        for k in 0..LANES {
            let delta = row.0[k] - view.background_px * rises.0[k];
            let along = delta * view.sign;
            let across = -along - view.twice_deviation;
            c[k] += if along > across { along } else { across };
            h[k] += along;
            n[k] += delta.abs();
            deltas.0[k] = delta;
        }
        background_px += view.background_px;
        let (up, down) = (deltas.largest(), -deltas.least());
        let (up, down) = (
            if up > 0.0 { up } else { 0.0 },
            if down > 0.0 { down } else { 0.0 },
        );
        widest = if up > widest { up } else { widest };
        widest = if down > widest { down } else { widest };
        *width = Width::new(up, down);
    }
    // Plain loops: closures would not be compiled for the wider instructions.
    let (mut at_least, mut at_most) = (Lanes::ZERO, Lanes::ZERO);
    let (mut excess_open, mut excess_solid) = (Lanes::ZERO, Lanes::ZERO);
    let (mut along_open, mut along_solid) = (Lanes::ZERO, Lanes::ZERO);
    let (mut n_at_least, mut n_at_most) = (Lanes::ZERO, Lanes::ZERO);
    let mut magnitude = Lanes::ZERO;
    for k in 0..LANES {
        let (open, solid, moved) = (open.0[k], solid.0[k], moved.0[k]);
        let absent = if open < solid { open } else { solid };
        // A row is a delta and what has risen.
        magnitude.0[k] = n[k] + 2.0 * background_px * rises.0[k];
        at_least.0[k] = c[k] - moved + absent;
        at_most.0[k] = c[k] + moved - absent;
        excess_open.0[k] = c[k] - moved + open;
        excess_solid.0[k] = c[k] - moved + solid;
        along_open.0[k] = h[k] - moved + open;
        along_solid.0[k] = h[k] - moved + solid;
        n_at_least.0[k] = n[k] - moved + absent;
        n_at_most.0[k] = n[k] + moved - absent;
    }
    let (least_open, least_solid) = (excess_open.least(), excess_solid.least());
    Excesses {
        at_least,
        at_most,
        least: if least_open < least_solid {
            least_open
        } else {
            least_solid
        },
        least_open,
        least_solid,
        largest: at_most.largest(),
        least_along_open: along_open.least(),
        least_along_solid: along_solid.least(),
        least_n: n_at_least.least(),
        largest_n: n_at_most.largest(),
        magnitude: magnitude.largest(),
        widest,
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn by_avx2(
    rows: &[Lanes],
    beside: Beside<'_>,
    views: &[ViewNow],
    widths: &mut [Width],
) -> Excesses {
    plainly(rows, beside, views, widths)
}

/// Excesses of a block's leaves: see [`plainly`].
#[inline]
pub(super) fn excesses(
    rows: &[Lanes],
    beside: Beside<'_>,
    views: &[ViewNow],
    widths: &mut [Width],
) -> Excesses {
    #[cfg(target_arch = "x86_64")]
    if is_on(Mechanism::WideExcess) && std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { by_avx2(rows, beside, views, widths) };
    }
    plainly(rows, beside, views, widths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_open_also_where_the_background_does_not_rise_with_it() {
        let mut row = Lanes::ZERO;
        (row.0[2], row.0[5], row.0[7]) = (-4.0, -9.0, 3.0);
        let (mut open, mut solid, mut moved) = (Lanes::INFINITE, Lanes::INFINITE, Lanes::ZERO);
        (open.0[2], moved.0[2]) = (0.0, 0.5);
        (solid.0[5], solid.0[7]) = (0.0, 0.0);
        let view = ViewNow {
            twice_deviation: 200.0,
            sign: 1.0,
            background_px: 1e8,
        };
        let beside = Beside {
            rises: &Lanes::ZERO,
            moved: &moved,
            open: &open,
            solid: &solid,
        };
        let mut widths = [Width::ZERO];
        let found = excesses(&[row], beside, &[view], &mut widths);
        assert_eq!((found.least, found.least_open), (-9.0, -4.5));
        assert_eq!(
            (found.least_along_solid, found.least_along_open),
            (-9.0, -4.5)
        );
        assert_eq!((found.largest, found.widest), (3.0, 9.0));
        assert_eq!((found.least_n, found.largest_n), (3.0, 9.0));
        assert_eq!((found.at_least.0[2], found.at_most.0[2]), (-4.5, -3.5));
        assert_eq!(found.at_least.0[0], f32::INFINITY);
        assert_eq!(widths, [Width::new(3.0, 9.0)]);
    }
}
