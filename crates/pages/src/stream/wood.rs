//! Wood in connected pieces, and with which piece of the stream each comes.

use std::collections::HashMap;

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance as _, RTree};
use secateur_gltf::LeafSurface;
use secateur_model::{Foliage, LeafId, LeafTriangle, Surface};
use secateur_simplify::wood::supports;

use super::part::{Part, part_of};

/// Of the wood's area, what comes first, large pieces before small ones: what bears a crown.
const FIRST_SHARE: f64 = 0.8;

/// A connected piece of a surface of wood.
pub(super) struct Wood {
    pub(super) surface: usize,
    triangles: Vec<u32>,
}

impl Wood {
    pub(super) fn part(&self, surfaces: &[LeafSurface]) -> Part {
        let surface = &surfaces[self.surface].surface;
        let first = surface.triangles[self.triangles[0] as usize][0];
        part_of(surface, &self.triangles, surface.positions[first as usize])
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }
}

/// All pieces of the wood, surface by surface, by their lowest triangle.
pub(super) fn pieces(surfaces: &[LeafSurface]) -> Vec<Wood> {
    let wood = surfaces.iter().enumerate().filter(|(_, s)| !s.is_foliage);
    wood.flat_map(|(number, of)| pieces_of(number, &of.surface))
        .collect()
}

/// Triangles hang together that share a point, wherever vertices are split.
fn pieces_of(number: usize, surface: &Surface) -> Vec<Wood> {
    let mut point_of: HashMap<[u64; 3], u32> = HashMap::new();
    let points: Vec<u32> = surface
        .positions
        .iter()
        .map(|p| {
            let next = point_of.len() as u32;
            *point_of
                .entry(p.to_array().map(f64::to_bits))
                .or_insert(next)
        })
        .collect();
    let mut above: Vec<u32> = (0..point_of.len() as u32).collect();
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|v| top(&mut above, points[v as usize]));
        let least = a.min(b).min(c);
        for other in [a, b, c] {
            above[other as usize] = least;
        }
    }
    let mut piece_of: HashMap<u32, usize> = HashMap::new();
    let mut pieces: Vec<Wood> = Vec::new();
    for (index, triangle) in surface.triangles.iter().enumerate() {
        let point = top(&mut above, points[triangle[0] as usize]);
        let piece = *piece_of.entry(point).or_insert_with(|| {
            pieces.push(Wood {
                surface: number,
                triangles: Vec::new(),
            });
            pieces.len() - 1
        });
        pieces[piece].triangles.push(index as u32);
    }
    pieces
}

/// The least point that hangs together with one, as far as is known; shortens the way there.
fn top(above: &mut [u32], point: u32) -> u32 {
    let mut at = point;
    while above[at as usize] != at {
        let next = above[at as usize];
        above[at as usize] = above[next as usize];
        at = above[at as usize];
    }
    at
}

/// Each piece as a leaf of a foliage.
pub(super) fn as_foliage(wood: &[Wood], surfaces: &[LeafSurface]) -> Foliage {
    let mut foliage = Foliage::default();
    for piece in wood {
        let surface = &surfaces[piece.surface].surface;
        let triangle = |t: &u32| {
            let corners = surface.triangles[*t as usize];
            LeafTriangle::plain(corners.map(|v| surface.positions[v as usize]))
        };
        let triangles: Vec<LeafTriangle> = piece.triangles.iter().map(triangle).collect();
        let pushed = foliage.push_leaf(&triangles, None);
        pushed.expect("a surface has finite positions");
    }
    foliage
}

/// For each piece of wood with which of the stream's pieces it comes: the first ones with the first,
/// the others evenly, large ones before small ones; but a twig no later than the leaves that are nearest
/// to it, and what something grows on no later than that. `comes` says it of leaves.
pub(super) fn arrivals(
    wood: &[Wood],
    surfaces: &[LeafSurface],
    foliage: &Foliage,
    comes: &[u32],
    stream_pieces: u32,
) -> Vec<u32> {
    let pieces = as_foliage(wood, surfaces);
    let area = |index: usize| pieces.leaf(LeafId::from_index(index)).area();
    let mut by_area: Vec<usize> = (0..wood.len()).collect();
    by_area.sort_by(|a, b| area(*b).total_cmp(&area(*a)).then(a.cmp(b)));
    let all: f64 = by_area.iter().map(|index| area(*index)).sum();
    let mut before = 0.0;
    let mut late = Vec::new();
    for &index in &by_area {
        if before >= FIRST_SHARE * all {
            late.push(index);
        }
        before += area(index);
    }
    let mut arrivals = vec![0; wood.len()];
    let later = u64::from(stream_pieces.saturating_sub(1));
    for (rank, index) in late.iter().enumerate() {
        let share = rank as u64 * later / late.len() as u64;
        arrivals[*index] = (1 + share as u32).min(stream_pieces - 1);
    }
    let points = (0..wood.len()).flat_map(|index| {
        let triangles = pieces.triangles_of(LeafId::from_index(index)).iter();
        triangles.flat_map(move |t| {
            let middle = t.corners.iter().sum::<DVec3>() / 3.0;
            let [a, b, c] = t.corners;
            [a, b, c, middle].map(|point| GeomWithData::new(point.to_array(), index))
        })
    });
    let points = RTree::bulk_load(points.collect());
    for (index, comes) in comes.iter().enumerate() {
        let triangles = foliage.triangles_of(LeafId::from_index(index));
        let nearest = triangles
            .iter()
            .flat_map(|t| t.corners)
            .filter_map(|corner| {
                let nearest = points.nearest_neighbor(corner.to_array())?;
                Some((nearest.distance_2(&corner.to_array()), nearest.data))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, twig)) = nearest {
            arrivals[twig] = arrivals[twig].min(*comes);
        }
    }
    // What a piece grows on has more area: it is met after all that grows on it.
    let supports = supports(&pieces);
    for index in by_area.into_iter().rev() {
        if let Some(support) = supports[index] {
            arrivals[support] = arrivals[support].min(arrivals[index]);
        }
    }
    arrivals
}
