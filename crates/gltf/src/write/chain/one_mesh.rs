//! Levels of one mesh each, whose vertices are in the space of the scene, about the plant's pivot.

use std::collections::{BTreeSet, HashMap, HashSet};

use glam::{DMat4, DVec3};
use serde_json::{Map, Value, json};

use super::super::compact_vertices::compact;
use super::super::draft::{Draft, NewElements, Role};
use super::super::leaf_edits::LeafEdits;
use super::super::nodes::{take_away, unlink};
use super::super::primitive::rewrite_primitive;
use super::super::references::{as_index, items, knows_all_extensions};
use super::super::single_leaf_mesh::animated_and_joint_nodes;
use super::merged::{LevelPrimitive, merged};
use super::placement::placement;
use super::plan::OneMesh;
use super::scene::{LevelNodes, children, holds_any, scene_roots};
use super::vertices::Baker;
use super::{Level, LevelContent, mesh_levels, morph, others};
use crate::accessor::{Component, Shape};
use crate::error::Fault;
use crate::parts::Part;
use crate::roles;
use crate::tree::Tree;

/// Makes a mesh and a node of every level and takes away the nodes that drew the
/// tree, but for what they drew beside the plant, where that is wanted.
pub(super) fn build(
    draft: &mut Draft,
    tree: &Tree,
    levels: &[Level],
    plan: &OneMesh,
    with_others: bool,
) -> Result<LevelNodes, Fault> {
    let edits: Vec<Option<LeafEdits>> = levels
        .iter()
        .map(|level| match level.content {
            LevelContent::Tree(lod) => Some(LeafEdits::new(tree, lod)),
            LevelContent::Surface(_) => None,
        })
        .collect();
    let kept_extras = extras_of_nodes(&draft.root, tree, plan);
    let pivot = placement(tree);
    let mut meshes = Meshes {
        tree,
        plan,
        pivot,
        shrunk: lists_that_shrink(tree, &edits),
        baker: Baker::default(),
    };
    let of_levels = levels.iter().zip(&edits);
    let of_levels: Result<Vec<Option<Value>>, Fault> = of_levels
        .map(|(level, edits)| match edits {
            Some(edits) => meshes.mesh(draft, level, edits),
            None => Ok(None),
        })
        .collect();
    let of_levels = of_levels?;
    note_changes(draft, tree, plan, pivot, &meshes.baker);
    let mut nodes = Vec::new();
    for (level, mesh) in levels.iter().zip(of_levels) {
        nodes.push(match level.content {
            LevelContent::Surface(surface) => mesh_levels::push_node(draft, level, surface, pivot),
            LevelContent::Tree(_) => push_node(draft, level, mesh, plan.skin, &kept_extras),
        });
    }
    let joints = animated_and_joint_nodes(&draft.root);
    for &node in &plan.drawn {
        take_away(draft, node);
        if with_others {
            others::put_back(draft, tree, node)?;
        }
    }
    let roots = scene_roots(&draft.root);
    let needless = needless_nodes(&draft.root, &roots, &plan.drawn, &joints);
    let roots: Vec<usize> = roots
        .into_iter()
        .filter(|root| !needless.contains(root))
        .collect();
    unlink(draft, &needless);
    let has_joints = |&root: &usize| holds_any(&draft.root, root, &joints);
    let (with_tree, others) = roots.into_iter().partition(has_joints);
    Ok(LevelNodes {
        levels: nodes,
        with_tree,
        others,
        placement: pivot,
        needless,
    })
}

/// What the meshes of all levels are made by.
struct Meshes<'a> {
    tree: &'a Tree,
    plan: &'a OneMesh,
    pivot: DVec3,
    /// Accessors of positions of which every level loses some.
    shrunk: HashSet<usize>,
    baker: Baker,
}

