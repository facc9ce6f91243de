//! Mutations of JSON by path.

use secateur_plant::Random;
use serde_json::{Value, json};

use crate::{below, extremes, pick};

/// Properties that readers look for, wherever they are put.
const KEYS: [&str; 24] = [
    "accessor",
    "accessors",
    "alphaCutoff",
    "alphaMode",
    "attributes",
    "bufferView",
    "byteOffset",
    "byteStride",
    "children",
    "count",
    "extensions",
    "extras",
    "images",
    "indices",
    "material",
    "matrix",
    "mesh",
    "mode",
    "normalized",
    "scale",
    "scenes",
    "sparse",
    "targets",
    "uri",
];

/// Changes one node of a document.
pub fn mutate(root: &mut Value, random: &mut Random) {
    let count = count(root);
    let target = below(random, count);
    let donor = nth(root, &mut below(random, count)).cloned();
    let Some(node) = nth_mut(root, &mut { target }) else {
        return;
    };
    match (below(random, 8), &mut *node) {
        (0..=2, Value::Number(number)) => {
            let near = below(random, 9) as i64 - 4;
            let near = number.as_i64().map(|n| n.saturating_add(near));
            *node = near.map_or_else(|| extremes::value(random), |n| json!(n));
        }
        (0, Value::Array(items)) if !items.is_empty() => {
            items.remove(below(random, items.len()));
        }
        (1, Value::Array(items)) if !items.is_empty() => {
            let copy = pick(random, items).clone();
            items.insert(below(random, items.len() + 1), copy);
        }
        (2, Value::Array(items)) => items.extend(donor),
        (0, Value::Object(members)) if !members.is_empty() => {
            let at = below(random, members.len());
            let key = members.keys().nth(at).cloned();
            key.and_then(|key| members.shift_remove(&key));
        }
        (1 | 2, Value::Object(members)) => {
            let key = (*pick(random, &KEYS)).to_owned();
            let value = donor.unwrap_or_else(|| extremes::value(random));
            members.insert(key, value);
        }
        (3, _) => *node = donor.unwrap_or(Value::Null),
        _ => *node = extremes::value(random),
    }
}

/// Nodes of a document, itself one of them.
fn count(value: &Value) -> usize {
    let children: usize = match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(members) => members.values().map(count).sum(),
        _ => 0,
    };
    1 + children
}

/// The node after `left` others, parents first.
fn nth<'a>(value: &'a Value, left: &mut usize) -> Option<&'a Value> {
    if *left == 0 {
        return Some(value);
    }
    *left -= 1;
    match value {
        Value::Array(items) => items.iter().find_map(|item| nth(item, left)),
        Value::Object(members) => members.values().find_map(|member| nth(member, left)),
        _ => None,
    }
}

fn nth_mut<'a>(value: &'a mut Value, left: &mut usize) -> Option<&'a mut Value> {
    if *left == 0 {
        return Some(value);
    }
    *left -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| nth_mut(item, left)),
        Value::Object(members) => members
            .values_mut()
            .find_map(|member| nth_mut(member, left)),
        _ => None,
    }
}
