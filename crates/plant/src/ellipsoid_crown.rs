//! A crown without wood, for measuring how time grows with leaves.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use secateur_model::{Foliage, FoliageError, LeafTriangle};

use crate::Random;

/// The shape and density of an [`ellipsoid_crown`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsoidCrown {
    /// Half the crown's extent along x, y and z, in metres.
    pub semi_axes_m: DVec3,
    /// The area of all leaves over the area of the crown's outline.
    pub layers: f64,
}

impl Default for EllipsoidCrown {
    fn default() -> Self {
        Self {
            semi_axes_m: DVec3::new(3.2, 3.6, 3.2),
            layers: 6.0,
        }
    }
}

impl EllipsoidCrown {
    /// The area of the crown's outline in square metres, as the mean of its
    /// views along x, y and z: pi (ab + bc + ca) / 3.
    pub fn outline_area_m2(&self) -> f64 {
        let DVec3 { x, y, z } = self.semi_axes_m;
        PI * (x * y + y * z + z * x) / 3.0
    }

    /// The side of a leaf, a square, in metres: `s` with
    /// `leaves * s^2 = layers * outline area`.
    ///
    /// Crowns of any number of leaves are so equally dense: a ray meets as many
    /// leaves in each. Turned at random, a leaf shows half of its area on
    /// average, so that is `layers / 2` over the whole outline.
    pub fn leaf_side_m(&self, leaves: u32) -> f64 {
        libm::sqrt(self.layers * self.outline_area_m2() / f64::from(leaves.max(1)))
    }
}

/// A crown of `leaves` square leaves about the origin, without texture.
///
/// Leaves are turned at random. Their centres lie in the ellipsoid at the
/// relative radius `u^(1/6)`, `u` evenly spread over 0..1, where an even
/// filling would have `u^(1/3)`: half of them in the outer 11 % of the radius.
///
/// # Errors
/// [`FoliageError`] for more leaves than a foliage can hold, or a crown that is
/// not finite.
pub fn ellipsoid_crown(
    leaves: u32,
    seed: u64,
    crown: &EllipsoidCrown,
) -> Result<Foliage, FoliageError> {
    let mut random = Random::new(seed);
    let mut foliage = Foliage::default();
    let half_side_m = 0.5 * crown.leaf_side_m(leaves);
    for _ in 0..leaves {
        let radius = libm::cbrt(libm::sqrt(random.unit()));
        let centre = direction(&mut random) * radius * crown.semi_axes_m;
        let [right, up] = tangents(&mut random);
        foliage.push_leaf(&square(centre, right * half_side_m, up * half_side_m), None)?;
    }
    Ok(foliage)
}

/// A unit vector, evenly spread over the sphere (Archimedes: z is even).
fn direction(random: &mut Random) -> DVec3 {
    let z = random.between(-1.0, 1.0);
    let across = libm::sqrt(1.0 - z * z);
    let (sin, cos) = libm::sincos(TAU * random.unit());
    DVec3::new(across * cos, across * sin, z)
}

/// Two unit vectors at right angles that span a plane turned at random.
fn tangents(random: &mut Random) -> [DVec3; 2] {
    let facing = direction(random);
    let first = facing.any_orthonormal_vector();
    let second = facing.cross(first);
    let (sin, cos) = libm::sincos(TAU * random.unit());
    [first * cos + second * sin, second * cos - first * sin]
}

fn square(centre: DVec3, right: DVec3, up: DVec3) -> [LeafTriangle; 2] {
    let corners = [
        (centre - right - up, DVec2::new(0.0, 1.0)),
        (centre + right - up, DVec2::new(1.0, 1.0)),
        (centre + right + up, DVec2::new(1.0, 0.0)),
        (centre - right + up, DVec2::new(0.0, 0.0)),
    ];
    [[0, 1, 2], [0, 2, 3]].map(|triangle: [usize; 3]| LeafTriangle {
        corners: triangle.map(|i| corners[i].0),
        uvs: triangle.map(|i| corners[i].1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowns_of_any_count_have_the_same_leaf_area() {
        let crown = EllipsoidCrown::default();
        for leaves in [1, 50, 2000] {
            let foliage = ellipsoid_crown(leaves, 3, &crown).unwrap();
            assert_eq!(foliage.leaves().len(), leaves as usize);
            let area: f64 = foliage.leaves().iter().map(|leaf| leaf.area()).sum();
            let layers = area / crown.outline_area_m2();
            assert!((layers - 6.0).abs() < 1e-9, "{layers} layers");
        }
        assert!(ellipsoid_crown(0, 3, &crown).unwrap().leaves().is_empty());
    }

    #[test]
    fn half_of_the_leaves_are_in_the_outer_shell() {
        let crown = EllipsoidCrown::default();
        let foliage = ellipsoid_crown(2000, 3, &crown).unwrap();
        let radii = foliage.leaves().iter();
        let radii = radii.map(|leaf| (leaf.centre() / crown.semi_axes_m).length());
        let radii: Vec<f64> = radii.collect();
        assert!(radii.iter().all(|&r| r <= 1.0 + 1e-12));
        // The median of u^(1/6) is 0.5^(1/6) = 0.891; four deviations of 2000
        // draws are 89.
        let outer = radii
            .iter()
            .filter(|&&r| r > 0.5f64.powf(1.0 / 6.0))
            .count();
        assert!(outer.abs_diff(1000) < 90, "{outer} outside");
    }

    #[test]
    fn a_crown_that_is_not_finite_is_refused() {
        let crown = EllipsoidCrown {
            semi_axes_m: DVec3::new(1.0, f64::NAN, 1.0),
            ..EllipsoidCrown::default()
        };
        assert!(matches!(
            ellipsoid_crown(4, 0, &crown),
            Err(FoliageError::NotFinite(_))
        ));
    }
}
