//! Stands: a level for each plant of a scene.

use secateur::Document;
use serde_json::{Value, json};

use crate::program::{Bench, oak};
use crate::schema::checked;

/// 60 plants of two kinds in ten rows that go away from the camera, and a wall that hides the last rows.
fn list() -> Value {
    let places = |odd: usize| -> Vec<Value> {
        let place = |k: usize| {
            let (row, column) = (k / 6, k % 6);
            json!({
                "position": [9.0 * column as f64 - 22.5, 0, -9.0 * row as f64],
                "turn_degrees": 37 * k % 360,
                "scale": 0.8 + 0.1 * (k % 5) as f64,
            })
        };
        (0..60).filter(|k| k % 2 == odd).map(place).collect()
    };
    json!({
        "plants": [
            { "file": "oak.glb", "places": places(0) },
            { "file": "birch.glb", "places": places(1) },
        ],
        "cameras": [
            { "eye": [0, 3, 20], "target": [0, 4, 0] },
            { "eye": [-30, 6, 14], "target": [0, 2, -20], "fov_y_degrees": 40, "aspect": 1 },
        ],
        "obstacles": ["wall.gltf"],
    })
}

/// A quad across z, wide and high, between the fifth and the sixth row.
fn wall() -> Value {
    let quad = json!({ "mesh": 0, "scale": [99, 34.5, 1], "translation": [0, 25.5, -40.5] });
    crate::scenes::scene(&[quad])
}

fn put(bench: &Bench, name: &str, file: &Value) {
    bench.put(name, file.to_string().as_bytes());
}

const FAST: [&str; 4] = ["--effort", "fast", "--screen-height", "270"];

#[test]
fn a_stand_is_as_light_as_its_cameras_let_it_be() {
    let bench = Bench::new();
    let grow = ["grow", "birch", "--leaves", "200", "-o", "birch.glb"];
    bench.run(&grow).succeeded();
    put(&bench, "wall.gltf", &wall());
    put(&bench, "scene.json", &list());
    let stand = ["stand", "scene.json", "-o", "out", "--max-flip", "0.02"];
    bench.run(&[&stand[..], &FAST].concat()).succeeded();
    let record = bench.json("out/stand.json");
    checked(&bench, "stand", &record);
    let number = |of: &str| record.pointer(of).and_then(Value::as_f64).unwrap();
    assert_eq!(number("/before/plants"), 60.0);
    // What the wall hides from both cameras is not there; crowns of the row behind it reach through.
    let places = record["places"].as_array().unwrap();
    let row = |k: &usize| k % 30 / 3;
    for (k, place) in places.iter().enumerate() {
        let is_seen = !place["level"].is_null();
        assert!(row(&k) == 5 || is_seen == (row(&k) < 5), "{place}");
    }
    let seen = places.iter().filter(|place| !place["level"].is_null());
    assert_eq!(number("/after/plants"), seen.count() as f64);
    for camera in record["cameras"].as_array().unwrap() {
        assert!(camera["flip_mean"].as_f64().unwrap() <= 0.02, "{camera}");
        let before = bench.read(camera["before"].as_str().unwrap());
        assert!(before.starts_with(b"\x89PNG"));
    }
    assert!(number("/cost_ratio") > 3.0, "{}", number("/cost_ratio"));
    // Near plants have finer levels than far ones.
    let level_of_row = |asked: usize| -> f64 {
        let own = (0..60).filter(|k| row(k) == asked);
        own.map(|k| places[k]["level"].as_f64().unwrap()).sum()
    };
    assert!(level_of_row(0) < level_of_row(4));
    // The scene is what the record says, and draws each level from one mesh.
    let scene = Document::open(&bench.path("out/stand.glb")).unwrap();
    let json = scene.json();
    let of_mesh = |mesh: &Value| -> u64 {
        let primitives = json["meshes"][mesh.as_u64().unwrap() as usize]["primitives"].as_array();
        let indices = primitives
            .unwrap()
            .iter()
            .map(|p| p["indices"].as_u64().unwrap() as usize);
        indices
            .map(|k| json["accessors"][k]["count"].as_u64().unwrap() / 3)
            .sum()
    };
    let nodes = json["nodes"].as_array().unwrap().iter();
    let triangles: u64 = nodes.filter_map(|node| node.get("mesh")).map(of_mesh).sum();
    assert_eq!(triangles as f64, number("/after/triangles"));
    let shown = record["kinds"].as_array().unwrap().iter();
    let shown = shown.flat_map(|kind| kind["levels"].as_array().unwrap());
    let shown = shown.filter(|level| level["plants"] != 0).count();
    // The plants themselves are two meshes each.
    let meshes = json["meshes"].as_array().unwrap().len();
    assert!(
        (shown..=shown + 2).contains(&meshes),
        "{meshes} meshes of {shown} levels"
    );

    // Half as many triangles are spent so that the pictures are as near as those let them be.
    let half = (number("/after/triangles") / 2.0).floor();
    let few = [
        "stand",
        "scene.json",
        "-o",
        "few",
        "--triangles",
        &half.to_string(),
    ];
    bench.run(&[&few[..], &FAST].concat()).succeeded();
    let few = bench.json("few/stand.json");
    let of = |record: &Value, of: &str| record.pointer(of).and_then(Value::as_f64).unwrap();
    assert!(of(&few, "/after/triangles") <= half);
    assert!(of(&few, "/cost_ratio") > number("/cost_ratio"));
    assert!(of(&few, "/cameras/0/flip_mean") > of(&record, "/cameras/0/flip_mean"));
    // Nothing is overwritten unasked.
    let again = [&stand[..], &FAST].concat();
    bench
        .run(&again)
        .failed_saying(&["stand.glb", "--overwrite"]);
}

