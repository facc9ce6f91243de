//! How near to the truth a client draws a level.

use secateur_eval::Shown;

/// How much of the truth a level may cover, in pictures of a client.
pub(super) const WITHIN: [f64; 2] = [0.9, 1.1];

/// As many specks a view as a level may show more than the original does by the same client.
pub(super) const MOST_MORE_SPECKS: f64 = 2.0;

/// What coverage out of its bounds counts besides: as much as a hundred specks.
const OUT_OF_BOUNDS: f64 = 1.0;

/// By how much more than is allowed coverage may change over the range of a level before other shares
/// of the leaves are no more tried.
const HOPELESS: f64 = 1.1;

/// How a client draws a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelAsDrawn {
    /// From where it begins to be seen.
    pub begin: Shown,
    /// From where the next takes over; for the last, where it is 64 pixels high, or half as high as
    /// where it begins if that is less.
    pub end: Shown,
    /// Specks in a view of it, at the worse of the two, beyond those of the original, where a client
    /// shows as much of that as there is: what fades away has no specks.
    pub more_specks_per_view: f64,
}

impl LevelAsDrawn {
    /// The share by which coverage is off where it is off most.
    pub(super) fn coverage_error(&self) -> f64 {
        let of = |shown: &Shown| (shown.coverage_over_truth - 1.0).abs();
        of(&self.begin).max(of(&self.end))
    }

    /// The share by which coverage is off where it is off most; a speck too many counts as much
    /// as a hundredth, and coverage out of its bounds besides.
    pub(super) fn error(&self) -> f64 {
        let shown = [self.begin, self.end].map(|shown| shown.coverage_over_truth);
        let is_within = shown.iter().all(|of| (WITHIN[0]..=WITHIN[1]).contains(of));
        let out = if is_within { 0.0 } else { OUT_OF_BOUNDS };
        self.coverage_error() + 0.01 * self.specks_too_many() + out
    }

    fn specks_too_many(&self) -> f64 {
        (self.more_specks_per_view - MOST_MORE_SPECKS).max(0.0)
    }

    /// By how much more should be seen, for coverage to be off as little as can be.
    pub(super) fn wanted_gain(&self) -> f64 {
        let [begin, end] = [self.begin, self.end].map(|shown| shown.coverage_over_truth);
        (begin * end).sqrt().recip().clamp(0.5, 2.0)
    }

    /// Whether more or less of the leaves brings the end within its bounds only where the beginning leaves
    /// them.
    pub(super) fn is_hopeless(&self) -> bool {
        let [begin, end] = [self.begin, self.end].map(|shown| shown.coverage_over_truth);
        begin.max(end) > begin.min(end) * HOPELESS * WITHIN[1] / WITHIN[0]
    }

    pub(super) fn is_within(&self) -> bool {
        let within = |shown: &Shown| (WITHIN[0]..=WITHIN[1]).contains(&shown.coverage_over_truth);
        within(&self.begin) && within(&self.end) && self.specks_too_many() == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_within_its_bounds_is_worth_some_specks() {
        let drawn = |coverage: [f64; 2], more_specks_per_view: f64| {
            let [begin, end] = coverage.map(|coverage_over_truth| Shown {
                coverage_over_truth,
                specks_per_view: 0.0,
            });
            let drawn = LevelAsDrawn {
                begin,
                end,
                more_specks_per_view,
            };
            drawn.error()
        };
        let faded = drawn([0.96, 0.51], 55.0);
        assert!(drawn([0.96, 0.98], 179.0) < faded);
        assert!(drawn([0.96, 0.98], 400.0) > faded);
        // Within their bounds, specks count as they did.
        assert!(drawn([0.96, 0.91], 20.0) < drawn([0.97, 0.99], 80.0));
    }
}
