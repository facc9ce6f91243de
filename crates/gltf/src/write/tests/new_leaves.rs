//! Levels with leaves that the input has not.

use glam::DVec3;
use serde_json::json;

use super::check::grid_error;
use super::encodings;
use super::fixture::{Fixture, UNSIGNED_BYTE, UNSIGNED_SHORT, read, square_indices, squares};
use super::validator::assert_valid;
use crate::Tree;
use crate::write::content::lod_content;
use secateur_model::{CornerRef, LeafId, Lod, NewCorner, NewLeaf, Place};

/// The first two leaves gone; in their place one that reaches from one to the
/// other, with the look of the second, and its last corner, unless it grows, where
/// none was.
fn one_of_two(tree: &Tree, area_scale: f64) -> (Lod, DVec3) {
    let leaf = |n| LeafId::new(n).unwrap();
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(leaf(1));
    lod.remove(leaf(2));
    let of = |n, corner, like| NewCorner {
        place: Place::Of(CornerRef {
            leaf: leaf(n),
            corner,
        }),
        like,
    };
    let apex = tree.foliage.leaf(leaf(1)).centre() + DVec3::new(0.25, 0.5, 0.75);
    let free = NewCorner {
        place: Place::At(apex),
        like: 2,
    };
    lod.make(NewLeaf {
        donor: leaf(2),
        triangles: vec![
            [of(1, 0, 0), of(2, 1, 1), free],
            [free, of(2, 1, 1), of(2, 2, 1)],
        ],
    });
    lod.resize(LeafId::from_index(tree.foliage.leaves().len()), area_scale);
    (lod, apex)
}

#[test]
fn a_new_leaf_has_its_places_and_the_look_of_its_donor() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let all = || encodings::all().into_iter();
    let sizes = [1.0, 2.25].into_iter();
    for (area_scale, (name, fixture)) in sizes.flat_map(|s| all().map(move |e| (s, e))) {
        eprintln!("{name}, {area_scale} times as large");
        let tree = fixture.tree();
        let (lod, apex) = one_of_two(&tree, area_scale);
        let path = folder.path().join(format!("{name}-{area_scale}.glb"));
        let written = tree.write_lod(&lod, &path).unwrap();
        let after = read(std::fs::read(&path).unwrap());
        files.push(path);
        assert_eq!(written.triangles, after.triangle_count(), "{name}");
        assert_eq!(after.foliage.leaves().len(), lod.leaf_count(), "{name}");

        let expected = lod.foliage(&tree.foliage);
        let made = expected.triangles_of(LeafId::from_index(lod.leaf_count() - 1));
        if area_scale == 1.0 {
            assert_eq!(made[0].corners[2], apex);
        }
        let size = tree.foliage.bounding_sphere().unwrap();
        let grid = grid_error(&tree, LeafId::new(1).unwrap());
        let tolerance = 1e-6 * (size.radius + size.centre.length()) + grid;
        let is_made = |leaf: &LeafId| {
            let found = after.foliage.triangles_of(*leaf);
            let pairs = made.iter().zip(found);
            found.len() == made.len()
                && pairs.clone().all(|(m, f)| m.uvs == f.uvs)
                && pairs
                    .flat_map(|(m, f)| m.corners.into_iter().zip(f.corners))
                    .all(|(m, f)| m.distance(f) <= tolerance)
        };
        let leaves = (0..lod.leaf_count()).map(LeafId::from_index);
        assert_eq!(leaves.filter(is_made).count(), 1, "{name}");
    }
    assert_valid(&files);
}

/// Every leaf cut down to its first triangle, which becomes `scale` times as large as
/// it was about its first corner, another scale for the first leaf.
fn cut_down(tree: &Tree, scale_of_first: f64) -> Lod {
    let count = tree.foliage.leaves().len();
    let mut lod = Lod::original(count);
    for donor in (0..count).map(LeafId::from_index) {
        let scale = if donor.index() == 0 {
            scale_of_first
        } else {
            2.0
        };
        let corners = tree.foliage.triangles_of(donor)[0].corners;
        let corner = |k: usize| NewCorner {
            place: Place::At(corners[0] + scale * (corners[k] - corners[0])),
            like: k as u32,
        };
        lod.remove(donor);
        lod.make(NewLeaf {
            donor,
            triangles: vec![[0, 1, 2].map(corner)],
        });
    }
    lod
}

