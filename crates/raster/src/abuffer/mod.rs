//! The A-buffer as it is edited: leaves go, leaves change their size.
//!
//! What an edit shows is told pixel by pixel, by the front leaf and the one behind it. Any
//! fragment may come to the front after enough edits, so lists stay complete; only the
//! fragments of a leaf that was removed are left where they are, and dropped when they reach
//! the front or room runs out.
//!
//! A trial of other sizes is taken back without drawing: [`Undo`] holds what was there.

mod events;
mod leaf_pixels;

use std::ops::Range;

pub use self::events::{Event, Events, FrontTwo};
use self::leaf_pixels::LeafPixels;
use crate::prefetch::{is_on_for_lists, prefetch};
use crate::{Fragment, ViewFragments};

/// How many pixels ahead spans, and lists, are asked for.
const SPANS_AHEAD: usize = 24;
const LISTS_AHEAD: usize = 8;

/// Largest number of fragments that are moved one by one to make room for another.
const LONG_LIST: usize = 16;

/// Room to grow at first: one fragment for every this many. It is reserved but not written, so it
/// takes no memory until it is used.
const ROOM_TO_GROW: usize = 2;

/// A pixel's list: `arena[start..start + len]`, nearest first, with room for
/// `room` fragments. Its first two are leaves that are still there.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: u32,
    len: u32,
    room: u32,
}

impl Span {
    #[inline]
    fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }
}

/// The fragments of some views, whose pixels follow each other, to be edited.
///
/// Takes 12 bytes a pixel and 12 to 20 a fragment. An edit takes time in proportion to the
/// fragments of the leaf, and tells `changed` of each pixel whose first two leaves are others
/// than before: the pixel, the two before and the two after. It tells of no pixel twice.
#[derive(Clone, Debug)]
pub struct ABuffer {
    spans: Vec<Span>,
    arena: Vec<Fragment>,
    is_there: Vec<bool>,
    leaf_pixels: LeafPixels,
}

/// Fragments that leaves had before a trial.
#[derive(Clone, Debug, Default)]
pub struct Undo {
    /// Leaves, and where their fragments end.
    leaves: Vec<(u32, usize)>,
    /// Pixel and depth of each of those fragments, leaf after leaf.
    fragments: Vec<(u32, u32)>,
}

