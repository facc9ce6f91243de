//! The kinds of things in a scene, and where each stands.
//!
//! A thing is a node with a mesh, with all that hangs on it; or a node of several meshes, where its like occurs more than
//! once or its children are meshes without a place of their own. Things are of one kind where they are the same but for their own transform: the same meshes, at the same
//! places below. Each instance of EXT_mesh_gpu_instancing is a thing.

use std::collections::{HashMap, HashSet};

use glam::DMat4;
use serde_json::{Value, json};

use super::error::{At, Fault, Problem};
use super::node::PlacedNode;
use super::parts::check_limit;
use super::property;
use super::{Document, GltfError};

/// The most things in a scene.
pub const MAX_THINGS: u64 = 1 << 20;

/// What places a node, and is no part of its kind.
const OF_PLACE: [&str; 5] = ["translation", "rotation", "scale", "matrix", "name"];

/// Things of a scene that are alike.
#[derive(Clone, Debug)]
pub struct SceneKind {
    /// The name of the first one's mesh, else of its node; unlike those of the other kinds.
    pub name: String,
    /// A file that holds one of them, at the origin.
    pub document: Document,
    /// Where they stand, in the order of the file.
    pub placements: Vec<Placement>,
}

/// Where a thing stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// The name of its node, which may be that of others.
    pub name: String,
    /// From the thing's own space to the scene's.
    pub world_from_own: DMat4,
}

/// What a node and all below it is, as a number: equal ones are alike.
type Likeness = usize;

impl Document {
    /// The kinds of things in the scene, in the order of their first ones.
    ///
    /// # Errors
    /// [`GltfError`] if nodes or instances can't be read, or there are more than [`MAX_THINGS`].
    pub fn scene_kinds(&self) -> Result<Vec<SceneKind>, GltfError> {
        self.kinds().map_err(|fault| self.error(fault))
    }

    fn kinds(&self) -> Result<Vec<SceneKind>, Fault> {
        let nodes = self.placed_nodes()?;
        let likenesses = self.likenesses(&nodes)?;
        let mut of_likeness: HashMap<Likeness, usize> = HashMap::new();
        let mut kinds: Vec<(PlacedNode, Vec<Placement>)> = Vec::new();
        let mut inside: HashSet<usize> = HashSet::new();
        let mut count = 0;
        let mut times: HashMap<Likeness, usize> = HashMap::new();
        for (likeness, _) in likenesses.values() {
            *times.entry(*likeness).or_default() += 1;
        }
        for node in &nodes {
            if node.parent.is_some_and(|parent| inside.contains(&parent)) {
                inside.insert(node.index);
                continue;
            }
            let json = property::entry(&self.root, "nodes", node.index)?;
            let (likeness, has_mesh) = likenesses[&node.index];
            let is_one = times[&likeness] > 1 || self.is_of_parts(json);
            let is_thing = json.get("mesh").is_some() || has_mesh && is_one;
            if !is_thing {
                continue;
            }
            inside.insert(node.index);
            let name = json.get("name").and_then(Value::as_str).unwrap_or("plant");
            let placed = |world_from_own| Placement {
                name: name.to_owned(),
                world_from_own,
            };
            let placements: Vec<Placement> = match self.instancing(node.index)? {
                None => vec![placed(node.world_from_node)],
                Some(instancing) => {
                    check_limit("plants in a scene", instancing.count as u64, MAX_THINGS)?;
                    let instances = self.node_from_instances(&instancing)?.into_iter();
                    let placed = instances.map(|instance| placed(node.world_from_node * instance));
                    placed.collect()
                }
            };
            if placements.iter().any(|p| !p.world_from_own.is_finite()) {
                return Err(Problem::NotFinite {
                    what: "the transform of node",
                    index: node.index,
                })
                .at(|| self.place("nodes", node.index));
            }
            count += placements.len() as u64;
            check_limit("plants in a scene", count, MAX_THINGS)?;
            let kind = *of_likeness.entry(likeness).or_insert_with(|| {
                kinds.push((*node, Vec::new()));
                kinds.len() - 1
            });
            kinds[kind].1.extend(placements);
        }
        let mut names = HashSet::new();
        let kind = |(node, placements): (PlacedNode, Vec<Placement>)| SceneKind {
            name: unlike(&mut names, self.kind_name(node.index)),
            document: self.alone(node.index),
            placements,
        };
        Ok(kinds.into_iter().map(kind).collect())
    }

    /// By node: what it is with all below it, and whether that has a mesh.
    fn likenesses(&self, nodes: &[PlacedNode]) -> Result<HashMap<usize, (Likeness, bool)>, Fault> {
        let mut numbers: HashMap<String, Likeness> = HashMap::new();
        let mut found: HashMap<usize, (Likeness, bool)> = HashMap::new();
        // Children come after their parents.
        for node in nodes.iter().rev() {
            let mut json = property::entry(&self.root, "nodes", node.index)?.clone();
            let mut has_mesh = json.get("mesh").is_some();
            let mut below = Vec::new();
            for child in property::list(&json, "children")? {
                let child = property::list_index("children", child)?;
                let (likeness, has) = found[&child];
                has_mesh |= has;
                let placed = property::entry(&self.root, "nodes", child)?;
                let place = OF_PLACE.map(|key| placed.get(key).filter(|_| key != "name").cloned());
                below.push(json!([likeness, place, placed.pointer(INSTANCING)]));
            }
            strip(&mut json);
            json["children"] = below.into();
            let next = numbers.len();
            let likeness = *numbers.entry(json.to_string()).or_insert(next);
            found.insert(node.index, (likeness, has_mesh));
        }
        Ok(found)
    }

