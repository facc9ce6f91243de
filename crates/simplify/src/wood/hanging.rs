//! What a coarser level leaves in the air.
//!
//! Collapses over all of a plant know neither what a bough grows on nor that a stem is to stay in one: a twig may be left
//! whose bough is gone, and a trunk may come apart at its fork. So what is left is taken apart into what hangs together;
//! what stands on the ground, or grew on nothing, holds what is near it, and this what is near to it. The rest hangs in
//! the air.

use glam::DVec3;
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod, NewLeaf};

use super::bearing::SLACK;
use super::support::{Bounds, Growing, bounds, growing};
use super::thickness::thickness;

/// What begins no higher above the lowest wood than this share of the height of all stands on the ground. Other values
/// were not tried.
const GROUND: f64 = 0.02;

/// What hangs in the air may be left out where it is no more than this share of the area that is left: of a trunk that
/// came apart more than that hangs. Other values were not tried.
const MOST_HANGING: f64 = 0.05;

/// Parts of one piece that are further from each other than this share of the height of all came apart. Other values
/// were not tried.
const APART: f64 = 0.01;

/// How pieces are held at first.
#[derive(Clone, Debug, Default)]
pub(super) struct Holds {
    /// By piece, how far it may be from what holds it, in world units; nothing for what grows on none or stands on the
    /// ground.
    reaches: Vec<Option<f64>>,
    /// How far parts of one piece may be from each other, in world units.
    apart: f64,
}

impl Holds {
    pub(super) fn of(wood: &Foliage) -> Self {
        let pieces = || (0..wood.leaves().len()).map(LeafId::from_index);
        let thickness: Vec<f64> = pieces().map(|piece| thickness(wood, piece)).collect();
        let heights = |triangles: &[LeafTriangle]| {
            let heights = triangles.iter().flat_map(|t| t.corners).map(|c| c.y);
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| {
                [low.min(y), high.max(y)]
            })
        };
        let [low, high] = heights(wood.triangles());
        let ground = low + GROUND * (high - low);
        let reach = |(piece, found): (LeafId, Option<Growing>)| {
            let found = found?;
            let [foot, _] = heights(wood.triangles_of(piece));
            let reach = (found.distance * (1.0 + SLACK)).max(thickness[found.on]);
            (foot > ground).then_some(reach)
        };
        Self {
            reaches: pieces().zip(growing(wood)).map(reach).collect(),
            apart: APART * (high - low),
        }
    }

    /// A level of the wood but for what hangs in the air; nothing where more hangs than may be left out.
    pub(super) fn without_hanging(&self, wood: &Foliage, lod: Lod) -> Option<Lod> {
        let mut left: Vec<Vec<LeafTriangle>> = vec![Vec::new(); wood.leaves().len()];
        for (piece, _) in lod.leaves() {
            left[piece.index()] = wood.triangles_of(piece).to_vec();
        }
        for (made, area_scale) in lod.made() {
            left[made.donor.index()].extend(made.triangles_in(wood, area_scale));
        }
        let held = self.held(&left)?;
        if held.iter().flatten().all(|is_held| *is_held) {
            return Some(lod);
        }
        let mut rest = Lod::original(left.len());
        let is_left: Vec<bool> = {
            let mut is_left = vec![false; left.len()];
            lod.leaves()
                .for_each(|(piece, _)| is_left[piece.index()] = true);
            is_left
        };
        for (piece, held) in held.iter().enumerate() {
            if !is_left[piece] || held.contains(&false) {
                rest.remove(LeafId::from_index(piece));
            }
        }
        let mut held: Vec<_> = held.iter().map(|held| held.iter()).collect();
        for (made, _) in lod.made() {
            let held = &mut held[made.donor.index()];
            let kept = made.triangles.iter().zip(held).filter(|(_, held)| **held);
            let triangles: Vec<_> = kept.map(|(triangle, _)| *triangle).collect();
            if !triangles.is_empty() {
                rest.make(NewLeaf {
                    donor: made.donor,
                    triangles,
                });
            }
        }
        Some(rest)
    }

    /// What is held of what is left of each piece: for each triangle whether it is. Nothing where more hangs than may be
    /// left out.
    pub(super) fn held(&self, left: &[Vec<LeafTriangle>]) -> Option<Vec<Vec<bool>>> {
        let of_pieces = left.par_iter().enumerate().map(|(piece, triangles)| {
            let shapes = together(triangles).into_iter();
            let shape = |triangles| Shape {
                piece,
                triangles,
                is_held: false,
            };
            shapes.map(shape).collect::<Vec<Shape>>()
        });
        let of_pieces: Vec<Vec<Shape>> = of_pieces.collect();
        let mut shapes = of_pieces.concat();
        self.hold(left, &mut shapes);
        let area = |shape: &Shape| -> f64 {
            let areas = shape
                .of(left)
                .map(|[a, b, c]| (b - a).cross(c - a).length());
            areas.sum()
        };
        let all: f64 = shapes.iter().map(area).sum();
        let hanging: f64 = shapes.iter().filter(|shape| !shape.is_held).map(area).sum();
        if hanging > MOST_HANGING * all {
            return None;
        }
        let mut held: Vec<Vec<bool>> = left.iter().map(|all| vec![true; all.len()]).collect();
        for shape in shapes.iter().filter(|shape| !shape.is_held) {
            for triangle in &shape.triangles {
                held[shape.piece][*triangle] = false;
            }
        }
        Some(held)
    }

    /// Finds what is held, from what holds itself on.
    fn hold(&self, left: &[Vec<LeafTriangle>], shapes: &mut [Shape]) {
        let mut newly: Vec<usize> = (self.reaches.iter().enumerate())
            .filter(|(_, reach)| reach.is_none())
            .filter_map(|(piece, _)| lowest(left, shapes, piece))
            .collect();
        while !newly.is_empty() {
            for number in &newly {
                shapes[*number].is_held = true;
            }
            let near = |number: &usize| {
                let shape = &shapes[*number];
                let of = |corners| GeomWithData::new(bounds(corners), shape.piece);
                shape.of(left).map(of).collect::<Vec<_>>()
            };
            let holding = RTree::bulk_load(newly.iter().flat_map(near).collect());
            let found = shapes.par_iter().enumerate();
            let found =
                found.filter(|(_, shape)| !shape.is_held && self.is_held_by(shape, left, &holding));
            newly = found.map(|(number, _)| number).collect();
        }
    }

    /// Whether it is near to one of these triangles, each with its piece.
    fn is_held_by(
        &self,
        shape: &Shape,
        left: &[Vec<LeafTriangle>],
        holding: &RTree<GeomWithData<Bounds, usize>>,
    ) -> bool {
        let of_others = self.reaches[shape.piece].unwrap_or(0.0).max(self.apart);
        shape.of(left).flatten().any(|corner| {
            let corner = corner.to_array();
            let mut near = holding.locate_within_distance(corner, of_others * of_others);
            near.any(|held| {
                let is_own = held.data == shape.piece;
                !is_own || held.distance_2(&corner) <= self.apart * self.apart
            })
        })
    }
}

