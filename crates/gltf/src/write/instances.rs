//! Nodes that draw their mesh many times (EXT_mesh_gpu_instancing).

use std::rc::Rc;

use glam::{DQuat, DVec3};
use serde_json::{Map, Value};

use super::draft::{Draft, NewElements, Role};
use super::references::as_index;
use super::single_leaf_mesh::Transform;
use super::vertices::Resize;
use crate::accessor::{Component, Shape};
use crate::error::Fault;

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// What one place draws from now on.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    /// `None` if nothing is left there.
    pub(super) mesh: Option<usize>,
    /// How the place as a whole is scaled, in the mesh's own space.
    pub(super) resize: Option<Resize>,
}

/// Gives a node the instances that are left; all of them draw one mesh.
pub(super) fn place_instances(
    draft: &mut Draft,
    node: usize,
    old_mesh: usize,
    placements: &[(usize, Placement)],
) -> Result<(), Fault> {
    let is_unchanged = |p: &Placement| p.mesh == Some(old_mesh) && p.resize.is_none();
    if placements
        .iter()
        .all(|(_, placement)| is_unchanged(placement))
    {
        return Ok(());
    }
    let groups = group_by_mesh(old_mesh, placements);
    let left: usize = groups.iter().map(|(_, members)| members.len()).sum();
    if left < placements.len() {
        let place = draft.document.place("nodes", node);
        let gone = placements.len() - left;
        draft.notes.push(format!(
            "{place}: {gone} of {} instances are gone",
            placements.len()
        ));
    }
    let attributes = old_attributes(draft, node);
    // Instances that come apart are one mesh by now.
    let Some((mesh, members)) = groups.first() else {
        draft.take_mesh_away(node);
        take_instancing_away(&mut draft.root["nodes"][node]);
        return Ok(());
    };
    let own = instance_attributes(draft, &attributes, members)?;
    let fields = &mut draft.root["nodes"][node];
    fields["mesh"] = (*mesh).into();
    fields["extensions"][INSTANCING]["attributes"] = own;
    Ok(())
}

/// Instances, and how each is scaled.
type Members<'p> = Vec<(usize, Option<&'p Resize>)>;

/// Instances by the mesh that they draw, the old mesh first, then in the order
/// of first instances.
fn group_by_mesh(old_mesh: usize, placements: &[(usize, Placement)]) -> Vec<(usize, Members<'_>)> {
    let mut groups: Vec<(usize, Members)> = vec![(old_mesh, Members::new())];
    let mut group_of = std::collections::HashMap::from([(old_mesh, 0)]);
    for (instance, placement) in placements {
        let Some(mesh) = placement.mesh else {
            continue;
        };
        let group = *group_of.entry(mesh).or_insert_with(|| {
            groups.push((mesh, Members::new()));
            groups.len() - 1
        });
        groups[group].1.push((*instance, placement.resize.as_ref()));
    }
    groups.retain(|(_, members)| !members.is_empty());
    groups
}

fn old_attributes(draft: &Draft, node: usize) -> Vec<(String, usize)> {
    let extension = &draft.document.root["nodes"][node]["extensions"][INSTANCING];
    let attributes = extension.get("attributes").and_then(Value::as_object);
    attributes
        .into_iter()
        .flatten()
        .filter_map(|(name, number)| Some((name.clone(), as_index(number)?)))
        .collect()
}

/// The attributes of some of a node's instances, every one of them, with
/// translation and scale as their resizes ask.
fn instance_attributes(
    draft: &mut Draft,
    old: &[(String, usize)],
    members: &Members,
) -> Result<Value, Fault> {
    let sources: Rc<[u32]> = members
        .iter()
        .map(|(instance, _)| *instance as u32)
        .collect();
    let is_scaled = members.iter().any(|(_, resize)| resize.is_some());
    let mut attributes = Map::new();
    for (name, accessor) in old {
        if is_scaled && ["TRANSLATION", "SCALE"].contains(&name.as_str()) {
            continue;
        }
        let gathered = draft.gather(*accessor, Role::Instance, &sources)?;
        attributes.insert(name.clone(), gathered.into());
    }
    if is_scaled {
        let scaled = scaled_transforms(draft, old, members)?;
        let mut insert = |name: &str, accessor: usize| {
            attributes.insert(name.to_owned(), accessor.into());
        };
        let translations = scaled.iter().map(|transform| transform.translation);
        insert(
            "TRANSLATION",
            push_vectors(draft, old, "TRANSLATION", translations),
        );
        let scales = scaled.iter().map(|transform| transform.scale);
        insert("SCALE", push_vectors(draft, old, "SCALE", scales));
    }
    Ok(attributes.into())
}

/// Instances that keep their size keep the bits of their transform.
fn scaled_transforms(
    draft: &Draft,
    old: &[(String, usize)],
    members: &Members,
) -> Result<Vec<Transform>, Fault> {
    let translations = read::<3>(draft, old, "TRANSLATION")?;
    let rotations = read::<4>(draft, old, "ROTATION")?;
    let scales = read::<3>(draft, old, "SCALE")?;
    let transform = |&(instance, resize): &(usize, Option<&Resize>)| {
        let rotation = rotations.get(instance).copied();
        let transform = Transform {
            translation: translations
                .get(instance)
                .copied()
                .map_or(DVec3::ZERO, DVec3::from),
            rotation: rotation.map_or(DQuat::IDENTITY, |r| DQuat::from_array(r).normalize()),
            scale: scales
                .get(instance)
                .copied()
                .map_or(DVec3::ONE, DVec3::from),
        };
        resize.map_or(transform, |resize| transform.scaled_about(resize))
    };
    Ok(members.iter().map(transform).collect())
}

fn accessor_named(old: &[(String, usize)], name: &str) -> Option<usize> {
    old.iter()
        .find(|(other, _)| other == name)
        .map(|(_, accessor)| *accessor)
}

fn read<const N: usize>(
    draft: &Draft,
    old: &[(String, usize)],
    name: &str,
) -> Result<Vec<[f64; N]>, Fault> {
    match accessor_named(old, name) {
        Some(accessor) => Ok(draft.document.elements(accessor)?.vectors::<N>().collect()),
        None => Ok(Vec::new()),
    }
}

fn push_vectors(
    draft: &mut Draft,
    old: &[(String, usize)],
    name: &str,
    vectors: impl ExactSizeIterator<Item = DVec3>,
) -> usize {
    let origin = accessor_named(old, name);
    let count = vectors.len();
    let bounded = origin.is_some_and(|accessor| {
        let fields = &draft.document.root["accessors"][accessor];
        fields.get("min").is_some() || fields.get("max").is_some()
    });
    let bytes = vectors
        .flat_map(|vector| vector.as_vec3().to_array())
        .flat_map(f32::to_le_bytes)
        .collect();
    let new = NewElements {
        component: Component::F32,
        shape: Shape::Vector(3),
        normalized: false,
        count,
        bytes: Some(bytes),
        bounded,
        role: Role::Instance,
    };
    draft.push_accessor(origin, new)
}

pub(super) fn take_instancing_away(node: &mut Value) {
    let Some(fields) = node.as_object_mut() else {
        return;
    };
    let Some(extensions) = fields.get_mut("extensions").and_then(Value::as_object_mut) else {
        return;
    };
    extensions.shift_remove(INSTANCING);
    if extensions.is_empty() {
        fields.shift_remove("extensions");
    }
}
