//! Parts of a plant with a level of their own: `simplify --level-of`, and the library's `LevelOptions::level_of`.

use secateur::{LevelOptions, Plant, Versioned};
use serde_json::Value;

use crate::program::Bench;

/// Triangles of leaves and of wood of the original, and of what is left.
fn left(bench: &Bench, options: &[&str]) -> [[f64; 2]; 2] {
    let files = ["oak.glb", "-o", "out.glb", "--report", "r.json"];
    bench.simplify(&[&files, options].concat()).succeeded();
    let report: Value = bench.json("r.json");
    ["original", "final"].map(|when| {
        ["foliage_triangles", "wood_triangles"].map(|key| report[key][when].as_f64().unwrap())
    })
}

/// `part` of `all` is this share, or at most a tenth less.
fn assert_share([all, part]: [f64; 2], share: f64) {
    let most = (share * all).round();
    assert!(
        part <= most && part >= 0.9 * most,
        "{part} of {all}: {share}"
    );
}

#[test]
fn parts_keep_their_own_share_and_the_rest_has_the_target() {
    let bench = Bench::new();
    let budget = ["--triangles", "0.2"];
    let of = |levels: &[&str]| {
        let levels = levels.iter().flat_map(|level| ["--level-of", level]);
        let options: Vec<&str> = budget.into_iter().chain(levels).collect();
        let [[leaves, wood], [leaves_left, wood_left]] = left(&bench, &options);
        [[leaves, leaves_left], [wood, wood_left]]
    };
    // The last that names a part counts.
    for (levels, shares) in [
        (&["material:*bark*=0.5"][..], [0.2, 0.5]),
        (&["all=0.7", "material:*leaf*=0.6"], [0.6, 0.7]),
    ] {
        let found = of(levels);
        assert_share(found[0], shares[0]);
        assert_share(found[1], shares[1]);
    }
    crate::validator::assert_valid(&[bench.path("out.glb")]);
    // Wood that no level names stays beside a target of leaves.
    let leaves = ["--ratio", "0.1", "--level-of", "material:*leaf*=0.5"];
    let [before, after] = left(&bench, &leaves);
    assert_share([before[0], after[0]], 0.5);
    assert_eq!(before[1], after[1]);
}

/// The library's level has the bytes of the program's, and its options travel as text.
#[test]
fn the_library_has_levels_of_parts_too() {
    let bench = Bench::new();
    let level_of = "material:*bark*=0.3";
    let files = ["simplify", "oak.glb", "-o", "out.glb"];
    let asked = ["--triangles", "0.4", "--level-of", level_of];
    bench.run(&[&files[..], &asked].concat()).succeeded();
    let mut options = LevelOptions::triangles(0.4);
    options.level_of = vec![level_of.parse().unwrap()];
    let text = serde_json::to_string(&Versioned::new(options.clone())).unwrap();
    assert!(text.contains(level_of), "{text}");
    let again: Versioned<LevelOptions> = serde_json::from_str(&text).unwrap();
    assert_eq!(again.options, options);
    let plant = Plant::open(bench.path("oak.glb")).unwrap();
    let level = plant.level(&options).unwrap();
    assert!(level.to_bytes().unwrap() == bench.read("out.glb"));
}

#[test]
fn parts_that_are_not_there_and_shares_that_are_none_are_one_sentence() {
    let bench = Bench::new();
    let refused = |options: &[&str], says: &[&str]| {
        let files = ["oak.glb", "-o", "out.glb", "--triangles", "0.3"];
        let arguments = [&files, options].concat();
        bench.simplify(&arguments).failed_saying(says);
    };
    let of = |level| ["--level-of", level];
    refused(
        &of("material:petal=0.5"),
        &["`material:petal` matches nothing", "material:oak bark"],
    );
    refused(
        &of("material:*bark*=1e-9"),
        &["oak.glb: the level of material:*bark*", "ask for"],
    );
    // Ignored wood is no part.
    let ignored = [&of("material:*bark*=0.5")[..], &["--wood", "ignore"]].concat();
    refused(&ignored, &["matches nothing", "material:oak leaf"]);
    for level in ["bark=0.5", "material:bark", "material:bark=2"] {
        let arguments = [
            "oak.glb",
            "-o",
            "out.glb",
            "--triangles",
            "0.3",
            "--level-of",
            level,
        ];
        let ran = bench.simplify(&arguments);
        assert!(
            ran.stderr.contains("is no level of parts"),
            "{}",
            ran.stderr
        );
    }
}