impl Meshes<'_> {
    /// The mesh of a level; nothing if none of its parts is left.
    fn mesh(
        &mut self,
        draft: &mut Draft,
        level: &Level,
        edits: &LeafEdits,
    ) -> Result<Option<Value>, Fault> {
        let mut primitives = Vec::new();
        for number in 0..self.tree.parts.len() {
            primitives.extend(self.primitive(draft, level, edits, number)?);
        }
        let primitives = merged(draft, primitives)?;
        Ok(mesh_json(level, self.plan, primitives))
    }

    /// What is left of a part; nothing if it is gone.
    fn primitive(
        &mut self,
        draft: &mut Draft,
        level: &Level,
        edits: &LeafEdits,
        number: usize,
    ) -> Result<Option<LevelPrimitive>, Fault> {
        let part = &self.tree.parts[number];
        let document = &self.tree.document;
        let matrix = match self.plan.skin {
            Some(_) => DMat4::IDENTITY,
            None => pivot_from_local(self.pivot, part),
        };
        let mut primitive = document.primitive(part.mesh, part.primitive)?.clone();
        if edits.is_changed(number) {
            match rewrite_primitive(draft, self.tree, edits, number)? {
                Some(rewritten) => primitive = rewritten,
                None => return Ok(None),
            }
        } else if let Some(position) = position_of(&primitive)
            && (matrix != DMat4::IDENTITY || self.shrunk.contains(&position))
            && knows_all_extensions(&draft.root)
        {
            compact(draft, &mut primitive, position)?;
        }
        if let Some(morphs) = &self.plan.morphs {
            add_targets(draft, &mut primitive, morphs.count)?;
        }
        let place = document.primitive_place(part.mesh, part.primitive);
        self.baker.bake(draft, &mut primitive, matrix, &place)?;
        if let (Some(going), LevelContent::Tree(lod), None) =
            (level.morph, level.content, self.plan.skin)
        {
            let places = morph::places(self.tree, (lod, edits), number, going)?;
            morph::add(draft, &mut primitive, &places, self.pivot, matrix)?;
        }
        Ok(Some(LevelPrimitive {
            json: primitive,
            is_foliage: part.role == roles::Role::Leaf,
        }))
    }
}

/// Adds the node of a level with its mesh, if it has one.
fn push_node(
    draft: &mut Draft,
    level: &Level,
    mesh: Option<Value>,
    skin: Option<usize>,
    kept_extras: &[Value],
) -> usize {
    let mut node = json!({"name": level.name});
    if let Some(mesh) = mesh {
        node["mesh"] = draft.push("meshes", mesh).into();
        if let Some(skin) = skin {
            node["skin"] = skin.into();
        }
    }
    let mut extras = level.facts.clone();
    if !kept_extras.is_empty() {
        extras.insert("original_nodes".to_owned(), kept_extras.into());
    }
    if !extras.is_empty() {
        node["extras"] = extras.into();
    }
    draft.push("nodes", node)
}

/// From a part's own space to that of its level.
fn pivot_from_local(pivot: DVec3, part: &Part) -> DMat4 {
    match pivot == DVec3::ZERO {
        true => part.world_from_local,
        false => DMat4::from_translation(-pivot) * part.world_from_local,
    }
}

fn position_of(primitive: &Value) -> Option<usize> {
    primitive.pointer("/attributes/POSITION").and_then(as_index)
}

/// Accessors of positions of which every level loses some: what still shares
/// them needs lists of its own.
fn lists_that_shrink(tree: &Tree, edits: &[Option<LeafEdits>]) -> HashSet<usize> {
    let shrinks = |&number: &usize| {
        let mut of_trees = edits.iter().flatten();
        of_trees.all(|edits| edits.is_changed(number))
    };
    let position = |number: usize| {
        let part = &tree.parts[number];
        let primitive = tree.document.primitive(part.mesh, part.primitive).ok()?;
        position_of(primitive)
    };
    let parts = (0..tree.parts.len()).filter(shrinks);
    parts.filter_map(position).collect()
}

/// Gives a primitive without morph targets such that change nothing: all of a
/// mesh have as many.
fn add_targets(draft: &mut Draft, primitive: &mut Value, count: usize) -> Result<(), Fault> {
    let has = items(primitive, "targets").len();
    let Some(position) = position_of(primitive).filter(|_| has < count) else {
        return Ok(());
    };
    let zeros = NewElements {
        component: Component::F32,
        shape: Shape::Vector(3),
        normalized: false,
        count: draft.elements(position)?.accessor.count,
        bytes: None,
        bounded: true,
        role: Role::Vertex,
    };
    let still = json!({"POSITION": draft.push_accessor(None, zeros)});
    let mut targets: Vec<Value> = items(primitive, "targets").map(|t| t.clone()).collect();
    targets.resize(count, still);
    primitive["targets"] = targets.into();
    Ok(())
}

