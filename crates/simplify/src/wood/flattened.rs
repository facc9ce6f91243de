//! Bodies of which collapses leave something flat: a front and a back in one plane.
//!
//! In a double-sided material each is drawn from both sides, and the one that is drawn first hides the other: from one
//! of the sides one sees the light of the other side. So both lie a little apart.

use glam::DVec3;
use secateur_model::{Foliage, LeafTriangle, Lod, NewCorner, NewLeaf, Place};

use super::fullness::compactness;
use super::thickness::thickness;

/// What is no more compact is flat: a ball is a tenth.
const FLAT: f64 = 1e-3;

/// How far a face moves outward, over the thickness that the body had.
const APART: f64 = 0.05;

/// The level in which fronts and backs of flattened pieces lie apart.
pub(crate) fn sides_apart(pieces: &Foliage, mut lod: Lod) -> Lod {
    lod.change_made(|leaf| move_apart(pieces, leaf));
    lod
}

fn move_apart(pieces: &Foliage, leaf: &mut NewLeaf) {
    let own = pieces.triangles_of(leaf.donor);
    let left = leaf.triangles_in(pieces, 1.0);
    let is_in_plane = |corner: &NewCorner| matches!(corner.place, Place::InPlaneOf { .. });
    let compactness = |triangles: &[LeafTriangle]| {
        let corners: Vec<_> = triangles.iter().map(|triangle| triangle.corners).collect();
        compactness(&corners)
    };
    let is_body = compactness(own).is_some_and(|found| found > FLAT);
    let is_flat = compactness(&left).is_some_and(|found| found <= FLAT);
    if !is_body || !is_flat || leaf.triangles.as_flattened().iter().any(is_in_plane) {
        return;
    }
    let way = APART * thickness(pieces, leaf.donor);
    for (corners, triangle) in leaf.triangles.iter_mut().zip(&left) {
        let out = way * across(triangle).normalize_or_zero();
        for (corner, at) in corners.iter_mut().zip(triangle.corners) {
            corner.place = Place::At(at + out);
        }
    }
}

fn across(triangle: &LeafTriangle) -> DVec3 {
    let [a, b, c] = triangle.corners;
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use secateur_model::{CornerRef, LeafId};

    use super::*;

    const A: DVec3 = DVec3::X;
    const B: DVec3 = DVec3::ZERO;
    const C: DVec3 = DVec3::Z;

    /// A plant of one piece of these faces, and a level of it: its first face and another back to back.
    fn flattened(faces: &[[DVec3; 3]]) -> (Foliage, Lod) {
        let face = |corners: &[DVec3; 3]| LeafTriangle {
            corners: *corners,
            uvs: [DVec2::ZERO; 3],
        };
        let all: Vec<LeafTriangle> = faces.iter().map(face).collect();
        let mut pieces = Foliage::default();
        let leaf = pieces.push_leaf(&all, None).unwrap();
        let corner = |number: u32| NewCorner {
            place: Place::Of(CornerRef {
                leaf,
                corner: number,
            }),
            like: number,
        };
        let mut lod = Lod::original(1);
        lod.remove(leaf);
        lod.make(NewLeaf {
            donor: leaf,
            triangles: [[0, 1, 2], [0, 2, 1]].map(|t| t.map(corner)).to_vec(),
        });
        (pieces, lod)
    }

    #[test]
    fn sides_of_a_flattened_body_lie_apart_each_on_its_own_side() {
        let top = DVec3::Y;
        let (pieces, level) = flattened(&[[A, B, C], [B, A, top], [C, B, top], [A, C, top]]);
        let left = sides_apart(&pieces, level).foliage(&pieces);
        let [front, back] = [0, 1].map(|k| left.triangles()[k]);
        let out = across(&front).normalize();
        let apart = (front.corners[0] - back.corners[0]).dot(out);
        let expected = 2.0 * APART * thickness(&pieces, LeafId::from_index(0));
        assert!(
            apart > 0.0 && (apart - expected).abs() < 1e-12,
            "{apart} {expected}"
        );
        assert_eq!(front.corners[1], B + 0.5 * apart * out);
    }

    /// What was a sheet, or two back to back, was drawn so before.
    #[test]
    fn sheets_stay_where_they_are() {
        let top = DVec3::Y;
        let sheet = [[A, B, C]];
        let pair = [[A, B, C], [A, C, B]];
        let open = [[A, B, C], [B, A, top], [C, B, top]];
        for faces in [&sheet[..], &pair, &open] {
            let (pieces, level) = flattened(faces);
            assert_eq!(sides_apart(&pieces, level.clone()), level);
        }
    }
}
