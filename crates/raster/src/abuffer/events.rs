//! What edits change at the front of the pixels.

/// The numbers of the front leaf of a pixel and of the one behind it; 0 where there is none.
pub type FrontTwo = [u32; 2];

/// Some pixels of a view, of which the first two leaves changed alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Index of the view.
    pub view: u32,
    /// The number of pixels.
    pub pixels: u32,
    /// The first two leaves as they were.
    pub before: FrontTwo,
    /// The first two leaves as they are.
    pub after: FrontTwo,
}

/// Events of which this many are remembered as they come.
const RECENT: usize = 64;

/// Events in turn, but of a [round](Self::begin_round) those alike are mostly one: who
/// follows events has far fewer to follow than pixels.
#[derive(Clone, Debug)]
pub struct Events {
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
    /// The events in turn.
    pub fn all(&self) -> &[Event] {
        &self.all
    }

    /// From here on until the next call no pixel changes twice. Events of two
    /// rounds stay apart and in order: a pixel may lose in the second what it
    /// gained in the first, and what is counted never falls below zero.
    pub fn begin_round(&mut self) {
        self.round = self.all.len();
    }

    /// Notes one more pixel.
    #[inline]
    pub fn push(&mut self, view: u32, before: FrontTwo, after: FrontTwo) {
        let is_same = |e: &Event| (e.view, e.before, e.after) == (view, before, after);
        let round = self.round;
        let is_there = |at: usize, all: &[Event]| at >= round && all.get(at).is_some_and(is_same);
        if !is_there(self.last, &self.all) {
            let place = &mut self.recent[place_among_recent(view, before, after)];
            self.last = *place as usize;
            if !is_there(self.last, &self.all) {
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
    pub fn move_views(&mut self, by: u32) {
        for event in &mut self.all {
            event.view += by;
        }
    }

    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.all.clear();
        self.round = 0;
    }
}

#[inline]
fn place_among_recent(view: u32, before: FrontTwo, after: FrontTwo) -> usize {
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
