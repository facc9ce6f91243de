//! What the threads of a step share.

use std::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard, RwLockWriteGuard};

use secateur_model::{Foliage, Growth};
use secateur_raster::ViewSet;

use super::candidates::Limits;
use super::counts::Counts;
use super::crew::Crew;
use super::pane::Pane;
use super::shard::{Finds, Shard};
use super::split::Split;

/// What all threads do at a time.
pub(super) enum Job {
    /// Each pane takes a leaf away and draws those that grow.
    Edit { pruned: u32, grown: Vec<Growth> },
    /// Each shard follows the last step, if there was one, and looks for its
    /// cheapest leaf.
    Search {
        pruned: Option<u32>,
        deviations: Vec<i64>,
        wants_largest: bool,
    },
}

/// No thread ever waits for a lock: the rounds of the [`Crew`] keep apart who
/// reads and who writes, and the locks only prove it.
pub(super) struct Shared<'a> {
    foliage: &'a Foliage,
    views: &'a ViewSet,
    split: Split,
    counts: RwLock<Counts<'a>>,
    panes: Vec<RwLock<Pane>>,
    pub shards: Vec<Mutex<Shard>>,
    limits: Limits,
    job: RwLock<Job>,
}

/// How far ahead the areas that an event changes are asked for.
const EVENTS_AHEAD: usize = 6;

const HELD: &str = "no thread panicked with a lock held";

impl<'a> Shared<'a> {
    pub(super) fn new(
        (foliage, views): (&'a Foliage, &'a ViewSet),
        split: Split,
        counts: Counts<'a>,
        panes: Vec<Pane>,
        shards: Vec<Shard>,
    ) -> Self {
        Self {
            foliage,
            views,
            split,
            counts: RwLock::new(counts),
            panes: panes.into_iter().map(RwLock::new).collect(),
            shards: shards.into_iter().map(Mutex::new).collect(),
            limits: Limits::none(),
            job: RwLock::new(Job::Search {
                pruned: None,
                deviations: Vec::new(),
                wants_largest: false,
            }),
        }
    }

    /// The most parts of a job.
    pub(super) fn most_parts(&self) -> usize {
        self.shards.len().max(self.panes.len())
    }

    pub(super) fn counts(&self) -> RwLockReadGuard<'_, Counts<'a>> {
        self.counts.read().expect(HELD)
    }

    pub(super) fn counts_mut(&self) -> RwLockWriteGuard<'_, Counts<'a>> {
        self.counts.write().expect(HELD)
    }

    fn shard(&self, index: usize) -> MutexGuard<'_, Shard> {
        self.shards[index].lock().expect(HELD)
    }

    /// Has the crew do a job.
    pub(super) fn do_together(&self, crew: &Crew, job: Job) {
        let parts = match job {
            Job::Edit { .. } => self.panes.len(),
            Job::Search { .. } => self.shards.len(),
        };
        *self.job.write().expect(HELD) = job;
        self.limits.reset();
        crew.begin(parts);
        crew.finish(|part| self.do_part(part));
    }

    /// A part of the job at hand.
    pub(super) fn do_part(&self, part: usize) {
        match &*self.job.read().expect(HELD) {
            Job::Edit { pruned, grown } => {
                let mut pane = self.panes[part].write().expect(HELD);
                pane.edit(self.foliage, self.views, *pruned, grown);
            }
            Job::Search {
                pruned,
                deviations,
                wants_largest,
            } => {
                let counts = self.counts();
                let mut shard = self.shard(part);
                shard.begin_step(&counts, deviations);
                if let Some(leaf) = *pruned {
                    let panes: Vec<_> = self.panes.iter().map(|p| p.read().expect(HELD)).collect();
                    let events = panes.iter().flat_map(|pane| pane.events());
                    shard.follow(&counts, events, leaf);
                }
                shard.search(&counts, &self.limits, *wants_largest);
            }
        }
    }

    /// Brings the areas up to date with what the panes edited.
    pub(super) fn settle(&self) {
        let mut counts = self.counts_mut();
        for pane in &self.panes {
            let pane = pane.read().expect(HELD);
            for (k, event) in pane.events().iter().enumerate() {
                if let Some(ahead) = pane.events().get(k + EVENTS_AHEAD) {
                    counts.prefetch(ahead);
                }
                counts.record(event);
            }
        }
        counts.settle();
    }

    /// What all shards found.
    pub(super) fn finds(&self) -> Finds {
        let finds = (0..self.shards.len()).map(|k| self.shard(k).finds);
        finds.fold(Finds::NONE, Finds::and)
    }

    /// Sum over the views of the VMI without a leaf less that of the original
    /// foliage, scaled.
    pub(super) fn deviation_without(&self, leaf: u32) -> i64 {
        let counts = self.counts();
        let deviation: i64 = counts.deviations().iter().sum();
        deviation + self.shard(self.split.shard(leaf)).delta_sum(&counts, leaf)
    }

    /// Pixels over all views that show foliage without a leaf.
    pub(super) fn covered_px_without(&self, leaf: u32) -> u64 {
        let shard = self.shard(self.split.shard(leaf));
        self.counts().covered_px() - u64::from(shard.background_px(leaf))
    }
}
