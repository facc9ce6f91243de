//! Cards with everything that a reader must have resolved before a page can draw
//! them: quantised positions and coordinates, a moved and turned texture, vertex
//! colours, a normal map, blocky filters, instances under a mirrored node.

use std::io::Cursor;

use image::{ImageFormat, Rgba, RgbaImage};
use serde_json::{Value, json};

struct Glb {
    root: Value,
    bytes: Vec<u8>,
}

impl Glb {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        self.append("bufferViews", view)
    }

    fn append(&mut self, list: &str, entry: Value) -> usize {
        let list = self.root[list].as_array_mut().unwrap();
        list.push(entry);
        list.len() - 1
    }

    fn accessor(
        &mut self,
        kind: &str,
        code: u32,
        count: usize,
        bytes: &[u8],
        more: Value,
    ) -> usize {
        let view = self.view(bytes);
        let mut accessor =
            json!({"bufferView": view, "type": kind, "componentType": code, "count": count});
        for (key, value) in more.as_object().unwrap() {
            accessor[key] = value.clone();
        }
        self.append("accessors", accessor)
    }

    fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len() / width, &bytes, json!({}))
    }

    fn texture(&mut self, image: &RgbaImage, sampler: usize) -> usize {
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).unwrap();
        let view = self.view(png.get_ref());
        let image = json!({"bufferView": view, "mimeType": "image/png"});
        let source = self.append("images", image);
        self.append("textures", json!({"source": source, "sampler": sampler}))
    }

    fn finished(mut self) -> Vec<u8> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut json = serde_json::to_vec(&self.root).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF".to_vec();
        let length = 28 + json.len() + self.bytes.len();
        for word in [2, length as u32, json.len() as u32, 0x4e4f_534a] {
            glb.extend(word.to_le_bytes());
        }
        glb.extend(json);
        glb.extend((self.bytes.len() as u32).to_le_bytes());
        glb.extend(0x004e_4942u32.to_le_bytes());
        glb.extend(self.bytes);
        glb
    }
}

/// Twelve cards about an axis.
pub(crate) fn glb() -> Vec<u8> {
    let mut glb = Glb {
        root: json!({
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing"],
            "extensionsRequired": ["KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing"],
            "scene": 0, "scenes": [{"nodes": [0]}],
            "accessors": [], "bufferViews": [], "images": [], "textures": [],
            "samplers": [{"magFilter": 9728, "minFilter": 9985, "wrapS": 33648, "wrapT": 10497}, {}],
        }),
        bytes: Vec::new(),
    };
    // A card of 200 x 100 steps, 1 x 0.5 after the node's scale.
    let corners: [[i16; 4]; 4] = [
        [-100, 0, 0, 0],
        [100, 0, 0, 0],
        [100, 100, 20, 0],
        [-100, 100, 0, 0],
    ];
    let bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let limits = json!({"min": [-100, 0, 0], "max": [100, 100, 20]});
    let position = glb.accessor("VEC3", 5122, 4, &bytes, limits);
    let view = glb.root["accessors"][position]["bufferView"]
        .as_u64()
        .unwrap() as usize;
    glb.root["bufferViews"][view]["byteStride"] = json!(8);
    let normals = [
        [0.0, 0.3, 0.95],
        [0.5, 0.0, 0.87],
        [0.0, 0.0, 1.0],
        [-0.4, 0.4, 0.82],
    ];
    let normal = glb.floats("VEC3", 3, normals.as_flattened());
    let uvs: [u16; 8] = [0, 65535, 65535, 65535, 65535, 0, 0, 0];
    let bytes: Vec<u8> = uvs.iter().flat_map(|v| v.to_le_bytes()).collect();
    let uv = glb.accessor("VEC2", 5123, 4, &bytes, json!({"normalized": true}));
    let colors = [
        255, 255, 255, 255, 255, 40, 40, 255, 90, 255, 90, 255, 60, 60, 255, 200,
    ];
    let color = glb.accessor("VEC4", 5121, 4, &colors, json!({"normalized": true}));
    let indices: Vec<u8> = [0u16, 1, 2, 0, 2, 3]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let indices = glb.accessor("SCALAR", 5123, 6, &indices, json!({}));

    // A leaf with a hole, half of it pale; bumps for its normals.
    let leaf = RgbaImage::from_fn(16, 16, |x, y| {
        let (dx, dy) = (x as f32 - 7.5, y as f32 - 7.5);
        let r = dx.hypot(dy);
        let alpha = if (2.5..7.8).contains(&r) { 255 } else { 0 };
        Rgba([
            if x < 8 { 60 } else { 170 },
            190,
            if y < 8 { 40 } else { 160 },
            alpha,
        ])
    });
    let bumps = RgbaImage::from_fn(64, 64, |x, y| {
        let slope = |t: u32| (127.5 + 90.0 * (t as f32 * 0.4).sin()) as u8;
        Rgba([slope(x), slope(y + 9), 225, 255])
    });
    let leaf = glb.texture(&leaf, 0);
    let bumps = glb.texture(&bumps, 1);
    let moved = json!({"KHR_texture_transform": {"offset": [0.15, -0.3], "rotation": 0.5, "scale": [1.6, 1.3]}});
    let material = |normals: Value| {
        json!({
            "name": "leaves", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.4,
            "normalTexture": normals,
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.9, 1.0, 0.8, 1.0], "metallicFactor": 0, "roughnessFactor": 0.45,
                "baseColorTexture": {"index": leaf, "extensions": moved},
            },
        })
    };
    let bumpy = material(json!({"index": bumps, "scale": 0.8, "extensions": moved}));
    // Instances go without bumps: three.js (r187) turns the green of their normal
    // maps round once too often.
    let mut smooth = material(Value::Null);
    smooth.as_object_mut().unwrap().remove("normalTexture");
    glb.root["materials"] = json!([bumpy, smooth]);
    let primitive = |material: usize| {
        json!({"primitives": [{
            "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "COLOR_0": color},
            "indices": indices, "material": material,
        }]})
    };
    glb.root["meshes"] = json!([primitive(0), primitive(1)]);

    let (mut places, mut turns, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    let mut nodes = Vec::new();
    for k in 0..12 {
        let angle = k as f32 * 0.9;
        let place = [120.0 * angle.cos(), 25.0 * k as f32, 120.0 * angle.sin()];
        let turn = [0.0, (angle / 2.0).sin(), 0.0, (angle / 2.0).cos()];
        let size = [1.0, 1.0 + 0.05 * k as f32, 1.0];
        if k % 2 == 0 {
            places.extend(place);
            turns.extend(turn);
            sizes.extend(size);
        } else {
            nodes.push(json!({"mesh": 0, "translation": place, "rotation": turn, "scale": size}));
        }
    }
    let places = glb.floats("VEC3", 3, &places);
    let turns = glb.floats("VEC4", 4, &turns);
    let sizes = glb.floats("VEC3", 3, &sizes);
    let plain: Vec<usize> = (3..3 + nodes.len()).collect();
    let small = [0.005, 0.005, 0.005];
    let mut all = vec![
        json!({"children": [1, 2], "scale": [-1, 1, 1], "translation": [3, 0, 0]}),
        json!({"mesh": 1, "scale": small, "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": places, "ROTATION": turns, "SCALE": sizes},
        }}}),
        json!({"children": plain, "scale": small}),
    ];
    all.append(&mut nodes);
    glb.root["nodes"] = json!(all);
    glb.finished()
}
