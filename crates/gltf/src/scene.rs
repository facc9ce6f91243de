//! A scene about a plant: the cameras that see it, and what stands before it.

use glam::{DMat4, DVec3};
use serde_json::Value;

use super::camera_path::{MAX_VIEWS_OF_A_PATH, VIEWS_OF_A_PATH};
use super::error::{At, Fault, Problem};
use super::find::triangles_of_all;
use super::node::PlacedNode;
use super::property::{self, bad};
use super::{Document, GltfError};
use secateur_model::Foliage;

/// The largest weight of a camera.
pub const MAX_CAMERA_WEIGHT: u32 = 16;

/// The most cameras of a scene, each counted as often as it weighs.
pub const MAX_WEIGHED_CAMERAS: u32 = 1024;

/// A perspective camera of a scene, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCamera {
    /// Its position in world space.
    pub eye: DVec3,
    /// The direction of view, of length 1.
    pub forward: DVec3,
    /// The direction that is up in its picture, of length 1.
    pub up: DVec3,
    /// The tangent of half the larger of its two angles of view: the picture fits a square of this
    /// angle both ways. A camera without an aspect ratio is taken to be square.
    pub tan_half_fov: f64,
    /// Width of its picture over the height, where the camera says it.
    pub aspect: Option<f64>,
    /// Nothing nearer than this is seen, in world units along the view.
    pub near: f64,
    /// How often it counts: 1 to [`MAX_CAMERA_WEIGHT`].
    pub weight: u32,
}

impl Document {
    /// The perspective cameras of the scene, in depth-first order of their nodes.
    ///
    /// `extras.weight` of the node, or else of the camera, says how often it counts; it is rounded to
    /// 1 to [`MAX_CAMERA_WEIGHT`], and is 1 where nothing is said. Scales of nodes change
    /// no camera, and what lies beyond `zfar` is seen too.
    ///
    /// A camera that an animation moves, itself or a node above it, is a path: as many cameras as
    /// `extras.views` says ([`VIEWS_OF_A_PATH`] where nothing is said), each in the middle of an
    /// equal part of the time. The first animation that moves it counts.
    ///
    /// # Errors
    /// [`GltfError`] if there is none, one is orthographic, or its numbers make no camera.
    pub fn cameras(&self) -> Result<Vec<SceneCamera>, GltfError> {
        self.scene_cameras().map_err(|fault| self.error(fault))
    }

    /// All triangles of the scene, as what hides leaves: each connected piece is an item, with its
    /// alpha mask cut out as those of leaves are. May be empty.
    ///
    /// # Errors
    /// [`GltfError`] if the geometry can't be read or there is too much of it.
    pub fn occluders(&self) -> Result<Foliage, GltfError> {
        triangles_of_all(self).map_err(|fault| self.error(fault))
    }

    fn scene_cameras(&self) -> Result<Vec<SceneCamera>, Fault> {
        let mut found: Vec<(PlacedNode, Seeing)> = Vec::new();
        for node in self.placed_nodes()? {
            let place = || self.place("nodes", node.index);
            let json = property::entry(&self.root, "nodes", node.index)?;
            let Some(index) = property::index(json, "camera").at(place)? else {
                continue;
            };
            let camera = property::entry(&self.root, "cameras", index).at(place)?;
            let (tan_half_fov, aspect, near) = lens(camera).at(|| self.place("cameras", index))?;
            let of_camera = || self.place("cameras", index);
            let weight = match whole_of(json, "weight", MAX_CAMERA_WEIGHT).at(place)? {
                Some(weight) => Some(weight),
                None => whole_of(camera, "weight", MAX_CAMERA_WEIGHT).at(of_camera)?,
            };
            let views = match whole_of(json, "views", MAX_VIEWS_OF_A_PATH).at(place)? {
                Some(views) => Some(views),
                None => whole_of(camera, "views", MAX_VIEWS_OF_A_PATH).at(of_camera)?,
            };
            let seeing = Seeing {
                tan_half_fov,
                aspect,
                near,
                weight: weight.unwrap_or(1),
                views: views.unwrap_or(VIEWS_OF_A_PATH),
            };
            found.push((node, seeing));
        }
        if found.is_empty() {
            return Err(Problem::NoCamera.into());
        }
        let nodes: Vec<usize> = found.iter().map(|(node, _)| node.index).collect();
        let motions = self.motions(&nodes)?;
        let mut cameras = Vec::new();
        for (node, seeing) in found {
            let places = match motions.get(&node.index) {
                None => vec![node],
                Some(motion) => {
                    let mut places = Vec::new();
                    for poses in motion.poses(seeing.views) {
                        let all = self.posed_nodes(&poses)?;
                        places.extend(all.into_iter().find(|placed| placed.index == node.index));
                    }
                    places
                }
            };
            for placed in places {
                let camera = seeing.from(placed.world_from_node);
                cameras.push(camera.at(|| self.place("nodes", node.index))?);
            }
            let weighed: u32 = cameras.iter().map(|camera| camera.weight).sum();
            if weighed > MAX_WEIGHED_CAMERAS {
                return Err(Problem::TooMuch {
                    what: "cameras, each counted as often as it weighs",
                    limit: MAX_WEIGHED_CAMERAS.into(),
                }
                .into());
            }
        }
        Ok(cameras)
    }
}

