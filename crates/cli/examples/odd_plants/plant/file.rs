//! Parts of a plant as a GLB.

use std::fmt;

use serde_json::{Map, Value, json};

use super::{Choices, NODE_SCALES, Picture, Triangle};

#[derive(Clone, Copy, Debug)]
pub(crate) enum Normals {
    Missing,
    Own,
    Zero,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Colors {
    Missing,
    White,
    Clear,
}

/// Which nodes draw the plant.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Nodes {
    One,
    Nested,
    /// Some nodes of one mesh.
    Several,
    /// One node of some instances.
    Instanced,
}

/// What is written.
#[derive(Debug)]
pub(crate) struct PlantFile {
    parts: Vec<Vec<Triangle>>,
    has_uvs: bool,
    node_scale: [f64; 3],
    nodes: Nodes,
    normals: Normals,
    colors: Colors,
    alpha: &'static str,
    cutoff: Option<f64>,
    opacity: f64,
    is_double_sided: bool,
    picture: Picture,
    png: Option<Vec<u8>>,
    wrap: u32,
    filter: u32,
    transform: Option<[f64; 2]>,
}

impl fmt::Display for PlantFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "node {:?}, {:?}, normals {:?}, colors {:?}, {} {:?}, opacity {}, double sided {}, {:?}, wrap {}, \
             filter {}, transform {:?}",
            self.node_scale,
            self.nodes,
            self.normals,
            self.colors,
            self.alpha,
            self.cutoff,
            self.opacity,
            self.is_double_sided,
            self.picture,
            self.wrap,
            self.filter,
            self.transform
        )
    }
}

