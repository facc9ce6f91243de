//! Leaves and wood in one primitive, and plants without leaves.

use std::f32::consts::TAU;

use secateur_gltf::{Detail, Document, TakenFor};
use secateur_model::{LeafId, Lod};
use serde_json::json;

use crate::small_tree::SmallTree;

const LEAVES: usize = 20;
const SIDES: usize = 8;

/// Twenty cards of 1 m about a trunk that ends 6 m high, in one primitive with one texture: its left half is leaf, of
/// which half is clear, its right half bark.
#[derive(Debug)]
struct Atlas {
    lowest_leaf: f32,
    trunk_foot: f32,
    /// Where in the texture the trunk has its bark from.
    bark_u: [f32; 2],
    alpha: &'static str,
    /// How many sides the trunk has; with two it is flat.
    sides: usize,
}

/// A trunk from the ground under a crown.
const STANDING: Atlas = Atlas {
    lowest_leaf: 4.0,
    trunk_foot: 0.0,
    bark_u: [0.55, 0.95],
    alpha: "MASK",
    sides: SIDES,
};

impl Atlas {
    fn tree(&self) -> SmallTree {
        let mut tree = SmallTree::empty();
        let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..LEAVES {
            let (x, y) = (
                3.0 * (k % 5) as f32 - 6.0,
                self.lowest_leaf + 1.25 * (k / 5) as f32,
            );
            let first = 4 * k as u16;
            for corner in 0..4u8 {
                let [u, v] = [f32::from(corner & 1), f32::from(corner >> 1)];
                positions.extend([x + u, y + v, 0.1]);
                uvs.extend([0.5 * u, v]);
            }
            indices.extend([0, 1, 2, 2, 1, 3].map(|corner| first + corner));
        }
        let first = 4 * LEAVES;
        for k in 0..=self.sides {
            let (sin, cos) = (k as f32 / self.sides as f32 * TAU).sin_cos();
            for y in [self.trunk_foot, 6.0] {
                let [left, right] = self.bark_u;
                positions.extend([0.3 * cos, y, 0.3 * sin]);
                uvs.extend([
                    left + (right - left) * k as f32 / self.sides as f32,
                    y / 6.0,
                ]);
            }
        }
        for k in 0..self.sides {
            let corners = [0, 1, 2, 2, 1, 3].map(|corner| (first + 2 * k + corner) as u16);
            indices.extend(corners);
        }
        let accessors = json!({
            "POSITION": tree.floats("VEC3", &positions),
            "TEXCOORD_0": tree.floats("VEC2", &uvs),
        });
        let indices = tree.shorts("SCALAR", &indices);
        tree.primitive(json!({"attributes": accessors, "indices": indices, "material": 0}));
        tree.texture(&image::RgbaImage::from_fn(4, 1, |x, _| {
            image::Rgba([60, 99, 20, if x == 1 { 0 } else { 255 }])
        }));
        let pbr = json!({"baseColorTexture": {"index": 0}});
        let material =
            json!({"name": "tree", "alphaMode": self.alpha, "pbrMetallicRoughness": pbr});
        tree.set("/materials", json!([material]))
    }
}

#[test]
fn a_trunk_among_leaves_is_wood() {
    let whole = STANDING.tree().document().into_whole_tree(&[]).unwrap();
    assert_eq!(whole.leaves().leaves().len(), LEAVES);
    assert_eq!(whole.wood().leaves().len(), 1);
    assert_eq!(whole.wood().triangles().len(), 2 * SIDES);
    let inspection = whole.items().inspection();
    assert_eq!(inspection.primitives[0].taken_for, TakenFor::FoliageInPart);
    assert_eq!(inspection.wood_triangles, 2 * SIDES as u64);
    assert!(inspection.warnings.is_empty(), "{:?}", inspection.warnings);
}

/// What hangs in the air, what the texture cuts, and what no alpha test cuts.
#[test]
fn pieces_that_nothing_speaks_for_stay_leaves() {
    let hangs = Atlas {
        lowest_leaf: 0.0,
        trunk_foot: 3.0,
        ..STANDING
    };
    let cut = Atlas {
        bark_u: [0.05, 0.45],
        ..STANDING
    };
    let opaque = Atlas {
        alpha: "OPAQUE",
        ..STANDING
    };
    for atlas in [hangs, cut, opaque] {
        let inspection = atlas.tree().document().inspect(&[]);
        let taken = inspection.primitives[0].taken_for;
        assert_ne!(taken, TakenFor::FoliageInPart, "{atlas:?}");
    }
}

