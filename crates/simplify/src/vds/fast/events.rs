//! What a step changes at the front of the pixels.

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

/// Events in turn. Pixels side by side mostly change alike and are one event.
#[derive(Default)]
pub(super) struct Events(Vec<Event>);

impl Events {
    pub(super) fn all(&self) -> &[Event] {
        &self.0
    }

    /// Notes one more pixel.
    #[inline]
    pub(super) fn push(&mut self, view: u32, before: Ends, after: Ends) {
        match self.0.last_mut() {
            Some(last) if (last.view, last.before, last.after) == (view, before, after) => {
                last.pixels += 1;
            }
            _ => self.0.push(Event {
                view,
                pixels: 1,
                before,
                after,
            }),
        }
    }

    /// The views count from here on instead of from 0.
    pub(super) fn move_views(&mut self, by: u32) {
        for event in &mut self.0 {
            event.view += by;
        }
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_that_change_alike_are_one_event() {
        let mut events = Events::default();
        events.push(0, [1, 2], [2, 0]);
        events.push(0, [1, 2], [2, 0]);
        events.push(1, [1, 2], [2, 0]);
        events.push(1, [1, 3], [2, 0]);
        events.push(1, [1, 3], [3, 0]);
        events.push(1, [1, 3], [3, 0]);
        events.move_views(5);
        let found: Vec<_> = events.all().iter().map(|e| (e.view, e.pixels)).collect();
        assert_eq!(found, [(5, 2), (6, 1), (6, 1), (6, 2)]);
        events.clear();
        assert_eq!(events.all().len(), 0);
    }
}
