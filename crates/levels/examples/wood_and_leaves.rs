//! How many times the limits plants differ at shares of their triangles, by how these are shared between leaves and
//! wood: `wood_and_leaves PIXELS LEAF_MARGIN PLANT.glb ...`. The last figure of a row is the geometric mean.
use std::ops::ControlFlow;
use std::path::Path;

use secateur_eval::{DifferenceJudge, Limits, ViewCount};
use secateur_gltf::{Detail, WholeTree};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{Budget, Sharing, WholePlant};
use secateur_simplify::{Options, Preset, Shared, Target};

/// The shares of a plant's triangles at which it is judged.
const SHARES: [f64; 10] = [0.7, 0.6, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1];

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let pixels_high: f64 = args[1].parse().expect("a number of pixels");
    let leaf_margin: f64 = args[2].parse().expect("a margin");
    for file in &args[3..] {
        let overs = overs(Path::new(file), pixels_high, leaf_margin);
        let words: Vec<String> = overs.iter().map(|over| format!("{over:.2}")).collect();
        let logarithms = overs.iter().map(|over| over.max(0.02).ln());
        let mean = (logarithms.sum::<f64>() / overs.len() as f64).exp();
        println!("{file}: {} {mean:.3}", words.join(" "));
    }
}

/// By share, how many times the limits a plant is.
fn overs(file: &Path, pixels_high: f64, leaf_margin: f64) -> Vec<f64> {
    let engine = OpenEngine::cpu();
    let plant = WholeTree::open(file, &[]).expect("a plant");
    let drawn = plant.items().drawn(Detail::Color).expect("surfaces");
    let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
    let original = drawn.into_iter().map(|drawn| drawn.surface).collect();
    let judge = DifferenceJudge::new(original, &is_wood);
    let options = Options {
        audit: false,
        ..Options::with_preset(Preset::Look, Target::triangle_share(1.0))
    };
    let [items, leaves, wood] = [plant.items().foliage(), plant.leaves(), plant.wood()];
    let whole = WholePlant::within(items, leaves, wood, &options, &engine).expect("a plant");
    let mut shared = Shared::default();
    let mut over = |share: f64| {
        let budget = Budget {
            triangles: (share * whole.triangle_count() as f64) as usize,
            sharing: Sharing::LeafMargin(leaf_margin),
        };
        let mut go_on = |_| ControlFlow::Continue(());
        let level = whole.level(budget, &options, &engine, Some(&mut shared), &mut go_on);
        let level = level.expect("a level");
        let lod = plant.joined(&level.leaves.lod, &level.wood);
        let document = plant.items().lod_document(&lod).expect("a level");
        let drawn = document.drawn_as_one(Detail::Color).expect("surfaces");
        let surfaces: Vec<_> = drawn.into_iter().map(|drawn| drawn.surface).collect();
        let difference = judge.difference(&surfaces, pixels_high, ViewCount::Search);
        difference.over(Limits::GOOD)
    };
    SHARES.map(&mut over).to_vec()
}
