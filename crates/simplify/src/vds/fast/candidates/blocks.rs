//! What bounds the costs of sixteen leaves at once.

use super::super::changes::BackgroundDrift;
use super::background::Background;
use super::epochs::Epochs;
use super::excess::Excesses;
use super::widths::Width;

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
            // Likewise three, times at most the pixels of a view.
            revealed: 2.5 * pixels,
            views,
        }
    }

    pub(super) fn of_f32(self, magnitude: f32) -> f32 {
        self.f32_part * magnitude
    }

    /// Of the background's terms in the views in which it is revealed, for a
    /// leaf that would hand it so many pixels.
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

/// A background drift in f32; a little less than it was.
pub(super) fn drift_then(drift: f64) -> f32 {
    (drift * (1.0 - 1e-6)) as f32
}

/// A background drift in f32; a little more than it is.
pub(super) fn drift_now(drift: f64) -> f32 {
    (drift * (1.0 + 1e-6)) as f32
}

/// A leaf's figures against the deviations of an epoch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figures {
    /// `sum g d` with the background's total as it was then.
    pub along: f32,
    pub excess: f32,
    /// How far the terms of the pixels it would hand to the background have
    /// moved since the epoch: where they are handed, and in all views.
    pub moved_by_gains: f32,
    pub moved_by_rise: f32,
    /// Sum of the deltas without their signs.
    pub n: f32,
    /// What was added up for them: sum of the parts' sizes.
    pub magnitude: f32,
    /// The largest delta without its sign.
    pub widest: f32,
    pub background_px: u32,
    /// The most pixels that it would hand to the background in a view.
    pub most_revealed: u32,
}

/// What a block's leaves would hand to the background, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reveals {
    pub least_px: u32,
    pub largest_px: u32,
    pub most_in_a_view: u32,
}

impl Reveals {
    pub(super) const NONE: Self = Self {
        least_px: u32::MAX,
        largest_px: 0,
        most_in_a_view: 0,
    };

    pub(super) fn include(&mut self, px: u32, most_in_a_view: u32) {
        self.least_px = self.least_px.min(px);
        self.largest_px = self.largest_px.max(px);
        self.most_in_a_view = self.most_in_a_view.max(most_in_a_view);
    }
}

/// How a step stands, as bounds need to know it.
#[derive(Clone, Copy)]
pub(super) struct Now<'a> {
    epochs: &'a Epochs,
    drift: f32,
    drift_revealed: f32,
    twice_deviation_sum: f32,
}

impl<'a> Now<'a> {
    pub(super) fn new(epochs: &'a Epochs, drift: BackgroundDrift, deviation_sum: i64) -> Self {
        Self {
            epochs,
            drift: drift_now(drift.rise + drift.revealed),
            drift_revealed: drift_now(drift.revealed),
            twice_deviation_sum: 2.0 * deviation_sum as f32,
        }
    }
}

/// What a step looks at first, of every block: small, so that all of them stay
/// in the cache. Leaves that would hand pixels to the background are *open*,
/// the others *solid*.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    /// The least `sum g d` of solid leaves, less what rounding may have done.
    solid: f32,
    /// The same of open leaves, with the background's total as it was.
    open: f32,
    /// Drift of the background where it is revealed, when the block was evaluated.
    drift_revealed: f32,
    epoch: u16,
    /// Pixels that an open leaf would hand to the background.
    least_px: u16,
    largest_px: u16,
}

impl Gate {
    #[inline(always)]
    pub(super) fn epoch(&self) -> usize {
        self.epoch.into()
    }

    /// Not above the excess of any solid leaf: by `sum g d`.
    #[inline(always)]
    pub(super) fn floor_of_solid(&self, now: &Now<'_>) -> f32 {
        now.epochs.flipped(self.epoch.into()) + self.solid
    }

    /// Not above the excess of any open leaf: by `sum g d`, with what the
    /// background's total takes away since then.
    #[inline(always)]
    pub(super) fn floor_of_open(&self, now: &Now<'_>) -> f32 {
        if self.largest_px == 0 {
            return f32::INFINITY;
        }
        let (least_px, largest_px) = (f32::from(self.least_px), f32::from(self.largest_px));
        let risen = now.epochs.background_moved(self.epoch.into());
        let risen = risen.at_most(least_px, largest_px);
        let moved = largest_px * (now.drift_revealed - self.drift_revealed);
        now.epochs.flipped(self.epoch.into()) + self.open - risen - moved
    }
}

