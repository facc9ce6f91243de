//! What it costs a client to draw a file or a level in it.

use std::collections::{BTreeSet, HashSet};

use serde_json::Value;

use super::Document;
use super::material_images::for_each_texture;

/// The extension by which one node draws many times.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// What it costs to draw a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LevelCost {
    /// Primitives that are drawn, each instance counted.
    pub draws: u64,
    /// Bytes that the level takes in its file: the whole file where it has one of its own; else what lies in buffers for
    /// it and for no finer level.
    pub bytes: u64,
    /// Bytes of all vertices and indices that it draws from, as the file has them, shared ones counted once.
    pub geometry_bytes: u64,
}

/// Buffer views that were counted already.
pub(crate) type Counted = HashSet<u64>;

impl Document {
    /// What it costs to draw its scene, all of it; `bytes` are those of its buffers that it draws from.
    pub fn cost(&self) -> LevelCost {
        let scene = self.root.get("scene").and_then(Value::as_u64).unwrap_or(0);
        let roots = entry(&self.root, "scenes", Some(scene)).and_then(|scene| scene.get("nodes"));
        let roots: Vec<u64> = numbers(roots).collect();
        LevelCost::below(&self.root, &roots, &mut Counted::default())
    }
}

impl LevelCost {
    /// What it costs to draw the level whose node has this name.
    pub(crate) fn of_level(root: &Value, name: &str, counted: &mut Counted) -> Self {
        let nodes = root.get("nodes").and_then(Value::as_array);
        let named = |node: &Value| node.get("name").and_then(Value::as_str) == Some(name);
        let place = nodes.and_then(|nodes| nodes.iter().position(named));
        let roots: Vec<u64> = place.into_iter().map(|place| place as u64).collect();
        Self::below(root, &roots, counted)
    }

    fn below(root: &Value, roots: &[u64], counted: &mut Counted) -> Self {
        let mut cost = LevelCost::default();
        let mut accessors = BTreeSet::new();
        let mut materials = BTreeSet::new();
        let mut nodes = roots.to_vec();
        let mut seen = HashSet::new();
        while let Some(number) = nodes.pop() {
            let Some(node) = entry(root, "nodes", Some(number)).filter(|_| seen.insert(number))
            else {
                continue;
            };
            nodes.extend(numbers(node.get("children")));
            let mesh = entry(root, "meshes", node.get("mesh").and_then(Value::as_u64));
            let primitives = mesh.and_then(|mesh| mesh.get("primitives")?.as_array());
            for primitive in primitives.into_iter().flatten() {
                cost.draws += instances(root, node);
                let attributes = primitive.get("attributes").and_then(Value::as_object);
                accessors.extend(
                    attributes
                        .into_iter()
                        .flat_map(|all| all.values())
                        .filter_map(Value::as_u64),
                );
                accessors.extend(primitive.get("indices").and_then(Value::as_u64));
                materials.extend(primitive.get("material").and_then(Value::as_u64));
            }
        }
        let mut views = BTreeSet::new();
        for number in accessors {
            let Some(accessor) = entry(root, "accessors", Some(number)) else {
                continue;
            };
            cost.geometry_bytes += accessor_bytes(accessor);
            views.extend(accessor.get("bufferView").and_then(Value::as_u64));
        }
        for number in materials {
            let material = entry(root, "materials", Some(number)).unwrap_or(&Value::Null);
            for_each_texture(material, &mut |texture| {
                views.extend(views_of_texture(root, texture as u64));
            });
        }
        let added = views.into_iter().filter(|view| counted.insert(*view));
        let lengths = added.filter_map(|view| {
            entry(root, "bufferViews", Some(view))?
                .get("byteLength")?
                .as_u64()
        });
        cost.bytes = lengths.sum();
        cost
    }
}

/// Bytes of an accessor's elements, packed tightly.
fn accessor_bytes(accessor: &Value) -> u64 {
    let number = |key| accessor.get(key).and_then(Value::as_u64).unwrap_or(0);
    let bytes = match number("componentType") {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        _ => 4,
    };
    let components = match accessor.get("type").and_then(Value::as_str) {
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4" | "MAT2") => 4,
        Some("MAT3") => 9,
        Some("MAT4") => 16,
        _ => 1,
    };
    number("count").saturating_mul(bytes * components)
}

/// The views of the images of a texture, in extensions too.
fn views_of_texture(root: &Value, texture: u64) -> Vec<u64> {
    let Some(texture) = entry(root, "textures", Some(texture)) else {
        return Vec::new();
    };
    let extensions = texture.get("extensions").and_then(Value::as_object);
    let of_extensions = extensions.into_iter().flat_map(|all| all.values());
    let sources = [texture].into_iter().chain(of_extensions);
    let images = sources.filter_map(|from| from.get("source")?.as_u64());
    images
        .filter_map(|image| {
            entry(root, "images", Some(image))?
                .get("bufferView")?
                .as_u64()
        })
        .collect()
}

/// How many times a node draws its mesh.
fn instances(root: &Value, node: &Value) -> u64 {
    let attributes = node
        .pointer(&format!("/extensions/{INSTANCING}/attributes"))
        .and_then(Value::as_object);
    let first = attributes.and_then(|all| all.values().next()?.as_u64());
    let count =
        entry(root, "accessors", first).and_then(|accessor| accessor.get("count")?.as_u64());
    count.unwrap_or(1)
}

fn entry<'a>(root: &'a Value, list: &str, number: Option<u64>) -> Option<&'a Value> {
    root.get(list)?.get(usize::try_from(number?).ok()?)
}

fn numbers(list: Option<&Value>) -> impl Iterator<Item = u64> + '_ {
    let list = list.and_then(Value::as_array);
    list.into_iter().flatten().filter_map(Value::as_u64)
}
