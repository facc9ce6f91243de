//! Where a plant stands. What its one root says stays in the nodes of levels, and their meshes are about the
//! plant's own pivot: an engine that puts a level somewhere finds its foot there.

use std::collections::HashSet;

use glam::{DMat4, DVec3};
use serde_json::{Value, json};

use super::super::single_leaf_mesh::animated_and_joint_nodes;
use super::plan::parents;
use super::scene::children;
use crate::property::numbers;
use crate::tree::Tree;

/// The pivot of the plant in the scene: that of the first node which moves it, from the root that holds all of
/// it down. Zero where several roots do, where it is skinned, or where that node is moved by others.
pub(super) fn placement(tree: &Tree) -> DVec3 {
    let Some(node) = placing_node(tree) else {
        return DVec3::ZERO;
    };
    let placed = tree.document.placed_nodes().into_iter().flatten();
    let mut of_node = placed.filter(|placed| placed.index == node);
    let world = of_node.next().map(|placed| placed.world_from_node);
    world.map_or(DVec3::ZERO, |world| world.w_axis.truncate())
}

fn placing_node(tree: &Tree) -> Option<usize> {
    let root = &tree.document.root;
    let drawing: HashSet<usize> = tree.parts.iter().map(|part| part.node).collect();
    if drawing
        .iter()
        .any(|&node| root["nodes"][node].get("skin").is_some())
    {
        return None;
    }
    let parents = parents(root);
    let mut holding: HashSet<usize> = HashSet::new();
    let mut roots: HashSet<usize> = HashSet::new();
    for &node in &drawing {
        let mut top = node;
        holding.insert(node);
        while let Some(&parent) = parents.get(&top) {
            holding.insert(parent);
            top = parent;
        }
        roots.insert(top);
    }
    let moved_by_others = animated_and_joint_nodes(root);
    let mut node = *roots.iter().next().filter(|_| roots.len() == 1)?;
    loop {
        if moved_by_others.contains(&node) {
            return None;
        }
        if translation(&root["nodes"][node]) != DVec3::ZERO {
            return Some(node);
        }
        let mut below = children(root, node)
            .into_iter()
            .filter(|child| holding.contains(child));
        let (only, None, false) = (below.next()?, below.next(), drawing.contains(&node)) else {
            return None;
        };
        node = only;
    }
}

/// How a node moves what it holds.
fn translation(node: &Value) -> DVec3 {
    let matrix = numbers::<16>(node, "matrix").ok().flatten();
    match matrix.map(|matrix| DMat4::from_cols_array(&matrix)) {
        Some(matrix) => matrix.w_axis.truncate(),
        None => numbers::<3>(node, "translation")
            .ok()
            .flatten()
            .map_or(DVec3::ZERO, DVec3::from_array),
    }
}

/// Moves a node of the scene by this.
pub(super) fn move_node(node: &mut Value, by: DVec3) {
    if by == DVec3::ZERO {
        return;
    }
    let moved = translation(node) + by;
    if let Some(matrix) = node.get_mut("matrix").and_then(Value::as_array_mut) {
        for (number, x) in matrix[12..].iter_mut().zip(moved.to_array()) {
            *number = json!(x);
        }
    } else if moved != DVec3::ZERO {
        node["translation"] = json!(moved.to_array());
    } else if let Some(fields) = node.as_object_mut() {
        fields.shift_remove("translation");
    }
}