/// A leaf by which a block is known: what its deltas sum to with the signs of
/// the deviations, exactly, its rank and its number.
pub(super) type First = (i64, u32, u32);

pub(super) const NO_FIRST: First = (i64::MAX, u32::MAX, 0);

#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub epoch: u16,
    least_along_solid: f32,
    least_along_open: f32,
    least: f32,
    least_open: f32,
    largest: f32,
    least_n: f32,
    largest_n: f32,
    magnitude: f32,
    pub widest: f32,
    least_px: u32,
    largest_px: u32,
    /// The most pixels that one of them would hand to the background in a view.
    most_revealed: u32,
    /// Background drift when it was evaluated.
    drift: f32,
    drift_revealed: f32,
    /// How far bounds may be off, but for the background's drift: those by
    /// `along`, and the others.
    rounding_solid: f32,
    rounding_open: f32,
    rounding: f32,
    /// By lane: leaves there are, and those whose deltas have changed since they
    /// were looked at, by no more than `slack` each.
    pub present: u16,
    pub outdated: u16,
    slack: f32,
    /// Which signs of the deviations `first` is for.
    pub signs: u32,
    /// The least of its solid leaves.
    pub first: First,
}

impl Block {
    pub(super) fn empty(epoch: usize, drift: BackgroundDrift, signs: u32) -> Self {
        Self {
            epoch: epoch as u16,
            least_along_solid: f32::INFINITY,
            least_along_open: f32::INFINITY,
            least: f32::INFINITY,
            least_open: f32::INFINITY,
            largest: f32::NEG_INFINITY,
            least_n: f32::INFINITY,
            largest_n: 0.0,
            magnitude: 0.0,
            widest: 0.0,
            least_px: u32::MAX,
            largest_px: 0,
            most_revealed: 0,
            drift: drift_then(drift.rise + drift.revealed),
            drift_revealed: drift_then(drift.revealed),
            rounding_solid: 0.0,
            rounding_open: 0.0,
            rounding: 0.0,
            present: 0,
            outdated: 0,
            slack: 0.0,
            signs,
            first: NO_FIRST,
        }
    }

    pub(super) fn gate(&self) -> Gate {
        let px = |px: u32| u16::try_from(px).unwrap_or(u16::MAX);
        let open = match u16::try_from(self.largest_px) {
            Ok(_) => self.least_along_open - self.rounding_open - self.slack,
            Err(_) => f32::NEG_INFINITY,
        };
        Gate {
            solid: self.least_along_solid - self.rounding_solid - self.slack,
            open,
            drift_revealed: self.drift_revealed,
            epoch: self.epoch,
            least_px: px(self.least_px),
            largest_px: px(self.largest_px),
        }
    }

    /// Whether a leaf of it would hand pixels to the background.
    #[inline]
    pub(super) fn has_background(&self) -> bool {
        self.largest_px > 0
    }

    /// Takes a leaf's new figures into account.
    #[inline]
    pub(super) fn include(&mut self, figures: &Figures, rounding: Rounding) {
        let moved = figures.moved_by_gains + figures.moved_by_rise;
        let excess = figures.excess - moved;
        if figures.background_px > 0 {
            let along = figures.along - figures.moved_by_gains;
            self.least_along_open = self.least_along_open.min(along);
            self.least_open = self.least_open.min(excess);
            self.most_revealed = self.most_revealed.max(figures.most_revealed);
            self.least_px = self.least_px.min(figures.background_px);
            self.largest_px = self.largest_px.max(figures.background_px);
        } else {
            self.least_along_solid = self.least_along_solid.min(figures.along);
        }
        self.least = self.least.min(excess);
        self.largest = self.largest.max(figures.excess);
        self.least_n = self.least_n.min(figures.n - moved);
        self.largest_n = self.largest_n.max(figures.n);
        self.magnitude = self.magnitude.max(figures.magnitude);
        self.widest = self.widest.max(figures.widest);
        self.allow_for(rounding);
    }

    fn allow_for(&mut self, rounding: Rounding) {
        let px = self.largest_px as f32;
        self.rounding_solid = rounding.of_f32(self.magnitude);
        self.rounding_open = self.rounding_solid + rounding.of_revealed(px);
        self.rounding = self.rounding_solid + rounding.of_background(px);
    }

    /// A leaf's deltas changed by so much in all.
    #[inline]
    pub(super) fn outdate(&mut self, lane: usize, change: f32) {
        self.outdated |= 1 << lane;
        self.slack = (self.slack + change) * (1.0 + 4.0 * f32::EPSILON);
    }

