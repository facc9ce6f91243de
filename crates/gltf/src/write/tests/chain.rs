//! Chains of levels, in every layout.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3};
use serde_json::{Map, Value, json};

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::{FLOAT, Fixture, UNSIGNED_BYTE, UNSIGNED_SHORT, read};
use super::fixture::{square_indices, squares};
use super::validator::assert_valid;
use crate::chain::{ChainFiles, ChainProblem, Layout, Level, LevelTexture};
use crate::error::Problem;
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
                for transform in ["matrix", "translation", "rotation", "scale"] {
                    assert_eq!(fields.get(transform), None, "{what}");
                }
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
            for file in &chain.files {
                let path = folder
                    .path()
                    .join(format!("{name}-{layout:?}-{}", file.name));
                std::fs::write(&path, &file.bytes).unwrap();
                files.push(path);
            }
        }
    }
    assert_valid(&files);
    // Of siblings the parent is above skinned meshes too; where it stands does not
    // count for them.
    let mut warnings = warnings(&files);
    warnings.retain(|code| code != "NODE_SKINNED_MESH_NON_ROOT");
    assert_eq!(warnings, [""; 0]);
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

/// What the levels share is there once, as it was.
fn assert_shared(before: &Value, after: &Value, what: &str) {
    for list in ["materials", "textures", "samplers", "cameras"] {
        assert_eq!(before.get(list), after.get(list), "{what}: {list}");
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

#[test]
fn the_same_levels_give_the_same_bytes() {
    for (name, fixture) in all() {
        for layout in LAYOUTS {
            let (one, other) = (
                chain(&fixture.tree(), layout),
                chain(&fixture.tree(), layout),
            );
            assert_eq!(one, other, "{name}");
        }
    }
}

/// Every attribute, below a node that mirrors, turns and stretches.
fn mirrored_rich() -> Fixture {
    let mut fixture = Fixture::new();
    let normal = [0.0, 0.0, 1.0];
    let mut positions = squares(4);
    positions.iter_mut().for_each(|p| p[2] = 0.0);
    let attributes = json!({
        "POSITION": fixture.vectors(&positions),
        "NORMAL": fixture.vectors(&[normal; 16]),
        "TANGENT": fixture.vectors(&[[1.0, 0.0, 0.0, 1.0]; 16]),
        "TEXCOORD_0": fixture.vectors(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(4)),
    });
    let targets = json!([{
        "POSITION": fixture.vectors(&[[1.0, 2.0, 3.0]; 16]),
        "NORMAL": fixture.vectors(&[[0.5, 0.0, 0.0]; 16]),
        "TANGENT": fixture.vectors(&[[0.0, 0.0, 0.5]; 16]),
    }]);
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let mut fixture = fixture.with_leaves(attributes, Some(indices));
    fixture.leaf_primitive()["targets"] = targets;
    fixture.root["nodes"][2]["scale"] = json!([-2, 1, 4]);
    fixture.root["nodes"][0]["rotation"] = json!([0.6, 0, 0, 0.8]);
    fixture.root["nodes"][0]["translation"] = json!([1, 2, 3]);
    fixture
}

#[test]
fn a_mirror_turns_triangles_normals_tangents_and_morphs() {
    let fixture = mirrored_rich();
    let tree = fixture.tree();
    let chain = chain(&tree, Layout::Files);
    let level = document(&chain, 0);
    let foliage = tree.parts.iter().find(|part| part.is_foliage).unwrap();
    let world_from_local: DMat4 = foliage.world_from_local;
    // The leaves are made of material 1, the bark of material 0.
    let primitives = level.root["meshes"][0]["primitives"].as_array().unwrap();
    let leaves = primitives.iter().position(|p| p["material"] == 1).unwrap();
    let number = |set: &Value, name: &str| set[name].as_u64().unwrap() as usize;
    let vectors = |number: usize| -> Vec<DVec3> {
        let elements = level.elements(number).unwrap();
        elements.vectors::<3>().map(DVec3::from_array).collect()
    };
    let attributes = &primitives[leaves]["attributes"];
    let positions = vectors(number(attributes, "POSITION"));
    let normals = vectors(number(attributes, "NORMAL"));
    let tangents = level.elements(number(attributes, "TANGENT")).unwrap();
    let old = tree.document.positions(1, 0).unwrap();
    for (old, new) in old.iter().zip(&positions) {
        assert!(world_from_local.transform_point3(*old).distance(*new) < 1e-5);
    }
    for corners in level.triangles(0, leaves).unwrap() {
        let [a, b, c] = corners.map(|corner| positions[corner as usize]);
        let outwards = (b - a).cross(c - a).normalize();
        let normal = normals[corners[0] as usize];
        assert!(
            outwards.distance(normal) < 1e-5,
            "{outwards} is not {normal}"
        );
    }
    let along = world_from_local.transform_vector3(DVec3::X).normalize();
    let side = world_from_local.transform_vector3(DVec3::Y).normalize();
    for ([x, y, z, w], normal) in tangents.vectors::<4>().zip(&normals) {
        let tangent = DVec3::new(x, y, z);
        assert!(tangent.distance(along) < 1e-5);
        let bitangent = normal.cross(tangent) * w;
        assert!(bitangent.distance(side) < 1e-5, "{bitangent} is not {side}");
    }
    let target = &primitives[leaves]["targets"][0];
    let moves = vectors(number(target, "POSITION"));
    let moved = world_from_local.transform_vector3(DVec3::new(1.0, 2.0, 3.0));
    assert!(moves.iter().all(|found| found.distance(moved) < 1e-5));
    // A morphed normal is that of the morphed original, but for its length.
    let of_normals = glam::DMat3::from_mat4(world_from_local)
        .inverse()
        .transpose();
    let expected = (of_normals * DVec3::new(0.5, 0.0, 1.0)).normalize();
    let changes = vectors(number(target, "NORMAL"));
    for (normal, change) in normals.iter().zip(&changes) {
        assert!((*normal + *change).normalize().distance(expected) < 1e-5);
    }
    let expected = world_from_local
        .transform_vector3(DVec3::new(1.0, 0.0, 0.5))
        .normalize();
    for change in vectors(number(target, "TANGENT")) {
        assert!((along + change).normalize().distance(expected) < 1e-5);
    }
    // The bark has no morph targets of its own, and must have as many.
    let bark = &primitives[1 - leaves];
    assert_eq!(bark["targets"].as_array().unwrap().len(), 1);
    let still = level
        .elements(number(&bark["targets"][0], "POSITION"))
        .unwrap();
    assert!(still.vectors::<3>().all(|moved| moved == [0.0; 3]));
}

/// Morph targets that no animation moves.
fn still_morphs() -> Fixture {
    let mut fixture = encodings::morphed();
    fixture.root.as_object_mut().unwrap().remove("animations");
    fixture.root["meshes"][1]["weights"] = json!([0.25, 0.5]);
    fixture.root["meshes"][1]["extras"] = json!({"targetNames": ["wind", "snow"]});
    fixture
}

#[test]
fn weights_and_names_of_morph_targets_stay() {
    for file in 0..3 {
        let level = document(&chain(&still_morphs().tree(), Layout::Files), file);
        let mesh = &level.root["meshes"][0];
        assert_eq!(mesh["weights"], json!([0.25, 0.5]));
        assert_eq!(mesh["extras"], json!({"targetNames": ["wind", "snow"]}));
    }
}

fn with_skin(fixture: &mut Fixture, mesh: usize, vertices: usize) {
    let joints = fixture.elements(UNSIGNED_BYTE, 4, &vec![0.0; 4 * vertices]);
    let weights = fixture.vectors(&vec![[1.0, 0.0, 0.0, 0.0]; vertices]);
    let attributes = &mut fixture.root["meshes"][mesh]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
}

/// A trunk and leaves of one skin, whose nodes have transforms that do not count.
fn one_skin() -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(4));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    with_skin(&mut fixture, 0, 4);
    with_skin(&mut fixture, 1, 16);
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "joint", "translation": [0, 1, 0], "extras": {"sway": 2}}));
    nodes[0]["children"] = json!([1, 2, 3]);
    nodes[1]["skin"] = 0.into();
    nodes[2]["skin"] = 0.into();
    fixture.root["skins"] = json!([{"joints": [3]}]);
    fixture
}

