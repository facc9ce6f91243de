//! A foliage and options in, a LOD and what led to it out: coarsen, select, widen, size.

use std::ops::ControlFlow;

use secateur_model::{Budget, Foliage, Lod};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::{ScaledBits, Vmi};
use secateur_raster::occluders::Occluded;
use secateur_raster::{MAX_TOTAL_PIXELS, OpenEngine, Rasteriser, Scene};

use crate::audit::audit;
use crate::auto_views::views_for;
use crate::coarsen::{Coarse, LossCurves, coarsen};
use crate::fill::fill;
use crate::hanging_leaves::cut;
use crate::last_views::{LastLook, is_left_looked_at};
use crate::memory::{Within, take_run};
use crate::observe::observe;
use crate::passes::Passes;
use crate::resolution::resolution_for;
use crate::select::{Begun, Selection, Task};
use crate::shared::{KeptOrder, Shared};
use crate::sizes::{SizePass, is_fit_spared};
use crate::stage::{Clock, Observer, Stage};
use crate::vds::{ViewPlan, final_views};
use crate::warning::{Ended, Warning, warnings};
use crate::{Error, LeafTriangles, Options, Simplified, Stopped, Target, as_seen, sphere_of};

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
        engine,
        budget,
    };
    let mut draft = run.select(shared.as_deref_mut(), &mut clock)?;
    let shown = &draft.shown;
    if options.occluders.is_some() && shown.shows_nothing(&foliage, resolution, run.rasteriser)? {
        let views = shown.views.len();
        return Err(Error::NothingSeen { views });
    }
    let unfitted_percent = draft.shown.error_percent();
    if let Some(objective) = options.objective()
        && !is_fit_spared(
            options.fit,
            objective,
            draft.shows_the_same,
            unfitted_percent,
        )
    {
        clock.begin(Stage::Fit)?;
        let shown = &draft.shown.views;
        let pass = SizePass::new(options, sphere, shown, objective, resolution);
        run.size(&mut draft, &pass, shared, &mut clock)?;
    }
    let lod = draft.passes.lod();
    let audited_by = match options.audit {
        false => None,
        true => {
            clock.begin(Stage::Audit)?;
            run.audit(&lod, &draft.shown)?
        }
    };
    let mut warnings = warnings(&Ended {
        options,
        target: run.target,
        foliage: &foliage,
        lod: &lod,
        is_fitted: draft.passes.sizes.is_some(),
        error_percent: unfitted_percent
            .zip(draft.shown.error_percent())
            .map(|(before, after)| [before, after]),
    });
    warnings.extend(engine.failure().map(Warning::GpuFailed));
    let Draft {
        passes,
        costs,
        shown,
        stopped,
        ..
    } = draft;
    let (areas, vmi_final) = shown.left.unzip();
    Ok(Simplified {
        passes,
        lod,
        costs,
        stopped,
        views: shown.views,
        driven_by: options.views.clone(),
        views_reason: chosen.reason,
        areas,
        vmi_original: shown.vmi_original,
        vmi_final,
        resolution,
        resolution_reason,
        engine: engine.name(),
        adapter: engine.adapter(),
        audited_by,
        seconds: clock.finish(),
        warnings,
    })
}

