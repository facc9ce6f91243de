//! A leaf of any number of triangles: what the budget asks for, whatever its textures are.
//!
//! Collapses along textures stall where triangles have texture coordinates of their own. Here vertices are
//! welded by position alone, and a triangle between corners of several textures shows all of one triangle that
//! was there. Where that stalls too, as triangles do not meet, as many as may stay are left and grow.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place};

use super::leaf_mesh;

/// Collapses by position are used where they leave at least this share of what may stay.
const LEAST_USED: f64 = 0.9;

/// The most that the sides of triangles grow for others that are gone.
const MOST_GROWN: f64 = 2.0;

/// The leaf with at most this many triangles, and at least nine tenths of that; none if that is no fewer
/// than it has, or none.
pub(crate) fn within(foliage: &Foliage, leaf: LeafId, at_most: usize) -> Option<NewLeaf> {
    let triangles = foliage.triangles_of(leaf);
    if at_most == 0 || at_most >= triangles.len() {
        return None;
    }
    let made = match collapsed(triangles, at_most) {
        Some(kept) => {
            let charts = Charts::of(triangles);
            kept.into_iter().map(|t| charts.textured(leaf, t)).collect()
        }
        None => thinned(triangles, at_most),
    };
    Some(NewLeaf {
        donor: leaf,
        triangles: made,
    })
}

/// What collapses leave where vertices are welded by position; none if that is too much or too little.
fn collapsed(triangles: &[LeafTriangle], at_most: usize) -> Option<Vec<[u32; 3]>> {
    let plain: Vec<LeafTriangle> = triangles
        .iter()
        .map(|t| LeafTriangle::plain(t.corners))
        .collect();
    let kept = leaf_mesh::collapsed(&plain, at_most)?;
    let least = (LEAST_USED * at_most as f64).ceil() as usize;
    (least..=at_most).contains(&kept.len()).then_some(kept)
}

/// Which corners lie in one piece of texture.
struct Charts<'a> {
    triangles: &'a [LeafTriangle],
    /// By triangle, the first triangle of its piece.
    of_triangles: Vec<usize>,
}

impl<'a> Charts<'a> {
    fn of(triangles: &'a [LeafTriangle]) -> Self {
        let mut parents: Vec<usize> = (0..triangles.len()).collect();
        let mut first_at: FxHashMap<[u64; 5], usize> = FxHashMap::default();
        for (t, triangle) in triangles.iter().enumerate() {
            for (place, uv) in triangle.corners.iter().zip(triangle.uvs) {
                let other = *first_at.entry(key(*place, uv)).or_insert(t);
                let [a, b] = [root(&mut parents, t), root(&mut parents, other)];
                parents[a.max(b)] = a.min(b);
            }
        }
        let of_triangles = (0..triangles.len()).map(|t| root(&mut parents, t));
        Self {
            triangles,
            of_triangles: of_triangles.collect(),
        }
    }

    /// A triangle between these corners: with their textures if they are of one piece, else with that of the
    /// triangle which the first of them is of.
    fn textured(&self, leaf: LeafId, corners: [u32; 3]) -> [NewCorner; 3] {
        let charts = corners.map(|corner| self.of_triangles[corner as usize / 3]);
        let of_one = charts[0] == charts[1] && charts[0] == charts[2];
        // Textures that meet by chance would show a line of it.
        let area = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|c| self.triangles[c as usize / 3].uvs[c as usize % 3]);
            (b - a).perp_dot(c - a)
        };
        let [first, ..] = corners;
        let turned = |k: u32| first - first % 3 + (first % 3 + k) % 3;
        let whole = [0, 1, 2].map(turned);
        let is_one = of_one && (area(corners) != 0.0 || area(whole) == 0.0);
        let like = if is_one { corners } else { whole };
        let corner = |k: usize| {
            let (triangle, number) = (corners[k] as usize / 3, corners[k] as usize % 3);
            let place = match is_one {
                true => Place::Of(CornerRef {
                    leaf,
                    corner: corners[k],
                }),
                false => Place::At(self.triangles[triangle].corners[number]),
            };
            NewCorner {
                place,
                like: like[k],
            }
        };
        [0, 1, 2].map(corner)
    }
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}

