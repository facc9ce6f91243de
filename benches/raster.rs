//! Fragments and areas of 20 views: the GPU against its CPU twin, in turn on
//! the same machine: `cargo bench --bench raster`.

mod rows;

use std::time::Instant;

use rows::{Row, Rows, repeats, shared_tree};
use secateur_gltf::Tree;
use secateur_model::{Foliage, Lod};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::gpu::{self, Device, Preference};
use secateur_raster::{AreaTable, Fragments, Scene, ViewSet, cpu};

fn main() {
    let mut rows = Rows::create("raster");
    let crown = |leaves| ellipsoid_crown(leaves, 1, &EllipsoidCrown::default()).expect("a crown");
    let mut cases: Vec<(String, Foliage)> = Vec::new();
    if let Some(path) = shared_tree("ez_oak_20k.glb") {
        let tree = Tree::open(&path, &[]).expect("the oak loads");
        cases.push(("ez_oak_20k".to_owned(), tree.foliage().clone()));
    }
    for leaves in [20_000, 100_000] {
        cases.push((format!("crown_{leaves}"), crown(leaves)));
    }
    let devices: Vec<Device> = Device::find(Preference::Any).into_iter().collect();
    for (name, foliage) in &cases {
        for device in &devices {
            compare(&mut rows, name, foliage, device);
        }
    }
}

fn compare(rows: &mut Rows, name: &str, foliage: &Foliage, device: &Device) {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let lod = Lod::original(foliage.leaves().len());
    let scene = Scene {
        foliage,
        lod: &lod,
        views: &views,
        resolution: 256,
    };
    let case = format!("{name}, 20 views at 256");
    let time = |stage: &dyn Fn() -> (Fragments, AreaTable)| {
        let start = Instant::now();
        let result = stage();
        (start.elapsed().as_secs_f64() * 1e3, result)
    };
    let on_cpu = || cpu::fragments_and_areas(&scene);
    let on_gpu = || gpu::fragments_and_areas(device, &scene).expect("the device works");
    // Once unmeasured: pipelines are made, memory is touched.
    assert!(time(&on_gpu).1 == time(&on_cpu).1, "the same bits");
    let (mut least_cpu, mut least_gpu) = (f64::INFINITY, f64::INFINITY);
    let mut add = |quantity, unit, value, repeat, adapter: &str| {
        rows.add(&Row {
            case: &case,
            quantity,
            unit,
            value,
            repeat,
            adapter,
            command: "cargo bench --bench raster",
        });
    };
    for repeat in 0..repeats().max(5) {
        let cpu = time(&on_cpu).0;
        let gpu = time(&on_gpu).0;
        add("fragments and areas", "ms", cpu, repeat, "cpu");
        add("fragments and areas", "ms", gpu, repeat, device.adapter());
        least_cpu = least_cpu.min(cpu);
        least_gpu = least_gpu.min(gpu);
    }
    add(
        "gpu over cpu (least)",
        "times",
        least_gpu / least_cpu,
        0,
        device.adapter(),
    );
}
