//! Scenes: from where a tree is seen, and what stands before it.

use secateur::{Lod, Tree};
use serde_json::{Value, json};

use crate::program::{Bench, OAK_LEAVES};

/// A camera 12 m away on an axis, as a node that looks at the trunk.
fn camera([x, z]: [f64; 2], extras: Value) -> Value {
    // -z becomes the way to the trunk.
    let turn = x.atan2(z) / 2.0;
    json!({
        "camera": 0,
        "translation": [12.0 * x, 2.5, 12.0 * z],
        "rotation": [0.0, turn.sin(), 0.0, turn.cos()],
        "extras": extras,
    })
}

const AXES: [[f64; 2]; 4] = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];

fn cameras() -> Vec<Value> {
    AXES.map(|axis| camera(axis, json!({}))).to_vec()
}

/// A scene with these nodes, in which mesh 0 is a quad of sides 2 across z, and camera 0 sees
/// an angle of a radian.
pub(crate) fn scene(nodes: &[Value]) -> Value {
    let corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    let floats = corners.map(|[x, y]| [x as f32, y as f32, 0.0]);
    let mut bytes: Vec<u8> = floats
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes);
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }],
        "materials": [{ "doubleSided": true }],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }
        ] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "buffers": [{ "byteLength": 60, "uri": format!("data:;base64,{data}") }],
    })
}

/// A wall across z, so large that nothing is seen past it by a camera behind it.
fn wall(z: f64) -> Value {
    json!({ "mesh": 0, "translation": [0, 0, z], "scale": [40, 40, 1] })
}

fn put(bench: &Bench, name: &str, file: &Value) {
    bench.put(name, file.to_string().as_bytes());
}

fn simplified(bench: &Bench, options: &[&str]) -> Value {
    let files = ["simplify", "oak.glb", "-o", "out.glb", "--report", "r.json"];
    let few = ["--resolution", "64"];
    bench.run(&[&files[..], options, &few].concat()).succeeded();
    bench.json("r.json")
}

/// Leaves left whose centre is at z above 0, and below it.
fn before_and_behind(bench: &Bench) -> [usize; 2] {
    let tree = Tree::open(&bench.path("out.glb"), &[]).unwrap();
    let left = tree.foliage().leaves();
    let before = left.iter().filter(|leaf| leaf.centre().z > 0.0).count();
    [before, left.len() - before]
}

#[test]
fn what_no_camera_of_a_scene_sees_goes_first() {
    let bench = Bench::new();
    let mut nodes = cameras();
    nodes.push(wall(0.0));
    // Along x the wall is seen edge on: those cameras see both sides.
    nodes[1] = camera([0.4, 1.0], json!({}));
    nodes[3] = camera([-0.4, 1.0], json!({}));
    // The camera behind the wall looks away from it.
    nodes[2] = json!({ "camera": 0, "translation": [0, 2.5, -12] });
    put(&bench, "scene.gltf", &scene(&nodes));
    let report = simplified(&bench, &["--ratio", "0.25", "--scene", "scene.gltf"]);
    let settings = &report["settings"];
    assert_eq!(settings["scene"], "scene.gltf");
    assert_eq!(settings["views"], "scene");
    assert_eq!(settings["view_count"], 4);
    assert_eq!(settings["occluder_triangles"], 2);
    let [before, behind] = before_and_behind(&bench);
    assert_eq!(before + behind, OAK_LEAVES as usize / 4);
    assert!(behind * 10 <= before, "{before} before, {behind} behind");

    // All cameras without the wall.
    nodes.pop();
    put(&bench, "bare.gltf", &scene(&nodes));
    simplified(&bench, &["--ratio", "0.25", "--scene", "bare.gltf"]);
    let [before, behind] = before_and_behind(&bench);
    assert!(behind * 5 > before, "{before} before, {behind} behind");
}

#[test]
fn further_files_hide_leaves_too_with_or_without_a_scene() {
    let bench = Bench::new();
    put(&bench, "wall.gltf", &scene(&[wall(0.0)]));
    put(&bench, "bare.gltf", &scene(&cameras()));
    let mut both = cameras();
    both.push(wall(0.0));
    put(&bench, "scene.gltf", &scene(&both));
    let order = |options: &[&str]| {
        let all = [&["--ratio", "0.25"], options].concat();
        simplified(&bench, &all)["order_sha256"].clone()
    };
    let apart = order(&["--scene", "bare.gltf", "--occluder", "wall.gltf"]);
    assert_eq!(apart, order(&["--scene", "scene.gltf"]));
    let bare = order(&["--scene", "bare.gltf"]);
    assert_ne!(apart, bare);
    let walled = order(&["--views", "6", "--occluder", "wall.gltf"]);
    assert_ne!(walled, order(&["--views", "6"]));
    // Where leaves are the whole plant's, and where wood hides them too.
    for wood in ["auto", "keep"] {
        let options = ["--wood", wood, "--ratio", "0.25", "--scene"];
        let of = |scene: &str| simplified(&bench, &[&options[..], &[scene]].concat());
        let [walled, bare] = ["scene.gltf", "bare.gltf"].map(of);
        assert_ne!(walled["order_sha256"], bare["order_sha256"], "{wood}");
    }
}