fn key(place: DVec3, uv: DVec2) -> [u64; 5] {
    [place.x, place.y, place.z, uv.x, uv.y].map(|v| (v + 0.0).to_bits())
}

/// This many of the triangles, spread over all, each about its centre as much larger as others are gone.
fn thinned(triangles: &[LeafTriangle], count: usize) -> Vec<[NewCorner; 3]> {
    let area = |t: &LeafTriangle| {
        let [a, b, c] = t.corners;
        (b - a).cross(c - a).length()
    };
    let kept: Vec<usize> = (0..count).map(|k| k * triangles.len() / count).collect();
    let left: f64 = kept.iter().map(|t| area(&triangles[*t])).sum();
    let all: f64 = triangles.iter().map(area).sum();
    let scale = (all / left).sqrt().clamp(1.0, MOST_GROWN);
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let of_triangle = |t: usize| {
        let corners = triangles[t].corners;
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        [0, 1, 2].map(|k| NewCorner {
            place: Place::At(centre + scale * (corners[k] - centre)),
            like: (3 * t + k) as u32,
        })
    };
    kept.into_iter().map(of_triangle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 10 x 10 squares, each triangle with all of a texture.
    fn sheet() -> Foliage {
        let mut triangles = Vec::new();
        let at = |x: usize, y: usize| DVec3::new(x as f64, y as f64, 0.0);
        let uvs = [DVec2::ZERO, DVec2::X, DVec2::Y];
        for (x, y) in (0..100).map(|k| (k % 10, k / 10)) {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            for corners in [[a, b, c], [c, d, a]] {
                triangles.push(LeafTriangle { corners, uvs });
            }
        }
        let mut foliage = Foliage::default();
        foliage.push_leaf(&triangles, None).unwrap();
        foliage
    }

    #[test]
    fn triangles_of_textures_of_their_own_collapse_and_show_all_of_one_of_them() {
        let foliage = sheet();
        let leaf = LeafId::from_index(0);
        for at_most in [100, 40, 10, 2] {
            let made = within(&foliage, leaf, at_most).unwrap();
            let left = made.triangles_in(&foliage, 1.0);
            assert!(
                left.len() <= at_most && left.len() * 10 >= at_most * 9,
                "{}",
                left.len()
            );
            let area: f64 = left
                .iter()
                .map(|t| {
                    let [a, b, c] = t.corners;
                    0.5 * (b - a).cross(c - a).length()
                })
                .sum();
            // A flat sheet keeps its outline.
            assert!((area - 100.0).abs() < 15.0, "{area} of {at_most}");
            for triangle in left {
                let [a, b, c] = triangle.uvs;
                assert_eq!((b - a).perp_dot(c - a).abs(), 1.0);
            }
        }
    }

    #[test]
    fn triangles_that_do_not_meet_get_fewer_and_larger() {
        let mut foliage = Foliage::default();
        let apart = |k: usize| {
            let at = 3.0 * k as f64 * DVec3::X;
            LeafTriangle::plain([at, at + DVec3::X, at + DVec3::Y])
        };
        let triangles: Vec<LeafTriangle> = (0..30).map(apart).collect();
        foliage.push_leaf(&triangles, None).unwrap();
        let leaf = LeafId::from_index(0);
        for at_most in 1..30 {
            let made = within(&foliage, leaf, at_most).unwrap();
            assert_eq!(made.triangles.len(), at_most);
        }
        assert_eq!(within(&foliage, leaf, 30), None);
        assert_eq!(within(&foliage, leaf, 0), None);
    }
}
