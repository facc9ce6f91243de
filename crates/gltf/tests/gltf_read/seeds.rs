//! What the fuzzer starts from: one small file for each encoding.

use base64::Engine;
use serde_json::{Value, json};

use crate::small_tree::{SQUARES, SmallTree};

/// File names and bytes; names that start with `broken` are refused.
pub(crate) fn all() -> Vec<(&'static str, Vec<u8>)> {
    let plain = SmallTree::squares();
    let glb = plain.glb();
    let endless = plain
        .clone()
        .set("/accessors/0/count", json!(1_000_000_000))
        .without("/accessors/0/bufferView");
    let nested = plain.clone().set(
        "/nodes",
        json!([
            {"children": [1, 2], "scale": [0.01, 0.01, 0.01]},
            {"mesh": 0, "rotation": [0, 0, 0.6, 0.8]},
            {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 3,0,0,1]},
        ]),
    );
    vec![
        ("plain.glb", glb.clone()),
        ("data_uri.gltf", data_uri(&plain)),
        ("nested.glb", nested.glb()),
        ("no_indices.glb", no_indices().glb()),
        ("strip.glb", strip().glb()),
        ("interleaved_quantised.glb", quantised().glb()),
        ("sparse.glb", sparse().glb()),
        ("instanced.glb", instanced().glb()),
        ("textured.glb", textured().glb()),
        (
            "meshopt_attributes.glb",
            meshopt("ATTRIBUTES", 12, &meshopt_positions(), 0).glb(),
        ),
        (
            "meshopt_triangles.glb",
            meshopt("TRIANGLES", 2, &meshopt_triangles(), 1).glb(),
        ),
        (
            "meshopt_indices.glb",
            meshopt("INDICES", 2, &meshopt_indices(), 1).glb(),
        ),
        ("draco_edgebreaker.glb", draco(DRACO_STREAMS[0]).glb()),
        ("draco_sequential.glb", draco(DRACO_STREAMS[1]).glb()),
        (
            "ktx2_etc1s.glb",
            ktx2(include_bytes!("../data/half_etc1s.ktx2")).glb(),
        ),
        (
            "ktx2_uastc_zstd.glb",
            ktx2(include_bytes!("../data/half_uastc_zstd.ktx2")).glb(),
        ),
        ("broken_truncated.glb", glb[..glb.len() / 2].to_vec()),
        ("broken_endless.glb", endless.glb()),
        (
            "broken_cycle.glb",
            plain.set("/nodes/0/children", json!([0])).glb(),
        ),
    ]
}

fn data_uri(tree: &SmallTree) -> Vec<u8> {
    let mut root = tree.root.clone();
    let data = base64::engine::general_purpose::STANDARD.encode(&tree.bytes);
    root["buffers"] =
        json!([{"byteLength": tree.bytes.len(), "uri": format!("data:;base64,{data}")}]);
    serde_json::to_vec(&root).unwrap()
}

fn no_indices() -> SmallTree {
    let mut tree = SmallTree::empty();
    let positions = tree.floats("VEC3", SQUARES[..6].as_flattened());
    tree.primitive(json!({"attributes": {"POSITION": positions}, "material": 0}));
    tree
}

fn strip() -> SmallTree {
    let mut tree = SmallTree::squares();
    let strip = tree.shorts("SCALAR", &[0, 1, 3, 2, 2, 4, 4, 5, 7, 6]);
    tree.set("/meshes/0/primitives/0/indices", json!(strip))
        .set("/meshes/0/primitives/0/mode", json!(5))
}

fn quantised() -> SmallTree {
    let mut tree = SmallTree::squares();
    let corner = |p: &[f32; 3]| [p[0] as u8, p[1] as u8, p[2] as u8, 9, 9, 9, 9, 9];
    let bytes: Vec<u8> = SQUARES.iter().flat_map(corner).collect();
    let view = tree.view(&bytes);
    tree.set(&format!("/bufferViews/{view}/byteStride"), json!(8))
        .set("/accessors/0/bufferView", json!(view))
        .set("/accessors/0/componentType", json!(5121))
        .set("/accessors/0/normalized", json!(true))
}

fn sparse() -> SmallTree {
    let mut tree = SmallTree::squares();
    let (indices, values) = (tree.view(&[1, 5]), tree.view(&[0x3f; 24]));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    });
    tree.set("/accessors/0/sparse", sparse)
}

fn instanced() -> SmallTree {
    let mut tree = SmallTree::squares();
    let translation = tree.floats("VEC3", &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0]);
    let rotation = tree.accessor("VEC4", 5120, 2, &[0, 0, 0, 127, 0, 0, 127, 0]);
    let attributes = json!({"TRANSLATION": translation, "ROTATION": rotation});
    tree.set(&format!("/accessors/{rotation}/normalized"), json!(true))
        .set(
            "/nodes/0/extensions",
            json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}}),
        )
}

