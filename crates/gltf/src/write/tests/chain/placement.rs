//! Levels keep the plant's own pivot: its place in the scene is in their nodes.

use super::*;
use crate::chain::LevelContent;

/// Three leaves and a trunk in one root.
fn tree_at_origin() -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(3));
    fixture.with_leaves(json!({"POSITION": positions}), Some(indices))
}

fn with_root(field: &str, value: Value) -> Fixture {
    let mut fixture = tree_at_origin();
    fixture.root["nodes"][0][field] = value;
    fixture
}

/// The node of a level and where the scene puts it, by the translations of itself and its parent.
fn level_node(document: &Document, number: usize) -> (usize, DVec3) {
    let node = node_named(&document.root, &format!("oak_LOD{number}"));
    let nodes = document.root["nodes"].as_array().unwrap();
    let holds = |fields: &&Value| {
        let children = fields.get("children").and_then(Value::as_array);
        children.is_some_and(|children| children.contains(&node.into()))
    };
    let chain = [Some(&nodes[node]), nodes.iter().find(holds)];
    let at = |fields: &Value| {
        let at = fields.get("translation").and_then(Value::as_array);
        at.map_or(DVec3::ZERO, |at| {
            DVec3::from_slice(&[0, 1, 2].map(|k| at[k].as_f64().unwrap()))
        })
    };
    (node, chain.into_iter().flatten().map(at).sum())
}

/// The lowest and the highest numbers of a level's positions, as its mesh has them.
fn bounds(document: &Document, node: usize) -> [Vec<f64>; 2] {
    let root = &document.root;
    let mesh = root["nodes"][node]["mesh"].as_u64().unwrap() as usize;
    let primitives = root["meshes"][mesh]["primitives"]
        .as_array()
        .unwrap()
        .iter();
    let mut bounds = [vec![f64::INFINITY; 3], vec![f64::NEG_INFINITY; 3]];
    for primitive in primitives {
        let accessor = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
        for k in 0..3 {
            let of = |end: &str| root["accessors"][accessor][end][k].as_f64().unwrap();
            bounds[0][k] = bounds[0][k].min(of("min"));
            bounds[1][k] = bounds[1][k].max(of("max"));
        }
    }
    bounds
}

#[test]
fn a_level_stands_where_the_plant_stood_about_the_same_pivot() {
    let original = tree_at_origin().tree();
    let moved = DVec3::new(100.0, 0.0, 50.0);
    let below_nodes = {
        // The root does nothing, the node below it moves the tree.
        let mut fixture = with_root("translation", json!([100, 0, 50]));
        let nodes = fixture.root["nodes"].as_array_mut().unwrap();
        nodes.push(json!({"name": "scene", "children": [0]}));
        fixture.root["scenes"][0]["nodes"] = json!([3]);
        fixture
    };
    let by_matrix = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 50, 1]);
    for fixture in [
        with_root("translation", json!([100, 0, 50])),
        with_root("matrix", by_matrix),
        below_nodes,
    ] {
        let tree = fixture.tree();
        for layout in LAYOUTS {
            let (chain, expected) = (chain(&tree, layout), chain(&original, layout));
            for number in 0..3 {
                let file = if layout == Layout::Files { number } else { 0 };
                let (document, expected) = (document(&chain, file), document(&expected, file));
                let (node, at) = level_node(&document, number);
                assert_eq!(at, moved, "{layout:?}");
                let (same, _) = level_node(&expected, number);
                assert_eq!(
                    bounds(&document, node),
                    bounds(&expected, same),
                    "{layout:?}"
                );
            }
            let first = document(&chain, 0);
            let parent = first.root["nodes"].as_array().unwrap();
            let parent = parent.iter().find(|node| node["name"] == "oak");
            let carries = parent.is_some_and(|parent| parent.get("translation").is_some());
            assert_eq!(carries, layout == Layout::Siblings);
            let again = read(chain.files[0].bytes.clone());
            assert_same_leaves(&again.foliage, &tree.foliage, "the finest level");
        }
    }
}

#[test]
fn turns_and_scales_are_about_the_pivot() {
    let mut fixture = with_root("translation", json!([10, 20, 30]));
    fixture.root["nodes"][0]["scale"] = json!([2, 2, 2]);
    let tree = fixture.tree();
    let document = document(&chain(&tree, Layout::Files), 0);
    let (node, at) = level_node(&document, 0);
    assert_eq!(at, DVec3::new(10.0, 20.0, 30.0));
    // Of the trunk and the leaves, doubled: 5 below the pivot become 10.
    assert_eq!(bounds(&document, node)[0], [0.0, -10.0, 0.0]);
}

