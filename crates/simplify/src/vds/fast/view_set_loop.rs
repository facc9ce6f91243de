//! The loop under one view set: pick, grow, apply, record.

use secateur_model::{Growth, LeafId, Lod};
use secateur_raster::{AreaTable, ViewSet};

use super::candidates::Found;
use super::counts::Counts;
use super::neighbours::Neighbours;
use super::shard::{Finds, Shard};
use super::shared::{Job, Shared};
use super::spin_pool::SpinPool;
use super::split::Split;
use super::switches::{Mechanism, is_on};
use super::view_slice::ViewSlice;
use super::{Ended, FastRun, leaf_id};
use crate::vds::outcome::VdsError;
use crate::vds::resize::{Pruned, Sights, covered_px, growths};
use crate::vds::{Reference, Resize, VdsOptions};
use crate::vmi::{Vmi, error_percent};

/// After this many steps it is seen whether grown leaves still fit the memory: one leaf can add at
/// most a fragment a pixel, 12 bytes, of all views.
const STEPS_A_CHECK: usize = 16;

/// The engine's state for one view set.
pub(super) struct ViewSetLoop<'a> {
    pub views: &'a ViewSet,
    pub vmi_original: Vmi,
    shared: Shared<'a>,
    pool: SpinPool,
    lead: Lead,
}

/// What one core does alone.
struct Lead {
    sights: Sights,
    neighbours: Neighbours,
    /// The leaf that the last step pruned.
    pruned: Option<u32>,
}

impl<'a> ViewSetLoop<'a> {
    pub(super) fn new<'r: 'a>(
        run: &FastRun<'r>,
        views: &'a ViewSet,
        cores: usize,
    ) -> Result<Self, VdsError> {
        let foliage = run.foliage;
        let leaf_count = foliage.leaves().len();
        let scene = run.scene(&run.lod, views);
        let rasterised = run.rasteriser.fragments_and_areas(&scene);
        let (fragments, areas_now) = rasterised.map_err(VdsError::from_raster)?;
        let pixels_per_view = fragments.pixels_per_view();
        // A few for each core, which may be late.
        let slices = if cores > 1 { 2 * cores } else { 1 };
        let occlusions = run.rasteriser.occlusions(views, run.resolution);
        let mut slices = ViewSlice::all(fragments, occlusions.as_deref(), leaf_count, slices);
        let mut counts = Counts::new(&areas_now, pixels_per_view as u32, run.table);
        let areas_original = match run.order.is_empty() {
            true => areas_now,
            false => run.areas(&Lod::original(leaf_count), views)?,
        };
        let vmi_original = Vmi::of(&areas_original, run.table);
        let sights = Sights {
            views: views.views().len(),
            pixels_per_view: run.resolution * run.resolution,
            covered_original_px: covered_px(&areas_original),
        };
        // With many leaves a table of areas is large, and what follows takes more.
        drop(areas_original);
        counts.measure_from(&vmi_original);
        let ranks = (0..=leaf_count as u32)
            .map(|n| LeafId::new(n).map_or(0, |leaf| run.options.ties.rank(leaf)));
        let ranks = ranks.collect();
        let leaves: Vec<u32> = run.lod.leaves().map(|(leaf, _)| leaf.get()).collect();
        let split = Split::over(cores);
        let shards = Shard::all(
            counts,
            &slices,
            split,
            &leaves,
            &ranks,
            pixels_per_view,
            run.options.reference == Reference::Original,
        );
        slices.iter_mut().for_each(ViewSlice::forget);
        let shared = Shared::new((foliage, views), split, slices, shards);
        Ok(Self {
            views,
            vmi_original,
            pool: SpinPool::new(cores, shared.most_parts()),
            shared,
            lead: Lead {
                sights,
                neighbours: Neighbours::new(foliage, &run.lod),
                pruned: None,
            },
        })
    }

    pub(super) fn prune_down_to(
        &mut self,
        run: &mut FastRun<'_>,
        leaves: usize,
    ) -> Result<Ended, VdsError> {
        let Self {
            views,
            vmi_original,
            shared,
            pool,
            lead,
        } = self;
        let shared: &Shared<'_> = shared;
        let mut left = run.lod.leaf_count();
        pool.run(
            |part| shared.do_part(part),
            || {
                while left > leaves {
                    let mut finds = lead.pick(run.options, shared, pool);
                    let share = lead.share(run, shared, finds);
                    // Other views than the last step's may show an error that is too large already.
                    let is_over =
                        || lead.error_is_over(run.max_error_percent, shared, vmi_original);
                    if share == 0.0 && is_on(Mechanism::HiddenTogether) && !is_over() {
                        let (gone, next) = lead.take_hidden(run, shared, finds, left - leaves)?;
                        left -= gone;
                        match next {
                            Some(next) => finds.cheapest = next,
                            None if gone > 0 => continue,
                            None => {}
                        }
                    }
                    let grown = lead.grow(run, finds.cheapest, share);
                    lead.apply(shared, pool, finds.cheapest.leaf, &grown);
                    if lead.error_is_over(run.max_error_percent, shared, vmi_original) {
                        return Ok(Ended::BeyondMaxError);
                    }
                    run.record(finds.cheapest, &grown);
                    left -= 1;
                    if !grown.is_empty() && left.is_multiple_of(STEPS_A_CHECK) {
                        run.may_lists_take(views, shared.list_bytes())?;
                    }
                    run.show_progress()?;
                }
                Ok(Ended::AtLeafCount)
            },
        )
    }

