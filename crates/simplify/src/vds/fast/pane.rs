//! Some of the views, as one core edits them: views do not share pixels, so cores need
//! not wait for each other.

use std::ops::Range;

use rayon::prelude::*;
use secateur_model::{Foliage, Growth};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::{Fragments, ViewSet};

use super::events::{Event, Events};
use super::pixels::PixelLists;

/// The pixel lists of some views in a row, and what draws there.
pub(super) struct Pane {
    views: Range<usize>,
    pixels: PixelLists,
    leaf_fragments: LeafFragments,
    events: Events,
}

impl Pane {
    /// All views over so many panes. Events lead from nothing but background to
    /// what is there.
    pub(super) fn all(fragments: Fragments, leaf_count: usize, panes: usize) -> Vec<Self> {
        let resolution = fragments.resolution();
        let pixels_per_view = fragments.pixels_per_view() as u32;
        let view_count = fragments.views().len();
        let mut rest = fragments.into_views().into_iter();
        let parts = (0..panes).map(|k| {
            let views = k * view_count / panes..(k + 1) * view_count / panes;
            let own: Vec<_> = rest.by_ref().take(views.len()).collect();
            (views, own)
        });
        let parts: Vec<_> = parts.collect();
        let panes = parts.into_par_iter().map(|(views, own)| {
            let pixels = PixelLists::new(own, pixels_per_view, leaf_count);
            let mut events = pixels.first_events();
            events.move_views(views.start as u32);
            Self {
                leaf_fragments: LeafFragments::new(resolution),
                views,
                pixels,
                events,
            }
        });
        panes.collect()
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
            pixels,
            leaf_fragments,
            events,
            ..
        } = self;
        events.clear();
        pixels.remove(pruned, events);
        let views = &views.views()[self.views.clone()];
        for growth in grown {
            let drawn = leaf_fragments.of(foliage, growth.leaf, growth.area_scale, views);
            pixels.replace(growth.leaf.get(), drawn, events);
        }
        events.move_views(self.views.start as u32);
    }

    /// What changed, by view over all panes.
    pub(super) fn events(&self) -> &[Event] {
        self.events.all()
    }

    /// Forgets the events, and their memory.
    pub(super) fn forget(&mut self) {
        self.events = Events::default();
    }
}
