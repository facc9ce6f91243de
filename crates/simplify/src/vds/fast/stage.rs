//! The loop under one view set: pick, grow, apply, record.

use secateur_model::{Growth, LeafId, Lod};
use secateur_raster::{AreaTable, ViewSet};

use super::candidates::Found;
use super::counts::Counts;
use super::crew::Crew;
use super::neighbours::Neighbours;
use super::pane::Pane;
use super::shard::{Finds, Shard};
use super::shared::{Job, Shared};
use super::split::Split;
use super::{Run, leaf_id};
use crate::vds::outcome::{Progress, Stopped, VdsError};
use crate::vds::resize::{Pruned, covered_px, growths};
use crate::vds::{Reference, Resize, VdsOptions};
use crate::vmi::{Vmi, error_percent};

/// The engine's state for one view set.
pub(super) struct Stage<'a> {
    pub views: &'a ViewSet,
    pub vmi_original: Vmi,
    shared: Shared<'a>,
    crew: Crew,
    lead: Lead,
}

/// What one core does alone.
struct Lead {
    /// Pixels over all views in which the original foliage is seen.
    covered_original_px: u64,
    neighbours: Neighbours,
    /// The leaf that the last step pruned.
    pruned: Option<u32>,
}

impl<'a> Stage<'a> {
    pub(super) fn new<'r: 'a>(
        run: &Run<'r>,
        views: &'a ViewSet,
        cores: usize,
    ) -> Result<Self, VdsError> {
        let foliage = run.foliage;
        let leaf_count = foliage.leaves().len();
        let fragments = run.rasteriser.fragments(&run.scene(&run.lod, views));
        let fragments = fragments.map_err(VdsError::from_raster)?;
        let pixels_per_view = fragments.pixels_per_view();
        // A few for each core, which may be late.
        let panes = if cores > 1 { 2 * cores } else { 1 };
        let mut panes = Pane::all(fragments, leaf_count, panes);
        let mut counts = Counts::new(
            panes.iter().flat_map(Pane::events),
            views.views().len(),
            pixels_per_view as u32,
            leaf_count,
            run.table,
        );
        let areas_now = area_table(&counts);
        let vmi_now = Vmi::of(&areas_now, run.table);
        let areas_original = match run.order.is_empty() {
            true => areas_now,
            false => run.areas(&Lod::original(leaf_count), views)?,
        };
        let vmi_original = Vmi::of(&areas_original, run.table);
        let pairs = vmi_now.scaled().iter().zip(vmi_original.scaled());
        counts.set_deviations(pairs.map(|(now, then)| now - then).collect());
        let ranks = (0..=leaf_count as u32)
            .map(|n| LeafId::new(n).map_or(0, |leaf| run.options.ties.rank(leaf)));
        let ranks = ranks.collect();
        let leaves: Vec<u32> = run.lod.leaves().map(|(leaf, _)| leaf.get()).collect();
        let split = Split::over(cores);
        let shards = Shard::all(
            &counts,
            &panes,
            split,
            &leaves,
            &ranks,
            pixels_per_view,
            run.options.reference == Reference::Original,
        );
        panes.iter_mut().for_each(Pane::forget);
        let shared = Shared::new((foliage, views), split, panes, shards);
        Ok(Self {
            views,
            vmi_original,
            crew: Crew::new(cores, shared.most_parts()),
            shared,
            lead: Lead {
                covered_original_px: covered_px(&areas_original),
                neighbours: Neighbours::new(foliage, &run.lod),
                pruned: None,
            },
        })
    }

    pub(super) fn prune_down_to(
        &mut self,
        run: &mut Run<'_>,
        leaves: usize,
    ) -> Result<Stopped, VdsError> {
        let Self {
            vmi_original,
            shared,
            crew,
            lead,
            ..
        } = self;
        let shared: &Shared<'_> = shared;
        let mut left = run.lod.leaf_count();
        crew.run(
            |part| shared.do_part(part),
            || {
                while left > leaves {
                    let finds = lead.pick(run.options, shared, crew);
                    let grown = lead.grow(run, shared, finds);
                    lead.apply(shared, crew, finds.cheapest.leaf, &grown);
                    if lead.error_is_over(run.options, shared, vmi_original) {
                        return Ok(Stopped::AtMaxError);
                    }
                    run.record(finds.cheapest, &grown);
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
            },
        )
    }

    pub(super) fn areas(&self) -> AreaTable {
        self.shared.with_counts(self.lead.pruned, area_table)
    }

    /// One step in which every leaf is looked at, for what should be found.
    #[cfg(test)]
    pub(super) fn step_and_exhaustively(&mut self, run: &mut Run<'_>) -> (Finds, Finds) {
        let Self {
            shared, crew, lead, ..
        } = self;
        let finds = lead.pick(run.options, shared, crew);
        let shards = shared.shards.iter();
        let expected = shards.map(|shard| shard.lock().unwrap().exhaustively());
        let expected = expected.fold(Finds::NONE, Finds::and);
        let grown = lead.grow(run, shared, finds);
        lead.apply(shared, crew, finds.cheapest.leaf, &grown);
        run.record(finds.cheapest, &grown);
        (finds, expected)
    }
}

impl Lead {
    /// Has all shards follow the last step and look for their cheapest leaves.
    fn pick(&mut self, options: &VdsOptions, shared: &Shared<'_>, crew: &Crew) -> Finds {
        let job = Job::Search {
            pruned: self.pruned.take(),
            wants_largest: options.resize == Resize::Normalised,
        };
        shared.do_together(crew, job);
        let finds = shared.finds();
        assert!(finds.cheapest != Found::NONE, "a leaf is left");
        finds
    }

    /// The leaves that fill the gap of the cheapest, and how large they become.
    fn grow(&mut self, run: &Run<'_>, shared: &Shared<'_>, finds: Finds) -> Vec<Growth> {
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
        let original_px = self.covered_original_px;
        let share = run.options.share(pruned, original_px, || finds.largest);
        self.neighbours.remove(leaf);
        if share == 0.0 {
            return Vec::new();
        }
        let count = run.options.neighbours;
        let nearest = self.neighbours.nearest(run.foliage, leaf, count);
        growths(run.foliage, &run.lod, leaf, share, &nearest)
    }

    fn apply(&mut self, shared: &Shared<'_>, crew: &Crew, leaf: u32, grown: &[Growth]) {
        let job = Job::Edit {
            pruned: leaf,
            grown: grown.to_vec(),
        };
        shared.do_together(crew, job);
        self.pruned = Some(leaf);
    }

    fn error_is_over(&self, options: &VdsOptions, shared: &Shared<'_>, vmi_original: &Vmi) -> bool {
        let Some(max) = options.stop.max_error_percent else {
            return false;
        };
        let deviation = |counts: &Counts<'_>| counts.deviations().iter().map(|d| d.abs()).sum();
        let deviation = shared.with_counts(self.pruned, deviation);
        error_percent(deviation, vmi_original.scaled().iter().sum()) > max
    }
}

fn area_table(counts: &Counts<'_>) -> AreaTable {
    let views = 0..counts.view_count();
    let leaf_count = counts.leaf_count();
    let row = |view: usize| (0..=leaf_count as u32).map(move |leaf| counts.areas(leaf)[view]);
    AreaTable::from_rows(leaf_count, views.flat_map(row).collect())
}
