//! The view sets that a run goes through.

use secateur_model::Foliage;
use secateur_raster::{MAX_RESOLUTION, MAX_TOTAL_PIXELS, ViewSet};

use super::{VdsError, VdsOptions, VdsRun, ViewPlan};

/// A stretch of a run with one view set.
pub(crate) struct Phase {
    pub views: ViewSet,
    /// The phase ends when this many leaves are left.
    pub leaves_at_end: usize,
}

/// The phases of a run over a foliage, in order; the last ends at the number of leaves that the
/// run goes down to. There is always one.
pub(crate) fn phases(run: &VdsRun, foliage: &Foliage) -> Result<Vec<Phase>, VdsError> {
    check_options(&run.options)?;
    let fewest = run.target.fewest_leaves(foliage);
    phases_down_to(&run.views, run.resolution, foliage.leaves().len(), fewest)
}

fn check_options(options: &VdsOptions) -> Result<(), VdsError> {
    if options.neighbours == 0 {
        return Err(VdsError::NoNeighbours);
    }
    let is_wrong = |max: &f64| max.is_nan() || *max < 0.0;
    match options.max_coverage.filter(is_wrong) {
        Some(max) => Err(VdsError::MaxCoverage(max)),
        None => Ok(()),
    }
}

fn phases_down_to(
    plan: &ViewPlan,
    resolution: u32,
    leaf_count: usize,
    leaves: usize,
) -> Result<Vec<Phase>, VdsError> {
    let target = leaves.min(leaf_count);
    let phases = match plan {
        ViewPlan::Fixed(views) => vec![Phase {
            views: views.clone(),
            leaves_at_end: target,
        }],
        ViewPlan::Staged(stages) => {
            let mut phases: Vec<Phase> = Vec::new();
            for stage in stages {
                let leaves_at_end =
                    (leaf_count - leaf_count * stage.gone_per_mille.min(1000) / 1000).max(target);
                // Of few leaves a stage may have none to remove.
                if phases
                    .last()
                    .is_some_and(|last| last.leaves_at_end == leaves_at_end)
                {
                    continue;
                }
                phases.push(Phase {
                    views: stage.views.clone(),
                    leaves_at_end,
                });
                if leaves_at_end == target {
                    break;
                }
            }
            if let Some(last) = phases.last_mut() {
                last.leaves_at_end = target;
            }
            phases
        }
    };
    if phases.is_empty() {
        return Err(VdsError::NoViews);
    }
    for phase in &phases {
        check(&phase.views, resolution)?;
    }
    Ok(phases)
}

/// The phase in which a run is that ended with this number of leaves.
pub(crate) fn final_phase(phases: &[Phase], leaves_left: usize) -> &Phase {
    let ended = |phase: &&Phase| phase.leaves_at_end <= leaves_left;
    let found = phases.iter().find(ended);
    found.expect("the last phase ends at the target")
}

/// The views of the last step of a run that goes from `leaf_count` leaves to
/// `leaves_left`.
///
/// # Errors
/// [`VdsError`] if the resolution is out of range.
pub(crate) fn final_views(
    plan: &ViewPlan,
    resolution: u32,
    leaf_count: usize,
    leaves_left: usize,
) -> Result<ViewSet, VdsError> {
    let phases = phases_down_to(plan, resolution, leaf_count, leaves_left)?;
    Ok(final_phase(&phases, leaves_left.min(leaf_count))
        .views
        .clone())
}

fn check(views: &ViewSet, resolution: u32) -> Result<(), VdsError> {
    if views.is_empty() {
        return Err(VdsError::NoViews);
    }
    let pixels = u64::from(resolution) * u64::from(resolution) * views.len() as u64;
    if resolution == 0 || resolution > MAX_RESOLUTION || pixels > MAX_TOTAL_PIXELS {
        return Err(VdsError::Resolution {
            views: views.len(),
            resolution,
            max: MAX_RESOLUTION,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::BoundingSphere;

    #[test]
    fn the_variable_plan_has_the_papers_ranges() {
        let sphere = BoundingSphere {
            centre: glam::DVec3::ZERO,
            radius: 1.0,
        };
        let variable = ViewPlan::variable(sphere);
        let plan = |leaves| {
            let phases = phases_down_to(&variable, 64, 1000, leaves).unwrap();
            phases
                .iter()
                .map(|p| (p.views.len(), p.leaves_at_end))
                .collect::<Vec<_>>()
        };
        assert_eq!(plan(100), [(20, 900), (12, 700), (8, 500), (6, 100)]);
        assert_eq!(plan(600), [(20, 900), (12, 700), (8, 600)]);
        assert_eq!(plan(950), [(20, 950)]);
        assert_eq!(plan(5000), [(20, 1000),], "nothing to do");

        let turning = phases_down_to(&ViewPlan::turning(sphere), 64, 1000, 3).unwrap();
        let ends: Vec<usize> = turning.iter().map(|p| p.leaves_at_end).collect();
        assert_eq!(ends[..4], [700, 500, 350, 250]);
        assert_eq!(ends[13..], [7, 5, 3]);
        assert!(turning.iter().all(|phase| phase.views.len() == 20));
        assert!(turning[0].views == turning[4].views && turning[0].views != turning[1].views);

        let views = |left| final_views(&variable, 64, 1000, left).unwrap().len();
        assert_eq!([1000, 900, 899, 600, 100].map(views), [20, 20, 12, 8, 6]);
    }
}
