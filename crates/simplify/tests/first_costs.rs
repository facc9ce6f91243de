//! First costs against their definition, and the twins against each other.

use glam::DVec3;
use proptest::prelude::*;
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, RevealEdge, Scene, ViewSet, cpu};
use secateur_simplify::first_costs;

fn any_foliage() -> impl Strategy<Value = Foliage> {
    let unit = || [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array);
    let leaf = (unit(), [unit(), unit(), unit()], 0.05..1.0f64);
    proptest::collection::vec(leaf, 1..40).prop_map(|leaves| {
        let mut foliage = Foliage::default();
        for (at, corners, size) in leaves {
            let triangle = LeafTriangle::plain(corners.map(|p| at + p * size));
            foliage.push_leaf(&[triangle], None).unwrap();
        }
        foliage
    })
}

/// Edges and areas of a foliage in the given views.
fn seen(scene: &Scene<'_>) -> (Vec<RevealEdge>, AreaTable) {
    let fragments = cpu::fragments(scene);
    (cpu::reveal_edges(&fragments), cpu::areas(scene))
}

/// Eq. 4 by drawing the foliage without the leaf.
fn cost_by_drawing(scene: &Scene<'_>, leaf: LeafId, before: &Vmi, table: &LgTable) -> u64 {
    let mut lod = scene.lod.clone();
    lod.remove(leaf);
    let after = Vmi::of(
        &cpu::areas(&Scene {
            lod: &lod,
            ..*scene
        }),
        table,
    );
    let pairs = before.scaled().iter().zip(after.scaled());
    pairs.map(|(b, a)| b.abs_diff(*a)).sum()
}

#[test]
fn a_leaf_before_the_background_costs_what_it_tells() {
    // Two views of 64 pixels. Leaf 1 fills half of the first and is unseen in
    // the second, so S_1 = 32 and S_0 = 96. Without it both views are
    // background, which tells nothing: its cost is the VMI of both views,
    // P I = 64 + 32 (5 - 5) + 32 (5 - lg 96) and 64 + 64 (6 - lg 96).
    let areas = AreaTable::from_rows(1, vec![32, 32, 64, 0]);
    let edge = RevealEdge {
        front: 1,
        second: 0,
        view: 0,
        pixels: 32,
    };
    let cost = first_costs::on_cpu(&[edge], &areas, &LgTable::new())[0];
    let lg_96 = 96f64.log2();
    let first = 64.0 + 32.0 * (5.0 - lg_96);
    let second = 64.0 + 64.0 * (6.0 - lg_96);
    let expected = (first.abs() + second.abs()) * f64::from(1u32 << 27);
    assert!((cost as f64 - expected).abs() < 256.0, "{cost}, {expected}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn first_costs_are_the_change_of_vmi(foliage in any_foliage(), resolution in 4u32..80) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let lod = Lod::original(foliage.leaves().len());
        let scene = Scene { foliage: &foliage, lod: &lod, views: &views, resolution };
        let (edges, areas) = seen(&scene);
        let table = LgTable::new();
        let before = Vmi::of(&areas, &table);
        let costs = first_costs::on_cpu(&edges, &areas, &table);
        for (index, cost) in costs.into_iter().enumerate() {
            let leaf = LeafId::from_index(index);
            prop_assert_eq!(cost, cost_by_drawing(&scene, leaf, &before, &table), "{}", leaf);
        }
    }
}

#[cfg(feature = "gpu")]
mod gpu {
    use secateur_raster::gpu::{Device, Preference};

    use super::*;

    /// A device, or `None` with a word on why; a failure where
    /// `SECATEUR_REQUIRE_GPU=1` is set.
    fn device() -> Option<Device> {
        match Device::find(Preference::Any) {
            Ok(device) => Some(device),
            Err(error) => {
                let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
                assert!(!is_required, "SECATEUR_REQUIRE_GPU=1, but: {error}");
                eprintln!("GPU twins skipped: {error}");
                None
            }
        }
    }

    fn assert_twins(device: &Device, foliage: &Foliage, views: &ViewSet, resolution: u32) {
        let lod = Lod::original(foliage.leaves().len());
        let (edges, areas) = seen(&Scene {
            foliage,
            lod: &lod,
            views,
            resolution,
        });
        let table = LgTable::new();
        let costs = first_costs::on_gpu(device, &edges, &areas, &table).unwrap();
        assert_eq!(costs, first_costs::on_cpu(&edges, &areas, &table));
    }

    #[test]
    fn twins_are_equal_on_any_foliage() {
        let Some(device) = device() else { return };
        // At 256 x 256 the background's area is beyond the table of logarithms.
        let config = ProptestConfig::with_cases(24);
        proptest!(config, |(foliage in any_foliage(), large in any::<bool>())| {
            let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
            assert_twins(&device, &foliage, &views, if large { 256 } else { 33 });
        });
    }

    #[test]
    fn runs_of_few_leaves_change_nothing() {
        let Some(device) = device() else { return };
        // The areas of 6 views and 40 leaves fit, 984 bytes; the changes of 20
        // leaves do, and the edges of fewer.
        let device = device.with_binding_limit(1000);
        let config = ProptestConfig::with_cases(8);
        let columns = ViewSet::octahedron(secateur_model::BoundingSphere {
            centre: DVec3::ZERO,
            radius: 2.0,
        });
        proptest!(config, |(foliage in any_foliage())| {
            let lod = Lod::original(foliage.leaves().len());
            let scene = Scene { foliage: &foliage, lod: &lod, views: &columns, resolution: 16 };
            let (edges, areas) = seen(&scene);
            let table = LgTable::new();
            let costs = first_costs::on_gpu(&device, &edges, &areas, &table).unwrap();
            prop_assert_eq!(costs, first_costs::on_cpu(&edges, &areas, &table));
        });
    }

    #[test]
    fn a_foliage_without_leaves_has_no_costs() {
        let Some(device) = device() else { return };
        let areas = AreaTable::from_rows(0, vec![64, 64]);
        let costs = first_costs::on_gpu(&device, &[], &areas, &LgTable::new());
        assert_eq!(costs, Ok(Vec::new()));
    }
}
