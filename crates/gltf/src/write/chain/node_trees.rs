//! Levels that keep the node tree: what cannot be put into one mesh stays as it
//! was, and every level has its own copy of the nodes that draw.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use serde_json::{Value, json};

use super::super::draft::Draft;
use super::super::leaf_edits::LeafEdits;
use super::super::meshes::rewrite_meshes;
use super::super::references::{as_index, items, len};
use super::super::single_leaf_mesh::animated_and_joint_nodes;
use super::placement::{move_node, placement};
use super::scene::{LevelNodes, children, holds_any, scene_roots};
use super::{Level, LevelContent, mesh_levels};
use crate::error::Fault;
use crate::roles::nodes_without_plant;
use crate::tree::Tree;

/// Makes a node of every level: the finest has the nodes of the file, the others
/// have copies. Skeletons stay where they are, and all levels move with them.
pub(super) fn build(draft: &mut Draft, tree: &Tree, levels: &[Level]) -> Result<LevelNodes, Fault> {
    let originals = draft.root.clone();
    let original = |list: &str| originals.get(list).cloned();
    let no_plant: HashSet<usize> = nodes_without_plant(&tree.parts, &tree.others)
        .into_iter()
        .collect();
    let (drawing, still): (Vec<usize>, Vec<usize>) = scene_roots(&draft.root)
        .into_iter()
        .partition(|&root| draws(&draft.root, root, &no_plant));
    let joints = animated_and_joint_nodes(&draft.root);
    let (with_tree, others) = still
        .into_iter()
        .partition(|&root| holds_any(&draft.root, root, &joints));
    let animations = original("animations").unwrap_or_default();
    let pivot = placement(tree);
    let mut lists: Option<[Value; 2]> = None;
    let mut level_nodes = Vec::new();
    for level in levels {
        let lod = match level.content {
            LevelContent::Tree(lod) => lod,
            LevelContent::Surface(surface) => {
                level_nodes.push(mesh_levels::push_node(draft, level, surface, pivot));
                if let Some(lists) = &mut lists {
                    *lists = ["nodes", "meshes"].map(|list| draft.root[list].clone());
                }
                continue;
            }
        };
        let edits = LeafEdits::new(tree, lod);
        let finest = lists.take();
        if finest.is_some() {
            for list in ["nodes", "meshes"] {
                draft.root[list] = original(list).unwrap_or_default();
            }
        }
        rewrite_meshes(draft, tree, &edits)?;
        let children = match finest {
            None => drawing.clone(),
            Some([nodes, meshes]) => {
                let of_level = [draft.root["nodes"].take(), draft.root["meshes"].take()];
                (draft.root["nodes"], draft.root["meshes"]) = (nodes, meshes);
                let mut copy = Copy {
                    of_level,
                    no_plant: &no_plant,
                    nodes: BTreeMap::new(),
                    meshes: BTreeMap::new(),
                };
                let copied: Vec<usize> = drawing
                    .iter()
                    .filter_map(|&root| copy.node(draft, root))
                    .collect();
                copy.animate(draft, &animations);
                copied
            }
        };
        for &child in &children {
            move_node(&mut draft.root["nodes"][child], -pivot);
        }
        let mut node = json!({"name": level.name});
        if !children.is_empty() {
            node["children"] = children.into();
        }
        if !level.facts.is_empty() {
            node["extras"] = level.facts.clone().into();
        }
        level_nodes.push(draft.push("nodes", node));
        lists = Some(["nodes", "meshes"].map(|list| draft.root[list].clone()));
    }
    Ok(LevelNodes {
        levels: level_nodes,
        with_tree,
        others,
        placement: pivot,
        needless: BTreeSet::new(),
    })
}

/// Whether a node, or one below it, draws something of the plant.
fn draws(root: &Value, node: usize, no_plant: &HashSet<usize>) -> bool {
    let mut left = vec![node];
    while let Some(node) = left.pop() {
        if root["nodes"][node].get("mesh").is_some() && !no_plant.contains(&node) {
            return true;
        }
        left.extend(children(root, node));
    }
    false
}