fn two_skins() -> Fixture {
    let mut fixture = one_skin();
    fixture.root["skins"] = json!([{"joints": [3]}, {"joints": [3]}]);
    fixture.root["nodes"][2]["skin"] = 1.into();
    fixture
}

#[test]
fn a_skin_stays_and_its_vertices_do_not_move() {
    let fixture = one_skin();
    let tree = fixture.tree();
    for layout in LAYOUTS {
        let level = document(&chain(&tree, layout), 0);
        let root = &level.root;
        let joint = node_named(root, "joint");
        assert_eq!(root["skins"], json!([{ "joints": [joint] }]));
        assert_eq!(root["nodes"][joint]["translation"], json!([0, 1, 0]));
        assert_eq!(root["nodes"][node_named(root, "oak_LOD0")]["skin"], 0);
        let placed = level.placed_nodes().unwrap();
        assert!(
            placed.iter().any(|node| node.index == joint),
            "in the scene"
        );
        let positions = level.positions(0, 1).unwrap();
        assert_eq!(positions, tree.document.positions(1, 0).unwrap());
        for primitive in root["meshes"][0]["primitives"].as_array().unwrap() {
            assert!(primitive["attributes"].get("WEIGHTS_0").is_some());
        }
    }
}

#[test]
fn what_cannot_be_one_mesh_keeps_its_nodes() {
    let expected = [
        ("two skins", two_skins(), "several skins"),
        ("some skinned", skinned_leaves(), "some are not"),
        ("instances", encodings::instanced_twig(), "is instanced"),
        (
            "animation",
            encodings::morphed(),
            "an animation or a skeleton",
        ),
    ];
    for (name, fixture, why) in expected {
        let tree = fixture.tree();
        for layout in LAYOUTS {
            let chain = chain(&tree, layout);
            let says = |note: &String| note.contains("keep the node tree") && note.contains(why);
            assert!(chain.notes.iter().any(says), "{name}: {:?}", chain.notes);
        }
    }
}

