//! Vertices whose attributes lie interleaved in one buffer view, of which some attributes were replaced: those that stay
//! get lists of their own, so that the bytes of the others do not stay between them.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use serde_json::Value;

use super::draft::{Draft, Role};
use super::drop_unreferenced::References;
use super::references::{as_index, items, knows_all_extensions};
use crate::error::Fault;

/// The vertices of a buffer view that an attribute is of: the view, its first stride and how many there are.
type Vertices = (usize, usize, usize);

/// Gives the attributes that are left of interleaved vertices lists of their own. Does nothing where an extension might
/// know accessors by number.
pub(super) fn separate_what_is_left(draft: &mut Draft, before: &References) -> Result<(), Fault> {
    if !knows_all_extensions(&draft.root) {
        return Ok(());
    }
    let gone = before.accessors_without_a_user(&mut draft.root);
    let interleaved: HashMap<usize, Vertices> = (0..before.accessors())
        .filter_map(|accessor| Some((accessor, vertices(draft, accessor)?)))
        .collect();
    let broken_places: HashSet<Vertices> = gone
        .iter()
        .filter_map(|lost| interleaved.get(lost).copied())
        .collect();
    let broken: HashMap<usize, usize> = interleaved
        .iter()
        .filter(|(accessor, place)| !gone.contains(accessor) && broken_places.contains(place))
        .map(|(&accessor, &(.., count))| (accessor, count))
        .collect();
    if broken.is_empty() {
        return Ok(());
    }
    let mut meshes: Vec<_> = items(&mut draft.root, "meshes")
        .map(|mesh| mesh.clone())
        .collect();
    for primitive in meshes.iter_mut().flat_map(|mesh| items(mesh, "primitives")) {
        let attributes = primitive.get_mut("attributes");
        let attributes = attributes.and_then(Value::as_object_mut);
        for number in attributes.into_iter().flat_map(|all| all.values_mut()) {
            let Some(accessor) = as_index(number) else {
                continue;
            };
            if let Some(&count) = broken.get(&accessor) {
                let all: Rc<[u32]> = (0..count as u32).collect();
                *number = draft.gather(accessor, Role::Vertex, &all)?.into();
            }
        }
    }
    draft.root["meshes"] = meshes.into();
    Ok(())
}

/// Where an accessor of the input lies between others.
fn vertices(draft: &Draft, accessor: usize) -> Option<Vertices> {
    let fields = &draft.document.root["accessors"][accessor];
    let view = fields.get("bufferView").and_then(as_index)?;
    let stride = draft.document.root["bufferViews"][view].get("byteStride");
    let stride = stride.and_then(as_index).filter(|&stride| stride > 0)?;
    let own = draft.document.accessor(accessor).ok()?.element_bytes();
    let offset = fields.get("byteOffset").and_then(as_index).unwrap_or(0);
    let count = fields.get("count").and_then(as_index)?;
    (own + 3 < stride).then_some((view, offset / stride, count))
}
