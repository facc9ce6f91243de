//! Some of the views, as one core edits them: views do not share pixels, so cores need
//! not wait for each other.

use std::ops::Range;

use rayon::prelude::*;
use secateur_model::{Foliage, Growth};
use secateur_raster::abuffer::{ABuffer, Event, Events};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::occluders::Occlusion;
use secateur_raster::{Fragments, ViewSet};

/// Some views in a row, and what draws there.
pub(super) struct ViewSlice {
    views: Range<usize>,
    pixels_per_view: u32,
    a_buffer: ABuffer,
    leaf_fragments: LeafFragments,
    events: Events,
}

impl ViewSlice {
    /// All views, parted into slices; `occlusions` says what hides leaves in each view. The events lead
    /// from background alone to what is there.
    pub(super) fn all(
        fragments: Fragments,
        occlusions: Option<&[Occlusion]>,
        leaf_count: usize,
        slices: usize,
    ) -> Vec<Self> {
        let resolution = fragments.resolution();
        let pixels_per_view = fragments.pixels_per_view() as u32;
        let view_count = fragments.views().len();
        let mut rest = fragments.into_views().into_iter();
        let parts = (0..slices).map(|k| {
            let views = k * view_count / slices..(k + 1) * view_count / slices;
            let own: Vec<_> = rest.by_ref().take(views.len()).collect();
            (views, own)
        });
        let parts: Vec<_> = parts.collect();
        let slices = parts.into_par_iter().map(|(views, own)| {
            let a_buffer = ABuffer::new(own, leaf_count);
            let mut events = Events::default();
            for (pixel, front) in (0..).zip(a_buffer.fronts()) {
                if front[0] != 0 {
                    events.push(views.start as u32 + pixel / pixels_per_view, [0, 0], front);
                }
            }
            Self {
                leaf_fragments: LeafFragments::new(resolution)
                    .among(occlusions.map_or(&[], |all| &all[views.clone()])),
                views,
                pixels_per_view,
                a_buffer,
                events,
            }
        });
        slices.collect()
    }

    /// Takes a leaf away and draws those that have grown anew. Events are those
    /// of this step.
    pub(super) fn edit(
        &mut self,
        foliage: &Foliage,
        views: &ViewSet,
        pruned: u32,
        grown: &[Growth],
    ) {
        let Self {
            pixels_per_view,
            a_buffer,
            leaf_fragments,
            events,
            ..
        } = self;
        let first_view = self.views.start as u32;
        let view_of = |pixel: u32| first_view + pixel / *pixels_per_view;
        events.clear();
        events.begin_round();
        a_buffer.remove(pruned, |pixel, before, after| {
            events.push(view_of(pixel), before, after);
        });
        let views = &views.views()[self.views.clone()];
        for growth in grown {
            let drawn = leaf_fragments.of(foliage, growth.leaf, growth.area_scale, views);
            events.begin_round();
            a_buffer.replace(growth.leaf.get(), drawn, |pixel, before, after| {
                events.push(view_of(pixel), before, after);
            });
        }
    }

    /// Whether a leaf is among the first two of no pixel.
    pub(super) fn is_hidden(&self, leaf: u32) -> bool {
        self.a_buffer.is_hidden(leaf)
    }

    /// Takes a leaf away that is [hidden](Self::is_hidden).
    pub(super) fn remove_hidden(&mut self, leaf: u32) {
        self.a_buffer.remove_hidden(leaf);
    }

    /// What changed, by view over all slices.
    pub(super) fn events(&self) -> &[Event] {
        self.events.all()
    }

    /// Bytes of the lists of fragments.
    pub(super) fn list_bytes(&self) -> u64 {
        self.a_buffer.list_bytes()
    }

    /// Forgets the events, and their memory.
    pub(super) fn forget(&mut self) {
        self.events = Events::default();
    }
}