/// Triangles of one piece that hang together.
#[derive(Clone, Debug)]
struct Shape {
    piece: usize,
    triangles: Vec<usize>,
    is_held: bool,
}

impl Shape {
    fn of<'l>(&'l self, left: &'l [Vec<LeafTriangle>]) -> impl Iterator<Item = [DVec3; 3]> {
        let triangles = self.triangles.iter();
        triangles.map(|triangle| left[self.piece][*triangle].corners)
    }
}

/// The one of a piece that reaches lowest.
fn lowest(left: &[Vec<LeafTriangle>], shapes: &[Shape], piece: usize) -> Option<usize> {
    let low = |shape: &Shape| {
        let heights = shape.of(left).flatten().map(|corner| corner.y);
        heights.fold(f64::INFINITY, f64::min)
    };
    let from = shapes.partition_point(|shape| shape.piece < piece);
    let own = shapes[from..]
        .iter()
        .take_while(|shape| shape.piece == piece);
    let own = own.enumerate().map(|(k, shape)| (low(shape), from + k));
    own.min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, number)| number)
}

/// Triangles by what shares places.
fn together(triangles: &[LeafTriangle]) -> Vec<Vec<usize>> {
    let mut at: FxHashMap<[u64; 3], Vec<usize>> = FxHashMap::default();
    let key = |place: DVec3| place.to_array().map(|v| (v + 0.0).to_bits());
    for (number, triangle) in triangles.iter().enumerate() {
        for corner in triangle.corners {
            at.entry(key(corner)).or_default().push(number);
        }
    }
    let mut is_known = vec![false; triangles.len()];
    let mut all = Vec::new();
    for first in 0..triangles.len() {
        if std::mem::replace(&mut is_known[first], true) {
            continue;
        }
        let mut shape = vec![first];
        let mut next = 0;
        while let Some(&triangle) = shape.get(next) {
            next += 1;
            for corner in triangles[triangle].corners {
                // What is at a place is looked at once.
                for other in at.remove(&key(corner)).unwrap_or_default() {
                    if !std::mem::replace(&mut is_known[other], true) {
                        shape.push(other);
                    }
                }
            }
        }
        all.push(shape);
    }
    all
}

