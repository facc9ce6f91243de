//! What the shards let each other know while they search: the best costs so far, so that
//! each can rule out more.

use std::sync::atomic::{AtomicI64, Ordering};

use super::super::switches::{Mechanism, is_on};

/// The least and the largest cost that any shard has found in this step. They
/// only spare looking: a leaf of just these costs is never ruled out by them, so
/// what is found does not depend on who finds it first.
#[derive(Debug)]
pub(in super::super) struct Limits {
    least: AtomicI64,
    largest: AtomicI64,
}

impl Limits {
    pub(in super::super) fn none() -> Self {
        Self {
            least: AtomicI64::new(i64::MAX),
            largest: AtomicI64::new(i64::MIN),
        }
    }

    /// Forgets what was found: a new step begins.
    pub(in super::super) fn reset(&self) {
        self.least.store(i64::MAX, Ordering::Relaxed);
        self.largest.store(i64::MIN, Ordering::Relaxed);
    }

    /// The least cost found, this one included.
    #[inline]
    pub(super) fn lower_least(&self, cost: i64) -> i64 {
        if !is_on(Mechanism::SharedLimits) {
            return cost;
        }
        let known = self.least.load(Ordering::Relaxed);
        if cost < known {
            self.least.fetch_min(cost, Ordering::Relaxed);
        }
        known.min(cost)
    }

    /// The largest cost found, this one included.
    #[inline]
    pub(super) fn raise_largest(&self, cost: i64) -> i64 {
        if !is_on(Mechanism::SharedLimits) {
            return cost;
        }
        let known = self.largest.load(Ordering::Relaxed);
        if cost > known {
            self.largest.fetch_max(cost, Ordering::Relaxed);
        }
        known.max(cost)
    }
}
