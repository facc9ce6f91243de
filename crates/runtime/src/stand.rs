//! A stand of trees: instances of one plant, those that a camera sees, and how much detail each needs.
//!
//! A renderer asks once a frame. What it draws each instance with is its own affair:
//! [`prefix_buffers`](crate::prefix_buffers), [`view_dependent`](crate::view_dependent),
//! boxes about leaves, or meshes of levels; the example `forest` of `secateur-levels` has all of them.

use glam::DVec3;
use secateur_model::{BoundingSphere, LodModel};

use crate::Screen;
use crate::view_dependent::{Criterion as _, InFrustum, Region};

/// Where a plant stands. It grows upwards, along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Where the origin of the plant's own space is, in world space.
    pub position: DVec3,
    /// By how much it is turned about its upright axis, in radians, from z towards x.
    pub yaw: f64,
    /// By what its lengths are multiplied.
    pub scale: f64,
}

impl Instance {
    /// A point of the plant's own space in world space.
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        self.position + self.scale * turned(point, self.yaw)
    }

    /// A point of world space in the plant's own.
    pub fn to_own(&self, point: DVec3) -> DVec3 {
        turned(point - self.position, -self.yaw) / self.scale
    }

    /// A direction of world space in the plant's own.
    pub fn direction_to_own(&self, direction: DVec3) -> DVec3 {
        turned(direction, -self.yaw)
    }
}

/// A point turned about the y axis.
fn turned(point: DVec3, yaw: f64) -> DVec3 {
    let (sin, cos) = yaw.sin_cos();
    DVec3::new(
        cos * point.x + sin * point.z,
        point.y,
        cos * point.z - sin * point.x,
    )
}

/// A camera in a stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandCamera {
    /// Its place in world space.
    pub eye: DVec3,
    /// The direction in which the camera looks.
    pub forward: DVec3,
    /// Its height in pixels and its vertical field of view.
    pub screen: Screen,
    /// Its width over its height.
    pub aspect: f64,
}

impl StandCamera {
    /// The tangents of half its fields of view, horizontal and vertical.
    pub fn half_tangents(&self) -> [f64; 2] {
        let vertical = (self.screen.field_of_view_degrees.to_radians() / 2.0).tan();
        [vertical * self.aspect, vertical]
    }

    /// What it sees, y upwards.
    pub fn frustum(&self) -> InFrustum {
        InFrustum::new(self.eye, self.forward, DVec3::Y, self.half_tangents())
    }
}

/// An instance that a camera may see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Its place in the list of instances.
    pub index: usize,
    /// From the eye to the middle of the plant, in world units.
    pub distance: f64,
    /// How many pixels high its bounding sphere shows there.
    pub pixels_high: f64,
}

/// The instances whose bounding spheres reach into what a camera sees, the nearest first. `sphere` is
/// that of the plant, in its own space.
pub fn seen(instances: &[Instance], sphere: BoundingSphere, camera: &StandCamera) -> Vec<Seen> {
    let mut frustum = camera.frustum();
    let mut seen: Vec<Seen> = instances
        .iter()
        .enumerate()
        .filter_map(|(index, instance)| {
            let region = Region {
                centre: instance.to_world(sphere.centre),
                radius: instance.scale * sphere.radius,
            };
            let distance = region.centre.distance(camera.eye);
            let pixels_high = camera.screen.pixels_high(
                2.0 * region.radius,
                distance.max(region.radius.max(f64::MIN_POSITIVE)),
            );
            frustum.wants_detail(&region).then_some(Seen {
                index,
                distance,
                pixels_high,
            })
        })
        .collect();
    seen.sort_by(|a, b| {
        a.distance
            .total_cmp(&b.distance)
            .then(a.index.cmp(&b.index))
    });
    seen
}

/// How many leaves a plant needs at a height on the screen: a number for each pixel of a square of
/// that side, since that is how its picture grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeavesByHeight {
    /// Leaves for each pixel of the square.
    pub leaves_a_px2: f64,
    /// However small it is shown.
    pub fewest: usize,
}

impl LeavesByHeight {
    /// The number for a plant of this many leaves.
    pub fn leaves(&self, pixels_high: f64, most: usize) -> usize {
        let wanted = self.leaves_a_px2 * pixels_high * pixels_high;
        let wanted = wanted.min(most as f64) as usize;
        wanted.max(self.fewest).min(most)
    }
}