#[test]
fn a_camera_counts_as_often_as_it_weighs() {
    let bench = Bench::new();
    let of = |weights: [f64; 4]| {
        let heavy = |k: usize| camera(AXES[k], json!({ "weight": weights[k] }));
        put(&bench, "scene.gltf", &scene(&[0, 1, 2, 3].map(heavy)));
        simplified(&bench, &["--ratio", "0.25", "--scene", "scene.gltf"])
    };
    let [equal, alike, heavy] = [[1.0; 4], [6.0; 4], [3.0, 1.0, 1.0, 1.4]].map(of);
    assert_eq!(equal["settings"]["view_count"], 4);
    assert_eq!(equal["order_sha256"], alike["order_sha256"]);
    assert_eq!(heavy["settings"]["view_count"], 6);
    assert_ne!(equal["order_sha256"], heavy["order_sha256"]);

    // A weight of 2 does what two cameras at the same place do.
    let mut repeated = vec![camera(AXES[0], json!({})); 2];
    repeated.extend(cameras());
    put(&bench, "scene.gltf", &scene(&repeated));
    let repeated = simplified(&bench, &["--ratio", "0.25", "--scene", "scene.gltf"]);
    assert_eq!(repeated["order_sha256"], heavy["order_sha256"]);
}

#[test]
fn a_scene_may_have_one_camera() {
    let bench = Bench::new();
    put(
        &bench,
        "scene.gltf",
        &scene(&[camera(AXES[0], json!({})), wall(0.0)]),
    );
    let report = simplified(&bench, &["--ratio", "0.25", "--scene", "scene.gltf"]);
    assert_eq!(report["settings"]["view_count"], 2);
    let [before, behind] = before_and_behind(&bench);
    assert!(behind * 10 <= before, "{before} before, {behind} behind");
}

/// What an alpha mask cuts out hides nothing: a hedge whose texture is empty is no wall.
#[test]
fn holes_of_occluders_are_holes() {
    let bench = Bench::new();
    let mut nodes = cameras();
    nodes.push(wall(0.0));
    let mut hedge = scene(&nodes);
    hedge["materials"] = json!([{
        "doubleSided": true, "alphaMode": "MASK",
        "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0] },
    }]);
    put(&bench, "hedge.gltf", &hedge);
    put(&bench, "bare.gltf", &scene(&cameras()));
    let order = |options: &[&str]| simplified(&bench, options)["order_sha256"].clone();
    let of = |name: &str| order(&["--ratio", "0.25", "--scene", name]);
    assert_eq!(of("hedge.gltf"), of("bare.gltf"));
    let solid = ["--ratio", "0.25", "--alpha", "ignore", "--scene"];
    let solid = |name: &str| order(&[&solid[..], &[name]].concat());
    assert_ne!(solid("hedge.gltf"), solid("bare.gltf"));
}

#[test]
fn chains_are_made_for_scenes_too() {
    let bench = Bench::new();
    let mut nodes = cameras();
    nodes.push(wall(0.0));
    put(&bench, "scene.gltf", &scene(&nodes));
    put(&bench, "bare.gltf", &scene(&cameras()));
    let order = |scene: &str, folder: &str| {
        let lods = ["lods", "oak.glb", "--levels", "0.3", "--report", "r.json"];
        let own = ["--scene", scene, "-o", folder];
        bench.run(&[&lods[..], &own].concat()).succeeded();
        let record = bench.json("r.json");
        assert_eq!(record["surroundings"]["scene"], scene);
        record["order_sha256"].clone()
    };
    assert_ne!(order("scene.gltf", "walled"), order("bare.gltf", "bare"));
}

/// What stands before a plant hides what a level lacks: fewer triangles look the same.
#[test]
fn levels_are_judged_from_the_cameras_of_a_scene_among_its_obstacles() {
    let bench = Bench::new();
    let camera = camera(AXES[0], json!({}));
    // Nearer than the tree, over all but its top: the wall's upper rim is at 5 m.
    let before = json!({ "mesh": 0, "translation": [0, -35, 6], "scale": [40, 40, 1] });
    put(&bench, "scene.gltf", &scene(&[camera.clone(), before]));
    put(&bench, "bare.gltf", &scene(&[camera]));
    let level = |scene: &str| {
        let wanted = ["--no-original", "--distances", "20", "--impostor", "none"];
        let files = [
            "lods",
            "oak.glb",
            "-o",
            "c",
            "--report",
            "r.json",
            "--overwrite",
        ];
        let run = bench.run(&[&files[..], &wanted, &["--scene", scene]].concat());
        run.succeeded();
        let level = bench.json("r.json")["levels"][0].clone();
        assert!(level["difference"].as_f64().unwrap() <= 0.28, "{level}");
        level["triangles"].as_u64().unwrap()
    };
    let [behind, bare] = ["scene.gltf", "bare.gltf"].map(level);
    assert!(
        behind * 5 < bare * 4,
        "{behind} behind the wall, {bare} without it"
    );
}

