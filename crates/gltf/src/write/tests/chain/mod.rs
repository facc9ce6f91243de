//! Chains of levels, in every layout: what they hold and how it is arranged.

mod attributes;
mod drawn_by_clients;
mod fixtures;
mod materials;
mod on_disk;
mod others;
mod placement;
mod sharing;
mod trees_of_others;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3};
use serde_json::{Map, Value, json};

use fixtures::{mirrored_rich, one_skin, still_morphs, two_skins};

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::{FLOAT, Fixture, UNSIGNED_BYTE, UNSIGNED_SHORT, read};
use super::fixture::{square_indices, squares};
use super::validator::assert_valid;
use crate::chain::{ChainFile, ChainFiles, ChainProblem, Layout, Level, LevelTexture};
use crate::error::Problem;
use crate::level_names::{of_unnamed_material, without_level};
use crate::{Detail, Document, Tree, WriteOptions};
use secateur_model::{
    AlphaMode, Filters, Finish, Foliage, LeafId, Lod, Material, Mips, NormalMap, Surface, Texture,
    Wrap,
};

const LAYOUTS: [Layout; 3] = [Layout::Files, Layout::Siblings, Layout::Msft];

/// The original, one leaf less and one larger, and the second leaf alone.
fn lods(tree: &Tree) -> [Lod; 3] {
    let mut last = Lod::original(tree.foliage.leaves().len());
    for index in (0..tree.foliage.leaves().len()).filter(|&index| index != 1) {
        last.remove(LeafId::from_index(index));
    }
    [
        Lod::original(tree.foliage.leaves().len()),
        one_gone_one_grown(tree),
        last,
    ]
}

fn facts(number: usize) -> Map<String, Value> {
    let coverage = [0.5, 0.2, 0.0][number];
    let facts = json!({"distance": 10 * number, "screen_coverage": coverage});
    facts.as_object().unwrap().clone()
}

fn levels(lods: &[Lod]) -> Vec<Level<'_>> {
    let level = |(number, lod)| Level::new("oak", number, lod, facts(number));
    lods.iter().enumerate().map(level).collect()
}

fn chain(tree: &Tree, layout: Layout) -> ChainFiles {
    tree.chain_to_bytes("oak", &levels(&lods(tree)), layout)
        .unwrap()
}

fn document(chain: &ChainFiles, file: usize) -> Document {
    let bytes = chain.files[file].bytes.clone();
    Document::from_bytes("chain.glb", bytes, None).unwrap()
}

fn node_named(root: &Value, name: &str) -> usize {
    let nodes = root["nodes"].as_array().unwrap();
    let mut found = (0..nodes.len()).filter(|&node| nodes[node]["name"] == name);
    let node = found.next().unwrap_or_else(|| panic!("no node {name}"));
    assert_eq!(found.next(), None, "one node {name}");
    node
}

/// Triangles of a node and all below it, every instance counted.
fn triangles_below(document: &Document, node: usize) -> u64 {
    let fields = &document.root["nodes"][node];
    let mut triangles = 0;
    if let Some(mesh) = fields.get("mesh") {
        let mesh = mesh.as_u64().unwrap() as usize;
        let primitives = document.root["meshes"][mesh]["primitives"]
            .as_array()
            .unwrap()
            .len();
        for primitive in 0..primitives {
            triangles += document.triangles(mesh, primitive).unwrap().len() as u64;
        }
        triangles *= document
            .instancing(node)
            .unwrap()
            .map_or(1, |i| i.count as u64);
    }
    let children = fields.get("children").and_then(Value::as_array);
    let children = children.into_iter().flatten();
    triangles
        + children
            .map(|child| triangles_below(document, child.as_u64().unwrap() as usize))
            .sum::<u64>()
}

/// Two foliages of the same leaves, in whatever order.
fn assert_same_leaves(found: &Foliage, expected: &Foliage, what: &str) {
    assert_eq!(
        found.leaves().len(),
        expected.leaves().len(),
        "{what}: leaves"
    );
    let of = |foliage: &Foliage| -> Vec<(DVec3, f64)> {
        let leaves = foliage.leaves().iter();
        leaves.map(|leaf| (leaf.centre(), leaf.area())).collect()
    };
    let found = of(found);
    for (centre, area) in of(expected) {
        let is_it = |other: &&(DVec3, f64)| {
            let size = area.sqrt() + 1e-3 * centre.abs().max_element();
            other.0.distance(centre) <= 1e-3 * size && (other.1 - area).abs() <= 1e-3 * area
        };
        assert!(
            found.iter().any(|leaf| is_it(&leaf)),
            "{what}: the leaf at {centre}"
        );
    }
}

