//! Meshes whose leaves change, and the nodes that draw them.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use serde_json::Value;

use super::baked_instances::bake_instances;
use super::draft::Draft;
use super::instances::{Placement, place_instances};
use super::leaf_edits::{LeafEdits, Use, group_by_edits, uses_by_mesh};
use super::primitive::rewrite_primitive;
use super::references::as_index;
use super::single_leaf_mesh::{animated_and_joint_nodes, can_scale_node, only_leaf, scale_node};
use super::vertices::Resize;
use crate::error::Fault;
use crate::tree::Tree;

/// Gives every mesh with leaves, and every node that draws one, the leaves that
/// are left. Returns the meshes that nothing is left of.
pub(super) fn rewrite_meshes(
    draft: &mut Draft,
    tree: &Tree,
    edits: &LeafEdits,
) -> Result<BTreeSet<usize>, Fault> {
    let drawn_by = nodes_by_mesh(&draft.root);
    let moved_by_others = animated_and_joint_nodes(&tree.document.root);
    let mut empty = BTreeSet::new();
    for (mesh, uses) in uses_by_mesh(tree) {
        let is_changed = |place: &Use| place.parts.iter().any(|&part| edits.is_changed(part));
        if !uses.iter().any(is_changed) {
            continue;
        }
        let seen: HashSet<usize> = uses.iter().map(|place| place.node).collect();
        let is_drawn_elsewhere = drawn_by[&mesh].iter().any(|node| !seen.contains(node));
        let baked = nodes_that_come_apart(tree, edits, &uses, &moved_by_others)?;
        let (apart, uses): (Vec<Use>, Vec<Use>) = uses
            .into_iter()
            .partition(|place| baked.contains(&place.node));
        for node in baked {
            let places: Vec<&Use> = apart.iter().filter(|place| place.node == node).collect();
            bake_instances(draft, tree, edits, (node, mesh), &places)?;
        }
        let plan = plan_mesh(
            draft,
            tree,
            edits,
            mesh,
            &uses,
            is_drawn_elsewhere,
            &moved_by_others,
        )?;
        if plan.is_empty {
            empty.insert(mesh);
        }
        apply(draft, mesh, &uses, &plan.placements)?;
    }
    Ok(empty)
}

/// The nodes with instances that would draw more than one mesh from now on.
fn nodes_that_come_apart(
    tree: &Tree,
    edits: &LeafEdits,
    uses: &[Use],
    moved_by_others: &HashSet<usize>,
) -> Result<BTreeSet<usize>, Fault> {
    let mut of_nodes: BTreeMap<usize, Vec<&Use>> = BTreeMap::new();
    for place in uses.iter().filter(|place| place.instance.is_some()) {
        of_nodes.entry(place.node).or_default().push(place);
    }
    let mut apart = BTreeSet::new();
    for (node, places) in of_nodes {
        let mut draws_old = false;
        let mut changed = Vec::new();
        for &place in &places {
            let is_changed = place.parts.iter().any(|&part| edits.is_changed(part));
            if is_changed
                && single_leaf_resize(tree, edits, place, true, moved_by_others)?.is_none()
            {
                changed.push(place);
            } else {
                draws_old = true;
            }
        }
        let groups = group_by_edits(tree, edits, &changed);
        let shows = |group: &&Vec<usize>| shows_anything(tree, edits, changed[group[0]]);
        if groups.iter().filter(shows).count() + usize::from(draws_old) > 1 {
            apart.insert(node);
        }
    }
    Ok(apart)
}

/// Whether anything of a place's mesh is left.
fn shows_anything(tree: &Tree, edits: &LeafEdits, place: &Use) -> bool {
    let [first, ..] = place.parts[..] else {
        return true;
    };
    let mesh = &tree.document.root["meshes"][tree.parts[first].mesh];
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    let is_left = |&part: &usize| {
        edits.has_made(part) || edits.of_part(part).any(|edit| edit.area_scale.is_some())
    };
    primitives.is_some_and(|all| all.len() > place.parts.len()) || place.parts.iter().any(is_left)
}

fn nodes_by_mesh(root: &Value) -> HashMap<usize, Vec<usize>> {
    let mut drawn_by: HashMap<usize, Vec<usize>> = HashMap::new();
    let nodes = root.get("nodes").and_then(Value::as_array);
    for (number, node) in nodes.into_iter().flatten().enumerate() {
        if let Some(mesh) = node.get("mesh").and_then(as_index) {
            drawn_by.entry(mesh).or_default().push(number);
        }
    }
    drawn_by
}

/// What each place of a mesh draws from now on.
struct MeshPlan {
    placements: Vec<Placement>,
    /// Whether the mesh is not drawn any more and has nothing left in it.
    is_empty: bool,
}