#[test]
fn places_whose_new_leaves_agree_share_a_mesh() {
    for (name, fixture) in [
        ("instanced leaf", encodings::instanced_leaf()),
        ("instanced twig", encodings::instanced_twig()),
        ("shared leaf", encodings::shared_leaf()),
        ("shared twig", encodings::shared_twig()),
    ] {
        let tree = fixture.tree();
        for (scale_of_first, added) in [(2.0, 0), (3.0, 1)] {
            let lod = cut_down(&tree, scale_of_first);
            let after = read(tree.lod_to_bytes(&lod).unwrap());
            let meshes = |tree: &Tree| tree.document.root["meshes"].as_array().unwrap().len();
            // Instances that differ are one mesh in the place of the old one.
            let added = match name.starts_with("instanced") {
                true => 0,
                false => added,
            };
            assert_eq!(meshes(&after), meshes(&tree) + added, "{name}");
            let area = |foliage: &secateur_model::Foliage| {
                let mut areas: Vec<f64> = foliage.leaves().iter().map(|l| l.area()).collect();
                areas.sort_by(f64::total_cmp);
                areas
            };
            let expected = area(&lod.foliage(&tree.foliage));
            let found = area(&after.foliage);
            assert_eq!(found.len(), expected.len(), "{name}");
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-5, "{name}");
            }
        }
    }
}

/// The first leaf gone; in its place a triangle in its plane, twice as far out about the
/// first corner of its own first triangle.
pub(super) fn beyond_its_corners(tree: &Tree) -> Lod {
    let leaf = LeafId::new(1).unwrap();
    let corner = |weights, like| NewCorner {
        place: Place::InPlaneOf {
            corners: [0, 1, 2],
            weights,
        },
        like,
    };
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(leaf);
    lod.make(NewLeaf {
        donor: leaf,
        triangles: vec![[
            corner([1.0, 0.0, 0.0], 0),
            corner([-1.0, 2.0, 0.0], 1),
            corner([-1.0, 0.0, 2.0], 2),
        ]],
    });
    lod
}

#[test]
fn a_texture_goes_on_beyond_the_corners_of_its_triangle() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let mut textured = 0;
    for (name, fixture) in encodings::all() {
        let tree = fixture.tree();
        let lod = beyond_its_corners(&tree);
        let path = folder.path().join(format!("{name}.glb"));
        tree.write_lod(&lod, &path).unwrap();
        let after = read(std::fs::read(&path).unwrap());
        files.push(path);

        let before = tree.foliage.triangles()[0];
        let expected = lod.foliage(&tree.foliage);
        let made = expected.triangles().last().unwrap();
        for k in 0..3 {
            let out = if k == 0 { 1.0 } else { 2.0 };
            let uv = before.uvs[0] + out * (before.uvs[k] - before.uvs[0]);
            assert!(made.uvs[k].distance(uv) < 1e-12, "{name}");
        }
        let size = tree.foliage.bounding_sphere().unwrap();
        let tolerance = 1e-6 * (size.radius + size.centre.length());
        let is_made = |found: &&secateur_model::LeafTriangle| {
            (0..3).all(|k| {
                made.corners[k].distance(found.corners[k]) <= tolerance
                    && made.uvs[k].distance(found.uvs[k]) <= 1e-6
            })
        };
        let count = after.foliage.triangles().iter().filter(is_made).count();
        assert_eq!(count, 1, "{name}");
        textured += usize::from(before.uvs[0] != before.uvs[1]);
    }
    assert!(textured > 0);
    assert_valid(&files);
}

