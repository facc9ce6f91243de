//! A leaf as one triangle by three of its corners, in its mean plane.
//!
//! Edge collapses keep the planes of the triangles that stay. A leaf folded along its midrib ends
//! as a triangle of one half, which other views see than saw the leaf.

use glam::DVec3;
use secateur_model::{Foliage, LeafId, LeafTriangle, NewLeaf};

use super::{MAX_LINEAR_SCALE, in_place_of, leaf_mesh};

/// Number of corners, the furthest from each other, of which all triples are tried.
const MAX_CORNERS: usize = 8;

/// A leaf has front and back faces if the vector sum of its triangles' areas is shorter than this
/// share of its area.
const MIN_FACING: f64 = 0.5;

/// Three corners of a leaf and of all leaves of its kind, numbered as in
/// [`secateur_model::CornerRef`].
pub(super) type CornerTriple = [u32; 3];

/// The triangle of these corners of a leaf, with the leaf's winding; none if it is a sliver, or
/// the leaf has front and back faces.
pub(super) fn flat(foliage: &Foliage, leaf: LeafId, three: CornerTriple) -> Option<NewLeaf> {
    let triangles = foliage.triangles_of(leaf);
    let centre = foliage.leaf(leaf).centre();
    let facing = facing(triangles);
    if facing.length() < MIN_FACING * foliage.leaf(leaf).area() {
        return None;
    }
    let normal = facing.try_normalize()?;
    let position = |corner: u32| {
        let at = position(triangles, corner);
        at - normal * normal.dot(at - centre)
    };
    let [a, b, c] = three;
    let [at_a, at_b, at_c] = three.map(position);
    let area = 0.5 * (at_b - at_a).cross(at_c - at_a).dot(normal);
    if area.abs() * MAX_LINEAR_SCALE.powi(2) < foliage.leaf(leaf).area() {
        return None;
    }
    let three = if area < 0.0 { [a, c, b] } else { three };
    in_place_of(foliage, leaf, &[three], position)
}

/// The triples of corners that a leaf and all of its kind could be replaced by.
pub(super) fn candidates(foliage: &Foliage, leaf: LeafId) -> Vec<CornerTriple> {
    let corners = some_corners(foliage.triangles_of(leaf));
    let mut found = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1) {
            found.extend(corners[j + 1..].iter().map(|&c| [a, b, c]));
        }
    }
    found
}

/// The vector sum of the triangles' areas.
pub(super) fn facing(triangles: &[LeafTriangle]) -> DVec3 {
    let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a);
    triangles.iter().map(|t| area(t.corners)).sum()
}

fn position(triangles: &[LeafTriangle], corner: u32) -> DVec3 {
    triangles[corner as usize / 3].corners[corner as usize % 3]
}

/// One corner at each vertex of a leaf; at most [`MAX_CORNERS`], far from each other.
fn some_corners(triangles: &[LeafTriangle]) -> Vec<u32> {
    let vertices = leaf_mesh::vertices(triangles).unwrap_or_default();
    let is_first = |corner: &u32| {
        let vertex = vertices[*corner as usize];
        vertices[..*corner as usize]
            .iter()
            .all(|before| *before != vertex)
    };
    let all: Vec<u32> = (0..vertices.len() as u32).filter(is_first).collect();
    let mut some: Vec<u32> = all.first().copied().into_iter().collect();
    while some.len() < all.len().min(MAX_CORNERS) {
        let distance = |corner: u32| {
            let to =
                |other: &u32| position(triangles, corner).distance(position(triangles, *other));
            some.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        let others = all.iter().copied().filter(|corner| !some.contains(corner));
        some.extend(others.max_by(|a, b| distance(*a).total_cmp(&distance(*b))));
    }
    some.sort_unstable();
    some
}
