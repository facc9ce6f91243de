//! What a chain has twice is kept once: levels have much in common.

use std::collections::HashMap;

use serde_json::Value;

use super::super::draft::Draft;
use super::super::references::{
    as_index, count_references, len, visit_accessor_numbers, visit_view_numbers,
};

/// Lets new accessors with the same elements be one, and forgets those that
/// nothing names: what was made on the way to something else.
pub(super) fn deduplicate_accessors(draft: &mut Draft) {
    share_equal(draft);
    forget_unused(draft);
}

fn share_equal(draft: &mut Draft) {
    let first_new = len(&draft.document.root, "accessors");
    let count = len(&draft.root, "accessors");
    let mut known: HashMap<(String, Option<&[u8]>), usize> = HashMap::new();
    let mut same_as: HashMap<usize, usize> = HashMap::new();
    for number in first_new..count {
        let accessor = &draft.root["accessors"][number];
        let view = accessor.get("bufferView").and_then(as_index);
        let mut description = accessor.clone();
        // Elements of an index and of a vertex may be the same bytes, but not share a view.
        description["bufferView"] = view.map_or(Value::Null, |view| {
            let fields = &draft.root["bufferViews"][view];
            let name = |name| fields.get(name).cloned().unwrap_or_default();
            [name("target"), name("byteStride")].into_iter().collect()
        });
        let bytes = view.map(|view| draft.new_bytes[&view].as_slice());
        let key = (description.to_string(), bytes);
        match known.get(&key) {
            Some(&first) => {
                same_as.insert(number, first);
            }
            None => {
                known.insert(key, number);
            }
        }
    }
    drop(known);
    visit_accessor_numbers(&mut draft.root, &mut |number| {
        if let Some(first) = as_index(number).and_then(|n| same_as.get(&n)) {
            *number = (*first).into();
        }
    });
}

/// Forgets new accessors, and their views, that nothing names.
pub(in crate::write) fn forget_unused(draft: &mut Draft) {
    let first_new = len(&draft.document.root, "accessors");
    let count = len(&draft.root, "accessors");
    let uses = count_references(&mut draft.root, count, visit_accessor_numbers);
    let new_numbers = numbers_after(first_new, &uses);
    visit_accessor_numbers(&mut draft.root, &mut |number| {
        if let Some(new) = as_index(number).and_then(|n| new_numbers.get(&n)) {
            *number = (*new).into();
        }
    });
    retain(&mut draft.root, "accessors", first_new, &new_numbers);
    let mut number = first_new..;
    draft
        .accessor_origins
        .retain(|_| number.next().is_some_and(|n| new_numbers.contains_key(&n)));

    let first_new = len(&draft.document.root, "bufferViews");
    let count = len(&draft.root, "bufferViews");
    let uses = count_references(&mut draft.root, count, visit_view_numbers);
    let new_numbers = numbers_after(first_new, &uses);
    visit_view_numbers(&mut draft.root, &mut |number| {
        if let Some(new) = as_index(number).and_then(|n| new_numbers.get(&n)) {
            *number = (*new).into();
        }
    });
    retain(&mut draft.root, "bufferViews", first_new, &new_numbers);
    let mut number = first_new..;
    draft
        .view_origins
        .retain(|_| number.next().is_some_and(|n| new_numbers.contains_key(&n)));
    let bytes = std::mem::take(&mut draft.new_bytes);
    let kept = bytes
        .into_iter()
        .filter_map(|(view, bytes)| Some((*new_numbers.get(&view)?, bytes)));
    draft.new_bytes = kept.collect();
}

/// The numbers that new items have when those without a use are gone.
fn numbers_after(first_new: usize, uses: &[u32]) -> HashMap<usize, usize> {
    let used = (first_new..uses.len()).filter(|&number| uses[number] > 0);
    used.zip(first_new..).collect()
}

fn retain(root: &mut Value, list: &str, first_new: usize, kept: &HashMap<usize, usize>) {
    if let Some(items) = root.get_mut(list).and_then(Value::as_array_mut) {
        let mut number = 0..;
        items.retain(|_| {
            number
                .next()
                .is_some_and(|n| n < first_new || kept.contains_key(&n))
        });
    }
}
