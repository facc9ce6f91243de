//! The wood by its parts: pieces, and where a connected piece has forks what is between these.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, Place};

use super::charts::Charts;
use super::forks;

/// The parts of a plant's wood.
///
/// A piece without forks is one part. Parts of one piece are closed where others grow on them, so they
/// have more triangles together than the piece.
#[derive(Clone, Debug)]
pub struct Parts {
    foliage: Foliage,
    origins: Vec<Origin>,
    pieces: Vec<Piece>,
}

/// A piece of the wood.
#[derive(Clone, Debug)]
struct Piece {
    /// How many it has as it is.
    triangles: usize,
    parts: Range<usize>,
    /// Where its bark is cut into charts.
    charts: Option<Charts>,
}

/// Where a part comes from.
#[derive(Clone, Debug)]
struct Origin {
    piece: LeafId,
    /// The part of the same piece that it grows on.
    on: Option<usize>,
    /// By corner of the part, the corner of the piece; nothing where it is the whole piece.
    corners: Option<Vec<u32>>,
}

impl Parts {
    /// Finds the forks of all pieces.
    ///
    /// # Panics
    /// If the wood has nearly as many triangles as a foliage can hold, and forks.
    pub fn of(wood: &Foliage) -> Self {
        let pieces = (0..wood.leaves().len()).into_par_iter();
        let of_piece = |piece: usize| {
            let triangles = wood.triangles_of(LeafId::from_index(piece));
            let is_cut_out = wood.leaf(LeafId::from_index(piece)).cutout().is_some();
            let charts = (!is_cut_out).then(|| Charts::of(triangles)).flatten();
            (forks::parts(triangles), charts)
        };
        let split: Vec<(Option<Vec<forks::Part>>, Option<Charts>)> = pieces.map(of_piece).collect();
        let mut parts = Self {
            foliage: Foliage::new(wood.cutouts().to_vec()),
            origins: Vec::new(),
            pieces: Vec::new(),
        };
        for (index, (split, charts)) in split.into_iter().enumerate() {
            let piece = LeafId::from_index(index);
            let all = wood.triangles_of(piece);
            let first = parts.origins.len();
            let count = split.as_ref().map_or(1, Vec::len);
            parts.pieces.push(Piece {
                triangles: all.len(),
                parts: first..first + count,
                charts,
            });
            let Some(split) = split else {
                parts.push(all, wood, piece, (None, None));
                continue;
            };
            for forks::Part { on, triangles } in split {
                let on = on.map(|on| first + on);
                let corners = triangles.as_flattened().to_vec();
                parts.push(
                    &of_corners(all, &triangles),
                    wood,
                    piece,
                    (on, Some(corners)),
                );
            }
        }
        parts
    }

    fn push(
        &mut self,
        triangles: &[LeafTriangle],
        wood: &Foliage,
        piece: LeafId,
        (on, corners): (Option<usize>, Option<Vec<u32>>),
    ) {
        let mut triangles = Cow::Borrowed(triangles);
        if self.pieces[piece.index()].charts.is_some() {
            for triangle in triangles.to_mut() {
                triangle.uvs = [DVec2::ZERO; 3];
            }
        }
        let pushed = self.foliage.push_leaf_like(&triangles, wood.leaf(piece));
        pushed.expect("triangles of the wood");
        self.origins.push(Origin { piece, on, corners });
    }

    /// The parts, each a leaf: those of a piece follow each other, the first one first. Where bark is cut
    /// into charts all texture coordinates are zero, so that nothing collapses or stays for them.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// Whether every piece is one part.
    pub fn are_pieces(&self) -> bool {
        self.origins.len() == self.piece_count()
    }

    /// The number of pieces.
    pub(super) fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Triangles of a piece as it is.
    pub(super) fn triangles_of_piece(&self, piece: LeafId) -> usize {
        self.pieces[piece.index()].triangles
    }

    /// The parts of a piece.
    pub(super) fn of_piece(&self, piece: LeafId) -> Range<usize> {
        self.pieces[piece.index()].parts.clone()
    }

    /// The piece that a part is of.
    pub(super) fn piece_of(&self, part: usize) -> LeafId {
        self.origins[part].piece
    }

    /// Whether a piece's bark is cut into charts.
    pub(super) fn has_charts(&self, piece: LeafId) -> bool {
        self.pieces[piece.index()].charts.is_some()
    }

    /// The corners of a piece that a new triangle of these has its texture from: of one chart where bark is cut into
    /// charts.
    pub(super) fn texture_of(&self, piece: LeafId, corners: [u32; 3]) -> [u32; 3] {
        match &self.pieces[piece.index()].charts {
            Some(charts) => charts.texture_of(corners),
            None => corners,
        }
    }

    /// The part of the same piece that a part grows on.
    pub(super) fn on(&self, part: usize) -> Option<usize> {
        self.origins[part].on
    }

    /// Triangles of the corners of a part, as corners of its piece. Of bark that is cut into charts each has
    /// its texture from one chart.
    pub(super) fn made(&self, part: usize, triangles: &[[u32; 3]]) -> Vec<[NewCorner; 3]> {
        let origin = &self.origins[part];
        let leaf = origin.piece;
        let of_piece = |corner: u32| match &origin.corners {
            Some(corners) => corners[corner as usize],
            None => corner,
        };
        let made = |triangle: &[u32; 3]| {
            let corners = triangle.map(of_piece);
            let like = self.texture_of(leaf, corners);
            [0, 1, 2].map(|k| NewCorner {
                place: Place::Of(CornerRef {
                    leaf,
                    corner: corners[k],
                }),
                like: like[k],
            })
        };
        triangles.iter().map(made).collect()
    }

