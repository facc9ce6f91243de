//! The same greedy choices as Algorithm 1, without drawing.
//!
//! Removing a leaf hands each pixel it owns to the leaf behind it, so with an
//! A-buffer the change of every area is known before it happens. The foliage is
//! rasterised once; then each step picks the cheapest leaf (`candidates`),
//! takes it out of the lists behind the pixels (`pixels`), rasterises the
//! leaves that grow, and brings areas, reveal edges and costs up to date with
//! what changed (`counts`). All of it is integers, so the result equals that of
//! [`reference`](super::reference) bit for bit: order, growth and VMI.

mod candidates;
mod changes;
mod counts;
mod neighbours;
mod pixels;
mod prefetch;
mod terms;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::{AreaTable, Rasteriser, Scene, ViewSet};

use self::candidates::{Candidates, Cheapest};
use self::counts::Counts;
use self::neighbours::Neighbours;
use self::pixels::PixelLists;
use super::outcome::{Progress, Stopped, VdsError, VdsOutcome};
use super::phases::{Phase, final_phase, phases};
use super::resize::{Pruned, growths};
use super::{Reference, Resize, VdsOptions};
use crate::lg::LgTable;
use crate::vmi::{Vmi, error_percent};

/// Simplifies a foliage by the exact engine.
///
/// `rasteriser` makes the first A-buffer (and one for each further view set of
/// a variable plan); the loop runs on one CPU core. Memory grows with the
/// fragments, about 20 bytes each. `progress` is called after every step and
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
        let mut stage = Stage::new(&run, &phase.views)?;
        let stopped = stage.prune_down_to(&mut run, phase.leaves_at_end)?;
        let is_last = phase.leaves_at_end == options.stop.leaves.min(leaf_count);
        match stopped {
            // The stage has gone one step too far.
            Stopped::AtMaxError => return run.outcome_from_scratch(&phases),
            Stopped::AtLeafCount if is_last => return Ok(run.outcome(stage)),
            Stopped::AtLeafCount => {}
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

/// The engine's state for one view set.
struct Stage<'a> {
    views: &'a ViewSet,
    vmi_original: Vmi,
    pixels: PixelLists,
    counts: Counts<'a>,
    candidates: Candidates,
    neighbours: Neighbours,
    leaf_fragments: LeafFragments,
    fragments_of_leaf: Vec<(u32, u32)>,
}

impl<'a> Stage<'a> {
    fn new(run: &Run<'a>, views: &'a ViewSet) -> Result<Self, VdsError> {
        let foliage = run.foliage;
        let leaf_count = foliage.leaves().len();
        let fragments = run.rasteriser.fragments(&run.scene(&run.lod, views));
        let fragments = fragments.map_err(VdsError::from_raster)?;
        let pixels_per_view = fragments.pixels_per_view();
        let pixels = PixelLists::new(fragments, leaf_count);
        let mut counts = Counts::new(pixels.ends(), pixels_per_view, leaf_count, run.table);
        let vmi_now = Vmi::of(&area_table(&counts, leaf_count), run.table);
        let vmi_original = if run.order.is_empty() {
            vmi_now.clone()
        } else {
            let original = Lod::original(leaf_count);
            Vmi::of(&run.areas(&original, views)?, run.table)
        };
        let pairs = vmi_now.scaled().iter().zip(vmi_original.scaled());
        counts.set_deviations(pairs.map(|(now, then)| now - then).collect());
        let ranks = (0..=leaf_count as u32)
            .map(|n| LeafId::new(n).map_or(0, |leaf| run.options.ties.rank(leaf)));
        let candidates = Candidates::new(
            &counts,
            leaves_by_place(foliage, &run.lod),
            ranks.collect(),
            pixels_per_view,
            &cost_deviations(run.options, &counts),
        );
        Ok(Self {
            views,
            vmi_original,
            pixels,
            counts,
            candidates,
            neighbours: Neighbours::new(foliage, &run.lod),
            leaf_fragments: LeafFragments::new(run.options.resolution),
            fragments_of_leaf: Vec::new(),
        })
    }

    fn prune_down_to(&mut self, run: &mut Run<'_>, leaves: usize) -> Result<Stopped, VdsError> {
        let mut left = run.lod.leaf_count();
        while left > leaves {
            let cheapest = self.pick(run);
            let grown = self.grow(run, cheapest);
            self.apply(run, cheapest.leaf, &grown);
            if self.error_is_over(run) {
                return Ok(Stopped::AtMaxError);
            }
            run.order.push(leaf_id(cheapest.leaf), &grown);
            run.costs_scaled.push(cheapest.cost);
            run.lod.remove(leaf_id(cheapest.leaf));
            for growth in &grown {
                run.lod.resize(growth.leaf, growth.area_scale);
            }
            left -= 1;
            let progress = Progress {
                steps: run.order.len(),
                steps_at_most: run.steps_at_most,
            };
            if (run.progress)(progress).is_break() {
                return Err(VdsError::Cancelled);
            }
        }
        Ok(Stopped::AtLeafCount)
    }