#[cfg(test)]
mod tests {
    use secateur_model::{CornerRef, NewCorner, Place};

    use super::super::tests::tube;
    use super::*;

    /// A trunk, a bough on it, a twig on the bough, and a berry that hangs below the bough.
    fn tree() -> Foliage {
        let mut wood = Foliage::default();
        let tip = DVec3::new(3.0, 5.0, 0.0);
        let berry = DVec3::new(2.0, 4.0, 0.0);
        for piece in [
            tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12),
            tube(DVec3::new(0.3, 4.0, 0.0), tip, 0.1, 8),
            tube(tip, tip + DVec3::new(1.0, 0.5, 0.0), 0.02, 4),
            tube(berry, berry + 0.05 * DVec3::Y, 0.02, 1),
        ] {
            wood.push_leaf(&piece, None).unwrap();
        }
        wood
    }

    /// The tree without the triangles of a piece that the filter drops.
    fn without(wood: &Foliage, piece: usize, is_kept: impl Fn(&LeafTriangle) -> bool) -> Lod {
        let donor = LeafId::from_index(piece);
        let mut lod = Lod::original(wood.leaves().len());
        lod.remove(donor);
        let all = wood.triangles_of(donor).iter().enumerate();
        let kept = all.filter(|(_, triangle)| is_kept(triangle));
        let corner = |corner: u32| NewCorner {
            place: Place::Of(CornerRef {
                leaf: donor,
                corner,
            }),
            like: corner,
        };
        let of = |(t, _): (usize, _)| [0, 1, 2].map(|k| corner(3 * t as u32 + k));
        let triangles: Vec<[NewCorner; 3]> = kept.map(of).collect();
        if !triangles.is_empty() {
            lod.make(NewLeaf { donor, triangles });
        }
        lod
    }

    fn left(wood: &Foliage, lod: Lod) -> Option<Vec<usize>> {
        let rest = Holds::of(wood).without_hanging(wood, lod)?;
        let originals = rest.leaves().map(|(piece, _)| piece.index());
        let mut all: Vec<usize> = originals.collect();
        all.extend(rest.made().map(|(made, _)| made.donor.index()));
        all.sort_unstable();
        Some(all)
    }

    #[test]
    fn what_grew_on_what_is_gone_goes_too() {
        let wood = tree();
        assert_eq!(left(&wood, Lod::original(4)), Some(vec![0, 1, 2, 3]));
        // The berry is as near to the trunk as it was to the bough.
        assert_eq!(left(&wood, without(&wood, 1, |_| false)), Some(vec![0]));
        assert_eq!(
            left(&wood, without(&wood, 2, |_| false)),
            Some(vec![0, 1, 3])
        );
        // Its half that is left on the trunk bears no twig.
        let inner = |t: &LeafTriangle| t.corners.iter().all(|c| c.x < 2.3);
        assert_eq!(left(&wood, without(&wood, 1, inner)), Some(vec![0, 1, 3]));
        // The outer half hangs itself, and what grows on it.
        let outer = |t: &LeafTriangle| t.corners.iter().all(|c| c.x > 1.5);
        assert_eq!(left(&wood, without(&wood, 1, outer)), Some(vec![0]));
    }

    /// Of a trunk that came apart more hangs than may be left out.
    #[test]
    fn a_trunk_that_came_apart_is_no_level() {
        let wood = tree();
        let torn = |t: &LeafTriangle| t.corners.iter().all(|c| c.y < 2.0 || c.y > 3.9);
        assert_eq!(left(&wood, without(&wood, 0, torn)), None);
        let whole = |t: &LeafTriangle| t.corners.iter().all(|c| c.y < 7.5);
        assert_eq!(
            left(&wood, without(&wood, 0, whole)),
            Some(vec![0, 1, 2, 3])
        );
    }
}
