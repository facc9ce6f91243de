//! Every place of a glTF file that names an accessor, a buffer view, a mesh or a
//! node by its number.
//!
//! An extension that is not known here may hold such numbers too. That is why
//! the writer never renumbers what was there before; see
//! [`knows_all_extensions`].

use serde_json::Value;

use crate::error::Problem;
use crate::skeleton::ACCESSORS_POINTER;

/// A walk over all numbers of one kind.
pub(super) type VisitNumbers = fn(&mut Value, &mut dyn FnMut(&mut Value));

/// Calls `visit` with each accessor number.
pub(super) fn visit_accessor_numbers(root: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for mesh in items(root, "meshes") {
        for primitive in items(mesh, "primitives") {
            visit_values(primitive.get_mut("attributes"), visit);
            visit_field(primitive, "indices", visit);
            for target in items(primitive, "targets") {
                visit_values(Some(target), visit);
            }
        }
    }
    for skin in items(root, "skins") {
        visit_field(skin, "inverseBindMatrices", visit);
    }
    for animation in items(root, "animations") {
        for sampler in items(animation, "samplers") {
            visit_field(sampler, "input", visit);
            visit_field(sampler, "output", visit);
        }
    }
    for node in items(root, "nodes") {
        let attributes = node.pointer_mut("/extensions/EXT_mesh_gpu_instancing/attributes");
        visit_values(attributes, visit);
    }
    visit_values(root.pointer_mut(ACCESSORS_POINTER), visit);
}

/// Calls `visit` with each buffer view number.
pub(super) fn visit_view_numbers(root: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for accessor in items(root, "accessors") {
        visit_field(accessor, "bufferView", visit);
        for part in ["indices", "values"] {
            let sparse = accessor.get_mut("sparse");
            if let Some(part) = sparse.and_then(|sparse| sparse.get_mut(part)) {
                visit_field(part, "bufferView", visit);
            }
        }
    }
    for image in items(root, "images") {
        visit_field(image, "bufferView", visit);
    }
    for mesh in items(root, "meshes") {
        for primitive in items(mesh, "primitives") {
            if let Some(draco) = primitive.pointer_mut("/extensions/KHR_draco_mesh_compression") {
                visit_field(draco, "bufferView", visit);
            }
        }
    }
}

/// Calls `visit` with each mesh number.
pub(super) fn visit_mesh_numbers(root: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for node in items(root, "nodes") {
        visit_field(node, "mesh", visit);
    }
}

/// Calls `visit` with each node number.
pub(super) fn visit_node_numbers(root: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for scene in items(root, "scenes") {
        items(scene, "nodes").for_each(&mut *visit);
    }
    for node in items(root, "nodes") {
        items(node, "children").for_each(&mut *visit);
        if let Some(lod) = node.pointer_mut("/extensions/MSFT_lod") {
            items(lod, "ids").for_each(&mut *visit);
        }
    }
    for skin in items(root, "skins") {
        items(skin, "joints").for_each(&mut *visit);
        visit_field(skin, "skeleton", visit);
    }
    for animation in items(root, "animations") {
        for channel in items(animation, "channels") {
            if let Some(target) = channel.get_mut("target") {
                visit_field(target, "node", visit);
            }
        }
    }
}

/// Refuses a file in which something names an entry that is not there: the writer adds
/// entries at the ends of lists, and one of them would get that number.
pub(crate) fn check_references(root: &mut Value) -> Result<(), Problem> {
    const LISTS: [(&str, VisitNumbers); 4] = [
        ("accessors", visit_accessor_numbers),
        ("bufferViews", visit_view_numbers),
        ("meshes", visit_mesh_numbers),
        ("nodes", visit_node_numbers),
    ];
    for (list, visit_numbers) in LISTS {
        let count = len(root, list);
        let mut stray = None;
        visit_numbers(root, &mut |number| {
            stray = stray.or(as_index(number).filter(|&index| index >= count));
        });
        if let Some(index) = stray {
            return Err(Problem::NoSuch { list, index, count });
        }
    }
    Ok(())
}

/// How often each of `count` items is named by the numbers that `visit_numbers`
/// finds.
pub(super) fn count_references(
    root: &mut Value,
    count: usize,
    visit_numbers: VisitNumbers,
) -> Vec<u32> {
    let mut references = vec![0; count];
    visit_numbers(root, &mut |number| {
        if let Some(slot) = as_index(number).and_then(|index| references.get_mut(index)) {
            *slot += 1;
        }
    });
    references
}

/// Whether every extension that the file uses is known to name no accessor,
/// buffer view or mesh other than in the places visited here.
pub(super) fn knows_all_extensions(root: &Value) -> bool {
    const FAMILIES: [&str; 3] = ["KHR_materials_", "KHR_texture_", "EXT_texture_"];
    const OTHERS: [&str; 10] = [
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
        "KHR_node_visibility",
        "KHR_xmp_json_ld",
        "MSFT_lod",
        "MSFT_texture_dds",
    ];
    let known = |name: &str| {
        OTHERS.contains(&name) || FAMILIES.iter().any(|family| name.starts_with(family))
    };
    let used = root.get("extensionsUsed").and_then(Value::as_array);
    used.into_iter()
        .flatten()
        .all(|name| name.as_str().is_some_and(known))
}

