//! The figures of a difference, what they come to, and how much of it a level may have.

use serde::Serialize;

use super::blocks::ViewScores;

/// By what the mean over the plant is multiplied to be held against its worst block.
pub(super) const OF_MEAN: f64 = 1.75;

/// By what the worst block of wood, or of spots, is multiplied: boughs and fruits within a crown are few pixels, and
/// everyone misses them.
const OF_WOOD: f64 = 0.45;

/// Of how many views, those that show most, the worst block of wood or spots is the mean.
const WOOD_VIEWS: usize = 2;

/// How far a level looks from its plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Difference {
    /// max(B, 1.75 M, .45 W), 0 to 1.75: the greater the worse.
    pub difference: f64,
    /// C: the largest relative difference of covered area in a block with a tenth of plant, 0 or more.
    pub block_coverage: f64,
    /// B: mean FLIP over the worst block, 0 to 1.
    pub worst_block: f64,
    /// M: mean FLIP over the plant's pixels, 0 to 1.
    pub mean: f64,
    /// W: mean FLIP over the wood of the worst block, or over its spots of another colour such as fruits and flowers,
    /// whichever is more; of the two views that show most, 0 to 1; 0 where there are no spots and wood is not known.
    pub worst_wood: f64,
}

impl Difference {
    /// A level with a larger difference is another plant: coarser than for backgrounds.
    pub const ANOTHER_PLANT: f64 = 0.5;

    /// The mean over views.
    pub(super) fn of_views(views: &[ViewScores]) -> Self {
        let mean = |of: fn(&ViewScores) -> f64| {
            views.iter().map(of).sum::<f64>() / views.len().max(1) as f64
        };
        let (worst_block, mean_flip) = (mean(|v| v.worst_block), mean(|v| v.mean));
        // A bough that is gone hides behind leaves from most sides.
        let mut woods: Vec<f64> = views.iter().map(|v| v.worst_wood).collect();
        woods.sort_by(|a, b| b.total_cmp(a));
        woods.truncate(WOOD_VIEWS);
        let worst_wood = woods.iter().sum::<f64>() / woods.len().max(1) as f64;
        Self {
            difference: Self::of_figures(worst_block, mean_flip, worst_wood),
            block_coverage: mean(|v| v.block_coverage),
            worst_block,
            mean: mean_flip,
            worst_wood,
        }
    }

    /// What this, of small pictures, would about be in large ones: each figure grows as it does in two views.
    pub fn enlarged(self, by: &Enlargement) -> Self {
        let figure = |of: fn(&Self) -> f64| match of(&by.small) > 0.0 {
            true => of(&self) * of(&by.large) / of(&by.small),
            false => of(&self).max(of(&by.large)),
        };
        let (worst_block, mean) = (figure(|d| d.worst_block), figure(|d| d.mean));
        let worst_wood = figure(|d| d.worst_wood);
        Self {
            difference: Self::of_figures(worst_block, mean, worst_wood),
            block_coverage: figure(|d| d.block_coverage),
            worst_block,
            mean,
            worst_wood,
        }
    }

    fn of_figures(worst_block: f64, mean: f64, worst_wood: f64) -> f64 {
        worst_block.max(OF_MEAN * mean).max(OF_WOOD * worst_wood)
    }

    /// Each figure the larger one.
    pub(super) fn worse(self, other: Self) -> Self {
        Self {
            difference: self.difference.max(other.difference),
            block_coverage: self.block_coverage.max(other.block_coverage),
            worst_block: self.worst_block.max(other.worst_block),
            mean: self.mean.max(other.mean),
            worst_wood: self.worst_wood.max(other.worst_wood),
        }
    }

    /// How many times the limits this is: above 1 it is beyond one of them.
    pub fn over(&self, limits: Limits) -> f64 {
        let of_difference = self.difference / limits.difference;
        of_difference.max(self.block_coverage / limits.block_coverage)
    }
}

/// The difference of one level in small and in large pictures, from two views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enlargement {
    pub(super) small: Difference,
    pub(super) large: Difference,
}

impl Enlargement {
    /// How many times as far beyond the limits the level is in the large pictures; nothing where that is no number above
    /// 0.
    pub fn times(&self, limits: Limits) -> Option<f64> {
        let times = self.large.over(limits) / self.small.over(limits);
        (times.is_finite() && times > 0.0).then_some(times)
    }
}

/// How much a level may differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// The most that a level may have of [`Difference::difference`], 0 to 1.75; .28 by default.
    pub difference: f64,
    /// The most that a level may have of [`Difference::block_coverage`], 0 or more; .20 by default.
    pub block_coverage: f64,
}

impl Limits {
    /// .28 with .20: of 97 graded pairs all that cannot be told, 18 of 22 that are hard to tell, and none that is
    /// plainly coarser.
    pub const GOOD: Self = Self::of_difference(0.28);

    /// A difference with its share of coverage: .20 for .28, and as much more or less for others.
    pub const fn of_difference(difference: f64) -> Self {
        Self {
            difference,
            block_coverage: difference * (0.20 / 0.28),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures([worst_block, mean, worst_wood, block_coverage]: [f64; 4]) -> Difference {
        Difference {
            difference: Difference::of_figures(worst_block, mean, worst_wood),
            block_coverage,
            worst_block,
            mean,
            worst_wood,
        }
    }

    /// Wood is twice as far off in large pictures, and is then the largest figure; what small ones do not show of
    /// coverage is taken from the large ones.
    #[test]
    fn each_figure_grows_as_in_two_views() {
        let by = Enlargement {
            small: figures([0.1, 0.05, 0.25, 0.0]),
            large: figures([0.125, 0.04, 0.5, 0.03]),
        };
        let all = figures([0.16, 0.05, 0.3, 0.01]);
        assert_eq!(all.difference, 0.16);
        let large = all.enlarged(&by);
        let expected = [
            (0.2, large.worst_block),
            (0.04, large.mean),
            (0.6, large.worst_wood),
        ];
        for (expected, found) in expected {
            assert!((expected - found).abs() < 1e-12, "{found}");
        }
        assert_eq!(large.block_coverage, 0.03);
        assert_eq!(large.difference, OF_WOOD * large.worst_wood);
        // .225 for .1125 of the same limits.
        assert_eq!(by.times(Limits::of_difference(0.28)), Some(2.0));
        let none = Enlargement {
            small: Difference::default(),
            ..by
        };
        assert_eq!(none.times(Limits::GOOD), None);
    }
}