/// What of a camera is the same wherever it stands.
struct Seeing {
    tan_half_fov: f64,
    aspect: Option<f64>,
    near: f64,
    weight: u32,
    /// How many views stand along its path, if it moves.
    views: u32,
}

impl Seeing {
    /// The camera of a node with this matrix: it looks along the node's -z, with y up.
    fn from(&self, world_from_node: DMat4) -> Result<SceneCamera, Problem> {
        let eye = world_from_node.transform_point3(DVec3::ZERO);
        let turned = |axis| direction(world_from_node.transform_vector3(axis));
        let (forward, up) = (turned(DVec3::NEG_Z), turned(DVec3::Y));
        let (Some(forward), Some(up), true) = (forward, up, eye.is_finite()) else {
            return Err(Problem::NoView);
        };
        if forward.cross(up).length() < 1e-9 {
            return Err(Problem::NoView);
        }
        Ok(SceneCamera {
            eye,
            forward,
            up,
            tan_half_fov: self.tan_half_fov,
            aspect: self.aspect,
            near: self.near,
            weight: self.weight,
        })
    }
}

/// A vector's direction. Scaled first, so that tiny and huge ones neither under- nor overflow.
fn direction(vector: DVec3) -> Option<DVec3> {
    let scaled = vector / vector.abs().max_element();
    let unit = scaled / scaled.length();
    unit.is_finite().then_some(unit)
}

/// The tangent of half the larger angle of view, the aspect ratio, and the near distance.
fn lens(camera: &Value) -> Result<(f64, Option<f64>, f64), Problem> {
    match property::text(camera, "type")? {
        Some("perspective") => {}
        Some("orthographic") => return Err(Problem::Orthographic),
        Some(_) => return Err(bad("type", "\"perspective\"", &camera["type"])),
        None => return Err(Problem::Missing("type")),
    }
    let perspective = camera
        .get("perspective")
        .ok_or(Problem::Missing("perspective"))?;
    let number =
        |name, expected, is_right: fn(f64) -> bool| match property::number(perspective, name)? {
            Some(number) if !is_right(number) => Err(bad(name, expected, &perspective[name])),
            found => Ok(found),
        };
    let is_above_zero = |x: f64| x > 0.0;
    let is_angle = |x: f64| x > 0.0 && x < std::f64::consts::PI;
    let angle = number("yfov", "an angle above 0 and below pi radians", is_angle)?;
    let near = number("znear", "a number above 0", is_above_zero)?;
    let aspect = number("aspectRatio", "a number above 0", is_above_zero)?;
    let far = number("zfar", "a number above 0", is_above_zero)?;
    let angle = angle.ok_or(Problem::Missing("yfov"))?;
    let near = near.ok_or(Problem::Missing("znear"))?;
    if far.is_some_and(|far| far <= near) {
        return Err(bad("zfar", "a number above `znear`", &perspective["zfar"]));
    }
    // Not the platform's tangent: the same scene is the same views everywhere.
    let tangent = libm::tan(angle / 2.0) * aspect.unwrap_or(1.0).max(1.0);
    match tangent.is_finite() && tangent > 0.0 {
        true => Ok((tangent, aspect, near)),
        false => Err(bad("perspective", "an angle of view", perspective)),
    }
}

