//! Nodes, instances and scenes: where leaves are in the world.

use glam::DVec3;
use secateur_model::Facing;
use serde_json::json;

use crate::small_tree::{SmallTree, assert_two_squares, centres};

#[track_caller]
fn assert_centres(tree: &SmallTree, expected: &[[f64; 3]]) {
    let found = centres(&tree.tree());
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let apart = (*found - DVec3::from_array(*expected)).length();
        assert!(apart < 1e-12, "{found} is not {expected:?}");
    }
}

#[test]
fn positions_without_transform_are_the_numbers_of_the_file() {
    // 0.1 as f32 is not 0.1 as f64; it stays the f32.
    let mut tree = SmallTree::empty();
    let positions = tree.floats("VEC3", &[0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    tree.primitive(json!({"attributes": {"POSITION": positions}, "material": 0}));
    let corner = tree.tree().foliage().triangles()[0].corners[0];
    let exact = [0.1f32, 0.2, 0.3].map(f64::from);
    assert_eq!(corner.to_array(), exact);
}

#[test]
fn nested_and_mirrored_nodes() {
    // Parent: scale 0.5, then +10 in x. Child: mirrored in x. A centre (x, y,
    // z) goes to (10 - x/2, y/2, z/2).
    let tree = SmallTree::squares().set(
        "/nodes",
        json!([
            {"children": [1], "translation": [10, 0, 0], "scale": [0.5, 0.5, 0.5]},
            {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]},
        ]),
    );
    assert_centres(&tree, &[[9.75, 0.25, 0.0], [9.75, 0.25, 1.0]]);
    // The mirrored surface still faces +z, with its triangles turned.
    let surfaces = tree.tree().surfaces().unwrap();
    let surface = &surfaces[0].0;
    let [a, b, c] = surface.triangles[0].map(|v| surface.positions[v as usize]);
    assert!((b - a).cross(c - a).z > 0.0);
}

#[test]
fn leaves_face_as_material_and_mirrors_say() {
    let facings = |tree: &SmallTree| -> Vec<Facing> {
        let tree = tree.tree();
        let leaves = tree.foliage().leaves();
        leaves.iter().map(|leaf| leaf.facing()).collect()
    };
    let single = SmallTree::squares().set("/materials/0/doubleSided", json!(false));
    assert_eq!(facings(&single), [Facing::Counterclockwise; 2]);
    let mirrored = single.set("/nodes/0/scale", json!([-1, 1, 1]));
    assert_eq!(facings(&mirrored), [Facing::Clockwise; 2]);
    let double = mirrored.set("/materials/0/doubleSided", json!(true));
    assert_eq!(facings(&double), [Facing::Both; 2]);
}

#[test]
fn a_rotation_turns_counter_clockwise_about_its_axis() {
    // A quarter turn about z takes x to y: (0.5, 0.5, z) to (-0.5, 0.5, z). The
    // quaternion is given at twice its length, which doesn't matter.
    let half = std::f64::consts::SQRT_2;
    let tree = SmallTree::squares().set("/nodes/0/rotation", json!([0, 0, half, half]));
    assert_centres(&tree, &[[-0.5, 0.5, 0.0], [-0.5, 0.5, 2.0]]);
}

#[test]
fn a_mesh_shared_by_nodes_is_leaves_for_each() {
    let tree = SmallTree::squares()
        .set("/scenes/0/nodes", json!([1, 0]))
        .set(
            "/nodes",
            json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]),
        );
    // In the order of the scene, not of the file.
    assert_centres(
        &tree,
        &[
            [5.5, 0.5, 0.0],
            [5.5, 0.5, 2.0],
            [0.5, 0.5, 0.0],
            [0.5, 0.5, 2.0],
        ],
    );
    assert_eq!(tree.tree().triangle_count(), 8);
}

#[test]
fn depth_first_order() {
    let tree = SmallTree::squares()
        .set("/scenes/0/nodes", json!([0, 3]))
        .set(
            "/nodes",
            json!([
                {"children": [1, 2]},
                {"children": [4]},
                {"mesh": 0, "translation": [2, 0, 0]},
                {"mesh": 0, "translation": [3, 0, 0]},
                {"mesh": 0, "translation": [4, 0, 0]},
            ]),
        );
    let order: Vec<f64> = centres(&tree.tree())
        .iter()
        .step_by(2)
        .map(|c| c.x - 0.5)
        .collect();
    assert_eq!(order, [4.0, 2.0, 3.0]);
}

#[test]
fn only_the_scene_is_drawn() {
    let nodes = json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]);
    let other = SmallTree::squares()
        .set("/nodes", nodes.clone())
        .set("/scenes", json!([{"nodes": [0]}, {"nodes": [1]}]))
        .set("/scene", json!(1));
    assert_centres(&other, &[[5.5, 0.5, 0.0], [5.5, 0.5, 2.0]]);
    assert_two_squares(&other.clone().without("/scene"));
    // Without scenes: every node that is no child.
    let all = SmallTree::squares()
        .set(
            "/nodes",
            json!([{"children": [1]}, {"mesh": 0}, {"mesh": 0}]),
        )
        .without("/scene")
        .without("/scenes");
    assert_eq!(centres(&all.tree()).len(), 4);
}

#[test]
fn gpu_instances_with_quantised_rotations() {
    let mut tree = SmallTree::squares();
    let translation = tree.floats("VEC3", &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0]);
    // A normalised byte quaternion: no turn, and half a turn about z.
    let rotation = tree.accessor("VEC4", 5120, 2, &[0, 0, 0, 127, 0, 0, 127, 0]);
    let scale = tree.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let attributes = json!({"TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale});
    let tree = tree
        .set(&format!("/accessors/{rotation}/normalized"), json!(true))
        .set("/nodes/0/translation", json!([0, 100, 0]))
        .set(
            "/nodes/0/extensions",
            json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}}),
        );
    // Second instance: scaled by 2, turned, +7 in x; the node adds 100 in y.
    assert_centres(
        &tree,
        &[
            [0.5, 100.5, 0.0],
            [0.5, 100.5, 2.0],
            [6.0, 99.0, 0.0],
            [6.0, 99.0, 4.0],
        ],
    );
    let surfaces = tree.tree().surfaces().unwrap();
    assert_eq!(surfaces.len(), 1, "instances share a surface");
    assert_eq!(surfaces[0].0.triangles.len(), 8);
}

#[test]
fn a_flat_transform_is_an_ordinary_one() {
    let tree = SmallTree::squares().set("/nodes/0/scale", json!([0, 1, 1]));
    let found = tree.tree();
    assert!(
        found
            .foliage()
            .leaves()
            .iter()
            .all(|leaf| leaf.area() == 0.0)
    );
}