fn plan_mesh(
    draft: &mut Draft,
    tree: &Tree,
    edits: &LeafEdits,
    mesh: usize,
    uses: &[Use],
    is_drawn_elsewhere: bool,
    moved_by_others: &HashSet<usize>,
) -> Result<MeshPlan, Fault> {
    let is_shared = uses.len() > 1 || is_drawn_elsewhere;
    let as_it_was = Placement {
        mesh: Some(mesh),
        resize: None,
    };
    let mut placements = vec![as_it_was; uses.len()];
    let mut is_mesh_kept = is_drawn_elsewhere;
    let mut changed = Vec::new();
    for (number, place) in uses.iter().enumerate() {
        if !place.parts.iter().any(|&part| edits.is_changed(part)) {
            is_mesh_kept = true;
        } else if let Some(resize) =
            single_leaf_resize(tree, edits, place, is_shared, moved_by_others)?
        {
            placements[number].resize = Some(resize);
            is_mesh_kept = true;
        } else {
            changed.push(number);
        }
    }

    let mut is_slot_free = !is_mesh_kept;
    let mut added = 0;
    let changed_uses: Vec<&Use> = changed.iter().map(|&number| &uses[number]).collect();
    for group in group_by_edits(tree, edits, &changed_uses) {
        let rewritten = rewrite_mesh(draft, tree, edits, mesh, changed_uses[group[0]])?;
        let number = match rewritten {
            None => None,
            Some(json) if is_slot_free => {
                is_slot_free = false;
                draft.root["meshes"][mesh] = json;
                Some(mesh)
            }
            Some(json) => {
                added += 1;
                Some(draft.push("meshes", json))
            }
        };
        for &member in &group {
            let [first, other] = [changed_uses[group[0]], changed_uses[member]];
            placements[changed[member]] = Placement {
                mesh: number,
                resize: edits.scale_beside(first, other),
            };
        }
    }
    if added > 0 {
        let place = draft.document.place("meshes", mesh);
        draft.notes.push(format!(
            "{place} was drawn in several places whose leaves differ now: {added} meshes were added for them"
        ));
    }
    Ok(MeshPlan {
        placements,
        is_empty: is_slot_free,
    })
}

/// How much a place grows as a whole, if its mesh is one leaf and the place can
/// be scaled without touching anything else.
fn single_leaf_resize(
    tree: &Tree,
    edits: &LeafEdits,
    place: &Use,
    is_shared: bool,
    moved_by_others: &HashSet<usize>,
) -> Result<Option<Resize>, Fault> {
    let is_free = match place.instance {
        Some(_) => true,
        None => is_shared && can_scale_node(&tree.document.root, moved_by_others, place.node),
    };
    if !is_free {
        return Ok(None);
    }
    only_leaf(tree, edits, place)
}

/// A mesh's JSON with the leaves of one of its places, or `None` if no
/// primitive is left.
fn rewrite_mesh(
    draft: &mut Draft,
    tree: &Tree,
    edits: &LeafEdits,
    mesh: usize,
    place: &Use,
) -> Result<Option<Value>, Fault> {
    let mut json = tree.document.root["meshes"][mesh].clone();
    let changed: HashMap<usize, usize> = place
        .parts
        .iter()
        .filter(|&&part| edits.is_changed(part))
        .map(|&part| (tree.parts[part].primitive, part))
        .collect();
    let Some(primitives) = json.get_mut("primitives").and_then(Value::as_array_mut) else {
        return Ok(Some(json));
    };
    let mut left = Vec::with_capacity(primitives.len());
    for (number, primitive) in primitives.drain(..).enumerate() {
        match changed.get(&number) {
            None => left.push(primitive),
            Some(&part) => left.extend(rewrite_primitive(draft, tree, edits, part)?),
        }
    }
    *primitives = left;
    Ok(Some(json).filter(|json| json["primitives"].as_array().is_some_and(|p| !p.is_empty())))
}

fn apply(
    draft: &mut Draft,
    mesh: usize,
    uses: &[Use],
    placements: &[Placement],
) -> Result<(), Fault> {
    let mut instances: BTreeMap<usize, Vec<(usize, Placement)>> = BTreeMap::new();
    for (place, placement) in uses.iter().zip(placements) {
        match (place.instance, placement.mesh, &placement.resize) {
            (Some(instance), _, _) => {
                let of_node = instances.entry(place.node).or_default();
                of_node.push((instance, placement.clone()));
            }
            (None, None, _) => draft.take_mesh_away(place.node),
            (None, Some(_), Some(resize)) => scale_node(draft, place.node, resize),
            (None, Some(new), None) if new != mesh => {
                draft.root["nodes"][place.node]["mesh"] = new.into();
            }
            (None, Some(_), None) => {}
        }
    }
    for (node, placements) in instances {
        place_instances(draft, node, mesh, &placements)?;
    }
    Ok(())
}
