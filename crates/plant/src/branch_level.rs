//! A level of detail of a plant that grows, by its own branches.

use std::str::FromStr;

use crate::rule_source::RuleSourceError;
use crate::{
    Chain, ClusterSize, Metric, Record, Scheme, Skeleton, StickSize, Thresholds, check_depth,
    merge_below, merge_levels,
};

/// Which level is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchAmount {
    /// A level of a branch chain or of a merging, by its number from 1.
    Level(usize),
    /// At most this share of the leaves, above 0 and up to 1.
    Share(f64),
}

impl BranchAmount {
    fn leaves_of(share: f64, skeleton: &Skeleton) -> usize {
        (share * skeleton.leaves.len() as f64).round() as usize
    }
}

impl FromStr for BranchAmount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text.parse(), text.parse::<f64>()) {
            (Ok(level), _) if level > 0 => Ok(Self::Level(level)),
            (Err(_), Ok(share)) if share > 0.0 && share <= 1.0 => Ok(Self::Share(share)),
            _ => Err("write a level, a whole number from 1, or a share such as 0.25".to_owned()),
        }
    }
}

/// How levels of detail are made of a plant that grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum BranchMethod {
    /// Paths of branches, the longest branching first; every prefix is a plant
    #[default]
    Chain,
    /// Sticks and leaf clusters merged from the twigs down, by a scheme or thresholds
    Merge,
}

/// Which level of detail of a plant that grows is wanted.
#[derive(Clone, Debug)]
pub struct BranchLevelOptions {
    /// Which level.
    pub amount: BranchAmount,
    /// How levels are made.
    pub method: BranchMethod,
    /// Merge: which share of the sticks each level takes away.
    pub scheme: Scheme,
    /// Merge: in place of the scheme, which sticks each level replaces.
    pub thresholds: Option<Thresholds>,
    /// Merge: how large clusters of leaves are.
    pub cluster_size: ClusterSize,
}

/// What a level of detail of a plant that grows is.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchLevel {
    /// How it was made.
    pub method: BranchMethod,
    /// The number of the level, from 1.
    pub level: usize,
    /// How many there are.
    pub levels: usize,
    /// Merge: sticks above this height over radius (HR) were replaced; none where all were that
    /// can be, or where the threshold is a thickness.
    pub height_over_radius: Option<f64>,
    /// Merge: sticks thinner than this were replaced, in metres; none by HR.
    pub thickness_m: Option<f64>,
    /// Merge: sticks that others stand for.
    pub sticks_replaced: Option<usize>,
    /// Leaves of the plant itself.
    pub leaves_original: usize,
}

impl BranchLevelOptions {
    /// The level of this plant.
    pub(crate) fn level(
        &self,
        name: &str,
        skeleton: &Skeleton,
    ) -> Result<(Skeleton, BranchLevel), RuleSourceError> {
        check_depth(&skeleton.segments).map_err(|source| RuleSourceError::TooDeep {
            name: name.to_owned(),
            source,
        })?;
        match self.method {
            BranchMethod::Chain => self.of_chain(name, skeleton),
            BranchMethod::Merge => self.of_merging(name, skeleton),
        }
    }

    fn of_chain(
        &self,
        name: &str,
        skeleton: &Skeleton,
    ) -> Result<(Skeleton, BranchLevel), RuleSourceError> {
        let chain = Chain::of(skeleton, Metric::BranchingLength);
        let level = match self.amount {
            BranchAmount::Level(level) => level,
            BranchAmount::Share(share) => {
                levels_with(&chain, BranchAmount::leaves_of(share, skeleton))
            }
        };
        check(name, level, chain.levels())?;
        let facts = BranchLevel {
            method: self.method,
            level,
            levels: chain.levels(),
            height_over_radius: None,
            thickness_m: None,
            sticks_replaced: None,
            leaves_original: skeleton.leaves.len(),
        };
        Ok((chain.skeleton(level), facts))
    }

    fn of_merging(
        &self,
        name: &str,
        skeleton: &Skeleton,
    ) -> Result<(Skeleton, BranchLevel), RuleSourceError> {
        let levels = match &self.thresholds {
            Some(thresholds) => merge_below(skeleton, thresholds, self.cluster_size),
            None => merge_levels(skeleton, &self.scheme, self.cluster_size),
        };
        let count = levels.len();
        let number = match self.amount {
            BranchAmount::Level(level) => level,
            BranchAmount::Share(share) => {
                let most = BranchAmount::leaves_of(share, skeleton);
                let first = levels.iter().position(|l| l.skeleton.leaves.len() <= most);
                first.map_or(count, |place| place + 1)
            }
        };
        check(name, number, count)?;
        let level = levels.into_iter().nth(number - 1);
        let level = level.expect("the number of a level was checked");
        let of = self.thresholds.as_ref().map(Thresholds::of);
        let is_thickness = of == Some(StickSize::Thickness);
        let threshold = Some(level.threshold).filter(|threshold| threshold.is_finite());
        let facts = BranchLevel {
            method: self.method,
            level: number,
            levels: count,
            height_over_radius: threshold.filter(|_| !is_thickness),
            thickness_m: threshold.filter(|_| is_thickness),
            sticks_replaced: Some(level.replaced),
            leaves_original: skeleton.leaves.len(),
        };
        Ok((level.skeleton, facts))
    }
}

/// The number of levels that bear at most this many leaves, at least 1.
fn levels_with(chain: &Chain, most: usize) -> usize {
    let (mut levels, mut leaves) = (0, 0);
    for record in chain.records() {
        match record {
            Record::Level => levels += 1,
            Record::Leaf(..) => leaves += 1,
            Record::Save(_) | Record::Restore(_) | Record::Segment(_) => {}
        }
        if leaves > most {
            return (levels - 1).max(1);
        }
    }
    levels
}

fn check(name: &str, level: usize, levels: usize) -> Result<(), RuleSourceError> {
    match level <= levels {
        true => Ok(()),
        false => Err(RuleSourceError::NoLevel {
            name: name.to_owned(),
            levels,
            level,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_makes_a_share() {
        assert_eq!("3".parse(), Ok(BranchAmount::Level(3)));
        assert_eq!("1".parse(), Ok(BranchAmount::Level(1)));
        assert_eq!("1.0".parse(), Ok(BranchAmount::Share(1.0)));
        assert_eq!("0.25".parse(), Ok(BranchAmount::Share(0.25)));
        for bad in ["0", "-1", "0.0", "1.5", "nan", "inf", "many", ""] {
            assert!(bad.parse::<BranchAmount>().is_err(), "{bad}");
        }
    }
}
