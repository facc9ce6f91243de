//! What is not as one might expect of a run, a sentence each.

use secateur_model::{Foliage, Lod};

use crate::settings::Goal;
use crate::{Fitting, LeafTriangles, Simplify};

/// A VMI error worth a word, where it was half as large.
const CLEAR_ERROR_PERCENT: f64 = 10.0;

/// The run that they are about.
pub(crate) struct Ended<'a> {
    pub(crate) settings: &'a Simplify,
    pub(crate) goal: Goal,
    pub(crate) foliage: &'a Foliage,
    pub(crate) lod: &'a Lod,
    pub(crate) is_fitted: bool,
    /// Before a fit and after it, on the driving views.
    pub(crate) error_percent: [f64; 2],
}

pub(crate) fn warnings(ended: &Ended<'_>) -> Vec<String> {
    let Ended {
        settings,
        goal,
        foliage,
        lod,
        ..
    } = *ended;
    let [before_percent, after_percent] = ended.error_percent;
    let is_fit_missing =
        matches!(settings.fit, Fitting::Weight(_) | Fitting::Coverage) && !ended.is_fitted;
    let all = [
        excess(goal, foliage),
        shortfall(settings, goal, foliage, lod),
        is_fit_missing.then(|| NOTHING_FITS.to_owned()),
        about_fit(before_percent, after_percent),
    ];
    all.into_iter().flatten().collect()
}

/// That more was asked for than there is.
fn excess(goal: Goal, foliage: &Foliage) -> Option<String> {
    let (asked, there, what) = match goal {
        Goal::Leaves(leaves) => (leaves, foliage.leaves().len(), "leaves"),
        Goal::Triangles(triangles) => (triangles, foliage.triangles().len(), "triangles"),
        Goal::MaxError(_) => return None,
    };
    (asked > there).then(|| {
        format!("{asked} {what} were asked for and there are {there}: no leaf was removed")
    })
}

/// What was asked for and is not so at the end.
fn shortfall(settings: &Simplify, goal: Goal, foliage: &Foliage, lod: &Lod) -> Option<String> {
    match (goal, settings.leaf_triangles) {
        (Goal::Triangles(asked), _) => {
            let left = lod.foliage(foliage).triangles().len();
            (left > asked && left < foliage.triangles().len()).then(|| {
                format!("{asked} triangles were asked for, and {left} is as near as it comes")
            })
        }
        (Goal::MaxError(percent), LeafTriangles::AtMost(most)) if lod.is_of_originals() => {
            Some(format!(
                "no leaf became coarser: with {most} triangles a leaf the VMI error would exceed {percent} %, or none has more"
            ))
        }
        _ => None,
    }
}

/// A fit was asked for and changed nothing.
const NOTHING_FITS: &str = "leaves keep their sizes: none fits better, all looks the same as it is, or the VMI error would exceed what was asked for";

/// That a fit cost information of the driving views.
fn about_fit(before_percent: f64, after_percent: f64) -> Option<String> {
    (after_percent > 2.0 * before_percent && after_percent > CLEAR_ERROR_PERCENT).then(|| {
        format!(
            "the fitted sizes have a VMI error of {after_percent:.1} % on the driving views, {before_percent:.1} % before: `--fit=none` keeps more of the information"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;
    use secateur_model::LeafTriangle;

    #[test]
    fn all_that_there_is_is_not_too_much() {
        let mut foliage = Foliage::default();
        let corners = [glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y];
        let leaf = [LeafTriangle::plain(corners); 2];
        foliage.push_leaf(&leaf, None).unwrap();
        assert_eq!(excess(Goal::Leaves(1), &foliage), None);
        assert_eq!(excess(Goal::Triangles(2), &foliage), None);
        let leaves = excess(Goal::Leaves(2), &foliage).unwrap();
        assert!(leaves.starts_with("2 leaves were asked for and there are 1"));
        let triangles = excess(Goal::Triangles(3), &foliage).unwrap();
        assert!(triangles.starts_with("3 triangles were asked for and there are 2"));
    }

    #[test]
    fn a_fit_that_changed_nothing_is_told_of_if_it_was_asked_for() {
        let foliage = Foliage::default();
        let lod = Lod::original(0);
        let told = |fit: Fitting, is_fitted: bool| {
            let settings = Simplify {
                fit,
                ..Simplify::to(Target::Leaves(0))
            };
            let ended = Ended {
                settings: &settings,
                goal: Goal::Leaves(0),
                foliage: &foliage,
                lod: &lod,
                is_fitted,
                error_percent: [0.0; 2],
            };
            warnings(&ended)
        };
        assert_eq!(told(Fitting::Weight(1.0), false), [NOTHING_FITS]);
        assert_eq!(told(Fitting::Coverage, false), [NOTHING_FITS]);
        assert!(told(Fitting::Weight(1.0), true).is_empty());
        assert!(told(Fitting::Auto, false).is_empty());
    }

    #[test]
    fn a_fit_that_costs_information_says_so() {
        assert_eq!(about_fit(8.0, 9.0), None);
        assert_eq!(about_fit(2.0, 9.9), None);
        assert_eq!(about_fit(30.0, 50.0), None);
        let warning = about_fit(10.3, 62.1).unwrap();
        assert!(warning.contains("VMI error of 62.1 %") && warning.contains("10.3 % before"));
    }
}
