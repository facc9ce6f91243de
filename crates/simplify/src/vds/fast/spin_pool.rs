//! A few threads that share the work of every step.
//!
//! A step takes a fraction of a millisecond, less than it takes to wake a
//! thread, so those of the pool stay awake between steps and wait by spinning. A part
//! of the work that no helper has begun is done by the leader: on a machine that
//! is busy with other things nothing waits for a thread that does not run.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Turns of spinning, some tens of microseconds, before other threads are let
/// in between.
const SPINS: u32 = 1000;

/// Bits of a round's word that hold how many parts it has.
const PARTS_BITS: u32 = 8;

/// The most parts that a round may have.
pub(super) const MAX_PARTS: usize = (1 << PARTS_BITS) - 1;

/// A counter with a cache line of its own.
#[repr(align(128))]
struct Claim(AtomicU64);

/// Work in rounds of numbered parts, each done once, by whoever comes first.
pub(super) struct SpinPool {
    members: usize,
    /// Number of the round, then how many parts it has.
    round: AtomicU64,
    /// By part, the word of the last round in which it was taken.
    claims: Vec<Claim>,
    /// Parts that are not done yet.
    left: AtomicUsize,
    is_over: AtomicBool,
    has_failed: AtomicBool,
}

impl SpinPool {
    /// Of a leader and helpers, for rounds of up to `parts` parts.
    pub(super) fn new(members: usize, parts: usize) -> Self {
        assert!(parts <= MAX_PARTS, "{parts} parts");
        Self {
            members,
            round: AtomicU64::new(0),
            claims: (0..parts).map(|_| Claim(AtomicU64::new(0))).collect(),
            left: AtomicUsize::new(0),
            is_over: AtomicBool::new(false),
            has_failed: AtomicBool::new(false),
        }
    }

    /// Does `lead` while helpers do parts of the rounds that it begins.
    pub(super) fn run<T>(&self, work: impl Fn(usize) + Sync, lead: impl FnOnce() -> T) -> T {
        self.is_over.store(false, Ordering::Relaxed);
        std::thread::scope(|scope| {
            let _over = Raised(&self.is_over);
            for member in 1..self.members {
                let work = &work;
                scope.spawn(move || self.help(member, work));
            }
            lead()
        })
    }

    /// Lets helpers begin a round.
    pub(super) fn begin(&self, parts: usize) {
        assert!(parts <= self.claims.len(), "{parts} parts");
        self.left.store(parts, Ordering::Relaxed);
        let number = (self.round.load(Ordering::Relaxed) >> PARTS_BITS) + 1;
        let word = number << PARTS_BITS | parts as u64;
        self.round.store(word, Ordering::Release);
    }

    /// Does what no helper has begun of the round, and waits for the rest.
    ///
    /// # Panics
    /// If a helper has.
    pub(super) fn finish(&self, work: impl Fn(usize)) {
        self.take_part(0, self.round.load(Ordering::Relaxed), &work);
        wait_until(|| {
            self.left.load(Ordering::Acquire) == 0 || self.has_failed.load(Ordering::Relaxed)
        });
        assert!(
            !self.has_failed.load(Ordering::Relaxed),
            "a helping thread panicked"
        );
    }

    fn help(&self, member: usize, work: &impl Fn(usize)) {
        let mut last = 0;
        loop {
            wait_until(|| {
                self.round.load(Ordering::Relaxed) != last || self.is_over.load(Ordering::Relaxed)
            });
            if self.is_over.load(Ordering::Relaxed) {
                return;
            }
            last = self.round.load(Ordering::Acquire);
            let failed = Raised(&self.has_failed);
            self.take_part(member, last, work);
            std::mem::forget(failed);
        }
    }

    /// Beginning with those that are this member's turn.
    fn take_part(&self, member: usize, round: u64, work: &impl Fn(usize)) {
        let parts = (round & MAX_PARTS as u64) as usize;
        for k in 0..parts {
            let part = (member * parts / self.members + k) % parts;
            let claim = &self.claims[part].0;
            let before = claim.load(Ordering::Relaxed);
            let is_free = before < round;
            if is_free
                && claim
                    .compare_exchange(before, round, Ordering::AcqRel, Ordering::Relaxed)
                    .is_ok()
            {
                work(part);
                self.left.fetch_sub(1, Ordering::Release);
            }
        }
    }
}

/// Raises a flag when it goes.
struct Raised<'a>(&'a AtomicBool);

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn wait_until(is_so: impl Fn() -> bool) {
    let mut spins = 0;
    while !is_so() {
        match spins < SPINS {
            true => std::hint::spin_loop(),
            false => std::thread::yield_now(),
        }
        spins += 1;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn each_part_of_each_round_is_done_once() {
        for members in [1, 2, 5] {
            let pool = SpinPool::new(members, 7);
            let done: Vec<Mutex<u32>> = (0..7).map(|_| Mutex::new(0)).collect();
            let work = |part: usize| *done[part].lock().unwrap() += 1;
            pool.run(work, || {
                for round in 0..2000 {
                    pool.begin(round % 7 + 1);
                    pool.finish(work);
                    let parts = done.iter().map(|d| std::mem::take(&mut *d.lock().unwrap()));
                    let expected = (0..7).map(|part| u32::from(part <= round % 7));
                    assert!(parts.eq(expected), "{members} members, round {round}");
                }
            });
        }
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_helper_that_panics_is_not_waited_for() {
        let pool = SpinPool::new(2, 2);
        let begun = AtomicUsize::new(0);
        let main = std::thread::current().id();
        let work = |_: usize| {
            // Both parts must have been begun, one by the helper.
            begun.fetch_add(1, Ordering::Relaxed);
            wait_until(|| begun.load(Ordering::Relaxed) == 2);
            assert_eq!(std::thread::current().id(), main, "a helper");
        };
        let caught = std::panic::AssertUnwindSafe(|| {
            pool.begin(2);
            pool.finish(work);
        });
        pool.run(work, || {
            assert!(std::panic::catch_unwind(caught).is_err());
        });
    }
}
