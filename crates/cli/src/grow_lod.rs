//! `secateur grow --lod`: a level of detail by the plant's own branches.

use std::str::FromStr;

use schemars::JsonSchema;
use secateur_plant::{Chain, Metric, Record, Skeleton, check_depth, merge_levels};
use serde::Serialize;

use super::args::{self, LodMethod};
use super::failure::Failure;

/// Which level is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Amount {
    /// A level of a chain or of a merging, by its number from 1.
    Level(usize),
    /// At most this share of the leaves, above 0 and up to 1.
    Share(f64),
}

impl FromStr for Amount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text.parse(), text.parse::<f64>()) {
            (Ok(level), _) if level > 0 => Ok(Self::Level(level)),
            (Err(_), Ok(share)) if share > 0.0 && share <= 1.0 => Ok(Self::Share(share)),
            _ => Err("write a level, a whole number from 1, or a share such as 0.25".to_owned()),
        }
    }
}

/// A level and what there is to say about it.
pub(crate) struct GrownLevel {
    pub(crate) skeleton: Skeleton,
    pub(crate) name: String,
    pub(crate) record: GrownLodRecord,
}

/// A level of detail by the plant's own branches.
#[derive(Clone, Serialize, JsonSchema)]
pub(crate) struct GrownLodRecord {
    /// `chain` or `merge`.
    method: &'static str,
    /// The number of the level, from 1.
    level: usize,
    /// How many there are.
    levels: usize,
    /// merge: the thinnest stick that is left as it was, in metres, if any is.
    threshold: Option<f64>,
    /// merge: sticks that others stand for.
    sticks_replaced: Option<usize>,
    leaves_original: usize,
}

/// The level that is asked for of this plant.
pub(crate) fn level(
    name: &str,
    skeleton: &Skeleton,
    amount: Amount,
    args: &args::Grow,
) -> Result<GrownLevel, Failure> {
    check_depth(&skeleton.segments).map_err(|e| Failure::input(format!("{name}: {e}")))?;
    match args.lod_method {
        LodMethod::Chain => of_chain(name, skeleton, amount),
        LodMethod::Merge => of_scheme(name, skeleton, amount, args),
    }
}

fn of_chain(name: &str, skeleton: &Skeleton, amount: Amount) -> Result<GrownLevel, Failure> {
    let chain = Chain::of(skeleton, Metric::BranchingLength);
    let levels = match amount {
        Amount::Level(level) => level,
        Amount::Share(share) => {
            let most = (share * skeleton.leaves.len() as f64).round() as usize;
            levels_with(&chain, most)
        }
    };
    check(name, levels, chain.levels())?;
    Ok(GrownLevel {
        skeleton: chain.skeleton(levels),
        name: format!("{levels} of {} levels of its chain", chain.levels()),
        record: GrownLodRecord {
            method: "chain",
            level: levels,
            levels: chain.levels(),
            threshold: None,
            sticks_replaced: None,
            leaves_original: skeleton.leaves.len(),
        },
    })
}

/// The number of levels that bear at most this many leaves, at least 1.
fn levels_with(chain: &Chain, most: usize) -> usize {
    let (mut levels, mut leaves) = (0, 0);
    for record in chain.records() {
        match record {
            Record::Level => levels += 1,
            Record::Leaf(..) => leaves += 1,
            _ => {}
        }
        if leaves > most {
            return (levels - 1).max(1);
        }
    }
    levels
}

fn of_scheme(
    name: &str,
    skeleton: &Skeleton,
    amount: Amount,
    args: &args::Grow,
) -> Result<GrownLevel, Failure> {
    let levels = merge_levels(skeleton, &args.scheme, args.cluster_size);
    let count = levels.len();
    let number = match amount {
        Amount::Level(level) => level,
        Amount::Share(share) => {
            let most = (share * skeleton.leaves.len() as f64).round() as usize;
            let fits = |leaves: usize| leaves <= most;
            let first = levels.iter().position(|l| fits(l.skeleton.leaves.len()));
            first.map_or(count, |place| place + 1)
        }
    };
    check(name, number, count)?;
    let level = levels.into_iter().nth(number - 1);
    let level = level.expect("the number of a level was checked");
    Ok(GrownLevel {
        name: format!("level {number} of {count} by merging"),
        record: GrownLodRecord {
            method: "merge",
            level: number,
            levels: count,
            threshold: Some(level.threshold).filter(|threshold| threshold.is_finite()),
            sticks_replaced: Some(level.replaced),
            leaves_original: skeleton.leaves.len(),
        },
        skeleton: level.skeleton,
    })
}

fn check(name: &str, level: usize, levels: usize) -> Result<(), Failure> {
    match level <= levels {
        true => Ok(()),
        false => Err(Failure::input(format!(
            "{name} has {levels} levels of detail, not {level}"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_makes_a_share() {
        assert_eq!("3".parse(), Ok(Amount::Level(3)));
        assert_eq!("1".parse(), Ok(Amount::Level(1)));
        assert_eq!("1.0".parse(), Ok(Amount::Share(1.0)));
        assert_eq!("0.25".parse(), Ok(Amount::Share(0.25)));
        for bad in ["0", "-1", "0.0", "1.5", "nan", "inf", "many", ""] {
            assert!(bad.parse::<Amount>().is_err(), "{bad}");
        }
    }
}
