//! Times fragments and areas of the twins on a crown of random quads:
//! `cargo run --release -p secateur-raster --example twin_times [LEAVES...]`.
//!
//! Prints one row per number of leaves: the least time of several runs, in
//! milliseconds, and the GPU's as a multiple of the CPU's.

use std::time::Instant;

use glam::DVec3;
use secateur_model::{BoundingSphere, Foliage, LeafTriangle, Lod, Random};
use secateur_raster::gpu::{self, Device, Preference};
use secateur_raster::{Scene, ViewSet, cpu};

const RESOLUTION: u32 = 256;
const RUNS: u32 = 7;

/// Leaves over each other where the crown is seen, on average.
const LAYERS: f64 = 6.0;

fn in_ball(random: &mut Random) -> DVec3 {
    loop {
        let p = DVec3::from_array([(); 3].map(|()| random.between(-1.0, 1.0)));
        if p.length_squared() <= 1.0 {
            return p;
        }
    }
}

fn crown(leaves: u32) -> Foliage {
    let mut random = Random::new(7);
    let mut foliage = Foliage::default();
    // A leaf shows half of its area from an average side; the ball shows pi.
    let side = (2.0 * LAYERS * std::f64::consts::PI / f64::from(leaves)).sqrt();
    for _ in 0..leaves {
        let centre = in_ball(&mut random);
        let normal = in_ball(&mut random).normalize_or(DVec3::Y);
        let right = normal.any_orthonormal_vector() * side * 0.5;
        let up = normal.cross(right);
        let corners = [
            centre - right - up,
            centre + right - up,
            centre + right + up,
            centre - right + up,
        ];
        let triangle = |k: [usize; 3]| LeafTriangle::plain(k.map(|k| corners[k]));
        foliage
            .push_leaf(&[triangle([0, 1, 2]), triangle([0, 2, 3])], None)
            .expect("corners are finite");
    }
    foliage
}

fn least_ms(mut run: impl FnMut()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..RUNS).map(once).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut counts = std::env::args()
        .skip(1)
        .map(|arg| arg.parse())
        .collect::<Result<Vec<u32>, _>>()?;
    if counts.is_empty() {
        counts = vec![20_000, 100_000];
    }
    let device = Device::find(Preference::Any)?;
    println!("adapter: {} ({})", device.adapter(), device.driver());
    println!("leaves, fragments, stage, cpu_ms, gpu_ms, ratio");
    for leaves in counts {
        let foliage = crown(leaves);
        let lod = Lod::original(foliage.leaves().len());
        let sphere = foliage.bounding_sphere().unwrap_or(BoundingSphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        });
        let views = ViewSet::dodecahedron(sphere);
        let scene = Scene {
            foliage: &foliage,
            lod: &lod,
            views: &views,
            resolution: RESOLUTION,
        };
        let (fragments, areas) = gpu::fragments_and_areas(&device, &scene)?;
        assert!(fragments == cpu::fragments(&scene) && areas == cpu::areas(&scene));
        let row = |stage: &str, cpu_ms: f64, gpu_ms: f64| {
            let ratio = gpu_ms / cpu_ms;
            let count = fragments.len();
            println!("{leaves}, {count}, {stage}, {cpu_ms:.1}, {gpu_ms:.1}, {ratio:.2}");
        };
        row(
            "fragments and their areas",
            least_ms(|| drop(cpu::fragments_and_areas(&scene))),
            least_ms(|| drop(gpu::fragments_and_areas(&device, &scene))),
        );
        row(
            "areas drawn",
            least_ms(|| drop(cpu::areas(&scene))),
            least_ms(|| drop(gpu::areas(&device, &scene))),
        );
    }
    Ok(())
}
