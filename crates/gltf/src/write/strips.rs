//! A finished file with triangle strips in place of lists.

use std::collections::HashMap;

use secateur_model::{joined_strips, strips};
use serde_json::Value;

use super::content::{Content, finished};
use super::draft::Draft;
use super::drop_unreferenced::References;
use super::primitive::new_indices;
use super::references::{as_index, len};
use crate::Document;
use crate::error::Fault;

const LIST: usize = 4;
const STRIP: usize = 5;

/// A file whose indexed lists are strips, one for each primitive: glTF has no restarts, so strips are joined by triangles
/// without area. Lists without indices stay, as no two of their triangles name a vertex in common; so do those
/// that are compressed by Draco.
pub(super) fn stripped(document: &Document) -> Result<Content, Fault> {
    let mut draft = Draft::new(document);
    let before = References::of(&mut draft.root);
    // Primitives that share indices and vertices share strips.
    let mut known: HashMap<[usize; 2], usize> = HashMap::new();
    let (mut of_lists, mut of_strips) = (0, 0);
    for mesh in 0..len(&draft.root, "meshes") {
        for primitive in 0..len(&draft.root["meshes"][mesh], "primitives") {
            let Some(key) = indexed_list(&draft.root["meshes"][mesh]["primitives"][primitive])
            else {
                continue;
            };
            let number = match known.get(&key) {
                Some(&number) => number,
                None => {
                    let triangles = document.triangles(mesh, primitive)?;
                    let joined = joined_strips(&strips(&triangles));
                    if joined.is_empty() {
                        continue;
                    }
                    of_lists += 3 * triangles.len();
                    of_strips += joined.len();
                    let vertices = document.vertex_count(mesh, primitive)?;
                    let elements = new_indices(&draft, key[0], &joined, vertices)?;
                    let number = draft.push_accessor(Some(key[0]), elements);
                    known.insert(key, number);
                    number
                }
            };
            let fields = &mut draft.root["meshes"][mesh]["primitives"][primitive];
            fields["indices"] = number.into();
            fields["mode"] = STRIP.into();
        }
    }
    draft.notes.push(format!(
        "triangle strips have {of_strips} indices, lists would have {of_lists}"
    ));
    finished(draft, &before, 0)
}

/// The accessors of indices and positions of a primitive that is a list with indices.
fn indexed_list(primitive: &Value) -> Option<[usize; 2]> {
    let is_list = primitive
        .get("mode")
        .is_none_or(|mode| as_index(mode) == Some(LIST));
    let draco = primitive.pointer("/extensions/KHR_draco_mesh_compression");
    let indices = primitive.get("indices").and_then(as_index)?;
    let positions = primitive
        .pointer("/attributes/POSITION")
        .and_then(as_index)?;
    (is_list && draco.is_none()).then_some([indices, positions])
}
