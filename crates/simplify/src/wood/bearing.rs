//! What a level of a piece of wood bears: leaves that hang on it, and pieces that grow on it.

use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use secateur_model::{Foliage, LeafId, LeafTriangle};

use super::distance::Shape;
use super::levels::Level;
use super::parts::Parts;
use super::support::{Growing, bounds, growing_of_parts};
use super::thickness::thickness;

/// A leaf is taken to hang on no more pieces than this: those that are nearest to it.
const MOST_BEARERS: usize = 4;

/// The most triangles of wood near a leaf that are looked at for these.
const MOST_NEAR: usize = 128;

/// Distances that differ by less than this share are one, since files have numbers of 32 bits.
pub(super) const SLACK: f64 = 1e-6;

/// A leaf that a piece bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Borne {
    pub(super) leaf: u32,
    /// The coarsest level that bears it, as all finer ones do; 0 is the piece as it is.
    pub(super) coarsest: u32,
}

/// By piece, the leaves that hang on it; and how far leaves are from wood at most.
pub(super) struct Bearing {
    pub(super) of_pieces: Vec<Vec<Borne>>,
    /// By leaf, the piece that is nearest to it; nothing without wood.
    pub(super) nearest: Vec<Option<u32>>,
    pub(super) largest_gap: f64,
}

/// Finds which leaves hang on which pieces: those within the largest distance that a leaf has from
/// the wood.
pub(super) fn bearing(wood: &Foliage, levels: &[&[Level]], leaves: &Foliage) -> Bearing {
    let tree = triangles_of(wood);
    let nearest: Vec<(f64, DVec3)> = (0..leaves.leaves().len())
        .into_par_iter()
        .map(|index| nearest_point(&tree, leaves.triangles_of(LeafId::from_index(index))))
        .collect();
    let finite = nearest
        .iter()
        .map(|found| found.0)
        .filter(|d| d.is_finite());
    let largest_gap = finite.fold(0.0, f64::max) * (1.0 + SLACK);
    let bearers = |(leaf, (_, point)): (usize, &(f64, DVec3))| {
        let mut pieces: Vec<u32> = Vec::new();
        let near = tree.nearest_neighbor_iter_with_distance_2(point.to_array());
        for (triangle, distance_2) in near.take(MOST_NEAR) {
            if distance_2 > largest_gap * largest_gap || pieces.len() == MOST_BEARERS {
                break;
            }
            if !pieces.contains(&triangle.data) {
                pieces.push(triangle.data);
            }
        }
        pieces
            .into_iter()
            .map(|piece| (piece, leaf as u32))
            .collect::<Vec<_>>()
    };
    let nearest_piece = |(_, point): &(f64, DVec3)| {
        let mut near = tree.nearest_neighbor_iter(point.to_array());
        near.next().map(|triangle| triangle.data)
    };
    let nearest_pieces = nearest.par_iter().map(nearest_piece).collect();
    let pairs: Vec<Vec<(u32, u32)>> = nearest.par_iter().enumerate().map(bearers).collect();
    let mut leaves_of: Vec<Vec<u32>> = vec![Vec::new(); levels.len()];
    for (piece, leaf) in pairs.concat() {
        leaves_of[piece as usize].push(leaf);
    }
    let of_piece = |(piece, hanging): (usize, Vec<u32>)| {
        let all = wood.triangles_of(LeafId::from_index(piece));
        let shapes: Vec<_> = levels[piece]
            .iter()
            .map(|level| Shape::of_level(all, &level.triangles))
            .collect();
        let borne = |leaf: u32| {
            let points = points_of(leaves.triangles_of(LeafId::from_index(leaf as usize)));
            // What is nearest to the wood is mostly near to a level of it, too.
            let (_, first) = nearest[leaf as usize];
            let is_near = |shape: &Shape, point| shape.is_within(point, largest_gap);
            let bears = |shape: &&Shape| {
                is_near(shape, first) || points.iter().any(|point| is_near(shape, *point))
            };
            Borne {
                leaf,
                coarsest: shapes.iter().take_while(bears).count() as u32,
            }
        };
        hanging.into_par_iter().map(borne).collect()
    };
    let of_pieces = leaves_of.into_par_iter().enumerate().map(of_piece);
    Bearing {
        of_pieces: of_pieces.collect(),
        nearest: nearest_pieces,
        largest_gap,
    }
}