fn skinned_leaves() -> Fixture {
    let all = encodings::all();
    all.into_iter()
        .find(|(name, _)| *name == "skinned")
        .unwrap()
        .1
}

#[test]
fn animations_move_the_copies_too() {
    let chain = chain(&encodings::morphed().tree(), Layout::Siblings);
    let root = document(&chain, 0).root;
    let channels = root["animations"][0]["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 3);
    let mut meshes = Vec::new();
    for channel in channels {
        assert_eq!(channel["target"]["path"], "weights");
        let node = channel["target"]["node"].as_u64().unwrap() as usize;
        meshes.push(root["nodes"][node]["mesh"].clone());
    }
    meshes.dedup();
    assert_eq!(meshes.len(), 3, "each level has a mesh of its own");
}

#[test]
fn what_looks_alike_is_one_primitive() {
    let fixture = encodings::shared_twig();
    let tree = fixture.tree();
    assert!(tree.parts.len() > 2);
    let level = document(&chain(&tree, Layout::Files), 0);
    let primitives = level.root["meshes"][0]["primitives"].as_array().unwrap();
    assert_eq!(primitives.len(), 2, "wood and leaves");
}

#[test]
fn levels_share_what_they_have_in_common() {
    let bark = |root: &Value, level: usize| {
        let node = node_named(root, &format!("oak_LOD{level}"));
        let mesh = root["nodes"][node]["mesh"].as_u64().unwrap() as usize;
        let primitives = root["meshes"][mesh]["primitives"].as_array().unwrap();
        let bark = primitives.iter().find(|p| p["material"] == 0);
        bark.unwrap().clone()
    };
    let fixture = encodings::textured();
    let root = document(&chain(&fixture.tree(), Layout::Siblings), 0).root;
    assert_eq!(bark(&root, 0), fixture.root["meshes"][0]["primitives"][0]);
    assert_eq!(root["images"].as_array().unwrap().len(), 1);

    // Bark whose vertices are moved, and parted from those of the leaves.
    let mut moved = encodings::shared_accessor();
    moved.root["nodes"][0]["scale"] = json!([2, 2, 2]);
    let moved = document(&chain(&moved.tree(), Layout::Siblings), 0).root;
    for root in [root, moved] {
        assert_eq!(bark(&root, 0), bark(&root, 1));
        assert_eq!(bark(&root, 0), bark(&root, 2));
    }
}

#[test]
fn extras_of_nodes_and_meshes_go_along() {
    let mut fixture = encodings::textured();
    fixture.root["nodes"][2]["extras"] = json!({"pivots": [1, 2]});
    fixture.root["nodes"][2]["translation"] = json!([0, 7, 0]);
    fixture.root["meshes"][0]["extras"] = json!({"kind": "bark"});
    fixture.root["meshes"][1]["extras"] = json!({"kind": "leaf"});
    for file in 0..3 {
        let root = document(&chain(&fixture.tree(), Layout::Files), file).root;
        let extras = &root["nodes"][node_named(&root, &format!("oak_LOD{file}"))]["extras"];
        let expected = json!([
            {"name": "trunk", "mesh_extras": {"kind": "bark"}, "pivot": [0.0, 0.0, 0.0]},
            {"name": "leaves", "extras": {"pivots": [1, 2]}, "mesh_extras": {"kind": "leaf"},
             "pivot": [0.0, 7.0, 0.0]},
        ]);
        assert_eq!(extras["original_nodes"], expected);
    }
}

#[test]
fn other_nodes_of_the_scene_stay() {
    let mut fixture = encodings::textured();
    fixture.root["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.extend([
        json!({"name": "eye", "camera": 0}),
        json!({"name": "bird's nest", "translation": [1, 2, 3]}),
    ]);
    nodes[0]["children"] = json!([1, 2, 4]);
    fixture.root["scenes"][0]["nodes"] = json!([0, 3]);
    for layout in LAYOUTS {
        let root = document(&chain(&fixture.tree(), layout), 0).root;
        let tree = node_named(&root, "tree");
        assert_eq!(
            root["nodes"][tree]["children"],
            json!([node_named(&root, "bird's nest")])
        );
        node_named(&root, "eye");
        let roots = root["scenes"][0]["nodes"].as_array().unwrap();
        assert_eq!(roots.len(), 3, "the level or its parent, the tree, the eye");
    }
}

