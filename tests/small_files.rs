//! A glTF tree of two leaves, small enough to be broken on purpose.

use serde_json::{Value, json};

use crate::program::Bench;

/// Corners of two square leaves, 12 bytes each, then two triangles each.
pub(crate) fn two_leaves() -> Vec<u8> {
    let mut bytes = Vec::new();
    for leaf in 0..2u8 {
        let left = 2.0 * f32::from(leaf);
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            for coordinate in [left + x, y, 0.0f32] {
                bytes.extend(coordinate.to_le_bytes());
            }
        }
    }
    for first in [0u16, 4] {
        for corner in [0, 1, 2, 0, 2, 3] {
            bytes.extend((first + corner).to_le_bytes());
        }
    }
    bytes
}

/// Its JSON; the buffer is `tree.bin`.
pub(crate) fn two_leaves_json() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "tree" }],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }
        ] }],
        "materials": [{ "name": "leaf", "alphaMode": "MASK" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
              "min": [0, 0, 0], "max": [3, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 24 }
        ],
        "buffers": [{ "uri": "tree.bin", "byteLength": 120 }]
    })
}

/// Puts the tree into a folder, its JSON changed at one place.
pub(crate) fn put_changed(bench: &Bench, pointer: &str, value: Value) {
    let mut json = two_leaves_json();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    bench.put("tree.gltf", json.to_string().as_bytes());
    bench.put("tree.bin", &two_leaves());
}

#[test]
fn unchanged_it_is_simplified() {
    // Else the tests of what is broken would show nothing.
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    let arguments = [
        "tree.gltf",
        "-o",
        "out.glb",
        "--leaves",
        "1",
        "--report",
        "r.json",
    ];
    bench.simplify(&arguments).succeeded();
    assert_eq!(bench.json("r.json")["triangles"]["final"], 2);
}
