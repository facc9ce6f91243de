//! The exact engine: the choices of Algorithm 1, without drawing the views again.
//!
//! The foliage is rasterised once, into the list of all leaves behind each pixel (an
//! [A-buffer](secateur_raster::abuffer)). Without a leaf each pixel that it owns goes to the
//! leaf behind it, so these lists say beforehand what the views would show. How many pixels a
//! leaf would hand to which other, by view, is a *reveal edge* (`edges`), and how many each
//! leaf owns is its area (`counts`). From both follows by how much VMI would change in each
//! view if a leaf went: the leaf's *deltas* (`deltas`). Its cost is the sum over the views of
//! `|D + d|`, with D how far VMI is off already and d the leaf's delta. Each step looks for
//! the leaf of least cost (`candidates`), where bounds on blocks of sixteen leaves spare the
//! engine nearly all costs. The step then takes that leaf out of the lists and draws its
//! nearest `neighbours`, which grow, once more; where the first two leaves of a pixel change,
//! the A-buffer notes an *event*. Areas, edges and deltas follow the events, and blocks are
//! told which of their leaves changed. Each core edits the lists of some views
//! (`view_slice`), keeps the edges and deltas of some of the leaves, with areas of all
//! (`shard`), and one of them leads (`spin_pool`, `view_set_loop`). All of it is integers,
//! logarithms included, so the result equals that of [`reference`](super::reference) bit for
//! bit: order, growth and VMI.
//!
//! ```text
//!   rasterise once
//!        |                        what a step changed
//!        v                  .------------+-----------.
//!   +----------+  events    v            v           v
//!   | A-buffer |-------> counts ----> edges ----> deltas ----> candidates
//!   +----------+         (areas)    (reveals)   (change of VMI)    |
//!        ^                                                         | the cheapest leaf
//!        |  take it out, draw what grows                           v
//!        '------------------------------------------------ neighbours
//! ```

mod candidates;
mod changes;
mod counts;
mod deltas;
mod edge_map;
mod edges;
mod neighbours;
mod reveals;
mod shard;
mod shared;
mod spin_pool;
mod split;
mod switches;
mod terms;
#[cfg(test)]
mod tests;
mod view_set_loop;
mod view_slice;

use std::ops::ControlFlow;

use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder};
use secateur_raster::{AreaTable, Rasteriser, Scene, ViewSet};

use self::candidates::Found;
#[cfg(feature = "ablation")]
pub use self::switches::{Mechanism, switch_off};
use self::view_set_loop::ViewSetLoop;
use super::outcome::{Progress, VdsError, VdsOutcome};
use super::phases::{Phase, final_phase, phases};
use super::{VdsOptions, VdsRun};
use crate::lg::LgTable;
use crate::select::Begun;
use crate::vmi::Vmi;

/// The most cores that the loop uses: a step has only so much to do at a time.
pub const MAX_CORES: usize = 4;

