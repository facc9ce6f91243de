//! What is taken for foliage, and what is said where it can't be told.

use secateur_gltf::{Selector, TakenFor};
use serde_json::{Value, json};

use crate::roles::case;
use crate::small_tree::SmallTree;

/// Twenty quads strewn about, then a box that is one closed piece, each a
/// primitive with its own unnamed material.
fn quads_and_box() -> SmallTree {
    let mut tree = SmallTree::empty();
    let quads: Vec<f32> = (0..20)
        .flat_map(|k| {
            let x = 3.0 * k as f32;
            [
                [x, 0.0, 0.0],
                [x + 1.0, 0.0, 0.0],
                [x, 1.0, 0.0],
                [x + 1.0, 1.0, 0.0],
            ]
        })
        .flatten()
        .collect();
    let quad_indices: Vec<u16> = (0..20)
        .flat_map(|k| [0, 1, 2, 2, 1, 3].map(|i| 4 * k + i))
        .collect();
    let corner = |k: u16| [k & 1, k >> 1 & 1, k >> 2].map(|b| -f32::from(b));
    let corners: Vec<f32> = (0..8).flat_map(corner).collect();
    let faces = [
        [0, 1, 3, 2],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    let box_indices: Vec<u16> = faces
        .iter()
        .flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d])
        .collect();
    for (material, (positions, indices)) in [(quads, quad_indices), (corners, box_indices)]
        .into_iter()
        .enumerate()
    {
        let positions = tree.floats("VEC3", &positions);
        let indices = tree.shorts("SCALAR", &indices);
        tree.primitive(json!({
            "attributes": {"POSITION": positions}, "indices": indices, "material": material
        }));
    }
    tree.set("/materials", json!([{}, {}]))
}

fn taken(tree: &SmallTree, selectors: &[Selector]) -> Vec<TakenFor> {
    let inspection = tree.document().inspect(selectors);
    inspection.primitives.iter().map(|p| p.taken_for).collect()
}

fn error(tree: &SmallTree, selectors: &[&str]) -> String {
    let selectors: Vec<Selector> = selectors.iter().map(|s| s.parse().unwrap()).collect();
    tree.document()
        .into_tree(&selectors)
        .unwrap_err()
        .to_string()
}

#[test]
fn many_alike_flat_pieces_are_leaves_without_any_name() {
    let tree = quads_and_box();
    assert_eq!(taken(&tree, &[]), [TakenFor::Foliage, TakenFor::Wood]);
    let inspection = tree.document().inspect(&[]);
    let reasons = |k: usize| inspection.primitives[k].reasons[0].text.clone();
    assert_eq!(reasons(0), "20 of its 20 pieces are small and flat");
    assert_eq!(
        reasons(1),
        "only 0 % of its triangles are in small flat pieces"
    );
    let facts = inspection.foliage.unwrap();
    assert_eq!((facts.leaves, facts.triangles), (20, 40));
    assert_eq!((facts.leaf_area.min, facts.leaf_area.max), (1.0, 1.0));
    assert_eq!(inspection.wood_triangles, 12);
    assert_eq!(
        inspection.extents,
        Some([[-1.0, -1.0, -1.0], [58.0, 1.0, 0.0]])
    );
}

#[test]
fn names_outweigh_shapes() {
    // A box called leaf and quads called bark: 4 - 3 against -4 + 4 points.
    // The name that all share, the mesh's, says nothing.
    let tree = quads_and_box()
        .set("/materials", json!([{"name": "bark"}, {"name": "leaf"}]))
        .set("/meshes/0/name", json!("oak leaves"));
    assert_eq!(
        error(&tree, &[]),
        "small.glb: no foliage was found; name it by a selector: material:leaf"
    );
}

