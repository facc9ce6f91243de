//! What the threads of a step share.

use std::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard, RwLockWriteGuard};

use secateur_model::{Foliage, Growth};
use secateur_raster::ViewSet;
use secateur_raster::cpu::LeafFragments;

use super::candidates::Limits;
use super::counts::Counts;
use super::crew::Crew;
use super::shard::{Finds, Shard};

/// What all threads do at a time.
pub(super) enum Job {
    /// Each shard follows the last step, if there was one, and looks for its
    /// cheapest leaf.
    Search {
        pruned: Option<u32>,
        deviations: Vec<i64>,
        wants_largest: bool,
    },
    /// Rasterises a leaf as it has grown, some views at a time.
    Draw(Growth),
}

/// Fragments of a leaf in some of the views.
struct Drawing {
    leaf_fragments: LeafFragments,
    /// Pixel over all views, and depth.
    found: Vec<(u32, u32)>,
}

/// No thread ever waits for a lock: the rounds of the [`Crew`] keep apart who
/// reads and who writes, and the locks only prove it.
pub(super) struct Shared<'a> {
    foliage: &'a Foliage,
    views: &'a ViewSet,
    resolution: u32,
    counts: RwLock<Counts<'a>>,
    pub shards: Vec<Mutex<Shard>>,
    limits: Limits,
    job: RwLock<Job>,
    drawings: Vec<Mutex<Drawing>>,
}

const HELD: &str = "no thread panicked with a lock held";

impl<'a> Shared<'a> {
    pub(super) fn new(
        foliage: &'a Foliage,
        views: &'a ViewSet,
        resolution: u32,
        counts: Counts<'a>,
        shards: Vec<Shard>,
        cores: usize,
    ) -> Self {
        // A few for each core, which may be late.
        let drawings = if cores > 1 { 2 * cores } else { 1 };
        let drawing = |_| {
            Mutex::new(Drawing {
                leaf_fragments: LeafFragments::new(resolution),
                found: Vec::new(),
            })
        };
        Self {
            foliage,
            views,
            resolution,
            counts: RwLock::new(counts),
            shards: shards.into_iter().map(Mutex::new).collect(),
            limits: Limits::none(),
            job: RwLock::new(Job::Search {
                pruned: None,
                deviations: Vec::new(),
                wants_largest: false,
            }),
            drawings: (0..drawings).map(drawing).collect(),
        }
    }

    /// The most parts of a job.
    pub(super) fn most_parts(&self) -> usize {
        self.shards.len().max(self.drawings.len())
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

    /// Has the crew do a job, and does `meanwhile` first.
    pub(super) fn do_together(&self, crew: &Crew, job: Job, meanwhile: impl FnOnce()) {
        let parts = match job {
            Job::Search { .. } => self.shards.len(),
            Job::Draw(_) => self.drawings.len(),
        };
        *self.job.write().expect(HELD) = job;
        self.limits.reset();
        crew.begin(parts);
        meanwhile();
        crew.finish(|part| self.do_part(part));
    }

    /// A part of the job at hand.
    pub(super) fn do_part(&self, part: usize) {
        match &*self.job.read().expect(HELD) {
            Job::Search {
                pruned,
                deviations,
                wants_largest,
            } => {
                let counts = self.counts();
                let mut shard = self.shard(part);
                if let Some(leaf) = *pruned {
                    shard.follow(&counts, leaf);
                }
                shard.search(&counts, deviations, &self.limits, *wants_largest);
            }
            Job::Draw(growth) => self.draw(part, *growth),
        }
    }

    fn draw(&self, part: usize, growth: Growth) {
        let mut drawing = self.drawings[part].lock().expect(HELD);
        let Drawing {
            leaf_fragments,
            found,
        } = &mut *drawing;
        found.clear();
        let (views, parts) = (self.views.views(), self.drawings.len());
        let per_view = self.resolution * self.resolution;
        let range = part * views.len() / parts..(part + 1) * views.len() / parts;
        for (v, view) in views.iter().enumerate().take(range.end).skip(range.start) {
            let first_pixel = v as u32 * per_view;
            let fragments = leaf_fragments.of(self.foliage, growth.leaf, growth.area_scale, view);
            let of_all = |(pixel, depth): &(u32, u32)| (first_pixel + pixel, *depth);
            found.extend(fragments.iter().map(of_all));
        }
    }

    /// The fragments of the leaf that was drawn, view by view.
    pub(super) fn take_drawn(&self, all: &mut Vec<(u32, u32)>) {
        all.clear();
        for drawing in &self.drawings {
            all.append(&mut drawing.lock().expect(HELD).found);
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
        let counts = self.counts();
        let deviation: i64 = counts.deviations().iter().sum();
        let owner = counts.edges.split().shard(leaf);
        deviation + self.shard(owner).delta_sum(&counts, leaf)
    }
}
