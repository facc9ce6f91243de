//! Whatever the stream, decoding it ends in a tree or in an error. An input is the number of
//! vertices and of triangles that the accessors speak of, two bytes each, then the Draco stream.

#![no_main]

use libfuzzer_sys::fuzz_target;
use serde_json::json;

fuzz_target!(|bytes: &[u8]| {
    let Some((&[low, high, low_triangles, high_triangles], stream)) = bytes.split_first_chunk()
    else {
        return;
    };
    let points = u16::from_le_bytes([low, high]);
    let corners = 3 * u32::from(u16::from_le_bytes([low_triangles, high_triangles]));
    let vectors =
        |kind: &str, code: u32| json!({"type": kind, "componentType": code, "count": points});
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "materials": [{"name": "leaf"}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 1, "TEXCOORD_0": 2, "COLOR_0": 3}, "indices": 0, "material": 0,
            "extensions": {"KHR_draco_mesh_compression": {
                "bufferView": 0, "attributes": {"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2}
            }},
        }]}],
        "accessors": [
            {"type": "SCALAR", "componentType": 5123, "count": corners},
            vectors("VEC3", 5126), vectors("VEC2", 5126), vectors("VEC4", 5121),
        ],
        "bufferViews": [{"buffer": 0, "byteLength": stream.len()}],
        "buffers": [{"byteLength": stream.len()}],
        "extensionsUsed": ["KHR_draco_mesh_compression"],
    });
    let _ = secateur_fuzz::tree(&secateur_fuzz::glb(&document, stream));
});
