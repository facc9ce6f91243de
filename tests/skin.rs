//! A skinned tree in another pose: what is left of its wood moves as it moved in the original.

use std::collections::HashMap;

use secateur::glam::{Mat3, Vec3};
use serde_json::{Value, json};

use crate::glb::{chunks, joined};
use crate::program::Bench;

/// A vertex by the bits of its position.
type Key = [u32; 3];

/// A GLB whose meshes hang on two joints: what is higher hangs more on the upper one.
fn skinned(glb: &[u8]) -> Vec<u8> {
    let (json, bin) = chunks(glb);
    let mut root: Value = serde_json::from_slice(json).unwrap();
    let mut bin = bin.to_vec();
    for mesh in 0..root["meshes"].as_array().unwrap().len() {
        for primitive in 0..root["meshes"][mesh]["primitives"].as_array().unwrap().len() {
            let attributes = root["meshes"][mesh]["primitives"][primitive]["attributes"].clone();
            let heights: Vec<f32> = vectors::<3>(&root, &bin, &attributes["POSITION"])
                .iter()
                .map(|[_, y, _]| *y)
                .collect();
            let joints = [0, 1, 0, 0].repeat(heights.len());
            let weights = heights.iter().flat_map(|y| {
                let upper = (y / 4.0).clamp(0.0, 1.0);
                [1.0 - upper, upper, 0.0, 0.0]
            });
            let weights: Vec<u8> = weights.flat_map(f32::to_le_bytes).collect();
            for (name, bytes, component) in
                [("JOINTS_0", joints, 5121), ("WEIGHTS_0", weights, 5126)]
            {
                let views = root["bufferViews"].as_array_mut().unwrap();
                views.push(json!({
                    "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len(),
                    "target": 34962,
                }));
                let view = views.len() - 1;
                bin.extend(bytes);
                let accessors = root["accessors"].as_array_mut().unwrap();
                accessors.push(json!({
                    "bufferView": view, "componentType": component, "count": heights.len(),
                    "type": "VEC4",
                }));
                let accessor = accessors.len() - 1;
                root["meshes"][mesh]["primitives"][primitive]["attributes"][name] = accessor.into();
            }
        }
    }
    let nodes = root["nodes"].as_array_mut().unwrap();
    for node in nodes.iter_mut().filter(|node| node.get("mesh").is_some()) {
        node["skin"] = 0.into();
    }
    let lower = nodes.len();
    nodes.push(json!({ "name": "lower", "children": [lower + 1] }));
    nodes.push(json!({ "name": "upper" }));
    root["skins"] = json!([{ "joints": [lower, lower + 1] }]);
    let in_scene = root["scenes"][0]["nodes"].as_array_mut().unwrap();
    in_scene.push(lower.into());
    root["buffers"][0]["byteLength"] = bin.len().into();
    joined(&root, &bin)
}

/// The vectors of an accessor of floats.
fn vectors<const N: usize>(root: &Value, bin: &[u8], accessor: &Value) -> Vec<[f32; N]> {
    let accessor = &root["accessors"][accessor.as_u64().unwrap() as usize];
    assert_eq!(accessor["componentType"], 5126);
    elements(root, bin, accessor, 4 * N, |bytes| {
        std::array::from_fn(|k| f32::from_le_bytes(bytes[4 * k..4 * k + 4].try_into().unwrap()))
    })
}

fn elements<T>(
    root: &Value,
    bin: &[u8],
    accessor: &Value,
    size: usize,
    read: impl Fn(&[u8]) -> T,
) -> Vec<T> {
    let number = |of: &Value| of.as_u64().unwrap_or(0) as usize;
    let view = &root["bufferViews"][number(&accessor["bufferView"])];
    let first = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
    let stride = number(&view["byteStride"]).max(size);
    (0..number(&accessor["count"]))
        .map(|k| read(&bin[first + k * stride..][..size]))
        .collect()
}

/// Vertices of the wood with where they are in another pose.
fn posed(glb: &[u8]) -> Vec<(Key, Vec3)> {
    let (json, bin) = chunks(glb);
    let root: Value = serde_json::from_slice(json).unwrap();
    let turn = Mat3::from_rotation_z(0.6) * Mat3::from_rotation_x(-0.3);
    let moved = |joint: u8, at: Vec3| match joint {
        0 => at,
        _ => turn * at + Vec3::new(0.2, 0.1, -0.4),
    };
    let mut all = Vec::new();
    let meshes = root["meshes"].as_array().unwrap().iter();
    for primitive in meshes.flat_map(|mesh| mesh["primitives"].as_array().unwrap()) {
        let material = &root["materials"][primitive["material"].as_u64().unwrap() as usize];
        if !material["name"].as_str().unwrap().contains("bark") {
            continue;
        }
        let attributes = &primitive["attributes"];
        let positions = vectors::<3>(&root, bin, &attributes["POSITION"]);
        let weights = vectors::<4>(&root, bin, &attributes["WEIGHTS_0"]);
        let joints = &root["accessors"][attributes["JOINTS_0"].as_u64().unwrap() as usize];
        assert_eq!(joints["componentType"], 5121);
        let joints = elements(&root, bin, joints, 4, |b| [b[0], b[1], b[2], b[3]]);
        for ((position, weights), joints) in positions.into_iter().zip(weights).zip(joints) {
            let at = Vec3::from(position);
            let parts = (0..4).map(|k| weights[k] * moved(joints[k], at));
            all.push((position.map(f32::to_bits), parts.sum()));
        }
    }
    all
}

#[test]
fn wood_of_few_sides_moves_with_its_joints_as_before() {
    let bench = Bench::new();
    let original = skinned(&bench.read("oak.glb"));
    bench.put("skinned.glb", &original);
    let before = posed(&original);
    let is_bent =
        |(key, now): &(Key, Vec3)| now.distance(Vec3::from(key.map(f32::from_bits))) > 0.1;
    assert!(before.iter().any(is_bent));
    let count = before.len();
    let before: HashMap<Key, Vec3> = before.into_iter().collect();
    let place = |key: &Key| Vec3::from(key.map(f32::from_bits));
    // Vertices of thin twigs are moved away from their axis, and move with the joints of those that they were.
    let of_nearest = |at: Vec3| {
        let nearest = before.iter().min_by(|a, b| {
            let distance = |of: &(&Key, &Vec3)| place(of.0).distance_squared(at);
            distance(a).total_cmp(&distance(b))
        });
        let (key, now) = nearest.expect("a vertex");
        (place(key).distance(at), *now)
    };
    let files = ["skinned.glb", "-o", "out.glb"];
    let options = ["--triangles", "0.1"];
    bench.simplify(&[&files[..], &options].concat()).succeeded();
    let left = posed(&bench.read("out.glb"));
    assert!(!left.is_empty() && 5 * left.len() < count, "{}", left.len());
    assert!(left.iter().any(is_bent));
    let mut own = 0;
    for (key, now) in &left {
        if let Some(was) = before.get(key) {
            own += 1;
            assert_eq!(now, was);
            continue;
        }
        let (distance, was) = of_nearest(place(key));
        assert!(distance < 0.05, "{distance} from all vertices");
        assert!(now.distance(was) < 0.05, "{now}, {was}");
    }
    // Flat strips of twigs have vertices of their own, moved like the others.
    assert!(8 * own > left.len(), "{own} of {}", left.len());
    crate::validator::assert_valid(&[bench.path("out.glb")]);
}
