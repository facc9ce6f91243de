//! What must hold for every LOD, whatever the encoding.

use std::collections::HashMap;

use glam::DVec3;
use serde_json::Value;

use crate::Tree;
use crate::accessor::{Component, Elements};
use crate::parts::Part;
use crate::roles::Role;
use crate::write::grid::steps_per_unit;
use secateur_model::{LeafId, LeafTriangle, Lod};

/// Checks a LOD that was written and read back against the tree it is from:
/// the right leaves, where and as large as they must be, with all their
/// attributes; the wood and all other JSON as they were.
pub(super) fn check_lod(before: &Tree, lod: &Lod, after: &Tree) {
    assert_eq!(after.foliage.leaves().len(), lod.leaf_count(), "leaves");
    let (mut old_data, mut new_data) = (Reader::new(before), Reader::new(after));
    for (old, new) in match_leaves(before, lod, after) {
        check_leaf(before, old, lod.area_scale(old).unwrap(), after, new);
        let (old_data, new_data) = (
            old_data.corner_attributes(old),
            new_data.corner_attributes(new),
        );
        assert_eq!(old_data, new_data, "{old}: attributes");
    }
    check_wood(before, after);
    check_other_json(&before.document.root, &after.document.root);
}

/// Leaves that are left, and the same leaves of the LOD. Splitting instances may
/// change their order; then their centres tell.
fn match_leaves(before: &Tree, lod: &Lod, after: &Tree) -> Vec<(LeafId, LeafId)> {
    let left: Vec<LeafId> = lod.leaves().map(|(leaf, _)| leaf).collect();
    let new = (0..left.len()).map(LeafId::from_index);
    let in_order: Vec<(LeafId, LeafId)> = left.iter().copied().zip(new).collect();
    let distance = |&(old, new): &(LeafId, LeafId)| {
        let centre = before.foliage.leaf(old).centre();
        centre.distance(after.foliage.leaf(new).centre())
    };
    let size = |leaf| before.foliage.leaf(leaf).area().sqrt();
    if in_order
        .iter()
        .all(|pair| distance(pair) <= 1e-3 * size(pair.0))
    {
        return in_order;
    }
    let nearest = |old: LeafId| {
        let candidates = (0..left.len()).map(|index| (old, LeafId::from_index(index)));
        candidates
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap()
    };
    left.iter().copied().map(nearest).collect()
}

fn check_leaf(before: &Tree, old: LeafId, area_scale: f64, after: &Tree, new: LeafId) {
    let (old_leaf, new_leaf) = (before.foliage.leaf(old), after.foliage.leaf(new));
    let triangles = before.foliage.triangles_of(old);
    let found = after.foliage.triangles_of(new);
    assert_eq!(triangles.len(), found.len(), "{old}: triangles");
    let extent = extent(triangles);
    let grid = grid_error(before, old);
    let magnitude = extent + old_leaf.centre().abs().max_element();
    for (t, f) in triangles.iter().zip(found) {
        assert_eq!(t.uvs, f.uvs, "{old}: texture coordinates");
        if area_scale == 1.0 && is_float(before, old) {
            assert_eq!(t.corners, f.corners, "{old} must not move");
        }
        for (corner, is) in t.corners.iter().zip(f.corners) {
            let must = old_leaf.centre() + area_scale.sqrt() * (*corner - old_leaf.centre());
            let error = must.distance(is);
            let tolerance = 1e-6 * magnitude + grid;
            assert!(error <= tolerance, "{old}: {is} is not {must}");
        }
    }
    let area = area_scale * old_leaf.area();
    let error = (new_leaf.area() - area).abs();
    let rounding = 1e-5 * area + (4e-7 * magnitude + 2.0 * grid) * extent;
    assert!(
        error <= rounding,
        "{old}: area {} is not {area}",
        new_leaf.area()
    );
}