#[test]
fn an_integer_position_says_that_it_became_a_float() {
    let mut fixture = encodings::quantised_normalised();
    fixture.root["nodes"][2]["scale"] = json!([2, 2, 2]);
    let chain = chain(&fixture.tree(), Layout::Siblings);
    let says = |note: &String| note.contains("quantised positions became f32");
    assert!(chain.notes.iter().any(says), "{:?}", chain.notes);
    let root = document(&chain, 0).root;
    let mesh = &root["meshes"][0];
    let leaves = mesh["primitives"].as_array().unwrap();
    let leaves = leaves.iter().find(|p| p["material"] == 1).unwrap();
    let position = leaves["attributes"]["POSITION"].as_u64().unwrap() as usize;
    assert_eq!(root["accessors"][position]["componentType"], FLOAT);
}

#[test]
fn levels_that_are_no_chain_are_refused() {
    let tree = encodings::textured().tree();
    let lods = lods(&tree);
    let refused = |change: &dyn Fn(&mut Vec<Level>), layout: Layout| -> ChainProblem {
        let mut levels = levels(&lods);
        change(&mut levels);
        let error = tree.chain_to_bytes("oak", &levels, layout).unwrap_err();
        match error.problem() {
            Problem::Chain(problem) => problem.clone(),
            other => panic!("{other}"),
        }
    };
    let files = Layout::Files;
    assert_eq!(
        refused(&|levels| levels.clear(), files),
        ChainProblem::Levels(0)
    );
    let many = |levels: &mut Vec<Level>| *levels = vec![levels[0].clone(); 9];
    assert_eq!(refused(&many, files), ChainProblem::Levels(9));
    for name in ["", "../oak", "a\\b", "a\n", ".hidden"] {
        let rename = |levels: &mut Vec<Level>| levels[1].name = name.to_owned();
        assert_eq!(refused(&rename, files), ChainProblem::Name(name.to_owned()));
    }
    let same = |levels: &mut Vec<Level>| levels[1].name = "oak_LOD0".to_owned();
    assert_eq!(
        refused(&same, files),
        ChainProblem::SameName("oak_LOD0".to_owned())
    );
    for wrong in [
        json!(0.5),
        json!(0.7),
        json!(-1),
        json!("a lot"),
        Value::Null,
    ] {
        let cover = |levels: &mut Vec<Level>| {
            levels[1]
                .facts
                .insert("screen_coverage".to_owned(), wrong.clone());
        };
        let problem = refused(&cover, Layout::Msft);
        assert_eq!(problem, ChainProblem::Coverage("oak_LOD1".to_owned()));
    }
}

