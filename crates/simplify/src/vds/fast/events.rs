//! What a step changes at the front of the pixels: the only thing that areas, edges and
//! costs need to hear of an edit.

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

/// Events in turn, but of a [round](Self::begin_round) those alike and next to each
/// other are one: shards follow events, not pixels.
#[derive(Default)]
pub(super) struct Events {
    all: Vec<Event>,
    /// Where those of the round begin.
    round: usize,
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
        match self.all[self.round..].last_mut() {
            Some(last) if (last.view, last.before, last.after) == (view, before, after) => {
                last.pixels += 1;
            }
            _ => self.all.push(Event {
                view,
                pixels: 1,
                before,
                after,
            }),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_in_a_row_that_change_alike_in_a_round_are_one_event() {
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
        assert_eq!(
            found,
            [
                (5, 2),
                (6, 1),
                (6, 1),
                (6, 1),
                (5, 1),
                (6, 1),
                (6, 1),
                (5, 1),
                (6, 1)
            ]
        );
        events.clear();
        assert_eq!(events.all().len(), 0);
    }
}