impl PlantFile {
    /// A file of the first two parts, leaves and wood, and of leaves with materials of their own.
    pub(crate) fn of(choices: &mut Choices<'_>, parts: Vec<Vec<Triangle>>, has_uvs: bool) -> Self {
        use {Colors as C, Nodes as N, Normals as O};
        let alpha = choices.one_of(&["MASK", "MASK", "MASK", "OPAQUE", "BLEND"]);
        let picture = choices.one_of(&Picture::ALL);
        Self {
            parts,
            has_uvs,
            node_scale: choices.one_of(&NODE_SCALES),
            nodes: choices.one_of(&[N::One, N::One, N::One, N::Nested, N::Several, N::Instanced]),
            normals: choices.one_of(&[O::Own, O::Missing, O::Zero]),
            colors: choices.one_of(&[
                C::Missing,
                C::Missing,
                C::Missing,
                C::Missing,
                C::Missing,
                C::White,
                C::White,
                C::Clear,
            ]),
            alpha,
            cutoff: match alpha {
                "MASK" => choices.one_of(&[
                    None,
                    Some(0.5),
                    Some(0.5),
                    Some(0.5),
                    Some(0.3),
                    Some(0.0),
                    Some(0.1),
                    Some(0.999),
                    Some(1.0),
                    Some(1.5),
                ]),
                _ => None,
            },
            opacity: choices.one_of(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.49, 0.0]),
            is_double_sided: !choices.one_in(3),
            picture,
            png: picture.png(&mut choices.random()),
            wrap: choices.one_of(&[10497, 33071, 33648]),
            filter: choices.one_of(&[9987, 9728, 9729, 9984]),
            transform: choices.one_of(&[None, None, Some([1.0, 1.0]), Some([0.0, -2.0])]),
        }
    }

    pub(crate) fn to_glb(&self) -> Vec<u8> {
        let mut buffer = Buffer::default();
        let parts = self.parts.iter().enumerate();
        let primitives: Vec<Value> = parts
            .filter(|(_, part)| !part.is_empty())
            .map(|(material, part)| {
                json!({ "material": material, "attributes": self.attributes(part, &mut buffer) })
            })
            .collect();
        let mut root =
            json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }] });
        if !primitives.is_empty() {
            self.put_nodes(&mut root, &mut buffer);
            root["meshes"] = json!([{ "name": "plant", "primitives": primitives }]);
            root["materials"] = (0..self.parts.len()).map(|k| self.material(k)).collect();
        }
        let mut used: Vec<&str> = Vec::new();
        if let (Some(png), false) = (&self.png, primitives.is_empty()) {
            let view = buffer.push(png);
            root["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
            root["textures"] = json!([{ "source": 0, "sampler": 0 }]);
            root["samplers"] =
                json!([{ "wrapS": self.wrap, "wrapT": self.wrap, "minFilter": self.filter }]);
            used.extend(self.transform.map(|_| "KHR_texture_transform"));
        }
        if let (Nodes::Instanced, false) = (self.nodes, primitives.is_empty()) {
            used.push("EXT_mesh_gpu_instancing");
        }
        if !used.is_empty() {
            root["extensionsUsed"] = json!(used);
        }
        buffer.into_glb(root)
    }

    fn put_nodes(&self, root: &mut Value, buffer: &mut Buffer) {
        let mut node = json!({ "mesh": 0, "name": "plant", "scale": self.node_scale });
        let steps = [[0.0; 3], [3.0, 0.0, 1.0], [-4.0, 0.5, 0.0]];
        let nodes = match self.nodes {
            Nodes::One => vec![node],
            Nodes::Nested => {
                let above = json!({ "name": "root", "children": [1], "translation": [1, 2, 3], "scale": [2, 2, 2] });
                vec![above, node]
            }
            Nodes::Several => steps
                .map(|at| {
                    let mut node = node.clone();
                    node["translation"] = json!(at);
                    node
                })
                .to_vec(),
            Nodes::Instanced => {
                let at = steps.map(|at| at.map(|x| x as f32));
                let at = buffer.accessor(at.as_flattened(), 3);
                let attributes = json!({ "attributes": { "TRANSLATION": at } });
                node["extensions"] = json!({ "EXT_mesh_gpu_instancing": attributes });
                vec![node]
            }
        };
        let roots = match self.nodes {
            Nodes::Nested => 1,
            Nodes::One | Nodes::Several | Nodes::Instanced => nodes.len(),
        };
        root["scenes"][0]["nodes"] = (0..roots).collect();
        root["nodes"] = nodes.into();
    }

    /// The second material is that of the wood.
    fn material(&self, index: usize) -> Value {
        if index == 1 {
            return json!({ "name": "bark", "doubleSided": self.is_double_sided });
        }
        let mut surface = json!({ "baseColorFactor": [0.9, 1.0, 0.9, self.opacity] });
        if self.png.is_some() && self.has_uvs {
            surface["baseColorTexture"] = json!({ "index": 0 });
            if let Some(scale) = self.transform {
                let transform = json!({ "scale": scale, "rotation": 0.7, "offset": [0.5, 0] });
                surface["baseColorTexture"]["extensions"] =
                    json!({ "KHR_texture_transform": transform });
            }
        }
        let mut material = json!({ "name": format!("leaf {index}"), "alphaMode": self.alpha,
            "doubleSided": self.is_double_sided, "pbrMetallicRoughness": surface });
        if let Some(cutoff) = self.cutoff {
            material["alphaCutoff"] = json!(cutoff);
        }
        material
    }

    /// Vertices of triangles that share none.
    fn attributes(&self, part: &[Triangle], buffer: &mut Buffer) -> Value {
        let mut attributes = Map::new();
        let mut put = |name: &str, values: Vec<f32>, width: usize| {
            attributes.insert(name.to_owned(), buffer.accessor(&values, width).into());
        };
        let corners = part.iter().flat_map(|(corners, _)| corners);
        put(
            "POSITION",
            corners.flat_map(|c| c.as_vec3().to_array()).collect(),
            3,
        );
        if self.has_uvs {
            let uvs = part.iter().flat_map(|(_, uvs)| uvs.as_flattened());
            put("TEXCOORD_0", uvs.map(|uv| *uv as f32).collect(), 2);
        }
        let normals = part.iter().map(|([a, b, c], _)| match self.normals {
            Normals::Missing => None,
            Normals::Own => Some(
                (b - a)
                    .cross(c - a)
                    .normalize_or_zero()
                    .as_vec3()
                    .to_array(),
            ),
            Normals::Zero => Some([0.0; 3]),
        });
        if let Some(normals) = normals.collect::<Option<Vec<_>>>() {
            put(
                "NORMAL",
                normals.iter().flat_map(|n| [*n; 3]).flatten().collect(),
                3,
            );
        }
        let color = match self.colors {
            Colors::Missing => None,
            Colors::White => Some([1.0; 4]),
            Colors::Clear => Some([1.0, 1.0, 1.0, 0.0]),
        };
        if let Some(color) = color {
            put("COLOR_0", vec![color; 3 * part.len()].into_flattened(), 4);
        }
        attributes.into()
    }
}

/// The bytes of a file, and what is known of them.
#[derive(Debug, Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn push(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.views.push(view);
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    /// An accessor of vectors of so many numbers.
    fn accessor(&mut self, values: &[f32], width: usize) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        let bound = |most: fn(f32, f32) -> f32, axis: usize| {
            let all = values.iter().skip(axis).step_by(width).copied();
            all.filter(|x| x.is_finite()).reduce(most).unwrap_or(0.0)
        };
        let bounds = [f32::min, f32::max].map(|most| {
            (0..width)
                .map(|axis| bound(most, axis))
                .collect::<Vec<f32>>()
        });
        let view = self.push(&bytes);
        self.accessors.push(
            json!({ "bufferView": view, "componentType": 5126, "count": values.len() / width,
            "type": format!("VEC{width}"), "min": bounds[0], "max": bounds[1] }),
        );
        self.accessors.len() - 1
    }

    fn into_glb(mut self, mut root: Value) -> Vec<u8> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        if !self.views.is_empty() {
            root["accessors"] = self.accessors.into();
            root["bufferViews"] = self.views.into();
            root["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let word = |n: usize| (n as u32).to_le_bytes();
        let mut glb = [*b"glTF", word(2), word(28 + text.len() + self.bytes.len())].concat();
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            glb.extend([word(chunk.len()), *kind].concat());
            glb.extend(chunk);
        }
        glb
    }
}
