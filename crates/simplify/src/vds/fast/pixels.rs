//! The A-buffer as it is edited: leaves go, leaves grow.
//!
//! The greedy loop needs, at every pixel, only the front leaf and the one
//! behind it; but after enough steps any fragment may come to the front, so the
//! lists stay complete. A removed leaf's fragments are left where they are and
//! dropped when they reach the front or room runs out.

use std::ops::Range;

use secateur_raster::{Fragment, ViewFragments};

use super::events::{Ends, Events};
use super::prefetch::prefetch;
use super::switches::{Mechanism, is_on};

/// How many pixels ahead spans, and lists, are asked for.
const SPANS_AHEAD: usize = 24;
const LISTS_AHEAD: usize = 8;

/// Up to so many fragments are moved one by one to make room for another.
const LONG_LIST: usize = 16;

/// The part of the fragments, one in so many, for which there is room to grow
/// at first. Where memory is given when it is first written to, it costs nothing.
const ROOM_TO_GROW: usize = 2;

/// A pixel's list: `arena[start..start + len]`, nearest first, with room for
/// `room` fragments. Its first two are leaves that are still there.
#[derive(Clone, Copy)]
struct Span {
    start: u32,
    len: u32,
    room: u32,
}

impl Span {
    fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }
}

/// The lists of some views.
pub(super) struct PixelLists {
    pixels_per_view: u32,
    spans: Vec<Span>,
    arena: Vec<Fragment>,
    is_there: Vec<bool>,
    leaf_pixels: LeafPixels,
}

impl PixelLists {
    /// With `leaf_count` leaves, all of which may have fragments.
    pub(super) fn new(views: Vec<ViewFragments>, pixels_per_view: u32, leaf_count: usize) -> Self {
        let fragments: usize = views.iter().map(|view| view.as_slice().len()).sum();
        let pixels = views.len() * pixels_per_view as usize;
        // Lists that grow out of their rooms move to the end.
        let mut arena = Vec::with_capacity(fragments + fragments / ROOM_TO_GROW);
        let mut spans = Vec::with_capacity(pixels);
        for view in views {
            let mut start = arena.len() as u32;
            for list in view.pixels() {
                let len = list.len() as u32;
                spans.push(Span {
                    start,
                    len,
                    room: len,
                });
                start += len;
            }
            arena.extend_from_slice(view.as_slice());
        }
        Self {
            pixels_per_view,
            leaf_pixels: LeafPixels::new(&spans, &arena, leaf_count),
            spans,
            arena,
            is_there: vec![true; leaf_count + 1],
        }
    }

    /// What leads from nothing but background to the first two leaves of every
    /// pixel.
    pub(super) fn first_events(&self) -> Events {
        let mut events = Events::default();
        for (pixel, span) in self.spans.iter().enumerate() {
            if span.len > 0 {
                let view = pixel as u32 / self.pixels_per_view;
                events.push(view, [0, 0], ends(&self.arena[span.range()]));
            }
        }
        events
    }

    /// Takes a leaf away, and notes where that changes the first two.
    pub(super) fn remove(&mut self, leaf: u32, events: &mut Events) {
        events.begin_round();
        self.is_there[leaf as usize] = false;
        let range = self.leaf_pixels.range(leaf);
        for at in range.clone() {
            let pixels = &self.leaf_pixels.pixels[at..range.end];
            let pixel = pixels[0];
            self.prefetch_lists(pixels.get(SPANS_AHEAD), pixels.get(LISTS_AHEAD));
            let before = ends(self.list(pixel));
            if before.contains(&leaf) {
                self.settle(pixel, before, events);
            }
        }
        self.leaf_pixels.clear(leaf);
    }

    /// Gives a leaf new fragments instead of its own: pairs of pixel (over these
    /// views) and depth, in the order of the pixels.
    pub(super) fn replace(&mut self, leaf: u32, fragments: &[(u32, u32)], events: &mut Events) {
        events.begin_round();
        let mut own = self.leaf_pixels.range(leaf);
        for (k, &(pixel, depth)) in fragments.iter().enumerate() {
            let ahead = [SPANS_AHEAD, LISTS_AHEAD].map(|ahead| fragments.get(k + ahead));
            let [soon, sooner] = ahead.map(|fragment| fragment.map(|(pixel, _)| pixel));
            self.prefetch_lists(soon, sooner);
            let mut is_own = false;
            while !is_own && !own.is_empty() && self.leaf_pixels.pixels[own.start] <= pixel {
                let known = self.leaf_pixels.pixels[own.start];
                own.start += 1;
                is_own = known == pixel;
                if !is_own {
                    self.take_out(known, leaf, events);
                }
            }
            let fragment = Fragment::new(depth, leaf);
            match is_own {
                true => self.move_to(pixel, fragment, events),
                false => self.insert(pixel, fragment, events),
            }
        }
        for at in own {
            self.take_out(self.leaf_pixels.pixels[at], leaf, events);
        }
        self.leaf_pixels.replace(leaf, fragments);
    }

