//! The woods of a walk, and the path of its camera.

use glam::{DMat4, DVec3};
use secateur_eval::StandCamera;
use secateur_plant::{Random, Species};

/// A plant that stands in the woods many times.
pub(super) struct Kind {
    pub(super) species: Species,
    pub(super) leaves: u32,
}

/// The seed of plants and of where they stand.
pub(super) const SEED: u64 = 7;

/// The kinds of plants of L-plants' woods: an oak, and a palmetto below it.
pub(super) const KINDS: [Kind; 2] = [
    Kind {
        species: Species::Oak,
        leaves: 1000,
    },
    Kind {
        species: Species::Palmetto,
        leaves: 300,
    },
];
const OAK: usize = 0;
const PALMETTO: usize = 1;

/// Where levels begin, in metres from the eye to the middle of a plant: ranges are the user's to choose in L-plants,
/// and the same for both schemes.
pub(super) const RANGES_M: [f64; 4] = [8.0, 16.0, 24.0, 32.0];

/// Frames on the path, straight ahead.
pub(super) const PATH_FRAMES: usize = 48;
/// Frames at its end, in which the camera turns half way round.
pub(super) const TURN_FRAMES: usize = 12;
pub(super) const FRAMES: usize = PATH_FRAMES + TURN_FRAMES;

/// Metres from one frame to the next.
const STEP_M: f64 = 0.5;
/// Eyes above the ground, in metres.
const EYE_M: f64 = 1.7;

/// The middle of the path at the height of eyes, from which the panorama is seen.
pub(super) const MIDDLE: DVec3 = DVec3::new(0.0, EYE_M, -0.5 * STEP_M * (PATH_FRAMES - 1) as f64);

/// Where one of the plants stands.
pub(super) struct Spot {
    /// The kind of plant, as an index in [`KINDS`].
    pub(super) kind: usize,
    pub(super) world_from_own: DMat4,
    /// Whether it stands beyond the last range from everywhere on the path.
    pub(super) is_backdrop: bool,
}

/// Oaks and palmettos in rows along both sides of the path, and oaks about them far off.
pub(super) fn spots() -> Vec<Spot> {
    let mut random = Random::new(SEED);
    let mut spot = |kind, x: f64, z: f64, is_backdrop| {
        let mut shift = || random.between(-1.0, 1.0);
        let place = DVec3::new(x + shift(), 0.0, z + shift());
        let turn = DMat4::from_rotation_y(std::f64::consts::PI * shift());
        Spot {
            kind,
            world_from_own: DMat4::from_translation(place) * turn,
            is_backdrop,
        }
    };
    let mut spots = Vec::new();
    for row in 0..8 {
        for side in [-1.0, 1.0] {
            let row = f64::from(row);
            spots.push(spot(OAK, 7.0 * side, 2.0 - 5.0 * row, false));
            spots.push(spot(PALMETTO, 3.5 * side, -1.0 - 4.0 * row, false));
        }
    }
    for k in 0..BACKDROP {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(BACKDROP)).sin_cos();
        let at = MIDDLE + BACKDROP_M * DVec3::new(sin, 0.0, cos);
        spots.push(spot(OAK, at.x, at.z, true));
    }
    spots
}

/// How many oaks stand about the woods, and how far from its middle, in metres.
const BACKDROP: u32 = 40;
const BACKDROP_M: f64 = 52.0;

/// Whether a frame is one of those in which the camera turns.
pub(super) fn is_turn(frame: usize) -> bool {
    frame >= PATH_FRAMES
}

/// The camera of a frame: 60 degrees high, 16 by 9.
pub(super) fn camera(frame: usize) -> StandCamera {
    let steps = frame.min(PATH_FRAMES - 1);
    let turned = (frame - steps) as f64 / TURN_FRAMES as f64;
    let (sin, cos) = (std::f64::consts::PI * turned).sin_cos();
    StandCamera {
        eye: DVec3::new(0.0, EYE_M, -STEP_M * steps as f64),
        forward: DVec3::new(sin, 0.0, -cos),
        up: DVec3::Y,
        tan_half_fov_y: (30.0_f64).to_radians().tan(),
        aspect: 16.0 / 9.0,
        near: 0.1,
    }
}

/// Whether some of a sphere may be in the picture of a camera that looks along the ground.
pub(super) fn is_in_view(camera: &StandCamera, centre: DVec3, radius: f64) -> bool {
    let right = camera.forward.cross(camera.up);
    let to = centre - camera.eye;
    let ahead = to.dot(camera.forward);
    let is_within = |aside: f64, tangent: f64| {
        aside.abs() <= ahead * tangent + radius * (1.0 + tangent * tangent).sqrt()
    };
    is_within(to.dot(right), camera.tan_half_fov_y * camera.aspect)
        && is_within(to.dot(camera.up), camera.tan_half_fov_y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_backdrop_is_beyond_the_last_range_from_everywhere() {
        let spots = spots();
        for frame in 0..FRAMES {
            let eye = camera(frame).eye;
            for spot in spots.iter().filter(|spot| spot.is_backdrop) {
                let at = spot.world_from_own.transform_point3(DVec3::ZERO);
                assert!(at.distance(eye) > RANGES_M[3] + 1.0);
            }
        }
    }

    /// Half a metre a frame ahead, then half way round where the path ends.
    #[test]
    fn the_path_goes_ahead_and_then_turns() {
        assert_eq!(camera(2).eye - camera(1).eye, DVec3::new(0.0, 0.0, -STEP_M));
        assert_eq!(camera(FRAMES - 1).eye, camera(PATH_FRAMES - 1).eye);
        assert!(camera(FRAMES - 1).forward.abs_diff_eq(DVec3::Z, 1e-12));
        assert_eq!(
            (is_turn(PATH_FRAMES - 1), is_turn(PATH_FRAMES)),
            (false, true)
        );
    }

    /// From the origin along -z, 60 degrees high: at 10 m half the height is 5.77 m.
    #[test]
    fn a_sphere_is_in_view_where_it_reaches_into_the_picture() {
        let seen = StandCamera {
            eye: DVec3::ZERO,
            ..camera(0)
        };
        let at = |x, y, z| is_in_view(&seen, DVec3::new(x, y, z), 1.0);
        assert!(at(0.0, 6.8, -10.0) && !at(0.0, 7.0, -10.0));
        assert!(at(11.6, 0.0, -10.0) && !at(11.8, 0.0, -10.0));
        assert!(!at(0.0, 0.0, 2.1) && at(0.0, 0.0, 0.5));
    }
}
