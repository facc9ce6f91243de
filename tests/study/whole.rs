//! Studies of whole plants, beside gltfpack where it is there.

use std::path::Path;

use serde_json::Value;

use super::{QUICKLY, readme, rows};
use crate::program::Bench;

const WHOLE: [&str; 11] = [
    "study", "oak.glb", "-o", "s", "--plan", "whole", "--levels", "0.98,0.3", QUICKLY[0],
    QUICKLY[1], "--quiet",
];

/// The rows of a method, by their levels.
fn left<'r>(rows: &'r [Value], label: [&str; 2]) -> Vec<(f64, &'r Value)> {
    let is = |row: &&Value| row["method"] == label[0] && row["setting"] == label[1];
    let of_method = rows.iter().filter(is);
    of_method
        .map(|row| (row["level"].as_f64().unwrap(), row))
        .collect()
}

/// Within its budget, and judged as a whole.
fn assert_is_whole(level: f64, row: &Value) {
    let original = row["whole"]["triangles_original"].as_u64().unwrap();
    let left = row["triangles_final"].as_u64().unwrap();
    assert!(left as f64 <= (level * original as f64).round(), "{row}");
    for key in ["flip_mean", "ssim", "silhouette_iou"] {
        let value = row["values"][key].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&value), "{key}: {row}");
    }
    assert_eq!(row["rigs"].as_array().unwrap().len(), 1);
    assert!(level > 0.5 || row["values"]["flip_mean"].as_f64().unwrap() > 0.0);
}

/// Without gltfpack a study of whole plants says so and goes on; where the wood alone is more than
/// the level, leaves alone can't get there.
#[test]
fn whole_plants_are_studied_without_gltfpack() {
    let bench = Bench::new();
    let empty = [bench.path("none")];
    let ran = bench.run_on_path(&empty, &WHOLE[..10]).succeeded();
    assert!(ran.stderr.contains("no gltfpack"), "{}", ran.stderr);
    assert_eq!(ran.stderr.trim().lines().count(), 1, "{}", ran.stderr);
    let rows = rows(&bench);
    let (auto, keep) = (
        left(&rows, ["vds", "wood auto"]),
        left(&rows, ["vds", "wood keep"]),
    );
    let levels = |rows: &[(f64, &Value)]| rows.iter().map(|(l, _)| *l).collect::<Vec<_>>();
    assert_eq!(levels(&auto), [0.98, 0.3]);
    assert_eq!(levels(&keep), [0.98], "nearly all of the small oak is wood");
    assert_eq!(rows.len(), 3);
    for (level, row) in auto.iter().chain(&keep) {
        assert_is_whole(*level, row);
        let picture = bench.read(&format!("s/{}", row["picture"].as_str().unwrap()));
        assert!(picture.starts_with(&[0xFF, 0xD8]), "a JPEG");
    }
    let again = bench.run(&["study", "--redraw", "-o", "s"]).succeeded();
    assert!(again.stdout.contains("3 rows"), "{}", again.stdout);
    let readme = readme(&bench);
    for part in [
        "## Whole plants",
        "### 30 % of all triangles",
        "vds wood auto",
    ] {
        assert!(readme.contains(part), "{part}: {readme}");
    }
    assert!(!readme.contains("of the leaves:"), "no row is of leaves");
    let page = String::from_utf8(bench.read("s/report.html")).unwrap();
    assert!(page.contains("<h2>Whole plants</h2>"));
    assert_eq!(page.matches("data:image/jpeg").count(), 7);
    // A row's command makes it again.
    let command = auto[1].1["command"].as_str().unwrap().to_owned();
    assert!(command.ends_with("--triangles 0.3 --no-audit --wood auto"));
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    bench.run(&words).succeeded();
    let made = secateur::Tree::open(&bench.path("out.glb"), &[]).unwrap();
    assert_eq!(auto[1].1["triangles_final"], made.triangle_count());
}

/// gltfpack gets as near to the level as it can from below, and its file is judged as ours.
#[test]
fn whole_plants_are_held_against_gltfpack() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/gltfpack/node_modules");
    if !folder.join("gltfpack").is_dir() {
        let hint = "gltfpack is missing; npm ci --prefix tests/gltfpack";
        let is_required = std::env::var("SECATEUR_REQUIRE_GLTFPACK").is_ok_and(|v| v == "1");
        assert!(!is_required, "{hint}");
        eprintln!("SKIPPED: {hint}");
        return;
    }
    let bench = Bench::new();
    let mut folders = vec![folder.join(".bin")];
    folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap()));
    let ran = bench.run_on_path(&folders, &WHOLE).succeeded();
    assert_eq!(ran.stderr, "");
    let rows = rows(&bench);
    let found = left(&rows, ["gltfpack", "sa"]);
    assert_eq!(found.len(), 2);
    for (level, row) in found {
        assert_is_whole(level, row);
        let ours = left(&rows, ["vds", "wood auto"]);
        let (_, ours) = ours.iter().find(|(l, _)| *l == level).unwrap();
        let [theirs, ours] = [row, *ours].map(|row| row["triangles_final"].as_f64().unwrap());
        assert!(theirs > 0.8 * ours, "{theirs} {ours}");
        assert!(row["engine"].as_str().unwrap().starts_with("gltfpack"));
    }
    let readme = readme(&bench);
    assert!(readme.contains("gltfpack sa"), "{readme}");
}
