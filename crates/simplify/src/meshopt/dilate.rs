//! Giving back the area that a simplified mesh has lost by moving its border
//! outwards.
//!
//! So do meshoptimizer's `simplify_dilate_borders` (pull request 1093, 2026)
//! and Nanite's 'preserve area', with the lost area over the border's length as
//! the offset. With A and A' the areas before and after, p the length of the
//! border and n the leaves that have one,
//!
//! ```text
//! d = min( (A - A') / p,  s/2 (sqrt(A/A') - 1) ),   s = p / 4n
//! ```
//!
//! The second term limits the first, which forgets that corners gain area too:
//! it is what squares of that border need to reach A.

use glam::DVec3;
use rustc_hash::FxHashMap;
use secateur_model::{Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place};

/// The furthest a corner moves, in offsets: sharp ones would become spikes.
const MITRE_LIMIT: f64 = 2.0;

/// Moves the borders of what is left of the foliage. Every leaf that is left
/// and has a border becomes a new leaf.
pub(super) fn dilate(foliage: &Foliage, removed: &mut Vec<LeafId>, made: &mut Vec<NewLeaf>) {
    let mut left: Vec<NewLeaf> = std::mem::take(made);
    let mut is_gone = vec![false; foliage.leaves().len()];
    removed.iter().for_each(|leaf| is_gone[leaf.index()] = true);
    let all = (0..foliage.leaves().len()).map(LeafId::from_index);
    let kept = all.clone().filter(|leaf| !is_gone[leaf.index()]);
    left.extend(kept.map(|leaf| whole(foliage, leaf)));
    left.sort_by_key(|leaf| leaf.donor);

    let outlines: Vec<Outline> = left
        .iter()
        .map(|leaf| Outline::of(&leaf.triangles_in(foliage, 1.0)))
        .collect();
    let bordered = outlines.iter().filter(|o| o.perimeter > 0.0).count();
    let perimeter: f64 = outlines.iter().map(|o| o.perimeter).sum();
    let before: f64 = foliage.leaves().iter().map(|leaf| leaf.area()).sum();
    let after: f64 = outlines.iter().map(|o| o.area).sum();
    let offset = offset(before, after, perimeter, bordered);
    for (leaf, outline) in left.iter_mut().zip(&outlines) {
        let corners = leaf.triangles.iter_mut().flatten();
        for (corner, vertex) in corners.zip(&outline.vertex_of) {
            let position = outline.positions[*vertex] + offset * outline.outwards[*vertex];
            corner.place = Place::At(position);
        }
    }
    *removed = all.collect();
    *made = left;
}

fn whole(foliage: &Foliage, leaf: LeafId) -> NewLeaf {
    let corner = |corner| NewCorner {
        place: Place::Of(secateur_model::CornerRef { leaf, corner }),
        like: corner,
    };
    let triangles = 0..foliage.triangles_of(leaf).len() as u32;
    NewLeaf {
        donor: leaf,
        triangles: triangles
            .map(|t| [0, 1, 2].map(|k| corner(3 * t + k)))
            .collect(),
    }
}

fn offset(before: f64, after: f64, perimeter: f64, leaves: usize) -> f64 {
    let lost = before - after;
    let is_measurable = lost > 0.0 && after > 0.0 && perimeter > 0.0;
    if !is_measurable {
        return 0.0;
    }
    let side = perimeter / (4.0 * leaves as f64);
    (lost / perimeter).min(0.5 * side * ((before / after).sqrt() - 1.0))
}

/// A leaf's vertices by position, and where its border's vertices go.
struct Outline {
    positions: Vec<DVec3>,
    /// For each corner of each triangle.
    vertex_of: Vec<usize>,
    /// By how much a vertex moves for an offset of 1.
    outwards: Vec<DVec3>,
    perimeter: f64,
    area: f64,
}

