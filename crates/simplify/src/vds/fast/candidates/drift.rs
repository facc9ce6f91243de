//! How far the background's terms may have moved, in f32, for any leaf.

use super::super::changes::BackgroundDrift;

/// How far the background has drifted, for each pixel that a leaf would hand to
/// it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    /// Where it is revealed.
    pub revealed: f32,
    /// And in all views together.
    pub everywhere: f32,
}

impl Drift {
    pub(super) fn then(drift: BackgroundDrift) -> Self {
        Self {
            revealed: drift_then(drift.revealed),
            everywhere: drift_then(drift.rise + drift.revealed),
        }
    }

    pub(super) fn now(drift: BackgroundDrift) -> Self {
        Self {
            revealed: drift_now(drift.revealed),
            everywhere: drift_now(drift.rise + drift.revealed),
        }
    }
}

/// A background drift in f32; a little less than it was.
pub(super) fn drift_then(drift: f64) -> f32 {
    (drift * (1.0 - 1e-6)) as f32
}

/// A background drift in f32; a little more than it is.
pub(super) fn drift_now(drift: f64) -> f32 {
    (drift * (1.0 + 1e-6)) as f32
}
