//! Textured triangles as a GLB.

use std::borrow::Cow;

use serde_json::json;

use super::plant::{Columns, PlantFile};
use crate::container::glb_bytes;
use secateur_model::{Material, Surface};

/// Surfaces as the bytes of a GLB file: a scene of this name, whose node "Tree" has a child for each
/// surface, foliage ("Leaves") and wood ("Branches"), a mesh and a material each. Textures are
/// embedded as PNG.
///
/// Numbers, and what vertices hang on, are written as [`plant_to_glb`](crate::plant_to_glb) writes
/// them. Surfaces without triangles are left out. The same surfaces give the same bytes.
///
/// # Panics
/// As [`plant_to_glb`](crate::plant_to_glb).
pub fn surfaces_to_glb(name: &str, surfaces: &[(Surface, bool)]) -> Vec<u8> {
    let mut file = PlantFile::default();
    let mut children = Vec::new();
    let mut is_unlit = false;
    for (surface, is_foliage) in surfaces {
        if surface.triangles.is_empty() {
            continue;
        }
        let node = if *is_foliage { "Leaves" } else { "Branches" };
        let material = &surface.material;
        let holds = &surface.holds;
        let holds = (!holds.is_empty()).then_some(Cow::Borrowed(&holds[..]));
        children.push(file.push_node(node, Columns::borrowed(surface), material, holds));
        push_finish(&mut file, material);
        is_unlit |= material.finish.is_unlit;
    }
    let mut tree = json!({"name": "Tree"});
    if !children.is_empty() {
        tree["children"] = json!(children);
    }
    let tree = file.push("nodes", tree);
    let mut root = file.finish(name, tree);
    if is_unlit {
        root["extensionsUsed"] = json!([UNLIT]);
    }
    glb_bytes(&root, file.buffer).expect("a plant fits into 4 GiB")
}

const UNLIT: &str = "KHR_materials_unlit";

/// Gives the last material what a grown plant's never has.
fn push_finish(file: &mut PlantFile, material: &Material) {
    let finish = &material.finish;
    let normals = finish.normal_map.as_ref();
    let normals = normals.map(|n| (file.texture(&n.texture), n.scale));
    let materials = file.lists["materials"].as_array_mut();
    let Some(fields) = materials.and_then(|all| all.last_mut()) else {
        return;
    };
    fields["pbrMetallicRoughness"]["roughnessFactor"] = json!(finish.roughness.clamp(0.0, 1.0));
    if let Some((index, scale)) = normals {
        fields["normalTexture"] = json!({"index": index, "scale": scale});
    }
    if finish.is_unlit {
        fields["extensions"] = json!({ UNLIT: {} });
    }
}
