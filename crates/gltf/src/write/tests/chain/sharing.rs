//! What levels have in common is there once, and all else of the file stays.

use super::*;

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
