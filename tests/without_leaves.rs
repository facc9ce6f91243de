//! Plants without leaves: dead trees, and what is modelled in one piece.

use secateur::{GrownPlant, Opening, Plant, plant_to_glb};
use secateur_model::Surface;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

use crate::program::Bench;

/// An oak in winter.
fn bare() -> Vec<u8> {
    let options = GrowOptions {
        leaves: 60,
        seed: 5,
    };
    let oak: GrownPlant = grow(Species::Oak, &options).unwrap();
    let leaves = Surface::empty(oak.leaves.material.clone());
    plant_to_glb(&GrownPlant {
        leaves,
        triangles_per_leaf: Vec::new(),
        skeleton: None,
        holds: None,
        ..oak
    })
}

fn record(bench: &Bench, arguments: &[&str]) -> Value {
    let ran = bench.run(&[arguments, &["--format", "json"]].concat());
    serde_json::from_str(&ran.succeeded().stdout).unwrap()
}

#[test]
fn a_dead_tree_gets_levels_and_a_note() {
    let bench = Bench::new();
    bench.put("dead.glb", &bare());
    let all = Plant::from_bytes("dead.glb", bare(), &Opening::default())
        .unwrap()
        .triangle_count();
    let inspected = record(&bench, &["inspect", "dead.glb"]);
    let note = inspected["notes"][0].as_str().unwrap();
    assert!(note.starts_with("no leaves were found"), "{note}");
    let arguments = ["simplify", "dead.glb", "-o", "half.glb"];
    let half = record(&bench, &[&arguments[..], &["--triangles", "0.5"]].concat());
    let left = half["triangles"]["final"].as_u64().unwrap();
    assert!(
        (9 * all..=10 * all).contains(&(20 * left)),
        "{left} of {all}"
    );
    assert_eq!(half["leaves"]["final"], 0);
    let arguments = ["lods", "dead.glb", "-o", "levels", "--distances", "20"];
    let lods = record(&bench, &arguments);
    let levels = lods["levels"].as_array().unwrap();
    assert!(levels.len() > 1, "{lods}");
    assert_eq!(half["notes"][0], note);
    assert_eq!(lods["notes"][0], note);
    for level in levels {
        assert!(level["difference"].as_f64().unwrap() <= 0.28, "{level}");
        assert_eq!(level["leaves"], 0);
    }
}
