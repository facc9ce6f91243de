//! Algorithm 1, taken literally: the oracle.
//!
//! For every candidate leaf of every step all views are drawn without it and
//! the VMI is computed anew. Slow on purpose: V renders a candidate, of the
//! order of L^2 / 2 candidates a run.

use std::ops::ControlFlow;

use rayon::prelude::*;
use secateur_model::{Foliage, LeafId, Lod, RemovalOrder};
use secateur_raster::{AreaTable, CpuRasteriser, Rasteriser, Scene, ViewSet};

use super::outcome::{Progress, VdsError, VdsOutcome};
use super::phases::{final_phase, phases};
use super::resize::{Pruned, Sights, covered_px, distance_squared, growths};
use super::{Reference, VdsOptions, VdsRun};
use crate::lg::LgTable;
use crate::vmi::{Vmi, error_percent};

/// Simplifies a foliage by Algorithm 1.
///
/// `progress` is called after every step and may break off the run.
///
/// # Errors
/// [`VdsError`] if the options are out of range or the run was broken off.
pub fn simplify(
    foliage: &Foliage,
    run: &VdsRun,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<VdsOutcome, VdsError> {
    simplify_drawn_by(&CpuRasteriser, foliage, run, progress)
}

/// [`simplify`], drawn by a rasteriser that never fails.
///
/// # Errors
/// As [`simplify`].
///
/// # Panics
/// If the rasteriser fails.
pub fn simplify_drawn_by(
    rasteriser: &(impl Rasteriser + Sync),
    foliage: &Foliage,
    run: &VdsRun,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<VdsOutcome, VdsError> {
    let leaf_count = foliage.leaves().len();
    let table = LgTable::new();
    let mut lod = Lod::original(leaf_count);
    let mut order = RemovalOrder::new(leaf_count as u32);
    let mut costs_scaled = Vec::new();
    let mut is_at_max_error = false;
    let phases = phases(run, foliage)?;
    let (options, resolution) = (&run.options, run.resolution);
    let steps_at_most = leaf_count - run.target.fewest_leaves(foliage).min(leaf_count);
    'run: for phase in &phases {
        let look = |lod: &Lod| {
            ViewsOfLod::at(
                rasteriser,
                &scene(foliage, lod, &phase.views, resolution),
                &table,
            )
        };
        let original = look(&Lod::original(leaf_count));
        while lod.leaf_count() > phase.leaves_at_end {
            let choice = choose(options, &lod, &original.vmi, &look);
            let sights = Sights {
                views: phase.views.views().len(),
                pixels_per_view: resolution * resolution,
                covered_original_px: original.covered_px,
            };
            let share = options.share(choice.pruned, sights, || choice.largest_cost);
            let nearest = nearest(foliage, &lod, choice.pruned.leaf, options.neighbours);
            let grown = growths(foliage, &lod, choice.pruned.leaf, share, &nearest);
            let before = lod.clone();
            lod.remove(choice.pruned.leaf);
            for growth in &grown {
                lod.resize(growth.leaf, growth.area_scale);
            }
            if let Some(max) = run.target.max_error_percent() {
                let now = look(&lod).vmi;
                let deviation = deviations(&original.vmi, &now).map(i64::abs).sum();
                if error_percent(deviation, original.vmi.scaled().iter().sum()) > max {
                    lod = before;
                    is_at_max_error = true;
                    break 'run;
                }
            }
            order.push(choice.pruned.leaf, &grown);
            costs_scaled.push(choice.pruned.cost);
            let steps = order.len();
            if progress(Progress {
                steps,
                steps_at_most,
            })
            .is_break()
            {
                return Err(VdsError::Cancelled);
            }
        }
    }
    let last = final_phase(&phases, lod.leaf_count());
    let areas_of = |lod: &Lod| areas(rasteriser, &scene(foliage, lod, &last.views, resolution));
    let areas = areas_of(&lod);
    Ok(VdsOutcome {
        vmi_original: Vmi::of(&areas_of(&Lod::original(leaf_count)), &table),
        vmi_final: Vmi::of(&areas, &table),
        areas,
        order,
        costs_scaled,
        is_at_max_error,
        views: last.views.clone(),
    })
}

fn scene<'a>(foliage: &'a Foliage, lod: &'a Lod, views: &'a ViewSet, resolution: u32) -> Scene<'a> {
    Scene {
        foliage,
        lod,
        views,
        resolution,
    }
}

struct Choice {
    pruned: Pruned,
    largest_cost: i64,
}

fn choose(
    options: &VdsOptions,
    lod: &Lod,
    original: &Vmi,
    look: &(impl Fn(&Lod) -> ViewsOfLod + Sync),
) -> Choice {
    let reference = match options.reference {
        Reference::Original => original.clone(),
        Reference::Previous => look(lod).vmi,
    };
    let candidates: Vec<LeafId> = lod.leaves().map(|(leaf, _)| leaf).collect();
    let evaluate = |&leaf: &LeafId| {
        let mut without = lod.clone();
        without.remove(leaf);
        let ViewsOfLod { vmi, covered_px } = look(&without);
        Pruned {
            leaf,
            cost: deviations(&reference, &vmi).map(i64::abs).sum(),
            deviation: deviations(original, &vmi).sum(),
            covered_px,
        }
    };
    let evaluated: Vec<Pruned> = candidates.par_iter().map(evaluate).collect();
    let by_cost = |p: &&Pruned| (p.cost, options.ties.rank(p.leaf));
    Choice {
        pruned: *evaluated
            .iter()
            .min_by_key(by_cost)
            .expect("a leaf is left"),
        largest_cost: evaluated.iter().map(|p| p.cost).max().unwrap_or(0),
    }
}

fn deviations<'a>(from: &'a Vmi, to: &'a Vmi) -> impl Iterator<Item = i64> + 'a {
    to.scaled().iter().zip(from.scaled()).map(|(b, a)| b - a)
}

/// What the views see.
struct ViewsOfLod {
    vmi: Vmi,
    covered_px: u64,
}

impl ViewsOfLod {
    fn at(rasteriser: &impl Rasteriser, scene: &Scene<'_>, table: &LgTable) -> Self {
        let areas = areas(rasteriser, scene);
        Self {
            vmi: Vmi::of(&areas, table),
            covered_px: covered_px(&areas),
        }
    }
}

fn areas(rasteriser: &impl Rasteriser, scene: &Scene<'_>) -> AreaTable {
    let areas = rasteriser.areas(scene);
    areas.expect("the CPU draws whatever there is memory for")
}

fn nearest(foliage: &Foliage, lod: &Lod, pruned: LeafId, count: usize) -> Vec<LeafId> {
    let others = lod.leaves().map(|(leaf, _)| leaf).filter(|l| *l != pruned);
    let mut by_distance: Vec<(f64, LeafId)> = others
        .map(|leaf| (distance_squared(foliage, pruned, leaf), leaf))
        .collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    by_distance.truncate(count);
    by_distance.into_iter().map(|(_, leaf)| leaf).collect()
}
