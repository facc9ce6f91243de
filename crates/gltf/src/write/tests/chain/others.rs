//! What is not the plant, in chains: kept once, beside the finest level.

use super::*;

/// A tree with a collision shape below its root, one more at the root of the scene, and ground in the mesh of
/// its bark.
fn with_others() -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(3));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(3));
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    let shape = fixture.vectors(&[[-9.0, -9.0, 0.0], [20.0, -9.0, 0.0], [0.0, 20.0, 0.0]]);
    let ground = [[-30.0, -5.0, -30.0], [30.0, -5.0, -30.0], [0.0, -5.0, 60.0]];
    let ground = fixture.vectors(&ground);
    let meshes = fixture.root["meshes"].as_array_mut().unwrap();
    meshes.push(json!({"name": "shape", "primitives": [{"attributes": {"POSITION": shape}}]}));
    let bark = meshes[0]["primitives"].as_array_mut().unwrap();
    bark.push(json!({"attributes": {"POSITION": ground}}));
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "tree-colonly", "mesh": 2}));
    nodes.push(json!({"name": "UCX_tree", "mesh": 2, "translation": [0, 1, 0]}));
    nodes[0]["children"] = json!([1, 2, 3]);
    fixture.root["scenes"][0]["nodes"] = json!([0, 4]);
    fixture
}

/// How often each of these is drawn in the scene: the shape below the root, that of the root, the ground.
fn others_in(document: &Document) -> [usize; 3] {
    let parts = document.parts().unwrap();
    let count = |is_it: &dyn Fn(&crate::parts::Part) -> bool| {
        parts.iter().filter(|part| is_it(part)).count()
    };
    let name = |node: usize| document.root["nodes"][node]["name"].as_str().unwrap();
    let has_material = |part: &crate::parts::Part| {
        let primitive = document.primitive(part.mesh, part.primitive).unwrap();
        primitive.get("material").is_some()
    };
    [
        count(&|part| name(part.node) == "tree-colonly"),
        count(&|part| name(part.node) == "UCX_tree"),
        count(&|part| name(part.node) == "trunk" && !has_material(part)),
    ]
}

#[test]
fn what_is_not_the_plant_is_there_once_and_in_no_level() {
    let tree = with_others().tree();
    assert_eq!((tree.parts.len(), tree.others.len()), (2, 3));
    let folder = tempfile::tempdir().unwrap();
    for layout in LAYOUTS {
        let chain = chain(&tree, layout);
        assert_valid(&written(&chain, folder.path(), &format!("{layout:?}")));
        assert_eq!(chain.triangles, [8, 6, 4], "{layout:?}");
        let note = "3 nodes are no plant and stay as they are: trunk (ground), tree-colonly (collision), UCX_tree (collision)";
        assert!(chain.notes.contains(&note.to_owned()), "{:?}", chain.notes);
        for file in 0..chain.files.len() {
            let document = document(&chain, file);
            let expected = [usize::from(file == 0); 3];
            assert_eq!(others_in(&document), expected, "{layout:?}, file {file}");
            for (number, triangles) in chain.triangles.iter().enumerate() {
                if layout != Layout::Files || number == file {
                    let node = node_named(&document.root, &format!("oak_LOD{number}"));
                    assert_eq!(triangles_below(&document, node), *triangles);
                }
            }
            let nodes = document.root["nodes"].as_array().unwrap();
            let is_needless = |node: &&Value| {
                ["mesh", "children"]
                    .iter()
                    .all(|field| node.get(field).is_none())
            };
            assert_eq!(nodes.iter().filter(is_needless).count(), 0, "{layout:?}");
        }
    }
}

#[test]
fn what_is_not_the_plant_has_no_copies_where_levels_keep_the_node_tree() {
    let mut fixture = with_others();
    let times = fixture.elements(FLOAT, 1, &[0.0, 1.0]);
    let places = fixture.vectors(&[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]);
    fixture.root["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": places}],
    }]);
    // The ground is in a mesh of its own here: a mesh of both is copied whole.
    let ground = fixture.root["meshes"][0]["primitives"][1].take();
    fixture.root["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .pop();
    let meshes = fixture.root["meshes"].as_array_mut().unwrap();
    meshes.push(json!({"primitives": [ground]}));
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "plane", "mesh": 3}));
    fixture.root["scenes"][0]["nodes"] = json!([0, 4, 5]);
    let tree = fixture.tree();
    assert_eq!((tree.parts.len(), tree.others.len()), (2, 3));
    for layout in LAYOUTS {
        let chain = chain(&tree, layout);
        let kept = chain
            .notes
            .iter()
            .any(|note| note.contains("keep the node tree"));
        assert!(kept, "{:?}", chain.notes);
        for file in 0..chain.files.len() {
            let document = document(&chain, file);
            let nodes = document.root["nodes"].as_array().unwrap();
            for helper in ["tree-colonly", "UCX_tree", "plane"] {
                let draws_it = |node: &&Value| node["name"] == helper && node.get("mesh").is_some();
                let found = nodes.iter().filter(draws_it).count();
                assert_eq!(
                    found,
                    usize::from(file == 0),
                    "{layout:?}, file {file}: {helper}"
                );
            }
        }
    }
}