#[test]
fn a_chain_goes_to_disk_with_its_images() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (folder.path().join("from"), folder.path().join("to"));
    std::fs::create_dir(&from).unwrap();
    std::fs::create_dir(&to).unwrap();
    let mut fixture = encodings::textured();
    fixture.root["images"] = json!([{"uri": "leaf.png"}]);
    let input = from.join("oak.glb");
    std::fs::write(&input, fixture.glb()).unwrap();
    std::fs::write(from.join("leaf.png"), encodings::one_texel_png()).unwrap();
    let tree = Tree::open(&input, &["material:leaf".parse().unwrap()]).unwrap();
    let lods = lods(&tree);

    let written = tree
        .write_chain("oak", &levels(&lods), Layout::Files, &to)
        .unwrap();
    let names = ["oak_LOD0.glb", "oak_LOD1.glb", "oak_LOD2.glb", "leaf.png"];
    assert_eq!(written.files, names.map(|name| to.join(name)));
    assert_eq!(written.triangles, chain(&tree, Layout::Files).triangles);
    let bytes: u64 = written
        .files
        .iter()
        .map(|f| f.metadata().unwrap().len())
        .sum();
    assert_eq!(written.bytes, bytes);

    for (name, layout) in [("s.glb", Layout::Siblings), ("m.gltf", Layout::Msft)] {
        let path = to.join(name);
        let written = tree
            .write_chain("oak", &levels(&lods), layout, &path)
            .unwrap();
        assert_eq!(written.files[0], path);
        let read = Document::open(&path).unwrap();
        let level = node_named(&read.root, "oak_LOD2");
        assert_eq!(triangles_below(&read, level), written.triangles[2]);
    }
    let glb = std::fs::read(to.join("s.glb")).unwrap();
    assert_eq!(glb, chain(&tree, Layout::Siblings).files[0].bytes);
    assert_valid(&[to.join("oak_LOD0.glb"), to.join("s.glb"), to.join("m.gltf")]);

    let over_input = tree.write_chain("oak", &levels(&lods), Layout::Msft, &input);
    assert!(
        over_input
            .unwrap_err()
            .to_string()
            .contains("the input is made of")
    );
}

/// A folder is where the third level should go: no other level appears, nor the
/// folder of the chain if it was made for it.
#[test]
fn a_chain_of_files_is_all_there_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.glb");
    std::fs::write(&input, encodings::textured().glb()).unwrap();
    let tree = Tree::open(&input, &["material:leaf".parse().unwrap()]).unwrap();
    let lods = lods(&tree);
    let levels = levels(&lods);
    let names = |folder: &Path| {
        let files = std::fs::read_dir(folder).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let to = folder.path().join("chain");
    let third = to.join("oak_LOD2.glb");
    let overwrite = WriteOptions::default().overwrite(true);
    let prepare = |options| tree.prepare_chain("oak", &levels, Layout::Files, &to, options);

    std::fs::create_dir_all(&third).unwrap();
    assert!(prepare(overwrite).is_err());
    assert_eq!(names(&to), ["oak_LOD2.glb"]);
    std::fs::remove_dir(&third).unwrap();

    std::fs::write(&third, "mine").unwrap();
    let error = prepare(WriteOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("LOD2") && error.contains("already"),
        "{error}"
    );
    assert_eq!(names(&to), ["oak_LOD2.glb"]);
    assert_eq!(std::fs::read(&third).unwrap(), b"mine");
    prepare(overwrite).unwrap().commit().unwrap();
    assert_eq!(names(&to), ["oak_LOD0.glb", "oak_LOD1.glb", "oak_LOD2.glb"]);

    std::fs::remove_dir_all(&to).unwrap();
    drop(prepare(overwrite).unwrap());
    assert_eq!(names(folder.path()), ["in.glb"]);
}

/// A picture of two colours on a quad of its own, with a hole at the upper left and a normal map.
fn picture() -> Surface {
    let texture = |rgba: Vec<u8>| {
        Arc::new(Texture {
            width: 2,
            height: 2,
            rgba,
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters::default(),
        })
    };
    let [green, brown] = [[60, 140, 40, 255], [120, 80, 40, 255]];
    let hole = [60, 140, 40, 0];
    let map = NormalMap {
        texture: texture([128, 128, 255, 255].repeat(4)),
        scale: 1.0,
    };
    Surface {
        positions: [[0.0, 7.0], [0.0, 0.0], [8.0, 0.0], [8.0, 7.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.5))
            .into(),
        normals: vec![Vec3::Z; 4],
        uvs: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
            .map(Vec2::from_array)
            .into(),
        colors: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Arc::new(Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: Some(texture([hole, green, brown, green].concat())),
            alpha_mode: AlphaMode::Mask(0.5),
            double_sided: true,
            finish: Finish {
                normal_map: Some(map),
                ..Finish::default()
            },
        }),
    }
}

