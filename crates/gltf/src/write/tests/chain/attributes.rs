//! Every attribute, skin and morph target of a level is as in the tree.

use super::fixtures::*;
use super::*;

#[test]
fn a_mirror_turns_triangles_normals_tangents_and_morphs() {
    let fixture = mirrored_rich();
    let tree = fixture.tree();
    let chain = chain(&tree, Layout::Files);
    let level = document(&chain, 0);
    let foliage = tree
        .parts
        .iter()
        .find(|part| part.role == crate::roles::Role::Leaf)
        .unwrap();
    // The mesh of a level is about the place of the root, which its node has.
    let pivot = DVec3::new(1.0, 2.0, 3.0);
    let level_from_local = DMat4::from_translation(-pivot) * foliage.world_from_local;
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
        assert!(level_from_local.transform_point3(*old).distance(*new) < 1e-5);
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
    let along = level_from_local.transform_vector3(DVec3::X).normalize();
    let side = level_from_local.transform_vector3(DVec3::Y).normalize();
    for ([x, y, z, w], normal) in tangents.vectors::<4>().zip(&normals) {
        let tangent = DVec3::new(x, y, z);
        assert!(tangent.distance(along) < 1e-5);
        let bitangent = normal.cross(tangent) * w;
        assert!(bitangent.distance(side) < 1e-5, "{bitangent} is not {side}");
    }
    let target = &primitives[leaves]["targets"][0];
    let moves = vectors(number(target, "POSITION"));
    let moved = level_from_local.transform_vector3(DVec3::new(1.0, 2.0, 3.0));
    assert!(moves.iter().all(|found| found.distance(moved) < 1e-5));
    // A morphed normal is that of the morphed original, but for its length.
    let of_normals = glam::DMat3::from_mat4(level_from_local)
        .inverse()
        .transpose();
    let expected = (of_normals * DVec3::new(0.5, 0.0, 1.0)).normalize();
    let changes = vectors(number(target, "NORMAL"));
    for (normal, change) in normals.iter().zip(&changes) {
        assert!((*normal + *change).normalize().distance(expected) < 1e-5);
    }
    let expected = level_from_local
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

#[test]
fn weights_and_names_of_morph_targets_stay() {
    for file in 0..3 {
        let level = document(&chain(&still_morphs().tree(), Layout::Files), file);
        let mesh = &level.root["meshes"][0];
        assert_eq!(mesh["weights"], json!([0.25, 0.5]));
        assert_eq!(mesh["extras"], json!({"targetNames": ["wind", "snow"]}));
    }
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
