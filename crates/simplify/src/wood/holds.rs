//! What leaves and wood hang on, found by where they are, for plants whose files do not say it.
//!
//! A corner of wood hangs on itself, and is as far along the wood as the shortest way over edges from the ground: up
//! the trunk, over to a branch where that is nearest to what it grows on, and along the branch. A leaf hangs on the
//! point of it that is nearest to the wood, and so moves with the twig that is there; where there is no wood, on its
//! lowest corner, as far along as that is high.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, Hold, LeafId, LeafTriangle, SegmentIndex};

use super::bearing::points_of;
use super::nearest::nearest;
use super::support::{Bounds, Foot, bounds, feet};

/// What all of a plant hangs on, in world units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoundHolds {
    /// What each leaf hangs on.
    pub leaves: Vec<Hold>,
    /// What each corner of each triangle of the wood hangs on.
    pub wood: Vec<[Hold; 3]>,
}

/// What leaves and wood hang on. The segment of a hold is the number of the piece of wood.
pub fn found_holds(leaves: &Foliage, wood: &Foliage) -> FoundHolds {
    let ways = Ways::of(wood);
    let ground = lowest(leaves.triangles().iter().chain(wood.triangles()));
    let of_leaf =
        |index: usize| ways.of_leaf(leaves.triangles_of(LeafId::from_index(index)), ground.y);
    let of_wood = |piece: usize| {
        let triangles = wood.triangles_of(LeafId::from_index(piece)).iter();
        let along = &ways.along[ways.firsts[piece]..];
        let triangles = triangles.zip(along);
        let held = triangles.map(move |(triangle, along)| {
            [0, 1, 2].map(|k| hold(Some(piece), triangle.corners[k], along[k]))
        });
        held.collect::<Vec<_>>()
    };
    FoundHolds {
        leaves: (0..leaves.leaves().len())
            .into_par_iter()
            .map(of_leaf)
            .collect(),
        wood: (0..wood.leaves().len())
            .into_par_iter()
            .flat_map_iter(of_wood)
            .collect(),
    }
}

fn hold(piece: Option<usize>, pivot: DVec3, along: f64) -> Hold {
    Hold {
        segment: piece.map(SegmentIndex::from_index),
        pivot: pivot.as_vec3(),
        along_m: along as f32,
    }
}

/// The lowest corner; the origin without any.
fn lowest<'t>(triangles: impl IntoIterator<Item = &'t LeafTriangle>) -> DVec3 {
    let corners = triangles.into_iter().flat_map(|t| t.corners);
    corners
        .min_by(|a, b| a.y.total_cmp(&b.y))
        .unwrap_or_default()
}

/// How far along the wood its corners are.
struct Ways<'w> {
    wood: &'w Foliage,
    /// By triangle of the wood and corner.
    along: Vec<[f64; 3]>,
    /// The first triangle of each piece.
    firsts: Vec<usize>,
    /// All triangles, with their piece and number.
    sorted: RTree<GeomWithData<Bounds, (u32, u32)>>,
}

impl<'w> Ways<'w> {
    fn of(wood: &'w Foliage) -> Self {
        let pieces =
            (0..wood.leaves().len()).map(|piece| wood.triangles_of(LeafId::from_index(piece)));
        let mut firsts = Vec::new();
        let mut boxes = Vec::with_capacity(wood.triangles().len());
        for (piece, triangles) in pieces.enumerate() {
            firsts.push(boxes.len());
            for triangle in triangles {
                let which = (piece as u32, boxes.len() as u32);
                boxes.push(GeomWithData::new(bounds(triangle.corners), which));
            }
        }
        let mut ways = Self {
            wood,
            along: vec![[0.0; 3]; boxes.len()],
            firsts,
            sorted: RTree::bulk_load(boxes),
        };
        // What a piece grows on comes before it.
        for (piece, foot) in feet(wood) {
            let starts = match foot {
                Foot::Grows { on, at } => {
                    let near = ways.nearest(at, |other| other == on);
                    near.map_or(Vec::new(), |near| vec![(at, near.along + near.distance)])
                }
                Foot::Stands { on_ground, height } => {
                    let corners = ways.triangles(piece).iter().flat_map(|t| t.corners);
                    let standing = corners.filter(|corner| corner.y <= height);
                    standing
                        .map(|corner| (corner, corner.y - on_ground))
                        .collect()
                }
            };
            let along = along_edges(ways.triangles(piece), &starts);
            let first = ways.firsts[piece];
            ways.along[first..first + along.len()].copy_from_slice(&along);
        }
        ways
    }

    fn triangles(&self, piece: usize) -> &'w [LeafTriangle] {
        self.wood.triangles_of(LeafId::from_index(piece))
    }

    /// The point of such pieces of wood that is nearest to a point.
    fn nearest(&self, point: DVec3, is_such: impl Fn(usize) -> bool) -> Option<Near> {
        let all = self
            .sorted
            .nearest_neighbor_iter_with_distance_2(point.to_array());
        let mut such = all.filter(|(found, _)| is_such(found.data.0 as usize));
        let (found, distance_2) = such.next()?;
        let (piece, triangle) = (found.data.0 as usize, found.data.1 as usize);
        let corners = self.wood.triangles()[triangle].corners;
        let weights = nearest(corners, point).weights;
        let along = weights.iter().zip(self.along[triangle]);
        Some(Near {
            piece,
            along: along.map(|(weight, along)| weight * along).sum(),
            distance: distance_2.sqrt(),
        })
    }

    fn of_leaf(&self, leaf: &[LeafTriangle], ground: f64) -> Hold {
        let mut best: Option<(Near, DVec3)> = None;
        for point in points_of(leaf) {
            let near = self.nearest(point, |_| true);
            let is_nearer = |near: &Near| {
                best.as_ref()
                    .is_none_or(|(best, _)| near.distance < best.distance)
            };
            if let Some(near) = near.filter(is_nearer) {
                best = Some((near, point));
            }
        }
        match best {
            Some((near, point)) => hold(Some(near.piece), point, near.along + near.distance),
            None => {
                let foot = lowest(leaf);
                hold(None, foot, foot.y - ground)
            }
        }
    }
}