/// Nothing but the files that were there.
#[track_caller]
fn refused(bench: &Bench, options: &[&str], parts: &[&str]) {
    let names = bench.names();
    for command in ["simplify", "lods"] {
        let target = match command {
            "simplify" => ["--ratio", "0.5", "-o", "out.glb", "--resolution", "64"],
            _ => ["--levels", "0.5", "-o", "out", "--layout", "files"],
        };
        let all = [
            &[command, "oak.glb", "--report", "r.json"],
            &target[..],
            options,
        ]
        .concat();
        bench.run(&all).failed_saying(parts);
        assert_eq!(bench.names(), names, "nothing is written");
    }
}

#[test]
fn scenes_that_cannot_be_used() {
    let bench = Bench::new();
    let change = |pointer: &str, value: Value| {
        let mut file = scene(&[camera(AXES[0], json!({})), wall(0.0)]);
        *file.pointer_mut(pointer).unwrap() = value;
        put(&bench, "scene.gltf", &file);
    };
    let of_scene = ["--scene", "scene.gltf"];
    put(&bench, "scene.gltf", &scene(&[wall(0.0)]));
    refused(&bench, &of_scene, &["scene.gltf: has no camera"]);
    change("/cameras/0/perspective/znear", json!(-1));
    refused(&bench, &of_scene, &["cameras[0]: `znear` is -1"]);
    change("/cameras/0/perspective/yfov", json!(3.2));
    refused(&bench, &of_scene, &["cameras[0]: `yfov` is 3.2"]);
    change("/cameras/0", json!({ "type": "orthographic" }));
    refused(&bench, &of_scene, &["cameras[0]: is orthographic"]);
    change("/nodes/0/extras", json!({ "weight": 99 }));
    refused(&bench, &of_scene, &["nodes[0]: `extras.weight` is 99"]);
    change("/buffers/0/byteLength", json!(99));
    refused(&bench, &of_scene, &["scene.gltf: buffers[0]", "99 bytes"]);
    bench.put("scene.gltf", b"hello");
    refused(&bench, &of_scene, &["scene.gltf: is not glTF"]);
    refused(
        &bench,
        &["--scene", "gone.glb"],
        &["gone.glb: cannot be read"],
    );
    refused(
        &bench,
        &["--occluder", "gone.glb"],
        &["gone.glb: cannot be read"],
    );
    put(&bench, "empty.gltf", &scene(&cameras()));
    refused(
        &bench,
        &["--occluder", "empty.gltf"],
        &["empty.gltf: has no triangle"],
    );
}

#[test]
fn surroundings_that_hide_everything() {
    let bench = Bench::new();
    let mut nodes = cameras();
    // Walls across the way of the cameras on the z axis; those on the x axis look away.
    nodes.extend([wall(11.0), wall(-11.0)]);
    nodes[1] = json!({ "camera": 0, "translation": [0, 2.5, 30] });
    nodes[3] = json!({ "camera": 0, "translation": [0, 2.5, -12] });
    put(&bench, "scene.gltf", &scene(&nodes));
    let says = ["oak.glb: no leaf is seen in any of the 4 views"];
    refused(&bench, &["--scene", "scene.gltf"], &says);
    // Cameras alone that look elsewhere.
    put(&bench, "away.gltf", &scene(&nodes[3..4]));
    let says = ["oak.glb: no leaf is seen in any of the 2 views"];
    refused(&bench, &["--scene", "away.gltf"], &says);
}

#[test]
fn what_goes_together_and_what_does_not() {
    let bench = Bench::new();
    put(&bench, "scene.gltf", &scene(&cameras()));
    let files = ["simplify", "oak.glb", "-o", "out.glb", "--ratio", "0.5"];
    let both = ["--scene", "scene.gltf", "--views", "8"];
    let run = bench.run(&[&files[..], &both].concat());
    run.misused_saying(&["--views", "cannot be used with", "--scene"]);
    let over = ["simplify", "oak.glb", "-o", "scene.gltf", "--ratio", "0.5"];
    let run = bench.run(&[&over[..], &["--scene", "scene.gltf"]].concat());
    run.failed_saying(&["scene.gltf"]);
}

/// No view of a scene changes what a whole LOD is.
#[test]
fn all_leaves_stay_where_all_may() {
    let bench = Bench::new();
    put(&bench, "scene.gltf", &scene(&cameras()));
    let report = simplified(&bench, &["--ratio", "1", "--scene", "scene.gltf"]);
    assert_eq!(report["leaves"]["final"], OAK_LEAVES);
    let tree = Tree::open(&bench.path("oak.glb"), &[]).unwrap();
    let whole = Lod::original(tree.foliage().leaves().len());
    assert_eq!(tree.lod_to_bytes(&whole).unwrap(), bench.read("out.glb"));
}
