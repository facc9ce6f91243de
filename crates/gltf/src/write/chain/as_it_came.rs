//! A level that is the plant itself, as the input has it: where the input's geometry is compressed, or shared in ways
//! that one mesh cannot, the level would be larger than its input.

use serde_json::{Value, json};

use super::super::content::sign;
use super::super::references::{items, len};
use super::{Level, LevelContent};
use crate::container::glb_bytes;
use crate::error::Fault;
use crate::tree::Tree;
use secateur_model::Lod;

/// By how much more than the input, in percent and bytes, a level may have: what its facts and names take.
const MORE_PERCENT: usize = 2;
const MORE_BYTES: usize = 1024;

/// The level as the input has it, with its own name and facts, where that saves bytes and costs no draw. None where the
/// level is not the plant as it is, where the input has more than the plant, or lies in several files.
pub(super) fn as_it_came(
    tree: &Tree,
    level: &Level,
    draws: u64,
    bytes: usize,
) -> Result<Option<Vec<u8>>, Fault> {
    let LevelContent::Tree(lod) = level.content else {
        return Ok(None);
    };
    let document = &tree.document;
    let root = document.root_as_it_came();
    let is_the_input = *lod == Lod::original(tree.foliage.leaves().len())
        && level.textures.is_empty()
        && level.morph.is_none()
        && tree.others.is_empty()
        && tree.levels_inside.nodes.is_empty()
        && document.cost().draws == tree.parts.len() as u64;
    let is_one_file = len(root, "buffers") == 1 && !names_files(root);
    if !is_the_input || !is_one_file || draws != tree.parts.len() as u64 {
        return Ok(None);
    }
    let mut root = root.clone();
    let buffer = &document.buffers[0];
    let buffer = buffer.bytes(0..buffer.len())?.into_owned();
    root["buffers"][0]["byteLength"] = buffer.len().into();
    if let Some(fields) = root["buffers"][0].as_object_mut() {
        fields.shift_remove("uri");
    }
    sign(&mut root);
    name(&mut root, level);
    let came = glb_bytes(&root, buffer);
    let saves = |came: &Vec<u8>| bytes > came.len() + came.len() * MORE_PERCENT / 100 + MORE_BYTES;
    Ok(came.filter(saves))
}

/// Whether images lie in files of their own.
fn names_files(root: &Value) -> bool {
    let images = root.get("images").and_then(Value::as_array);
    let mut images = images.into_iter().flatten();
    images.any(|image| image.get("uri").is_some())
}

/// Gives the name and the facts of the level to the node of its scene, where that is one.
fn name(root: &mut Value, level: &Level) {
    let scene = root.get("scene").and_then(Value::as_u64).unwrap_or(0);
    let nodes = root["scenes"][scene as usize]["nodes"].as_array();
    let Some([node]) = nodes.map(Vec::as_slice) else {
        return;
    };
    let node = node.as_u64().unwrap_or(0) as usize;
    let Some(node) = items(root, "nodes").nth(node) else {
        return;
    };
    node["name"] = level.name.clone().into();
    if node.get("extras").is_none() && !level.facts.is_empty() {
        node["extras"] = json!({});
    }
    if let Some(extras) = node.get_mut("extras").and_then(Value::as_object_mut) {
        extras.extend(level.facts.clone());
    }
}
