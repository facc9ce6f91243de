//! Times the judge.
use secateur_eval::{DifferenceJudge, ViewCount};
use secateur_gltf::{Detail, Document};
use std::path::Path;
fn main() {
    let open = |p: &str| -> Vec<_> { Document::open(Path::new(p)).unwrap().drawn_as_one(Detail::Color).unwrap().into_iter().map(|d| d.surface).collect() };
    let a: Vec<String> = std::env::args().collect();
    let (original, level) = (open(&a[1]), open(&a[2]));
    let judge = DifferenceJudge::new(original, &[]);
    let px: f64 = a[3].parse().unwrap();
    judge.difference(&level, px, ViewCount::Search);
    let n: u32 = a[4].parse().unwrap();
    for _ in 0..n { judge.difference(&level, px, ViewCount::Search); }
}
