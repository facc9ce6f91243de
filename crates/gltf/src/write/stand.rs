//! A scene of many plants: what they are made of is there once, however many of them draw it.

use std::collections::HashMap;

use glam::{DMat4, DQuat, DVec3};
use serde_json::{Map, Value, json};

use super::references::{as_index, items};
use crate::container::glb_bytes;
use crate::error::{At, Fault, Problem};
use crate::material_images::for_each_texture;
use crate::write_problem::WriteProblem;
use crate::{Document, GltfError, property};

/// Views start at multiples of this many bytes.
const ALIGNMENT: usize = 4;

/// Extensions by which data is compressed: here it is not.
const COMPRESSIONS: [&str; 3] = [
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_draco_mesh_compression",
];

/// A glTF scene that is put together of others. Equal meshes, materials, images and bytes are written once.
#[derive(Debug, Default)]
pub struct StandWriter {
    lists: Map<String, Value>,
    nodes: Vec<Value>,
    roots: Vec<usize>,
    buffer: Vec<u8>,
    /// The places of what is there, by list and text; of bytes by themselves.
    known: HashMap<(&'static str, String), usize>,
    views: HashMap<Vec<u8>, usize>,
    extensions: [Vec<String>; 2],
}

/// What the scene of a file draws, ready to be placed.
#[derive(Clone, Debug)]
pub struct StandPart {
    /// Its root nodes, children within them.
    roots: Vec<Value>,
}

impl StandWriter {
    /// Takes in what the scene of a file draws.
    ///
    /// # Errors
    /// [`GltfError`] if it can't be read, or is skinned.
    pub fn part(&mut self, document: &Document) -> Result<StandPart, GltfError> {
        let mut read = || -> Result<StandPart, Fault> {
            for (list, all) in ["extensionsUsed", "extensionsRequired"]
                .iter()
                .zip(&mut self.extensions)
            {
                let names = property::list(&document.root, list)?;
                for name in names.iter().filter_map(Value::as_str) {
                    if !COMPRESSIONS.contains(&name) && !all.iter().any(|known| known == name) {
                        all.push(name.to_owned());
                    }
                }
            }
            let mut taking = Taking {
                writer: self,
                document,
                images: HashMap::new(),
            };
            let nodes = document.placed_nodes()?;
            let roots = nodes.iter().filter(|node| node.parent.is_none());
            let roots = roots
                .map(|node| taking.node(node.index))
                .collect::<Result<_, _>>()?;
            Ok(StandPart { roots })
        };
        read().map_err(|fault| document.error(fault))
    }

    /// Puts a part somewhere, as a node of this name.
    pub fn place(&mut self, name: &str, part: &StandPart, world_from_own: DMat4, extras: Value) {
        let mut node = json!({ "name": name });
        set_transform(&mut node, world_from_own);
        match &part.roots[..] {
            // A node without a place of its own stands where the part does.
            [root]
                if ["translation", "rotation", "scale", "matrix"]
                    .iter()
                    .all(|key| root.get(key).is_none()) =>
            {
                let fields = root.as_object().into_iter().flatten();
                for (key, value) in fields.filter(|(key, _)| *key != "name") {
                    node[key] = value.clone();
                }
            }
            roots => node["children"] = roots.to_vec().into(),
        }
        node["extras"] = extras;
        let number = self.push_node(node);
        self.roots.push(number);
    }

    /// The scene as a GLB; `name` is what errors call it.
    ///
    /// # Errors
    /// [`GltfError`] beyond 4 GiB.
    pub fn to_glb(&self, name: &str) -> Result<Vec<u8>, GltfError> {
        let mut root = json!({
            "asset": { "version": "2.0", "generator": "secateur" },
            "scene": 0,
            "scenes": [{ "nodes": self.roots }],
        });
        if self.roots.is_empty() {
            root["scenes"] = json!([{}]);
        } else {
            root["nodes"] = self.nodes.clone().into();
        }
        for (list, entries) in &self.lists {
            root[list] = entries.clone();
        }
        if !self.buffer.is_empty() {
            let length = self.buffer.len().next_multiple_of(ALIGNMENT);
            root["buffers"] = json!([{ "byteLength": length }]);
        }
        let text = root.to_string();
        for (list, names) in ["extensionsUsed", "extensionsRequired"]
            .iter()
            .zip(&self.extensions)
        {
            // Quantised attributes name no extension where they are.
            let is_used = |name: &&String| {
                *name == "KHR_mesh_quantization" || text.contains(&format!("\"{name}\""))
            };
            let used: Vec<&String> = names.iter().filter(is_used).collect();
            if !used.is_empty() {
                root[*list] = json!(used);
            }
        }
        let glb = glb_bytes(&root, self.buffer.clone());
        glb.ok_or_else(|| GltfError::new(name, Problem::from(WriteProblem::TooLarge)))
    }