#[test]
fn several_roots_have_no_pivot_in_common() {
    let mut fixture = with_root("translation", json!([100, 0, 50]));
    fixture.root["nodes"][0]["children"] = json!([1]);
    fixture.root["scenes"][0]["nodes"] = json!([0, 2]);
    let tree = fixture.tree();
    let document = document(&chain(&tree, Layout::Files), 0);
    let (node, at) = level_node(&document, 0);
    assert_eq!(at, DVec3::ZERO);
    assert_eq!(bounds(&document, node)[1][0], 101.0);
}

#[test]
fn copies_of_the_node_tree_are_about_the_pivot_too() {
    let mut fixture = with_root("translation", json!([100, 0, 50]));
    let places = fixture.vectors(&[[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]]);
    let attributes = json!({ "TRANSLATION": places });
    fixture.instance(attributes.as_object().unwrap().clone());
    let tree = fixture.tree();
    for layout in LAYOUTS {
        let chain = chain(&tree, layout);
        for number in 0..3 {
            let file = if layout == Layout::Files { number } else { 0 };
            let document = document(&chain, file);
            let (node, at) = level_node(&document, number);
            assert_eq!(at, DVec3::new(100.0, 0.0, 50.0), "{layout:?}");
            for child in document.root["nodes"][node]["children"].as_array().unwrap() {
                let child = &document.root["nodes"][child.as_u64().unwrap() as usize];
                assert_eq!(child.get("translation"), None, "{layout:?}");
            }
        }
        let again = read(chain.files[0].bytes.clone());
        assert_same_leaves(&again.foliage, &tree.foliage, "the finest level");
    }
}

#[test]
fn what_an_animation_moves_stays_where_it_is() {
    let mut fixture = with_root("translation", json!([100, 0, 50]));
    let times = fixture.elements(FLOAT, 1, &[0.0, 1.0]);
    let places = fixture.vectors(&[[100.0, 0.0, 50.0], [100.0, 1.0, 50.0]]);
    fixture.root["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": places}],
    }]);
    let document = document(&chain(&fixture.tree(), Layout::Files), 0);
    let (_, at) = level_node(&document, 0);
    assert_eq!(at, DVec3::ZERO);
    let root = node_named(&document.root, "tree");
    assert_eq!(
        document.root["nodes"][root]["translation"],
        json!([100, 0, 50])
    );
}

#[test]
fn impostors_stand_there_too() {
    let tree = with_root("translation", json!([100, 0, 50])).tree();
    let (surface, _) = tree.surfaces().unwrap().remove(0);
    let lod = Lod::original(tree.foliage.leaves().len());
    let mut levels = levels(std::slice::from_ref(&lod));
    let mut impostor = Level::of_surface("oak", 1, &surface, facts(1));
    impostor.name = "oak_LOD1".to_owned();
    assert!(matches!(impostor.content, LevelContent::Surface(_)));
    levels.push(impostor);
    for layout in LAYOUTS {
        let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
        let document = document(&chain, chain.files.len() - 1);
        let (node, at) = level_node(&document, 1);
        assert_eq!(at, DVec3::new(100.0, 0.0, 50.0), "{layout:?}");
        // The trunk: about its pivot, as the tree has it.
        assert_eq!(bounds(&document, node)[0], [0.0, -5.0, 0.0], "{layout:?}");
    }
}

#[test]
fn a_strangers_tree_that_stands_elsewhere_has_the_levels_of_one_at_the_origin() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/cases");
    let [placed, base] = ["placed.glb", "base.glb"].map(|name| Path::new(folder).join(name));
    if !placed.is_file() || !base.is_file() {
        eprintln!("SKIPPED: ../shared/cases/placed.glb is not there");
        return;
    }
    let [placed, base] = [placed, base].map(|path| {
        let tree = Tree::open(&path, &[]).unwrap();
        let lod = Lod::original(tree.foliage.leaves().len());
        let chain = tree.chain_to_bytes("oak", &levels(&[lod]), Layout::Files);
        document(&chain.unwrap(), 0)
    });
    let (node, at) = level_node(&placed, 0);
    assert_eq!(at, DVec3::new(100.0, 0.0, 50.0));
    assert_eq!(bounds(&placed, node), bounds(&base, level_node(&base, 0).0));
}
