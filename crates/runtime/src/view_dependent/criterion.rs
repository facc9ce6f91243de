//! Where detail is wanted.
//!
//! The model does not care (Remolar et al., WSCG 2003, section 5.1.1): a criterion is whatever says
//! of a region whether it needs detail. Those here want detail wherever any point of a region does,
//! so that with a region every larger one wants it: what a refinement ends in then depends on the
//! criterion only, not on the level that it came from.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Region;

/// Says where detail is wanted.
pub trait Criterion {
    /// Whether a region needs detail.
    fn wants_detail(&mut self, region: &Region) -> bool;

    /// Whether all regions need detail that hold one which does. Else what lies below each leaf in
    /// the zone of interest is searched, at every refinement.
    fn is_nested(&self) -> bool {
        false
    }
}

impl<F: FnMut(&Region) -> bool> Criterion for F {
    fn wants_detail(&mut self, region: &Region) -> bool {
        self(region)
    }
}

/// Detail within a sphere, such as all that is within a distance of an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InSphere {
    /// World-space centre, or eye.
    pub centre: DVec3,
    /// The sphere's radius in world units.
    pub radius: f64,
}

impl Criterion for InSphere {
    #[inline]
    fn wants_detail(&mut self, region: &Region) -> bool {
        let reach = self.radius + region.radius;
        region.centre.distance_squared(self.centre) <= reach * reach
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// Detail outside a sphere: the middle of a crown, which hardly shows, is coarse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutsideSphere {
    /// World-space centre of the sphere.
    pub centre: DVec3,
    /// The sphere's radius in world units.
    pub radius: f64,
}

impl Criterion for OutsideSphere {
    #[inline]
    fn wants_detail(&mut self, region: &Region) -> bool {
        let within = self.radius - region.radius;
        within < 0.0 || region.centre.distance_squared(self.centre) > within * within
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// Detail on one side of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InFrontOf {
    /// A point of the plane.
    pub point: DVec3,
    /// Of length 1, towards the side of detail.
    pub normal: DVec3,
}

impl Criterion for InFrontOf {
    #[inline]
    fn wants_detail(&mut self, region: &Region) -> bool {
        (region.centre - self.point).dot(self.normal) >= -region.radius
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// Detail in what a camera sees: in front of all of its planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InFrustum {
    planes: [InFrontOf; 5],
}

impl InFrustum {
    /// Of a camera that looks from `eye` along `forward` with `up` upwards, by the tangents of half
    /// its horizontal and vertical field of view.
    pub fn new(eye: DVec3, forward: DVec3, up: DVec3, half_tangents: [f64; 2]) -> Self {
        let forward = forward.normalize_or_zero();
        let right = forward.cross(up).normalize_or_zero();
        let up = right.cross(forward);
        let [x, y] = half_tangents;
        let side = |across: DVec3, tangent: f64| InFrontOf {
            point: eye,
            normal: (across + tangent * forward).normalize_or_zero(),
        };
        let ahead = InFrontOf {
            point: eye,
            normal: forward,
        };
        Self {
            planes: [
                side(right, x),
                side(-right, x),
                side(up, y),
                side(-up, y),
                ahead,
            ],
        }
    }
}

impl Criterion for InFrustum {
    #[inline]
    fn wants_detail(&mut self, region: &Region) -> bool {
        self.planes.iter_mut().all(|p| p.wants_detail(region))
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// Detail where what a leaf stands for would show as more than a number of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargerThan {
    /// From where it is seen.
    pub eye: DVec3,
    /// Half the screen's height in pixels over the tangent of half its field of view.
    pub pixels_at_unit_distance: f64,
    /// The radius that needs no detail yet.
    pub radius_px: f64,
}

impl Criterion for LargerThan {
    #[inline]
    fn wants_detail(&mut self, region: &Region) -> bool {
        let distance = region.centre.distance(self.eye) - region.radius;
        distance <= 0.0 || region.radius * self.pixels_at_unit_distance > self.radius_px * distance
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// The number of directions around the line of sight in which the outline is known.
const DIRECTIONS: usize = 64;

/// Detail near the outline of a crown, as an eye sees it from far.
#[derive(Clone, Debug, PartialEq)]
pub struct OnSilhouette {
    centre: DVec3,
    right: DVec3,
    up: DVec3,
    /// How far the crown reaches from the line of sight through its centre, in each direction.
    reach: [f64; DIRECTIONS],
    share: f64,
}

impl OnSilhouette {
    /// Of a crown of these regions about `centre`; what reaches `share` of the way from the line of
    /// sight to the outline is near it.
    pub fn new(eye: DVec3, centre: DVec3, crown: &[Region], share: f64) -> Self {
        let forward = (centre - eye).normalize_or(DVec3::NEG_Z);
        let right = forward.any_orthonormal_vector();
        let mut silhouette = Self {
            centre,
            right,
            up: right.cross(forward),
            reach: [0.0; DIRECTIONS],
            share,
        };
        for region in crown {
            let (x, y) = silhouette.across(region);
            let reach = &mut silhouette.reach[direction(y.atan2(x))];
            *reach = reach.max(x.hypot(y));
        }
        silhouette
    }

    fn across(&self, region: &Region) -> (f64, f64) {
        let from = region.centre - self.centre;
        (from.dot(self.right), from.dot(self.up))
    }
}

/// The direction of an angle.
fn direction(angle: f64) -> usize {
    ((angle / TAU).rem_euclid(1.0) * DIRECTIONS as f64) as usize % DIRECTIONS
}

impl Criterion for OnSilhouette {
    fn wants_detail(&mut self, region: &Region) -> bool {
        let (x, y) = self.across(region);
        let far = x.hypot(y);
        let least = match region.radius < far {
            false => self.reach.iter().copied().fold(f64::INFINITY, f64::min),
            true => {
                let (angle, half) = (y.atan2(x), (region.radius / far).asin());
                let first = direction(angle - half);
                let count = (half / TAU * 2.0 * DIRECTIONS as f64) as usize + 2;
                let covered = (0..count.min(DIRECTIONS)).map(|k| (first + k) % DIRECTIONS);
                covered.map(|k| self.reach[k]).fold(f64::INFINITY, f64::min)
            }
        };
        far + region.radius >= self.share * least
    }

    fn is_nested(&self) -> bool {
        true
    }
}

/// Detail where both want it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Both<A, B>(pub A, pub B);

impl<A: Criterion, B: Criterion> Criterion for Both<A, B> {
    fn wants_detail(&mut self, region: &Region) -> bool {
        self.0.wants_detail(region) && self.1.wants_detail(region)
    }

    fn is_nested(&self) -> bool {
        self.0.is_nested() && self.1.is_nested()
    }
}
