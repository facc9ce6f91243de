//! GPU twins against CPU twins, bit for bit.
//!
//! Without an adapter these tests say so and pass, unless
//! `SECATEUR_REQUIRE_GPU=1` is set.
#![cfg(feature = "gpu")]

mod limits;
mod scenes;
mod sizes;

use std::sync::OnceLock;

use secateur_model::{Foliage, Lod};
use secateur_raster::gpu::{self, Device, Preference};
use secateur_raster::{Scene, ViewSet, cpu};

/// The device of all tests, or `None` with a word on why.
fn device() -> Option<&'static Device> {
    static DEVICE: OnceLock<Option<Device>> = OnceLock::new();
    DEVICE.get_or_init(open).as_ref()
}

fn open() -> Option<Device> {
    match Device::find(Preference::Any) {
        Ok(device) => {
            eprintln!(
                "GPU twins run on {} ({})",
                device.adapter(),
                device.driver()
            );
            Some(device)
        }
        Err(error) => {
            let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
            assert!(!is_required, "SECATEUR_REQUIRE_GPU=1, but: {error}");
            eprintln!("GPU twins skipped: {error}");
            None
        }
    }
}

/// Asserts that every stage gives what its CPU twin gives.
fn assert_twins(device: &Device, scene: &Scene<'_>) {
    let (expected, areas_of_heads) = cpu::fragments_and_areas(scene);
    let expected_areas = cpu::areas(scene);
    assert_eq!(
        areas_of_heads, expected_areas,
        "areas of the CPU's A-buffer"
    );
    let (fragments, areas) = gpu::fragments_and_areas(device, scene).unwrap();
    assert_eq!(fragments.len(), expected.len(), "fragments over all views");
    assert!(fragments == expected, "fragments differ");
    assert_eq!(areas, expected_areas, "areas of the A-buffer");
    assert_eq!(
        gpu::areas(device, scene).unwrap(),
        expected_areas,
        "areas drawn"
    );
    let images = gpu::leaf_ids(device, scene).unwrap();
    assert_eq!(images.len(), scene.views.len());
    for (view, image) in images.iter().enumerate() {
        assert!(*image == expected.leaf_ids(view), "image of view {view}");
    }
}

/// [`assert_twins`] for leaves at their original sizes.
fn assert_original_twins(foliage: &Foliage, views: &ViewSet, resolution: u32) {
    let Some(device) = device() else { return };
    let lod = Lod::original(foliage.leaves().len());
    assert_twins(
        device,
        &Scene {
            foliage,
            lod: &lod,
            views,
            resolution,
        },
    );
}
