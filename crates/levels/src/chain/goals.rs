//! How different a level may be in the pictures of a search, so that it is within the limits in those of its size.

/// Levels are aimed at this share of what is allowed: the difference is not monotonic.
const AIM: f64 = 0.98;

/// By which power of their size larger pictures than those of a search show more, until a place has told: a fourth
/// more at 1,080 pixels.
const USUAL_POWER: f64 = 0.217;

/// How many times as large as in a search pictures must be to tell of that power.
const LARGE: f64 = 1.5;

/// How many times the limits a level may be in the pictures of a search.
pub(super) struct Goals {
    /// Where a place's own pictures are as large.
    of_small: f64,
    /// By which power of their size larger pictures show more.
    power: f64,
    /// Whether a place has told of it.
    is_power_known: bool,
    /// How high a plant is at most in the pictures of a search, in pixels.
    search_px: f64,
}

impl Goals {
    /// The goals before any place has told; `search_px` is how high a plant is at most in the pictures of a search.
    pub(super) fn of(search_px: f64) -> Self {
        Self {
            search_px,
            of_small: AIM,
            power: USUAL_POWER,
            is_power_known: false,
        }
    }

    /// For a place at this height.
    pub(super) fn at(&self, pixels_high: f64) -> f64 {
        self.of_small * self.size_over_search(pixels_high).powf(-self.power)
    }

    /// Whether that is not a guess.
    pub(super) fn are_known(&self, pixels_high: f64) -> bool {
        self.is_power_known || self.size_over_search(pixels_high) <= LARGE
    }

    /// Takes in that a level differed `times` as much in its own pictures, this high in pixels, as in those of a search.
    pub(super) fn learn(&mut self, pixels_high: f64, times: f64) {
        let size = self.size_over_search(pixels_high);
        if size > LARGE {
            self.is_power_known = true;
            self.power = (times.ln() / size.ln()).clamp(0.0, 1.0);
        } else {
            self.of_small = AIM * size.powf(self.power) / times;
        }
    }

    /// How many times as high as in the pictures of a search a plant is in a place's own; 1 where those are no larger.
    fn size_over_search(&self, pixels_high: f64) -> f64 {
        (pixels_high / self.search_px).max(1.0)
    }
}
