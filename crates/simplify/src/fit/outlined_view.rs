//! What one view shows of outline and areas while leaves change their size.

use secateur_model::LeafId;
use secateur_raster::abuffer::{Events, FrontTwo};
use secateur_raster::{Fragment, LeafIdImage};

use super::sized_view::{Change, SizedView};

/// What a leaf of some size does in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    /// Pixels that only it covers: those within the outline less those outside.
    pub outline_px: i64,
    /// Pixels, seen or not, that it covers now or at this size and not both.
    pub changed_px: u32,
    /// Pixels that it owns.
    pub area_px: u32,
    /// What these would be worth to who owns them without it, scaled.
    pub worth_to_others: i64,
}

/// One view: the outline that it should have, and what covers its pixels.
pub(super) struct OutlinedView<'a> {
    sized: SizedView<'a>,
    /// Its number among those of its set.
    view: u32,
    /// Whether a pixel shows foliage in the original.
    outline: Vec<bool>,
    /// Pixels that show foliage where they should not, or none where they should.
    outline_error_px: u32,
    /// What changed at the front when sizes were last tried out.
    pub events: Events,
}

impl<'a> OutlinedView<'a> {
    pub(super) fn new(sized: SizedView<'a>, view: usize, original: &LeafIdImage) -> Self {
        let outline: Vec<bool> = original.leaf_ids.iter().map(|leaf| *leaf != 0).collect();
        let pixels = outline.iter().zip(sized.a_buffer.fronts());
        let wrong = pixels.filter(|(is_foliage, [front, _])| **is_foliage != (*front != 0));
        Self {
            view: view as u32,
            outline_error_px: wrong.count() as u32,
            outline,
            sized,
            events: Events::default(),
        }
    }

    /// The areas of the leaves in pixels, the background first.
    pub(super) fn areas_px(&self, leaf_count: usize) -> Vec<u32> {
        let mut areas_px = vec![0; leaf_count + 1];
        for [front, _] in self.sized.a_buffer.fronts() {
            areas_px[front as usize] += 1;
        }
        areas_px
    }

    /// Pixels that show foliage in the original.
    pub(super) fn outline_px(&self) -> u32 {
        let foliage = self.outline.iter().filter(|is_foliage| **is_foliage);
        foliage.count() as u32
    }

    /// Pixels that show foliage where they should not, or none where they should.
    pub(super) fn outline_error_px(&self) -> u32 {
        self.outline_error_px
    }

    /// What a leaf does here at the size that it has, and at two others; `value` is that of a
    /// pixel to a leaf.
    pub(super) fn seen(
        &mut self,
        leaf: LeafId,
        others: [f64; 2],
        value: impl Fn(u32) -> i64,
    ) -> [Seen; 3] {
        let number = leaf.get();
        let outline = &self.outline;
        let alone = |pixel: u32| if outline[pixel as usize] { 1 } else { -1 };
        let mut now = Seen::default();
        let a_buffer = &self.sized.a_buffer;
        for &pixel in a_buffer.pixels_of(number) {
            let [front, second] = a_buffer.front_two(pixel);
            if front == number {
                now.area_px += 1;
                now.worth_to_others += value(second);
                now.outline_px += if second == 0 { alone(pixel) } else { 0 };
            }
        }
        let [first, second] = others.map(|scale| {
            let (a_buffer, fragments) = self.sized.at_size(leaf, scale);
            let own = a_buffer.pixels_of(number);
            let mut then = Seen {
                changed_px: (own.len() + fragments.len()) as u32,
                ..Seen::default()
            };
            let mut own = own.iter().copied().peekable();
            for &(pixel, depth) in fragments {
                while own.next_if(|before| *before < pixel).is_some() {}
                then.changed_px -= 2 * u32::from(own.peek() == Some(&pixel));
                let other = a_buffer.nearest_but(pixel, number);
                if Fragment::new(depth, number) < other {
                    then.area_px += 1;
                    then.worth_to_others += value(other.leaf());
                    then.outline_px += if other.leaf() == 0 { alone(pixel) } else { 0 };
                }
            }
            then
        });
        [now, first, second]
    }

    /// Makes leaves larger or smaller.
    pub(super) fn try_out(&mut self, changes: &[Change]) {
        let Self {
            sized,
            view,
            outline,
            outline_error_px,
            events,
        } = self;
        events.clear();
        sized.try_out(changes, |pixel, before, after| {
            if before[0] != after[0] {
                *outline_error_px = corrected(*outline_error_px, outline, pixel, before, after);
                events.push(*view, [before[0], 0], [after[0], 0]);
            }
        });
    }

    /// Gives the leaves that were last tried out the sizes back that they had.
    pub(super) fn take_back(&mut self) {
        let Self {
            sized,
            outline,
            outline_error_px,
            ..
        } = self;
        sized.take_back(|pixel, before, after| {
            *outline_error_px = corrected(*outline_error_px, outline, pixel, before, after);
        });
    }
}

/// Pixels of wrong outline after one that showed this and shows that.
fn corrected(
    error_px: u32,
    outline: &[bool],
    pixel: u32,
    before: FrontTwo,
    after: FrontTwo,
) -> u32 {
    let is_wrong = |front: u32| u32::from((front != 0) != outline[pixel as usize]);
    error_px + is_wrong(after[0]) - is_wrong(before[0])
}
