//! Times how long a level is judged, in large and in small pictures: `judge_time PLANT.glb LEVEL.glb`.
use std::path::Path;
use std::time::Instant;

use secateur_eval::{DifferenceJudge, ViewCount};
use secateur_gltf::{Detail, Document, WholeTree};

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let plant = WholeTree::open(Path::new(&args[1]), &[]).expect("a plant");
    let drawn = plant.items().drawn(Detail::Color).expect("surfaces");
    let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
    let original = drawn.into_iter().map(|drawn| drawn.surface).collect();
    let level = Document::open(Path::new(&args[2])).expect("a level");
    let level = level.drawn_as_one(Detail::Color).expect("surfaces");
    let level: Vec<_> = level.into_iter().map(|drawn| drawn.surface).collect();
    let judge = DifferenceJudge::new(original, &is_wood);
    for (px, count) in [(1080.0, ViewCount::All), (270.0, ViewCount::Search)] {
        for _ in 0..4 {
            let began = Instant::now();
            let found = judge.difference(&level, px, count);
            println!(
                "{px} px, {count:?}: {:.0} ms, {found:?}",
                began.elapsed().as_secs_f64() * 1e3
            );
        }
    }
}
