//! What a piece loses with fewer triangles, by pixels and by distance.

use glam::DVec3;
use secateur_model::{Foliage, LeafId, LeafTriangle};
use secateur_raster::ViewSet;
use secateur_raster::cpu::LeafFragments;

use super::distance::{Shape, mean_distance};
use super::parts::of_corners;
use super::thickness::thickness;

/// A level that is further off than this, in pixels of a view, shows nothing where the piece was. Of 1, 2, 3
/// and 5, and of shares of the piece's thickness, 2 had the least FLIP or nearly at a half, a quarter and a
/// tenth of all triangles on an oak, a birch, a willow, `quat_commontree_1` and `ez_bush2`: thick pieces
/// need more triangles for their thickness than thin ones do, of which only the outline shows.
const FAR_PX: f64 = 2.0;

/// What is drawn to judge levels by.
#[derive(Clone, Copy)]
pub(super) struct Judges<'a> {
    pub(super) views: &'a ViewSet,
    /// Pixels along a side of a view.
    pub(super) resolution: u32,
}

/// What a level loses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loss {
    /// The share of the piece's pixels that it shows no longer, or elsewhere.
    pub(super) loss: f64,
    /// How far corners of the piece are from it on the mean, in world units.
    pub(super) off: f64,
    /// How far the further one of the piece's two ends is from it, in world units.
    pub(super) ends_off: f64,
    /// How many pixels show it for each that showed the piece, in the view where these are fewest.
    pub(super) least_shown: f64,
}

/// A piece as it was, to judge levels of it by.
pub(super) struct Original<'a> {
    wood: &'a Foliage,
    piece: LeafId,
    views: &'a ViewSet,
    resolution: u32,
    fragments: &'a mut LeafFragments,
    /// The pixels that show it where nothing hides it, over the views, rising.
    pixels: Vec<u32>,
    ends: [DVec3; 2],
}

impl<'a> Original<'a> {
    /// `fragments` is what draws; what it has drawn does not matter.
    pub(super) fn new(
        wood: &'a Foliage,
        piece: LeafId,
        judges: Judges<'a>,
        fragments: &'a mut LeafFragments,
    ) -> Self {
        let mut original = Self {
            wood,
            piece,
            views: judges.views,
            resolution: judges.resolution,
            fragments,
            pixels: Vec::new(),
            ends: ends(wood.triangles_of(piece)),
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

    /// What it loses is the mean of two losses: the share of its pixels that it shows no longer, or shows beside them if
    /// that is more; and how far its corners are from what is left on the mean, in pixels, over [`FAR_PX`], at
    /// most 1. Pixels alone take a tube for a strip where both have one outline.
    pub(super) fn loss(&mut self, left: &[[u32; 3]]) -> Loss {
        let all = self.wood.triangles_of(self.piece);
        let shape = Shape::of_level(all, left);
        let off = mean_distance(all, &shape);
        let ends_off = self.ends.map(|end| shape.distance(end));
        let ends_off = ends_off[0].max(ends_off[1]);
        if self.pixels.is_empty() {
            // The piece may still bear leaves and twigs: the nearer, the better.
            let thickness = thickness(self.wood, self.piece);
            return Loss {
                loss: match off > 0.0 {
                    true => off / (off + thickness),
                    false => 0.0,
                },
                off,
                ends_off,
                least_shown: 1.0,
            };
        }
        let now = self.pixels_of(&of_corners(all, left));
        let both = in_both(&self.pixels, &now);
        let lost = self.pixels.len().max(now.len()) - both;
        let off_px = off * self.px_per_unit();
        let lost = lost as f64 / self.pixels.len() as f64;
        Loss {
            loss: 0.5 * lost + 0.5 * (off_px / FAR_PX).min(1.0),
            off,
            ends_off,
            least_shown: self.least_shown(&now),
        }
    }

    /// The pixels of `now` in a view, over those that showed the piece there: the least of all views that showed it.
    fn least_shown(&self, now: &[u32]) -> f64 {
        let view_px = u64::from(self.resolution).pow(2);
        let in_view = |pixels: &[u32], view: u64| {
            let before =
                |view: u64| pixels.partition_point(|pixel| u64::from(*pixel) < view * view_px);
            before(view + 1) - before(view)
        };
        let views = 0..self.views.views().len() as u64;
        let shown = views.filter_map(|view| {
            let before = in_view(&self.pixels, view);
            (before > 0).then(|| in_view(now, view) as f64 / before as f64)
        });
        shown.fold(f64::INFINITY, f64::min)
    }

    /// Pixels that a world unit has in a view. Of what turns outward everywhere, views from all around show a
    /// quarter of the area on the mean.
    fn px_per_unit(&self) -> f64 {
        let area_px = self.pixels.len() as f64 / self.views.views().len() as f64;
        (4.0 * area_px / self.wood.leaf(self.piece).area()).sqrt()
    }
}

/// The corner that is furthest from the first one, and the one that is furthest from that.
fn ends(triangles: &[LeafTriangle]) -> [DVec3; 2] {
    let furthest = |from: DVec3| {
        let corners = triangles.iter().flat_map(|t| t.corners);
        let by_distance = |a: &DVec3, b: &DVec3| {
            a.distance_squared(from)
                .total_cmp(&b.distance_squared(from))
        };
        corners.max_by(by_distance).unwrap_or(from)
    };
    let one = furthest(triangles[0].corners[0]);
    [one, furthest(one)]
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::rings::tubes;
    use super::super::tests::tube;
    use super::*;

    /// Three sides in the place of eight: few pixels of a view show next to nothing of it, many do.
    #[test]
    fn a_level_loses_more_where_more_pixels_show_it() {
        let mut wood = Foliage::default();
        let triangles = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 8);
        wood.push_leaf(&triangles, None).unwrap();
        let views = ViewSet::octahedron(wood.bounding_sphere().unwrap());
        let level = tubes(&triangles, true)
            .into_iter()
            .find(|level| level.len() == 6)
            .unwrap();
        let loss = |resolution: u32| {
            let mut fragments = LeafFragments::new(resolution);
            let judges = Judges {
                views: &views,
                resolution,
            };
            let mut original = Original::new(&wood, LeafId::from_index(0), judges, &mut fragments);
            original.loss(&level).loss
        };
        let [few, many] = [32, 256].map(loss);
        // Half of the loss at most is that of the outline, which is alike.
        assert!(many > few + 0.15, "{few}, then {many}");
        // What is as it was loses nothing.
        let all: Vec<[u32; 3]> = (0..triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let mut fragments = LeafFragments::new(64);
        let judges = Judges {
            views: &views,
            resolution: 64,
        };
        let mut original = Original::new(&wood, LeafId::from_index(0), judges, &mut fragments);
        assert!(original.loss(&all).loss < 1e-12);
    }
}
