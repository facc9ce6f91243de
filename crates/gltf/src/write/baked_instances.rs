//! Instances whose leaves differ now: all of a node become one mesh, since each mesh costs a draw call.

use std::collections::HashMap;

use serde_json::Value;

use super::chain::{Baker, LevelPrimitive, merged};
use super::compact_vertices::compact;
use super::draft::Draft;
use super::instances::take_instancing_away;
use super::leaf_edits::{LeafEdits, Use};
use super::primitive::rewrite_primitive;
use super::references::{as_index, knows_all_extensions};
use crate::error::Fault;
use crate::roles::Role;
use crate::tree::Tree;

/// Gives a node one mesh of all that its instances of `mesh` draw from now on, in its own space.
pub(super) fn bake_instances(
    draft: &mut Draft,
    tree: &Tree,
    edits: &LeafEdits,
    (node, mesh): (usize, usize),
    places: &[&Use],
) -> Result<(), Fault> {
    let Some(instancing) = tree.document.instancing(node)? else {
        return Ok(());
    };
    let node_from_instances = tree.document.node_from_instances(&instancing)?;
    let mut json = tree.document.root["meshes"][mesh].clone();
    let original = json["primitives"].as_array().cloned().unwrap_or_default();
    let mut baker = Baker::default();
    let mut primitives = Vec::new();
    for place in places {
        let parts = place.parts.iter();
        let leaves: HashMap<usize, usize> = parts
            .map(|&part| (tree.parts[part].primitive, part))
            .collect();
        let instance = place.instance.unwrap_or_default();
        for (number, primitive) in original.iter().enumerate() {
            let part = leaves.get(&number).copied();
            let mut primitive = primitive.clone();
            match part.filter(|&part| edits.is_changed(part)) {
                Some(part) => match rewrite_primitive(draft, tree, edits, part)? {
                    Some(rewritten) => primitive = rewritten,
                    None => continue,
                },
                None => {
                    let position = primitive["attributes"].get("POSITION").and_then(as_index);
                    if let Some(position) = position
                        && knows_all_extensions(&draft.root)
                    {
                        compact(draft, &mut primitive, position)?;
                    }
                }
            }
            let called = tree.document.primitive_place(mesh, number);
            baker.bake(
                draft,
                &mut primitive,
                node_from_instances[instance],
                &called,
            )?;
            primitives.push(LevelPrimitive {
                json: primitive,
                is_foliage: part.is_some_and(|part| tree.parts[part].role == Role::Leaf),
            });
        }
    }
    let called = draft.document.place("nodes", node);
    draft.notes.push(format!(
        "{called}: its {} instances have different leaves now, and are one mesh",
        places.len()
    ));
    take_instancing_away(&mut draft.root["nodes"][node]);
    let primitives = merged(draft, primitives)?;
    if primitives.is_empty() {
        draft.take_mesh_away(node);
        return Ok(());
    }
    json["primitives"] = Value::Array(primitives);
    draft.root["nodes"][node]["mesh"] = draft.push("meshes", json).into();
    Ok(())
}
