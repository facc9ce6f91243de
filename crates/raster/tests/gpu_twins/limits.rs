//! What the device can take at once, and what it cannot.

use secateur_raster::gpu::{self, Device, GpuError, Preference, wgpu};
use secateur_raster::{Scene, ViewSet};

use proptest::prelude::*;

use super::scenes::any_world;
use super::{assert_twins, device};

fn small_device(binding_limit: u64) -> Option<Device> {
    device()?;
    Some(
        Device::find(Preference::Any)
            .unwrap()
            .with_binding_limit(binding_limit),
    )
}

#[test]
fn chunks_and_windows_change_nothing() {
    // A view of 40 x 40 pixels takes 6,404 bytes: one view a chunk, and lists
    // of at most 1,000 fragments a window.
    let Some(small) = small_device(8_000) else {
        return;
    };
    let config = ProptestConfig::with_cases(12);
    proptest!(config, |((foliage, lod) in any_world(40..200))| {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let scene = Scene { foliage: &foliage, lod: &lod, views: &views, resolution: 40 };
        assert_twins(&small, &scene);
    });
}

#[test]
fn what_cannot_be_bound_is_refused_in_words() {
    let Some(small) = small_device(8_000) else {
        return;
    };
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let tree = any_world(100..101).new_tree(&mut runner).unwrap();
    let (foliage, lod) = proptest::strategy::ValueTree::current(&tree);
    let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
    let scene = Scene {
        foliage: &foliage,
        lod: &lod,
        views: &views,
        resolution: 64,
    };
    let too_large = GpuError::TooLarge {
        what: "the pixels of a view",
        bytes: 4 * (64 * 64 + 1),
        limit: 8_000,
    };
    assert_eq!(gpu::fragments(&small, &scene), Err(too_large.clone()));
    assert_eq!(gpu::areas(&small, &scene), Err(too_large.clone()));
    assert_eq!(
        too_large.to_string(),
        "the pixels of a view need 16388 bytes, and the GPU reads at most 8000 at once; \
         run on the CPU"
    );
}

#[test]
fn a_device_of_ones_own_serves() {
    if device().is_none() {
        return;
    }
    // A plain device: the limits of the WebGPU standard, and no feature, so
    // that triangles take the way through a copy.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let sound = adapters.into_iter().find_map(|adapter| {
        let descriptor = wgpu::DeviceDescriptor::default();
        let (own, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
        Device::from_wgpu(own, queue, adapter.get_info()).ok()
    });
    let own = sound.expect("the adapter found before is there");
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let tree = any_world(100..101).new_tree(&mut runner).unwrap();
    let (foliage, lod) = proptest::strategy::ValueTree::current(&tree);
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().unwrap());
    let scene = Scene {
        foliage: &foliage,
        lod: &lod,
        views: &views,
        resolution: 100,
    };
    assert_twins(&own, &scene);
}
