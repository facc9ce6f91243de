//! Plants without leaves: dead trees, and what is modelled in one piece.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use secateur::{Document, GrownPlant, LevelOptions, Opening, Plant, plant_to_glb, surfaces_to_glb};
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

/// A crown of a bumpy sphere, foliage or not: each of its triangles has corners and a normal of its own.
fn flat_shaded(is_foliage: bool) -> Vec<u8> {
    const RINGS: u32 = 24;
    let point = |ring: u32, step: u32| {
        let (up, around) = [(ring, RINGS), (step % (2 * RINGS), RINGS)]
            .map(|(k, of)| std::f64::consts::PI * f64::from(k) / f64::from(of))
            .into();
        let reach = 1.0 + 0.08 * (5.0 * up).sin() * (4.0 * around).cos();
        reach * DVec3::new(up.sin() * around.cos(), up.cos(), up.sin() * around.sin())
    };
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let mut crown = Surface::empty(Arc::clone(&oak.wood.material));
    for ring in 0..RINGS {
        for step in 0..2 * RINGS {
            let [a, b] = [step, step + 1].map(|step| point(ring, step));
            let [c, d] = [step, step + 1].map(|step| point(ring + 1, step));
            for corners in [[a, b, c], [b, d, c]] {
                let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let Some(normal) = across.try_normalize() else {
                    continue;
                };
                let first = crown.positions.len() as u32;
                crown.positions.extend(corners);
                crown.normals.extend([normal.as_vec3(); 3]);
                crown.triangles.push([first, first + 1, first + 2]);
            }
        }
    }
    surfaces_to_glb("crown", &[(crown, is_foliage)])
}

/// What is flat-shaded stays so: its normals are no seams that hold edges, and new triangles have normals of their own.
#[test]
fn a_flat_shaded_crown_is_flat_shaded_in_its_levels() {
    for is_foliage in [false, true] {
        let crown = flat_shaded(is_foliage);
        let plant = Plant::from_bytes("crown.glb", crown, &Opening::default()).unwrap();
        let level = plant
            .level(&LevelOptions::triangles(0.2))
            .unwrap()
            .to_bytes()
            .unwrap();
        let level = Document::from_bytes("level.glb", level, None).unwrap();
        let [(level, _)] = &level.surfaces(&[]).unwrap()[..] else {
            panic!("one surface");
        };
        let (left, all) = (level.triangles.len() as u64, plant.triangle_count());
        assert!((left * 20).abs_diff(all * 4) <= all, "{left} of {all}");
        let is_flat = |corners: &&[u32; 3]| {
            let [a, b, c] = corners.map(|k| level.positions[k as usize]);
            let own = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            corners
                .iter()
                .all(|&k| Vec3::dot(level.normals[k as usize], own).abs() > 0.99)
        };
        let flat = level.triangles.iter().filter(is_flat).count() as u64;
        assert!(flat * 100 >= left * 95, "{flat} of {left} are flat");
    }
}
