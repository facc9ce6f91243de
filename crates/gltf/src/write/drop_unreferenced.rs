//! Drops the accessors, buffer views and meshes that nothing names any more.
//! Accessors and buffer views that stay keep their numbers: an extension that is
//! not known may name them.

use std::collections::{BTreeSet, HashSet};

use serde_json::{Value, json};

use super::draft::{Draft, NewElements, Role};
use super::references::{
    VisitNumbers, as_index, count_references, items, knows_all_extensions, len,
    visit_accessor_numbers, visit_mesh_numbers, visit_view_numbers,
};
use crate::accessor::{Component, Shape};

/// How often the input names each of its accessors and buffer views.
pub(super) struct References {
    accessors: Vec<u32>,
    views: Vec<u32>,
}

impl References {
    pub(super) fn of(root: &mut Value) -> Self {
        let (accessors, views) = (len(root, "accessors"), len(root, "bufferViews"));
        Self {
            accessors: count_references(root, accessors, visit_accessor_numbers),
            views: count_references(root, views, visit_view_numbers),
        }
    }

    /// How many accessors the input has.
    pub(super) fn accessors(&self) -> usize {
        self.accessors.len()
    }

    /// Accessors of the input that nothing in `root` names any more.
    pub(super) fn accessors_without_a_user(&self, root: &mut Value) -> HashSet<usize> {
        let after = count_references(root, self.accessors.len(), visit_accessor_numbers);
        let is_gone = |&number: &usize| after[number] == 0 && self.accessors[number] > 0;
        (0..self.accessors.len()).filter(is_gone).collect()
    }

    /// Accessors of the input that are named less often in `root`.
    pub(super) fn accessors_that_lost_a_user(&self, root: &mut Value) -> HashSet<usize> {
        let after = count_references(root, self.accessors.len(), visit_accessor_numbers);
        let lost = |&number: &usize| after[number] < self.accessors[number];
        (0..self.accessors.len()).filter(lost).collect()
    }
}

/// Drops the accessors and buffer views that nothing names any more. Returns the
/// views that lost some of their accessors, where it is certain that nobody else
/// needs those bytes.
pub(super) fn drop_unreferenced(draft: &mut Draft, before: &References) -> HashSet<usize> {
    stop_animating_lost_weights(draft);

    let renumbered = renumber_new(
        &mut draft.root,
        &ACCESSORS,
        &before.accessors,
        &draft.accessor_origins,
    );
    debug_assert!(
        renumbered
            .placeholders
            .iter()
            .all(|&n| before.accessors[n] > 0)
    );

    let view_count = len(&draft.root, "bufferViews");
    let after = count_references(&mut draft.root, view_count, visit_view_numbers);
    let renumbered = renumber_new(&mut draft.root, &VIEWS, &before.views, &draft.view_origins);
    let first_new = before.views.len();
    let bytes = std::mem::take(&mut draft.new_bytes);
    let renamed =
        |(view, bytes): (usize, Vec<u8>)| (renumbered.new_numbers[view - first_new], bytes);
    draft.new_bytes = bytes.into_iter().map(renamed).collect();
    for placeholder in renumbered.placeholders {
        draft
            .new_bytes
            .insert(placeholder, vec![0; PLACEHOLDER_BYTES]);
    }

    drop_extension(&mut draft.root, "EXT_mesh_gpu_instancing", uses_instancing);
    if !knows_all_extensions(&draft.root) {
        return HashSet::new();
    }
    let lost_some = |&view: &usize| after[view] > 0 && after[view] < before.views[view];
    (0..before.views.len()).filter(lost_some).collect()
}

const PLACEHOLDER_BYTES: usize = 4;

/// A top-level list whose items are named by number.
struct List {
    name: &'static str,
    visit_numbers: VisitNumbers,
    /// The smallest valid item, for a number that must stay taken.
    placeholder: fn() -> Value,
    /// What a new item takes over from the one whose number it gets.
    inherited: &'static [&'static str],
}