    fn pick(&mut self, run: &Run<'_>) -> Cheapest {
        let deviations = cost_deviations(run.options, &self.counts);
        self.candidates.begin_step(&self.counts, &deviations);
        self.candidates.cheapest(&self.counts)
    }

    /// The leaves that fill the gap of the cheapest, and how large they become.
    fn grow(&mut self, run: &Run<'_>, cheapest: Cheapest) -> Vec<Growth> {
        let leaf = leaf_id(cheapest.leaf);
        let deviation = match run.options.resize {
            Resize::Deficit => self.deviation_without(cheapest.leaf),
            _ => 0,
        };
        let pruned = Pruned {
            leaf,
            cost: cheapest.cost,
            deviation,
        };
        let pixels_per_view = run.options.resolution * run.options.resolution;
        let share = run.options.resize.share(pruned, pixels_per_view, || {
            self.candidates.largest_cost(&self.counts)
        });
        self.neighbours.remove(run.foliage, leaf);
        if share == 0.0 {
            return Vec::new();
        }
        let count = run.options.neighbours;
        let nearest = self.neighbours.nearest(run.foliage, leaf, count);
        growths(run.foliage, &run.lod, leaf, share, &nearest)
    }

    fn deviation_without(&self, leaf: u32) -> i64 {
        let mut deltas = vec![0; self.counts.view_count()];
        self.counts.deltas(leaf, &mut deltas);
        deltas.iter().sum::<i64>() + self.counts.deviations().iter().sum::<i64>()
    }

    fn apply(&mut self, run: &Run<'_>, leaf: u32, grown: &[Growth]) {
        let Self {
            pixels,
            counts,
            candidates,
            ..
        } = self;
        let per_view = run.options.resolution * run.options.resolution;
        let view_of = |pixel: u32| (pixel / per_view) as usize;
        candidates.remove(counts, leaf);
        pixels.remove(leaf, |pixel, before, after| {
            counts.record(view_of(pixel), pixel, before, after);
        });
        for growth in grown {
            self.fragments_of_leaf.clear();
            for (v, view) in self.views.views().iter().enumerate() {
                let first_pixel = v as u32 * per_view;
                let found =
                    self.leaf_fragments
                        .of(run.foliage, growth.leaf, growth.area_scale, view);
                self.fragments_of_leaf.extend(
                    found
                        .iter()
                        .map(|(pixel, depth)| (first_pixel + pixel, *depth)),
                );
            }
            let fragments = &self.fragments_of_leaf;
            pixels.replace(growth.leaf.get(), fragments, |pixel, before, after| {
                counts.record(view_of(pixel), pixel, before, after);
            });
        }
        counts.commit(|counts, leaf, change, soon| {
            candidates.prefetch(soon);
            candidates.note(counts, leaf, change);
        });
    }

    fn error_is_over(&self, run: &Run<'_>) -> bool {
        let Some(max) = run.options.stop.max_error_percent else {
            return false;
        };
        let deviation = self.counts.deviations().iter().map(|d| d.abs()).sum();
        error_percent(deviation, self.vmi_original.scaled().iter().sum()) > max
    }

    fn areas(&self) -> AreaTable {
        area_table(&self.counts, self.candidates.leaf_count())
    }
}

fn leaf_id(number: u32) -> LeafId {
    LeafId::new(number).expect("leaves count from 1")
}

/// The deviations that costs are measured with: none against the previous
/// foliage.
fn cost_deviations(options: &VdsOptions, counts: &Counts<'_>) -> Vec<i64> {
    match options.reference {
        Reference::Original => counts.deviations().to_vec(),
        Reference::Previous => vec![0; counts.view_count()],
    }
}

fn area_table(counts: &Counts<'_>, leaf_count: usize) -> AreaTable {
    let views = 0..counts.view_count();
    let row = |view: usize| (0..=leaf_count as u32).map(move |leaf| counts.areas(leaf)[view]);
    AreaTable::from_rows(leaf_count, views.flat_map(row).collect())
}

/// The leaves that are left along a space-filling curve: leaves near each other
/// are seen from the same views.
fn leaves_by_place(foliage: &Foliage, lod: &Lod) -> Vec<u32> {
    let Some(sphere) = foliage.bounding_sphere() else {
        return Vec::new();
    };
    let cell = |x: f64| ((x / sphere.radius.max(f64::MIN_POSITIVE) + 1.0) * 511.0) as u64;
    let key = |leaf: LeafId| {
        let [x, y, z] = (foliage.leaf(leaf).centre() - sphere.centre)
            .to_array()
            .map(cell);
        (0..10).fold(0u64, |key, bit| {
            key | (x >> bit & 1) << (3 * bit)
                | (y >> bit & 1) << (3 * bit + 1)
                | (z >> bit & 1) << (3 * bit + 2)
        })
    };
    let mut keyed: Vec<(u64, u32)> = lod.leaves().map(|(l, _)| (key(l), l.get())).collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, leaf)| leaf).collect()
}
