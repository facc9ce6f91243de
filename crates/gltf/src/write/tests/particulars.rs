//! What holds for one encoding each.

use serde_json::{Value, json};

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::{Fixture, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT, read};
use super::fixture::{square_indices, squares};
use crate::write::content::{Content, lod_content};
use crate::{Document, Tree};
use secateur_model::{LeafId, Lod};

fn leaf(number: u32) -> LeafId {
    LeafId::new(number).unwrap()
}

fn without(tree: &Tree, removed: &[u32]) -> Lod {
    let mut lod = Lod::original(tree.foliage.leaves().len());
    removed.iter().for_each(|&number| lod.remove(leaf(number)));
    lod
}

fn content(fixture: &Fixture, lod: impl Fn(&Tree) -> Lod) -> Content {
    let tree = fixture.tree();
    lod_content(&tree, &lod(&tree), &crate::Cutoffs::default()).unwrap()
}

fn names(list: &Value) -> Vec<(&Value, &Value)> {
    let items = list.as_array().unwrap().iter();
    items
        .map(|item| (&item["extras"], &item["extensions"]))
        .collect()
}

#[test]
fn everything_keeps_its_number_name_and_extras() {
    let fixture = encodings::rich();
    let root = content(&fixture, one_gone_one_grown).root;
    let tree = fixture.tree();
    let before = &tree.document.root;
    for list in ["accessors", "bufferViews", "meshes", "buffers"] {
        let views = |root: &Value| {
            let mut views = root[list].clone();
            // The extras of a view stay with its number, its extensions are of
            // the bytes that were there.
            if list == "bufferViews" {
                for view in views.as_array_mut().unwrap() {
                    view["extensions"] = Value::Null;
                }
            }
            views
        };
        assert_eq!(names(&views(before)), names(&views(&root)), "{list}");
    }
    let primitive = |root: &Value| root["meshes"][1]["primitives"][0].clone();
    assert_eq!(
        primitive(before),
        primitive(&root),
        "same numbers, mappings and extras"
    );
}

#[test]
fn an_unknown_extension_keeps_meshes_in_their_places() {
    // The trunk's mesh moves behind the leaves': without leaves it would move up.
    let mut fixture = encodings::rich();
    fixture.root["meshes"].as_array_mut().unwrap().swap(0, 1);
    fixture.root["nodes"][1]["mesh"] = 1.into();
    fixture.root["nodes"][2]["mesh"] = 0.into();
    let bare = content(&fixture, |tree| without(tree, &[1, 2, 3, 4]));
    assert_eq!(bare.root["meshes"][1]["name"], "trunk");
    assert_eq!(bare.root["meshes"][0]["primitives"][0]["mode"], 0);
    assert_eq!(bare.root["nodes"][1]["mesh"], 1);
    assert_eq!(bare.root["nodes"][2].get("mesh"), None);
    validate("placeholder", &bare);

    // Where no extension can name it, it does move.
    fixture.root["extensionsUsed"] = json!(["KHR_materials_variants"]);
    let bare = content(&fixture, |tree| without(tree, &[1, 2, 3, 4]));
    assert_eq!(bare.root["meshes"][0]["name"], "trunk");
    assert_eq!(bare.root["nodes"][1]["mesh"], 0);
}

fn validate(name: &str, content: &Content) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{name}.glb"));
    let glb = crate::container::glb_bytes(&content.root, content.buffer.clone()).unwrap();
    std::fs::write(&path, glb).unwrap();
    super::validator::assert_valid(&[path]);
}