#[test]
fn whoever_names_the_leaves_gets_all_of_them() {
    for selector in ["material:tree", "all"] {
        let selectors = [selector.parse().unwrap()];
        let named = STANDING.tree().document().into_tree(&selectors).unwrap();
        assert_eq!(named.foliage().leaves().len(), LEAVES + 1, "{selector}");
    }
}

#[test]
fn what_is_drawn_is_told_apart_too() {
    let tree = STANDING.tree().document().into_tree(&[]).unwrap();
    let drawn = tree.drawn(Detail::Color).unwrap();
    let counts = drawn
        .iter()
        .map(|d| (d.is_foliage, d.surface.triangles.len()));
    let counts: Vec<(bool, usize)> = counts.collect();
    assert_eq!(counts, [(false, 2 * SIDES), (true, 2 * LEAVES)]);
    let whole = STANDING.tree().document().into_whole_tree(&[]).unwrap();
    let items = whole.items();
    let surfaces = items.leaf_surfaces(Detail::Color).unwrap();
    let mut seen = 0;
    for leaf_surface in &surfaces {
        let surface = &leaf_surface.surface;
        for leaf in &leaf_surface.leaves {
            let own = items.foliage().triangles_of(leaf.leaf);
            assert_eq!(own.len(), leaf.triangles.len());
            for (triangle, number) in own.iter().zip(&leaf.triangles) {
                let corners = surface.triangles[*number as usize];
                let placed = corners.map(|corner| surface.positions[corner as usize]);
                assert_eq!(placed, triangle.corners);
            }
            seen += 1;
        }
    }
    assert_eq!(seen, LEAVES + 1);
}

#[test]
fn the_trunk_stays_where_leaves_go() {
    let tree = STANDING.tree().document().into_tree(&[]).unwrap();
    let mut lod = Lod::original(LEAVES);
    for leaf in 2..LEAVES {
        lod.remove(LeafId::from_index(leaf));
    }
    let glb = tree.lod_to_bytes(&lod).unwrap();
    let level = Document::from_bytes("level.glb", glb, None).unwrap();
    let level = level.into_whole_tree(&[]).unwrap();
    assert_eq!(level.leaves().leaves().len(), 2);
    let whole = STANDING.tree().document().into_whole_tree(&[]).unwrap();
    assert_eq!(level.wood().triangles(), whole.wood().triangles());
}

#[test]
fn a_plant_may_have_no_leaves() {
    let mut tree = SmallTree::empty();
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 3.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let positions = tree.floats("VEC3", corners.as_flattened());
    let indices = tree.shorts("SCALAR", &[0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3]);
    tree.primitive(json!({
        "attributes": {"POSITION": positions}, "indices": indices, "material": 0
    }));
    let tree = tree.set("/materials", json!([{"name": "bark"}]));
    let whole = tree.document().into_whole_tree(&[]).unwrap();
    assert!(whole.leaves().leaves().is_empty());
    assert_eq!(whole.wood().triangles().len(), 4);
    let inspection = whole.items().inspection();
    let [note] = &inspection.notes[..] else {
        panic!("one note is said");
    };
    assert_eq!(
        note,
        "no leaves were found: all of it is taken for solid surface"
    );
    assert_eq!(inspection.candidates, ["all"]);
    assert!(tree.document().inspect(&[]).problem.is_none());
}

/// A tenth of its triangles or more could be leaves, and nothing else is.
#[test]
fn what_is_cut_out_is_foliage_where_nothing_else_is() {
    let bush = Atlas {
        bark_u: [0.05, 0.45],
        ..STANDING
    };
    let inspection = bush.tree().document().inspect(&[]);
    assert_eq!(inspection.primitives[0].taken_for, TakenFor::Foliage);
}

/// A coarse trunk may be flat, as leaves are.
#[test]
fn wood_of_a_level_is_known_from_its_plant() {
    let original = STANDING.tree().document().into_tree(&[]).unwrap();
    let flat = Atlas {
        sides: 2,
        ..STANDING
    };
    let wood_triangles = |document: Document| {
        let whole = document.into_whole_tree(&[]).unwrap();
        whole.wood().triangles().len()
    };
    assert_eq!(wood_triangles(flat.tree().document()), 0);
    let known = flat.tree().document().with_roles_of(&original);
    assert_eq!(wood_triangles(known), 4);
}
