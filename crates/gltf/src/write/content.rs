//! A LOD as JSON and one buffer.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use serde_json::{Value, json};

use super::beyond_cards;
use super::chain::forget_unused;
use super::compact_vertices::drop_unused_vertices;
use super::compress;
use super::cutoffs::Cutoffs;
use super::draft::Draft;
use super::drop_unreferenced::{
    References, drop_meshes, drop_unreferenced, remove_field, undrawn_meshes,
};
use super::interleaved::separate_what_is_left;
use super::leaf_edits::LeafEdits;
use super::meshes::rewrite_meshes;
use super::nodes::{drop_nodes, leave_out_levels};
use super::packing::{PackProblem, ViewBytes, pack};
use super::references::len;
use super::skeleton::rewrite_skeleton;
use crate::Document;
use crate::buffer::BufferSource;
use crate::error::{At, Fault, Problem};
use crate::order_extras::ORDER_EXTRAS_NAME;
use crate::tree::Tree;
use secateur_model::Lod;

/// What a LOD's files hold.
#[derive(Clone)]
pub(super) struct Content {
    /// The JSON; the first of its `buffers` has no URI, a second one no bytes.
    pub(super) root: Value,
    pub(super) buffer: Vec<u8>,
    /// Triangles drawn, each instance counted.
    pub(super) triangles: u64,
    pub(super) notes: Vec<String>,
}

/// The content of a LOD's files.
///
/// # Panics
/// If the LOD is of another number of leaves.
pub(super) fn lod_content(tree: &Tree, lod: &Lod, cutoffs: &Cutoffs) -> Result<Content, Fault> {
    assert_eq!(
        lod.area_scales().len(),
        tree.foliage.leaves().len(),
        "a LOD knows every leaf of its tree"
    );
    let edits = LeafEdits::new(tree, lod);
    let mut draft = Draft::new(&tree.document);
    draft
        .notes
        .extend(tree.document.notes_of_others(&tree.others));
    let before = References::of(&mut draft.root);
    let left_out = leave_out_levels(&mut draft, tree);
    let mut empty = rewrite_meshes(&mut draft, tree, &edits)?;
    if !left_out.is_empty() {
        empty.extend(undrawn_meshes(&mut draft));
    }
    drop_meshes(&mut draft, &empty);
    rewrite_skeleton(&mut draft, tree, lod)?;
    drop_order(&mut draft, tree, lod);
    beyond_cards::clear(&mut draft, tree, lod, cutoffs)?;
    cutoffs.apply(&mut draft, tree);
    drop_nodes(&mut draft.root, &left_out);
    drop_unused_vertices(&mut draft, &before)?;
    forget_unused(&mut draft);
    let triangles = count_triangles(tree, &edits)?;
    finished(draft, &before, triangles)
}

/// Leaves out the removal order of all leaves, where some are gone or others.
fn drop_order(draft: &mut Draft, tree: &Tree, lod: &Lod) {
    if *lod == Lod::original(tree.foliage.leaves().len()) {
        return;
    }
    let extras = draft.root.get_mut("extras").and_then(Value::as_object_mut);
    let Some(extras) = extras.filter(|extras| extras.contains_key(ORDER_EXTRAS_NAME)) else {
        return;
    };
    extras.shift_remove(ORDER_EXTRAS_NAME);
    if extras.is_empty() {
        remove_field(&mut draft.root, "extras");
    }
}

