//! Primitives of one look become one: each costs an engine a draw call.

use std::collections::HashMap;

use serde_json::{Map, Value, json};

use super::super::draft::{Draft, NewElements, Role, is_all_zero};
use super::super::references::as_index;
use super::vertices::{corners_of, push_indices, topology_of};
use crate::accessor::Component;
use crate::error::Fault;
use crate::primitive::Topology;

/// A primitive of a level, and whether its triangles are leaves.
pub(in crate::write) struct LevelPrimitive {
    pub(in crate::write) json: Value,
    pub(in crate::write) is_foliage: bool,
}

/// Joins primitives that differ in their vertices only; leaves and wood stay
/// apart. In the order of the first of each.
pub(in crate::write) fn merged(
    draft: &mut Draft,
    primitives: Vec<LevelPrimitive>,
) -> Result<Vec<Value>, Fault> {
    let mut groups: Vec<Vec<Value>> = Vec::new();
    let mut group_of: HashMap<String, usize> = HashMap::new();
    for primitive in primitives {
        let group = match look(draft, &primitive)? {
            Some(look) => *group_of.entry(look).or_insert(groups.len()),
            None => groups.len(),
        };
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(primitive.json);
    }
    let mut joined = Vec::with_capacity(groups.len());
    for mut group in groups {
        joined.push(match group.len() {
            1 => group.remove(0),
            _ => join(draft, &group)?,
        });
    }
    Ok(joined)
}

/// All of a primitive but the elements of its accessors, or `None` if it cannot
/// be joined to another.
fn look(draft: &Draft, primitive: &LevelPrimitive) -> Result<Option<String>, Fault> {
    let json = &primitive.json;
    let is_list = topology_of(json) == Topology::List;
    let knows_vertices = json.get("extensions").is_some_and(|extensions| {
        let names = extensions.as_object().into_iter().flatten();
        names
            .into_iter()
            .any(|(name, _)| name != "KHR_materials_variants")
    });
    if !is_list || knows_vertices || json["attributes"].get("POSITION").is_none() {
        return Ok(None);
    }
    let mut sets = Vec::new();
    for set in attribute_sets(json) {
        let mut described = Vec::new();
        for (semantic, number) in set {
            let accessor = draft.elements(number)?.accessor;
            described.push(json!([semantic, accessor.kind(), accessor.normalized]));
        }
        described.sort_by_key(Value::to_string);
        sets.push(described);
    }
    let mut rest = json.clone();
    if let Some(fields) = rest.as_object_mut() {
        for vertices in ["attributes", "indices", "targets", "mode"] {
            fields.shift_remove(vertices);
        }
    }
    Ok(Some(json!([primitive.is_foliage, sets, rest]).to_string()))
}

/// The attributes of a primitive, then those of its morph targets.
fn attribute_sets(primitive: &Value) -> Vec<Vec<(String, usize)>> {
    let targets = primitive.get("targets").and_then(Value::as_array);
    let sets = std::iter::once(&primitive["attributes"]).chain(targets.into_iter().flatten());
    let numbers = |set: &Value| {
        let fields = set.as_object().into_iter().flatten();
        fields
            .filter_map(|(semantic, number)| Some((semantic.clone(), as_index(number)?)))
            .collect()
    };
    sets.map(numbers).collect()
}

fn join(draft: &mut Draft, group: &[Value]) -> Result<Value, Fault> {
    // Primitives with the very same vertices share them still.
    let mut lists: Vec<Vec<Vec<(String, usize)>>> = Vec::new();
    let mut starts: Vec<usize> = Vec::new();
    let mut vertex_count = 0;
    let mut corners: Vec<u32> = Vec::new();
    for primitive in group {
        let position = as_index(&primitive["attributes"]["POSITION"]).unwrap_or_default();
        let (own, count) = corners_of(draft, primitive, position)?;
        let sets = attribute_sets(primitive);
        let known = lists.iter().position(|other| *other == sets);
        let start = match known {
            Some(list) => starts[list],
            None => {
                lists.push(sets);
                starts.push(vertex_count);
                vertex_count += count;
                vertex_count - count
            }
        };
        corners.extend(own.iter().map(|corner| corner + start as u32));
    }
    let mut joined = group[0].clone();
    let mut new_sets = Vec::new();
    for (number, set) in lists[0].iter().enumerate() {
        let mut new_set = Map::new();
        for (semantic, first) in set {
            let others = lists.iter().map(|sets| {
                let found = sets[number].iter().find(|(name, _)| name == semantic);
                found.map_or(*first, |(_, accessor)| *accessor)
            });
            let accessors: Vec<usize> = others.collect();
            new_set.insert(semantic.clone(), concatenated(draft, &accessors)?.into());
        }
        new_sets.push(Value::Object(new_set));
    }
    let targets = new_sets.split_off(1);
    joined["attributes"] = new_sets.remove(0);
    if !targets.is_empty() {
        joined["targets"] = targets.into();
    }
    let old = group[0].get("indices").and_then(as_index);
    joined["indices"] = push_indices(draft, old, &corners, vertex_count).into();
    if let Some(fields) = joined.as_object_mut() {
        fields.shift_remove("mode");
    }
    Ok(joined)
}

/// The elements of accessors of one kind, one after the other.
fn concatenated(draft: &mut Draft, accessors: &[usize]) -> Result<usize, Fault> {
    if let [only] = accessors {
        return Ok(*only);
    }
    let kind = draft.elements(accessors[0])?.accessor;
    let mut bytes = Vec::new();
    let mut count = 0;
    let mut is_zero = true;
    let mut bounded = false;
    for &accessor in accessors {
        let elements = draft.elements(accessor)?;
        is_zero &= is_all_zero(&elements);
        count += elements.accessor.count;
        bytes.extend_from_slice(&elements.bytes);
        let fields = &draft.root["accessors"][accessor];
        bounded |= fields.get("min").is_some() || fields.get("max").is_some();
    }
    let new = NewElements {
        component: kind.component,
        shape: kind.shape,
        normalized: kind.normalized && kind.component != Component::F32,
        count,
        bytes: (!is_zero).then_some(bytes),
        bounded,
        role: Role::Vertex,
    };
    let origin = draft.origin_of(accessors[0]);
    Ok(draft.push_accessor(origin, new))
}
