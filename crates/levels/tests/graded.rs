//! The difference that levels are chosen by, held against grades that people gave by eye.

use std::path::Path;

use rayon::prelude::*;
use secateur_eval::{DifferenceJudge, Limits, ViewCount};
use secateur_gltf::{Detail, Document, WholeTree};
use serde_json::Value;

/// A pair of a plant and a level: its grade from 1 (cannot tell) to 5 (another plant), and what was computed.
struct Pair {
    name: String,
    grade: f64,
    difference: f64,
    over: f64,
}

fn judged(shared: &Path, pair: &Value) -> Pair {
    let file = |key: &str| shared.join(pair[key].as_str().expect("a file"));
    let number = |key: &str| pair[key].as_f64().expect("a number");
    let plant = WholeTree::open(&file("original"), &[]).expect("a plant");
    let drawn = plant.items().drawn(Detail::Color).expect("surfaces");
    let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
    let original = drawn.into_iter().map(|drawn| drawn.surface).collect();
    let level = Document::open(&file("level")).expect("a level");
    let level = level.drawn_as_one(Detail::Color).expect("surfaces");
    let level: Vec<_> = level.into_iter().map(|drawn| drawn.surface).collect();
    let judge = DifferenceJudge::new(original, &is_wood);
    let seen = judge.difference(&level, number("pixels_high"), ViewCount::Search);
    Pair {
        name: format!("{} at {}", pair["level"], number("pixels_high")),
        grade: number("grade"),
        difference: seen.difference,
        over: seen.over(Limits::GOOD),
    }
}

/// By value its rank, the mean of several that are equal.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |value: &f64| {
        let below = values.iter().filter(|other| *other < value).count();
        let equal = values.iter().filter(|other| *other == value).count();
        below as f64 + (equal as f64 - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

/// Spearman's rank correlation.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let [a, b] = [a, b].map(ranks);
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| -> f64 {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

#[test]
fn ranks_agree_by_how_they_are_ordered() {
    assert_eq!(ranks(&[7.0, 3.0, 7.0]), [1.5, 0.0, 1.5]);
    assert!((rank_correlation(&[1.0, 2.0, 9.0], &[0.1, 0.4, 0.5]) - 1.0).abs() < 1e-12);
    assert!((rank_correlation(&[1.0, 2.0, 9.0], &[3.0, 2.0, 1.0]) + 1.0).abs() < 1e-12);
}

/// Rank correlation of .94 or more; nothing that is plainly coarser (3 or worse) is within the limits, and hardly
/// anything that cannot be told (1.5 or better) is beyond them.
#[test]
fn the_difference_orders_levels_as_people_do() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let Ok(text) = std::fs::read(shared.join("graded/graded.json")) else {
        eprintln!("SKIPPED: no graded pairs beside the repository");
        return;
    };
    let pairs: Vec<Value> = serde_json::from_slice(&text).expect("pairs");
    let mut pairs: Vec<Pair> = pairs.par_iter().map(|pair| judged(&shared, pair)).collect();
    pairs.sort_by(|a, b| a.grade.total_cmp(&b.grade));
    for pair in &pairs {
        println!(
            "{} {:.3} {:.3} {}",
            pair.grade, pair.difference, pair.over, pair.name
        );
    }
    let of = |value: fn(&Pair) -> f64| pairs.iter().map(value).collect::<Vec<f64>>();
    let correlation = rank_correlation(&of(|pair| pair.grade), &of(|pair| pair.difference));
    println!("rank correlation {correlation:.3}");
    assert!(correlation >= 0.94, "{correlation}");
    let coarse = pairs.iter().filter(|pair| pair.grade >= 3.0);
    assert_eq!(coarse.filter(|pair| pair.over <= 1.0).count(), 0);
    let same = pairs.iter().filter(|pair| pair.grade <= 1.5);
    assert_eq!(same.filter(|pair| pair.over > 1.0).count(), 0);
}
