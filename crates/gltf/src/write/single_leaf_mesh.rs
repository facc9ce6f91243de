//! A mesh that is a single leaf, drawn in many places: where a leaf is resized,
//! its node or instance is scaled and the mesh stays shared.

use std::collections::HashSet;

use glam::{DMat4, DQuat, DVec3};
use serde_json::{Value, json};

use super::draft::Draft;
use super::leaf_edits::{LeafEdits, Use};
use super::references::{as_index, len};
use super::vertices::Resize;
use crate::error::Fault;
use crate::property::numbers;
use crate::tree::Tree;

/// The resize of the leaf that is all of this place's mesh; `None` if there is
/// more in the mesh, or the leaf keeps its size or goes.
pub(super) fn only_leaf(
    tree: &Tree,
    edits: &LeafEdits,
    place: &Use,
) -> Result<Option<Resize>, Fault> {
    let [part] = place.parts[..] else {
        return Ok(None);
    };
    if edits.has_made(part) {
        return Ok(None);
    }
    let mut leaves = edits.of_part(part);
    let (Some(edit), None) = (leaves.next(), leaves.next()) else {
        return Ok(None);
    };
    let Some(resize) = edits.resize(part, &edit) else {
        return Ok(None);
    };
    let (mesh, primitive) = (tree.parts[part].mesh, tree.parts[part].primitive);
    let is_whole = len(&tree.document.root["meshes"][mesh], "primitives") == 1
        && tree.document.triangles(mesh, primitive)?.len() == edit.triangles.len();
    Ok(is_whole.then_some(resize))
}

/// Whether scaling a node changes nothing but its mesh.
pub(super) fn can_scale_node(root: &Value, moved_by_others: &HashSet<usize>, node: usize) -> bool {
    let fields = &root["nodes"][node];
    let is_plain = ["children", "skin", "camera", "extensions"]
        .iter()
        .all(|name| fields.get(name).is_none());
    is_plain && !moved_by_others.contains(&node)
}

/// Nodes whose transform matters to more than their mesh: joints, and all that
/// an animation moves.
pub(super) fn animated_and_joint_nodes(root: &Value) -> HashSet<usize> {
    let mut moved_by_others = HashSet::new();
    for channel in list(root, "animations").flat_map(|animation| list(animation, "channels")) {
        moved_by_others.extend(animated_node(&channel["target"]));
    }
    for skin in list(root, "skins") {
        let joints = list(skin, "joints").chain(skin.get("skeleton"));
        moved_by_others.extend(joints.filter_map(as_index));
    }
    moved_by_others
}

/// KHR_animation_pointer names a node in a path such as `/nodes/3/scale`.
fn animated_node(target: &Value) -> Option<usize> {
    let pointer = target.pointer("/extensions/KHR_animation_pointer/pointer");
    match pointer.and_then(Value::as_str) {
        Some(path) => path
            .strip_prefix("/nodes/")?
            .split('/')
            .next()?
            .parse()
            .ok(),
        None => as_index(target.get("node")?),
    }
}

fn list<'a>(object: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> {
    object
        .get(name)
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
}

/// Scales a node, that holds only the leaf, about the leaf's centre.
pub(super) fn scale_node(draft: &mut Draft, node: usize, resize: &Resize) {
    let fields = &mut draft.root["nodes"][node];
    if let Some(matrix) = numbers::<16>(fields, "matrix").ok().flatten() {
        let scaled = DMat4::from_cols_array(&matrix) * about_centre(resize);
        fields["matrix"] = json!(scaled.to_cols_array());
        return;
    }
    let transform = read_transform(fields);
    let scaled = transform.scaled_about(resize);
    fields["translation"] = json!(scaled.translation.to_array());
    fields["scale"] = json!(scaled.scale.to_array());
}

fn about_centre(resize: &Resize) -> DMat4 {
    DMat4::from_translation(resize.centre_local)
        * DMat4::from_scale(DVec3::splat(resize.linear_scale))
        * DMat4::from_translation(-resize.centre_local)
}

fn read_transform(node: &Value) -> Transform {
    let vector = |name, default| {
        let read = numbers::<3>(node, name).ok().flatten();
        read.map_or(default, DVec3::from_array)
    };
    let rotation = numbers::<4>(node, "rotation").ok().flatten();
    Transform {
        translation: vector("translation", DVec3::ZERO),
        rotation: rotation.map_or(DQuat::IDENTITY, DQuat::from_array),
        scale: vector("scale", DVec3::ONE),
    }
}

/// Where a node or an instance puts its mesh: scaled, turned, moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

impl Transform {
    /// The transform that scales the mesh about a point of it first.
    pub(super) fn scaled_about(self, resize: &Resize) -> Self {
        let centre_from_origin = self.rotation * (self.scale * resize.centre_local);
        Self {
            translation: self.translation + (1.0 - resize.linear_scale) * centre_from_origin,
            scale: resize.linear_scale * self.scale,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_of_a_scaled_place_stays() {
        let transform = Transform {
            translation: DVec3::new(1.0, 2.0, 3.0),
            rotation: DQuat::from_rotation_z(0.5),
            scale: DVec3::new(2.0, -1.0, 0.5),
        };
        let resize = Resize {
            centre_local: DVec3::new(0.5, 0.25, -1.0),
            linear_scale: 3.0,
        };
        let matrix = |t: Transform| {
            DMat4::from_scale_rotation_translation(t.scale, t.rotation, t.translation)
        };
        let scaled = matrix(transform.scaled_about(&resize));
        let expected = matrix(transform) * about_centre(&resize);
        assert!(scaled.abs_diff_eq(expected, 1e-12));
        let centre = matrix(transform).transform_point3(resize.centre_local);
        assert!(
            scaled
                .transform_point3(resize.centre_local)
                .distance(centre)
                < 1e-12
        );
    }

    #[test]
    fn nodes_with_company_are_not_free() {
        let root = json!({
            "nodes": [{"mesh": 0}, {"mesh": 0, "children": [0]}, {"mesh": 0}, {"mesh": 0}, {"mesh": 0}],
            "skins": [{"joints": [2]}],
            "animations": [{"channels": [
                {"sampler": 0, "target": {"node": 3, "path": "scale"}},
                {"sampler": 0, "target": {"path": "pointer", "extensions":
                    {"KHR_animation_pointer": {"pointer": "/nodes/4/translation"}}}}]}],
        });
        let moved_by_others = animated_and_joint_nodes(&root);
        let is_free = |&node: &usize| can_scale_node(&root, &moved_by_others, node);
        assert_eq!((0..5).filter(is_free).collect::<Vec<_>>(), [0]);
    }
}
