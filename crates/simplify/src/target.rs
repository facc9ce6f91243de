//! How far a plant is simplified.

use secateur_model::{Foliage, LeafId};
use serde::{Deserialize, Serialize};

use crate::Error;

/// A number of things, or a share of those that there are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Amount {
    /// An absolute number; more than there are means all.
    Count(u64),
    /// This share, 0 to 1, rounded to the nearest number.
    Share(f64),
}

impl Amount {
    /// The number, where there are `total` of them.
    pub fn of(self, total: usize) -> usize {
        match self {
            Self::Count(count) => usize::try_from(count).unwrap_or(usize::MAX),
            Self::Share(share) => (share * total as f64).round() as usize,
        }
    }
}

/// How far a run goes: what is left at its end, or what it may lose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// At this many leaves. If that is more than there are, nothing is removed, and a
    /// warning says so.
    Leaves(Amount),
    /// At this many triangles of the foliage, or as few below as whole leaves and collapses of
    /// their edges allow. A mesh simplifier, which knows no leaves, may end above.
    Triangles(Amount),
    /// Before the first step after which the VMI error on the driving views would exceed this
    /// many per cent.
    MaxErrorPercent(f64),
}

impl Target {
    /// At this many leaves.
    pub fn leaves(count: u64) -> Self {
        Self::Leaves(Amount::Count(count))
    }

    /// At this share of the leaves, 0 to 1.
    pub fn leaf_share(share: f64) -> Self {
        Self::Leaves(Amount::Share(share))
    }

    /// At this many triangles of the foliage.
    pub fn triangles(count: u64) -> Self {
        Self::Triangles(Amount::Count(count))
    }

    /// At this share of the foliage's triangles, 0 to 1.
    pub fn triangle_share(share: f64) -> Self {
        Self::Triangles(Amount::Share(share))
    }

    /// Whether its number is in range.
    ///
    /// # Errors
    /// [`Error::Target`] if it is not.
    pub fn check(self) -> Result<(), Error> {
        let refused = |what: String, range| Err(Error::Target(what, range));
        match self {
            Self::Leaves(Amount::Share(share)) | Self::Triangles(Amount::Share(share))
                if !(0.0..=1.0).contains(&share) =>
            {
                refused(format!("ratio {share}"), "a number from 0 to 1")
            }
            Self::MaxErrorPercent(percent) if percent.is_nan() || percent < 0.0 => {
                refused(format!("{percent} % error"), "a number from 0 upwards")
            }
            Self::Leaves(_) | Self::Triangles(_) | Self::MaxErrorPercent(_) => Ok(()),
        }
    }

    /// The target in numbers of this foliage.
    pub(crate) fn counted(self, foliage: &Foliage) -> Self {
        let count = |amount: Amount, total| Amount::Count(amount.of(total) as u64);
        match self {
            Self::Leaves(amount) => Self::Leaves(count(amount, foliage.leaves().len())),
            Self::Triangles(amount) => Self::Triangles(count(amount, foliage.triangles().len())),
            Self::MaxErrorPercent(percent) => Self::MaxErrorPercent(percent),
        }
    }

    /// The number of triangles to stop at, if that is the target.
    pub(crate) fn triangle_count(self, foliage: &Foliage) -> Option<usize> {
        match self {
            Self::Triangles(amount) => Some(amount.of(foliage.triangles().len())),
            Self::Leaves(_) | Self::MaxErrorPercent(_) => None,
        }
    }

    /// The error to stop before, if that is the target.
    pub(crate) fn max_error_percent(self) -> Option<f64> {
        match self {
            Self::MaxErrorPercent(percent) => Some(percent),
            Self::Leaves(_) | Self::Triangles(_) => None,
        }
    }

    /// The number of leaves to stop at, if that is the target; else none is certain to stay.
    pub(crate) fn leaves_to_stop_at(self, foliage: &Foliage) -> usize {
        match self {
            Self::Leaves(amount) => amount.of(foliage.leaves().len()),
            Self::Triangles(_) | Self::MaxErrorPercent(_) => 0,
        }
    }

    /// The number of leaves at which the target is reached whichever leaves are left, where
    /// leaves keep their triangles.
    pub(crate) fn fewest_leaves(self, foliage: &Foliage) -> usize {
        match self.triangle_count(foliage) {
            Some(at_most) => leaves_within(foliage, at_most),
            None => self.leaves_to_stop_at(foliage),
        }
    }
}

/// The largest number of leaves that have no more than this many triangles together, whichever
/// leaves they are.
fn leaves_within(foliage: &Foliage, triangles_at_most: usize) -> usize {
    let leaves = (0..foliage.leaves().len()).map(LeafId::from_index);
    let mut counts: Vec<usize> = leaves.map(|l| foliage.triangles_of(l).len()).collect();
    counts.sort_unstable_by(|a, b| b.cmp(a));
    let mut sum = 0;
    let fits = counts.iter().take_while(|&&count| {
        sum += count;
        sum <= triangles_at_most
    });
    fits.count()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    use super::*;

    /// Leaf k has k triangles.
    fn foliage(leaves: usize) -> Foliage {
        let triangle = LeafTriangle::plain([DVec3::ZERO, DVec3::X, DVec3::Y]);
        let mut foliage = Foliage::default();
        for k in 1..=leaves {
            foliage.push_leaf(&vec![triangle; k], None).unwrap();
        }
        foliage
    }

    #[test]
    fn shares_round_to_the_nearest_count() {
        // 1.5 and 2.25; all; none.
        let of_15 = [0.1, 0.15, 1.0, 0.0].map(|share| Amount::Share(share).of(15));
        assert_eq!(of_15, [2, 2, 15, 0]);
        assert_eq!(Amount::Share(0.25).of(30), 8);
        assert_eq!(Amount::Count(7).of(3), 7);
    }

    #[test]
    fn targets_out_of_range_are_refused() {
        for target in [
            Target::leaf_share(1.01),
            Target::leaf_share(-0.1),
            Target::leaf_share(f64::NAN),
            Target::triangle_share(1.01),
            Target::MaxErrorPercent(-1.0),
            Target::MaxErrorPercent(f64::NAN),
        ] {
            assert!(target.check().is_err(), "{target:?}");
        }
        let error = Target::leaf_share(1.5).check().unwrap_err().to_string();
        assert_eq!(
            error,
            "the target of ratio 1.5 must be a number from 0 to 1"
        );
    }

    #[test]
    fn as_many_leaves_are_within_a_budget_as_the_largest_allow() {
        // Of 1, 2, 3 and 4 triangles.
        let foliage = foliage(4);
        let fewest = |triangles| Target::triangles(triangles).fewest_leaves(&foliage);
        assert_eq!([0, 3, 4, 6, 7, 9, 10].map(fewest), [0, 0, 1, 1, 2, 3, 4]);
        assert_eq!(Target::leaves(2).fewest_leaves(&foliage), 2);
        assert_eq!(Target::MaxErrorPercent(1.0).fewest_leaves(&foliage), 0);
    }
}
