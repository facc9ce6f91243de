//! Which materials levels of a chain show.

use std::collections::BTreeSet;

use serde_json::Value;

use super::super::references::{as_index, items};
use super::scene::children;

/// The meshes of a node and of all below it.
pub(super) fn meshes_below(root: &Value, node: usize) -> BTreeSet<usize> {
    let mut left = vec![node];
    let mut meshes = BTreeSet::new();
    while let Some(node) = left.pop() {
        meshes.extend(root["nodes"][node].get("mesh").and_then(as_index));
        left.extend(children(root, node));
    }
    meshes
}

/// Calls `visit` with each material number of a mesh, those of variants too.
pub(super) fn visit_materials(mesh: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for primitive in items(mesh, "primitives") {
        if let Some(number) = primitive.get_mut("material") {
            visit(number);
        }
        if let Some(variants) = primitive.pointer_mut("/extensions/KHR_materials_variants") {
            for mapping in items(variants, "mappings") {
                if let Some(number) = mapping.get_mut("material") {
                    visit(number);
                }
            }
        }
    }
}