impl ABuffer {
    /// From the fragments of views, of leaves numbered to `leaf_count`.
    ///
    /// # Panics
    /// If a fragment is of a leaf beyond.
    pub fn new(views: Vec<ViewFragments>, leaf_count: usize) -> Self {
        let leaf_pixels = LeafPixels::new(&views, leaf_count);
        let fragments: usize = views.iter().map(|view| view.as_slice().len()).sum();
        let pixels = views.iter().map(|view| view.pixels().len()).sum();
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
            spans,
            arena,
            is_there: vec![true; leaf_count + 1],
            leaf_pixels,
        }
    }

    /// The front leaf of each pixel in turn, and the one behind it.
    pub fn fronts(&self) -> impl Iterator<Item = FrontTwo> {
        (0..self.spans.len() as u32).map(|pixel| self.front_two(pixel))
    }

    /// The front leaf of a pixel, and the one behind it.
    #[inline]
    pub fn front_two(&self, pixel: u32) -> FrontTwo {
        first_two(self.list_of(self.spans[pixel as usize]))
    }

    /// How many leaves cover a pixel: 0, 1, or 2 where they are more.
    #[inline]
    pub fn cover(&self, pixel: u32) -> u32 {
        self.spans[pixel as usize].len.min(2)
    }

    /// The nearest fragment of a pixel that is not of this leaf: of leaf 0, behind
    /// everything, where there is none.
    #[inline]
    pub fn nearest_but(&self, pixel: u32, leaf: u32) -> Fragment {
        // The first two are leaves that are there.
        let first_two = self.list_of(self.spans[pixel as usize]).iter().take(2);
        let mut others = first_two.filter(|fragment| fragment.leaf() != leaf);
        *others.next().unwrap_or(&Fragment::new(u32::MAX, 0))
    }

    /// The pixels in which a leaf has a fragment, in order.
    #[inline]
    pub fn pixels_of(&self, leaf: u32) -> &[u32] {
        self.leaf_pixels.of(leaf)
    }

    /// Bytes of the lists and of what finds them by leaf.
    pub fn list_bytes(&self) -> u64 {
        (size_of_val(&self.arena[..]) + size_of_val(self.leaf_pixels.all())) as u64
    }

    /// Whether a leaf is among the first two of no pixel: without it, all pixels show what they did.
    pub fn is_hidden(&self, leaf: u32) -> bool {
        let mut pixels = self.leaf_pixels.of(leaf).iter();
        pixels.all(|pixel| !self.front_two(*pixel).contains(&leaf))
    }

    /// Takes a leaf away for good that is [hidden](Self::is_hidden).
    pub fn remove_hidden(&mut self, leaf: u32) {
        debug_assert!(self.is_hidden(leaf));
        self.is_there[leaf as usize] = false;
        self.leaf_pixels.clear(leaf);
    }

    /// Takes a leaf away for good.
    pub fn remove(&mut self, leaf: u32, mut changed: impl FnMut(u32, FrontTwo, FrontTwo)) {
        self.is_there[leaf as usize] = false;
        let range = self.leaf_pixels.range(leaf);
        for at in range.clone() {
            let pixels = &self.leaf_pixels.all()[at..range.end];
            let pixel = pixels[0];
            self.prefetch_lists(pixels.get(SPANS_AHEAD), pixels.get(LISTS_AHEAD));
            let before = first_two(self.list(pixel));
            if before.contains(&leaf) {
                self.settle(pixel, before, &mut changed);
            }
        }
        self.leaf_pixels.clear(leaf);
    }

    /// Gives a leaf new fragments instead of its own: pairs of pixel and depth, in the order of
    /// the pixels.
    ///
    /// # Panics
    /// If the leaf was removed.
    pub fn replace(
        &mut self,
        leaf: u32,
        fragments: &[(u32, u32)],
        mut changed: impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        assert!(self.is_there[leaf as usize], "leaf {leaf} was removed");
        let changed = &mut changed;
        let mut own = self.leaf_pixels.range(leaf);
        for (k, &(pixel, depth)) in fragments.iter().enumerate() {
            let ahead = [SPANS_AHEAD, LISTS_AHEAD].map(|ahead| fragments.get(k + ahead));
            let [soon, sooner] = ahead.map(|fragment| fragment.map(|(pixel, _)| pixel));
            self.prefetch_lists(soon, sooner);
            let mut is_own = false;
            while !is_own && !own.is_empty() && self.leaf_pixels.all()[own.start] <= pixel {
                let known = self.leaf_pixels.all()[own.start];
                own.start += 1;
                is_own = known == pixel;
                if !is_own {
                    self.take_out(known, leaf, changed);
                }
            }
            let fragment = Fragment::new(depth, leaf);
            match is_own {
                true => self.move_to(pixel, fragment, changed),
                false => self.insert(pixel, fragment, changed),
            }
        }
        for at in own {
            self.take_out(self.leaf_pixels.all()[at], leaf, changed);
        }
        let pixels = fragments.iter().map(|(pixel, _)| *pixel);
        self.leaf_pixels.replace(leaf, pixels);
    }

    /// As [`replace`](Self::replace), and `undo` holds what is needed to take it back.
    pub fn try_out(
        &mut self,
        leaf: u32,
        fragments: &[(u32, u32)],
        undo: &mut Undo,
        changed: impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        for &pixel in self.leaf_pixels.of(leaf) {
            let list = self.list_of(self.spans[pixel as usize]);
            undo.fragments
                .push((pixel, list[place_of(list, leaf)].depth()));
        }
        undo.leaves.push((leaf, undo.fragments.len()));
        self.replace(leaf, fragments, changed);
    }

    /// Takes back what was [tried out](Self::try_out) with `undo`, the last first, after which
    /// it is empty.
    pub fn undo(&mut self, undo: &mut Undo, mut changed: impl FnMut(u32, FrontTwo, FrontTwo)) {
        while let Some((leaf, end)) = undo.leaves.pop() {
            let start = undo.leaves.last().map_or(0, |(_, end)| *end);
            self.replace(leaf, &undo.fragments[start..end], &mut changed);
        }
        undo.clear();
    }

    /// Asks for a span that is needed soon, and for the list of a span that is
    /// needed sooner.
    #[inline(always)]
    fn prefetch_lists(&self, soon: Option<&u32>, sooner: Option<&u32>) {
        if !is_on_for_lists() {
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

    #[inline]
    fn list_of(&self, span: Span) -> &[Fragment] {
        &self.arena[span.range()]
    }

    #[inline]
    fn list(&mut self, pixel: u32) -> &mut [Fragment] {
        &mut self.arena[self.spans[pixel as usize].range()]
    }

    /// Makes the first two entries leaves that are there, and tells of a change.
    fn settle(
        &mut self,
        pixel: u32,
        before: FrontTwo,
        changed: &mut impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
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
            changed(pixel, before, after);
        }
    }

    fn take_out(
        &mut self,
        pixel: u32,
        leaf: u32,
        changed: &mut impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        let list = self.list(pixel);
        let before = first_two(list);
        let place = place_of(list, leaf);
        list.copy_within(place + 1.., place);
        self.spans[pixel as usize].len -= 1;
        if place < 2 {
            self.settle(pixel, before, changed);
        }
    }

    /// Moves the leaf's fragment to where its new depth belongs.
    #[inline]
    fn move_to(
        &mut self,
        pixel: u32,
        fragment: Fragment,
        changed: &mut impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        let list = self.list(pixel);
        let from = place_of(list, fragment.leaf());
        let before = first_two(list);
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
            self.settle(pixel, before, changed);
        }
    }

    #[inline]
    fn insert(
        &mut self,
        pixel: u32,
        fragment: Fragment,
        changed: &mut impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        let span = &self.spans[pixel as usize];
        if span.len == span.room {
            self.make_room(pixel);
        }
        let span = &mut self.spans[pixel as usize];
        let last = span.len as usize;
        span.len += 1;
        let list = &mut self.arena[span.range()];
        let before = first_two(&list[..last]);
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
        changed(pixel, before, after);
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
            if self.arena.len() + room as usize > self.arena.capacity() {
                self.compact();
            }
            let range = self.spans[pixel as usize].range();
            let start = u32::try_from(self.arena.len()).expect("fragments fit 32 bits");
            self.arena.extend_from_within(range);
            self.arena
                .resize(start as usize + room as usize, Fragment::new(0, 0));
            let span = &mut self.spans[pixel as usize];
            (span.start, span.room) = (start, room);
        }
    }

    /// Drops the places that lists have left for others, and fragments of leaves that are gone.
    fn compact(&mut self) {
        let live: usize = self.spans.iter().map(|span| span.len as usize).sum();
        // As much as makes up for a walk over all pixels, where few of them show anything.
        let room = live.max(self.spans.len()) / ROOM_TO_GROW;
        let mut arena = Vec::with_capacity(live + room);
        for span in &mut self.spans {
            let start = arena.len();
            let list = self.arena[span.range()].iter();
            arena.extend(list.filter(|fragment| self.is_there[fragment.leaf() as usize]));
            let len = (arena.len() - start) as u32;
            *span = Span {
                start: start as u32,
                len,
                room: len,
            };
        }
        self.arena = arena;
    }
}

impl Undo {
    /// What was tried out stays.
    pub fn clear(&mut self) {
        self.leaves.clear();
        self.fragments.clear();
    }
}

#[inline]
fn first_two(list: &[Fragment]) -> FrontTwo {
    [0, 1].map(|k| list.get(k).map_or(0, |f| f.leaf()))
}

#[inline]
fn place_of(list: &[Fragment], leaf: u32) -> usize {
    list.iter()
        .position(|f| f.leaf() == leaf)
        .expect("a leaf is in the lists of its pixels")
}

#[cfg(test)]
mod tests;