#[test]
fn a_file_of_leaves_alone_can_lose_them_all() {
    let mut fixture = encodings::two_primitives();
    let primitives = fixture.root["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap();
    primitives.remove(0);
    let bare = content(&fixture, |tree| without(tree, &[1, 2, 3, 4]));
    assert_eq!(bare.root.get("meshes"), None);
    assert_eq!(bare.triangles, 0);
    validate("nothing", &bare);
}

#[test]
fn no_dead_bytes_stay() {
    // A leaf is four positions of 12 bytes and six indices of 2, the bark three
    // of each, its indices padded to 8 bytes. shared_accessor has one list of
    // 19 positions for both, shared_view one view.
    const LEAF: usize = 4 * 12 + 6 * 2;
    let bytes = |fixture: &Fixture, removed: &[u32]| {
        content(fixture, |tree| without(tree, removed)).buffer.len()
    };
    for fixture in [encodings::shared_view(), encodings::shared_accessor()] {
        // Four positions and six indices of the trunk that nobody draws.
        let full = bytes(&fixture, &[]);
        assert_eq!(bytes(&fixture, &[1]), full - LEAF);
        assert!(bytes(&fixture, &[1, 2, 3, 4]) <= full - 4 * LEAF);
    }
    let fixture = encodings::touching();
    // The first square shares one of its vertices with the next.
    assert_eq!(bytes(&fixture, &[1]), bytes(&fixture, &[]) - 3 * 12 - 6 * 2);
}

#[test]
fn integers_stay_integers() {
    let fixture = encodings::quantised_normalised();
    let position = |lod: fn(&Tree) -> Lod| {
        let root = content(&fixture, lod).root;
        let number = root["meshes"][1]["primitives"][0]["attributes"]["POSITION"].clone();
        root["accessors"][number.as_u64().unwrap() as usize].clone()
    };
    let kept = position(|tree| without(tree, &[1]));
    assert_eq!(kept["componentType"], super::fixture::SHORT);
    assert_eq!(kept["normalized"], true);
    // Leaves 2 to 4: x from 3 to 10, y to 2 and z to 0.25, times 2048.
    assert_eq!(kept["min"], json!([3 * 2048, 0, 0]));
    assert_eq!(kept["max"], json!([10 * 2048, 2 * 2048, 512]));

    let grown = position(one_gone_one_grown);
    assert_eq!(grown["componentType"], super::fixture::SHORT);
    assert_eq!(grown["normalized"], true);
}

#[test]
fn indices_are_as_wide_as_they_must_be() {
    let component = |before: u32, leaves: usize, removed: &[u32]| {
        let mut fixture = Fixture::new();
        let positions = fixture.vectors(&squares(leaves));
        let indices = fixture.indices(before, &square_indices(leaves));
        let fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
        let root = content(&fixture, |tree| without(tree, removed)).root;
        let number = root["meshes"][1]["primitives"][0]["indices"]
            .as_u64()
            .unwrap();
        root["accessors"][number as usize]["componentType"]
            .as_u64()
            .unwrap() as u32
    };
    assert_eq!(component(UNSIGNED_BYTE, 3, &[1]), UNSIGNED_BYTE);
    assert_eq!(component(UNSIGNED_INT, 3, &[1]), UNSIGNED_SHORT);
    // 16,384 leaves have 65,536 vertices, one too many for 16 bits: 65,535 is
    // no vertex. Without one leaf they fit.
    assert_eq!(component(UNSIGNED_INT, 16_385, &[1]), UNSIGNED_INT);
    assert_eq!(component(UNSIGNED_INT, 16_384, &[1]), UNSIGNED_SHORT);
}

#[test]
fn a_vertex_between_a_kept_and_a_grown_leaf_is_split() {
    // Leaf 2 doubles; it shares a vertex with leaf 1 and one with leaf 3. Both
    // neighbours keep their corners, leaf 2 moves its copies.
    let fixture = encodings::touching();
    let lod = |tree: &Tree| {
        let mut lod = without(tree, &[]);
        lod.resize(leaf(2), 2.0);
        lod
    };
    let tree = fixture.tree();
    let after = read(tree.lod_to_bytes(&lod(&tree)).unwrap());
    for number in [1, 3, 4] {
        let of = |tree: &Tree| tree.foliage.triangles_of(leaf(number)).to_vec();
        assert_eq!(of(&tree), of(&after));
    }
    assert_eq!(after.document.positions(1, 0).unwrap().len(), 13 + 2);
    assert!((after.foliage.leaf(leaf(2)).area() - 2.0).abs() < 1e-6);
}

#[test]
fn morph_displacements_grow_with_their_leaf() {
    let fixture = encodings::morphed();
    let tree = fixture.tree();
    let after = read(tree.lod_to_bytes(&one_gone_one_grown(&tree)).unwrap());
    let targets = &after.document.root["meshes"][1]["primitives"][0]["targets"];
    let moves = |target: usize| -> Vec<[f64; 3]> {
        let accessor = targets[target]["POSITION"].as_u64().unwrap();
        let elements = after.document.elements(accessor as usize).unwrap();
        elements.vectors::<3>().collect()
    };
    // Vertices 4 to 7, the second leaf's, come first now: 0.5 + k times root 2.
    let grown = f64::from((4.5 * std::f64::consts::SQRT_2) as f32);
    assert_eq!(moves(0)[0], [0.0, 0.0, grown]);
    assert_eq!(moves(0)[4], [0.0, 0.0, 8.5]);
    assert_eq!(moves(1), [[0.0; 3]; 12]);
    let zeros = targets[1]["POSITION"].as_u64().unwrap() as usize;
    assert_eq!(
        after.document.root["accessors"][zeros].get("bufferView"),
        None
    );
}

#[test]
fn weights_of_a_bare_node_are_not_animated_any_more() {
    let bare = content(&encodings::morphed(), |tree| without(tree, &[1, 2, 3, 4]));
    let channel = &bare.root["animations"][0]["channels"][0];
    assert_eq!(channel["target"], json!({"path": "weights"}));
    assert!(bare.notes.iter().any(|note| note.contains("weights")));
}

#[test]
fn instances_of_a_leaf_stay_instances_of_it() {
    let tree = encodings::instanced_leaf().tree();
    let after = read(tree.lod_to_bytes(&one_gone_one_grown(&tree)).unwrap());
    assert_eq!(
        after.document.positions(1, 0).unwrap(),
        tree.document.positions(1, 0).unwrap()
    );
    let root = &after.document.root;
    assert_eq!(root["nodes"].as_array().unwrap().len(), 3);
    let attributes = &root["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    let ids = attributes["_ID"].as_u64().unwrap() as usize;
    let ids: Vec<[f64; 1]> = after.document.elements(ids).unwrap().vectors().collect();
    assert_eq!(ids, [[8.0], [9.0], [10.0]]);
}

#[test]
fn no_instance_no_instancing() {
    let bare = content(&encodings::instanced_leaf(), |tree| {
        without(tree, &[1, 2, 3, 4])
    });
    assert_eq!(bare.root["nodes"][2], json!({"name": "leaves"}));
    assert_eq!(bare.root.get("extensionsUsed"), None);
    assert_eq!(bare.root.get("extensionsRequired"), None);
}

#[test]
fn instances_whose_leaves_differ_are_drawn_at_once() {
    // Instance 1 keeps one leaf, grown; instances 2 and 3 stay as they were.
    let tree = encodings::instanced_twig().tree();
    let lod = one_gone_one_grown(&tree);
    let after = read(tree.lod_to_bytes(&lod).unwrap());
    let root = &after.document.root;
    let nodes = root["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), 3);
    assert_eq!(nodes[2].get("children"), None);
    assert_eq!(nodes[2].get("extensions"), None);
    assert_eq!(root.get("extensionsUsed"), None);
    assert_eq!(root["meshes"].as_array().unwrap().len(), 2);
    let primitives = root["meshes"][1]["primitives"].as_array().unwrap();
    assert_eq!(primitives.len(), 1);
    // Nothing stays of the instances' own vertices.
    let mut named = std::collections::BTreeSet::new();
    for mesh in root["meshes"].as_array().unwrap() {
        for primitive in mesh["primitives"].as_array().unwrap() {
            let attributes = primitive["attributes"].as_object().unwrap().values();
            named.extend(
                attributes
                    .chain(primitive.get("indices"))
                    .map(Value::to_string),
            );
        }
    }
    assert_eq!(named.len(), root["accessors"].as_array().unwrap().len());
    let left = lod.foliage(&tree.foliage);
    assert_eq!(after.foliage.triangles().len(), left.triangles().len());
    let apart = content(&encodings::instanced_twig(), one_gone_one_grown);
    assert!(apart.notes.iter().any(|note| note.contains("are one mesh")));
}

#[test]
fn nodes_of_one_mesh_share_it_while_they_can() {
    let meshes = |lod: fn(&Tree) -> Lod| {
        let root = content(&encodings::shared_twig(), lod).root;
        let count = root["meshes"].as_array().unwrap().len();
        let drawn = [2, 3, 4].map(|node| root["nodes"][node]["mesh"].clone());
        (count, drawn)
    };
    // Leaves 1, 3 and 5 are the same leaf of the mesh at three nodes.
    let (all, some) = (
        |tree: &Tree| without(tree, &[1, 3, 5]),
        |tree: &Tree| without(tree, &[1, 5]),
    );
    assert_eq!(meshes(all), (2, [json!(1), json!(1), json!(1)]));
    assert_eq!(meshes(some), (3, [json!(2), json!(1), json!(2)]));
    // The whole of node 2: it draws nothing, the others what they drew.
    let whole = |tree: &Tree| without(tree, &[1, 2]);
    assert_eq!(meshes(whole), (2, [Value::Null, json!(1), json!(1)]));
}

#[test]
fn nodes_of_one_leaf_are_scaled_where_they_stand() {
    let scaled = content(&encodings::shared_leaf(), one_gone_one_grown);
    let nodes = &scaled.root["nodes"];
    assert_eq!(scaled.root["meshes"].as_array().unwrap().len(), 2);
    assert_eq!(nodes[2].get("mesh"), None);
    assert_ne!(
        nodes[3]["matrix"],
        json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1])
    );
    assert_eq!(nodes[3]["mesh"], 1);
    assert_eq!(nodes[4]["scale"], json!([1, -2, 1]));
}

#[test]
fn another_scene_keeps_its_leaves() {
    let other = content(&encodings::second_scene(), one_gone_one_grown).root;
    assert_eq!(other["nodes"][3]["mesh"], 1);
    assert_eq!(other["nodes"][2]["mesh"], 2);
    let positions = |mesh: usize| {
        let number = other["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"].as_u64();
        other["accessors"][number.unwrap() as usize]["count"].clone()
    };
    assert_eq!((positions(1), positions(2)), (json!(16), json!(12)));
}

#[test]
fn images_in_the_buffer_move_along() {
    let fixture = encodings::textured();
    let tree = fixture.tree();
    let glb = tree.lod_to_bytes(&one_gone_one_grown(&tree)).unwrap();
    let after = Document::from_bytes("textured", glb, None).unwrap();
    let view = after.root["images"][0]["bufferView"].as_u64().unwrap() as usize;
    assert_eq!(after.view_bytes(view).unwrap(), encodings::one_texel_png());
}

#[test]
fn compressed_views_that_stay_keep_their_streams() {
    let fixture = encodings::meshopt();
    let copy = content(&fixture, |tree| without(tree, &[]));
    let tree = fixture.tree();
    let streams = |root: &Value, buffer: &[u8]| -> Vec<Vec<u8>> {
        let views = root["bufferViews"].as_array().unwrap().iter();
        let compressed =
            views.filter_map(|view| view.pointer("/extensions/EXT_meshopt_compression"));
        let number = |fields: &Value, name: &str| fields[name].as_u64().unwrap() as usize;
        let stream = |fields: &Value| {
            let start = number(fields, "byteOffset");
            buffer[start..start + number(fields, "byteLength")].to_vec()
        };
        compressed.map(stream).collect()
    };
    let before = streams(&fixture.root, &fixture.bin);
    assert!(!before.is_empty());
    assert_eq!(streams(&copy.root, &copy.buffer), before);
    for list in ["extensionsUsed", "extensionsRequired"] {
        assert_eq!(copy.root[list], tree.document.root[list]);
    }
    // The holes where the positions were are gone.
    assert!(copy.buffer.len() < fixture.bin.len());
    let fallback = &copy.root["buffers"][1]["extensions"]["EXT_meshopt_compression"];
    assert_eq!(*fallback, json!({"fallback": true}));
}
