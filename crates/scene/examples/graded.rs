//! Prints how pairs that were graded by eye are judged.
use secateur_eval::{DifferenceJudge, ViewCount};
use secateur_gltf::{Detail, Document};
use secateur_model::{AlphaMode, Surface};
use std::path::Path;

fn surfaces(path: &Path) -> Vec<Surface> {
    let document = Document::open(path).unwrap();
    document.drawn_as_one(Detail::Color).unwrap().into_iter().map(|d| d.surface).collect()
}

fn main() {
    let shared = Path::new("../shared");
    let pairs: serde_json::Value = serde_json::from_slice(&std::fs::read(shared.join("graded/graded.json")).unwrap()).unwrap();
    for pair in pairs.as_array().unwrap() {
        let text = |k: &str| pair[k].as_str().unwrap().to_owned();
        let original = surfaces(&shared.join(text("original")));
        let level = surfaces(&shared.join(text("level")));
        let is_wood: Vec<bool> = original.iter().map(|s| {
            let n = s.material.name.to_lowercase();
            n.contains("bark") || n.contains("branch") || n.contains("wood") || n.contains("trunk") || (n.is_empty() && s.material.alpha_mode == AlphaMode::Opaque)
        }).collect();
        let judge = DifferenceJudge::new(original, &is_wood);
        let px = pair["pixels_high"].as_f64().unwrap();
        let start = std::time::Instant::now();
        let d = judge.difference(&level, px, ViewCount::All);
        let first = start.elapsed().as_secs_f64();
        let w = d.worst_wood;
        let start = std::time::Instant::now();
        let s = judge.difference(&level, px, ViewCount::Search);
        println!("{}\t{}\t{}\t{:.4}\t{:.4}\t{:.4}\t{:.4}\t{:.4}\t{}\t{first:.2}\t{:.2}\t{:.4}", text("level").replace("graded/",""), px, pair["grade"], d.difference, d.block_coverage, d.worst_block, d.mean, s.difference, judge.plant_count(), start.elapsed().as_secs_f64(), w);
    }
}