#[test]
fn morph_targets_move_new_leaves_with_their_donors() {
    let tree = encodings::morphed().tree();
    let displacements = |lod: &Lod| -> Vec<f64> {
        let after = read(tree.lod_to_bytes(lod).unwrap());
        let primitive = &after.document.root["meshes"][1]["primitives"][0];
        let number = primitive["targets"][0]["POSITION"].as_u64().unwrap();
        let elements = after.document.elements(number as usize).unwrap();
        elements.vectors::<3>().map(|[_, _, z]| z).collect()
    };
    // Vertex k goes up by k + 0.5; the first triangle is of the first three.
    let [a, b, c] = tree.document.triangles(1, 0).unwrap()[0].map(|k| f64::from(k) + 0.5);
    let found = displacements(&beyond_its_corners(&tree));
    assert_eq!(found[..3], [a, 2.0 * b - a, 2.0 * c - a]);
    // Corners 0, 1 and 2 of the second leaf, as it is and grown.
    let [a, b, c] = tree.document.triangles(1, 0).unwrap()[2].map(|k| f64::from(k) + 0.5);
    for area_scale in [1.0, 2.25] {
        let found = displacements(&one_of_two(&tree, area_scale).0);
        let mut made: Vec<f64> = found.into_iter().filter(|z| *z < 8.0).collect();
        made.sort_by(f64::total_cmp);
        assert_eq!(made, [a, b, b, c]);
    }
}

#[test]
fn every_set_of_texture_coordinates_and_the_normals_go_on() {
    let tree = encodings::rich().tree();
    let lod = beyond_its_corners(&tree);
    let content = lod_content(&tree, &lod, &crate::Cutoffs::default()).unwrap();
    let became_f32 = |note: &String| note.contains("became f32");
    assert!(!content.notes.iter().any(became_f32), "they stay 16 bits");
    let after = read(tree.lod_to_bytes(&lod).unwrap());
    let of = |tree: &Tree, semantic: &str| -> Vec<DVec3> {
        let primitive = &tree.document.root["meshes"][1]["primitives"][0];
        let number = primitive["attributes"][semantic].as_u64().unwrap();
        let elements = tree.document.elements(number as usize).unwrap();
        match semantic {
            "NORMAL" => elements.vectors::<3>().map(DVec3::from_array).collect(),
            _ => elements
                .vectors::<2>()
                .map(|[u, v]| DVec3::new(u, v, 0.0))
                .collect(),
        }
    };
    let triangle = tree.document.triangles(1, 0).unwrap()[0].map(|vertex| vertex as usize);
    for semantic in ["TEXCOORD_0", "TEXCOORD_1", "NORMAL"] {
        let before = of(&tree, semantic);
        let [a, b, c] = triangle.map(|vertex| before[vertex]);
        let sums = [a, 2.0 * b - a, 2.0 * c - a];
        assert!(sums[1].distance(b) > 1e-3, "{semantic} differs by vertex");
        let expected = match semantic {
            "NORMAL" => sums.map(DVec3::normalize),
            _ => sums,
        };
        let found = of(&after, semantic);
        for sum in expected {
            let is_there = |vector: &DVec3| vector.distance(sum) < 1.2e-5;
            assert!(found.iter().any(is_there), "{semantic}: {sum} of {found:?}");
        }
    }
}

/// A triangle in the plane of corners of different triangles of its donor.
#[test]
fn the_plane_of_a_new_leaf_may_be_of_corners_of_several_triangles() {
    let fixture = encodings::rich();
    let tree = fixture.tree();
    let of_leaf = |leaf: &LeafId| tree.foliage.triangles_of(*leaf).len() >= 2;
    let mut leaves = (0..tree.foliage.leaves().len()).map(LeafId::from_index);
    let leaf = leaves.find(of_leaf).expect("a leaf of two triangles");
    let of_donor = tree.foliage.triangles_of(leaf);
    let at = |corner: u32| {
        let triangle = &of_donor[corner as usize / 3];
        let k = corner as usize % 3;
        (triangle.corners[k], triangle.uvs[k])
    };
    let is_new = |corner: &u32| (0..3).all(|first| at(first).0.distance(at(*corner).0) > 1e-3);
    let beyond = (3..6).find(is_new).expect("a corner of the second alone");
    let plane = [0, 1, beyond];
    let corner = |weights, like| NewCorner {
        place: Place::InPlaneOf {
            corners: plane,
            weights,
        },
        like,
    };
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(leaf);
    lod.make(NewLeaf {
        donor: leaf,
        triangles: vec![[
            corner([1.5, 0.0, -0.5], 0),
            corner([0.0, 1.0, 0.0], 1),
            corner([-0.5, 0.0, 1.5], 2),
        ]],
    });
    let after = read(tree.lod_to_bytes(&lod).unwrap());
    let (a, c) = (at(0), at(beyond));
    let at = (1.5 * a.0 - 0.5 * c.0, 1.5 * a.1 - 0.5 * c.1);
    let is_there = |triangle: &secateur_model::LeafTriangle| {
        let mut corners = triangle.corners.iter().zip(&triangle.uvs);
        corners.any(|(p, uv)| p.distance(at.0) < 1e-5 && uv.distance(at.1) < 1e-5)
    };
    assert!(after.foliage.triangles().iter().any(is_there));
}