    /// All triangles of a part, as [`Self::made`].
    pub(super) fn whole(&self, part: usize) -> Vec<[NewCorner; 3]> {
        let count = self.foliage.triangles_of(LeafId::from_index(part)).len() as u32;
        let all: Vec<[u32; 3]> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        self.made(part, &all)
    }
}

/// Triangles of corners of a piece.
pub(super) fn of_corners(all: &[LeafTriangle], left: &[[u32; 3]]) -> Vec<LeafTriangle> {
    let of = |corner: u32| (&all[corner as usize / 3], corner as usize % 3);
    let triangle = |t: &[u32; 3]| LeafTriangle {
        corners: t.map(of).map(|(t, k)| t.corners[k]),
        uvs: t.map(of).map(|(t, k)| t.uvs[k]),
    };
    left.iter().map(triangle).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use rustc_hash::FxHashSet;
    use secateur_model::Lod;

    use super::super::forks::tests::forked;
    use super::super::tests::{by_geometry, tube};
    use super::*;

    /// A trunk and a bough of one connected mesh, and a twig on the bough's end that is a piece of its own.
    fn wood() -> Foliage {
        let mut wood = Foliage::default();
        let triangles = forked();
        let reach = |corner: &DVec3| corner.x.hypot(corner.z);
        let corners = triangles.iter().flat_map(|t| t.corners);
        let tip = corners
            .max_by(|a, b| reach(a).total_cmp(&reach(b)))
            .unwrap();
        let twig = tube(tip, tip + DVec3::new(0.2, 1.0, 0.1), 0.02, 4);
        wood.push_leaf(&triangles, None).unwrap();
        wood.push_leaf(&twig, None).unwrap();
        wood
    }

    /// What is left of the trunk, of the bough and of the twig.
    fn is_left(lod: &Lod, wood: &Foliage) -> [bool; 3] {
        let whole: FxHashSet<LeafId> = lod.leaves().map(|(leaf, _)| leaf).collect();
        let [connected, twig] = [0, 1].map(LeafId::from_index);
        let mut is_left = [whole.contains(&connected); 3];
        is_left[2] = whole.contains(&twig);
        for (made, _) in lod.made() {
            for corner in made.triangles.iter().flatten() {
                if let Place::Of(at) = corner.place {
                    assert_eq!((at.leaf, at.corner), (made.donor, corner.like));
                }
                let triangle = &wood.triangles_of(made.donor)[corner.like as usize / 3];
                let place = triangle.corners[corner.like as usize % 3];
                match made.donor == twig {
                    true => is_left[2] = true,
                    false if place.x.hypot(place.z) > 2.0 => is_left[1] = true,
                    false => is_left[0] |= place.y == 0.0,
                }
            }
        }
        is_left
    }

    #[test]
    fn a_bough_goes_and_the_trunk_that_it_is_connected_to_stays() {
        let foliage = wood();
        assert!(!Parts::of(&foliage).are_pieces());
        let wood = by_geometry(&foliage, &[1000.0, 30.0, 20.0]);
        let all = foliage.triangles().len();
        let mut seen = FxHashSet::default();
        for budget in 0..=all {
            let (lod, _) = wood.within(budget);
            let left = lod.foliage(&foliage).triangles().len();
            assert!(left <= budget, "{left} of {budget}");
            let [trunk, bough, twig] = is_left(&lod, &foliage);
            assert!(trunk || !bough, "a bough without its trunk at {budget}");
            assert!(bough || !twig, "a twig without its bough at {budget}");
            seen.insert([trunk, bough, twig]);
        }
        assert!(seen.contains(&[true, false, false]), "{seen:?}");
        assert!(seen.contains(&[true, true, false]), "{seen:?}");
        assert_eq!(wood.within(all).0, Lod::original(2));
    }

    /// A twig on a bough with more area than the trunk which bears the bough.
    #[test]
    fn a_large_bough_still_grows_on_its_trunk() {
        let foliage = wood();
        let parts = Parts::of(&foliage);
        let found = super::super::support::growing_of_parts(&parts);
        let on: Vec<Option<usize>> = found.iter().map(|found| Some(found.as_ref()?.on)).collect();
        assert_eq!(on, [None, Some(0), Some(1)]);
        assert_eq!(found[1].as_ref().unwrap().distance, 0.0);
    }

    #[test]
    fn an_order_takes_a_connected_piece_apart() {
        let foliage = wood();
        let order = by_geometry(&foliage, &[1000.0, 30.0, 20.0]).order();
        order.check(&foliage).unwrap();
        let left = |steps: usize| Lod::after(&order, steps);
        assert_eq!(left(0).foliage(&foliage), foliage);
        assert_eq!(left(order.len()).leaf_count(), 0);
        let count = |steps: usize| left(steps).foliage(&foliage).triangles().len();
        for steps in 0..order.len() {
            let [now, next] = [count(steps), count(steps + 1)];
            assert!(next < now, "{now} triangles, then {next}");
            let [trunk, bough, twig] = is_left(&left(steps), &foliage);
            assert!(trunk || !bough, "a bough without its trunk");
            assert!(bough || !twig, "a twig without its bough");
        }
        let is_bare = |steps: usize| is_left(&left(steps), &foliage) == [true, false, false];
        assert!((0..order.len()).any(is_bare));
    }

    /// Parts of a piece do not hold each other's corners: few triangles will do.
    #[test]
    fn parts_of_a_piece_get_as_coarse_as_pieces() {
        let foliage = wood();
        let wood = by_geometry(&foliage, &[1.0, 1.0, 1.0]);
        let least = |part: usize| wood.pieces[part].levels.last().unwrap().triangles.len();
        assert!(least(0) <= 8 && least(1) <= 4, "{}, {}", least(0), least(1));
    }
}
