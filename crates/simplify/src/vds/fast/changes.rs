//! How much a step changed, summed up for bounds: they are widened by that instead of
//! being computed anew.

/// Grows by at least what a step changes at the background's term of a leaf,
/// summed over the views without signs, for every pixel that the leaf would
/// hand to the background, and for exact logarithms.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BackgroundDrift {
    /// In the views in which the leaf reveals it.
    pub revealed: f64,
    /// What its growing total takes away in every view.
    pub rise: f64,
}

/// How the deltas of a leaf changed in a step: the sum of the changes over the
/// views without signs; infinite where the leaf itself changed, or what is
/// behind it, and negative where nothing did.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Change(f32);

impl Change {
    pub(super) const NONE: Self = Self(-1.0);
    pub(super) const OF_ITSELF: Self = Self(f32::INFINITY);

    /// The bound, if only the areas of leaves behind it changed.
    pub(super) fn of_others(self) -> Option<f32> {
        self.0.is_finite().then_some(self.0)
    }

    /// Adds `units` to the bound, rounded up.
    pub(super) fn add(&mut self, units: u64) {
        self.0 = (self.0.max(0.0) + units as f32) * (1.0 + 4.0 * f32::EPSILON);
    }
}
