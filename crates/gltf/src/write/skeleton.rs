//! The skeleton of a tree with fewer leaves: those that are left still know
//! their segments.

use serde_json::Value;

use super::draft::{Draft, NewElements, Role};
use crate::accessor::{Component, Shape};
use crate::error::Fault;
use crate::skeleton::{ACCESSORS_POINTER, EXTRAS_NAME, LEAF_SEGMENT};
use crate::tree::Tree;
use secateur_model::Lod;

/// Gives the list of leaves' segments the leaves of the LOD: original ones in leaf
/// order, then made ones, on the segments of their donors. Where their order in
/// the file is another, or the list is not that of this foliage, the skeleton goes
/// and a note says so.
pub(super) fn rewrite_skeleton(draft: &mut Draft, tree: &Tree, lod: &Lod) -> Result<(), Fault> {
    let Some(accessors) = draft.root.pointer(ACCESSORS_POINTER) else {
        return Ok(());
    };
    let number = accessors
        .get(LEAF_SEGMENT)
        .and_then(super::references::as_index);
    let is_unchanged = lod.is_of_originals() && lod.leaf_count() == tree.foliage.leaves().len();
    if is_unchanged {
        return Ok(());
    }
    let mut foliage_parts = tree.leaf_sources.iter().map(|source| source.part);
    let first = foliage_parts.next();
    let is_one_part = foliage_parts.all(|part| Some(part) == first);
    let elements = number.and_then(|n| draft.document.elements(n).ok());
    let of_this_foliage = elements.filter(|elements| {
        let accessor = &elements.accessor;
        is_one_part
            && accessor.count == tree.foliage.leaves().len()
            && accessor.shape == Shape::Vector(2)
            && accessor.component == Component::U16
    });
    let (Some(number), Some(elements)) = (number, of_this_foliage) else {
        drop_skeleton(draft);
        return Ok(());
    };
    let originals = lod.leaves().map(|(leaf, _)| leaf);
    let leaves = originals.chain(lod.made().map(|(made, _)| made.donor));
    let size = elements.accessor.element_bytes();
    let bytes: Vec<u8> = leaves
        .flat_map(|leaf| elements.bytes[leaf.index() * size..][..size].to_vec())
        .collect();
    let count = bytes.len() / size;
    if count == 0 {
        drop_skeleton(draft);
        return Ok(());
    }
    let new = NewElements {
        component: Component::U16,
        shape: Shape::Vector(2),
        normalized: false,
        count,
        bytes: Some(bytes),
        bounded: false,
        role: Role::Instance,
    };
    let new_number = draft.push_accessor(Some(number), new);
    if let Some(accessors) = draft.root.pointer_mut(ACCESSORS_POINTER) {
        accessors[LEAF_SEGMENT] = new_number.into();
    }
    Ok(())
}

/// Leaves the skeleton out, and says so.
pub(super) fn drop_skeleton(draft: &mut Draft) {
    if draft.root.pointer(ACCESSORS_POINTER).is_none() {
        return;
    }
    let extras = draft.root.get_mut("extras").and_then(Value::as_object_mut);
    if let Some(extras) = extras {
        extras.shift_remove(EXTRAS_NAME);
    }
    if draft.root["extras"]
        .as_object()
        .is_some_and(|e| e.is_empty())
    {
        super::drop_unreferenced::remove_field(&mut draft.root, "extras");
    }
    draft
        .notes
        .push("the skeleton was left out: it does not fit the leaves that are left".to_owned());
}