    pub(super) fn areas(&self) -> AreaTable {
        self.shared
            .with_counts(self.lead.pruned, |counts| counts.area_table())
    }

    /// One step in which every leaf is looked at, for what should be found.
    #[cfg(test)]
    pub(super) fn step_and_exhaustively(&mut self, run: &mut FastRun<'_>) -> (Finds, Finds) {
        let Self {
            shared, pool, lead, ..
        } = self;
        let finds = lead.pick(run.options, shared, pool);
        let shards = shared.shards.iter();
        let expected = shards.map(|shard| shard.lock().unwrap().exhaustively());
        let expected = expected.fold(Finds::NONE, Finds::and);
        let share = lead.share(run, shared, finds);
        let grown = lead.grow(run, finds.cheapest, share);
        lead.apply(shared, pool, finds.cheapest.leaf, &grown);
        run.record(finds.cheapest, &grown);
        (finds, expected)
    }
}

impl Lead {
    /// Has all shards follow the last step and look for their cheapest leaves.
    fn pick(&mut self, options: &VdsOptions, shared: &Shared<'_>, pool: &SpinPool) -> Finds {
        let job = Job::Search {
            pruned: self.pruned.take(),
            wants_largest: options.resize.needs_largest_cost(),
        };
        shared.do_together(pool, job);
        let finds = shared.finds();
        assert!(finds.cheapest != Found::NONE, "a leaf is left");
        finds
    }

    /// The share of the cheapest leaf's area that others take over.
    fn share(&self, run: &FastRun<'_>, shared: &Shared<'_>, finds: Finds) -> f64 {
        let leaf = leaf_id(finds.cheapest.leaf);
        let deviation = match run.options.resize {
            Resize::Deficit => shared.deviation_without(finds.cheapest.leaf),
            _ => 0,
        };
        let pruned = Pruned {
            leaf,
            cost: finds.cheapest.cost,
            deviation,
            covered_px: match run.options.max_coverage {
                Some(_) => shared.covered_px_without(finds.cheapest.leaf),
                None => 0,
            },
        };
        run.options.share(pruned, self.sights, || finds.largest)
    }

    /// Takes away up to `at_most` leaves that are among the first two of no pixel, each as long as it is the cheapest;
    /// no other leaf grows for them. As views show the same without them, costs stay what they are, and one search does
    /// for all. How many went, and the one that is the cheapest then, if that is known.
    fn take_hidden(
        &mut self,
        run: &mut FastRun<'_>,
        shared: &Shared<'_>,
        finds: Finds,
        at_most: usize,
    ) -> Result<(usize, Option<Found>), VdsError> {
        let mut without_effect = shared.without_effect();
        for gone in 0..at_most {
            let first = without_effect.first();
            let first = first.filter(|found| *found < finds.cheapest_with_effect);
            let Some(found) = first.filter(|found| without_effect.is_hidden(found.leaf)) else {
                return Ok((gone, first));
            };
            without_effect.remove_hidden(found.leaf);
            self.neighbours.remove(leaf_id(found.leaf));
            run.record(found, &[]);
            run.show_progress()?;
        }
        Ok((at_most, None))
    }

    /// The leaves that fill the gap of one that goes, and how large they become.
    fn grow(&mut self, run: &FastRun<'_>, pruned: Found, share: f64) -> Vec<Growth> {
        let leaf = leaf_id(pruned.leaf);
        self.neighbours.remove(leaf);
        if share == 0.0 {
            return Vec::new();
        }
        let count = run.options.neighbours;
        let nearest = self.neighbours.nearest(run.foliage, leaf, count);
        growths(run.foliage, &run.lod, leaf, share, &nearest)
    }

    fn apply(&mut self, shared: &Shared<'_>, pool: &SpinPool, leaf: u32, grown: &[Growth]) {
        let job = Job::Edit {
            pruned: leaf,
            grown: grown.to_vec(),
        };
        shared.do_together(pool, job);
        self.pruned = Some(leaf);
    }

    fn error_is_over(
        &self,
        max_percent: Option<f64>,
        shared: &Shared<'_>,
        vmi_original: &Vmi,
    ) -> bool {
        let Some(max) = max_percent else {
            return false;
        };
        let deviation = |counts: &Counts<'_>| counts.deviations().iter().map(|d| d.abs()).sum();
        let deviation = shared.with_counts(self.pruned, deviation);
        error_percent(deviation, vmi_original.scaled().iter().sum()) > max
    }
}