/// How far the grid of a leaf's positions may move them, in metres; 0 for f32.
pub(super) fn grid_error(tree: &Tree, leaf: LeafId) -> f64 {
    let part = &tree.parts[tree.leaf_sources[leaf.index()].part as usize];
    let position = tree
        .document
        .attribute(part.mesh, part.primitive, "POSITION");
    let accessor = tree.document.accessor(position.unwrap().unwrap()).unwrap();
    let columns = [0, 1, 2].map(|k| part.world_from_local.col(k).length());
    let longest = columns.into_iter().fold(0.0, f64::max);
    steps_per_unit(&accessor).map_or(0.0, |steps| 0.9 * longest / steps)
}

/// Integers beside a leaf that grows are rounded.
fn is_float(tree: &Tree, leaf: LeafId) -> bool {
    let part = &tree.parts[tree.leaf_sources[leaf.index()].part as usize];
    let position = tree
        .document
        .attribute(part.mesh, part.primitive, "POSITION");
    let accessor = tree.document.accessor(position.unwrap().unwrap()).unwrap();
    accessor.component == Component::F32
}

fn extent(triangles: &[LeafTriangle]) -> f64 {
    let corners = || triangles.iter().flat_map(|t| t.corners);
    let first = corners().next().unwrap();
    let far = |p: DVec3| p.distance(first);
    corners().map(far).fold(0.0, f64::max)
}

/// A tree's primitives, each read once.
struct Reader<'t> {
    tree: &'t Tree,
    triangles: HashMap<(usize, usize), Vec<[u32; 3]>>,
    elements: HashMap<usize, Elements<'t>>,
}

/// An attribute of the corners of a leaf: set (0 the primitive's own, then its
/// morph targets), semantic, component type, normalised, bytes.
type CornerAttribute = (usize, String, u32, bool, Vec<u8>);

impl<'t> Reader<'t> {
    fn new(tree: &'t Tree) -> Self {
        Self {
            tree,
            triangles: HashMap::new(),
            elements: HashMap::new(),
        }
    }

    fn elements(&mut self, accessor: usize) -> &Elements<'t> {
        let read = || self.tree.document.elements(accessor).unwrap();
        self.elements.entry(accessor).or_insert_with(read)
    }

    /// The attributes of a leaf's corners, without positions.
    fn corner_attributes(&mut self, leaf: LeafId) -> Vec<CornerAttribute> {
        let source = &self.tree.leaf_sources[leaf.index()];
        let part = &self.tree.parts[source.part as usize];
        let document = &self.tree.document;
        let triangles = self
            .triangles
            .entry((part.mesh, part.primitive))
            .or_insert_with(|| document.triangles(part.mesh, part.primitive).unwrap());
        let corners: Vec<u32> = self
            .tree
            .triangles_of(source)
            .iter()
            .flat_map(|&t| triangles[t as usize])
            .collect();
        let primitive = document.primitive(part.mesh, part.primitive).unwrap();
        let mut all = Vec::new();
        for (set, semantic, accessor) in attributes(primitive) {
            if semantic == "POSITION" {
                continue;
            }
            let elements = self.elements(accessor);
            let kind = elements.accessor;
            let bytes = bytes_of_corners(elements, &corners);
            all.push((set, semantic, kind.component.code(), kind.normalized, bytes));
        }
        all
    }
}

/// Set, semantic and accessor of every attribute of a primitive.
fn attributes(primitive: &Value) -> Vec<(usize, String, usize)> {
    let targets = primitive.get("targets").and_then(Value::as_array);
    let sets = std::iter::once(&primitive["attributes"]).chain(targets.into_iter().flatten());
    sets.enumerate()
        .flat_map(|(set, attributes)| {
            let fields = attributes.as_object().unwrap().iter();
            fields.map(move |(semantic, number)| {
                (set, semantic.clone(), number.as_u64().unwrap() as usize)
            })
        })
        .collect()
}

/// Wood keeps its transform and every attribute of every corner.
fn check_wood(before: &Tree, after: &Tree) {
    let wood = |tree: &'_ Tree| -> Vec<Part> {
        let parts = tree.parts.iter().filter(|part| part.role == Role::Wood);
        parts.cloned().collect()
    };
    let (old, new) = (wood(before), wood(after));
    assert_eq!(old.len(), new.len(), "wood");
    for (old, new) in old.iter().zip(&new) {
        assert_eq!(old.world_from_local, new.world_from_local);
        assert_eq!(wood_corners(before, old), wood_corners(after, new), "wood");
    }
}

