//! From where a scene sees a plant, and what stands before it.

use secateur_model::{BoundingSphere, Surface};
use secateur_raster::{View, ViewSet};

/// Levels are judged from at most this many cameras of a scene, spread evenly over their list.
const MOST_CAMERAS: usize = 12;

/// A camera nearer to the centre than this many radii stands in the crown: it sees what it sees.
const LEAST_RADII: f64 = 1.05;

/// A scene about a plant, as its levels are judged in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneLook {
    /// From where the plant is seen; from all around where there is none.
    pub cameras: Option<ViewSet>,
    /// What stands about it and is no part of it, in the plant's world space.
    pub obstacles: Vec<Surface>,
}

/// The cameras that see a sphere, each once, turned to its middle and as narrow as holds it.
pub(super) fn tight_cameras(cameras: &ViewSet, sphere: BoundingSphere) -> Vec<View> {
    let mut views: Vec<View> = Vec::new();
    for view in cameras.views().iter().filter_map(|v| tight(v, sphere)) {
        if !views.contains(&view) {
            views.push(view);
        }
    }
    let count = views.len().min(MOST_CAMERAS);
    (0..count).map(|k| views[k * views.len() / count]).collect()
}

fn tight(camera: &View, sphere: BoundingSphere) -> Option<View> {
    let away = sphere.centre - camera.eye();
    let distance = away.length();
    if distance < LEAST_RADII * sphere.radius {
        return Some(*camera);
    }
    // The corner of a picture is the farthest from its middle.
    let corner = (std::f64::consts::SQRT_2 * camera.tan_half_fov()).atan();
    let half_width = (sphere.radius / distance).asin();
    let aside = camera.forward().angle_between(away);
    if camera.near() >= distance + sphere.radius || aside - half_width >= corner {
        return None;
    }
    let tangent = half_width.tan();
    let up = camera.up();
    let turned = View::look_at(camera.eye(), sphere.centre, up, tangent, camera.near());
    Some(turned.unwrap_or(*camera))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const UNIT: BoundingSphere = BoundingSphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    };

    fn camera(eye: DVec3, target: DVec3) -> View {
        View::look_at(eye, target, DVec3::Y, 0.5, 0.1).unwrap()
    }

    #[test]
    fn cameras_turn_to_the_plant_and_those_that_do_not_see_it_are_left_out() {
        let aside = camera(DVec3::Z * 5.0, DVec3::new(1.0, 0.0, 0.0));
        let away = camera(DVec3::Z * 5.0, DVec3::Z * 9.0);
        let behind = View::look_at(DVec3::X * 5.0, DVec3::ZERO, DVec3::Y, 0.5, 6.5).unwrap();
        let within = camera(DVec3::Z * 0.5, DVec3::X);
        let all = ViewSet::new(vec![aside, away, aside, behind, within]);
        let [turned, inside] = tight_cameras(&all, UNIT)[..] else {
            panic!("two see it, one of them twice over");
        };
        assert_eq!(turned.eye(), DVec3::Z * 5.0);
        assert!((turned.forward() - DVec3::NEG_Z).length() < 1e-12);
        // A sphere of radius 1 seen from 5: sine 1/5, tangent 1 / sqrt 24.
        assert!((turned.tan_half_fov() - 24f64.sqrt().recip()).abs() < 1e-12);
        assert_eq!(inside, within);
    }

    #[test]
    fn of_a_long_path_some_cameras_are_taken_from_all_along_it() {
        let path = (0..48).map(|k| camera(DVec3::new(f64::from(k), 0.0, 9.0), DVec3::ZERO));
        let found = tight_cameras(&ViewSet::new(path.collect()), UNIT);
        let xs: Vec<f64> = found.iter().map(|view| view.eye().x).collect();
        assert_eq!(xs, (0..12).map(|k| f64::from(4 * k)).collect::<Vec<_>>());
    }
}
