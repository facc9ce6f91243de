//! What is not as one might expect of a run.

use std::fmt;

use secateur_model::{Facing, Foliage, Leaf, Lod};

use crate::{Fitting, LeafTriangles, Options, Target};

/// A VMI error worth a word, where it was half as large.
const CLEAR_ERROR_PERCENT: f64 = 10.0;

/// What is not as one might expect of a run; shown it is a sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// More leaves were asked for than there are.
    MoreLeavesThanThereAre {
        /// The number asked for.
        asked: usize,
        /// The number of leaves.
        there: usize,
    },
    /// More triangles were asked for than there are.
    MoreTrianglesThanThereAre {
        /// The number asked for.
        asked: usize,
        /// The number of triangles.
        there: usize,
    },
    /// More triangles are left than were asked for.
    TrianglesAboveTarget {
        /// The number asked for.
        asked: usize,
        /// The number that is left.
        left: usize,
    },
    /// Coarser leaves were asked for and would exceed the error asked for.
    NoLeafBecameCoarser {
        /// Triangles that a leaf was to keep at most.
        triangles_at_most: u32,
        /// The error that was not to be exceeded, in per cent.
        max_error_percent: f64,
    },
    /// A fit of sizes was asked for and changed nothing.
    NothingToFit,
    /// A fit of sizes cost information of the driving views.
    FitCostsInformation {
        /// VMI error before the fit, in per cent.
        before_percent: f64,
        /// VMI error after it, in per cent.
        after_percent: f64,
    },
    /// Leaves have materials that clients draw from one side only.
    SingleSidedLeaves {
        /// How many leaves have such materials.
        count: usize,
        /// The number of all leaves.
        there: usize,
    },
    /// Wood that carries the crown to the ground is gone.
    SupportsGone {
        /// How many pieces of it are gone.
        gone: usize,
        /// The number of all of them.
        there: usize,
    },
    /// The GPU failed for this reason, and the CPU took over.
    GpuFailed(String),
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MoreLeavesThanThereAre { asked, there } => write!(
                f,
                "{asked} leaves were asked for and there are {there}: no leaf was removed"
            ),
            Self::MoreTrianglesThanThereAre { asked, there } => write!(
                f,
                "{asked} triangles were asked for and there are {there}: no leaf was removed"
            ),
            Self::TrianglesAboveTarget { asked, left } => write!(
                f,
                "{asked} triangles were asked for, and {left} is as near as it comes"
            ),
            Self::NoLeafBecameCoarser {
                triangles_at_most,
                max_error_percent,
            } => write!(
                f,
                "no leaf became coarser: with {triangles_at_most} triangles a leaf the VMI error would exceed {max_error_percent} %, or none has more"
            ),
            Self::NothingToFit => f.write_str(
                "leaves keep their sizes: none fits better, all looks the same as it is, or the VMI error would exceed what was asked for",
            ),
            Self::FitCostsInformation {
                before_percent,
                after_percent,
            } => write!(
                f,
                "the fitted sizes have a VMI error of {after_percent:.1} % on the driving views, {before_percent:.1} % before: without a fit more of the information is kept"
            ),
            Self::SingleSidedLeaves { count, there } => write!(
                f,
                "{count} of {there} leaves have a material that is not doubleSided: clients cull their back faces, so about half of them are not drawn, and leaves seen from behind count for nothing; set doubleSided if that is not meant"
            ),
            Self::SupportsGone { gone, there } => write!(
                f,
                "{gone} of {there} stems, pots or trunks that carry the crown are gone: they do not fit the budget; ask for more triangles"
            ),
            Self::GpuFailed(reason) => {
                write!(f, "the GPU failed and the CPU took over: {reason}")
            }
        }
    }
}

/// The run that they are about.
pub(crate) struct Ended<'a> {
    pub(crate) options: &'a Options,
    /// In numbers of the foliage.
    pub(crate) target: Target,
    pub(crate) foliage: &'a Foliage,
    pub(crate) lod: &'a Lod,
    pub(crate) is_fitted: bool,
    /// Before a fit and after it, on the driving views, where that is known.
    pub(crate) error_percent: Option<[f64; 2]>,
}

pub(crate) fn warnings(ended: &Ended<'_>) -> Vec<Warning> {
    let is_fit_asked = matches!(ended.options.fit, Fitting::Weight(_) | Fitting::Coverage);
    let all = [
        excess(ended.target, ended.foliage),
        shortfall(ended),
        (is_fit_asked && !ended.is_fitted).then_some(Warning::NothingToFit),
        single_sided(ended.foliage),
        ended.error_percent.and_then(about_fit),
    ];
    all.into_iter().flatten().collect()
}