    /// Whether all children of a node are meshes that stand where it does.
    fn is_of_parts(&self, node: &Value) -> bool {
        let children = node.get("children").and_then(Value::as_array);
        let is_part = |child: &Value| {
            let child = child
                .as_u64()
                .and_then(|k| self.root["nodes"].get(k as usize));
            child.is_some_and(|child| {
                let has_place = OF_PLACE
                    .iter()
                    .any(|key| *key != "name" && child.get(*key).is_some());
                child.get("mesh").is_some() && !has_place && child.pointer(INSTANCING).is_none()
            })
        };
        children.is_some_and(|all| all.iter().all(is_part))
    }

    fn kind_name(&self, node: usize) -> String {
        let json = &self.root["nodes"][node];
        let mesh = json.get("mesh").and_then(Value::as_u64);
        let mesh = mesh.and_then(|mesh| self.root["meshes"].get(mesh as usize));
        let name = |of: &Value| of.get("name").and_then(Value::as_str).map(str::to_owned);
        let name = mesh.and_then(name).or_else(|| name(json));
        // As names of nodes and files of levels have it.
        let name: String = name
            .unwrap_or_default()
            .chars()
            .filter(|c| !c.is_control() && !r#"/\:*?"<>|"#.contains(*c))
            .collect();
        match name.trim_start_matches('.') {
            "" => "plant".to_owned(),
            name => name.to_owned(),
        }
    }

    /// This file with one node alone in its scene, at the origin, and nothing that moves it.
    fn alone(&self, node: usize) -> Self {
        let mut alone = self.clone();
        let root = &mut alone.root;
        strip(&mut root["nodes"][node]);
        root["scenes"] = json!([{ "nodes": [node] }]);
        root["scene"] = 0.into();
        if let Some(fields) = root.as_object_mut() {
            fields.remove("animations");
        }
        alone.undecoded = None;
        alone
    }
}

const INSTANCING: &str = "/extensions/EXT_mesh_gpu_instancing";

/// Takes away what places a node.
fn strip(node: &mut Value) {
    let Some(fields) = node.as_object_mut() else {
        return;
    };
    for key in OF_PLACE.iter().chain(&["camera", "extras"]) {
        fields.remove(*key);
    }
    if let Some(extensions) = fields.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.remove("EXT_mesh_gpu_instancing");
        if extensions.is_empty() {
            fields.remove("extensions");
        }
    }
}

/// A name that none has yet.
fn unlike(names: &mut HashSet<String>, name: String) -> String {
    let mut own = name.clone();
    let mut number = 2;
    while !names.insert(own.clone()) {
        own = format!("{name}_{number}");
        number += 1;
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(nodes: Value, roots: Value) -> Vec<(String, usize)> {
        let file = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": roots }],
            "nodes": nodes,
            "meshes": [{ "name": "oak", "primitives": [] }, { "primitives": [] }],
        });
        let file = file.to_string().into_bytes();
        let document = Document::from_bytes("s.gltf", file, None).unwrap();
        let kinds = document.scene_kinds().unwrap();
        let kind = |kind: SceneKind| (kind.name, kind.placements.len());
        kinds.into_iter().map(kind).collect()
    }

    #[test]
    fn nodes_of_one_mesh_are_one_kind_wherever_they_stand() {
        let found = kinds(
            json!([
                { "name": "forest", "children": [1, 2], "translation": [5, 0, 0] },
                { "name": "a", "mesh": 0, "translation": [1, 0, 0] },
                { "name": "b", "mesh": 0, "scale": [2, 2, 2] },
                { "name": "rock", "mesh": 1 },
            ]),
            json!([0, 3]),
        );
        assert_eq!(found, [("oak".to_owned(), 2), ("rock".to_owned(), 1)]);
    }

    #[test]
    fn meshes_in_one_place_are_one_thing() {
        let part = json!({ "mesh": 0 });
        let tree = json!({ "name": "tree", "children": [1, 2] });
        let found = kinds(json!([tree, part, { "mesh": 1 }]), json!([0]));
        assert_eq!(found, [("tree".to_owned(), 1)]);
    }

    /// A trunk and a crown below one node: two such nodes are two of a kind, a third whose crown sits higher is another.
    #[test]
    fn several_meshes_below_a_node_are_one_thing_where_that_occurs_again() {
        let crown = |y: f64| json!({ "mesh": 1, "translation": [0, y, 0] });
        let found = kinds(
            json!([
                { "name": "tree", "children": [1, 2] }, { "mesh": 0 }, crown(3.0),
                { "name": "tree", "children": [4, 5], "translation": [9, 0, 0] }, { "mesh": 0 }, crown(3.0),
                { "name": "tall", "children": [7, 8] }, { "mesh": 0 }, crown(5.0),
            ]),
            json!([0, 3, 6]),
        );
        let expected = [("tree", 2), ("oak", 1), ("plant", 1)];
        assert_eq!(
            found,
            expected.map(|(name, count)| (name.to_owned(), count))
        );
    }
}
