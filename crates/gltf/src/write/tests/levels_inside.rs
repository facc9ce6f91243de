//! Files that have levels already: the finest is the plant, the others go.

use serde_json::{Value, json};

use super::fixture::{Fixture, UNSIGNED_SHORT, square_indices, squares};
use super::validator::assert_valid;
use crate::chain::{Layout, Level};
use crate::{Document, Tree};
use secateur_model::{Foliage, LeafId, Lod};

/// A tree of three leaves, node 0, and two coarser ones of two and of one leaf, nodes 3 and 4, none of them in
/// the scene but the first.
fn three_levels() -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(3));
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    for (number, leaves) in [(1, 2), (2, 1)] {
        let positions = fixture.vectors(&squares(leaves));
        let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(leaves));
        let primitive =
            json!({"attributes": {"POSITION": positions}, "indices": indices, "material": 1});
        let meshes = fixture.root["meshes"].as_array_mut().unwrap();
        meshes.push(json!({"name": format!("coarse {number}"), "primitives": [primitive]}));
        let node = json!({"name": format!("coarse {number}"), "mesh": 1 + number});
        fixture.root["nodes"].as_array_mut().unwrap().push(node);
    }
    fixture
}

/// Three levels that are known by their names.
fn named() -> Fixture {
    let mut fixture = three_levels();
    for (node, name) in [(0, "Oak_LOD0"), (3, "Oak_LOD1"), (4, "Oak_LOD2_Billboard")] {
        fixture.root["nodes"][node]["name"] = name.into();
    }
    fixture.root["scenes"][0]["nodes"] = json!([0, 3, 4]);
    fixture
}

/// Three levels that MSFT_lod links.
fn linked() -> Fixture {
    let mut fixture = three_levels();
    fixture.use_extension("MSFT_lod", false);
    fixture.root["nodes"][0]["extensions"] = json!({"MSFT_lod": {"ids": [3, 4]}});
    fixture.root["nodes"][0]["extras"] = json!({"MSFT_screencoverage": [0.5, 0.2, 0.0]});
    fixture
}

const NAMED_NOTE: &str =
    "2 nodes are coarser levels of Oak_LOD0 and are left out: Oak_LOD1, Oak_LOD2_Billboard";
const LINKED_NOTE: &str = "2 nodes are coarser levels of tree and are left out: coarse 1, coarse 2";

fn both() -> [(Fixture, &'static str); 2] {
    [(named(), NAMED_NOTE), (linked(), LINKED_NOTE)]
}

fn names(root: &Value, list: &str) -> Vec<String> {
    let items = root[list].as_array().unwrap().iter();
    items
        .map(|item| item["name"].as_str().unwrap_or_default().to_owned())
        .collect()
}

/// Two leaves of the finest.
fn without_first(tree: &Tree) -> Lod {
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(LeafId::from_index(0));
    lod
}

#[test]
fn the_finest_level_is_the_plant() {
    for (fixture, note) in both() {
        let tree = fixture.tree();
        assert_eq!(
            (tree.leaf_triangle_count(), tree.wood_triangle_count()),
            (6, 2)
        );
        assert_eq!(tree.inspection().notes, [note]);
        let drawn = tree.document.surfaces(&[]).unwrap();
        let triangles: usize = drawn.iter().map(|(s, _)| s.triangles.len()).sum();
        assert_eq!(triangles, 8);
    }
}

#[test]
fn coarser_levels_are_not_in_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (fixture, note) in both() {
        let tree = fixture.tree();
        let path = folder.path().join("level.glb");
        let options = crate::WriteOptions::default().overwrite(true);
        let prepared =
            tree.prepare_lod_with(&without_first(&tree), &Default::default(), &path, options);
        let written = prepared.unwrap().commit().unwrap();
        assert_eq!(written.triangles, 6);
        assert_eq!(written.notes, [note]);
        assert_valid(std::slice::from_ref(&path));
        let level = Document::open(&path).unwrap();
        assert_eq!(names(&level.root, "nodes").len(), 3);
        assert_eq!(names(&level.root, "meshes"), ["trunk", "leaves"]);
        let text = level.root.to_string();
        assert!(!text.contains("MSFT"), "{text}");
        // What only the coarser levels named takes no bytes any more.
        assert!(level.data_bytes < tree.document.data_bytes);
        assert_eq!(level.inspect(&[]).notes, [""; 0]);
    }
}

#[test]
fn coarser_levels_are_in_no_chain_that_is_made() {
    for (fixture, note) in both() {
        let tree = fixture.tree();
        let lods = [Lod::original(3), without_first(&tree)];
        let levels = levels(&lods);
        for layout in [Layout::Files, Layout::Siblings, Layout::Msft] {
            let chain = tree.chain_to_bytes("new", &levels, layout).unwrap();
            assert!(chain.notes.contains(&note.to_owned()), "{:?}", chain.notes);
            for file in chain.files {
                let document = Document::from_bytes(&file.name, file.bytes, None).unwrap();
                let mut all = names(&document.root, "nodes");
                all.extend(names(&document.root, "meshes"));
                let is_old = |name: &&String| name.contains("coarse") || name.contains("Oak");
                assert_eq!(all.iter().find(is_old), None, "{layout:?}");
                assert!(!document.root.to_string().contains("original_nodes"));
            }
        }
    }
}

fn levels(lods: &[Lod]) -> Vec<Level<'_>> {
    let level = |(number, lod)| {
        let coverage = json!({"screen_coverage": 0.5 - 0.5 * number as f64});
        Level::new("new", number, lod, coverage.as_object().unwrap().clone())
    };
    lods.iter().enumerate().map(level).collect()
}