/// Says that more was asked for than there is.
fn excess(target: Target, foliage: &Foliage) -> Option<Warning> {
    match target {
        Target::Leaves(asked) => {
            let there = foliage.leaves().len();
            let asked = asked.of(there);
            (asked > there).then_some(Warning::MoreLeavesThanThereAre { asked, there })
        }
        Target::Triangles(asked) => {
            let there = foliage.triangles().len();
            let asked = asked.of(there);
            (asked > there).then_some(Warning::MoreTrianglesThanThereAre { asked, there })
        }
        Target::MaxErrorPercent(_) => None,
    }
}

/// What was asked for and is not so at the end.
fn shortfall(ended: &Ended<'_>) -> Option<Warning> {
    let (foliage, lod) = (ended.foliage, ended.lod);
    match (ended.target, ended.options.leaf_triangles) {
        (Target::Triangles(asked), _) => {
            let there = foliage.triangles().len();
            let (asked, left) = (asked.of(there), lod.foliage(foliage).triangles().len());
            (left > asked && left < there).then_some(Warning::TrianglesAboveTarget { asked, left })
        }
        (Target::MaxErrorPercent(max_error_percent), LeafTriangles::AtMost(triangles_at_most))
            if lod.is_of_originals() =>
        {
            Some(Warning::NoLeafBecameCoarser {
                triangles_at_most,
                max_error_percent,
            })
        }
        _ => None,
    }
}

/// Says that leaves are culled.
fn single_sided(foliage: &Foliage) -> Option<Warning> {
    let leaves = foliage.leaves();
    let is_culled = |leaf: &&Leaf| leaf.facing() != Facing::Both;
    let count = leaves.iter().filter(is_culled).count();
    (count > 0).then_some(Warning::SingleSidedLeaves {
        count,
        there: leaves.len(),
    })
}

/// Says that a fit cost information of the driving views.
fn about_fit([before_percent, after_percent]: [f64; 2]) -> Option<Warning> {
    (after_percent > 2.0 * before_percent && after_percent > CLEAR_ERROR_PERCENT).then_some(
        Warning::FitCostsInformation {
            before_percent,
            after_percent,
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::LeafTriangle;

    #[test]
    fn all_that_there_is_is_not_too_much() {
        let mut foliage = Foliage::default();
        let corners = [glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y];
        let leaf = [LeafTriangle::plain(corners); 2];
        foliage.push_leaf(&leaf, None).unwrap();
        assert_eq!(excess(Target::leaves(1), &foliage), None);
        assert_eq!(excess(Target::triangles(2), &foliage), None);
        let leaves = excess(Target::leaves(2), &foliage).unwrap().to_string();
        assert!(leaves.starts_with("2 leaves were asked for and there are 1"));
        let triangles = excess(Target::triangles(3), &foliage).unwrap().to_string();
        assert!(triangles.starts_with("3 triangles were asked for and there are 2"));
    }

    #[test]
    fn a_fit_that_changed_nothing_is_told_of_if_it_was_asked_for() {
        let foliage = Foliage::default();
        let lod = Lod::original(0);
        let told = |fit: Fitting, is_fitted: bool| {
            let options = Options {
                fit,
                ..Options::to(Target::leaves(0))
            };
            let ended = Ended {
                options: &options,
                target: Target::leaves(0),
                foliage: &foliage,
                lod: &lod,
                is_fitted,
                error_percent: Some([0.0; 2]),
            };
            warnings(&ended)
        };
        assert_eq!(told(Fitting::Weight(1.0), false), [Warning::NothingToFit]);
        assert_eq!(told(Fitting::Coverage, false), [Warning::NothingToFit]);
        assert!(told(Fitting::Weight(1.0), true).is_empty());
        assert!(told(Fitting::Auto, false).is_empty());
    }

    #[test]
    fn a_fit_that_costs_information_says_so() {
        assert_eq!(about_fit([8.0, 9.0]), None);
        assert_eq!(about_fit([2.0, 9.9]), None);
        assert_eq!(about_fit([30.0, 50.0]), None);
        let warning = about_fit([10.3, 62.1]).unwrap().to_string();
        assert!(warning.contains("VMI error of 62.1 %") && warning.contains("10.3 % before"));
    }
}