/// The items of a list of an object, none where there is no such list.
pub(super) fn items<'a>(object: &'a mut Value, list: &str) -> std::slice::IterMut<'a, Value> {
    let list = object.get_mut(list).and_then(Value::as_array_mut);
    list.map(|list| list.iter_mut()).unwrap_or_default()
}

/// How many items a top-level list has.
pub(super) fn len(root: &Value, list: &str) -> usize {
    root.get(list).and_then(Value::as_array).map_or(0, Vec::len)
}

/// The number in a JSON value that names an item of a list. JSON does not tell
/// 2 from 2.0.
pub(super) fn as_index(number: &Value) -> Option<usize> {
    let from_float = |x: f64| (x >= 0.0 && x.fract() == 0.0).then_some(x as u64);
    let whole = number
        .as_u64()
        .or_else(|| number.as_f64().and_then(from_float));
    whole.and_then(|n| usize::try_from(n).ok())
}

fn visit_field(object: &mut Value, field: &str, visit: &mut dyn FnMut(&mut Value)) {
    if let Some(number) = object.get_mut(field) {
        visit(number);
    }
}

fn visit_values(object: Option<&mut Value>, visit: &mut dyn FnMut(&mut Value)) {
    if let Some(fields) = object.and_then(Value::as_object_mut) {
        fields.values_mut().for_each(visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_place_is_visited_once() {
        // Each number occurs in one place only, so a place that is forgotten or
        // visited twice shows.
        let mut root = json!({
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": 0, "_AGE": 1}, "indices": 2, "targets": [{"POSITION": 3}]},
                {"attributes": {"POSITION": 4}}]}],
            "skins": [{"inverseBindMatrices": 5, "joints": [9]}, {"joints": [9]}],
            "animations": [{"channels": [{"sampler": 9}], "samplers": [{"input": 6, "output": 7}]}],
            "nodes": [{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing":
                {"attributes": {"TRANSLATION": 8, "_ID": 9}}}}],
            "extras": {"secateur_skeleton": {"version": 1, "accessors": {"leaf_segment": 10}}},
            "accessors": [
                {"bufferView": 0, "sparse": {"count": 9, "indices": {"bufferView": 1}, "values": {"bufferView": 2}}},
                {"count": 9}],
            "images": [{"bufferView": 3}, {"uri": "bark.png"}],
        });
        let nodes = json!([{"children": [0]}, {"extensions": {"MSFT_lod": {"ids": [1, 2]}}}]);
        let mut of_nodes = json!({
            "scenes": [{"nodes": [3]}, {}],
            "nodes": nodes,
            "skins": [{"joints": [4, 5], "skeleton": 6}],
            "animations": [{"channels": [{"target": {"node": 7}}, {"target": {}}]}],
        });
        assert_eq!(
            count_references(&mut of_nodes, 8, visit_node_numbers),
            [1; 8]
        );
        assert_eq!(
            count_references(&mut root, 11, visit_accessor_numbers),
            [1; 11]
        );
        assert_eq!(count_references(&mut root, 4, visit_view_numbers), [1; 4]);
        assert_eq!(count_references(&mut root, 1, visit_mesh_numbers), [1]);
    }

    #[test]
    fn numbers_of_entries_that_are_not_there_are_refused() {
        // Two of each list; whoever names a third is found, in every place.
        let sound = json!({
            "accessors": [{"bufferView": 1}, {"sparse": {"indices": {"bufferView": 0}, "values": {"bufferView": 1}}}],
            "bufferViews": [{}, {}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}, {}],
            "nodes": [{"mesh": 1, "children": [1]}, {}],
            "scenes": [{"nodes": [0]}],
            "skins": [{"inverseBindMatrices": 1, "joints": [1], "skeleton": 0}],
            "animations": [{
                "samplers": [{"input": 0, "output": 1}],
                "channels": [{"target": {"node": 1}}]}],
            "images": [{"bufferView": 1}],
        });
        assert!(check_references(&mut sound.clone()).is_ok());
        for (place, list) in [
            ("/accessors/0/bufferView", "bufferViews"),
            ("/accessors/1/sparse/values/bufferView", "bufferViews"),
            ("/images/0/bufferView", "bufferViews"),
            ("/meshes/0/primitives/0/attributes/POSITION", "accessors"),
            ("/skins/0/inverseBindMatrices", "accessors"),
            ("/animations/0/samplers/0/output", "accessors"),
            ("/nodes/0/mesh", "meshes"),
            ("/nodes/0/children/0", "nodes"),
            ("/scenes/0/nodes/0", "nodes"),
            ("/skins/0/joints/0", "nodes"),
            ("/skins/0/skeleton", "nodes"),
            ("/animations/0/channels/0/target/node", "nodes"),
        ] {
            let mut broken = sound.clone();
            *broken.pointer_mut(place).unwrap() = 2.into();
            let refused = check_references(&mut broken);
            let is_it = matches!(refused, Err(Problem::NoSuch { list: l, index: 2, count: 2 }) if l == list);
            assert!(is_it, "{place}: {refused:?}");
        }
    }

    #[test]
    fn a_strange_extension_is_not_known() {
        assert!(knows_all_extensions(&json!({})));
        let known = json!({"extensionsUsed": ["KHR_texture_transform", "KHR_materials_variants"]});
        assert!(knows_all_extensions(&known));
        assert!(!knows_all_extensions(
            &json!({"extensionsUsed": ["EXT_structural_metadata"]})
        ));
    }
}
