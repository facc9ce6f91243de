//! How a client blends from a level to the next: decided here for `extras`, records and the files of engines alike.
//!
//! The next level is good enough from where it begins, so nothing of it is shown nearer than that. From there a client
//! cross-fades over a tenth of the distance. One that switches at once goes over a twentieth farther off and comes back
//! where the next level begins.

use serde::Serialize;

/// How wide the band is, as a share of the distance at which it begins.
const WIDTH: f64 = 0.1;

/// How much farther off one goes over at once than comes back, as a share of the same.
const HYSTERESIS: f64 = 0.05;

/// Where a client blends from a level to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BlendBand {
    /// Up to here only this level is shown, in metres: where the next one begins.
    pub begin: f64,
    /// From here on only the next one, in metres.
    pub end: f64,
    /// A client that switches at once goes over at `begin + hysteresis` and back at `begin`, in metres.
    pub hysteresis: f64,
    /// How many pixels high the screen shows the plant's largest extent at `begin`.
    pub begin_px: f64,
    /// And at `end`.
    pub end_px: f64,
}

impl BlendBand {
    /// The band before a level that begins so many metres off, where the plant is so many pixels high.
    pub fn before(distance: f64, pixels_high: f64) -> Self {
        Self {
            begin: distance,
            end: (1.0 + WIDTH) * distance,
            hysteresis: HYSTERESIS * distance,
            begin_px: pixels_high,
            end_px: pixels_high / (1.0 + WIDTH),
        }
    }

    /// Its middle and half its width, in metres.
    pub fn middle_and_margin(&self) -> [f64; 2] {
        [0.5 * (self.begin + self.end), 0.5 * (self.end - self.begin)]
    }
}
