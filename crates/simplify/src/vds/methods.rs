//! VDS as a method beside others: fast, and literal.

use secateur_model::{Foliage, PlantSkeleton};
use secateur_raster::CpuRasteriser;
use secateur_raster::measure::vmi::ScaledBits;
use secateur_raster::occluders::Occluded;

use super::{Progress, VdsError, VdsOptions, VdsOutcome, VdsRun, fast, reference};
use crate::Error;
use crate::observe::Shown;
use crate::select::{Select, Selection, Steps, Task};

/// VDS by the exact, fast engine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fast(pub VdsOptions);

/// VDS by Algorithm 1, taken literally.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Literal(pub VdsOptions);

impl Select for Fast {
    fn check(&self, _: &Foliage, _: Option<&PlantSkeleton>) -> Result<(), Error> {
        Ok(())
    }

    fn select(&self, task: &Task<'_>, steps: &mut Steps<'_>) -> Result<Selection, Error> {
        let mut see = |progress: Progress| steps(progress.steps, progress.steps_at_most);
        let run = run(self.0, task);
        selection(fast::simplify_from(
            task.foliage,
            &run,
            task.begun,
            task.rasteriser,
            &mut see,
        ))
    }
}

impl Select for Literal {
    fn check(&self, _: &Foliage, _: Option<&PlantSkeleton>) -> Result<(), Error> {
        Ok(())
    }

    fn select(&self, task: &Task<'_>, steps: &mut Steps<'_>) -> Result<Selection, Error> {
        let mut see = |progress: Progress| steps(progress.steps, progress.steps_at_most);
        let run = run(self.0, task);
        selection(match task.occluders {
            Some(occluders) => {
                let rasteriser = Occluded {
                    rasteriser: &CpuRasteriser,
                    occluders,
                };
                reference::simplify_drawn_by(&rasteriser, task.foliage, &run, &mut see)
            }
            None => reference::simplify(task.foliage, &run, &mut see),
        })
    }
}

fn run(options: VdsOptions, task: &Task<'_>) -> VdsRun {
    VdsRun {
        options,
        views: task.views.clone(),
        resolution: task.resolution,
        target: task.target,
    }
}

fn selection(outcome: Result<VdsOutcome, VdsError>) -> Result<Selection, Error> {
    let outcome = outcome?;
    Ok(Selection {
        order: outcome.order,
        costs: outcome.costs_scaled.into_iter().map(ScaledBits).collect(),
        shown: Some(Shown {
            views: outcome.views,
            areas: outcome.areas,
            vmi_original: outcome.vmi_original,
            vmi: outcome.vmi_final,
        }),
        is_at_max_error: outcome.is_at_max_error,
    })
}