fn wood_corners(tree: &Tree, part: &Part) -> Vec<CornerAttribute> {
    let document = &tree.document;
    let corners = document.triangles(part.mesh, part.primitive).unwrap();
    let primitive = document.primitive(part.mesh, part.primitive).unwrap();
    let of_corners = |(set, semantic, accessor): (usize, String, usize)| {
        let elements = document.elements(accessor).unwrap();
        let bytes = bytes_of_corners(&elements, corners.as_flattened());
        let kind = elements.accessor;
        (set, semantic, kind.component.code(), kind.normalized, bytes)
    };
    attributes(primitive).into_iter().map(of_corners).collect()
}

fn bytes_of_corners(elements: &Elements, corners: &[u32]) -> Vec<u8> {
    let size = elements.accessor.element_bytes();
    corners
        .iter()
        .flat_map(|&corner| &elements.bytes[corner as usize * size..][..size])
        .copied()
        .collect()
}

/// All JSON but what says where bytes are and which geometry a mesh has; that
/// is what the other checks look at.
fn check_other_json(before: &Value, after: &Value) {
    let names = before.as_object().unwrap().keys();
    for name in names {
        let (old, new) = (&before[name], after.get(name).unwrap_or(&Value::Null));
        match name.as_str() {
            "accessors" | "bufferViews" | "buffers" | "meshes" => {}
            "images" => assert_eq!(without_views(old), without_views(new)),
            // What became of the nodes of leaves is each test's own affair.
            "nodes" => check_nodes(old, new),
            "extensionsUsed" | "extensionsRequired" => {
                let expected: Vec<&Value> = old
                    .as_array()
                    .unwrap()
                    .iter()
                    .filter(|name| *name != COMPRESSION || has_compression(after))
                    .filter(|name| *name != INSTANCING || has_instances(after))
                    .collect();
                let found: Vec<&Value> = new.as_array().into_iter().flatten().collect();
                assert_eq!(expected, found, "{name}");
            }
            "asset" => assert_signed(old, new),
            _ => assert_eq!(old, new, "{name}"),
        }
    }
}

/// Who wrote a file is said in it, and who wrote the one that it was made of.
fn assert_signed(before: &Value, after: &Value) {
    let mut expected = before.clone();
    if let Some(tool) = before.get("generator") {
        if before.get("extras").is_none() {
            expected["extras"] = serde_json::json!({});
        }
        expected["extras"]["generator"] = tool.clone();
    }
    expected["generator"] = concat!("secateur ", env!("CARGO_PKG_VERSION")).into();
    assert_eq!(expected, *after, "asset");
}

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

const COMPRESSION: &str = "EXT_meshopt_compression";

/// Whether a view is compressed still: the smallest are not worth it.
fn has_compression(root: &Value) -> bool {
    let views = root["bufferViews"].as_array().unwrap();
    let compressed = |view: &Value| view["extensions"].get(COMPRESSION).is_some();
    views.iter().any(compressed)
}

/// Whether a node has instances still: those whose leaves differ are one mesh.
fn has_instances(root: &Value) -> bool {
    let nodes = root["nodes"].as_array().unwrap();
    nodes
        .iter()
        .any(|node| node["extensions"].get(INSTANCING).is_some())
}

fn without_views(images: &Value) -> Value {
    let mut images = images.clone();
    for image in images.as_array_mut().into_iter().flatten() {
        image.as_object_mut().unwrap().remove("bufferView");
    }
    images
}

fn check_nodes(before: &Value, after: &Value) {
    let (before, after) = (before.as_array().unwrap(), after.as_array().unwrap());
    for (old, new) in before.iter().zip(after) {
        for kept in ["name", "extras", "rotation", "camera", "matrix"] {
            if kept == "matrix" && old.get("extras").is_some_and(|e| e == "may be scaled") {
                continue;
            }
            assert_eq!(old.get(kept), new.get(kept), "{kept} of {old}");
        }
        let is_wood = old.get("name").is_some_and(|name| name != "leaves");
        if is_wood {
            assert_eq!(old, new);
        }
    }
}