/// Which levels a piece may have: by its own level, 0 as it is, how coarse what it grows on may be;
/// nothing where no level will do.
pub(super) type Needs = Vec<Option<u32>>;

/// For each piece what it needs of the one that it grows on to be no further from it than that is
/// thick, or than some piece was from its own at first; nothing for what grows on none.
pub(super) fn needs(parts: &Parts, levels: &[&[Level]]) -> Vec<Option<(usize, Needs)>> {
    let wood = parts.foliage();
    let growing = growing_of_parts(parts);
    let gaps = growing.iter().flatten().map(|found| found.distance);
    let largest_gap = gaps.fold(0.0, f64::max) * (1.0 + SLACK);
    let shapes: Vec<Vec<Shape>> = (0..levels.len())
        .into_par_iter()
        .map(|piece| {
            let all = wood.triangles_of(LeafId::from_index(piece));
            let shape = |level: &Level| Shape::of_level(all, &level.triangles);
            levels[piece].iter().map(shape).collect()
        })
        .collect();
    let of_piece = |piece: usize| {
        let Growing { on, at, .. } = growing[piece]?;
        let whole = |piece: usize| Shape::of(wood.triangles_of(LeafId::from_index(piece)));
        let bound = largest_gap.max(thickness(wood, LeafId::from_index(on)));
        let below = whole(on);
        let own = whole(piece);
        let mut known: Vec<(DVec3, Option<u32>)> = Vec::new();
        let mut needs = Needs::new();
        for shape in std::iter::once(&own).chain(&shapes[piece]) {
            let foot = (shape.corners())
                .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)));
            let foot = foot.expect("a piece has triangles");
            let need = match known.iter().find(|(point, _)| *point == foot) {
                Some((_, need)) => *need,
                None => {
                    let bears = |shape: &&Shape| shape.is_within(foot, bound);
                    let finest = bears(&&below);
                    let coarsest = shapes[on].iter().take_while(bears).count() as u32;
                    let need = finest.then_some(coarsest);
                    known.push((foot, need));
                    need
                }
            };
            needs.push(need);
        }
        Some((on, needs))
    };
    (0..levels.len()).into_par_iter().map(of_piece).collect()
}

/// All triangles with the number of their piece.
pub(super) fn triangles_of(wood: &Foliage) -> RTree<GeomWithData<super::support::Bounds, u32>> {
    let all = (0..wood.leaves().len()).flat_map(|piece| {
        let triangles = wood.triangles_of(LeafId::from_index(piece)).iter();
        triangles.map(move |t| GeomWithData::new(bounds(t.corners), piece as u32))
    });
    RTree::bulk_load(all.collect())
}

/// The point of a leaf that is nearest to the wood, and how far that is; infinite without wood.
fn nearest_point(
    tree: &RTree<GeomWithData<super::support::Bounds, u32>>,
    leaf: &[LeafTriangle],
) -> (f64, DVec3) {
    let mut best = (f64::INFINITY, leaf[0].corners[0]);
    for point in points_of(leaf) {
        let mut near = tree.nearest_neighbor_iter_with_distance_2(point.to_array());
        if let Some((_, distance_2)) = near.next()
            && distance_2 < best.0
        {
            best = (distance_2, point);
        }
    }
    (best.0.sqrt(), best.1)
}

/// The points by which the distance of a leaf is taken: corners and centres of its triangles.
pub(super) fn points_of(leaf: &[LeafTriangle]) -> Vec<DVec3> {
    let points = |t: &LeafTriangle| {
        let [a, b, c] = t.corners;
        [a, b, c, (a + b + c) / 3.0]
    };
    leaf.iter().flat_map(points).collect()
}
