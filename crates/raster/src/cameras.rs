//! One's own cameras, from a JSON file.

use std::io::Read;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use crate::{View, ViewError, ViewSet};

/// A megabyte holds thousands of cameras; VDS wants tens.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// A camera file is not what it should be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct CamerasError {
    /// The file, or what else errors should call it.
    pub file: String,
    /// What is wrong, and where.
    pub reason: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    cameras: Vec<Camera>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Camera {
    eye: [f64; 3],
    target: [f64; 3],
    up: Option<[f64; 3]>,
    fov_y_degrees: Option<f64>,
    near: Option<f64>,
}

/// Reads cameras from a JSON file:
///
/// ```json
/// {"cameras": [{"eye": [0, 2, 9], "target": [0, 2, 0]},
///              {"eye": [9, 2, 0], "target": [0, 2, 0],
///               "up": [0, 1, 0], "fov_y_degrees": 60, "near": 0.1}]}
/// ```
///
/// Positions in world units. Images are square, so `fov_y_degrees` (60) is the
/// field of view both ways. `up` is y, or z for cameras that look along y;
/// `near`, nearer than which nothing is seen, a twentieth of the way to the
/// target.
///
/// # Errors
/// [`CamerasError`] with the file's name, the camera and what is wrong.
pub fn read_cameras(path: &Path) -> Result<ViewSet, CamerasError> {
    let name = path.display().to_string();
    let failed = |reason: String| CamerasError {
        file: name.clone(),
        reason,
    };
    let mut text = String::new();
    let file = std::fs::File::open(path);
    file.and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_string(&mut text))
        .map_err(|e| failed(format!("the cameras cannot be read: {e}")))?;
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(failed("holds more than a megabyte of cameras".to_owned()));
    }
    cameras_from_json(&name, &text)
}

/// The cameras of a JSON text as [`read_cameras`] describes; `name` is what
/// errors call it.
///
/// # Errors
/// [`CamerasError`].
pub fn cameras_from_json(name: &str, text: &str) -> Result<ViewSet, CamerasError> {
    let failed = |reason: String| CamerasError {
        file: name.to_owned(),
        reason,
    };
    let file: CameraFile =
        serde_json::from_str(text).map_err(|e| failed(format!("is no list of cameras: {e}")))?;
    if file.cameras.is_empty() {
        return Err(failed("`cameras` is empty".to_owned()));
    }
    let view = |(index, camera): (usize, &Camera)| {
        view_of(camera).map_err(|e| failed(format!("cameras[{index}]: {e}")))
    };
    let views: Result<Vec<View>, CamerasError> =
        file.cameras.iter().enumerate().map(view).collect();
    Ok(ViewSet::new(views?))
}

fn view_of(camera: &Camera) -> Result<View, ViewError> {
    let [eye, target] = [camera.eye, camera.target].map(DVec3::from_array);
    let distance = (target - eye).length();
    let looks_along_y = (target - eye).y.abs() > 0.999 * distance;
    let default_up = if looks_along_y { DVec3::Z } else { DVec3::Y };
    let up = camera.up.map_or(default_up, DVec3::from_array);
    let fov_y_degrees = camera.fov_y_degrees.unwrap_or(60.0);
    let tan_half_fov = match fov_y_degrees {
        60.0 => View::TAN_30_DEGREES,
        // Not the platform's tangent: the same file is the same views everywhere.
        other if other > 0.0 && other < 180.0 => libm::tan(other.to_radians() / 2.0),
        other => return Err(ViewError::FieldOfView(other)),
    };
    if distance == 0.0 {
        return Err(ViewError::NoDirection);
    }
    View::look_at(
        eye,
        target,
        up,
        tan_half_fov,
        camera.near.unwrap_or(0.05 * distance),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(json: &str) -> String {
        cameras_from_json("c.json", json).unwrap_err().to_string()
    }

    #[test]
    fn defaults_are_those_of_the_built_in_sets() {
        let json = r#"{"cameras": [{"eye": [3, 0, 0], "target": [0, 0, 0]},
                                   {"eye": [0, 3, 0], "target": [0, 0, 0]}]}"#;
        let views = cameras_from_json("c.json", json).unwrap();
        let built_in = ViewSet::octahedron(secateur_model::BoundingSphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        });
        // The octahedron's views 0 and 2 stand at +x and +y, three radii away.
        assert_eq!(views.views()[0], built_in.views()[0]);
        assert_eq!(views.views()[1], built_in.views()[2]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        assert!(error("{").starts_with("c.json: is no list of cameras: EOF"));
        assert_eq!(error(r#"{"cameras": []}"#), "c.json: `cameras` is empty");
        let unknown = error(r#"{"cameras": [{"eye": [0,0,1], "target": [0,0,0], "fov": 3}]}"#);
        assert!(unknown.contains("unknown field `fov`"), "{unknown}");
        let flat = error(r#"{"cameras": [{"eye": [0,0,0], "target": [0,0,0]}]}"#);
        assert!(
            flat.starts_with("c.json: cameras[0]: a camera's eye, target"),
            "{flat}"
        );
        let wide =
            error(r#"{"cameras": [{"eye": [0,0,1], "target": [0,0,0], "fov_y_degrees": 180}]}"#);
        assert!(
            wide.contains("180 degrees is not between 0 and 180"),
            "{wide}"
        );
    }
}