#[test]
fn a_picture_is_the_last_level_in_every_layout() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture();
    let mut files = Vec::new();
    for (name, fixture) in all() {
        let tree = fixture.tree();
        let lods = lods(&tree);
        for layout in LAYOUTS {
            let what = format!("{name}, {layout:?}");
            let mut levels = levels(&lods[..2]);
            levels.push(Level::of_surface("oak", 2, &picture, facts(2)));
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            assert_eq!(chain.triangles[2], 2, "{what}");
            let is_alone = layout == Layout::Files;
            let last = document(&chain, if is_alone { 2 } else { 0 });
            let node = node_named(&last.root, "oak_LOD2");
            assert_eq!(triangles_below(&last, node), 2, "{what}");
            assert_eq!(last.root["nodes"][node]["extras"]["distance"], 20, "{what}");
            let mesh = last.root["nodes"][node]["mesh"].as_u64().unwrap() as usize;
            let primitive = &last.root["meshes"][mesh]["primitives"][0];
            // Along u is along x; the top of the picture is up.
            let tangents = primitive["attributes"]["TANGENT"].as_u64().unwrap();
            let tangents = last.elements(tangents as usize).unwrap();
            let tangents: Vec<[f64; 4]> = tangents.vectors::<4>().collect();
            assert_eq!(tangents, [[1.0, 0.0, 0.0, 1.0]; 4], "{what}");
            let material = primitive["material"].as_u64().unwrap() as usize;
            let material = &last.root["materials"][material];
            assert_eq!(material["alphaMode"], "MASK", "{what}");
            assert_eq!(material["doubleSided"], true, "{what}");
            if is_alone {
                let count = |list: &str| last.root[list].as_array().map_or(0, Vec::len);
                let counts = ["nodes", "meshes", "materials", "textures", "images"].map(count);
                assert_eq!(counts, [1, 1, 1, 2, 2], "{what}: nothing of the tree");
            }
            for file in &chain.files {
                let path = folder
                    .path()
                    .join(format!("{name}-{layout:?}-{}", file.name));
                std::fs::write(&path, &file.bytes).unwrap();
                files.push(path);
            }
        }
    }
    assert_valid(&files);
    let mut warnings = warnings(&files);
    warnings.retain(|code| code != "NODE_SKINNED_MESH_NON_ROOT");
    assert_eq!(warnings, [""; 0]);
}

/// A texture of 2 x 2 texels of this colour, with a sampler of its own.
fn own_texture(color: [u8; 4], mips: Mips) -> LevelTexture {
    LevelTexture {
        material: 1,
        texture: Arc::new(Texture {
            width: 2,
            height: 2,
            rgba: color.repeat(4),
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters {
                mips,
                ..Filters::default()
            },
        }),
    }
}

/// The material of the leaves of a level.
fn leaf_material(document: &Document, level: usize) -> usize {
    let node = node_named(&document.root, &format!("oak_LOD{level}"));
    let mesh = document.root["nodes"][node]["mesh"].as_u64().unwrap();
    let primitives = document.root["meshes"][mesh as usize]["primitives"].as_array();
    let last = primitives.unwrap().last().unwrap();
    last["material"].as_u64().unwrap() as usize
}

/// Leaf textures differ by level; what nobody needs any more is gone, and all else of the material
/// is as it was.
#[test]
fn levels_have_textures_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let tree = encodings::textured().tree();
    let lods = lods(&tree);
    let own = [
        vec![],
        vec![own_texture([10, 200, 30, 255], Mips::None)],
        vec![own_texture([90, 80, 10, 128], Mips::Blended)],
    ];
    let original = &tree.document.root["materials"][1];
    for layout in LAYOUTS {
        for is_all in [false, true] {
            let what = format!("{layout:?}, all {is_all}");
            let mut levels = levels(&lods);
            for (number, level) in levels.iter_mut().enumerate() {
                level.textures = &own[if is_all { number.max(1) } else { number }];
            }
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            let mut images = 0;
            for (number, level) in levels.iter().enumerate() {
                let file = if layout == Layout::Files { number } else { 0 };
                let document = document(&chain, file);
                let number = leaf_material(&document, number);
                let drawn = document.drawn(Detail::Color, &[]).unwrap();
                let leaf = drawn.iter().find(|d| d.material == Some(number));
                // With MSFT_lod only the finest level is in the scene.
                assert!(leaf.is_some() || layout == Layout::Msft, "{what}");
                let shown = leaf.and_then(|leaf| leaf.surface.material.texture.as_ref());
                if let (Some(shown), [own]) = (shown, level.textures) {
                    assert_eq!(**shown, *own.texture, "{what}");
                }
                let mut material = document.root["materials"][number].clone();
                let index = &mut material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
                *index = 0.into();
                assert_eq!(material, *original, "{what}");
                images = document.root["images"].as_array().unwrap().len();
                if layout == Layout::Files {
                    assert_eq!(images, 1, "{what}");
                }
                let of_material = document.images_of_material(number);
                let found = (of_material[0].size, of_material[0].has_mips);
                let expected = match level.textures {
                    [own] => ([2, 2], own.texture.filters.mips != Mips::None),
                    _ => ([1, 1], true),
                };
                assert_eq!(found, expected, "{what}");
                assert!(of_material[0].is_base_color && of_material.len() == 1);
            }
            if layout != Layout::Files {
                // The one of the tree is replaced where no level keeps it; equal ones are not shared.
                assert_eq!(images, 3, "{what}");
            }
            for file in &chain.files {
                let path = folder
                    .path()
                    .join(format!("{layout:?}-{is_all}-{}", file.name));
                std::fs::write(&path, &file.bytes).unwrap();
                files.push(path);
            }
        }
    }
    assert_valid(&files);
    assert_eq!(warnings(&files), [""; 0]);
}

