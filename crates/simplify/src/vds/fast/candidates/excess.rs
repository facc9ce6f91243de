//! The excesses of a block's leaves, in f32, as vector instructions.

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
    /// `sum (|D + d| - |D|)` of each leaf.
    pub excess: Lanes,
    /// Its least, without lanes that hold no leaf.
    pub least: f32,
    /// The least of leaves that would hand pixels to the background.
    pub least_open: f32,
    /// Its largest, likewise.
    pub largest: f32,
    /// The least of `sum g d`, g the signs of D, of leaves that would hand
    /// nothing to the background.
    pub least_along_solid: f32,
    /// The least of the others, without what the background's total takes away.
    pub least_along_open: f32,
}

/// Evaluates a block: `rows` its leaves' deltas by view, but for what the
/// background's total takes away in every view, which is `rises` times the
/// background's area; `absent` infinite where a lane holds no leaf.
///
/// With g the sign of D, `|D + d| - |D|` is the larger of `g d` and
/// `-g d - 2 |D|`: no large numbers cancel.
#[inline(always)]
fn plainly(rows: &[Lanes], rises: &Lanes, views: &[ViewNow], absent: &Lanes) -> Excesses {
    let (mut c, mut h) = ([0f32; LANES], [0f32; LANES]);
    for (row, view) in rows.iter().zip(views) {
        for k in 0..LANES {
            let along = (row.0[k] - view.background_px * rises.0[k]) * view.sign;
            let across = -along - view.twice_deviation;
            c[k] += if along > across { along } else { across };
            h[k] += row.0[k] * view.sign;
        }
    }
    // Plain loops: closures would not be compiled for the wider instructions.
    let mut found = [Lanes::ZERO; 5];
    for k in 0..LANES {
        let (open, solid) = match rises.0[k] > 0.0 {
            true => (absent.0[k], f32::INFINITY),
            false => (f32::INFINITY, absent.0[k]),
        };
        found[0].0[k] = c[k] + absent.0[k];
        found[1].0[k] = c[k] + open;
        found[2].0[k] = absent.0[k] - c[k];
        found[3].0[k] = h[k] + solid;
        found[4].0[k] = h[k] + open;
    }
    Excesses {
        excess: found[0],
        least: found[0].least(),
        least_open: found[1].least(),
        largest: -found[2].least(),
        least_along_solid: found[3].least(),
        least_along_open: found[4].least(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn by_avx2(rows: &[Lanes], rises: &Lanes, views: &[ViewNow], absent: &Lanes) -> Excesses {
    plainly(rows, rises, views, absent)
}

/// Excesses of a block's leaves: see [`plainly`].
#[inline]
pub(super) fn excesses(
    rows: &[Lanes],
    rises: &Lanes,
    views: &[ViewNow],
    absent: &Lanes,
) -> Excesses {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { by_avx2(rows, rises, views, absent) };
    }
    plainly(rows, rises, views, absent)
}