/// `None` for a level of which nothing is left.
fn mesh_json(level: &Level, plan: &OneMesh, primitives: Vec<Value>) -> Option<Value> {
    if primitives.is_empty() {
        return None;
    }
    let mut mesh = json!({"name": level.name, "primitives": primitives});
    let weights = plan.morphs.as_ref().and_then(|m| m.weights.clone());
    if let Some(weights) = weights {
        mesh["weights"] = weights;
    }
    if let Some(extras) = &plan.mesh_extras {
        mesh["extras"] = extras.clone();
    }
    Some(mesh)
}

/// What the nodes that go say in their extras: name, pivot in the scene, extras.
fn extras_of_nodes(root: &Value, tree: &Tree, plan: &OneMesh) -> Vec<Value> {
    let mut kept = Vec::new();
    let placed = tree.document.placed_nodes().into_iter().flatten();
    for placed in placed.filter(|placed| !tree.levels_inside.nodes.contains(&placed.index)) {
        let node = &root["nodes"][placed.index];
        let mesh = node.get("mesh").and_then(as_index);
        let mesh_extras = mesh.and_then(|mesh| root["meshes"][mesh].get("extras"));
        let mesh_extras = mesh_extras.filter(|_| plan.mesh_extras.is_none());
        if node.get("extras").is_none() && mesh_extras.is_none() {
            continue;
        }
        let mut entry = Map::new();
        for (name, value) in [
            ("name", node.get("name")),
            ("extras", node.get("extras")),
            ("mesh_extras", mesh_extras),
        ] {
            entry.extend(value.map(|value| (name.to_owned(), value.clone())));
        }
        let pivot = placed.world_from_node.w_axis.truncate().to_array();
        entry.insert("pivot".to_owned(), json!(pivot));
        kept.push(entry.into());
    }
    kept
}

fn note_changes(draft: &mut Draft, tree: &Tree, plan: &OneMesh, pivot: DVec3, baker: &Baker) {
    if plan.skin.is_none() {
        let mut moved: BTreeSet<usize> = BTreeSet::new();
        let mut drawn_by: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        for part in &tree.parts {
            if pivot_from_local(pivot, part) != DMat4::IDENTITY {
                moved.insert(part.node);
            }
            drawn_by.entry(part.mesh).or_default().insert(part.node);
        }
        if !moved.is_empty() {
            draft.notes.push(format!(
                "each level is one mesh: the transforms of {} nodes were put into the vertices",
                moved.len()
            ));
        }
        let shared = drawn_by.values().filter(|nodes| nodes.len() > 1).count();
        if shared > 0 {
            draft.notes.push(format!(
                "each level is one mesh: {shared} meshes that several nodes drew were written once for each of them"
            ));
        }
    }
    for place in &baker.became_f32 {
        draft.notes.push(format!(
            "{place}: its quantised positions became f32, because the transform of its node was put into them"
        ));
    }
}

/// The nodes below these roots that drew the tree, or held only such, and have
/// nothing else to do.
pub(super) fn needless_nodes(
    root: &Value,
    roots: &[usize],
    drawn: &[usize],
    joints: &HashSet<usize>,
) -> BTreeSet<usize> {
    let drawn: HashSet<usize> = drawn.iter().copied().collect();
    let mut needless = BTreeSet::new();
    // Children after their parents; so backwards.
    let mut order: Vec<usize> = roots.to_vec();
    let mut next = 0;
    while next < order.len() {
        order.extend(children(root, order[next]));
        next += 1;
    }
    for &node in order.iter().rev() {
        let fields = &root["nodes"][node];
        let is_empty = ["mesh", "camera", "extensions"]
            .iter()
            .all(|name| fields.get(name).is_none());
        let children = children(root, node);
        let holds_nothing = children.iter().all(|child| needless.contains(child));
        let was_needed = drawn.contains(&node) || !children.is_empty();
        if is_empty && holds_nothing && was_needed && !joints.contains(&node) {
            needless.insert(node);
        }
    }
    needless
}
