//! Whatever the KTX2 image, a tree that shows it is read with it or without.

#![no_main]

use libfuzzer_sys::fuzz_target;
use serde_json::json;

fuzz_target!(|image: &[u8]| {
    let corners: [f32; 15] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1.];
    let mut bin: Vec<u8> = corners.into_iter().flat_map(f32::to_le_bytes).collect();
    let vertices = bin.len();
    bin.extend(image);
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "materials": [{
            "name": "leaf", "alphaMode": "MASK",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        }],
        "textures": [{"extensions": {"KHR_texture_basisu": {"source": 0}}}],
        "images": [{"bufferView": 1, "mimeType": "image/ktx2"}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0,
        }]}],
        "accessors": [
            {"type": "VEC3", "componentType": 5126, "count": 3, "bufferView": 0},
            {"type": "VEC2", "componentType": 5126, "count": 3, "bufferView": 0, "byteOffset": 36},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": vertices},
            {"buffer": 0, "byteOffset": vertices, "byteLength": image.len()},
        ],
        "buffers": [{"byteLength": bin.len()}],
        "extensionsUsed": ["KHR_texture_basisu"],
    });
    let _ = secateur_fuzz::tree(&secateur_fuzz::glb(&document, &bin));
});