fn textured() -> SmallTree {
    let mut tree = SmallTree::squares();
    let uvs: Vec<f32> = SQUARES.iter().flat_map(|p| [p[0], p[1]]).collect();
    let uvs = tree.floats("VEC2", &uvs);
    let image = image::RgbaImage::from_fn(4, 4, |x, y| image::Rgba([9, 99, 9, (64 * x + y) as u8]));
    let mut png = std::io::Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = tree.view(png.get_ref());
    let texture = json!({"index": 0, "extensions": {
        "KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 2]}
    }});
    tree.set(
        "/images",
        json!([{"bufferView": view, "mimeType": "image/png"}]),
    )
    .set("/samplers", json!([{"wrapS": 33648}]))
    .set("/textures", json!([{"source": 0, "sampler": 0}]))
    .set(
        "/materials/0",
        json!({
            "alphaMode": "MASK", "alphaCutoff": 0.3,
            "pbrMetallicRoughness": {"baseColorTexture": texture}
        }),
    )
    .set("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(uvs))
}

/// The squares as streams of Draco's two methods.
pub(crate) const DRACO_STREAMS: [&[u8]; 2] = [
    include_bytes!("../data/squares_edgebreaker.drc"),
    include_bytes!("../data/squares_sequential.drc"),
];

/// The squares with texture coordinates and colours, all of them in this stream: accessors of
/// indices, positions, texture coordinates and colours.
pub(crate) fn draco(stream: &[u8]) -> SmallTree {
    let mut tree = SmallTree::empty();
    let view = tree.view(stream);
    for (kind, code, count) in [
        ("SCALAR", 5123, 12),
        ("VEC3", 5126, 8),
        ("VEC2", 5126, 8),
        ("VEC4", 5121, 8),
    ] {
        let accessor = json!({"type": kind, "componentType": code, "count": count});
        tree.append("accessors", accessor);
    }
    tree.root["accessors"][3]["normalized"] = json!(true);
    let names = ["POSITION", "TEXCOORD_0", "COLOR_0"];
    let numbered = |first: usize| -> Value {
        let numbers = names.iter().enumerate();
        numbers
            .map(|(k, name)| (name.to_string(), json!(first + k)))
            .collect()
    };
    tree.primitive(json!({
        "attributes": numbered(1), "indices": 0, "material": 0,
        "extensions": {"KHR_draco_mesh_compression": {
            "bufferView": view, "attributes": numbered(0)
        }},
    }));
    let used = json!(["KHR_draco_mesh_compression"]);
    tree.set("/extensionsUsed", used.clone())
        .set("/extensionsRequired", used)
}

/// The squares with this image as their texture.
fn ktx2(image: &[u8]) -> SmallTree {
    let mut tree = textured();
    let view = tree.view(image);
    tree.set(
        "/images/0",
        json!({"bufferView": view, "mimeType": "image/ktx2"}),
    )
    .set(
        "/textures/0",
        json!({"sampler": 0, "extensions": {"KHR_texture_basisu": {"source": 0}}}),
    )
}

/// The squares with one of their views compressed.
fn meshopt(mode: &str, stride: usize, stream: &[u8], view: usize) -> SmallTree {
    let mut tree = SmallTree::squares();
    let source = tree.view(stream);
    let length = tree.root["bufferViews"][view]["byteLength"]
        .as_u64()
        .unwrap() as usize;
    let compression: Value = json!({
        "buffer": 0, "byteOffset": tree.root["bufferViews"][source]["byteOffset"],
        "byteLength": stream.len(), "byteStride": stride, "count": length / stride, "mode": mode,
    });
    tree.set(
        &format!("/bufferViews/{view}/extensions"),
        json!({"EXT_meshopt_compression": compression}),
    )
}

/// Version 0: literal deltas, sixteen for each byte position.
fn meshopt_positions() -> Vec<u8> {
    let mut stream = vec![0xa0];
    for position in 0..12 {
        let byte = |corner: &[f32; 3]| corner[position / 4].to_le_bytes()[position % 4];
        stream.push(3);
        let mut last = 0;
        let mut deltas = [0; 16];
        for (delta, value) in deltas.iter_mut().zip(SQUARES.iter().map(byte)) {
            let step = value.wrapping_sub(last);
            *delta = step << 1 ^ if step & 0x80 == 0 { 0 } else { 0xff };
            last = value;
        }
        stream.extend(deltas);
    }
    stream.extend([0; 32]);
    stream
}

/// Two free-standing triangles and, on an edge of each, another.
fn meshopt_triangles() -> Vec<u8> {
    let mut stream = vec![0xe1, 0xf0, 0x00, 0xf0, 0x10];
    stream.extend([0; 16]);
    stream
}

fn meshopt_indices() -> Vec<u8> {
    let mut stream = vec![0xd1, 0, 4, 4, 6, 8, 4, 4, 4, 4, 6, 8, 4];
    stream.extend([0; 4]);
    stream
}
