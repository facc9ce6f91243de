//! How far the background's terms have drifted, in f32.
//!
//! What was kept then is rounded down and what holds now is rounded up, so that
//! their difference is never less than the drift in between.

/// A drift as it was; a little less.
pub(super) fn drift_then(drift: f64) -> f32 {
    (drift * (1.0 - 1e-6)) as f32
}

/// A drift as it is; a little more.
pub(super) fn drift_now(drift: f64) -> f32 {
    (drift * (1.0 + 1e-6)) as f32
}