/// What all passes of a run know.
struct PassContext<'a> {
    foliage: &'a Foliage,
    options: &'a Options,
    /// In numbers of the foliage.
    target: Target,
    views: ViewPlan,
    resolution: u32,
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
    /// Makes leaves coarser, has the method choose leaves, and cuts what goes beyond the target.
    fn select(
        &self,
        mut shared: Option<&mut Shared>,
        clock: &mut Clock<'_>,
    ) -> Result<Draft, Error> {
        clock.begin(Stage::Select)?;
        let is_driven = self.options.method.vds().is_some();
        let mut curves = shared.as_mut().and_then(|shared| shared.curves.take());
        let shares = match is_driven {
            true => self
                .options
                .leaf_triangles
                .shares(self.foliage, self.target, &mut curves),
            false => None,
        };
        let known = match &mut shared {
            Some(shared) if is_driven => shared.take(&self.options.views, &shares),
            _ => None,
        };
        let coarse = match (&known, &shares) {
            (Some(known), _) => known.coarse.clone(),
            (None, Some(shares)) => {
                let curves = curves.get_or_insert_with(|| LossCurves::of(self.foliage));
                coarsen(self.foliage, curves, shares)
            }
            (None, None) => None,
        };
        if let Some(shared) = &mut shared {
            shared.curves = curves;
        }
        let target = match self.target {
            // The error that counts is the one against the leaves as they are.
            Target::MaxErrorPercent(_) if coarse.is_some() => Target::leaves(0),
            target => target,
        };
        let task = Task {
            foliage: coarse.as_ref().map_or(self.foliage, Coarse::foliage),
            target,
            begun: known.as_ref().map(|known| &known.begun),
            skeleton: self.options.skeleton.as_deref(),
            views: &self.views,
            resolution: self.resolution,
            rasteriser: self.rasteriser,
            occluders: self.occluders,
        };
        let selection = match known.as_ref().filter(|known| known.reaches(&task)) {
            Some(known) => known.selection(),
            None => self
                .options
                .method
                .select(&task, &mut |done, at_most| clock.step(done, at_most))?,
        };
        if let (Some(shared), true) = (&mut shared, is_driven) {
            shared.keep(KeptOrder {
                views: self.options.views.clone(),
                shares,
                coarse: coarse.clone(),
                begun: Begun {
                    order: selection.order.clone(),
                    costs: selection.costs.clone(),
                },
            });
        }
        let Selection {
            mut order,
            costs,
            shown,
            is_at_max_error,
        } = selection;
        let at_most = self.target.triangle_count(self.foliage);
        let ordered = coarse.as_ref().map_or(self.foliage, Coarse::foliage);
        let held_by = self.options.held_by.as_deref();
        let found = order.len();
        let chosen = cut(&mut order, ordered, held_by, at_most);
        let is_as_found = coarse.is_none() && held_by.is_none() && chosen == found;
        let mut passes = Passes {
            coarse,
            order,
            needles: Vec::new(),
            sizes: None,
        };
        if self.options.widens_needles() {
            passes.widen_needles(self.foliage, held_by);
        }
        let is_filled = match (at_most, self.options.leaf_triangles) {
            (Some(at_most), LeafTriangles::Auto) => {
                fill(&mut passes, self.foliage, at_most, chosen)
            }
            _ => false,
        };
        let is_as_found = is_as_found && passes.needles.is_empty() && !is_filled;
        let mut stopped = match self.target {
            Target::Triangles(_) => Stopped::AtTriangles,
            Target::MaxErrorPercent(_) if is_at_max_error => Stopped::AtMaxError,
            Target::Leaves(_) | Target::MaxErrorPercent(_) => Stopped::AtLeafCount,
        };
        let shown = match shown {
            Some(shown) if is_as_found => shown.into(),
            _ => {
                clock.begin(Stage::Observe)?;
                if let Target::MaxErrorPercent(percent) = self.target
                    && self.cut_at_error(&mut passes, percent)?
                {
                    stopped = Stopped::AtMaxError;
                }
                self.look(&passes, is_driven, shared)?
            }
        };
        let are_all_left = passes.lod().leaf_count() == self.foliage.leaves().len();
        let is_coarse_the_same = passes.coarse.as_ref().is_none_or(Coarse::shows_the_same);
        Ok(Draft {
            shows_the_same: is_driven
                && !is_filled
                && passes.needles.is_empty()
                && are_all_left
                && is_coarse_the_same,
            costs: costs
                .into_iter()
                .take(passes.order.len().min(chosen))
                .collect(),
            passes,
            shown,
            stopped,
        })
    }

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
