//! Leaves alike: those that would hand a few pixels of one view to the background, and change nothing else.
//!
//! They are many at the silhouettes of crowns whose leaves are about a pixel large, and those of as many pixels of one
//! view cost just the same. So one cost does for all of them, and the lowest in rank is the cheapest. They stand
//! outside the blocks.

use std::collections::BTreeSet;

use super::super::deltas::Sight;
use super::super::switches::{Mechanism, is_on};
use super::{Candidates, FIRST_GROUP, Found, WAITING};

/// The most pixels that they hand over.
const MOST_PX: usize = 4;

/// Groups of leaves alike, by pixels, then view; each by rank, then leaf number.
pub(super) struct Alike {
    view_count: usize,
    groups: Vec<BTreeSet<(u32, u32)>>,
    /// Leaves of all groups.
    len: usize,
}

impl Alike {
    pub(super) fn none(view_count: usize) -> Self {
        Self {
            view_count,
            groups: vec![BTreeSet::new(); MOST_PX * view_count],
            len: 0,
        }
    }

    /// The place of the leaves that would hand over so many pixels of a view, if they have a group.
    fn place(&self, view: u32, pixels: u32) -> Option<u32> {
        let group = (pixels as usize - 1) * self.view_count + view as usize;
        let place = FIRST_GROUP as usize + group;
        (pixels as usize <= MOST_PX && place < WAITING as usize).then_some(place as u32)
    }

    /// Takes a leaf into the group of a place.
    pub(super) fn insert(&mut self, place: u32, ranked: (u32, u32)) {
        self.len += usize::from(self.groups[(place - FIRST_GROUP) as usize].insert(ranked));
    }

    /// Takes a leaf out of the group of its place.
    pub(super) fn remove(&mut self, place: u32, ranked: (u32, u32)) {
        self.len -= usize::from(self.groups[(place - FIRST_GROUP) as usize].remove(&ranked));
    }
}

impl Candidates {
    /// The place of the leaves that are like this one, if it is of such a kind.
    pub(super) fn place_of_alike(&self, sight: Sight<'_>, leaf: u32) -> Option<u32> {
        if !is_on(Mechanism::AlikeTogether) {
            return None;
        }
        let (view, pixels) = sight.only_reveal(leaf)?;
        self.alike.place(view, pixels)
    }

    /// The cheapest leaf of each group, with its cost.
    pub(super) fn first_alike(&self, sight: Sight<'_>) -> impl Iterator<Item = Found> {
        let counts = sight.counts;
        let background = counts.target(0);
        let by_pixels = self.alike.groups.chunks(self.view_count).zip(1u32..);
        let by_pixels = by_pixels.filter(move |(groups, _)| {
            self.alike.len > 0 && groups.iter().any(|group| !group.is_empty())
        });
        by_pixels.flat_map(move |(groups, pixels)| {
            let lg_after = counts.table.lg(background.total + pixels);
            let rise = background.rise(lg_after);
            let with_rise = move |view: usize| {
                self.deviations[view] - (u64::from(background.areas[view]) * rise) as i64
            };
            let elsewhere: i64 = (0..groups.len()).map(|view| with_rise(view).abs()).sum();
            let firsts = groups.iter().enumerate();
            firsts.filter_map(move |(view, group)| {
                let &(rank, leaf) = group.first()?;
                let gain = counts.background_gain(view as u32, pixels);
                let there = with_rise(view) + gain - i64::from(pixels) * lg_after;
                let cost = elsewhere - with_rise(view).abs() + there.abs();
                Some(Found { cost, rank, leaf })
            })
        })
    }
}
