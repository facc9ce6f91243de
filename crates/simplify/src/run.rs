//! A foliage and options in, a LOD and what led to it out: coarsen, select, widen, size.

mod selecting;

use std::ops::ControlFlow;

use secateur_model::{BoundingSphere, Budget, Foliage, Lod};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::{ScaledBits, Vmi};
use secateur_raster::occluders::Occluded;
use secateur_raster::{MAX_TOTAL_PIXELS, OpenEngine, Rasteriser, Scene};

use crate::audit::audit;
use crate::auto_views::views_for;
use crate::last_views::{LastLook, is_left_looked_at};
use crate::memory::{Within, take_run};
use crate::observe::observe;
use crate::passes::Passes;
use crate::resolution::resolution_for;
use crate::shared::Shared;
use crate::sizes::{SizePass, is_fit_spared};
use crate::stage::{Clock, Observer, Stage};
use crate::vds::{ViewPlan, final_views};
use crate::warning::{Ended, Warning, warnings};
use crate::{Error, Options, Simplified, Stopped, Target, as_seen, sphere_of};

/// Simplifies a foliage.
///
/// Time is about in proportion to the leaves at equal crown density, and to the
/// number of views times the pixels that a leaf covers; memory about 20 bytes a
/// fragment and 12 a pixel, and where sizes are fitted, after that, what
/// [`fit`](crate::fit::fit()) says.
/// [`Method::VdsReference`](crate::Method::VdsReference) takes views x leaves^2 / 2 drawings.
///
/// # Errors
/// [`Error`] if the foliage is empty or out of range, an option is, the GPU
/// that was asked for is missing or fails, or the result does not pass the audit.
///
/// ```
/// use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
/// use secateur_simplify::{Options, Resolution, Target, simplify};
///
/// let foliage = ellipsoid_crown(300, 1, &EllipsoidCrown::default())?;
/// let mut options = Options::to(Target::leaf_share(0.5));
/// options.resolution = Resolution::Pixels(64);
/// let result = simplify(&foliage, &options)?;
/// assert_eq!(result.lod.leaf_count(), 150);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify(foliage: &Foliage, options: &Options) -> Result<Simplified, Error> {
    let engine = OpenEngine::open(options.engine)?;
    simplify_on(
        &engine,
        foliage,
        options,
        &mut |_| ControlFlow::Continue(()),
    )
}

/// [`simplify`] on an engine that is open already, whatever [`Options::engine`] says, and watched:
/// `observer` is called when a stage begins and after every step; it may break off the run.
///
/// # Errors
/// As [`simplify`]; [`Error::Stopped`] if it was broken off.
pub fn simplify_on(
    engine: &OpenEngine,
    foliage: &Foliage,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Simplified, Error> {
    simplify_sharing(engine, foliage, options, None, observer)
}

/// [`simplify_on`], several times with different targets: what one run finds the next goes on from.
/// Foliage and options other than the target must be the same each time.
///
/// # Errors
/// As [`simplify_on`].
pub fn simplify_sharing(
    engine: &OpenEngine,
    foliage: &Foliage,
    options: &Options,
    mut shared: Option<&mut Shared>,
    observer: &mut Observer<'_>,
) -> Result<Simplified, Error> {
    let foliage = as_seen(foliage, options.alpha, options.sides);
    let sphere = sphere_of(&foliage)?;
    options.target.check()?;
    options.check(&foliage)?;
    let mut clock = Clock::new(observer);

    clock.begin(Stage::Resolution)?;
    let (resolution, resolution_reason) =
        resolution_for(&foliage, options, sphere, engine, shared.as_deref_mut())?;
    let chosen = views_for(
        &foliage,
        options,
        sphere,
        resolution,
        engine,
        shared.as_deref_mut(),
    )?;
    let options = &Options {
        views: chosen.views,
        ..options.clone()
    };
    let mut budget = Budget::new(options.memory);
    let views = options.first_views(sphere);
    // More pixels than can be counted are refused later, in words that no memory helps.
    if u64::from(resolution).pow(2) * views.len() as u64 <= MAX_TOTAL_PIXELS {
        take_run(&mut budget, &foliage, options, &views, resolution)?;
    }
    let within = Within { engine, budget };
    let occluders = options
        .occluders
        .as_ref()
        .filter(|occluders| !occluders.leaves().is_empty())
        .map(|occluders| as_seen(occluders, options.alpha, options.sides));
    let occluded = occluders.as_deref().map(|occluders| Occluded {
        rasteriser: &within as &dyn Rasteriser,
        occluders,
    });
    let run = PassContext {
        foliage: &foliage,
        occluders: occluders.as_deref(),
        rasteriser: match &occluded {
            Some(occluded) => occluded,
            None => &within,
        },
        options,
        target: options.target.counted(&foliage),
        views: options.plan(sphere),
        resolution,
        reasons: Reasons {
            views: chosen.reason,
            resolution: resolution_reason,
        },
        engine,
        budget,
    };
    let draft = run.select(shared.as_deref_mut(), &mut clock)?;
    run.finished(draft, sphere, shared, clock)
}

/// Why a run looks as it does, in words.
#[derive(Clone)]
struct Reasons {
    views: Option<String>,
    resolution: String,
}

/// What all passes of a run know.
struct PassContext<'a> {
    foliage: &'a Foliage,
    options: &'a Options,
    /// In numbers of the foliage.
    target: Target,
    views: ViewPlan,
    resolution: u32,
    reasons: Reasons,
    engine: &'a OpenEngine,
    /// What is left for what views show.
    budget: Budget,
    /// The engine within the budget, with what hides leaves.
    rasteriser: &'a dyn Rasteriser,
    occluders: Option<&'a Foliage>,
}

