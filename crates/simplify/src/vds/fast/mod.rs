//! The exact engine: the choices of Algorithm 1, without drawing the views again.
//!
//! The foliage is rasterised once, into the list of all leaves behind each pixel (an
//! A-buffer, `pixels`). Without a leaf each pixel that it owns goes to the leaf behind
//! it, so these lists say beforehand what the views would show. How many pixels a leaf
//! would hand to which other, by view, is a *reveal edge* (`edges`), and how many each
//! leaf owns is its area (`counts`). From both follows by how much VMI would change in
//! each view if a leaf went: the leaf's *deltas* (`deltas`). Its cost is the sum over
//! the views of `|D + d|`, with D how far VMI is off already and d the leaf's delta.
//! Each step looks for the leaf of least cost (`candidates`), where bounds on blocks of
//! sixteen leaves spare the engine to compute nearly all costs. The step then takes that
//! leaf out of the lists and draws its nearest `neighbours`, which grow, once more; where
//! the first two leaves of a pixel change it notes an *event* (`events`). Areas, edges and
//! deltas follow the events, and blocks are told which of their leaves changed. All
//! of it is integers, logarithms included, so the result equals that of
//! [`reference`](super::reference) bit for bit: order, growth and VMI.
//!
//! ```text
//!  rasterise once
//!       |                      what a step changed
//!       v                 .------------+-----------.
//!   +--------+  events    v            v           v
//!   | pixels |-------> counts ----> edges ----> deltas ----> candidates
//!   +--------+         (areas)    (reveals)   (change of VMI)    |
//!       ^                                                        | the cheapest leaf
//!       |  take it out, draw what grows                          v
//!       '----------------------------------------------- neighbours
//! ```
//!
//! Each core edits the lists of some views (`pane`), and keeps the edges and deltas of
//! some of the leaves, with areas of all (`shard`); one of them leads (`crew`, `stage`).

mod candidates;
mod changes;
mod counts;
mod crew;
mod deltas;
mod edge_map;
mod edges;
mod events;
mod neighbours;
mod pane;
mod pixels;
mod prefetch;
mod reveals;
mod shard;
mod shared;
mod split;
mod stage;
mod switches;
mod terms;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder};
use secateur_raster::{AreaTable, Rasteriser, Scene, ViewSet};

use self::candidates::Found;
use self::stage::Stage;
#[cfg(feature = "ablation")]
pub use self::switches::{Mechanism, switch_off};
use super::VdsOptions;
use super::outcome::{Progress, Stopped, VdsError, VdsOutcome};
use super::phases::{Phase, final_phase, phases};
use crate::lg::LgTable;
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
    options: &VdsOptions,
    rasteriser: &dyn Rasteriser,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<VdsOutcome, VdsError> {
    let leaf_count = foliage.leaves().len();
    let phases = phases(options, leaf_count)?;
    let table = LgTable::new();
    let cores = rayon::current_num_threads().min(MAX_CORES);
    let mut run = Run {
        foliage,
        options,
        rasteriser,
        table: &table,
        lod: Lod::original(leaf_count),
        order: RemovalOrder::new(leaf_count as u32),
        costs_scaled: Vec::new(),
        steps_at_most: leaf_count - options.stop.leaves.min(leaf_count),
        progress,
    };
    for phase in &phases {
        let mut stage = Stage::new(&run, &phase.views, cores)?;
        let stopped = stage.prune_down_to(&mut run, phase.leaves_at_end)?;
        let is_last = phase.leaves_at_end == options.stop.leaves.min(leaf_count);
        match stopped {
            // The stage has gone one step too far.
            Stopped::AtMaxError => return run.outcome_from_scratch(&phases),
            Stopped::AtLeafCount | Stopped::AtTriangles if is_last => {
                return Ok(run.outcome(stage));
            }
            Stopped::AtLeafCount | Stopped::AtTriangles => {}
        }
    }
    unreachable!("the last phase ends at the target")
}

/// What lasts over all phases.
struct Run<'a> {
    foliage: &'a Foliage,
    options: &'a VdsOptions,
    rasteriser: &'a dyn Rasteriser,
    table: &'a LgTable,
    lod: Lod,
    order: RemovalOrder,
    costs_scaled: Vec<i64>,
    steps_at_most: usize,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl<'a> Run<'a> {
    fn scene<'s>(&'s self, lod: &'s Lod, views: &'s ViewSet) -> Scene<'s> {
        Scene {
            foliage: self.foliage,
            lod,
            views,
            resolution: self.options.resolution,
        }
    }

    fn areas(&self, lod: &Lod, views: &ViewSet) -> Result<AreaTable, VdsError> {
        let areas = self.rasteriser.areas(&self.scene(lod, views));
        areas.map_err(VdsError::from_raster)
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

    fn outcome(self, stage: Stage<'_>) -> VdsOutcome {
        let areas = stage.areas();
        VdsOutcome {
            order: self.order,
            costs_scaled: self.costs_scaled,
            stopped: Stopped::AtLeafCount,
            views: stage.views.clone(),
            vmi_final: Vmi::of(&areas, self.table),
            vmi_original: stage.vmi_original,
            areas,
        }
    }

    fn outcome_from_scratch(self, phases: &[Phase]) -> Result<VdsOutcome, VdsError> {
        let views = final_phase(phases, self.lod.leaf_count()).views.clone();
        let original = Lod::original(self.foliage.leaves().len());
        let areas_original = self.areas(&original, &views)?;
        let areas = self.areas(&self.lod, &views)?;
        Ok(VdsOutcome {
            order: self.order,
            costs_scaled: self.costs_scaled,
            stopped: Stopped::AtMaxError,
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