#[test]
fn every_layout_is_read_as_its_finest_level() {
    let tree = linked().tree();
    let lods = [Lod::original(3), without_first(&tree)];
    let corners = |foliage: &Foliage| {
        let triangles = foliage.triangles().iter();
        let mut corners: Vec<String> = triangles.map(|t| format!("{:?}", t.corners)).collect();
        corners.sort_unstable();
        corners
    };
    for layout in [Layout::Files, Layout::Siblings, Layout::Msft] {
        let chain = tree.chain_to_bytes("new", &levels(&lods), layout).unwrap();
        let again = super::fixture::read(chain.files[0].bytes.clone());
        assert_eq!(
            corners(&again.foliage),
            corners(&tree.foliage),
            "{layout:?}"
        );
        assert_eq!(again.triangle_count(), tree.triangle_count(), "{layout:?}");
        let noted = again.inspection.notes.len();
        assert_eq!(noted, usize::from(layout != Layout::Files), "{layout:?}");
    }
}

#[test]
fn names_that_are_no_levels_of_each_other_stay() {
    let kept = |names: [&str; 3]| {
        let mut fixture = named();
        for (node, name) in [0, 3, 4].into_iter().zip(names) {
            fixture.root["nodes"][node]["name"] = name.into();
        }
        let document = Document::from_bytes("x.glb", fixture.glb(), None).unwrap();
        let mut nodes: Vec<usize> = document.parts().unwrap().iter().map(|p| p.node).collect();
        nodes.dedup();
        nodes
    };
    const ALL: [usize; 4] = [1, 2, 3, 4];
    assert_eq!(kept(["Oak_LOD0", "Oak_LOD1", "Oak_LOD2"]), [1, 2]);
    assert_eq!(kept(["Oak_LOD2", "Oak_LOD1", "Oak_LOD0"]), [4]);
    assert_eq!(kept(["Oak", "Oak_LOD1", "Oak_LOD2"]), [1, 2]);
    assert_eq!(kept(["Oak_LOD0", "Oak_LOD1", "Oak_Billboard"]), [1, 2]);
    assert_eq!(kept(["Oak_LOD0", "Oak_LOD1", "Billboard_LOD2"]), [1, 2]);
    // Two plants, and two of which each has one level only.
    assert_eq!(kept(["Oak_LOD0", "Oak_LOD1", "Pine_LOD0"]), [1, 2, 4]);
    assert_eq!(kept(["Oak_LOD0", "Pine_LOD1", "Birch_LOD2"]), ALL);
    assert_eq!(kept(["Oak", "Pine_LOD1", "Billboard"]), ALL);
    assert_eq!(kept(["Oak_1", "Oak_2", "Oak_3"]), ALL);
}

#[test]
fn what_moves_a_coarser_level_stays_without_its_mesh() {
    let mut fixture = named();
    let times = fixture.elements(super::fixture::FLOAT, 1, &[0.0, 1.0]);
    let places = fixture.vectors(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    fixture.root["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}],
        "samplers": [{"input": times, "output": places}],
    }]);
    let tree = fixture.tree();
    let glb = tree.lod_to_bytes(&without_first(&tree)).unwrap();
    let level = Document::from_bytes("level.glb", glb, None).unwrap();
    assert_eq!(names(&level.root, "nodes").len(), 5);
    assert_eq!(level.root["nodes"][3].get("mesh"), None);
    assert_eq!(level.root["animations"], fixture.root["animations"]);
}

/// Two trees of a trunk and leaves, the second without its middle leaf and so far along x.
fn in_one_place(away: f64) -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(3));
    let of_two = [&square_indices(1)[..], &square_indices(3)[12..]].concat();
    let of_two = fixture.indices(UNSIGNED_SHORT, &of_two);
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    let trunk = fixture.root["meshes"][0]["primitives"][0].clone();
    let leaves = json!({"attributes": {"POSITION": positions}, "indices": of_two, "material": 1});
    let meshes = fixture.root["meshes"].as_array_mut().unwrap();
    meshes.push(json!({"name": "b", "primitives": [trunk, leaves]}));
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "b", "mesh": 2, "translation": [away, 0, 0]}));
    fixture.root["nodes"][0]["name"] = "a".into();
    fixture.root["scenes"][0]["nodes"] = json!([0, 3]);
    fixture
}

#[test]
fn plants_that_fill_one_box_are_levels() {
    let notes = |away| in_one_place(away).tree().inspection().notes.clone();
    assert_eq!(
        notes(0.0),
        ["1 node is a coarser level of a and is left out: b"]
    );
    assert!(notes(100.0).iter().all(|note| !note.contains("coarser")));
}

#[test]
fn cases_of_strangers_are_their_finest_level() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/cases");
    for (name, levels) in [
        ("lodsinside.glb", "Oak_LOD1, Oak_LOD2, Oak_LOD3_Billboard"),
        ("msftlod.glb", "Oak1, Oak2"),
    ] {
        let path = std::path::Path::new(folder).join(name);
        if !path.is_file() {
            eprintln!("SKIPPED: ../shared/cases/{name} is not there");
            continue;
        }
        let tree = Tree::open(&path, &[]).unwrap();
        assert_eq!(tree.triangle_count(), 1428, "{name}");
        let notes = &tree.inspection().notes;
        assert!(
            notes[0].ends_with(&format!("are left out: {levels}")),
            "{notes:?}"
        );
        let leaves = tree.foliage.leaves().len();
        let glb = tree.lod_to_bytes(&Lod::original(leaves)).unwrap();
        let level = Document::from_bytes(name, glb, None).unwrap();
        assert_eq!(names(&level.root, "nodes").len(), 1, "{name}");
        assert_eq!(names(&level.root, "meshes").len(), 1, "{name}");
    }
}
