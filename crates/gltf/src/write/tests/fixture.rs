//! Building small glTF files.

use serde_json::{Map, Value, json};

use crate::accessor::Component;
use crate::container::glb_bytes;
use crate::write::bounds::bounds;
use crate::{Document, Selector, Tree};

pub(super) const BYTE: u32 = 5120;
pub(super) const UNSIGNED_BYTE: u32 = 5121;
pub(super) const SHORT: u32 = 5122;
pub(super) const UNSIGNED_SHORT: u32 = 5123;
pub(super) const UNSIGNED_INT: u32 = 5125;
pub(super) const FLOAT: u32 = 5126;

/// Triangles of a square with corners 0 to 3.
pub(super) const SQUARE: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// Corners of the k-th square leaf: side about 1, tilted, three units apart.
pub(super) fn square(k: usize) -> [[f32; 3]; 4] {
    let (x, y) = (3.0 * k as f32, (k % 2) as f32);
    [
        [x, y, 0.0],
        [x + 1.0, y, 0.25],
        [x + 1.0, y + 1.0, 0.25],
        [x, y + 1.0, 0.0],
    ]
}

/// Corners of `count` square leaves.
pub(super) fn squares(count: usize) -> Vec<[f32; 3]> {
    (0..count).flat_map(square).collect()
}

/// Indices of `count` squares.
pub(super) fn square_indices(count: usize) -> Vec<u32> {
    let corner = |k: usize| SQUARE.map(|corner| corner + 4 * k as u32);
    (0..count).flat_map(corner).collect()
}

/// A glTF file with a bark mesh in node 1 and room for leaves in mesh 1, which
/// node 2 draws.
pub(super) struct Fixture {
    pub(super) root: Value,
    pub(super) bin: Vec<u8>,
}

impl Fixture {
    pub(super) fn new() -> Self {
        let mut fixture = Self {
            root: json!({
                "asset": {"version": "2.0"},
                "scene": 0,
                "scenes": [{"nodes": [0]}],
                "nodes": [
                    {"name": "tree", "children": [1, 2]},
                    {"name": "trunk", "mesh": 0},
                    {"name": "leaves", "mesh": 1},
                ],
                "materials": [{"name": "bark"}, {"name": "leaf", "doubleSided": true}],
                "meshes": [{"name": "trunk"}, {"name": "leaves"}],
                "accessors": [],
                "bufferViews": [],
            }),
            bin: Vec::new(),
        };
        let positions = [
            [0.0, -5.0, 0.0],
            [1.0, -5.0, 0.0],
            [0.5, 0.0, 0.5],
            [0.0, -5.0, 1.0],
        ];
        let bark = json!({
            "attributes": {"POSITION": fixture.vectors(&positions)},
            "indices": fixture.indices(UNSIGNED_SHORT, &[0, 1, 2, 1, 3, 2]),
            "material": 0,
        });
        fixture.root["meshes"][0]["primitives"] = json!([bark]);
        fixture
    }

    /// With these attributes and indices as the leaf mesh.
    pub(super) fn with_leaves(mut self, attributes: Value, indices: Option<usize>) -> Self {
        let mut primitive = json!({"attributes": attributes, "material": 1});
        if let Some(indices) = indices {
            primitive["indices"] = indices.into();
        }
        self.root["meshes"][1]["primitives"] = json!([primitive]);
        self
    }

    pub(super) fn leaf_primitive(&mut self) -> &mut Value {
        &mut self.root["meshes"][1]["primitives"][0]
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.root[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    pub(super) fn accessor(&mut self, fields: Value) -> usize {
        self.push("accessors", fields)
    }

    /// Elements of `size` components in a view of their own; each element
    /// starts on a multiple of four bytes.
    pub(super) fn elements(&mut self, component: u32, size: usize, values: &[f64]) -> usize {
        let element: Vec<u8> = component_bytes(component, &values[..size]);
        let stride = element.len().next_multiple_of(4);
        let mut bytes = Vec::new();
        for element in values.chunks_exact(size) {
            bytes.extend(component_bytes(component, element));
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        let view = self.view(&bytes, (stride != element.len()).then_some(stride));
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][size];
        let count = values.len() / size;
        let mut accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        if size == 3 {
            let tight = component_bytes(component, values);
            let code = json!({ "componentType": component });
            let component = Component::from_code(&code).unwrap();
            let (min, max) = bounds(component, 3, &tight);
            accessor["min"] = min;
            accessor["max"] = max;
        }
        self.accessor(accessor)
    }

    /// An accessor of these values, stored as normalised integers.
    pub(super) fn normalized(&mut self, component: u32, size: usize, values: &[f64]) -> usize {
        let accessor = self.elements(component, size, values);
        self.root["accessors"][accessor]["normalized"] = true.into();
        accessor
    }

    pub(super) fn vectors<const N: usize>(&mut self, vectors: &[[f32; N]]) -> usize {
        let values: Vec<f64> = vectors.iter().flatten().map(|&x| f64::from(x)).collect();
        self.elements(FLOAT, N, &values)
    }

    pub(super) fn indices(&mut self, component: u32, indices: &[u32]) -> usize {
        let values: Vec<f64> = indices.iter().map(|&i| f64::from(i)).collect();
        let bytes = component_bytes(component, &values);
        let view = self.view(&bytes, None);
        self.accessor(json!({"bufferView": view, "componentType": component, "count": indices.len(), "type": "SCALAR"}))
    }

    pub(super) fn use_extension(&mut self, name: &str, is_required: bool) {
        let mut lists = vec!["extensionsUsed"];
        lists.extend(is_required.then_some("extensionsRequired"));
        for list in lists {
            match self.root.get_mut(list).and_then(Value::as_array_mut) {
                Some(names) => names.push(name.into()),
                None => self.root[list] = json!([name]),
            }
        }
    }

    /// Makes the leaf node draw instances with these attributes.
    pub(super) fn instance(&mut self, attributes: Map<String, Value>) {
        self.use_extension("EXT_mesh_gpu_instancing", true);
        let instancing = json!({"attributes": attributes, "extras": "a row of trees"});
        self.root["nodes"][2]["extensions"] = json!({ "EXT_mesh_gpu_instancing": instancing });
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut root = self.root.clone();
        if root.get("buffers").is_none() {
            root["buffers"] = json!([{}]);
        }
        root["buffers"][0]["byteLength"] = self.bin.len().into();
        glb_bytes(&root, self.bin.clone()).unwrap()
    }

    pub(super) fn tree(&self) -> Tree {
        read(self.glb())
    }
}

/// A tree from the bytes of a GLB: its leaves are what is made of "leaf".
pub(super) fn read(glb: Vec<u8>) -> Tree {
    let leaves = [Selector::Material("leaf".to_owned())];
    let document = Document::from_bytes("fixture.glb", glb, None).unwrap();
    document.into_tree(&leaves).unwrap()
}

fn component_bytes(component: u32, values: &[f64]) -> Vec<u8> {
    let bytes = |&value: &f64| match component {
        BYTE => (value as i8).to_le_bytes().to_vec(),
        UNSIGNED_BYTE => vec![value as u8],
        SHORT => (value as i16).to_le_bytes().to_vec(),
        UNSIGNED_SHORT => (value as u16).to_le_bytes().to_vec(),
        UNSIGNED_INT => (value as u32).to_le_bytes().to_vec(),
        _ => (value as f32).to_le_bytes().to_vec(),
    };
    values.iter().flat_map(bytes).collect()
}