#[test]
fn real_trees_make_chains() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for path in super::real_trees::trees() {
        let tree = Document::open(&path).unwrap().into_tree(&[]).unwrap();
        let count = tree.foliage.leaves().len();
        let mut lods = vec![Lod::original(count); 3];
        for index in 0..count {
            let leaf = LeafId::from_index(index);
            if index % 2 == 1 {
                lods[1].remove(leaf);
            }
            match index % 10 {
                0 => lods[2].resize(leaf, 4.0),
                _ => lods[2].remove(leaf),
            }
        }
        let name = path.file_stem().unwrap().to_str().unwrap();
        let mut sizes = Vec::new();
        for layout in LAYOUTS {
            let chain = tree.chain_to_bytes("oak", &levels(&lods), layout).unwrap();
            sizes.push(chain.files.iter().map(|f| f.bytes.len()).sum::<usize>());
            for (number, &triangles) in chain.triangles.iter().enumerate() {
                let file = if layout == Layout::Files { number } else { 0 };
                let level = document(&chain, file);
                let node = node_named(&level.root, &format!("oak_LOD{number}"));
                assert_eq!(triangles_below(&level, node), triangles, "{name}");
                if layout == Layout::Files && number == 0 {
                    let extents = |document: &Document| document.inspect(&[]).extents.unwrap();
                    let (old, new) = (extents(&tree.document), extents(&level));
                    for (old, new) in old.as_flattened().iter().zip(new.as_flattened()) {
                        assert!((old - new).abs() <= 1e-5 * (1.0 + old.abs()), "{name}");
                    }
                }
            }
            for file in &chain.files {
                let path = folder
                    .path()
                    .join(format!("{name}-{layout:?}-{}", file.name));
                std::fs::write(&path, &file.bytes).unwrap();
                files.push(path);
            }
        }
        // One file has what the levels share once.
        assert!(
            sizes[1] < sizes[0] && sizes[2] < sizes[0],
            "{name}: {sizes:?}"
        );
        let input = path.metadata().unwrap().len();
        eprintln!("{name}: {input} bytes, files, siblings and msft: {sizes:?}");
    }
    assert_valid(&files);
    assert_eq!(warnings(&files), [""; 0]);
}

/// A tree large enough to be looked at: leaves with a texture below a node that
/// mirrors and turns.
fn to_look_at() -> Fixture {
    let mut fixture = Fixture::new();
    let leaf = |k: usize| {
        let (x, y) = ((k % 6) as f32 * 1.5, (k / 6) as f32 * 1.5);
        [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]].map(|[x, y]| [x, y, 0.1 * x])
    };
    let positions: Vec<[f32; 3]> = (0..30).flat_map(leaf).collect();
    let attributes = json!({
        "POSITION": fixture.vectors(&positions),
        "NORMAL": fixture.vectors(&[[0.0, 0.0, 1.0]; 120]),
        "TEXCOORD_0": fixture.vectors(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(30)),
    });
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(30));
    let mut fixture = fixture.with_leaves(attributes, Some(indices));
    let view = fixture.view(&encodings::one_texel_png(), None);
    fixture.root["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    fixture.root["textures"] = json!([{"source": 0}]);
    fixture.root["materials"] = json!([
        {"name": "bark", "doubleSided": true,
         "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.2, 0.1, 1.0], "metallicFactor": 0}},
        {"name": "leaf",
         "pbrMetallicRoughness": {"baseColorFactor": [0.6, 1.0, 0.4, 1.0], "metallicFactor": 0,
                                  "baseColorTexture": {"index": 0}}},
    ]);
    fixture.root["nodes"][2]["scale"] = json!([-1, 1, 1]);
    fixture.root["nodes"][2]["translation"] = json!([6, 0, 0]);
    fixture.root["nodes"][0]["rotation"] = json!([0, 0.28, 0, 0.96]);
    fixture
}

/// What the tests show to clients, with its name.
fn shown() -> Vec<(&'static str, Fixture)> {
    let mut skinned = to_look_at();
    with_skin(&mut skinned, 0, 4);
    with_skin(&mut skinned, 1, 120);
    let nodes = skinned.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "joint", "rotation": [0, 0, 0.28, 0.96]}));
    // A node of a skinned mesh is best a root: what is above it does not count.
    for node in nodes.iter_mut().take(3).skip(1) {
        node["skin"] = 0.into();
    }
    nodes[2]
        .as_object_mut()
        .unwrap()
        .retain(|name, _| ["name", "mesh", "skin"].contains(&&**name));
    nodes[0] = json!({"name": "tree", "children": [3]});
    skinned.root["scenes"][0]["nodes"] = json!([0, 1, 2]);
    skinned.root["skins"] = json!([{"joints": [3]}]);

    let mut instanced = to_look_at();
    let moves = instanced.vectors(&[[0.0, 0.0, 0.0], [1.0, 9.0, 1.0]]);
    let attributes = json!({ "TRANSLATION": moves });
    instanced.instance(attributes.as_object().unwrap().clone());
    vec![
        ("one-mesh", to_look_at()),
        ("skinned", skinned),
        ("instanced", instanced),
    ]
}

