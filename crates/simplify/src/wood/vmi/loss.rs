//! What a piece loses with fewer triangles, by pixels and by distance.

use secateur_model::{Foliage, LeafId, LeafTriangle};
use secateur_raster::ViewSet;
use secateur_raster::cpu::LeafFragments;

use super::super::distance::mean_distance;
use super::super::thickness::thickness;

/// A piece as it was, to judge levels of it by.
pub(super) struct Original<'a> {
    wood: &'a Foliage,
    piece: LeafId,
    views: &'a ViewSet,
    fragments: LeafFragments,
    /// The pixels that show it where nothing hides it, over the views, rising.
    pixels: Vec<u32>,
    thickness: f64,
}

impl<'a> Original<'a> {
    pub(super) fn new(
        wood: &'a Foliage,
        piece: LeafId,
        views: &'a ViewSet,
        resolution: u32,
    ) -> Self {
        let mut original = Self {
            wood,
            piece,
            views,
            fragments: LeafFragments::new(resolution),
            pixels: Vec::new(),
            thickness: thickness(wood, piece),
        };
        original.pixels = original.pixels_of(wood.triangles_of(piece));
        original
    }

    fn pixels_of(&mut self, triangles: &[LeafTriangle]) -> Vec<u32> {
        let like = self.wood.leaf(self.piece);
        let cutouts = self.wood.cutouts();
        let drawn = self
            .fragments
            .of_triangles(triangles, like, cutouts, self.views.views());
        drawn.iter().map(|(pixel, _)| *pixel).collect()
    }

    /// The mean of two losses: the share of its pixels that it shows no longer, or shows beside them if
    /// that is more; and how far its corners are from what is left on the mean, over its thickness,
    /// at most 1. Pixels alone take a tube for a strip where both have one outline. Either alone, and
    /// both, were tried at a quarter and a tenth of all triangles: both had the least FLIP, or nearly,
    /// on an oak, a birch, `quat_commontree_1` and `ez_bush2`.
    pub(super) fn loss(&mut self, left: &[[u32; 3]]) -> f64 {
        let all = self.wood.triangles_of(self.piece);
        let off = match self.thickness > 0.0 {
            true => (mean_distance(all, left) / self.thickness).min(1.0),
            false => 1.0,
        };
        if self.pixels.is_empty() {
            return off;
        }
        let now = self.pixels_of(&of_corners(all, left));
        let both = in_both(&self.pixels, &now);
        let lost = self.pixels.len().max(now.len()) - both;
        0.5 * (lost as f64 / self.pixels.len() as f64) + 0.5 * off
    }
}

/// How many numbers two rising lists share.
fn in_both(a: &[u32], b: &[u32]) -> usize {
    let mut b = b.iter().peekable();
    let is_in_b = |x: &&u32| {
        while b.next_if(|y| y < x).is_some() {}
        b.peek() == Some(x)
    };
    a.iter().filter(is_in_b).count()
}

/// Triangles of corners of a piece.
fn of_corners(all: &[LeafTriangle], left: &[[u32; 3]]) -> Vec<LeafTriangle> {
    let of = |corner: u32| (&all[corner as usize / 3], corner as usize % 3);
    let triangle = |t: &[u32; 3]| LeafTriangle {
        corners: t.map(of).map(|(t, k)| t.corners[k]),
        uvs: t.map(of).map(|(t, k)| t.uvs[k]),
    };
    left.iter().map(triangle).collect()
}