/// Why a stand cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StandError {
    /// The plant has one level only.
    #[error(
        "the instances have no levels: the removal order of their plant ({leaves} leaves) has no step; simplify the plant to fewer leaves"
    )]
    NoLevels {
        /// Leaves of the plant.
        leaves: usize,
    },
    /// An instance that stands nowhere or has no size.
    #[error("instance {0} has a position, turn or scale that is not a finite number, or no size")]
    NotPlaced(usize),
}

/// Checks that instances can be drawn at levels of a model.
///
/// # Errors
/// [`StandError`]: the first thing that is wrong.
pub fn check(instances: &[Instance], model: &LodModel) -> Result<(), StandError> {
    if model.order().is_empty() {
        return Err(StandError::NoLevels {
            leaves: model.most_leaves(),
        });
    }
    let is_placed = |instance: &Instance| {
        instance.position.is_finite()
            && instance.yaw.is_finite()
            && instance.scale.is_finite()
            && instance.scale > 0.0
    };
    match instances.iter().position(|instance| !is_placed(instance)) {
        Some(index) => Err(StandError::NotPlaced(index)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use secateur_model::{LeafId, RemovalOrder};
    use secateur_plant::{EllipsoidCrown, ellipsoid_crown};

    use super::*;

    fn at(position: DVec3) -> Instance {
        Instance {
            position,
            yaw: 0.0,
            scale: 1.0,
        }
    }

    /// Looks along -z, 90 degrees wide and high, 100 pixels.
    fn camera() -> StandCamera {
        StandCamera {
            eye: DVec3::ZERO,
            forward: DVec3::NEG_Z,
            screen: Screen {
                height_px: 100.0,
                field_of_view_degrees: 90.0,
            },
            aspect: 1.0,
        }
    }

    #[test]
    fn a_quarter_turn_takes_z_to_x_and_back() {
        let instance = Instance {
            position: DVec3::new(1.0, 2.0, 3.0),
            yaw: FRAC_PI_2,
            scale: 2.0,
        };
        let there = instance.to_world(DVec3::Z);
        assert!(there.distance(DVec3::new(3.0, 2.0, 3.0)) < 1e-12);
        assert!(instance.to_own(there).distance(DVec3::Z) < 1e-12);
        assert!(instance.direction_to_own(DVec3::X).distance(DVec3::Z) < 1e-12);
    }

    #[test]
    fn what_is_beside_or_behind_is_not_seen_and_the_nearest_comes_first() {
        let sphere = BoundingSphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        };
        let instances = [
            at(DVec3::new(0.0, 0.0, -20.0)),
            at(DVec3::new(0.0, 0.0, 5.0)),
            at(DVec3::new(0.0, 0.0, -10.0)),
            // Its middle is outside, its side is not: the plane is at 45 degrees.
            at(DVec3::new(11.0, 0.0, -10.0)),
            at(DVec3::new(12.0, 0.0, -10.0)),
        ];
        let seen = seen(&instances, sphere, &camera());
        let indices: Vec<usize> = seen.iter().map(|s| s.index).collect();
        assert_eq!(indices, [2, 3, 0]);
        // 2 m of the 20 m that 100 pixels show at a distance of 10 m.
        assert!((seen[0].pixels_high - 10.0).abs() < 1e-9);
    }

    #[test]
    fn leaves_grow_with_the_square_of_the_height() {
        let rule = LeavesByHeight {
            leaves_a_px2: 0.5,
            fewest: 8,
        };
        let found = [2.0, 10.0, 20.0, 1e9].map(|px| rule.leaves(px, 1000));
        assert_eq!(found, [8, 50, 200, 1000]);
        assert_eq!(rule.leaves(2.0, 5), 5, "a plant of fewer leaves");
    }

    #[test]
    fn instances_without_levels_and_without_a_place_are_refused() {
        let crown = ellipsoid_crown(4, 1, &EllipsoidCrown::default()).unwrap();
        let mut order = RemovalOrder::new(4);
        let model = LodModel::new(order.clone(), &crown).unwrap();
        let error = check(&[at(DVec3::ZERO)], &model).unwrap_err();
        assert_eq!(error, StandError::NoLevels { leaves: 4 });
        order.push(LeafId::from_index(0), &[]);
        let model = LodModel::new(order, &crown).unwrap();
        let mut instances = [at(DVec3::ZERO); 3];
        assert_eq!(check(&instances, &model), Ok(()));
        instances[2].scale = 0.0;
        assert_eq!(check(&instances, &model), Err(StandError::NotPlaced(2)));
        instances[1].position.x = f64::NAN;
        assert_eq!(check(&instances, &model), Err(StandError::NotPlaced(1)));
    }
}
