//! Nodes that go.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::draft::Draft;
use super::drop_unreferenced::{drop_extension, remove_field};
use super::references::{as_index, items, knows_all_extensions, visit_node_numbers};
use super::single_leaf_mesh::animated_and_joint_nodes;
use crate::tree::Tree;

/// The extension that names coarser levels of a node.
pub(super) const LEVELS_EXTENSION: &str = "MSFT_lod";

/// Where the node says from which size on its levels are drawn.
const COVERAGE: &str = "MSFT_screencoverage";

/// Takes the coarser levels that the file has out of the scene. Returns the nodes that nothing names any more.
pub(super) fn leave_out_levels(draft: &mut Draft, tree: &Tree) -> BTreeSet<usize> {
    let levels = &tree.levels_inside;
    draft.notes.extend(tree.document.note_of_levels(levels));
    let mut gone = BTreeSet::new();
    if levels.nodes.is_empty() {
        return gone;
    }
    levels.nodes.iter().for_each(|&node| take_away(draft, node));
    for node in items(&mut draft.root, "nodes") {
        forget_levels(node);
    }
    drop_extension(&mut draft.root, LEVELS_EXTENSION, |_| false);
    // What moves, or moves others, stays, without a mesh.
    let moving = animated_and_joint_nodes(&draft.root);
    let nodes = &draft.root["nodes"];
    let is_needed = |node: &usize| moving.contains(node) || nodes[*node].get("camera").is_some();
    if !levels.nodes.iter().any(is_needed) {
        gone.clone_from(&levels.nodes);
    }
    unlink(draft, &gone);
    gone
}

/// Leaves a node in its place, drawing nothing, without levels of its own.
pub(super) fn take_away(draft: &mut Draft, node: usize) {
    draft.take_mesh_away(node);
    drop_levels_extension(&mut draft.root["nodes"][node]);
}

fn forget_levels(node: &mut Value) {
    drop_levels_extension(node);
    let Some(extras) = node.get_mut("extras").and_then(Value::as_object_mut) else {
        return;
    };
    if extras.shift_remove(COVERAGE).is_some() && extras.is_empty() {
        remove_field(node, "extras");
    }
}

fn drop_levels_extension(node: &mut Value) {
    if let Some(extensions) = node.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.shift_remove(LEVELS_EXTENSION);
        if extensions.is_empty() {
            remove_field(node, "extensions");
        }
    }
}

/// Takes nodes from the lists of their parents and scenes.
pub(super) fn unlink(draft: &mut Draft, gone: &BTreeSet<usize>) {
    let is_gone = |number: &Value| as_index(number).is_some_and(|node| gone.contains(&node));
    for (list, members) in [("nodes", "children"), ("scenes", "nodes")] {
        for holder in items(&mut draft.root, list) {
            let Some(numbers) = holder.get_mut(members).and_then(Value::as_array_mut) else {
                continue;
            };
            numbers.retain(|number| !is_gone(number));
            if numbers.is_empty() {
                remove_field(holder, members);
            }
        }
    }
}

/// Drops nodes that nothing names. Nodes behind them move up, unless an
/// extension that is not known might name one: then an empty node keeps the place.
pub(super) fn drop_nodes(root: &mut Value, gone: &BTreeSet<usize>) {
    if gone.is_empty() {
        return;
    }
    if !knows_all_extensions(root) {
        for &node in gone {
            root["nodes"][node] = json!({});
        }
        return;
    }
    visit_node_numbers(root, &mut |number| {
        if let Some(node) = as_index(number) {
            *number = (node - gone.range(..node).count()).into();
        }
    });
    if let Some(nodes) = root.get_mut("nodes").and_then(Value::as_array_mut) {
        let mut number = 0..;
        nodes.retain(|_| number.next().is_some_and(|node| !gone.contains(&node)));
    }
}