/// What coarser wood is: triangles between corners of the piece that was, some of them gone.
#[test]
fn vertices_of_what_is_made_of_old_corners_keep_their_skin() {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(4));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    let joints: Vec<f64> = (0..16).flat_map(|_| [0.0, 1.0, 0.0, 0.0]).collect();
    let joints = fixture.elements(UNSIGNED_BYTE, 4, &joints);
    // Each vertex has other weights.
    let weights: Vec<[f32; 4]> = (0..16u8)
        .map(|k| f32::from(k) / 16.0)
        .map(|w| [w, 1.0 - w, 0.0, 0.0])
        .collect();
    let weights = fixture.vectors(&weights);
    let attributes = &mut fixture.leaf_primitive()["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    let joints = [nodes.len(), nodes.len() + 1];
    nodes.extend([json!({"name": "root"}), json!({"name": "tip"})]);
    nodes[2]["skin"] = 0.into();
    fixture.root["skins"] = json!([{"joints": joints}]);
    let tree = fixture.tree();

    let piece = LeafId::new(2).unwrap();
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(piece);
    let of = |corner| NewCorner {
        place: Place::Of(CornerRef {
            leaf: piece,
            corner,
        }),
        like: corner,
    };
    lod.make(NewLeaf {
        donor: piece,
        triangles: vec![[of(0), of(1), of(5)]],
    });
    let after = read(tree.lod_to_bytes(&lod).unwrap());
    let vertices = |tree: &Tree| -> Vec<[Vec<u8>; 3]> {
        let part = tree
            .parts
            .iter()
            .find(|part| part.role == crate::roles::Role::Leaf)
            .unwrap();
        let document = &tree.document;
        let primitive = document.primitive(part.mesh, part.primitive).unwrap();
        let of = |name: &str| {
            let accessor = primitive["attributes"][name].as_u64().unwrap() as usize;
            let elements = document.elements(accessor).unwrap();
            let size = elements.accessor.element_bytes();
            elements
                .bytes
                .chunks(size)
                .map(<[u8]>::to_vec)
                .collect::<Vec<_>>()
        };
        let [places, joints, weights] = ["POSITION", "JOINTS_0", "WEIGHTS_0"].map(of);
        let all = places.into_iter().zip(joints).zip(weights);
        all.map(|((place, joints), weights)| [place, joints, weights])
            .collect()
    };
    let (before, now) = (vertices(&tree), vertices(&after));
    assert_eq!(before.len(), now.len() + 1);
    assert!(now.iter().all(|vertex| before.contains(vertex)));
}

/// Bark without normals says nothing of leaves that have some, when both are asked for and again.
#[test]
fn each_part_has_normals_of_its_own() {
    let mut fixture = Fixture::new();
    let attributes = json!({
        "POSITION": fixture.vectors(&squares(1)),
        "NORMAL": fixture.vectors(&[[0.0, 0.0, 1.0]; 4]),
    });
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(1));
    let tree = fixture.with_leaves(attributes, Some(indices)).tree();
    let has_normals = [0, 1, 0, 1].map(|number| {
        let (part, document) = (&tree.parts[number], &tree.document);
        let primitive = document.primitive(part.mesh, part.primitive).unwrap();
        let triangles = document.triangles(part.mesh, part.primitive).unwrap();
        let known = &tree.old_normals;
        let normals = known.of_part(number, document, primitive, &triangles);
        normals.unwrap().is_some()
    });
    assert_eq!(has_normals, [false, true, false, true]);
}
