//! Vertex lists that lost a user are compacted: wood that shares its vertices
//! with leaves keeps those that it uses.

use std::rc::Rc;

use serde_json::Value;

use super::draft::{Draft, Role};
use super::drop_unreferenced::References;
use super::primitive::new_indices;
use super::references::{as_index, items, knows_all_extensions, len};
use crate::accessor::is_index;
use crate::error::Fault;

/// Gives primitives that were not rewritten, but use the vertices of one that
/// was or is gone, vertices of their own: otherwise those of removed leaves
/// would stay. Does nothing where an extension might know vertices by number.
pub(super) fn drop_unused_vertices(draft: &mut Draft, before: &References) -> Result<(), Fault> {
    if !knows_all_extensions(&draft.root) {
        return Ok(());
    }
    let lost_a_user = before.accessors_that_lost_a_user(&mut draft.root);
    for mesh in 0..len(&draft.root, "meshes") {
        for primitive in 0..len(&draft.root["meshes"][mesh], "primitives") {
            let fields = &draft.root["meshes"][mesh]["primitives"][primitive];
            let position = fields.pointer("/attributes/POSITION").and_then(as_index);
            if position.is_some_and(|position| lost_a_user.contains(&position)) {
                let mut fields = fields.clone();
                if compact(draft, &mut fields, position.unwrap_or(0))? {
                    draft.root["meshes"][mesh]["primitives"][primitive] = fields;
                }
            }
        }
    }
    Ok(())
}

/// Gives a primitive of the input, whose positions are this accessor, lists of the
/// vertices that it uses. Returns whether it had others.
pub(super) fn compact(
    draft: &mut Draft,
    primitive: &mut Value,
    position: usize,
) -> Result<bool, Fault> {
    let document = draft.document;
    let Some(old) = primitive.get("indices").and_then(as_index) else {
        return Ok(false);
    };
    let vertex_count = document.accessor(position)?.count;
    if !is_index(&document.accessor(old)?) {
        return Ok(false);
    }
    let mut corners = document.elements(old)?.indices();
    let Some(sources) = used_vertices(vertex_count, &mut corners) else {
        return Ok(false);
    };
    let sources: Rc<[u32]> = sources.into();
    gather_all(draft, primitive.get_mut("attributes"), &sources)?;
    for target in items(primitive, "targets") {
        gather_all(draft, Some(target), &sources)?;
    }
    let new = new_indices(draft, old, &corners, sources.len())?;
    primitive["indices"] = draft.push_accessor(Some(old), new).into();
    Ok(true)
}

fn gather_all(
    draft: &mut Draft,
    attributes: Option<&mut Value>,
    sources: &Rc<[u32]>,
) -> Result<(), Fault> {
    let attributes = attributes.and_then(Value::as_object_mut);
    for number in attributes
        .into_iter()
        .flat_map(|fields| fields.values_mut())
    {
        if let Some(old) = as_index(number) {
            *number = draft.gather(old, Role::Vertex, sources)?.into();
        }
    }
    Ok(())
}

/// The vertices that some corner names, ascending, and the corners renumbered
/// to them. `None`, and the corners as they were, if all are named, or one that
/// is not there.
fn used_vertices(vertex_count: usize, corners: &mut [u32]) -> Option<Vec<u32>> {
    let mut is_used = vec![false; vertex_count];
    for &corner in corners.iter() {
        *is_used.get_mut(corner as usize)? = true;
    }
    let used: Vec<u32> = (0..)
        .zip(&is_used)
        .filter(|(_, used)| **used)
        .map(|(v, _)| v)
        .collect();
    if used.len() == vertex_count {
        return None;
    }
    let mut new_number = vec![0; vertex_count];
    for (number, &vertex) in (0..).zip(&used) {
        new_number[vertex as usize] = number;
    }
    for corner in corners {
        *corner = new_number[*corner as usize];
    }
    Some(used)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_follow_the_vertices_that_stay() {
        let mut corners = [5, 1, 5, 3];
        assert_eq!(used_vertices(6, &mut corners), Some(vec![1, 3, 5]));
        assert_eq!(corners, [2, 0, 2, 1]);
        assert_eq!(used_vertices(3, &mut corners), None, "all are used");
        assert_eq!(used_vertices(2, &mut corners), None, "2 is not there");
        assert_eq!(corners, [2, 0, 2, 1]);
    }
}
