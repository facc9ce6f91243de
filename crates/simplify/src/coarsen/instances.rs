//! Leaves that are instances of one mesh: what one of them becomes, all become, so that they stay instances.

use glam::{DMat3, DVec3};
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place};

/// What takes the place of a leaf where this takes that of another instance of its mesh; none where one of them has no
/// area.
pub(super) fn as_instance(foliage: &Foliage, made: &NewLeaf, leaf: LeafId) -> Option<NewLeaf> {
    let [from, to] = [made.donor, leaf].map(|leaf| foliage.triangles_of(leaf));
    let largest = (0..from.len()).max_by(|&a, &b| area(&from[a]).total_cmp(&area(&from[b])))?;
    let [from, to] = [frame(&from[largest])?, frame(to.get(largest)?)?];
    let to_from = to.1 * from.1.inverse();
    let corner = |corner: &NewCorner| NewCorner {
        place: match corner.place {
            Place::At(position) => Place::At(to.0 + to_from * (position - from.0)),
            Place::Of(at) => Place::Of(CornerRef { leaf, ..at }),
            Place::InPlaneOf { corners, weights } => Place::InPlaneOf { corners, weights },
        },
        like: corner.like,
    };
    Some(NewLeaf {
        donor: leaf,
        triangles: made
            .triangles
            .iter()
            .map(|t| [0, 1, 2].map(|k| corner(&t[k])))
            .collect(),
    })
}

fn area(triangle: &LeafTriangle) -> f64 {
    let [a, b, c] = triangle.corners;
    (b - a).cross(c - a).length()
}

/// A corner of a triangle, two of its edges and as long a normal.
fn frame(triangle: &LeafTriangle) -> Option<(DVec3, DMat3)> {
    let [a, b, c] = triangle.corners;
    let across = (b - a).cross(c - a);
    let normal = across.try_normalize()? * across.length().sqrt();
    Some((a, DMat3::from_cols(b - a, c - a, normal)))
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat, DVec2};

    use super::super::{LossCurves, share_triangles};
    use super::*;

    /// A bent strip of 8 triangles, at these places.
    fn instances(places: &[DAffine3]) -> Foliage {
        let mut foliage = Foliage::default();
        for place in places {
            let at = |k: usize, side: f64| {
                let t = k as f64 / 4.0;
                place.transform_point3(DVec3::new(side * (1.0 - 0.6 * t), t, 0.4 * t * t))
            };
            let mut triangles = Vec::new();
            for k in 0..4 {
                let [a, b] = [at(k, -0.2), at(k, 0.2)];
                let [c, d] = [at(k + 1, -0.2), at(k + 1, 0.2)];
                triangles.push(LeafTriangle {
                    corners: [a, b, c],
                    uvs: [DVec2::ZERO; 3],
                });
                triangles.push(LeafTriangle {
                    corners: [b, d, c],
                    uvs: [DVec2::ZERO; 3],
                });
            }
            let leaf = foliage.push_leaf(&triangles, None).unwrap();
            foliage.set_shape(leaf, 7);
        }
        foliage
    }

    fn places() -> Vec<DAffine3> {
        let place = |k: usize| {
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, k as f64, 2.0 * k as f64, 0.3);
            let scale = DVec3::splat(1.0 + 0.2 * (k % 5) as f64);
            DAffine3::from_scale_rotation_translation(scale, turn, DVec3::splat(k as f64))
        };
        (0..20).map(place).collect()
    }

    /// In their own space all have the corners of the first, at every number of triangles.
    #[test]
    fn instances_become_coarser_alike() {
        let places = places();
        let foliage = instances(&places);
        let curves = LossCurves::of(&foliage);
        for at_most in [20, 70, 100, 150] {
            let shares = share_triangles(&foliage, at_most, &curves);
            assert!(shares.iter().all(|share| *share == shares[0]), "{shares:?}");
            assert!(
                10 * shares.iter().sum::<usize>() >= 9 * at_most,
                "{shares:?}"
            );
            let own = |k: usize| {
                let leaf = LeafId::from_index(k);
                let Some(made) = curves.coarser(&foliage, leaf, shares[k]) else {
                    return Vec::new();
                };
                let local = places[k].inverse();
                let corners = made
                    .triangles_in(&foliage, 1.0)
                    .into_iter()
                    .flat_map(|t| t.corners);
                corners
                    .map(|at| local.transform_point3(at))
                    .collect::<Vec<_>>()
            };
            for k in 1..places.len() {
                let pairs = own(0).into_iter().zip(own(k));
                for (of_first, of_other) in pairs {
                    assert!(of_first.distance(of_other) < 1e-9, "{of_first} {of_other}");
                }
            }
        }
    }
}
