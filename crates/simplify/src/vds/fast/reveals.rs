//! What a leaf would hand to another, view by view.

use smallvec::SmallVec;

/// Pixels by view, only those that are not zero: a word for each view, so that
/// most edges are one cache line with all they have.
#[derive(Clone)]
pub(super) struct Reveals {
    /// View, then pixels less one.
    words: SmallVec<[u32; 6]>,
    /// Bits for the pixels.
    shift: u8,
}

impl Reveals {
    /// No reveals yet. All views together have at most
    /// [`MAX_TOTAL_PIXELS`](secateur_raster::MAX_TOTAL_PIXELS), and with them
    /// the words have room for every view.
    pub(super) fn none(pixels_per_view: u32) -> Self {
        Self {
            words: SmallVec::new(),
            shift: pixels_per_view.next_power_of_two().ilog2() as u8,
        }
    }

    /// Views with their pixels.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let (shift, mask) = (self.shift, (1 << self.shift) - 1);
        self.words.iter().map(move |w| (w >> shift, (w & mask) + 1))
    }

    /// Hands over more pixels of a view, or fewer.
    #[inline]
    pub(super) fn add(&mut self, view: u32, by: i32) {
        let known = self.words.iter().position(|w| w >> self.shift == view);
        let Some(at) = known else {
            debug_assert!(by > 0, "pixels come before they go");
            self.words.push(view << self.shift | (by as u32 - 1));
            return;
        };
        let pixels_less_one = self.words[at] & ((1 << self.shift) - 1);
        match pixels_less_one as i32 + 1 + by {
            0 => {
                self.words.swap_remove(at);
            }
            _ => self.words[at] = self.words[at].wrapping_add_signed(by),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_come_and_go() {
        for (views, per_view) in [(20, 1 << 16), (128, 1 << 22), (7, 1000), (1 << 17, 1 << 12)] {
            let mut reveals = Reveals::none(per_view);
            reveals.add(views - 1, per_view as i32);
            reveals.add(0, 1);
            reveals.add(3, 7);
            reveals.add(3, -2);
            let found: Vec<_> = reveals.iter().collect();
            assert_eq!(found, [(views - 1, per_view), (0, 1), (3, 5)]);
            reveals.add(views - 1, -(per_view as i32));
            reveals.add(3, -5);
            assert_eq!(reveals.iter().collect::<Vec<_>>(), [(0, 1)]);
        }
    }
}