/// The nodes of a coarser level, as they are copied.
struct Copy<'o> {
    /// The lists of nodes and of meshes that the level would have by itself.
    of_level: [Value; 2],
    /// Nodes that draw nothing of the plant: there is no copy of what they draw.
    no_plant: &'o HashSet<usize>,
    /// The copies of nodes.
    nodes: BTreeMap<usize, usize>,
    /// The numbers of meshes in the chain.
    meshes: BTreeMap<usize, usize>,
}

impl Copy<'_> {
    /// Copies a node with all below it that draws, or nothing where that is
    /// nothing.
    fn node(&mut self, draft: &mut Draft, node: usize) -> Option<usize> {
        let mut copy = self.of_level[0][node].clone();
        if self.no_plant.contains(&node)
            && let Some(fields) = copy.as_object_mut()
        {
            fields.shift_remove("mesh");
        }
        let below = copy.get("children").and_then(Value::as_array).cloned();
        let below: Vec<usize> = below
            .into_iter()
            .flatten()
            .filter_map(|child| self.node(draft, as_index(&child)?))
            .collect();
        let mesh = copy.get("mesh").and_then(as_index);
        if mesh.is_none() && below.is_empty() {
            return None;
        }
        if let Some(fields) = copy.as_object_mut() {
            for once in ["children", "camera"] {
                fields.shift_remove(once);
            }
            let extensions = fields.get_mut("extensions").and_then(Value::as_object_mut);
            if let Some(extensions) = extensions {
                for once in ["KHR_lights_punctual", "MSFT_lod"] {
                    extensions.shift_remove(once);
                }
                if extensions.is_empty() {
                    fields.shift_remove("extensions");
                }
            }
        }
        if !below.is_empty() {
            copy["children"] = below.into();
        }
        if let Some(mesh) = mesh {
            copy["mesh"] = self.mesh(draft, mesh).into();
        }
        let number = draft.push("nodes", copy);
        self.nodes.insert(node, number);
        Some(number)
    }

    /// The number of a mesh in the chain. No two levels have the same mesh, though
    /// they may have the same vertices: Babylon.js draws what several nodes share
    /// as instances of the first, and takes a level away with its meshes when the
    /// next finer one is there.
    fn mesh(&mut self, draft: &mut Draft, mesh: usize) -> usize {
        if let Some(&known) = self.meshes.get(&mesh) {
            return known;
        }
        let number = draft.push("meshes", self.of_level[1][mesh].clone());
        self.meshes.insert(mesh, number);
        number
    }

    /// What moves a node moves its copy.
    fn animate(&self, draft: &mut Draft, originals: &Value) {
        let has_mesh: Vec<bool> = items(&mut draft.root, "nodes")
            .map(|node| node.get("mesh").is_some())
            .collect();
        for animation in 0..len(&draft.root, "animations") {
            let channels = originals[animation]
                .get("channels")
                .and_then(Value::as_array);
            for channel in channels.into_iter().flatten() {
                let Some(copied) = self.moved_copy(channel) else {
                    continue;
                };
                let is_lost = channel["target"]["path"] == "weights"
                    && copied["target"]
                        .get("node")
                        .and_then(as_index)
                        .is_some_and(|node| !has_mesh[node]);
                let channels = draft.root["animations"][animation]["channels"].as_array_mut();
                if let (Some(channels), false) = (channels, is_lost) {
                    channels.push(copied);
                }
            }
        }
    }

    /// The channel that does to a copy what this one does to the node.
    fn moved_copy(&self, channel: &Value) -> Option<Value> {
        const POINTER: &str = "/target/extensions/KHR_animation_pointer/pointer";
        let mut copied = channel.clone();
        if let Some(pointer) = copied.pointer_mut(POINTER) {
            let path = pointer.as_str()?.strip_prefix("/nodes/")?;
            let (node, rest) = path.split_once('/')?;
            let copy = self.nodes.get(&node.parse().ok()?)?;
            *pointer = format!("/nodes/{copy}/{rest}").into();
            return Some(copied);
        }
        let node = channel["target"].get("node").and_then(as_index)?;
        copied["target"]["node"] = (*self.nodes.get(&node)?).into();
        Some(copied)
    }
}