/// Names that differ in their last number are named by a wildcard, unless that would name wood.
#[test]
fn many_names_are_one_with_a_wildcard() {
    let crowns = |of_wood: &str| {
        let tree = quads_and_box();
        let [quads, boxed] = [0, 1].map(|k| tree.root["meshes"][0]["primitives"][k].clone());
        let crown = |k: usize| json!({"name": format!("crown.00{k}"), "primitives": [boxed]});
        let nodes: Vec<Value> = (0..4).map(|mesh| json!({"mesh": mesh})).collect();
        let wood = json!({"name": of_wood, "primitives": [quads]});
        let tree = tree
            .set("/materials", json!([{"name": "bark"}, {"name": "leaf"}]))
            .set("/meshes", json!([wood, crown(1), crown(2), crown(3)]))
            .set("/nodes", json!(nodes))
            .set("/scenes/0/nodes", json!([0, 1, 2, 3]));
        tree.document().inspect(&[]).candidates
    };
    assert_eq!(crowns("trunk"), ["mesh:crown.*"]);
    let each = ["mesh:crown.001", "mesh:crown.002", "mesh:crown.003"];
    assert_eq!(crowns("crown.000"), each);
}

/// The points and the texts of what a primitive's names say.
fn of_names(tree: &SmallTree, primitive: usize) -> Vec<(f64, String)> {
    let inspection = tree.document().inspect(&[]);
    let reasons = inspection.primitives[primitive].reasons.iter();
    reasons
        .filter(|reason| reason.text.contains("name"))
        .map(|reason| (reason.points, reason.text.clone()))
        .collect()
}

/// A material called grass is of blades where there are many pieces. One piece is a lawn, and its name says nothing.
#[test]
fn grass_is_leaves_where_it_has_many_pieces() {
    let called = |names: Value| quads_and_box().set("/materials", names);
    let blades = called(json!([{"name": "Grass_01"}, {}]));
    let text = "material name `Grass_01` speaks of leaves";
    assert_eq!(of_names(&blades, 0), [(4.0, text.to_owned())]);
    let lawn = called(json!([{}, {"name": "grass"}]));
    assert!(of_names(&lawn, 1).is_empty());
}

#[test]
fn a_word_that_is_copied_counts_once() {
    // Two meshes: else the mesh's name is that of all.
    let two = |[material, mesh, node]: [&str; 3]| {
        let tree = quads_and_box();
        let boxed = tree.root["meshes"][0]["primitives"][1].clone();
        let quads = tree.root["meshes"][0]["primitives"][0].clone();
        tree.set("/materials", json!([{"name": material}, {}]))
            .set(
                "/meshes",
                json!([{"name": mesh, "primitives": [quads]}, {"primitives": [boxed]}]),
            )
            .set("/nodes", json!([{"name": node, "mesh": 0}, {"mesh": 1}]))
            .set("/scenes/0/nodes", json!([0, 1]))
    };
    let said = |names| of_names(&two(names), 0);
    let once = [(-4.0, "material name `Tree_Bark` speaks of wood".to_owned())];
    assert_eq!(said(["Tree_Bark", "Tree_Bark", "tree_bark.001"]), once);
    // Another word is another witness.
    let points = |names| {
        said(names)
            .iter()
            .map(|(points, _)| *points)
            .collect::<Vec<_>>()
    };
    assert_eq!(points(["Bark", "Trunk", "trunk.001"]), [-4.0, -3.0]);
    assert_eq!(points(["Bark", "x", "Leaves"]), [-4.0, 2.0]);
    assert_eq!(points(["x", "y", "Leaves"]), [2.0]);
}

#[test]
fn branches_on_cut_out_cards_are_no_wood() {
    let with = |name: &str, alpha: &str| {
        let mut tree = quads_and_box();
        tree.texture(&image::RgbaImage::from_fn(2, 1, |x, _| {
            image::Rgba([90, 60, 30, 255 * x as u8])
        }));
        let pbr = json!({"baseColorTexture": {"index": 0}});
        let cards = json!({"name": name, "alphaMode": alpha, "pbrMetallicRoughness": pbr});
        tree.set("/materials", json!([cards, {"name": "x"}]))
    };
    assert_eq!(of_names(&with("Tree_Branches_01", "MASK"), 0), []);
    assert_eq!(of_names(&with("twigs", "MASK"), 0), []);
    assert_eq!(of_names(&with("Tree_Branches_01", "OPAQUE"), 0).len(), 1);
    assert_eq!(of_names(&with("Bark", "MASK"), 0).len(), 1);
}