    /// None of its leaves is outdated any more.
    #[inline]
    pub(super) fn is_up_to_date(&mut self) {
        self.outdated = 0;
        self.slack = 0.0;
    }

    /// All its leaves were evaluated.
    #[inline]
    pub(super) fn renew(
        &mut self,
        epoch: usize,
        found: &Excesses,
        reveals: Reveals,
        drift: BackgroundDrift,
        rounding: Rounding,
    ) {
        (self.least, self.largest) = (found.least, found.largest);
        self.least_open = found.least_open;
        self.least_along_solid = found.least_along_solid;
        self.least_along_open = found.least_along_open;
        (self.least_n, self.largest_n) = (found.least_n, found.largest_n);
        (self.magnitude, self.widest) = (found.magnitude, found.widest);
        (self.least_px, self.largest_px) = (reveals.least_px, reveals.largest_px);
        self.most_revealed = reveals.most_in_a_view;
        self.epoch = epoch as u16;
        self.drift = drift_then(drift.rise + drift.revealed);
        self.drift_revealed = drift_then(drift.revealed);
        self.allow_for(rounding);
    }

    /// What the deltas of its solid leaves sum to at least, with the signs of
    /// its epoch, is known exactly.
    #[inline]
    pub(super) fn know_solid(&mut self, least_along: i64) {
        self.least_along_solid = match least_along {
            i64::MAX => f32::INFINITY,
            along => along as f32,
        };
    }

    /// How far the excesses of its leaves in f32 may be off by rounding.
    #[inline]
    pub(super) fn f32_rounding(&self, rounding: Rounding) -> f32 {
        rounding.of_f32(self.magnitude)
    }

    #[inline]
    fn margin(&self, now: &Now<'_>) -> f32 {
        self.rounding + self.slack + self.largest_px as f32 * (now.drift - self.drift)
    }

    /// Whether the excesses of its leaves, or of its open ones, are all above a
    /// limit: by `n`, by `sum g d`, and by what they were when they were
    /// evaluated.
    pub(super) fn is_above(
        &self,
        limit: f32,
        now: &Now<'_>,
        background: &mut Background,
        widths: &[Width],
        only_open: bool,
    ) -> bool {
        let epoch = usize::from(self.epoch);
        let (mut moved, mut by_gains, mut risen) = (0.0, 0.0, 0.0);
        if self.has_background() {
            let (least_px, largest_px) = (self.least_px as f32, self.largest_px as f32);
            risen = now
                .epochs
                .background_moved(epoch)
                .at_most(least_px, largest_px);
            by_gains = background.moved_by_gains(epoch, self.most_revealed, self.largest_px);
            let by_rise = background.moved_by_rise(epoch, self.least_px, self.largest_px);
            let by_drift = largest_px * (now.drift - self.drift);
            moved = (by_gains + by_rise).min(by_drift + self.rounding - self.rounding_solid);
            let by_drift = largest_px * (now.drift_revealed - self.drift_revealed);
            by_gains = by_gains.min(by_drift + self.rounding_open - self.rounding_solid);
        }
        let limit = limit + self.rounding_solid + self.slack;
        let along = match only_open {
            true => self.least_along_open - risen,
            false => self.least_along_solid.min(self.least_along_open - risen),
        };
        if self.least_n - now.twice_deviation_sum - moved > limit
            || now.epochs.flipped(epoch) + along - by_gains > limit
        {
            return true;
        }
        let least = if only_open {
            self.least_open
        } else {
            self.least
        };
        least - moved > limit && least - moved - now.epochs.lost_within(epoch, widths) > limit
    }

    /// Not below the excess of any of its leaves.
    #[inline]
    pub(super) fn ceiling(&self, now: &Now<'_>) -> f32 {
        let since = self.largest + now.epochs.risen(self.epoch.into());
        self.largest_n.min(since) + self.margin(now)
    }

    /// Not below `n` of any of its leaves, when nothing is known of the
    /// background's drift but that it was less then.
    #[inline]
    pub(super) fn top(&self) -> Top {
        Top {
            largest_n: self.largest_n + self.rounding + self.slack,
            largest_px: self.largest_px as f32,
        }
    }
}

/// What rules out a block's leaves from being the dearest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    largest_n: f32,
    largest_px: f32,
}

impl Top {
    /// Not below the excess of any of its leaves; `drift` the background's
    /// since the last rebuild.
    #[inline(always)]
    pub(super) fn ceiling(&self, drift: f32) -> f32 {
        self.largest_n + self.largest_px * drift
    }
}