/// A number of the extras of an entry, rounded: 1 to `most`.
fn whole_of(entry: &Value, name: &'static str, most: u32) -> Result<Option<u32>, Problem> {
    let Some(found) = entry.get("extras").and_then(|extras| extras.get(name)) else {
        return Ok(None);
    };
    let rounded = found.as_f64().map(f64::round);
    match rounded.filter(|number| (1.0..=f64::from(most)).contains(number)) {
        Some(number) => Ok(Some(number as u32)),
        None if name == "weight" => Err(bad("extras.weight", "a number from 1 to 16", found)),
        None => Err(bad("extras.views", "a number from 1 to 256", found)),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use serde_json::json;

    use super::*;

    /// A file with these nodes, all of its scene, and cameras.
    fn with(nodes: Value, cameras: Value) -> Document {
        let roots: Vec<usize> = (0..nodes.as_array().unwrap().len()).collect();
        let file = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": roots }],
            "nodes": nodes,
            "cameras": cameras,
        });
        Document::from_bytes("s.gltf", file.to_string().into_bytes(), None).unwrap()
    }

    fn perspective(lens: Value) -> Value {
        json!([{ "type": "perspective", "perspective": lens }])
    }

    fn error(node: Value, cameras: Value) -> String {
        with(json!([node]), cameras)
            .cameras()
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn cameras_stand_and_look_as_their_nodes_do() {
        let half = 0.5f64.sqrt();
        let document = with(
            json!([
                { "camera": 0, "translation": [1, 2, 3], "scale": [2, 2, 2] },
                // A quarter turn about y: -z becomes -x.
                { "camera": 0, "rotation": [0, half, 0, half] },
                { "name": "no camera" },
            ]),
            perspective(json!({ "yfov": FRAC_PI_2, "znear": 0.25 })),
        );
        let cameras = document.cameras().unwrap();
        assert_eq!(cameras.len(), 2);
        assert_eq!(cameras[0].eye, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(cameras[0].forward, DVec3::NEG_Z);
        assert_eq!(cameras[0].up, DVec3::Y);
        assert_eq!((cameras[0].near, cameras[0].weight), (0.25, 1));
        assert!((cameras[0].tan_half_fov - 1.0).abs() < 1e-15);
        assert!((cameras[1].forward - DVec3::NEG_X).length() < 1e-15);
    }

    #[test]
    fn a_square_holds_the_larger_angle() {
        for (aspect, tangent) in [(2.0, 2.0), (0.5, 1.0), (1.0, 1.0)] {
            let lens = json!({ "yfov": FRAC_PI_2, "znear": 1, "aspectRatio": aspect });
            let cameras = with(json!([{ "camera": 0 }]), perspective(lens));
            let found = cameras.cameras().unwrap()[0].tan_half_fov;
            assert!((found - tangent).abs() < 1e-15, "{aspect}: {found}");
        }
    }

    #[test]
    fn the_nodes_weight_counts_before_the_cameras() {
        let camera = json!([{
            "type": "perspective", "perspective": { "yfov": 1, "znear": 1 },
            "extras": { "weight": 3 },
        }]);
        let nodes = json!([
            { "camera": 0 },
            { "camera": 0, "extras": { "weight": 5.4 } },
            { "camera": 0, "extras": { "of": "somebody" } },
        ]);
        let weights: Vec<u32> = with(nodes, camera)
            .cameras()
            .unwrap()
            .iter()
            .map(|camera| camera.weight)
            .collect();
        assert_eq!(weights, [3, 5, 3]);
    }

    #[test]
    fn what_is_no_camera_is_refused_with_its_place() {
        let camera = || json!({ "camera": 0 });
        let lens = |yfov: f64, near: f64| perspective(json!({ "yfov": yfov, "znear": near }));
        assert_eq!(
            error(camera(), lens(1.0, 0.0)),
            "s.gltf: cameras[0]: `znear` is 0.0, not a number above 0"
        );
        for yfov in [0.0, -1.0, PI, 9.0] {
            let says = error(camera(), lens(yfov, 0.1));
            assert!(says.contains("cameras[0]: `yfov` is"), "{says}");
        }
        let inside_out = perspective(json!({ "yfov": 1, "znear": 2, "zfar": 1 }));
        assert!(error(camera(), inside_out).contains("`zfar` is 1, not a number above `znear`"));
        let no_near = perspective(json!({ "yfov": 1 }));
        assert!(error(camera(), no_near).contains("has no `znear`"));
        let flat = json!([{ "type": "orthographic", "orthographic": {} }]);
        assert!(error(camera(), flat).contains("cameras[0]: is orthographic"));
        assert!(error(json!({}), json!([])).contains("s.gltf: has no camera"));
        assert!(error(json!({ "camera": 7 }), json!([])).contains("`cameras[7]` does not exist"));
        let squashed = json!({ "camera": 0, "scale": [1, 1, 0] });
        assert!(error(squashed, lens(1.0, 0.1)).contains("nodes[0]: its transform leaves"));
        for weight in [json!(0), json!(17), json!("much"), json!(-1)] {
            let heavy = json!({ "camera": 0, "extras": { "weight": weight } });
            let says = error(heavy, lens(1.0, 0.1));
            assert!(says.contains("not a number from 1 to 16"), "{says}");
        }
        let many: Vec<Value> = vec![json!({ "camera": 0, "extras": { "weight": 16 } }); 65];
        let says = with(json!(many), lens(1.0, 0.1)).cameras().unwrap_err();
        assert!(
            says.to_string().contains("more than 1024 cameras"),
            "{says}"
        );
    }

    #[test]
    fn a_scene_may_have_nothing_that_hides_leaves() {
        let empty = with(json!([{ "name": "nothing" }]), json!([]));
        assert!(empty.occluders().unwrap().leaves().is_empty());
    }

    /// Two keys: from x = 0 at once to x = 8 after 2 s, of a node above the camera.
    fn walked(extras: Value, interpolation: &str) -> Document {
        let numbers = [0.0f32, 2.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0];
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, bytes);
        let file = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "children": [1] }, { "camera": 0, "translation": [0, 1, 0], "extras": extras }],
            "cameras": perspective(json!({ "yfov": 1, "znear": 1 })),
            "animations": [{
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
                "samplers": [{ "input": 0, "output": 1, "interpolation": interpolation }],
            }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR" },
                { "bufferView": 0, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3" },
            ],
            "bufferViews": [{ "buffer": 0, "byteLength": 32 }],
            "buffers": [{ "byteLength": 32, "uri": format!("data:;base64,{data}") }],
        });
        Document::from_bytes("s.gltf", file.to_string().into_bytes(), None).unwrap()
    }

    #[test]
    fn a_camera_that_moves_is_a_path_of_cameras() {
        let four = walked(json!({ "views": 4, "weight": 2 }), "LINEAR");
        let cameras = four.cameras().unwrap();
        let eyes: Vec<[f64; 3]> = cameras.iter().map(|c| c.eye.to_array()).collect();
        let expected = [1.0, 3.0, 5.0, 7.0].map(|x| [x, 1.0, 0.0]);
        assert_eq!(eyes, expected);
        assert!(
            cameras
                .iter()
                .all(|c| c.weight == 2 && c.forward == DVec3::NEG_Z)
        );
        let usual = walked(json!({}), "LINEAR").cameras().unwrap();
        assert_eq!(usual.len(), VIEWS_OF_A_PATH as usize);
    }

    #[test]
    fn paths_that_cannot_be_read_are_refused() {
        let says = |extras: Value, interpolation: &str| {
            let document = walked(extras, interpolation);
            document.cameras().unwrap_err().to_string()
        };
        let views = "s.gltf: nodes[1]: `extras.views` is 0, not a number from 1 to 256";
        assert_eq!(says(json!({ "views": 0 }), "LINEAR"), views);
        let kind = "`interpolation` is \"SPIRAL\", not LINEAR, STEP or CUBICSPLINE";
        let found = says(json!({}), "SPIRAL");
        assert_eq!(found, format!("s.gltf: animations[0]: {kind}"));
        let count = "s.gltf: animations[0]: has another number of values than of times";
        assert_eq!(says(json!({}), "CUBICSPLINE"), count);
    }
}