#[test]
fn a_strangers_cards_of_branches_are_leaves() {
    let Some(document) = case("branchcards2.glb") else {
        return;
    };
    let inspection = document.inspect(&[]);
    let primitives = inspection.primitives.iter();
    let taken: Vec<TakenFor> = primitives.take(2).map(|p| p.taken_for).collect();
    assert_eq!(taken, [TakenFor::Wood, TakenFor::Foliage]);
}

#[test]
fn a_selector_decides() {
    let tree = quads_and_box().set("/materials", json!([{"name": "oak_leaf"}, {}]));
    for text in ["material:*leaf", "material:#0"] {
        let selector: Selector = text.parse().unwrap();
        assert_eq!(
            taken(&tree, &[selector]),
            [TakenFor::Foliage, TakenFor::Wood],
            "{text}"
        );
    }
    let all: Selector = "node:crown".parse().unwrap();
    assert_eq!(taken(&tree, &[all]), [TakenFor::Foliage, TakenFor::Foliage]);
    let unnamed: Selector = "material:#1".parse().unwrap();
    let boxed = tree.document().into_tree(&[unnamed]).unwrap();
    assert_eq!(boxed.foliage().leaves().len(), 1);
    assert!(boxed.inspection().primitives[1].chosen_by_user);
}

#[test]
fn a_node_selector_can_take_one_of_two_nodes() {
    let tree = SmallTree::squares()
        .set("/scenes/0/nodes", json!([0, 1]))
        .set(
            "/nodes",
            json!([{"mesh": 0, "name": "left"}, {"mesh": 0, "name": "right"}]),
        );
    let right: Selector = "node:right".parse().unwrap();
    assert_eq!(
        taken(&tree, std::slice::from_ref(&right)),
        [TakenFor::FoliageInPart]
    );
    let tree = tree.document().into_tree(&[right]).unwrap();
    assert_eq!(tree.foliage().leaves().len(), 2);
    assert_eq!(
        (tree.leaf_triangle_count(), tree.wood_triangle_count()),
        (4, 4)
    );
}

#[test]
fn a_selector_that_matches_nothing_is_told_what_there_is() {
    let tree = quads_and_box().set("/materials", json!([{"name": "oak"}, {}]));
    assert_eq!(
        error(&tree, &["material:oak", "material:leaf*"]),
        "small.glb: `material:leaf*` matches nothing; there are material:oak, material:#1"
    );
    assert_eq!(
        error(&tree, &["node:tree"]),
        "small.glb: `node:tree` matches nothing; there are node:crown"
    );
}

#[test]
fn wood_alone_is_no_foliage() {
    let mut tree = quads_and_box();
    tree.root["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .remove(0);
    assert_eq!(
        error(&tree, &[]),
        "small.glb: no foliage was found; name it by a selector: all"
    );
    let empty = SmallTree::empty();
    assert_eq!(
        error(&empty, &[]),
        "small.glb: no foliage was found: the file has no triangles to choose from"
    );
}

/// A few cards of many say nothing, and a plant that had leaves has no others.
#[test]
fn what_is_known_of_a_plant_holds_for_its_levels() {
    let original = quads_and_box().document().into_tree(&[]).unwrap();
    assert_eq!(original.foliage().leaves().len(), 20);
    let mut level = quads_and_box();
    let quads = level.root["meshes"][0]["primitives"][0]["indices"].clone();
    let few = level.shorts("SCALAR", &[0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7]);
    assert_ne!(quads, few);
    level.root["meshes"][0]["primitives"][0]["indices"] = few.into();
    assert!(error(&level, &[]).contains("no foliage was found"));
    let known = level.document().with_roles_of(&original);
    assert_eq!(known.into_tree(&[]).unwrap().foliage().leaves().len(), 2);
    // A selector decides nevertheless.
    let named = level.document().with_roles_of(&original);
    let named = named.into_tree(&["material:#1".parse().unwrap()]).unwrap();
    assert_eq!(named.foliage().leaves().len(), 1);
}

#[test]
fn one_card_drawn_many_times_is_many_leaves() {
    let mut tree = SmallTree::empty();
    let card = tree.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    tree.primitive(json!({"attributes": {"POSITION": card}}));
    let places: Vec<f32> = (0..60).map(|k| k as f32).collect();
    let places = tree.floats("VEC3", &places);
    let tree = tree.set(
        "/nodes/0/extensions",
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}),
    );
    let inspection = tree.document().inspect(&[]);
    assert_eq!(inspection.foliage.as_ref().unwrap().leaves, 20);
    let primitive = &inspection.primitives[0];
    assert_eq!(primitive.placements, 20);
    assert_eq!(
        primitive.reasons[0].text,
        "its only piece is small and flat, and drawn 20 times"
    );
}