/// The content of a draft: what nothing names any more is gone, and the rest of
/// the bytes lies in one buffer. `before` is what the input names.
pub(super) fn finished(
    mut draft: Draft,
    before: &References,
    triangles: u64,
) -> Result<Content, Fault> {
    let document = draft.document;
    let compression = draft.compression;
    sign(&mut draft.root);
    separate_what_is_left(&mut draft, before)?;
    let partly_used = drop_unreferenced(&mut draft, before);

    let mut own: HashMap<usize, Cow<[u8]>> = HashMap::new();
    for (view, bytes) in std::mem::take(&mut draft.new_bytes) {
        own.insert(view, Cow::Owned(bytes));
    }
    let kept = compress::take_off(&mut draft, &partly_used, &mut own)?;
    let bytes = ViewBytes {
        buffers: document.buffers.iter().collect(),
        own,
        partly_used,
    };
    let mut buffer = pack(&mut draft.root, &bytes).map_err(|problem| match problem {
        PackProblem::OutOfRange(view) => stray_view(document, view),
        PackProblem::Unreadable(problem) => problem.into(),
    })?;
    set_buffer(&mut draft.root, document, buffer.len());
    if let Some(compression) = compression {
        buffer = compress::compress(&mut draft.root, buffer, compression, &kept);
    }
    Ok(Content {
        triangles,
        notes: without_repeats(draft.notes),
        root: draft.root,
        buffer,
    })
}

/// Says that this program wrote the file; what said so before stays in the extras of `asset`.
pub(super) fn sign(root: &mut Value) {
    const OURS: &str = "secateur";
    let asset = &mut root["asset"];
    let before = asset.get("generator").and_then(Value::as_str);
    let before = before
        .filter(|tool| !tool.starts_with(OURS))
        .map(str::to_owned);
    if let Some(before) = before {
        if asset.get("extras").is_none() {
            asset["extras"] = json!({});
        }
        // Extras that are no object are somebody's own.
        if let Some(extras) = asset["extras"].as_object_mut() {
            extras.insert("generator".into(), before.into());
        }
    }
    asset["generator"] = format!("{OURS} {}", env!("CARGO_PKG_VERSION")).into();
}

fn stray_view(document: &Document, view: usize) -> Fault {
    let generic = || Err(Problem::Missing("bytes")).at(|| document.place("bufferViews", view));
    let read = document.view_bytes(view).map(|_| ());
    match read.and_then(|()| generic()) {
        Err(fault) => fault,
        Ok(()) => unreachable!("the generic fault is a fault"),
    }
}

/// One buffer in the place of all: the first that had bytes keeps its name and
/// extras.
fn set_buffer(root: &mut Value, document: &Document, byte_length: usize) {
    if byte_length == 0 {
        remove_field(root, "buffers");
        return;
    }
    let has_bytes = |index: &usize| document.buffers[*index].source != BufferSource::Placeholder;
    let first = (0..document.buffers.len()).find(has_bytes);
    let mut buffer = first.map_or_else(|| json!({}), |index| root["buffers"][index].clone());
    remove_field(&mut buffer, "uri");
    buffer["byteLength"] = byte_length.into();
    root["buffers"] = json!([buffer]);
}

/// A mesh that is written several times has the same to say each time.
pub(super) fn without_repeats(mut notes: Vec<String>) -> Vec<String> {
    let mut said = HashSet::new();
    notes.retain(|note| said.insert(note.clone()));
    notes
}

/// The triangles that are drawn, each instance counted.
pub(super) fn count_triangles(tree: &Tree, edits: &LeafEdits) -> Result<u64, Fault> {
    let mut of_primitive: HashMap<(usize, usize), u64> = HashMap::new();
    let mut triangles = 0;
    for (number, part) in tree.parts.iter().enumerate() {
        let place = (part.mesh, part.primitive);
        let all = match of_primitive.get(&place) {
            Some(&known) => known,
            None => {
                let count = tree.document.triangles(place.0, place.1)?.len() as u64;
                of_primitive.insert(place, count);
                count
            }
        };
        let gone = edits
            .of_part(number)
            .filter(|edit| edit.area_scale.is_none());
        triangles += all - gone.map(|edit| edit.triangles.len() as u64).sum::<u64>();
        triangles += edits.made_in(number).len() as u64;
    }
    debug_assert!(len(&tree.document.root, "meshes") > 0 || triangles == 0);
    Ok(triangles)
}
