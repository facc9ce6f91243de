//! Any scene: leaves and cut-outs of any kind at any size.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use secateur_model::{Cutout, Foliage, LeafId, LeafTriangle, Lod, Wrap};
use secateur_raster::gpu::split_into_tiles;
use secateur_raster::snap::Snapper;
use secateur_raster::{Scene, ViewSet, cpu};

use super::{assert_twins, device};

fn corner() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        4 => [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array),
        // On a coarse grid, where edges, depths and corners coincide.
        1 => [-4i32..5, -4i32..5, -4i32..5]
            .prop_map(|p| DVec3::from_array(p.map(|c| f64::from(c) / 4.0))),
    ]
}

fn wrap() -> impl Strategy<Value = Wrap> {
    prop_oneof![
        Just(Wrap::Repeat),
        Just(Wrap::ClampToEdge),
        Just(Wrap::MirroredRepeat)
    ]
}

fn cutout() -> impl Strategy<Value = Arc<Cutout>> {
    ([1u32..40, 1u32..40], [wrap(), wrap()], any::<u64>()).prop_map(|(size, wrap, bits)| {
        Arc::new(Cutout::from_fn(size, wrap, |x, y| {
            bits >> ((x * 7 + y * 13) % 64) & 1 == 1
        }))
    })
}

type AnyLeaf = (DVec3, [DVec3; 4], f64, Option<usize>, [f64; 8], Option<f64>);

fn leaf() -> impl Strategy<Value = AnyLeaf> {
    (
        corner(),
        [corner(), corner(), corner(), corner()],
        0.01..1.5f64,
        proptest::option::of(0usize..3),
        prop::array::uniform8(-3.0..3.0f64),
        proptest::option::weighted(0.9, prop_oneof![Just(1.0), 0.1..9.0f64]),
    )
}

/// Quads, not always flat, so that a leaf may cover a pixel twice.
pub(super) fn any_world(leaves: std::ops::Range<usize>) -> impl Strategy<Value = (Foliage, Lod)> {
    let cutouts = prop::array::uniform3(cutout());
    (cutouts, proptest::collection::vec(leaf(), leaves)).prop_map(|(cutouts, leaves)| {
        let mut foliage = Foliage::new(cutouts.to_vec());
        let mut lod = Lod::original(leaves.len());
        for (at, corners, size, cutout, uvs, area_scale) in leaves {
            let p = corners.map(|p| at + p * size);
            let t = [0, 2, 4, 6].map(|k| DVec2::new(uvs[k], uvs[k + 1]));
            let triangles = [[0, 1, 2], [0, 2, 3]].map(|k| LeafTriangle {
                corners: k.map(|k| p[k]),
                uvs: k.map(|k| t[k]),
            });
            let id = foliage
                .push_leaf(&triangles, cutout.map(|c| c as u32))
                .unwrap();
            match area_scale {
                None => lod.remove(id),
                Some(scale) => lod.resize(id, scale),
            }
        }
        (foliage, lod)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_scene_has_equal_twins((foliage, lod) in any_world(1..60), resolution in 1u32..100) {
        let Some(device) = device() else { return Ok(()) };
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        assert_twins(device, &Scene { foliage: &foliage, lod: &lod, views: &views, resolution });
    }

    #[test]
    fn tiles_cover_what_the_triangle_covers((foliage, _) in any_world(1..6), tile_px in 1u32..70) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let snapper = Snapper::new(&views.views()[0], 200);
        for index in 0..foliage.leaves().len() {
            let leaf = LeafId::from_index(index);
            let geometry = foliage.leaf(leaf);
            let cutout = geometry.cutout().map(|c| &*foliage.cutouts()[c as usize]);
            let triangles = foliage.triangles_of(leaf);
            snapper.snap_leaf(leaf.get(), geometry, triangles, 1.0, cutout, |whole| {
                let mut expected = Vec::new();
                cpu::rasterise(whole, foliage.cutouts(), |x, y, d| expected.push((y, x, d)));
                let mut found = Vec::new();
                split_into_tiles(whole, tile_px, |tile| {
                    let sides = [tile.size & 0xFFFF, tile.size >> 16];
                    assert!(sides.iter().all(|side| (1..=tile_px).contains(side)));
                    cpu::rasterise(tile, foliage.cutouts(), |x, y, d| found.push((y, x, d)));
                });
                found.sort_unstable();
                assert_eq!(found, expected);
            });
        }
    }

    #[test]
    fn a_leaf_is_what_its_triangles_cover(
        (foliage, lod) in any_world(1..6),
        resolution in prop_oneof![1u32..40, 100u32..300],
    ) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let mut leaf_fragments = cpu::LeafFragments::new(resolution);
        for (leaf, area_scale) in lod.leaves() {
            let geometry = foliage.leaf(leaf);
            let cutout = geometry.cutout().map(|c| &*foliage.cutouts()[c as usize]);
            let triangles = foliage.triangles_of(leaf);
            let mut expected = BTreeMap::new();
            for (first_row, view) in (0..).step_by(resolution as usize).zip(views.views()) {
                let snapper = Snapper::new(view, resolution);
                snapper.snap_leaf(leaf.get(), geometry, triangles, area_scale, cutout, |triangle| {
                    cpu::rasterise(triangle, foliage.cutouts(), |x, y, depth| {
                        let known = expected.entry((first_row + y) * resolution + x).or_insert(depth);
                        *known = (*known).min(depth);
                    });
                });
            }
            let found = leaf_fragments.of(&foliage, leaf, area_scale, views.views());
            prop_assert_eq!(found, expected.into_iter().collect::<Vec<_>>());
        }
    }
}