const ACCESSORS: List = List {
    name: "accessors",
    visit_numbers: visit_accessor_numbers,
    placeholder: || json!({"componentType": 5126, "count": 1, "type": "SCALAR"}),
    inherited: &[],
};

const VIEWS: List = List {
    name: "bufferViews",
    visit_numbers: visit_view_numbers,
    placeholder: || json!({"buffer": 0, "byteLength": PLACEHOLDER_BYTES}),
    inherited: &["name", "extras"],
};

struct Renumbered {
    /// The final numbers of the new items.
    new_numbers: Vec<usize>,
    /// Numbers of the input that are not needed and could not be dropped.
    placeholders: Vec<usize>,
}

/// Moves new items into numbers that are not needed any more, each to that of
/// the item it stands for if it can, and drops what is left over at the end.
fn renumber_new(
    root: &mut Value,
    list: &List,
    before: &[u32],
    origins: &[Option<usize>],
) -> Renumbered {
    let total = before.len() + origins.len();
    let after = count_references(root, total, list.visit_numbers);
    let mut free: BTreeSet<usize> = (0..before.len())
        .filter(|&number| before[number] > 0 && after[number] == 0)
        .collect();
    let new_numbers = choose_numbers(&mut free, before.len(), origins);

    (list.visit_numbers)(root, &mut |number| {
        let new = as_index(number).and_then(|n| n.checked_sub(before.len()));
        if let Some(&renumbered) = new.and_then(|new| new_numbers.get(new)) {
            *number = renumbered.into();
        }
    });
    let Some(old) = root.get_mut(list.name).and_then(Value::as_array_mut) else {
        return Renumbered {
            new_numbers,
            placeholders: Vec::new(),
        };
    };
    let new = old.split_off(before.len());
    for (number, mut item) in new_numbers.iter().zip(new) {
        match old.get_mut(*number) {
            Some(slot) => {
                inherit(&mut item, slot, list.inherited);
                *slot = item;
            }
            None => old.push(item),
        }
    }
    while free.last().is_some_and(|&last| last + 1 == old.len()) {
        free.pop_last();
        old.pop();
    }
    for &number in &free {
        old[number] = (list.placeholder)();
    }
    if old.is_empty() {
        remove_field(root, list.name);
    }
    Renumbered {
        new_numbers,
        placeholders: free.into_iter().collect(),
    }
}

/// Ascending where numbers are appended, so that items can be pushed in order.
fn choose_numbers(
    free: &mut BTreeSet<usize>,
    old_count: usize,
    origins: &[Option<usize>],
) -> Vec<usize> {
    let own: Vec<Option<usize>> = origins
        .iter()
        .map(|origin| origin.filter(|origin| free.remove(origin)))
        .collect();
    let mut appended = old_count..;
    own.into_iter()
        .map(|own| {
            own.or_else(|| free.pop_first())
                .unwrap_or_else(|| appended.next().expect("numbers do not end"))
        })
        .collect()
}

fn inherit(item: &mut Value, from: &Value, names: &[&str]) {
    for name in names {
        if let (None, Some(value)) = (item.get(name), from.get(name)) {
            item[*name] = value.clone();
        }
    }
}