/// A point of the wood that is near to another point.
struct Near {
    piece: usize,
    /// From the ground along the wood, in world units.
    along: f64,
    /// How far the two are from each other, in world units.
    distance: f64,
}

/// How far the corners of a piece are along it: the length of the shortest way over edges from a point where it
/// starts, and how far along that is.
fn along_edges(triangles: &[LeafTriangle], starts: &[(DVec3, f64)]) -> Vec<[f64; 3]> {
    let mut numbers: FxHashMap<[u64; 3], usize> = FxHashMap::default();
    let mut points: Vec<DVec3> = Vec::new();
    let mut number = |point: DVec3| {
        let next = numbers.len();
        // Adding zero turns -0 into 0.
        let key = (point + 0.0).to_array().map(f64::to_bits);
        *numbers.entry(key).or_insert_with(|| {
            points.push(point);
            next
        })
    };
    let corners: Vec<[usize; 3]> = triangles
        .iter()
        .map(|t| t.corners.map(&mut number))
        .collect();
    let starts: Vec<(usize, f64)> = starts
        .iter()
        .map(|(point, along)| (number(*point), *along))
        .collect();
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for [a, b, c] in &corners {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            beside[*from].push(*to);
            beside[*to].push(*from);
        }
    }
    let mut along = vec![f64::INFINITY; points.len()];
    // The bits of numbers that are not negative have their order.
    let mut next = BinaryHeap::new();
    for (start, from) in starts {
        let from = from.max(0.0);
        along[start] = along[start].min(from);
        next.push(Reverse((from.to_bits(), start)));
    }
    while let Some(Reverse((bits, point))) = next.pop() {
        if along[point].to_bits() < bits {
            continue;
        }
        for &other in &beside[point] {
            let there = along[point] + points[point].distance(points[other]);
            if there < along[other] {
                along[other] = there;
                next.push(Reverse((there.to_bits(), other)));
            }
        }
    }
    let of = |point: usize| {
        if along[point].is_finite() {
            along[point]
        } else {
            0.0
        }
    };
    corners.into_iter().map(|t| t.map(of)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::tube;
    use super::*;

    /// A trunk of 4 m, a branch of 2 m from its middle, a leaf at the branch's tip, and one that floats beside it.
    #[test]
    fn what_is_along_a_branch_counts_the_trunk_below_it() {
        let mut wood = Foliage::default();
        let trunk = tube(DVec3::ZERO, 4.0 * DVec3::Y, 0.2, 8);
        wood.push_leaf(&trunk, None).unwrap();
        let [from, tip] = [DVec3::new(0.1, 2.0, 0.0), DVec3::new(2.1, 2.0, 0.0)];
        wood.push_leaf(&tube(from, tip, 0.05, 8), None).unwrap();
        let mut leaves = Foliage::default();
        for from in [tip, tip + 0.5 * DVec3::X] {
            let card = [
                from,
                from + 0.3 * DVec3::X,
                from + DVec3::new(0.3, 0.2, 0.0),
            ];
            leaves
                .push_leaf(&[LeafTriangle::plain(card)], None)
                .unwrap();
        }
        let found = found_holds(&leaves, &wood);
        let farthest = |piece: usize| {
            let of_piece = found.wood.as_flattened().iter();
            let of_piece =
                of_piece.filter(|hold| hold.segment == Some(SegmentIndex::from_index(piece)));
            of_piece.map(|hold| hold.along_m).fold(0.0, f32::max)
        };
        assert!((farthest(0) - 4.0).abs() < 0.5, "{}", farthest(0));
        assert!((farthest(1) - 4.0).abs() < 0.5, "{}", farthest(1));
        let [on_it, beside] = found.leaves[..] else {
            unreachable!("two leaves")
        };
        assert!((on_it.along_m - 4.0).abs() < 0.5, "{on_it:?}");
        assert!(
            (beside.along_m - on_it.along_m - 0.5).abs() < 0.1,
            "{beside:?}"
        );
        assert_eq!(beside.pivot, (tip + 0.5 * DVec3::X).as_vec3());
        assert_eq!(on_it.segment, Some(SegmentIndex::from_index(1)));
        // Wood hangs on itself.
        let corners = wood.triangles().iter().flat_map(|t| t.corners);
        for (corner, hold) in corners.zip(found.wood.as_flattened()) {
            assert_eq!(hold.pivot, corner.as_vec3());
        }
    }

    #[test]
    fn blades_without_wood_hang_on_their_feet() {
        let mut leaves = Foliage::default();
        for foot in [DVec3::ZERO, DVec3::new(1.0, 0.5, 0.0)] {
            let blade = [foot, foot + 0.1 * DVec3::X, foot + DVec3::Y];
            leaves
                .push_leaf(&[LeafTriangle::plain(blade)], None)
                .unwrap();
        }
        let along = found_holds(&leaves, &Foliage::default()).leaves;
        assert_eq!(
            along.iter().map(|hold| hold.along_m).collect::<Vec<_>>(),
            [0.0, 0.5]
        );
        assert!(along.iter().all(|hold| hold.segment.is_none()));
    }
}
