//! The excesses of a block's leaves, in f32, as vector instructions.

use super::widths::Width;

/// Leaves of a block.
pub(super) const LANES: usize = 16;

/// A number for each leaf of a block, one cache line.
#[repr(align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes(pub [f32; LANES]);

impl Lanes {
    pub(super) const ZERO: Self = Self([0.0; LANES]);

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
    pub largest: f32,
    /// Likewise the least of `sum g d`, g the signs of D, of leaves that would hand
    /// nothing to the background.
    pub least_along_solid: f32,
    /// The least of the others.
    pub least_along_open: f32,
    /// Likewise the least and largest sum of the deltas without their signs.
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
    /// Infinite where a lane holds no leaf.
    pub absent: &'a Lanes,
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
        absent,
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
    let mut found = [Lanes::ZERO; 8];
    let mut magnitude = Lanes::ZERO;
    for k in 0..LANES {
        let (open, solid) = match rises.0[k] > 0.0 {
            true => (absent.0[k], f32::INFINITY),
            false => (f32::INFINITY, absent.0[k]),
        };
        // A row is a delta and what has risen.
        magnitude.0[k] = n[k] + 2.0 * background_px * rises.0[k];
        found[0].0[k] = c[k] + absent.0[k] - moved.0[k];
        found[1].0[k] = c[k] + open - moved.0[k];
        found[2].0[k] = c[k] + solid;
        found[3].0[k] = absent.0[k] - c[k] - moved.0[k];
        found[4].0[k] = h[k] + open - moved.0[k];
        found[5].0[k] = h[k] + solid;
        found[6].0[k] = n[k] + absent.0[k] - moved.0[k];
        found[7].0[k] = absent.0[k] - n[k] - moved.0[k];
    }
    let (least_open, least_solid) = (found[1].least(), found[2].least());
    let mut at_most = found[3];
    for k in 0..LANES {
        at_most.0[k] = -at_most.0[k];
    }
    Excesses {
        at_least: found[0],
        at_most,
        least: if least_open < least_solid {
            least_open
        } else {
            least_solid
        },
        least_open,
        largest: -found[3].least(),
        least_along_open: found[4].least(),
        least_along_solid: found[5].least(),
        least_n: found[6].least(),
        largest_n: -found[7].least(),
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
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { by_avx2(rows, beside, views, widths) };
    }
    plainly(rows, beside, views, widths)
}
