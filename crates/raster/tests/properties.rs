//! What must hold for any foliage.

use glam::DVec3;
use proptest::prelude::*;
use secateur_model::{Foliage, LeafTriangle, Lod};
use secateur_raster::snap::Snapper;
use secateur_raster::{AreaTable, MAX_RESOLUTION, Scene, View, ViewSet, cpu};

fn corner() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        4 => [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array),
        // On a coarse grid, where edges, depths and corners coincide.
        1 => [-4i32..5, -4i32..5, -4i32..5]
            .prop_map(|p| DVec3::from_array(p.map(|c| f64::from(c) / 4.0))),
    ]
}

fn any_foliage(leaves: std::ops::Range<usize>) -> impl Strategy<Value = Foliage> {
    let leaf = (
        corner(),
        [corner(), corner(), corner(), corner()],
        0.01..1.0f64,
        1..3usize,
    );
    proptest::collection::vec(leaf, leaves).prop_map(|leaves| {
        let mut foliage = Foliage::default();
        for (at, corners, size, count) in leaves {
            let [a, b, c, d] = corners.map(|p| at + p * size);
            let triangles = [[a, b, c], [a, c, d]].map(LeafTriangle::plain);
            foliage.push_leaf(&triangles[..count], None).unwrap();
        }
        foliage
    })
}

fn moved(foliage: &Foliage, by: impl Fn(DVec3) -> DVec3) -> Foliage {
    let mut moved = Foliage::default();
    for leaf in 0..foliage.leaves().len() {
        let id = secateur_model::LeafId::from_index(leaf);
        let triangles: Vec<LeafTriangle> = foliage
            .triangles_of(id)
            .iter()
            .map(|t| LeafTriangle::plain(t.corners.map(&by)))
            .collect();
        moved.push_leaf(&triangles, None).unwrap();
    }
    moved
}

fn areas(foliage: &Foliage, resolution: u32) -> AreaTable {
    let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
    cpu::areas(&Scene {
        foliage,
        lod: &Lod::original(foliage.leaves().len()),
        views: &views,
        resolution,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn drawing_and_a_buffer_agree_and_areas_sum_to_the_pixels(
        foliage in any_foliage(1..40),
        resolution in 1u32..70,
    ) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let lod = Lod::original(foliage.leaves().len());
        let scene = Scene { foliage: &foliage, lod: &lod, views: &views, resolution };
        let fragments = cpu::fragments(&scene);
        for (v, view) in views.views().iter().enumerate() {
            let image = cpu::draw_leaf_ids(&scene, view);
            prop_assert_eq!(&image, &fragments.leaf_ids(v));
            let row = cpu::histogram(&image, foliage.leaves().len());
            prop_assert_eq!(row.iter().sum::<u32>(), resolution * resolution);
        }
        for list in fragments.views().iter().flat_map(|view| view.pixels()) {
            prop_assert!(list.is_sorted());
            let mut leaves: Vec<u32> = list.iter().map(|f| f.leaf()).collect();
            leaves.sort_unstable();
            leaves.dedup();
            prop_assert_eq!(leaves.len(), list.len(), "a leaf once a pixel");
        }
    }

    #[test]
    fn a_power_of_two_changes_nothing(foliage in any_foliage(1..20), power in -40i32..40) {
        let scale = 2f64.powi(power);
        let scaled = moved(&foliage, |p| p * scale);
        prop_assert_eq!(areas(&foliage, 64), areas(&scaled, 64));
    }

    #[test]
    fn moving_changes_only_rounding(foliage in any_foliage(1..20), offset in corner()) {
        let there = areas(&moved(&foliage, |p| p + offset * 1e3), 64);
        let here = areas(&foliage, 64);
        let differing: u32 = here.as_slice().iter().zip(there.as_slice())
            .map(|(a, b)| a.abs_diff(*b)).sum();
        // Corners move by 1e-13 of the image; a grid step is 6e-5 of it, so a
        // corner near the border of two steps may snap the other way and turn
        // a pixel or two along its edges.
        prop_assert!(differing <= 40, "{differing} pixels of {}", 6 * 64 * 64);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Corners up to a quarter beyond the edges of the largest image.
    #[test]
    fn a_leaf_may_cross_the_largest_image(
        corners in prop::array::uniform4([-1.25..1.25f64, -1.25..1.25, -3.0..-1.0]),
    ) {
        let [a, b, c, d] = corners.map(|[x, y, z]| DVec3::new(-x * z, -y * z, z));
        let triangles = [[a, b, c], [a, c, d]].map(LeafTriangle::plain);
        let mut foliage = Foliage::default();
        let leaf = foliage.push_leaf(&triangles, None).unwrap();
        let view = View::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 1.0, 0.5).unwrap();
        let size = MAX_RESOLUTION;
        let mut expected = vec![u32::MAX; (size * size) as usize];
        Snapper::new(&view, size).snap_leaf(1, foliage.leaf(leaf), &triangles, 1.0, None, |t| {
            cpu::rasterise(t, &[], |x, y, depth| {
                let known = &mut expected[(y * size + x) as usize];
                *known = (*known).min(depth);
            });
        });
        let mut found = vec![u32::MAX; expected.len()];
        for (pixel, depth) in cpu::LeafFragments::new(size).of(&foliage, leaf, 1.0, &[view]) {
            found[*pixel as usize] = *depth;
        }
        prop_assert!(found == expected);
    }
}
