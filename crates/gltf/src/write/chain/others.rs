//! What is not the plant, in a chain: it stays as it is, once, beside the finest level.

use std::collections::BTreeSet;

use super::super::compact_vertices::compact;
use super::super::draft::Draft;
use super::super::nodes::{take_away, unlink};
use super::super::references::{as_index, items, knows_all_extensions};
use super::super::single_leaf_mesh::animated_and_joint_nodes;
use super::one_mesh::needless_nodes;
use super::scene::scene_roots;
use crate::error::Fault;
use crate::roles::{mesh_of, nodes_without_plant, primitives_beside_plant};
use crate::tree::Tree;

/// Takes what is not the plant out of the file of a coarser level. Returns the nodes that nothing needs any
/// more, which no other node holds.
pub(super) fn leave_out(draft: &mut Draft, tree: &Tree) -> BTreeSet<usize> {
    let nodes = nodes_without_plant(&tree.parts, &tree.others);
    let joints = animated_and_joint_nodes(&draft.root);
    nodes.iter().for_each(|&node| take_away(draft, node));
    let needless = needless_nodes(&draft.root, &scene_roots(&draft.root), &nodes, &joints);
    unlink(draft, &needless);
    needless
}

/// Gives a node that drew the plant a mesh of what of its own is not the plant, if there is such. Pieces that were
/// parted from the plant keep only their own vertices.
pub(super) fn put_back(draft: &mut Draft, tree: &Tree, node: usize) -> Result<(), Fault> {
    let primitives = primitives_beside_plant(&tree.others, node);
    let Some(part) = tree.others.iter().find(|part| part.node == node) else {
        return Ok(());
    };
    let original = &tree.document.root;
    let mut mesh = mesh_of(&original["meshes"][part.mesh], &primitives);
    if knows_all_extensions(&draft.root) {
        let placed = primitives.iter().zip(items(&mut mesh, "primitives"));
        for (number, primitive) in placed {
            let position = primitive.pointer("/attributes/POSITION").and_then(as_index);
            let is_half = tree.document.halves.contains_key(&[part.mesh, *number]);
            if let Some(position) = position.filter(|_| is_half) {
                compact(draft, primitive, position)?;
            }
        }
    }
    draft.root["nodes"][node]["mesh"] = draft.push("meshes", mesh).into();
    for field in ["skin", "weights"] {
        if let Some(value) = original["nodes"][node].get(field) {
            draft.root["nodes"][node][field] = value.clone();
        }
    }
    Ok(())
}