/// Drops meshes that have no primitive left. Meshes behind them move up, unless
/// an unknown extension might name one: then a mesh of one point, which no node
/// draws, keeps the place.
pub(super) fn drop_meshes(draft: &mut Draft, empty: &BTreeSet<usize>) {
    let count = len(&draft.root, "meshes");
    let is_trailing = |&mesh: &usize| (mesh..count).all(|later| empty.contains(&later));
    let may_move = knows_all_extensions(&draft.root);
    let (dropped, kept): (BTreeSet<usize>, BTreeSet<usize>) =
        empty.iter().partition(|mesh| may_move || is_trailing(mesh));
    if !kept.is_empty() {
        put_in_points(draft, &kept);
    }
    let root = &mut draft.root;
    visit_mesh_numbers(root, &mut |number| {
        if let Some(mesh) = as_index(number) {
            *number = (mesh - dropped.range(..mesh).count()).into();
        }
    });
    if let Some(meshes) = root.get_mut("meshes").and_then(Value::as_array_mut) {
        let mut number = 0..;
        meshes.retain(|_| number.next().is_some_and(|mesh| !dropped.contains(&mesh)));
        if meshes.is_empty() {
            remove_field(root, "meshes");
        }
    }
}

/// The meshes that were drawn in the file and are not any more.
pub(super) fn undrawn_meshes(draft: &mut Draft) -> BTreeSet<usize> {
    let count = len(&draft.document.root, "meshes");
    let mut original = draft.document.root.clone();
    let was_drawn = count_references(&mut original, count, visit_mesh_numbers);
    let all = len(&draft.root, "meshes");
    let is_drawn = count_references(&mut draft.root, all, visit_mesh_numbers);
    (0..count.min(all))
        .filter(|&mesh| was_drawn[mesh] > 0 && is_drawn[mesh] == 0)
        .collect()
}

fn put_in_points(draft: &mut Draft, meshes: &BTreeSet<usize>) {
    const POINTS: u32 = 0;
    let zero = NewElements {
        component: Component::F32,
        shape: Shape::Vector(3),
        normalized: false,
        count: 1,
        bytes: None,
        bounded: true,
        role: Role::Vertex,
    };
    let point = draft.push_accessor(None, zero);
    for &mesh in meshes {
        let fields = &mut draft.root["meshes"][mesh];
        fields["primitives"] = json!([{"attributes": {"POSITION": point}, "mode": POINTS}]);
        remove_field(fields, "weights");
    }
}

/// Channels that animate the morph weights of a node without mesh lose their
/// node: they are valid then, do nothing, and animations keep their numbers.
fn stop_animating_lost_weights(draft: &mut Draft) {
    let has_mesh: Vec<bool> = items(&mut draft.root, "nodes")
        .map(|node| node.get("mesh").is_some())
        .collect();
    let mut stopped = 0;
    for animation in items(&mut draft.root, "animations") {
        for channel in items(animation, "channels") {
            let Some(target) = channel.get_mut("target").and_then(Value::as_object_mut) else {
                continue;
            };
            let node = target.get("node").and_then(as_index);
            let is_lost = node.is_some_and(|node| has_mesh.get(node) == Some(&false));
            if is_lost && target.get("path").is_some_and(|path| path == "weights") {
                target.shift_remove("node");
                stopped += 1;
            }
        }
    }
    if stopped > 0 {
        draft.notes.push(format!(
            "{stopped} animation channels moved morph weights of nodes that have no leaf left; they do nothing now"
        ));
    }
}

fn uses_instancing(root: &Value) -> bool {
    let nodes = root.get("nodes").and_then(Value::as_array);
    nodes.into_iter().flatten().any(|node| {
        node.pointer("/extensions/EXT_mesh_gpu_instancing")
            .is_some()
    })
}

/// Takes an extension off the lists of extensions unless it is still used.
pub(super) fn drop_extension(root: &mut Value, name: &str, is_used: fn(&Value) -> bool) {
    if is_used(root) {
        return;
    }
    for list in ["extensionsUsed", "extensionsRequired"] {
        let Some(names) = root.get_mut(list).and_then(Value::as_array_mut) else {
            continue;
        };
        names.retain(|other| other != name);
        if names.is_empty() {
            remove_field(root, list);
        }
    }
}

/// Removes a field of an object.
pub(super) fn remove_field(object: &mut Value, name: &str) {
    if let Some(fields) = object.as_object_mut() {
        fields.shift_remove(name);
    }
}
