//! A foliage and settings in, a removal order and its LOD out.

use std::ops::ControlFlow;

use secateur_model::{BoundingSphere, Foliage, Lod, RemovalOrder};
use secateur_raster::{AreaTable, MAX_TOTAL_PIXELS, Scene, ViewSet};
use secateur_simplify::resolution::{CANDIDATES, choose};
use secateur_simplify::vds::{self, Stop, Stopped, VdsOptions, VdsOutcome};
use secateur_simplify::vmi::Vmi;

use crate::audit::audit;
use crate::baseline;
use crate::clock::Clock;
use crate::driven::Driven;
use crate::fitted::{Fitted, fitting_views, is_fit_spared};
use crate::settings::Goal;
use crate::warnings::{Ended, warnings};
use crate::{Error, Method, OpenEngine, Resolution, Simplify};

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress {
    /// A stage begins; the name is that of its entry in
    /// [`Simplified::seconds`].
    Stage(&'static str),
    /// A step was made: one leaf less; or, in the stage `fit`, some were tried in other
    /// sizes, which may end early.
    Step {
        /// Steps done.
        done: usize,
        /// Steps to do at most.
        at_most: usize,
    },
}

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// Which leaves went, in order, and which grew for them. Every prefix of it
    /// is a LOD: [`Lod::after`]. Where leaves became coarser that is its first step,
    /// and all finer levels are of these leaves. Where sizes were fitted that is its last,
    /// in which no leaf goes.
    pub order: RemovalOrder,
    /// The leaves that are left, and how large.
    pub lod: Lod,
    /// Cost of each step in units of 2^-27 bits times pixels of a view: see
    /// [`secateur_simplify::vmi`]; 0 for the step that makes leaves coarser and for that which fits
    /// their sizes. Empty for
    /// methods without such costs.
    pub costs_scaled: Vec<i64>,
    /// Whether the last step fits sizes.
    pub is_fitted: bool,
    /// Why the run ended.
    pub stopped: Stopped,
    /// The views of the last step.
    pub views: ViewSet,
    /// Areas of the leaves that are left in those views, in pixels. A row for
    /// each original leaf, or, where leaves were made, for each of
    /// [`Lod::foliage`].
    pub areas: AreaTable,
    /// VMI of the original foliage in those views.
    pub vmi_original: Vmi,
    /// VMI of what is left in those views.
    pub vmi_final: Vmi,
    /// Width and height of the images in pixels.
    pub resolution: u32,
    /// Why that resolution, in words.
    pub resolution_reason: String,
    /// `gpu` or `cpu`.
    pub engine: &'static str,
    /// The GPU and its driver.
    pub adapter: Option<String>,
    /// What the result was audited against, if it was.
    pub audited_by: Option<&'static str>,
    /// Stages and how long they took.
    pub seconds: Vec<(&'static str, f64)>,
    /// What is not as one might expect, a sentence each.
    pub warnings: Vec<String>,
}

impl Simplified {
    /// VMI error against the original foliage on the driving views, in per cent.
    pub fn driving_error_percent(&self) -> f64 {
        self.vmi_original.error_percent(&self.vmi_final)
    }
}

/// Simplifies a foliage.
///
/// `progress` is called when a stage begins and after every step; it may break
/// off the run.
///
/// Time is about in proportion to the leaves at equal crown density, and to the
/// number of views times the pixels that a leaf covers; memory about 20 bytes a
/// fragment and 12 a pixel, and where sizes are fitted, after that, 25 a pixel of 78
/// views, of 512 x 512 pixels at least (1.3 GB at most), and 12 a view and leaf.
/// [`Method::VdsReference`] takes views x leaves^2 / 2 drawings.
///
/// # Errors
/// [`Error`] if the foliage is empty or out of range, a setting is, the GPU
/// that was asked for is missing or fails, the run was broken off or its
/// result does not pass the audit.
///
/// ```
/// use std::ops::ControlFlow;
/// use secateur::plant::{EllipsoidCrown, ellipsoid_crown};
/// use secateur::{Resolution, Simplify, Target, simplify};
///
/// let foliage = ellipsoid_crown(300, 1, &EllipsoidCrown::default())?;
/// let mut settings = Simplify::to(Target::Ratio(0.5));
/// settings.resolution = Resolution::Pixels(64);
/// let result = simplify(&foliage, &settings, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(result.lod.leaf_count(), 150);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify(
    foliage: &Foliage,
    settings: &Simplify,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Simplified, Error> {
    let sphere = sphere_of(foliage)?;
    let views = settings.views.around(sphere).len() as u64;
    let triangle_views = foliage.triangles().len() as u64 * views;
    let engine = OpenEngine::open(settings.engine, triangle_views)?;
    simplify_on(&engine, foliage, settings, progress)
}

/// [`simplify`] on an engine that is open already, whatever
/// [`Simplify::engine`] says.
///
/// # Errors
/// As [`simplify`].
pub fn simplify_on(
    engine: &OpenEngine,
    foliage: &Foliage,
    settings: &Simplify,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Simplified, Error> {
    let foliage = settings.alpha.apply(foliage);
    let sphere = sphere_of(&foliage)?;
    let goal = settings.target.goal(&foliage)?;
    baseline::check(&foliage, settings)?;
    let mut clock = Clock::new(progress);

    clock.begin("resolution")?;
    let (resolution, resolution_reason) = match settings.resolution {
        Resolution::Pixels(n) => (n, "as asked".to_owned()),
        Resolution::Auto => resolution_for(&foliage, &settings.views.around(sphere), engine)?,
    };
    let options = VdsOptions {
        views: settings.views.plan(sphere),
        resolution,
        reference: settings.reference,
        resize: settings.resize,
        neighbours: settings.neighbours,
        max_coverage: settings.max_coverage,
        ties: settings.ties,
        // As the goal says, for methods that follow it step by step.
        stop: Stop {
            leaves: 0,
            max_error_percent: None,
        },
    };

    clock.begin("simplify")?;
    let order = baseline::order(&foliage, settings, goal, &mut |done, at_most| {
        clock.step(done, at_most)
    })?;
    let (outcome, shows_the_same) = match order {
        None => by_views(
            &foliage,
            settings,
            goal,
            options.clone(),
            engine,
            &mut clock,
        )?,
        Some(order) => {
            clock.begin("areas")?;
            let outcome = baseline::outcome(&foliage, order, goal, &options, engine)?;
            (outcome, false)
        }
    };
    let error_percent = |o: &VdsOutcome| o.vmi_original.error_percent(&o.vmi_final);
    let (steps, unfitted_percent) = (outcome.order.len(), error_percent(&outcome));
    let outcome = match settings.objective() {
        None => outcome,
        Some(objective)
            if is_fit_spared(settings.fit, objective, shows_the_same, unfitted_percent) =>
        {
            outcome
        }
        Some(objective) => {
            clock.begin("fit")?;
            let mut tried = |done, at_most| clock.step(done, at_most);
            let fitting = Fitted {
                views: fitting_views(&settings.views, sphere, &outcome.views, objective),
                objective,
                goal,
                options: &options,
            };
            fitting.of(&foliage, outcome, engine, &mut tried)?
        }
    };
    let lod = Lod::after(&outcome.order, outcome.order.len());
    let audited_by = match settings.audit {
        false => None,
        true => {
            clock.begin("audit")?;
            let made = (!lod.is_of_originals()).then(|| lod.foliage(&foliage));
            let left = made.as_ref().unwrap_or(&foliage);
            let scene = Scene {
                foliage: left,
                lod: &made
                    .as_ref()
                    .map_or_else(|| lod.clone(), |f| Lod::original(f.leaves().len())),
                views: &outcome.views,
                resolution,
            };
            Some(audit(&outcome.areas, &scene, engine)?)
        }
    };
    let seconds = clock.finish();
    let is_fitted = outcome.order.len() > steps;
    let mut warnings = warnings(&Ended {
        settings,
        goal,
        foliage: &foliage,
        lod: &lod,
        is_fitted,
        error_percent: [unfitted_percent, error_percent(&outcome)],
    });
    warnings.extend(engine.warning());
    Ok(Simplified {
        order: outcome.order,
        lod,
        costs_scaled: outcome.costs_scaled,
        is_fitted,
        stopped: outcome.stopped,
        views: outcome.views,
        areas: outcome.areas,
        vmi_original: outcome.vmi_original,
        vmi_final: outcome.vmi_final,
        resolution,
        resolution_reason,
        engine: engine.name(),
        adapter: engine.adapter(),
        audited_by,
        seconds,
        warnings,
    })
}

fn resolution_for(
    foliage: &Foliage,
    views: &ViewSet,
    engine: &OpenEngine,
) -> Result<(u32, String), Error> {
    let [least, .., most] = CANDIDATES;
    if u64::from(most).pow(2) * views.len() as u64 > MAX_TOTAL_PIXELS {
        return Ok((least, "there are too many views to try more".to_owned()));
    }
    let chosen = choose(foliage, views, engine)?;
    Ok((chosen.resolution, chosen.reason))
}

/// What came of it, and whether it shows all that was there.
fn by_views(
    foliage: &Foliage,
    settings: &Simplify,
    goal: Goal,
    options: VdsOptions,
    engine: &OpenEngine,
    clock: &mut Clock<'_>,
) -> Result<(VdsOutcome, bool), Error> {
    let way = Driven {
        leaf_triangles: settings.leaf_triangles,
        goal,
        options,
    };
    let found = way.order(foliage, |driving, options| {
        let mut step = |progress: vds::Progress| clock.step(progress.steps, progress.steps_at_most);
        Ok(match settings.method {
            Method::VdsReference => vds::reference::simplify(driving, options, &mut step)?,
            _ => vds::fast::simplify(driving, options, engine, &mut step)?,
        })
    })?;
    let outcome = match found.order {
        None => found.outcome,
        Some(order) => {
            clock.begin("areas")?;
            way.outcome(foliage, order, found.outcome, engine)?
        }
    };
    Ok((outcome, found.shows_the_same))
}

/// The bounding sphere, if cameras about it can be computed.
///
/// # Errors
/// [`Error::NoLeaf`] or [`Error::OutOfRange`].
pub fn sphere_of(foliage: &Foliage) -> Result<BoundingSphere, Error> {
    let sphere = foliage.bounding_sphere().ok_or(Error::NoLeaf)?;
    // A foliage without extent is looked at as if it had a radius of 1.
    let size = if sphere.radius > 0.0 {
        sphere.radius
    } else {
        1.0
    };
    let distance = sphere.centre.length();
    let is_in_range = (1e-30..=1e30).contains(&size) && distance <= 1e9 * size;
    is_in_range.then_some(sphere).ok_or(Error::OutOfRange {
        radius: sphere.radius,
        distance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;
    use glam::DVec3;
    use secateur_model::LeafTriangle;

    fn leaf_at(place: DVec3, size: f64) -> Foliage {
        let mut foliage = Foliage::default();
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| place + size * p);
        foliage
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
        foliage
    }

    #[test]
    fn what_no_camera_can_be_put_around_is_refused() {
        assert!(sphere_of(&leaf_at(DVec3::ZERO, 1.0)).is_ok());
        // A leaf that is a point is looked at as if it were of size 1.
        assert!(sphere_of(&leaf_at(DVec3::ONE, 0.0)).is_ok());
        for foliage in [
            leaf_at(DVec3::ZERO, 1e200),
            leaf_at(DVec3::ZERO, 1e-100),
            leaf_at(DVec3::splat(1e9), 1.0),
        ] {
            let error = sphere_of(&foliage).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { .. }));
        }
        let empty = sphere_of(&Foliage::default()).unwrap_err();
        assert!(matches!(empty, Error::NoLeaf));
    }

    #[test]
    fn many_views_are_no_reason_to_leave_the_range() {
        let foliage = leaf_at(DVec3::ZERO, 1.0);
        let one = ViewSet::octahedron(foliage.bounding_sphere().unwrap()).views()[0];
        // 513 views of 1024 x 1024 pixels are more than 2^29 pixels.
        let views = ViewSet::new(vec![one; 513]);
        let chosen = resolution_for(&foliage, &views, &OpenEngine::cpu()).unwrap();
        assert_eq!(chosen.0, 256);
    }

    #[test]
    fn a_run_can_be_broken_off_at_a_stage_and_at_a_step() {
        let mut foliage = leaf_at(DVec3::ZERO, 1.0);
        for x in 1..4 {
            let other = leaf_at(DVec3::X * f64::from(x), 1.0);
            foliage.push_leaf(other.triangles(), None).unwrap();
        }
        let settings = Simplify {
            resolution: Resolution::Pixels(32),
            ..Simplify::to(Target::Leaves(1))
        };
        let at = |last: Progress| {
            let mut seen = Vec::new();
            let result = simplify(&foliage, &settings, &mut |progress| {
                seen.push(progress);
                match progress == last {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            });
            assert!(matches!(result, Err(Error::Stopped)));
            seen.len()
        };
        assert_eq!(at(Progress::Stage("resolution")), 1);
        assert_eq!(
            at(Progress::Step {
                done: 2,
                at_most: 3
            }),
            4
        );
    }
}
