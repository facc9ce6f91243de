//! Which piece of wood grows on which.

use glam::DVec3;
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree, RTreeObject};
use secateur_model::{Foliage, LeafId};

/// Largest number of corners of a piece that are compared with other pieces.
const MOST_CORNERS: usize = 192;

/// For each piece the one that it grows on: of those of more area the one nearest to any of its
/// corners. The piece of the most area grows on none. Pieces of equal area are taken in their
/// order.
pub fn supports(wood: &Foliage) -> Vec<Option<usize>> {
    let area = |index: usize| wood.leaf(LeafId::from_index(index)).area();
    let mut by_area: Vec<usize> = (0..wood.leaves().len()).collect();
    by_area.sort_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
    let mut rank = vec![0; by_area.len()];
    for (place, &index) in by_area.iter().enumerate() {
        rank[index] = place;
    }
    let mut boxes = Vec::with_capacity(wood.triangles().len());
    for (index, &rank) in rank.iter().enumerate() {
        for triangle in wood.triangles_of(LeafId::from_index(index)) {
            let corners = triangle.corners.map(|corner| corner.to_array());
            let bounds = AABB::from_points(corners.iter());
            boxes.push(GeomWithData::new(Bounds(bounds, triangle.corners), rank));
        }
    }
    let tree = RTree::bulk_load(boxes);
    let support = |index: usize| -> Option<usize> {
        if rank[index] == 0 {
            return None;
        }
        let triangles = wood.triangles_of(LeafId::from_index(index));
        let corners = triangles.iter().flat_map(|t| t.corners);
        let step = (3 * triangles.len()).div_ceil(MOST_CORNERS);
        let mut best = (f64::INFINITY, usize::MAX);
        for corner in corners.step_by(step) {
            let nearest = tree.nearest_neighbor_iter_with_distance_2(corner.to_array());
            for (other, distance_2) in nearest {
                if distance_2 >= best.0 {
                    break;
                }
                if other.data < rank[index] {
                    best = (distance_2, other.data);
                    break;
                }
            }
        }
        (best.1 != usize::MAX).then(|| by_area[best.1])
    };
    (0..rank.len()).into_par_iter().map(support).collect()
}

/// A triangle with its box.
struct Bounds(AABB<[f64; 3]>, [DVec3; 3]);

impl RTreeObject for Bounds {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.0
    }
}

impl rstar::PointDistance for Bounds {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from_array(*point);
        (point - nearest_on(self.1, point)).length_squared()
    }
}

/// The point of a triangle that is nearest to a point: by the region of its plane in which the
/// point lies (Ericson, Real-Time Collision Detection, 5.1.5).
fn nearest_on([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let inverse = 1.0 / (va + vb + vc);
    match inverse.is_finite() {
        true => a + ab * (vb * inverse) + ac * (vc * inverse),
        false => a,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_a_triangle_is_in_it() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let nearest = |x, y, z| nearest_on(triangle, DVec3::new(x, y, z));
        assert_eq!(nearest(0.25, 0.25, 3.0), DVec3::new(0.25, 0.25, 0.0));
        assert_eq!(nearest(-1.0, -1.0, 0.0), DVec3::ZERO);
        assert_eq!(nearest(2.0, 0.0, 0.0), DVec3::X);
        assert_eq!(nearest(0.5, -1.0, 0.0), DVec3::new(0.5, 0.0, 0.0));
        assert_eq!(nearest(1.0, 1.0, 0.0), DVec3::new(0.5, 0.5, 0.0));
        assert_eq!(nearest_on([DVec3::ONE; 3], DVec3::ZERO), DVec3::ONE);
    }
}