#[test]
fn three_js_and_babylon_js_draw_every_level() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture();
    let mut jobs = Vec::new();
    let mut triangles = std::collections::HashMap::new();
    for (name, fixture) in shown() {
        let tree = fixture.tree();
        let count = tree.foliage.leaves().len();
        let mut lods = vec![Lod::original(count); 3];
        for index in 0..count {
            let leaf = LeafId::from_index(index);
            if index % 2 == 0 {
                lods[1].remove(leaf);
            }
            match index % 6 {
                1 => lods[2].resize(leaf, 2.0),
                _ => lods[2].remove(leaf),
            }
        }
        let input = format!("{name}.glb");
        std::fs::write(folder.path().join(&input), fixture.glb()).unwrap();
        let mut layouts = Vec::new();
        for layout in LAYOUTS {
            let mut levels = levels(&lods);
            levels[2].facts["screen_coverage"] = json!(0.1);
            let facts = json!({"screen_coverage": 0.0});
            let facts = facts.as_object().unwrap().clone();
            levels.push(Level::of_surface("oak", 3, &picture, facts));
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            let mut files = Vec::new();
            for file in &chain.files {
                let path = format!("{name}-{layout:?}-{}", file.name);
                std::fs::write(folder.path().join(&path), &file.bytes).unwrap();
                files.push(format!("/{path}"));
            }
            let names = ["oak_LOD0", "oak_LOD1", "oak_LOD2", "oak_LOD3"];
            layouts.push(json!({"layout": format!("{layout:?}"), "files": files, "names": names}));
            triangles.insert(name, chain.triangles);
        }
        jobs.push(json!({"name": name, "input": format!("/{input}"), "layouts": layouts}));
    }
    let path = folder.path().join("jobs.json");
    std::fs::write(&path, json!(jobs).to_string()).unwrap();
    let Some(seen) = super::clients::show("page.js", &path) else {
        return;
    };
    assert_eq!(seen.len(), shown().len() * 2 * LAYOUTS.len());
    for chain in seen {
        eprintln!("{chain}");
        let expected = &triangles[chain["name"].as_str().unwrap()];
        let levels = chain["levels"].as_array().unwrap();
        let found: Vec<f64> = levels
            .iter()
            .map(|l| l["triangles"].as_f64().unwrap())
            .collect();
        assert_eq!(
            found,
            expected.iter().map(|&n| n as f64).collect::<Vec<_>>(),
            "{chain}"
        );
        assert!(found.is_sorted_by(|a, b| a > b), "{chain}");
        for level in levels {
            assert!(level["covered"].as_f64().unwrap() > 0.02, "blank: {chain}");
            assert!(
                level["colours"].as_u64().unwrap() > 1,
                "one colour: {chain}"
            );
        }
        // The finest level looks as the input does.
        assert!(
            chain["differs_from_input"].as_f64().unwrap() < 0.002,
            "{chain}"
        );
        if chain["layout"] == "Msft" {
            // JavaScript does not tell 0 from 0.0.
            let coverage: Vec<f64> = chain["coverage"]
                .as_array()
                .unwrap()
                .iter()
                .map(|c| c.as_f64().unwrap())
                .collect();
            assert_eq!(coverage, [0.5, 0.2, 0.1, 0.0], "{chain}");
        }
    }
}