/// Simplifies a foliage by the exact engine.
///
/// `rasteriser` makes the first A-buffer (and one for each further view set of
/// a variable plan); the loop runs on the threads of the current rayon pool, at
/// most [`MAX_CORES`] of them, with the same result for any number. Memory grows
/// with the fragments, about 20 bytes each, with the pixels, 12 bytes each, and
/// with four bytes a leaf, view and core. `progress` is called after every step and
/// may break off the run.
///
/// # Errors
/// [`VdsError`] if the options are out of range, the rasteriser fails or the
/// run was broken off.
pub fn simplify(
    foliage: &Foliage,
    job: &VdsRun,
    rasteriser: &dyn Rasteriser,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<VdsOutcome, VdsError> {
    simplify_from(foliage, job, None, rasteriser, progress)
}

/// [`simplify`], which goes on from steps that a run of the same options and views made before; the
/// outcome is that of one run.
///
/// # Errors
/// As [`simplify`].
///
/// # Panics
/// If the steps are of another foliage.
pub fn simplify_from(
    foliage: &Foliage,
    job: &VdsRun,
    begun: Option<&Begun>,
    rasteriser: &dyn Rasteriser,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<VdsOutcome, VdsError> {
    let leaf_count = foliage.leaves().len();
    let phases = phases(job, foliage)?;
    let leaves_at_end = job.target.fewest_leaves(foliage).min(leaf_count);
    let table = LgTable::new();
    let cores = rayon::current_num_threads().min(MAX_CORES);
    let mut run = FastRun {
        foliage,
        options: &job.options,
        resolution: job.resolution,
        max_error_percent: job.target.max_error_percent(),
        rasteriser,
        table: &table,
        lod: match begun {
            Some(begun) => Lod::after(&begun.order, begun.order.len()),
            None => Lod::original(leaf_count),
        },
        order: match begun {
            Some(begun) => begun.order.clone(),
            None => RemovalOrder::new(leaf_count as u32),
        },
        costs_scaled: begun.map_or_else(Vec::new, |begun| {
            begun.costs.iter().map(|cost| cost.0).collect()
        }),
        steps_at_most: leaf_count - leaves_at_end,
        progress,
    };
    for phase in &phases {
        let is_behind = phase.leaves_at_end >= run.lod.leaf_count();
        if begun.is_some() && is_behind && phase.leaves_at_end > leaves_at_end {
            continue;
        }
        let mut view_set_loop = ViewSetLoop::new(&run, &phase.views, cores)?;
        let ended = view_set_loop.prune_down_to(&mut run, phase.leaves_at_end)?;
        let is_last = phase.leaves_at_end == leaves_at_end;
        match ended {
            // The loop has gone one step too far.
            Ended::BeyondMaxError => return run.outcome_from_scratch(&phases),
            Ended::AtLeafCount if is_last => return run.outcome(&view_set_loop),
            Ended::AtLeafCount => {}
        }
    }
    unreachable!("the last phase ends at the target")
}

/// Why no more leaves go from a set of views.
enum Ended {
    /// The number of leaves that the phase goes down to is left.
    AtLeafCount,
    /// The last step exceeded the error asked for.
    BeyondMaxError,
}

/// What lasts over all phases.
struct FastRun<'a> {
    foliage: &'a Foliage,
    options: &'a VdsOptions,
    resolution: u32,
    max_error_percent: Option<f64>,
    rasteriser: &'a dyn Rasteriser,
    table: &'a LgTable,
    lod: Lod,
    order: RemovalOrder,
    costs_scaled: Vec<i64>,
    steps_at_most: usize,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl<'a> FastRun<'a> {
    fn scene<'s>(&'s self, lod: &'s Lod, views: &'s ViewSet) -> Scene<'s> {
        Scene {
            foliage: self.foliage,
            lod,
            views,
            resolution: self.resolution,
        }
    }

    fn areas(&self, lod: &Lod, views: &ViewSet) -> Result<AreaTable, VdsError> {
        let areas = self.rasteriser.areas(&self.scene(lod, views));
        areas.map_err(VdsError::from_raster)
    }

    fn may_lists_take(&self, views: &ViewSet, bytes: u64) -> Result<(), VdsError> {
        let scene = self.scene(&self.lod, views);
        let may = self.rasteriser.may_lists_take(&scene, bytes);
        may.map_err(VdsError::from_raster)
    }

    /// Tells how far the run is, and hears whether it may go on.
    fn show_progress(&mut self) -> Result<(), VdsError> {
        let progress = Progress {
            steps: self.order.len(),
            steps_at_most: self.steps_at_most,
        };
        match (self.progress)(progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(VdsError::Cancelled),
        }
    }

    /// Takes down a step.
    fn record(&mut self, pruned: Found, grown: &[Growth]) {
        self.order.push(leaf_id(pruned.leaf), grown);
        self.costs_scaled.push(pruned.cost);
        self.lod.remove(leaf_id(pruned.leaf));
        for growth in grown {
            self.lod.resize(growth.leaf, growth.area_scale);
        }
    }

    fn outcome(self, view_set_loop: &ViewSetLoop<'_>) -> Result<VdsOutcome, VdsError> {
        // Both are the same; a GPU counts what it drew.
        let areas = match self.rasteriser.is_gpu() {
            true => self.areas(&self.lod, view_set_loop.views)?,
            false => view_set_loop.areas(),
        };
        Ok(VdsOutcome {
            order: self.order,
            costs_scaled: self.costs_scaled,
            is_at_max_error: false,
            views: view_set_loop.views.clone(),
            vmi_final: Vmi::of(&areas, self.table),
            vmi_original: view_set_loop.vmi_original.clone(),
            areas,
        })
    }

    fn outcome_from_scratch(self, phases: &[Phase]) -> Result<VdsOutcome, VdsError> {
        let views = final_phase(phases, self.lod.leaf_count()).views.clone();
        let original = Lod::original(self.foliage.leaves().len());
        let areas_original = self.areas(&original, &views)?;
        let areas = self.areas(&self.lod, &views)?;
        Ok(VdsOutcome {
            order: self.order,
            costs_scaled: self.costs_scaled,
            is_at_max_error: true,
            vmi_original: Vmi::of(&areas_original, self.table),
            vmi_final: Vmi::of(&areas, self.table),
            areas,
            views,
        })
    }
}

fn leaf_id(number: u32) -> LeafId {
    LeafId::new(number).expect("leaves count from 1")
}
