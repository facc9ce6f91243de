//! A tree of two leaves, built in code, to be bent into every encoding.

use glam::DVec3;
use secateur_gltf::{Document, Tree};
use serde_json::{Value, json};

/// Two unit squares in the planes z = 0 and z = 2, two triangles each.
pub(crate) const SQUARES: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 2.0],
    [1.0, 0.0, 2.0],
    [1.0, 1.0, 2.0],
    [0.0, 1.0, 2.0],
];

/// The triangles of [`SQUARES`].
pub(crate) const INDICES: [u16; 12] = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];

/// JSON and the bytes of its one buffer.
#[derive(Clone)]
pub(crate) struct SmallTree {
    pub(crate) root: Value,
    pub(crate) bytes: Vec<u8>,
}

impl SmallTree {
    /// A scene of one node with one mesh of no primitives, material 0 named
    /// `leaf`.
    pub(crate) fn empty() -> Self {
        let root = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "crown"}],
            "meshes": [{"primitives": []}],
            "materials": [{"name": "leaf"}],
            "accessors": [],
            "bufferViews": [],
        });
        Self {
            root,
            bytes: Vec::new(),
        }
    }

    /// The two squares: accessor 0 positions (VEC3 of FLOAT), accessor 1
    /// indices (UNSIGNED_SHORT), each in the bufferView of the same number.
    pub(crate) fn squares() -> Self {
        let mut tree = Self::empty();
        let positions = tree.floats("VEC3", SQUARES.as_flattened());
        let indices = tree.shorts("SCALAR", &INDICES);
        tree.primitive(json!({
            "attributes": {"POSITION": positions}, "indices": indices, "material": 0
        }));
        tree
    }

    /// Adds a view of these bytes, on a multiple of four.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()
        });
        self.bytes.extend_from_slice(bytes);
        self.append("bufferViews", view)
    }

    /// Adds an entry to a list of the JSON and returns its number.
    pub(crate) fn append(&mut self, list: &str, entry: Value) -> usize {
        let entries = self.root.as_object_mut().unwrap();
        let entries = entries.entry(list).or_insert_with(|| json!([]));
        let entries = entries.as_array_mut().unwrap();
        entries.push(entry);
        entries.len() - 1
    }

    /// Adds a view and an accessor over all of it.
    pub(crate) fn accessor(&mut self, kind: &str, code: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.append(
            "accessors",
            json!({"bufferView": view, "type": kind, "componentType": code, "count": count}),
        )
    }

    pub(crate) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len() / width(kind), &bytes)
    }

    pub(crate) fn shorts(&mut self, kind: &str, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(kind, 5123, values.len() / width(kind), &bytes)
    }

    /// Adds a primitive to mesh 0.
    pub(crate) fn primitive(&mut self, primitive: Value) {
        let primitives = &mut self.root["meshes"][0]["primitives"];
        primitives.as_array_mut().unwrap().push(primitive);
    }

    /// Adds a PNG image and a texture of it.
    pub(crate) fn texture(&mut self, texels: &image::RgbaImage) {
        let mut png = std::io::Cursor::new(Vec::new());
        texels.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let view = self.view(png.get_ref());
        let image = json!({"bufferView": view, "mimeType": "image/png"});
        let image = self.append("images", image);
        self.append("textures", json!({"source": image}));
    }

    /// Puts a value into the JSON; the last step of the path may be new.
    pub(crate) fn set(mut self, path: &str, value: Value) -> Self {
        let (parent, key) = path.rsplit_once('/').unwrap();
        let parent = self.root.pointer_mut(parent).expect(path);
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            other => other[key] = value,
        }
        self
    }

    /// Takes a property out of the JSON.
    pub(crate) fn without(mut self, path: &str) -> Self {
        let (parent, key) = path.rsplit_once('/').unwrap();
        let parent = self.root.pointer_mut(parent).unwrap();
        parent.as_object_mut().unwrap().remove(key).expect(path);
        self
    }

    /// As a GLB; a buffer of all bytes is added where the JSON has none.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut root = self.root.clone();
        if root.get("buffers").is_none() {
            root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        }
        let mut json = serde_json::to_vec(&root).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut chunk = self.bytes.clone();
        chunk.resize(chunk.len().next_multiple_of(4), 0);
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((28 + json.len() as u32 + chunk.len() as u32).to_le_bytes());
        out.extend((json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(json);
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(chunk);
        out
    }

    pub(crate) fn document(&self) -> Document {
        Document::from_bytes("small.glb", self.glb(), None).unwrap()
    }

    /// The tree whose material `leaf` is foliage.
    pub(crate) fn tree(&self) -> Tree {
        let selectors = ["material:leaf".parse().unwrap()];
        self.document().into_tree(&selectors).unwrap()
    }

    /// The sentence of the error that reading it ends in.
    pub(crate) fn error(&self) -> String {
        let selectors = ["material:leaf".parse().unwrap()];
        let read = Document::from_bytes("small.glb", self.glb(), None)
            .and_then(|document| document.into_tree(&selectors));
        read.expect_err("a broken file is refused").to_string()
    }
}

fn width(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        _ => 4,
    }
}

/// The centres of a tree's leaves.
pub(crate) fn centres(tree: &Tree) -> Vec<DVec3> {
    tree.foliage()
        .leaves()
        .iter()
        .map(|leaf| leaf.centre())
        .collect()
}

/// Every encoding of the two squares gives these leaves.
#[track_caller]
pub(crate) fn assert_two_squares(tree: &SmallTree) {
    let tree = tree.tree();
    let found = centres(&tree);
    let expected = [DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.5, 0.5, 2.0)];
    assert_eq!(found.len(), 2, "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((*found - expected).length() < 1e-12, "{found} {expected}");
    }
    assert!(
        tree.foliage()
            .leaves()
            .iter()
            .all(|l| (l.area() - 1.0).abs() < 1e-12)
    );
    assert_eq!(tree.triangle_count(), 4);
}