    /// Asks for a span that is needed soon, and for the list of a span that is
    /// needed sooner.
    #[inline(always)]
    fn prefetch_lists(&self, soon: Option<&u32>, sooner: Option<&u32>) {
        if !is_on(Mechanism::PrefetchPixels) {
            return;
        }
        if let Some(pixel) = soon {
            prefetch(&self.spans, *pixel as usize);
        }
        if let Some(pixel) = sooner {
            let span = self.spans[*pixel as usize];
            prefetch(&self.arena, span.start as usize);
            prefetch(&self.arena, span.start as usize + 8);
        }
    }

    fn list(&mut self, pixel: u32) -> &mut [Fragment] {
        &mut self.arena[self.spans[pixel as usize].range()]
    }

    /// Makes the first two entries leaves that are there, and notes a change.
    fn settle(&mut self, pixel: u32, before: Ends, events: &mut Events) {
        let span = &mut self.spans[pixel as usize];
        let list = &mut self.arena[span.range()];
        let there = |f: &Fragment| self.is_there[f.leaf() as usize];
        let front = list.iter().position(there).unwrap_or(list.len());
        let gap = list
            .iter()
            .skip(front + 1)
            .position(there)
            .unwrap_or(list.len().saturating_sub(front + 1));
        let mut after = [0, 0];
        let mut drop = front;
        if front < list.len() {
            list[front + gap] = list[front];
            drop += gap;
            after[0] = list[drop].leaf();
            after[1] = list.get(drop + 1).map_or(0, |f| f.leaf());
        }
        span.start += drop as u32;
        span.len -= drop as u32;
        span.room -= drop as u32;
        if before != after {
            events.push(pixel / self.pixels_per_view, before, after);
        }
    }

    fn take_out(&mut self, pixel: u32, leaf: u32, events: &mut Events) {
        let list = self.list(pixel);
        let before = ends(list);
        let place = place_of(list, leaf);
        list.copy_within(place + 1.., place);
        self.spans[pixel as usize].len -= 1;
        if place < 2 {
            self.settle(pixel, before, events);
        }
    }

    /// Moves the leaf's fragment to where its new depth belongs.
    #[inline]
    fn move_to(&mut self, pixel: u32, fragment: Fragment, events: &mut Events) {
        let list = self.list(pixel);
        let from = place_of(list, fragment.leaf());
        let before = ends(list);
        let mut to = from;
        while to > 0 && list[to - 1] > fragment {
            list[to] = list[to - 1];
            to -= 1;
        }
        while to + 1 < list.len() && list[to + 1] < fragment {
            list[to] = list[to + 1];
            to += 1;
        }
        list[to] = fragment;
        if to != from && to.min(from) < 2 {
            self.settle(pixel, before, events);
        }
    }

    #[inline]
    fn insert(&mut self, pixel: u32, fragment: Fragment, events: &mut Events) {
        let span = &self.spans[pixel as usize];
        if span.len == span.room {
            self.make_room(pixel);
        }
        let span = &mut self.spans[pixel as usize];
        let last = span.len as usize;
        span.len += 1;
        let list = &mut self.arena[span.range()];
        let before = ends(&list[..last]);
        let mut place = last;
        if last > LONG_LIST {
            place = list[..last].partition_point(|f| *f < fragment);
            list.copy_within(place..last, place + 1);
        } else {
            while place > 0 && list[place - 1] > fragment {
                list[place] = list[place - 1];
                place -= 1;
            }
        }
        list[place] = fragment;
        let after = match place {
            0 => [fragment.leaf(), before[0]],
            1 => [before[0], fragment.leaf()],
            _ => return,
        };
        events.push(pixel / self.pixels_per_view, before, after);
    }

    #[cold]
    fn make_room(&mut self, pixel: u32) {
        let span = &mut self.spans[pixel as usize];
        let range = span.range();
        let mut kept = range.start;
        for at in range.clone() {
            let fragment = self.arena[at];
            if self.is_there[fragment.leaf() as usize] {
                self.arena[kept] = fragment;
                kept += 1;
            }
        }
        span.len = (kept - range.start) as u32;
        if span.len == span.room {
            let room = span.len + span.len / 2 + 2;
            let start = u32::try_from(self.arena.len()).expect("fragments fit 32 bits");
            self.arena.extend_from_within(range);
            self.arena
                .resize(start as usize + room as usize, Fragment::new(0, 0));
            (span.start, span.room) = (start, room);
        }
    }
}

fn ends(list: &[Fragment]) -> Ends {
    [0, 1].map(|k| list.get(k).map_or(0, |f| f.leaf()))
}

fn place_of(list: &[Fragment], leaf: u32) -> usize {
    list.iter()
        .position(|f| f.leaf() == leaf)
        .expect("a leaf is in the lists of its pixels")
}

/// The pixels (over these views) in which each leaf has a fragment.
struct LeafPixels {
    /// Start and length, by leaf number.
    ranges: Vec<(u32, u32)>,
    pixels: Vec<u32>,
    live: usize,
}

