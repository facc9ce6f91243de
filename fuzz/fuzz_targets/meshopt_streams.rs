//! Whatever the stream, decompressing it ends in a tree or in an error. An input is
//! a mode, a filter, a stride in words and a count of two bytes, then the stream.

#![no_main]

use libfuzzer_sys::fuzz_target;
use serde_json::{Value, json};

const MODES: [&str; 3] = ["ATTRIBUTES", "TRIANGLES", "INDICES"];
const FILTERS: [&str; 5] = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];

/// Vertices beside compressed indices: a fan of them, 12 bytes each.
const VERTICES: usize = 256;

fuzz_target!(|bytes: &[u8]| {
    let Some((&[mode, filter, words, low, high], stream)) = bytes.split_first_chunk() else {
        return;
    };
    let mode = usize::from(mode) % MODES.len();
    let count = usize::from(u16::from_le_bytes([low, high]));
    let (document, bin) = match mode {
        0 => vertices(
            FILTERS[usize::from(filter) % FILTERS.len()],
            words,
            count,
            stream,
        ),
        _ => indices(MODES[mode], words, count, stream),
    };
    let _ = secateur_fuzz::tree(&secateur_fuzz::glb(&document, &bin));
});

/// A document whose vertices are the stream, drawn without indices.
fn vertices(filter: &str, words: u8, count: usize, stream: &[u8]) -> (Value, Vec<u8>) {
    let stride = 4 * usize::from(words).clamp(1, 64);
    let component_type = match stride {
        4 => 5120,
        8 => 5122,
        _ => 5126,
    };
    let position =
        json!({"bufferView": 0, "type": "VEC3", "componentType": component_type, "count": count});
    let view = compressed("ATTRIBUTES", filter, stride, count, stream);
    let primitive = json!({"attributes": {"POSITION": 0}, "material": 0});
    (
        document(primitive, json!([position]), json!([view]), stream.len()),
        stream.to_vec(),
    )
}

/// A document whose indices are the stream.
fn indices(mode: &str, words: u8, count: usize, stream: &[u8]) -> (Value, Vec<u8>) {
    let (stride, component_type) = if words % 2 == 1 { (2, 5123) } else { (4, 5125) };
    let index =
        json!({"bufferView": 0, "type": "SCALAR", "componentType": component_type, "count": count});
    let position =
        json!({"bufferView": 1, "type": "VEC3", "componentType": 5126, "count": VERTICES});
    let mut bin = stream.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let fan = json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": 12 * VERTICES});
    for k in 0..VERTICES {
        let corner = [k as f32, (k * k % 97) as f32, (k % 3) as f32];
        bin.extend(corner.into_iter().flat_map(f32::to_le_bytes));
    }
    let view = compressed(mode, "NONE", stride, count, stream);
    let primitive = json!({"attributes": {"POSITION": 1}, "indices": 0, "material": 0});
    (
        document(
            primitive,
            json!([index, position]),
            json!([view, fan]),
            bin.len(),
        ),
        bin,
    )
}

fn compressed(mode: &str, filter: &str, stride: usize, count: usize, stream: &[u8]) -> Value {
    json!({"buffer": 0, "byteLength": stride * count, "byteStride": stride, "extensions": {"EXT_meshopt_compression": {
        "buffer": 0, "byteLength": stream.len(), "byteStride": stride, "count": count, "mode": mode, "filter": filter}}})
}

fn document(primitive: Value, accessors: Value, views: Value, length: usize) -> Value {
    json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
           "meshes": [{"primitives": [primitive]}], "materials": [{"name": "leaf"}],
           "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": length}]})
}