    fn push_node(&mut self, mut node: Value) -> usize {
        if let Some(Value::Array(children)) = node.get_mut("children").map(Value::take) {
            let children: Vec<usize> = children.into_iter().map(|c| self.push_node(c)).collect();
            node["children"] = json!(children);
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// The number of an entry of a list, which is added where it is new.
    fn entry(&mut self, list: &'static str, entry: Value) -> usize {
        let entries = self.lists.entry(list).or_insert_with(|| json!([]));
        let Value::Array(entries) = entries else {
            unreachable!("lists are arrays");
        };
        *self
            .known
            .entry((list, entry.to_string()))
            .or_insert_with(|| {
                entries.push(entry);
                entries.len() - 1
            })
    }

    /// The number of a view of these bytes.
    fn view(&mut self, bytes: &[u8], fields: Value) -> usize {
        if let Some(known) = self.views.get(bytes) {
            return *known;
        }
        self.buffer
            .resize(self.buffer.len().next_multiple_of(ALIGNMENT), 0);
        let mut view = fields;
        view["buffer"] = 0.into();
        view["byteOffset"] = self.buffer.len().into();
        view["byteLength"] = bytes.len().into();
        self.buffer.extend_from_slice(bytes);
        let number = self.entry("bufferViews", view);
        self.views.insert(bytes.to_vec(), number);
        number
    }
}

/// A file that is taken in.
struct Taking<'w, 'd> {
    writer: &'w mut StandWriter,
    document: &'d Document,
    images: HashMap<usize, usize>,
}

impl Taking<'_, '_> {
    /// A node with its children in it.
    fn node(&mut self, index: usize) -> Result<Value, Fault> {
        let place = || self.document.place("nodes", index);
        let mut node = property::entry(&self.document.root, "nodes", index)?.clone();
        if node.get("skin").is_some() {
            return Err(Problem::Skinned).at(place);
        }
        let fields = node.as_object_mut();
        if let Some(fields) = fields {
            fields.retain(|key, _| !["extras", "camera", "weights"].contains(&key.as_str()));
        }
        if let Some(mesh) = property::index(&node, "mesh").at(place)? {
            node["mesh"] = self.mesh(mesh)?.into();
        }
        let attributes = node.pointer_mut("/extensions/EXT_mesh_gpu_instancing/attributes");
        for number in attributes
            .and_then(Value::as_object_mut)
            .into_iter()
            .flat_map(|all| all.values_mut())
        {
            self.renumber(number, Self::accessor)?;
        }
        let children = property::list(&node, "children").at(place)?.to_vec();
        let mut taken = Vec::new();
        for child in &children {
            taken.push(self.node(property::list_index("children", child).at(place)?)?);
        }
        if !taken.is_empty() {
            node["children"] = taken.into();
        }
        Ok(node)
    }

    fn renumber(
        &mut self,
        number: &mut Value,
        take: fn(&mut Self, usize) -> Result<usize, Fault>,
    ) -> Result<(), Fault> {
        if let Some(index) = as_index(number) {
            *number = take(self, index)?.into();
        }
        Ok(())
    }

    fn mesh(&mut self, index: usize) -> Result<usize, Fault> {
        let mut mesh = property::entry(&self.document.root, "meshes", index)?.clone();
        for primitive in items(&mut mesh, "primitives") {
            let attributes = primitive
                .get_mut("attributes")
                .and_then(Value::as_object_mut);
            for number in attributes.into_iter().flat_map(|all| all.values_mut()) {
                self.renumber(number, Self::accessor)?;
            }
            if let Some(number) = primitive.get_mut("indices") {
                self.renumber(number, Self::accessor)?;
            }
            if let Some(number) = primitive.get_mut("material") {
                self.renumber(number, Self::material)?;
            }
            if let Some(fields) = primitive.as_object_mut() {
                // Plants are at rest.
                fields.remove("targets");
                fields.remove("extensions");
            }
        }
        if let Some(fields) = mesh.as_object_mut() {
            fields.retain(|key, _| ["name", "primitives"].contains(&key.as_str()));
        }
        Ok(self.writer.entry("meshes", mesh))
    }

    fn accessor(&mut self, index: usize) -> Result<usize, Fault> {
        let mut accessor = property::entry(&self.document.root, "accessors", index)?.clone();
        if let Some(number) = accessor.get_mut("bufferView") {
            self.renumber(number, Self::view)?;
        }
        for part in ["indices", "values"] {
            let sparse = accessor
                .get_mut("sparse")
                .and_then(|sparse| sparse.get_mut(part));
            if let Some(number) = sparse.and_then(|part| part.get_mut("bufferView")) {
                self.renumber(number, Self::view)?;
            }
        }
        Ok(self.writer.entry("accessors", accessor))
    }

    fn view(&mut self, index: usize) -> Result<usize, Fault> {
        let json = property::entry(&self.document.root, "bufferViews", index)?;
        let kept = ["byteStride", "target"].into_iter();
        let kept = kept.filter_map(|key| Some((key.to_owned(), json.get(key)?.clone())));
        let fields: Map<String, Value> = kept.collect();
        let bytes = self.document.view_bytes(index)?;
        Ok(self.writer.view(&bytes, fields.into()))
    }

    fn material(&mut self, index: usize) -> Result<usize, Fault> {
        let mut material = property::entry(&self.document.root, "materials", index)?.clone();
        let mut textures = Vec::new();
        for_each_texture(&material, &mut |texture| textures.push(texture));
        let mut numbers = HashMap::new();
        for texture in textures {
            numbers.insert(texture, self.texture(texture)?);
        }
        renumber_textures(&mut material, &numbers);
        Ok(self.writer.entry("materials", material))
    }

    fn texture(&mut self, index: usize) -> Result<usize, Fault> {
        let mut texture = property::entry(&self.document.root, "textures", index)?.clone();
        if let Some(number) = texture.get_mut("sampler") {
            self.renumber(number, Self::sampler)?;
        }
        if let Some(number) = texture.get_mut("source") {
            self.renumber(number, Self::image)?;
        }
        let extensions = texture.get_mut("extensions").and_then(Value::as_object_mut);
        for extension in extensions.into_iter().flat_map(|all| all.values_mut()) {
            if let Some(number) = extension.get_mut("source") {
                self.renumber(number, Self::image)?;
            }
        }
        Ok(self.writer.entry("textures", texture))
    }

    fn sampler(&mut self, index: usize) -> Result<usize, Fault> {
        let sampler = property::entry(&self.document.root, "samplers", index)?.clone();
        Ok(self.writer.entry("samplers", sampler))
    }

    fn image(&mut self, index: usize) -> Result<usize, Fault> {
        if let Some(known) = self.images.get(&index) {
            return Ok(*known);
        }
        let mut image = property::entry(&self.document.root, "images", index)?.clone();
        if let Some(bytes) = self.document.encoded_image(index) {
            if image.get("mimeType").is_none() {
                image["mimeType"] = match bytes.starts_with(b"\xff\xd8") {
                    true => "image/jpeg".into(),
                    false => "image/png".into(),
                };
            }
            if let Some(fields) = image.as_object_mut() {
                fields.remove("uri");
            }
            image["bufferView"] = self.writer.view(&bytes, json!({})).into();
        }
        let number = self.writer.entry("images", image);
        self.images.insert(index, number);
        Ok(number)
    }
}

fn renumber_textures(material: &mut Value, numbers: &HashMap<usize, usize>) {
    let Some(fields) = material.as_object_mut() else {
        return;
    };
    for (name, value) in fields.iter_mut().filter(|(name, _)| *name != "extras") {
        let index = value.get("index").and_then(as_index);
        if let Some(number) = index
            .filter(|_| name.ends_with("Texture"))
            .and_then(|i| numbers.get(&i))
        {
            value["index"] = (*number).into();
        }
        renumber_textures(value, numbers);
    }
}

/// As translation, rotation and scale where that is the same, else as a matrix.
fn set_transform(node: &mut Value, matrix: DMat4) {
    if matrix == DMat4::IDENTITY {
        return;
    }
    let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
    let again = DMat4::from_scale_rotation_translation(scale, rotation, translation);
    let largest = matrix
        .to_cols_array()
        .iter()
        .fold(1.0f64, |a, b| a.max(b.abs()));
    if !again.abs_diff_eq(matrix, 1e-9 * largest) {
        node["matrix"] = json!(matrix.to_cols_array());
        return;
    }
    let as_f32 = |v: DVec3| v.to_array().map(|x| x as f32);
    if translation != DVec3::ZERO {
        node["translation"] = json!(as_f32(translation));
    }
    if !rotation.abs_diff_eq(DQuat::IDENTITY, 1e-12) {
        node["rotation"] = json!(rotation.to_array().map(|x| x as f32));
    }
    if !scale.abs_diff_eq(DVec3::ONE, 1e-9) {
        node["scale"] = json!(as_f32(scale));
    }
}