/// A ball of `rings` rings of `rings` corners, without poles.
fn ball(rings: u16) -> (Vec<f32>, Vec<u16>) {
    let turn = |k: u16, whole: f32| f32::from(k) / f32::from(rings) * whole;
    let corners = (0..rings).flat_map(|ring| {
        let (sin, cos) = turn(2 * ring + 1, std::f32::consts::FRAC_PI_2).sin_cos();
        (0..rings).map(move |k| {
            let (z, x) = turn(k, std::f32::consts::TAU).sin_cos();
            [sin * x, cos, sin * z]
        })
    });
    let quads = (0..rings - 1).flat_map(|ring| (0..rings).map(move |k| (ring, k)));
    let triangles = quads.flat_map(|(ring, k)| {
        let [a, b] = [k, (k + 1) % rings].map(|k| ring * rings + k);
        [a, b, a + rings, b, b + rings, a + rings]
    });
    (corners.flatten().collect(), triangles.collect())
}

#[test]
fn lumps_are_no_leaves_whatever_their_name() {
    let mut tree = SmallTree::empty();
    for (material, (positions, indices)) in [ball(12), ball(8)].into_iter().enumerate() {
        let positions = tree.floats("VEC3", &positions);
        let indices = tree.shorts("SCALAR", &indices);
        tree.primitive(json!({
            "attributes": {"POSITION": positions}, "indices": indices, "material": material
        }));
    }
    let green = json!({"baseColorFactor": [0.1, 0.6, 0.1, 1.0]});
    let leaves = json!({"name": "leaves", "pbrMetallicRoughness": green});
    let tree = tree.set("/materials", json!([leaves, {"name": "stone"}]));
    let found = &tree.document().inspect(&[]).primitives[0];
    assert_eq!(found.taken_for, TakenFor::Wood);
    assert_eq!(
        found.reasons[0].text,
        "its only piece is round and of many triangles"
    );
}

#[test]
fn an_inspection_reads_well_and_is_json() {
    let inspection = quads_and_box().document().inspect(&[]);
    let text = inspection.to_string();
    for line in [
        "  leaves       20 of 40 triangles in all",
        "  a leaf       2 / 2 / 2 triangles (min / median / max)",
        "  wood         12 triangles",
        "    taken for foliage: +4 points",
        "      -3  only 0 % of its triangles are in small flat pieces",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    let json = serde_json::to_value(&inspection).unwrap();
    assert_eq!(json["foliage"]["leaves"], 20);
    assert_eq!(json["primitives"][0]["taken_for"], "foliage");
}

#[test]
fn skins_and_morph_targets_are_mentioned() {
    let tree = SmallTree::squares()
        .set("/nodes/0/skin", json!(0))
        .set("/meshes/0/primitives/0/targets", json!([{"POSITION": 0}]));
    let warnings = tree.tree().inspection().warnings.clone();
    assert_eq!(
        warnings,
        [
            "meshes[0].primitives[0]: is skinned; its bind pose is read",
            "meshes[0].primitives[0]: has morph targets; its shape at rest is read",
        ]
    );
}
