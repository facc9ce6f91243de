//! What a step changes at the front of the pixels.

use super::switches::{Mechanism, is_on};

/// The front leaf of a pixel and the one behind it; 0 where there is none.
pub(super) type Ends = [u32; 2];

/// Some pixels of a view, of which the first two leaves changed alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Event {
    pub view: u32,
    pub pixels: u32,
    pub before: Ends,
    pub after: Ends,
}

/// Events of which this many are remembered as they come.
const RECENT: usize = 64;

/// Events in turn, but of a [round](Self::begin_round) those alike are mostly
/// one: shards follow events, not pixels.
pub(super) struct Events {
    all: Vec<Event>,
    /// Where those of the round begin.
    round: usize,
    /// Where the last pixel was counted.
    last: usize,
    /// Where others were, by what changed; only where the event there agrees.
    recent: [u32; RECENT],
}

impl Default for Events {
    fn default() -> Self {
        Self {
            all: Vec::new(),
            round: 0,
            last: 0,
            recent: [0; RECENT],
        }
    }
}

impl Events {
    pub(super) fn all(&self) -> &[Event] {
        &self.all
    }

    /// From here on until the next call no pixel changes twice. Events of two
    /// rounds stay apart and in order: a pixel may lose in the second what it
    /// gained in the first, and what is counted never falls below zero.
    pub(super) fn begin_round(&mut self) {
        self.round = self.all.len();
    }

    /// Notes one more pixel.
    #[inline]
    pub(super) fn push(&mut self, view: u32, before: Ends, after: Ends) {
        let is_same = |e: &Event| (e.view, e.before, e.after) == (view, before, after);
        let round = self.round;
        let is_there = |at: usize, all: &[Event]| at >= round && all.get(at).is_some_and(is_same);
        if !is_there(self.last, &self.all) {
            let place = &mut self.recent[place_among_recent(view, before, after)];
            self.last = *place as usize;
            if !is_on(Mechanism::RecentEvents) || !is_there(self.last, &self.all) {
                self.last = self.all.len();
                *place = self.last as u32;
                self.all.push(Event {
                    view,
                    pixels: 0,
                    before,
                    after,
                });
            }
        }
        self.all[self.last].pixels += 1;
    }

    /// The views count from here on instead of from 0.
    pub(super) fn move_views(&mut self, by: u32) {
        for event in &mut self.all {
            event.view += by;
        }
    }

    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.round = 0;
    }
}

#[inline]
fn place_among_recent(view: u32, before: Ends, after: Ends) -> usize {
    let [a, b] = [before, after].map(|[front, second]| u64::from(front) << 32 | u64::from(second));
    let mixed = (a.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ b ^ u64::from(view) << 40)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (mixed >> 58) as usize % RECENT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_change_alike_in_a_round_are_one_event() {
        let mut events = Events::default();
        events.push(0, [1, 2], [2, 0]);
        events.push(0, [1, 2], [2, 0]);
        events.push(1, [1, 2], [2, 0]);
        events.push(1, [1, 3], [2, 0]);
        events.push(1, [1, 3], [3, 0]);
        events.push(0, [1, 2], [2, 0]);
        events.push(1, [1, 3], [3, 0]);
        events.begin_round();
        events.push(1, [1, 3], [3, 0]);
        events.push(0, [1, 2], [2, 0]);
        events.push(1, [1, 3], [3, 0]);
        events.move_views(5);
        let found: Vec<_> = events.all().iter().map(|e| (e.view, e.pixels)).collect();
        assert_eq!(found, [(5, 3), (6, 1), (6, 1), (6, 2), (6, 2), (5, 1)]);
        events.clear();
        assert_eq!(events.all().len(), 0);
    }

    #[test]
    fn what_is_forgotten_between_is_counted_all_the_same() {
        let mut events = Events::default();
        for _ in 0..3 {
            for leaf in 1..=500 {
                events.push(leaf % 3, [leaf, 0], [0, 0]);
            }
            events.clear();
            for leaf in (1..=500).chain(1..=500) {
                events.push(leaf % 3, [leaf, leaf + 1], [leaf + 1, 0]);
            }
            for leaf in 1..=500 {
                let of_leaf = events.all().iter().filter(|e| e.before == [leaf, leaf + 1]);
                assert!(of_leaf.clone().all(|e| e.view == leaf % 3));
                assert_eq!(of_leaf.map(|e| e.pixels).sum::<u32>(), 2);
            }
        }
    }
}
