//! Whether the levels of a tree can be one mesh each.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use serde_json::Value;

use super::super::references::as_index;
use super::super::single_leaf_mesh::animated_and_joint_nodes;
use crate::tree::Tree;

/// What a level of one mesh takes over from the nodes of the tree.
pub(super) struct OneMesh {
    /// The skin of all nodes that draw, if they have one: then vertices stay
    /// where they are, as the transforms of such nodes count for nothing.
    pub(super) skin: Option<usize>,
    /// Weights and names of the morph targets, and how many there are.
    pub(super) morphs: Option<Morphs>,
    /// Extras that all meshes share.
    pub(super) mesh_extras: Option<Value>,
    /// The nodes that draw, in traversal order.
    pub(super) drawn: Vec<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Morphs {
    pub(super) count: usize,
    pub(super) weights: Option<Value>,
    names: Option<Value>,
}

/// Why the levels keep the node tree, as the end of a sentence.
pub(super) type Obstacle = String;

/// How the tree becomes one mesh a level, or why it cannot.
pub(super) fn one_mesh(tree: &Tree) -> Result<OneMesh, Obstacle> {
    let root = &tree.document.root;
    let mut seen = HashSet::new();
    let drawn: Vec<usize> = tree
        .parts
        .iter()
        .map(|part| part.node)
        .filter(|&node| seen.insert(node))
        .collect();
    let name = |node: usize| tree.document.place("nodes", node);
    let is_instanced = |&&node: &&usize| {
        let pointer = "/extensions/EXT_mesh_gpu_instancing";
        root["nodes"][node].pointer(pointer).is_some()
    };
    if let Some(&node) = drawn.iter().find(is_instanced) {
        return Err(format!("{} is instanced", name(node)));
    }
    let skins: BTreeSet<Option<usize>> = drawn
        .iter()
        .map(|&node| root["nodes"][node].get("skin").and_then(as_index))
        .collect();
    if skins.len() > 1 {
        return Err(match skins.contains(&None) {
            true => "some of its meshes are skinned and some are not".to_owned(),
            false => "its meshes have several skins".to_owned(),
        });
    }
    let skin = skins.first().copied().flatten();
    let moved_by_others = animated_and_joint_nodes(root);
    let parents = parents(root);
    for &node in &drawn {
        // A skinned mesh stands where its joints are; its own node may only
        // not have weights that are animated.
        let mut above = Some(node);
        while let Some(moving) = above {
            if moved_by_others.contains(&moving) {
                return Err(format!(
                    "{} is moved by an animation or a skeleton",
                    name(moving)
                ));
            }
            above = match skin {
                Some(_) => None,
                None => parents.get(&moving).copied(),
            };
        }
    }
    Ok(OneMesh {
        skin,
        morphs: morphs(root, &drawn)?,
        mesh_extras: mesh_extras(root, &drawn),
        drawn,
    })
}

/// The parent of each node that has one.
pub(super) fn parents(root: &Value) -> BTreeMap<usize, usize> {
    let mut parents = BTreeMap::new();
    let nodes = root.get("nodes").and_then(Value::as_array);
    for (number, node) in nodes.into_iter().flatten().enumerate() {
        let children = node.get("children").and_then(Value::as_array);
        let children = children.into_iter().flatten().filter_map(as_index);
        parents.extend(children.map(|child| (child, number)));
    }
    parents
}

fn morphs(root: &Value, drawn: &[usize]) -> Result<Option<Morphs>, Obstacle> {
    let mut found: Option<Morphs> = None;
    for &node in drawn {
        let node = &root["nodes"][node];
        let Some(mesh) = node.get("mesh").and_then(as_index) else {
            continue;
        };
        let mesh = &root["meshes"][mesh];
        let primitives = mesh.get("primitives").and_then(Value::as_array);
        let counts = primitives.into_iter().flatten().map(|primitive| {
            let targets = primitive.get("targets").and_then(Value::as_array);
            targets.map_or(0, Vec::len)
        });
        let count = counts.max().unwrap_or(0);
        if count == 0 {
            continue;
        }
        let morphs = Morphs {
            count,
            weights: node.get("weights").or(mesh.get("weights")).cloned(),
            names: mesh.pointer("/extras/targetNames").cloned(),
        };
        if found.get_or_insert_with(|| morphs.clone()) != &morphs {
            return Err("its meshes have several sets of morph targets".to_owned());
        }
    }
    Ok(found)
}

/// The extras of the meshes, where all that have some have the same.
fn mesh_extras(root: &Value, drawn: &[usize]) -> Option<Value> {
    let meshes = drawn
        .iter()
        .filter_map(|&node| root["nodes"][node].get("mesh").and_then(as_index));
    let mut extras = meshes.filter_map(|mesh| root["meshes"][mesh].get("extras"));
    let first = extras.next()?;
    extras.all(|other| other == first).then(|| first.clone())
}
