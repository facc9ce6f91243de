//! Methods that are not driven by views: their order first, what the views
//! show of it after.

use std::ops::ControlFlow;

use secateur_model::{Foliage, Lod, PlantSkeleton, RemovalOrder};
use secateur_plant::{Metric, chain_order, check_depth, merge_order};
use secateur_raster::{Rasteriser, Scene, ViewSet};
use secateur_simplify::fit::{MAX_OUTLINE_WEIGHT, Objective};
use secateur_simplify::lg::LgTable;
use secateur_simplify::vds::{Stopped, VdsOptions, VdsOutcome, ViewPlan};
use secateur_simplify::vmi::Vmi;
use secateur_simplify::{fsa, meshopt, stochastic};

use crate::settings::Goal;
use crate::{Error, LeafTriangles, Method, OpenEngine, Simplify};

/// The order of a method, or `None` for VDS, which is driven by views.
/// `progress` gets the steps done and the steps to do at most.
///
/// With an error to stop before, the order goes on to the last leaf.
pub(crate) fn order(
    foliage: &Foliage,
    settings: &Simplify,
    goal: Goal,
    progress: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Option<RemovalOrder>, Error> {
    let leaves = match goal {
        Goal::Leaves(leaves) => leaves,
        Goal::Triangles(_) | Goal::MaxError(_) => 0,
    };
    let at_most = foliage.leaves().len().saturating_sub(leaves);
    let order = match settings.method {
        Method::Vds | Method::VdsReference => return Ok(None),
        Method::Stochastic => {
            let options = stochastic::StochasticOptions {
                seed: settings.seed,
                area_weight: settings.area_weight,
            };
            Some(stochastic::simplify(foliage, leaves, &options))
        }
        Method::Meshopt => {
            let (count, left) = match goal {
                Goal::Triangles(left) => (foliage.triangles().len(), left),
                _ => (foliage.leaves().len(), leaves),
            };
            let share = left as f64 / count as f64;
            Some(meshopt::simplify(foliage, share, settings.meshopt))
        }
        Method::Fsa => fsa::simplify(foliage, leaves, &settings.fsa, &mut |steps| {
            progress(steps, at_most)
        }),
        Method::Chain => {
            let skeleton = skeleton_of(foliage, settings)?;
            let metric = Metric::BranchingLength;
            Some(chain_order(foliage, skeleton, metric, leaves))
        }
        Method::Merge => {
            let skeleton = skeleton_of(foliage, settings)?;
            Some(merge_order(
                foliage,
                skeleton,
                settings.cluster_size,
                leaves,
            ))
        }
    };
    let mut order = order.ok_or(Error::Stopped)?;
    if let Goal::Triangles(at_most) = goal {
        order.truncate(order.steps_to_triangles(foliage, at_most));
    }
    Ok(Some(order))
}

fn skeleton_of<'a>(foliage: &Foliage, settings: &'a Simplify) -> Result<&'a PlantSkeleton, Error> {
    let method = settings.method.name();
    let skeleton = settings.skeleton.as_deref();
    let skeleton = skeleton.ok_or(Error::NoSkeleton { method })?;
    skeleton.check(foliage.leaves().len())?;
    check_depth(&skeleton.segments)?;
    Ok(skeleton)
}

/// Weights that are out of range, and a skeleton that is missing or another's.
pub(crate) fn check(foliage: &Foliage, settings: &Simplify) -> Result<(), Error> {
    if settings.method.needs_skeleton() {
        skeleton_of(foliage, settings)?;
    }
    let refuse = |name: &str, value: f64, range| {
        Err(Error::Setting(format!("the {name} of {value}"), range))
    };
    if settings.leaf_triangles == LeafTriangles::AtMost(0) {
        return refuse("number of a leaf's triangles", 0.0, "from 1 upwards");
    }
    if let Some(Objective::Information { outline_weight }) = settings.objective()
        && !(0.0..=MAX_OUTLINE_WEIGHT).contains(&outline_weight)
    {
        return refuse("weight of the outline", outline_weight, "from 0 to 100");
    }
    let fsa = &settings.fsa;
    if !(0.0..=1.0).contains(&settings.area_weight) {
        return refuse("area weight", settings.area_weight, "from 0 to 1");
    }
    if !(fsa.distance_weight.is_finite() && fsa.distance_weight > 0.0) {
        return refuse("distance weight", fsa.distance_weight, "above 0");
    }
    if !(fsa.planarity_weight.is_finite() && fsa.planarity_weight >= 0.0) {
        return refuse("planarity weight", fsa.planarity_weight, "from 0 upwards");
    }
    Ok(())
}

/// What the views show of an order. Where there is an error to stop before, the
/// order is cut where the error crosses it, found by halving: with one crossing
/// that is the first.
pub(crate) fn outcome(
    foliage: &Foliage,
    mut order: RemovalOrder,
    goal: Goal,
    options: &VdsOptions,
    engine: &OpenEngine,
) -> Result<VdsOutcome, Error> {
    let views = views_of(&options.views);
    let table = LgTable::new();
    let draw = |foliage: &Foliage, lod: &Lod| {
        let scene = Scene {
            foliage,
            lod,
            views: &views,
            resolution: options.resolution,
        };
        engine.areas(&scene).map_err(|e| Error::Gpu(e.to_string()))
    };
    let all = |foliage: &Foliage| Lod::original(foliage.leaves().len());
    let after = |order: &RemovalOrder, steps| {
        let lod = Lod::after(order, steps);
        let areas = if lod.is_of_originals() {
            draw(foliage, &lod)?
        } else {
            let left = lod.foliage(foliage);
            draw(&left, &all(&left))?
        };
        let vmi = Vmi::of(&areas, &table);
        Ok::<_, Error>((areas, vmi))
    };
    let vmi_original = Vmi::of(&draw(foliage, &all(foliage))?, &table);
    let mut stopped = match goal {
        Goal::Triangles(_) => Stopped::AtTriangles,
        Goal::Leaves(_) | Goal::MaxError(_) => Stopped::AtLeafCount,
    };
    if let Goal::MaxError(percent) = goal {
        // Within the error, and beyond it.
        let (mut within, mut beyond) = (0, order.len() + 1);
        while beyond - within > 1 {
            let steps = within + (beyond - within) / 2;
            match vmi_original.error_percent(&after(&order, steps)?.1) <= percent {
                true => within = steps,
                false => beyond = steps,
            }
        }
        if within < order.len() {
            stopped = Stopped::AtMaxError;
            order.truncate(within);
        }
    }
    let (areas, vmi_final) = after(&order, order.len())?;
    Ok(VdsOutcome {
        costs_scaled: Vec::new(),
        stopped,
        views,
        areas,
        vmi_original,
        vmi_final,
        order,
    })
}

fn views_of(plan: &ViewPlan) -> ViewSet {
    match plan {
        ViewPlan::Fixed(views) => views.clone(),
        ViewPlan::Variable(sphere) => ViewSet::dodecahedron(*sphere),
    }
}
