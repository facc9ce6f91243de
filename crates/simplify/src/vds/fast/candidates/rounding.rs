//! How far rounding may put bounds off: f32 sums, and logarithms rounded down.

/// What rounding may do to bounds and to excesses computed in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    /// Of an excess, as a part of the sum of what was added up.
    f32_part: f32,
    /// Of what the background's total takes away in all views together.
    rise: f32,
    /// Of the background's term in one view in which it is revealed.
    revealed: f32,
    views: f32,
}

impl Rounding {
    pub(super) fn new(views: usize, pixels_per_view: usize) -> Self {
        let (views, pixels) = (views as f32, pixels_per_view as f32);
        Self {
            // The roundings of a delta, of a deviation, of their difference and
            // of each sum, and as much again to spare.
            f32_part: (views + 8.0) * 2.0 * f32::EPSILON,
            // Logarithms are rounded down within 1.2 units. Then and now, each
            // of two logarithms times areas that sum to at most all pixels.
            rise: 2.5 * pixels * views,
            // Three roundings, times at most the pixels of a view.
            revealed: 2.5 * pixels,
            views,
        }
    }

    pub(super) fn of_f32(self, magnitude: f32) -> f32 {
        self.f32_part * magnitude
    }

    /// The rounding of the background's terms in the views in which it is revealed, for a
    /// leaf that would hand it `background_px` pixels.
    pub(super) fn of_revealed(self, background_px: f32) -> f32 {
        self.revealed * background_px.min(self.views)
    }

    pub(super) fn of_background(self, background_px: f32) -> f32 {
        match background_px > 0.0 {
            true => self.rise + self.of_revealed(background_px),
            false => 0.0,
        }
    }
}