impl Outline {
    fn of(triangles: &[LeafTriangle]) -> Self {
        let mut positions = Vec::new();
        let mut known: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        let mut vertex = |position: DVec3| {
            let key = position.to_array().map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                positions.push(position);
                positions.len() - 1
            })
        };
        let vertex_of: Vec<usize> = triangles
            .iter()
            .flat_map(|t| t.corners)
            .map(&mut vertex)
            .collect();

        let mut uses: FxHashMap<(usize, usize), u32> = FxHashMap::default();
        let edges = |t: &[usize]| [(t[0], t[1], t[2]), (t[1], t[2], t[0]), (t[2], t[0], t[1])];
        for (a, b, _) in vertex_of.chunks_exact(3).flat_map(edges) {
            *uses.entry((a.min(b), a.max(b))).or_default() += 1;
        }
        let mut normals: Vec<Vec<DVec3>> = vec![Vec::new(); positions.len()];
        let (mut perimeter, mut area) = (0.0, 0.0);
        for triangle in vertex_of.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| positions[triangle[k]]);
            area += 0.5 * (b - a).cross(c - a).length();
            for (a, b, c) in edges(triangle) {
                if uses[&(a.min(b), a.max(b))] > 1 {
                    continue;
                }
                let along = (positions[b] - positions[a]).normalize_or_zero();
                let inwards = (positions[c] - positions[a]).reject_from_normalized(along);
                let outwards = -inwards.normalize_or_zero();
                perimeter += positions[a].distance(positions[b]);
                normals[a].push(outwards);
                normals[b].push(outwards);
            }
        }
        Self {
            outwards: normals.iter().map(|n| mitre(n)).collect(),
            positions,
            vertex_of,
            perimeter,
            area,
        }
    }
}

/// Where the offset edges of these normals meet, for an offset of 1.
fn mitre(normals: &[DVec3]) -> DVec3 {
    let sum: DVec3 = normals.iter().sum();
    let Some(direction) = sum.try_normalize() else {
        return DVec3::ZERO;
    };
    let reach = normals.iter().map(|n| n.dot(direction)).fold(1.0, f64::min);
    direction / reach.max(1.0 / MITRE_LIMIT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: f64, at: DVec3) -> [LeafTriangle; 2] {
        let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(x, y)| at + side * DVec3::new(x, y, 0.0));
        [[a, b, c], [a, c, d]].map(LeafTriangle::plain)
    }

    /// Of four unit squares one is left: it becomes the square of side 2 about
    /// the same middle, exactly the area of the four.
    #[test]
    fn one_square_regains_the_area_of_four() {
        let mut foliage = Foliage::default();
        for k in 0..4 {
            let at = DVec3::X * 3.0 * f64::from(k);
            foliage.push_leaf(&square(1.0, at), None).unwrap();
        }
        let mut removed: Vec<LeafId> = (1..4).map(LeafId::from_index).collect();
        let mut made = Vec::new();
        dilate(&foliage, &mut removed, &mut made);
        assert_eq!((removed.len(), made.len()), (4, 1));
        let corners = made[0].triangles_in(&foliage, 1.0);
        let expected = square(2.0, DVec3::new(-0.5, -0.5, 0.0));
        for (found, expected) in corners.iter().zip(expected) {
            for (f, e) in found.corners.iter().zip(expected.corners) {
                assert!(f.distance(e) < 1e-12, "{f} is not {e}");
            }
        }
    }

    /// Lost 3 of 4 over a border of 4 would be 3/4; squares need 1/2. Lost 1 of
    /// 101 over a border of 4000 (ten squares of side 100) is 1/4000.
    #[test]
    fn the_offset_is_the_lost_area_over_the_border_but_limited() {
        assert_eq!(offset(4.0, 1.0, 4.0, 1), 0.5);
        let small = offset(101.0, 100.0, 4000.0, 10);
        assert!((small - 1.0 / 4000.0).abs() < 1e-12, "{small}");
        assert_eq!(offset(1.0, 2.0, 4.0, 1), 0.0);
        assert_eq!(offset(1.0, 0.0, 0.0, 0), 0.0);
    }

    #[test]
    fn spikes_are_cut_short() {
        let thin = mitre(&[DVec3::Y, DVec3::new(0.01, -1.0, 0.0).normalize()]);
        assert!(thin.length() <= MITRE_LIMIT + 1e-12);
        let corner = mitre(&[DVec3::X, DVec3::Y]);
        assert!(corner.distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-12);
    }
}