#[test]
fn every_layout_of_every_encoding_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for (name, fixture) in all() {
        let tree = fixture.tree();
        let lods = lods(&tree);
        for layout in LAYOUTS {
            let what = format!("{name}, {layout:?}");
            eprintln!("{what}");
            let chain = chain(&tree, layout);
            assert_eq!(chain.triangles[0], tree.triangle_count(), "{what}");
            assert!(chain.triangles.is_sorted_by(|a, b| a > b), "{what}");
            let keeps_nodes = chain
                .notes
                .iter()
                .any(|note| note.contains("keep the node tree"));
            for (number, lod) in lods.iter().enumerate() {
                let file = if layout == Layout::Files { number } else { 0 };
                let document = document(&chain, file);
                let root = &document.root;
                let node = node_named(root, &format!("oak_LOD{number}"));
                let found = triangles_below(&document, node);
                assert_eq!(found, chain.triangles[number], "{what}: level {number}");
                let fields = &root["nodes"][node];
                assert_eq!(fields["extras"]["distance"], json!(10 * number), "{what}");
                for transform in ["matrix", "rotation", "scale"] {
                    assert_eq!(fields.get(transform), None, "{what}");
                }
                // Where a tree stands that has one root; of siblings their parent says it.
                let stands = tree.document.root["nodes"][0].get("translation");
                let stands = stands.filter(|_| layout != Layout::Siblings);
                let numbers = |at: &Value| -> Vec<Option<f64>> {
                    at.as_array().unwrap().iter().map(Value::as_f64).collect()
                };
                let found = fields.get("translation").map(numbers);
                assert_eq!(found, stands.map(numbers), "{what}");
                if !keeps_nodes {
                    let mesh = fields["mesh"].as_u64().unwrap() as usize;
                    assert_eq!(root["meshes"][mesh]["name"], fields["name"], "{what}");
                }
                assert_shared(&tree.document.root, root, &what);
                if layout == Layout::Files {
                    let level = read(chain.files[file].bytes.clone());
                    let expected = lod.foliage(&tree.foliage);
                    assert_same_leaves(&level.foliage, &expected, &what);
                    assert_eq!(
                        level.wood_triangle_count(),
                        tree.wood_triangle_count(),
                        "{what}"
                    );
                }
            }
            check_arrangement(&tree, &document(&chain, 0), layout, &what);
            files.extend(written(
                &chain,
                folder.path(),
                &format!("{name}-{layout:?}"),
            ));
        }
    }
    assert_valid(&files);
    // Of siblings the parent is above skinned meshes too; where it stands does not
    // count for them.
    let mut warnings = warnings(&files);
    warnings.retain(|code| code != "NODE_SKINNED_MESH_NON_ROOT");
    assert_eq!(warnings, [""; 0]);
}

/// The files of a chain, written into a folder, their names after `prefix`.
fn written(chain: &ChainFiles, folder: &Path, prefix: &str) -> Vec<PathBuf> {
    let write = |file: &ChainFile| {
        let path = folder.join(format!("{prefix}-{}", file.name));
        std::fs::write(&path, &file.bytes).unwrap();
        path
    };
    chain.files.iter().map(write).collect()
}

/// The codes of the validator's warnings; none where it is not installed.
fn warnings(files: &[PathBuf]) -> Vec<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/validator/validate.mjs");
    let output = Command::new("node").arg(script).args(files).output();
    let lines = output.map_or_else(|_| Vec::new(), |output| output.stdout);
    let lines = String::from_utf8(lines).unwrap();
    let mut codes = Vec::new();
    for line in lines.lines() {
        let report: Value = serde_json::from_str(line).unwrap();
        let messages = report["messages"].as_array().unwrap();
        codes.extend(
            messages
                .iter()
                .map(|m| m["code"].as_str().unwrap().to_owned()),
        );
    }
    codes
}

/// All encodings, and those that only a chain has trouble with.
fn all() -> Vec<(&'static str, Fixture)> {
    let mut all = encodings::all();
    all.extend([
        ("still-morphs", still_morphs()),
        ("one-skin", one_skin()),
        ("two-skins", two_skins()),
        ("mirrored-rich", mirrored_rich()),
    ]);
    all
}

