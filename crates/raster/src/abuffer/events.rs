//! What edits change at the front of the pixels: the only thing that areas, reveal edges and
//! costs need to hear of an edit.

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

/// Events in turn, but of a [round](Self::begin_round) those alike and next to each other are
/// one: who follows events has far fewer to follow than pixels.
#[derive(Clone, Debug, Default)]
pub struct Events {
    all: Vec<Event>,
    /// Where those of the round begin.
    round: usize,
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

    /// Forgets all of them.
    pub fn clear(&mut self) {
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
        let found: Vec<_> = events.all().iter().map(|e| (e.view, e.pixels)).collect();
        assert_eq!(
            found,
            [
                (0, 2),
                (1, 1),
                (1, 1),
                (1, 1),
                (0, 1),
                (1, 1),
                (1, 1),
                (0, 1),
                (1, 1)
            ]
        );
        events.clear();
        assert_eq!(events.all().len(), 0);
    }
}
