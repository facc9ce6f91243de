//! Over which frame FLIP is averaged.
//!
//! Mean FLIP depends on how much of a picture shows nothing but background: there two pictures are the
//! same. So that one number means one thing everywhere, it is always the mean over the frame of the
//! views that judge, 60 degrees from 3 radii of the leaves' bounding sphere, as [`Pictures::measure`] has it.
//! Pictures as narrow as just holds the whole plant show more of it in as many pixels. All that they
//! leave out is background, so the mean over the wider frame is theirs times the ratio of the areas.
//!
//! [`Pictures::measure`]: super::Pictures::measure

use secateur_model::BoundingSphere;

/// From how many radii the views that judge look.
const RADII: f64 = 3.0;

/// The square of the tangent of half of their field of view, 60 degrees.
const SQUARE_OF_JUDGES: f64 = 1.0 / 3.0;

/// The square of the tangent of half of the field of view that just holds the sphere from there.
const SQUARE_OF_TIGHT: f64 = 1.0 / (RADII * RADII - 1.0);

/// By what the mean of a picture that just holds the sphere of a plant is multiplied to be that over the
/// frame of the views that judge, which look at the sphere of its leaves: 3/8 where both are one. A plant
/// whose leaves are so small a part of it that the frame does not hold it keeps the mean that it has.
pub fn share_of_tight_frame(plant: BoundingSphere, leaves: BoundingSphere) -> f64 {
    let of_areas = (plant.radius / leaves.radius).powi(2);
    let share = SQUARE_OF_TIGHT / SQUARE_OF_JUDGES * of_areas;
    // All leaves may be one point.
    if share < 1.0 { share } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DVec3, Vec3};
    use secateur_model::{AlphaMode, Finish, Material, Surface};
    use secateur_raster::{View, ViewSet};

    use super::*;
    use crate::Pictures;

    /// Slats across a square whose corners lie on the unit sphere.
    fn slats(count: u32) -> Surface {
        let side = 2f64.sqrt();
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for k in 0..count {
            let low = -side / 2.0 + side * f64::from(k) / f64::from(count);
            let high = low + 0.5 * side / f64::from(count);
            let first = positions.len() as u32;
            for [x, y] in [[-0.5, low], [0.5, low], [0.5, high], [-0.5, high]] {
                positions.push(DVec3::new(x * side, y, 0.0));
            }
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        Surface {
            normals: vec![Vec3::Z; positions.len()],
            positions,
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles,
            material: Arc::new(Material {
                name: String::new(),
                base_color: [0.1, 0.3, 0.1, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    const UNIT: BoundingSphere = BoundingSphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    };

    fn sphere(radius: f64) -> BoundingSphere {
        BoundingSphere { radius, ..UNIT }
    }

    #[test]
    fn a_share_is_of_the_frame_of_the_views_that_judge() {
        let share = share_of_tight_frame(UNIT, UNIT);
        assert!((share - 0.375).abs() < 1e-12);
        let sets = ViewSet::held_out(UNIT);
        for view in sets.iter().flat_map(ViewSet::views) {
            let tight = (1.0 / view.eye().length()).asin().tan();
            let ratio = (tight / view.tan_half_fov()).powi(2);
            assert!((ratio - share).abs() < 1e-9, "{ratio}");
        }
        let of_larger = share_of_tight_frame(sphere(1.2), UNIT);
        assert!((of_larger / share - 1.44).abs() < 1e-12);
        for leaves in [0.1, 0.0] {
            assert_eq!(share_of_tight_frame(UNIT, sphere(leaves)), 1.0);
        }
    }

    /// Pictures of both frames say the same, if a pixel is as much of the plant in both and the mean of as many samples.
    #[test]
    fn tight_and_wide_pictures_agree() {
        let of = |tangent: f64, side: u32| {
            let view = View::look_at(DVec3::Z * RADII, DVec3::ZERO, DVec3::Y, tangent, 0.1);
            let views = [ViewSet::new(vec![view.unwrap()])];
            let [a, b] = [9, 11].map(|count| Pictures::of_size(&[slats(count)], &views, side));
            a.flips(&b)[0]
        };
        let wide = of(SQUARE_OF_JUDGES.sqrt(), 416);
        let tight = of(SQUARE_OF_TIGHT.sqrt(), 255) * share_of_tight_frame(UNIT, UNIT);
        assert!(
            wide > 0.01 && (tight / wide - 1.0).abs() < 0.03,
            "{tight} {wide}"
        );
    }
}