/// The oak's two meshes hang on a node; three such nodes are three oaks, one of them by an instance.
#[test]
fn plants_of_a_gltf_scene_are_its_nodes() {
    let bench = Bench::new();
    let glb = oak();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut root: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let of_tree = root["nodes"][2]["children"].clone();
    assert_eq!(of_tree, json!([0, 1]));
    let nodes = root["nodes"].as_array_mut().unwrap();
    for x in [-9.0, 9.0] {
        let first = nodes.len();
        let parts = [nodes[0].clone(), nodes[1].clone()];
        nodes.extend(parts);
        nodes.push(
            json!({ "name": "Another", "children": [first, first + 1], "translation": [x, 0, 0] }),
        );
    }
    nodes.push(json!({ "camera": 0, "translation": [0, 4, 25] }));
    let roots = json!([2, 5, 8, 9]);
    root["scenes"][0]["nodes"] = roots;
    root["cameras"] = json!([{ "type": "perspective",
        "perspective": { "yfov": 0.9, "znear": 0.1, "aspectRatio": 2 } }]);
    let mut json = serde_json::to_vec(&root).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut scene = b"glTF\x02\0\0\0".to_vec();
    scene.extend(((glb.len() - length + json.len()) as u32).to_le_bytes());
    scene.extend((json.len() as u32).to_le_bytes());
    scene.extend(&glb[16..20]);
    scene.extend(&json);
    scene.extend(&glb[20 + length..]);
    bench.put("scene.glb", &scene);
    let stand = ["stand", "scene.glb", "-o", "out"];
    bench.run(&[&stand[..], &FAST].concat()).succeeded();
    let record = bench.json("out/stand.json");
    assert_eq!(record["kinds"].as_array().unwrap().len(), 1);
    assert_eq!(record["before"]["plants"], 3);
    assert!(record["cameras"][0]["difference"].as_f64().unwrap() <= 0.28);
    let names: Vec<&str> = record["places"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["Tree_0", "Another_1", "Another_2"]);
}

#[test]
fn lists_that_are_none_are_refused_in_one_sentence() {
    let bench = Bench::new();
    let with = |change: &dyn Fn(&mut Value)| {
        let mut list = json!({
            "plants": [{ "file": "oak.glb", "places": [{ "position": [0, 0, 0] }] }],
            "cameras": [{ "eye": [0, 2, 20], "target": [0, 2, 0] }],
        });
        change(&mut list);
        put(&bench, "scene.json", &list);
    };
    let refused = |words: &[&str]| {
        let words = [&["scene.json"], words].concat();
        bench
            .run(&["stand", "scene.json", "-o", "out"])
            .failed_saying(&words);
    };
    with(&|list| list["cameras"] = json!([]));
    refused(&["`cameras` is empty"]);
    with(&|list| list["plants"][0]["places"][0]["scale"] = json!(0));
    refused(&["plants[0].places[0]", "scale above 0"]);
    with(&|list| list["cameras"][0]["target"] = list["cameras"][0]["eye"].clone());
    refused(&["cameras[0]", "two points"]);
    with(&|list| list["trees"] = json!(1));
    refused(&["trees"]);
    with(&|list| list["plants"][0]["places"] = json!([]));
    refused(&["0 places"]);
    with(&|list| list["plants"][0]["file"] = json!("none.glb"));
    bench
        .run(&["stand", "scene.json", "-o", "out"])
        .failed_saying(&["none.glb"]);
}
