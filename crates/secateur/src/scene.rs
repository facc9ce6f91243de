//! The views of a scene's cameras.

use secateur_gltf::SceneCamera;
use secateur_raster::{View, ViewError, ViewSet};

/// The driving views of a scene's cameras, such as [`Document::cameras`](crate::Document::cameras)
/// reads them.
///
/// A camera of weight n is n equal views: so it counts n times in every sum, exactly. What all
/// weights share is divided out. Mutual information is what a leaf tells about the view that it is
/// seen from; one view alone has none. So a camera that stands alone gets a view of nothing beside
/// it, which is the same but for its near plane: then what counts is how much foliage shows.
///
/// # Errors
/// [`ViewError`] if a camera is none.
pub fn scene_views(cameras: &[SceneCamera]) -> Result<ViewSet, ViewError> {
    let shared = cameras
        .iter()
        .fold(0, |shared, camera| greatest_divisor(shared, camera.weight));
    let mut views: Vec<View> = Vec::new();
    for camera in cameras {
        let weight = camera.weight / shared.max(1);
        let view = view_of(camera, camera.near)?;
        views.extend(std::iter::repeat_n(view, weight as usize));
    }
    if let [first, rest @ ..] = &views[..]
        && rest.iter().all(|view| view == first)
    {
        let of_nothing = view_of(&cameras[0], BEYOND_ALL)?;
        views.truncate(1);
        views.push(of_nothing);
    }
    Ok(ViewSet::new(views))
}

/// A near distance that nothing is beyond: a plant is at most 1e30 large, and 1e9 times that away.
const BEYOND_ALL: f64 = 1e45;

fn view_of(camera: &SceneCamera, near: f64) -> Result<View, ViewError> {
    // Far enough that the eye's own coordinates do not round the direction away.
    let far = camera.eye.abs().max_element().max(1.0);
    let target = camera.eye + far * camera.forward;
    View::look_at(camera.eye, target, camera.up, camera.tan_half_fov, near)
}

fn greatest_divisor(a: u32, b: u32) -> u32 {
    match b {
        0 => a,
        b => greatest_divisor(b, a % b),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn camera(x: f64, weight: u32) -> SceneCamera {
        SceneCamera {
            eye: DVec3::X * x,
            forward: DVec3::NEG_Z,
            up: DVec3::Y,
            tan_half_fov: 1.0,
            aspect: None,
            near: 0.1,
            weight,
        }
    }

    fn eyes(cameras: &[SceneCamera]) -> Vec<f64> {
        let views = scene_views(cameras).unwrap();
        views.views().iter().map(|view| view.eye().x).collect()
    }

    #[test]
    fn a_weight_is_met_by_equal_views() {
        assert_eq!(eyes(&[camera(1.0, 2), camera(2.0, 1)]), [1.0, 1.0, 2.0]);
        // All alike is once each, and 4 to 6 is 2 to 3.
        assert_eq!(eyes(&[camera(1.0, 7), camera(2.0, 7)]), [1.0, 2.0]);
        assert_eq!(
            eyes(&[camera(1.0, 4), camera(2.0, 6)]),
            [1.0, 1.0, 2.0, 2.0, 2.0]
        );
    }

    #[test]
    fn a_camera_alone_is_told_from_one_that_sees_nothing() {
        for alone in [&[camera(3.0, 5)][..], &[camera(3.0, 1), camera(3.0, 2)]] {
            let views = scene_views(alone).unwrap();
            let [one, other] = views.views() else {
                panic!("{} views", views.len());
            };
            assert_eq!([one.near(), other.near()], [0.1, BEYOND_ALL]);
        }
    }
}