/// A list of a file, with the names that its entries have in the plant.
fn named_as_in_plant(root: &Value, list: &str) -> Vec<Value> {
    let entries = root.get(list).and_then(Value::as_array);
    let mut entries = entries.cloned().unwrap_or_default();
    for (number, entry) in entries.iter_mut().enumerate() {
        let name = entry.get("name").and_then(Value::as_str);
        match name.map(|name| without_level(name).to_owned()) {
            Some(name) if name != of_unnamed_material(number) => entry["name"] = name.into(),
            Some(_) => drop(entry.as_object_mut().unwrap().remove("name")),
            None => {}
        }
    }
    entries
}

/// What the levels share is there once, as it was.
fn assert_shared(before: &Value, after: &Value, what: &str) {
    for list in ["materials", "textures", "samplers", "cameras"] {
        let [before, after] = [before, after].map(|root| named_as_in_plant(root, list));
        assert_eq!(before, after, "{what}: {list}");
    }
    for list in ["images", "skins", "animations"] {
        let count = |root: &Value| root.get(list).and_then(Value::as_array).map(Vec::len);
        assert_eq!(count(before), count(after), "{what}: {list}");
    }
}

fn check_arrangement(tree: &Tree, document: &Document, layout: Layout, what: &str) {
    let root = &document.root;
    let scene = root.get("scene").and_then(Value::as_u64).unwrap_or(0) as usize;
    let roots = root["scenes"][scene]["nodes"].as_array().unwrap();
    let names = |numbers: &[Value]| -> Vec<String> {
        let name = |n: &Value| root["nodes"][n.as_u64().unwrap() as usize]["name"].clone();
        numbers
            .iter()
            .map(|n| name(n).as_str().unwrap_or_default().to_owned())
            .collect()
    };
    let first = &root["nodes"][roots[0].as_u64().unwrap() as usize];
    match layout {
        Layout::Usd => panic!("{what}: layers of USD are no glTF"),
        Layout::Files => assert_eq!(first["name"], "oak_LOD0", "{what}"),
        Layout::Siblings => {
            assert_eq!(first["name"], "oak", "{what}");
            let children = names(first["children"].as_array().unwrap());
            assert_eq!(
                children[..3],
                ["oak_LOD0", "oak_LOD1", "oak_LOD2"],
                "{what}"
            );
        }
        Layout::Msft => {
            assert_eq!(first["name"], "oak_LOD0", "{what}");
            let ids = first["extensions"]["MSFT_lod"]["ids"].as_array().unwrap();
            assert_eq!(names(ids), ["oak_LOD1", "oak_LOD2"], "{what}");
            assert_eq!(
                first["extras"]["MSFT_screencoverage"],
                json!([0.5, 0.2, 0.0]),
                "{what}"
            );
            let used = root["extensionsUsed"].as_array().unwrap();
            assert!(used.iter().any(|name| name == "MSFT_lod"), "{what}");
            // Who does not know the extension sees the finest level only.
            let drawn = document.parts().unwrap();
            let triangles = |part: &crate::parts::Part| {
                document.triangles(part.mesh, part.primitive).unwrap().len() as u64
            };
            let drawn: u64 = drawn.iter().map(triangles).sum();
            assert_eq!(drawn, tree.triangle_count(), "{what}");
        }
    }
}

/// Every plant becomes a layer that has its levels' triangles and names all its textures.
#[test]
fn levels_as_usd_have_their_triangles() {
    for (name, fixture) in all() {
        let chain = chain(&fixture.tree(), Layout::Usd);
        assert_eq!(chain.files[0].name, "oak.usda", "{name}");
        let layer = std::str::from_utf8(&chain.files[0].bytes).unwrap();
        let mut triangles = Vec::new();
        for line in layer.lines().map(str::trim_start) {
            if line.starts_with("def Xform \"oak_LOD") {
                triangles.push(0);
            }
            if let Some(counts) = line.strip_prefix("int[] faceVertexCounts = [") {
                *triangles.last_mut().unwrap() += counts.split(',').count() as u64;
            }
        }
        assert_eq!(triangles, chain.triangles, "{name}");
        for texture in &chain.files[1..] {
            assert!(layer.contains(&format!("@./{}@", texture.name)), "{name}");
        }
        let bytes: u64 = chain.costs.iter().map(|cost| cost.bytes).sum();
        let all: usize = chain.files.iter().map(|file| file.bytes.len()).sum();
        assert!(bytes < all as u64, "{name}");
    }
}

#[test]
fn the_same_levels_give_the_same_bytes() {
    for (name, fixture) in all() {
        for layout in [&LAYOUTS[..], &[Layout::Usd]].concat() {
            let (one, other) = (
                chain(&fixture.tree(), layout),
                chain(&fixture.tree(), layout),
            );
            assert_eq!(one, other, "{name}");
        }
    }
}