/// What came of the passes so far.
struct Draft {
    passes: Passes,
    costs: Vec<ScaledBits>,
    shown: LastLook,
    stopped: Stopped,
    /// Whether what is left shows all that was there: no leaf is gone, and one triangle
    /// of a card that shows all of it is all that became coarser.
    shows_the_same: bool,
}

impl PassContext<'_> {
    /// Cuts the passes where the error crosses the one that is asked for, found by halving: with
    /// one crossing that is the first. If coarser leaves alone exceed it they stay as they were.
    /// Whether anything was cut.
    fn cut_at_error(&self, passes: &mut Passes, max_percent: f64) -> Result<bool, Error> {
        let steps = passes.in_one_order();
        let views = self.views.first();
        let table = LgTable::new();
        let vmi_after = |count| {
            let lod = Lod::after(&steps, count);
            let areas = observe(self.foliage, &lod, &views, self.resolution, self.rasteriser)?;
            Ok::<_, Error>(Vmi::of(&areas, &table))
        };
        let original = vmi_after(0)?;
        // Within the error, and beyond it.
        let (mut within, mut beyond) = (0, steps.len() + 1);
        while beyond - within > 1 {
            let count = within + (beyond - within) / 2;
            match original.error_percent(&vmi_after(count)?) <= max_percent {
                true => within = count,
                false => beyond = count,
            }
        }
        if within == steps.len() {
            return Ok(false);
        }
        if passes.coarse.is_some() && within == 0 {
            passes.coarse = None;
        }
        let coarsened = usize::from(passes.coarse.is_some());
        passes.order.truncate(within - coarsened);
        Ok(true)
    }

    /// What the views of the last step show. Where the error says how many leaves are left, and
    /// for methods that are not driven by views, the first views.
    fn look(
        &self,
        passes: &Passes,
        is_driven: bool,
        shared: Option<&mut Shared>,
    ) -> Result<LastLook, Error> {
        let lod = passes.lod();
        let views = match (is_driven, self.target) {
            (true, Target::Leaves(_) | Target::Triangles(_)) => {
                let count = self.foliage.leaves().len();
                final_views(&self.views, self.resolution, count, lod.leaf_count())?
            }
            _ => self.views.first(),
        };
        let observe =
            |lod: &Lod| observe(self.foliage, lod, &views, self.resolution, self.rasteriser);
        let table = LgTable::new();
        let known = shared.as_ref().and_then(|shared| shared.original.clone());
        let vmi_original = match known.filter(|(of, _)| *of == views) {
            Some((_, vmi)) => vmi,
            None => {
                let original = Lod::original(self.foliage.leaves().len());
                Vmi::of(&observe(&original)?, &table)
            }
        };
        if let Some(shared) = shared {
            shared.original = Some((views.clone(), vmi_original.clone()));
        }
        let mut left = None;
        if is_left_looked_at(self.options, self.target) {
            let areas = observe(&lod)?;
            let vmi = Vmi::of(&areas, &table);
            left = Some((areas, vmi));
        }
        Ok(LastLook {
            vmi_original,
            left,
            views,
        })
    }

    /// Fits the sizes of what is left, where the options ask for it and it is not spared.
    fn fit(
        &self,
        draft: &mut Draft,
        sphere: BoundingSphere,
        shared: Option<&mut Shared>,
        clock: &mut Clock<'_>,
    ) -> Result<(), Error> {
        let Some(objective) = self.options.objective() else {
            return Ok(());
        };
        let error_percent = draft.shown.error_percent();
        let (fit, is_same) = (self.options.fit, draft.shows_the_same);
        if is_fit_spared(fit, objective, is_same, error_percent) {
            return Ok(());
        }
        clock.begin(Stage::Fit)?;
        let (shown, resolution) = (&draft.shown.views, self.resolution);
        let pass = SizePass::new(self.options, sphere, shown, objective, resolution);
        self.size(draft, &pass, shared, clock)
    }

    /// Fits the sizes of what is left, where that changes anything and keeps to the error that is
    /// asked for.
    fn size(
        &self,
        draft: &mut Draft,
        pass: &SizePass,
        shared: Option<&mut Shared>,
        clock: &mut Clock<'_>,
    ) -> Result<(), Error> {
        let lod = draft.passes.lod();
        let mut steps = |done, at_most| clock.step(done, at_most);
        let hidden_by = self.occluders;
        let factors = pass.factors(
            self.foliage,
            &lod,
            hidden_by,
            self.budget,
            shared,
            &mut steps,
        )?;
        let Some(factors) = factors else {
            return Ok(());
        };
        draft.passes.sizes = Some(factors);
        if let Some(held_by) = &self.options.held_by {
            draft.passes.take_hanging(self.foliage, held_by);
        }
        if !is_left_looked_at(self.options, self.target) {
            draft.shown.left = None;
            return Ok(());
        }
        let sized = draft.passes.lod();
        let shown = &mut draft.shown;
        let areas = observe(
            self.foliage,
            &sized,
            &shown.views,
            self.resolution,
            self.rasteriser,
        )?;
        let vmi = Vmi::of(&areas, &LgTable::new());
        if let Target::MaxErrorPercent(percent) = self.target
            && shown.vmi_original.error_percent(&vmi) > percent
        {
            draft.passes.sizes = None;
            return Ok(());
        }
        shown.left = Some((areas, vmi));
        Ok(())
    }

    /// What has to be said of a run that came to its end; the error is that before sizes were fitted.
    fn warnings(&self, draft: &Draft, lod: &Lod, unfitted_percent: Option<f64>) -> Vec<Warning> {
        let mut warnings = warnings(&Ended {
            options: self.options,
            target: self.target,
            foliage: self.foliage,
            lod,
            is_fitted: draft.passes.sizes.is_some(),
            error_percent: unfitted_percent
                .zip(draft.shown.error_percent())
                .map(|(before, after)| [before, after]),
        });
        warnings.extend(self.engine.failure().map(Warning::GpuFailed));
        warnings
    }

    /// The last passes after the selection, and what came of the run.
    fn finished(
        &self,
        mut draft: Draft,
        sphere: BoundingSphere,
        shared: Option<&mut Shared>,
        mut clock: Clock<'_>,
    ) -> Result<Simplified, Error> {
        let (options, resolution) = (self.options, self.resolution);
        let shown = &draft.shown;
        if options.occluders.is_some()
            && shown.shows_nothing(self.foliage, resolution, self.rasteriser)?
        {
            let views = shown.views.len();
            return Err(Error::NothingSeen { views });
        }
        let unfitted_percent = draft.shown.error_percent();
        self.fit(&mut draft, sphere, shared, &mut clock)?;
        let lod = draft.passes.lod();
        let audited_by = match options.audit {
            false => None,
            true => {
                clock.begin(Stage::Audit)?;
                self.audit(&lod, &draft.shown)?
            }
        };
        let warnings = self.warnings(&draft, &lod, unfitted_percent);
        let (areas, vmi_final) = draft.shown.left.unzip();
        let reasons = self.reasons.clone();
        Ok(Simplified {
            passes: draft.passes,
            lod,
            costs: draft.costs,
            stopped: draft.stopped,
            views: draft.shown.views,
            driven_by: options.views.clone(),
            views_reason: reasons.views,
            areas,
            vmi_original: draft.shown.vmi_original,
            vmi_final,
            resolution,
            resolution_reason: reasons.resolution,
            engine: self.engine.name(),
            adapter: self.engine.adapter(),
            audited_by,
            seconds: clock.finish(),
            warnings,
        })
    }

    /// Draws the result from scratch another way and compares.
    fn audit(&self, lod: &Lod, shown: &LastLook) -> Result<Option<&'static str>, Error> {
        let Some((areas, _)) = &shown.left else {
            return Ok(None);
        };
        let made = (!lod.is_of_originals()).then(|| lod.foliage(self.foliage));
        let all_made = made.as_ref().map(|made| Lod::original(made.leaves().len()));
        let scene = Scene {
            foliage: made.as_ref().unwrap_or(self.foliage),
            lod: all_made.as_ref().unwrap_or(lod),
            views: &shown.views,
            resolution: self.resolution,
        };
        audit(areas, &scene, self.engine, self.occluders).map(Some)
    }
}

#[cfg(test)]
mod tests;
