//! Where the levels stand in the scene.

use std::collections::{BTreeSet, HashSet};

use glam::DVec3;
use serde_json::{Map, Value, json};

use super::super::draft::Draft;
use super::super::nodes::{LEVELS_EXTENSION, drop_nodes};
use super::super::references::{as_index, len};
use super::placement::move_node;
use super::{Layout, Level};

/// The nodes of a chain before it is put into the scene.
pub(super) struct LevelNodes {
    /// One a level, finest first.
    pub(super) levels: Vec<usize>,
    /// Roots of the scene that belong to the tree: its skeleton.
    pub(super) with_tree: Vec<usize>,
    /// Other roots of the scene.
    pub(super) others: Vec<usize>,
    /// Where the plant stands, in the scene: the levels' meshes are about this.
    pub(super) placement: DVec3,
    /// Nodes that nothing needs any more.
    pub(super) needless: BTreeSet<usize>,
}

/// Puts the levels into the scene.
pub(super) fn arrange(
    draft: &mut Draft,
    name: &str,
    levels: &[Level],
    layout: Layout,
    nodes: LevelNodes,
) {
    // What else moves with siblings stands where it stood.
    if layout != Layout::Siblings || !nodes.with_tree.is_empty() {
        for &node in &nodes.levels {
            move_node(&mut draft.root["nodes"][node], nodes.placement);
        }
    }
    let mut roots = Vec::new();
    match layout {
        Layout::Siblings => {
            let children: Vec<usize> = nodes
                .levels
                .iter()
                .chain(&nodes.with_tree)
                .copied()
                .collect();
            let mut parent = json!({"name": name, "children": children});
            if nodes.with_tree.is_empty() {
                move_node(&mut parent, nodes.placement);
            }
            roots.push(draft.push("nodes", parent));
        }
        Layout::Msft | Layout::Files | Layout::Usd => {
            roots.push(nodes.levels[0]);
            roots.extend(&nodes.with_tree);
        }
    }
    roots.extend(&nodes.others);
    set_roots(&mut draft.root, &roots);
    if layout == Layout::Msft && levels.len() > 1 {
        link_levels(&mut draft.root, levels, &nodes.levels);
    }
    drop_nodes(&mut draft.root, &nodes.needless);
}

fn link_levels(root: &mut Value, levels: &[Level], nodes: &[usize]) {
    let coverages: Vec<f64> = levels.iter().filter_map(Level::screen_coverage).collect();
    let finest = &mut root["nodes"][nodes[0]];
    if finest
        .get("extras")
        .is_none_or(|extras| !extras.is_object())
    {
        finest["extras"] = Map::new().into();
    }
    finest["extras"]["MSFT_screencoverage"] = coverages.into();
    finest["extensions"][LEVELS_EXTENSION] = json!({"ids": nodes[1..]});
    match root.get_mut("extensionsUsed").and_then(Value::as_array_mut) {
        Some(names) if names.iter().any(|name| name == LEVELS_EXTENSION) => {}
        Some(names) => names.push(LEVELS_EXTENSION.into()),
        None => root["extensionsUsed"] = json!([LEVELS_EXTENSION]),
    }
}

/// The roots of the default scene: those that the reader takes.
pub(super) fn scene_roots(root: &Value) -> Vec<usize> {
    let of_list = |nodes: Option<&Value>| {
        let nodes = nodes.and_then(Value::as_array).into_iter().flatten();
        nodes.filter_map(as_index).collect()
    };
    if let Some(scene) = default_scene(root) {
        return of_list(root["scenes"][scene].get("nodes"));
    }
    let count = len(root, "nodes");
    let is_child: BTreeSet<usize> = (0..count).flat_map(|node| children(root, node)).collect();
    (0..count).filter(|node| !is_child.contains(node)).collect()
}

fn default_scene(root: &Value) -> Option<usize> {
    let named = root.get("scene").and_then(as_index);
    named.or((len(root, "scenes") > 0).then_some(0))
}

fn set_roots(root: &mut Value, roots: &[usize]) {
    match default_scene(root) {
        Some(scene) => root["scenes"][scene]["nodes"] = roots.into(),
        None => {
            root["scenes"] = json!([{ "nodes": roots }]);
            root["scene"] = 0.into();
        }
    }
}

/// The children of a node.
pub(super) fn children(root: &Value, node: usize) -> Vec<usize> {
    let children = root["nodes"][node]
        .get("children")
        .and_then(Value::as_array);
    let children = children.into_iter().flatten();
    children.filter_map(as_index).collect()
}

/// Whether a node, or one below it, is one of these.
pub(super) fn holds_any(root: &Value, node: usize, wanted: &HashSet<usize>) -> bool {
    let mut left = vec![node];
    while let Some(node) = left.pop() {
        if wanted.contains(&node) {
            return true;
        }
        left.extend(children(root, node));
    }
    false
}
