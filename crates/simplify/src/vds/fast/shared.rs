//! What the threads of a step share, and the two jobs that they do together: editing
//! pixels, then following the edit and searching.

use std::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard, RwLockWriteGuard};

use secateur_model::{Foliage, Growth};
use secateur_raster::ViewSet;

use super::candidates::{Found, Limits};
use super::counts::Counts;
use super::shard::{Finds, Shard};
use super::spin_pool::SpinPool;
use super::split::Split;
use super::view_slice::ViewSlice;

/// What all threads do at a time.
pub(super) enum Job {
    /// Each slice of views takes a leaf away and draws those that grow.
    Edit { pruned: u32, grown: Vec<Growth> },
    /// Each shard follows the last step, if there was one, and looks for its
    /// cheapest leaf.
    Search {
        pruned: Option<u32>,
        wants_largest: bool,
    },
}

/// No thread ever waits for a lock: the rounds of the [`SpinPool`] keep apart who
/// reads and who writes, and the locks only prove it.
pub(super) struct Shared<'a> {
    foliage: &'a Foliage,
    views: &'a ViewSet,
    split: Split,
    slices: Vec<RwLock<ViewSlice>>,
    pub shards: Vec<Mutex<Shard<'a>>>,
    limits: Limits,
    job: RwLock<Job>,
}

const HELD: &str = "no thread panicked with a lock held";

impl<'a> Shared<'a> {
    pub(super) fn new(
        (foliage, views): (&'a Foliage, &'a ViewSet),
        split: Split,
        slices: Vec<ViewSlice>,
        shards: Vec<Shard<'a>>,
    ) -> Self {
        Self {
            foliage,
            views,
            split,
            slices: slices.into_iter().map(RwLock::new).collect(),
            shards: shards.into_iter().map(Mutex::new).collect(),
            limits: Limits::none(),
            job: RwLock::new(Job::Search {
                pruned: None,
                wants_largest: false,
            }),
        }
    }

    /// The most parts of a job.
    pub(super) fn most_parts(&self) -> usize {
        self.shards.len().max(self.slices.len())
    }

    fn shard(&self, index: usize) -> MutexGuard<'_, Shard<'a>> {
        self.shards[index].lock().expect(HELD)
    }

    /// Has the pool do a job.
    pub(super) fn do_together(&self, pool: &SpinPool, job: Job) {
        let parts = match job {
            Job::Edit { .. } => self.slices.len(),
            Job::Search { .. } => self.shards.len(),
        };
        *self.job.write().expect(HELD) = job;
        self.limits.reset();
        pool.begin(parts);
        pool.finish(|part| self.do_part(part));
    }

    /// A part of the job at hand.
    pub(super) fn do_part(&self, part: usize) {
        match &*self.job.read().expect(HELD) {
            Job::Edit { pruned, grown } => {
                let mut slice = self.slices[part].write().expect(HELD);
                slice.edit(self.foliage, self.views, *pruned, grown);
            }
            Job::Search {
                pruned,
                wants_largest,
            } => {
                let mut shard = self.shard(part);
                if let Some(leaf) = *pruned {
                    let slices = self.slices_as_edited();
                    shard.settle(&slices, leaf);
                    shard.begin_step();
                    shard.follow(&slices, leaf);
                } else {
                    shard.begin_step();
                }
                shard.search(&self.limits, *wants_largest);
            }
        }
    }

    fn slices_as_edited(&self) -> Vec<RwLockReadGuard<'_, ViewSlice>> {
        self.slices.iter().map(|p| p.read().expect(HELD)).collect()
    }

    /// Bytes of all lists of fragments.
    pub(super) fn list_bytes(&self) -> u64 {
        let slices = self.slices_as_edited();
        slices.iter().map(|slice| slice.list_bytes()).sum()
    }

    /// Areas after the last step, which may have pruned a leaf.
    pub(super) fn with_counts<T>(
        &self,
        pruned: Option<u32>,
        see: impl FnOnce(&Counts<'_>) -> T,
    ) -> T {
        let mut shard = self.shard(0);
        if let Some(leaf) = pruned {
            shard.settle(&self.slices_as_edited(), leaf);
        }
        see(shard.counts())
    }

    /// The leaves without effect, for the leader alone.
    pub(super) fn without_effect(&self) -> WithoutEffect<'_, 'a> {
        WithoutEffect {
            slices: self.slices.iter().map(|p| p.write().expect(HELD)).collect(),
            shards: (0..self.shards.len()).map(|k| self.shard(k)).collect(),
        }
    }

    /// What all shards found.
    pub(super) fn finds(&self) -> Finds {
        let finds = (0..self.shards.len()).map(|k| self.shard(k).finds);
        finds.fold(Finds::NONE, Finds::and)
    }

    /// Sum over the views of the VMI without a leaf less that of the original
    /// foliage, scaled.
    pub(super) fn deviation_without(&self, leaf: u32) -> i64 {
        let shard = self.shard(self.split.shard(leaf));
        let deviation: i64 = shard.counts().deviations().iter().sum();
        deviation + shard.delta_sum(leaf)
    }

    /// Pixels over all views that show foliage without a leaf.
    pub(super) fn covered_px_without(&self, leaf: u32) -> u64 {
        let shard = self.shard(self.split.shard(leaf));
        shard.counts().covered_px() - u64::from(shard.background_px(leaf))
    }
}

/// Leaves without effect, as they are taken away between two rounds.
pub(super) struct WithoutEffect<'s, 'a> {
    slices: Vec<RwLockWriteGuard<'s, ViewSlice>>,
    shards: Vec<MutexGuard<'s, Shard<'a>>>,
}

impl WithoutEffect<'_, '_> {
    /// The first of all shards, with its cost.
    pub(super) fn first(&self) -> Option<Found> {
        let shards = self.shards.iter();
        shards
            .filter_map(|shard| shard.first_without_effect())
            .min()
    }

    /// Whether a leaf is among the first two of no pixel.
    pub(super) fn is_hidden(&self, leaf: u32) -> bool {
        self.slices.iter().all(|slice| slice.is_hidden(leaf))
    }

    /// Takes a hidden leaf away: nothing else changes.
    pub(super) fn remove_hidden(&mut self, leaf: u32) {
        self.slices
            .iter_mut()
            .for_each(|slice| slice.remove_hidden(leaf));
        self.shards.iter_mut().for_each(|shard| shard.forget(leaf));
    }
}