impl LeafPixels {
    fn new(spans: &[Span], arena: &[Fragment], leaf_count: usize) -> Self {
        let mut ranges = vec![(0u32, 0u32); leaf_count + 1];
        for fragment in arena {
            ranges[fragment.leaf() as usize].1 += 1;
        }
        let mut before = 0;
        for range in &mut ranges {
            range.0 = before;
            before += std::mem::take(&mut range.1);
        }
        let mut pixels = vec![0; arena.len()];
        for (pixel, span) in spans.iter().enumerate() {
            for fragment in &arena[span.start as usize..][..span.len as usize] {
                let (start, filled) = &mut ranges[fragment.leaf() as usize];
                pixels[(*start + *filled) as usize] = pixel as u32;
                *filled += 1;
            }
        }
        Self {
            ranges,
            live: pixels.len(),
            pixels,
        }
    }

    fn range(&self, leaf: u32) -> Range<usize> {
        let (start, len) = self.ranges[leaf as usize];
        start as usize..(start + len) as usize
    }

    fn clear(&mut self, leaf: u32) {
        self.live -= self.ranges[leaf as usize].1 as usize;
        self.ranges[leaf as usize].1 = 0;
    }

    fn replace(&mut self, leaf: u32, fragments: &[(u32, u32)]) {
        self.clear(leaf);
        if self.pixels.len() > 2 * self.live + 65_536 {
            self.compact();
        }
        let start = u32::try_from(self.pixels.len()).expect("fragments fit 32 bits");
        self.ranges[leaf as usize] = (start, fragments.len() as u32);
        self.pixels.extend(fragments.iter().map(|(pixel, _)| pixel));
        self.live += fragments.len();
    }

    fn compact(&mut self) {
        let mut kept = Vec::with_capacity(self.live);
        for (start, len) in &mut self.ranges {
            let range = *start as usize..(*start + *len) as usize;
            *start = kept.len() as u32;
            kept.extend_from_slice(&self.pixels[range]);
        }
        self.pixels = kept;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use proptest::prelude::*;

    use super::*;

    const PIXELS: usize = 4;

    /// Depths of a leaf at the pixels where it is.
    type Depths = [Option<u32>; PIXELS];

    fn any_depths() -> impl Strategy<Value = Depths> {
        prop::array::uniform4(prop::option::weighted(0.8, 0u32..100))
    }

    fn ends_of(lists: &[BTreeSet<Fragment>]) -> Vec<Ends> {
        let ends = |list: &BTreeSet<Fragment>| {
            let mut leaves = list.iter().map(|f| f.leaf());
            [0, 1].map(|_| leaves.next().unwrap_or(0))
        };
        lists.iter().map(ends).collect()
    }

    proptest! {
        /// Lists of up to 60 leaves, long and short, as leaves go and change.
        #[test]
        fn events_are_what_sorted_lists_say(
            leaves in prop::collection::vec(any_depths(), 1..60),
            steps in prop::collection::vec(
                (any::<prop::sample::Index>(), prop::option::weighted(0.7, any_depths())),
                1..60,
            ),
        ) {
            let mut lists = vec![BTreeSet::new(); PIXELS];
            let put = |lists: &mut Vec<BTreeSet<Fragment>>, leaf: u32, depths: &Depths| {
                for (list, depth) in lists.iter_mut().zip(depths) {
                    list.retain(|f: &Fragment| f.leaf() != leaf);
                    list.extend(depth.map(|depth| Fragment::new(depth, leaf)));
                }
            };
            for (leaf, depths) in (1..).zip(&leaves) {
                put(&mut lists, leaf, depths);
            }
            let mut starts = vec![0];
            for list in &lists {
                starts.push(starts[starts.len() - 1] + list.len() as u32);
            }
            let fragments = lists.iter().flatten().copied().collect();
            let view = ViewFragments::from_lists(starts, fragments);
            let mut pixels = PixelLists::new(vec![view], PIXELS as u32, leaves.len());
            let mut left: Vec<u32> = (1..=leaves.len() as u32).collect();
            let mut events = Events::default();
            for (index, depths) in steps {
                if left.is_empty() {
                    break;
                }
                let before = ends_of(&lists);
                let at = index.index(left.len());
                events.clear();
                match depths {
                    None => {
                        let leaf = left.swap_remove(at);
                        put(&mut lists, leaf, &[None; PIXELS]);
                        pixels.remove(leaf, &mut events);
                    }
                    Some(depths) => {
                        put(&mut lists, left[at], &depths);
                        let drawn = (0..).zip(depths);
                        let drawn: Vec<_> = drawn.filter_map(|(p, d)| Some((p, d?))).collect();
                        pixels.replace(left[at], &drawn, &mut events);
                    }
                }
                let mut expected = BTreeMap::new();
                for change in before.into_iter().zip(ends_of(&lists)) {
                    if change.0 != change.1 {
                        *expected.entry(change).or_insert(0) += 1;
                    }
                }
                let mut found = BTreeMap::new();
                for event in events.all() {
                    *found.entry((event.before, event.after)).or_insert(0) += event.pixels;
                }
                prop_assert_eq!(found, expected);
            }
        }
    }
}
