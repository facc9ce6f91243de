//! Studies of plants at the distances of a walk.

use secateur::plant_to_glb;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

use super::{readme, rows};
use crate::program::Bench;

/// At each distance of a walk the level for it, one of fixed shares, an impostor and a mesh as light.
#[test]
fn plants_are_studied_at_the_distances_of_a_walk() {
    let bench = Bench::new();
    let options = GrowOptions {
        leaves: 30,
        seed: 5,
    };
    let small = grow(Species::Oak, &options).unwrap();
    bench.put("oak.glb", &plant_to_glb(&small));
    // So far off that pictures are small.
    let at = ["--distances", "400,800", "--levels", "0.2"];
    let study = [&["study", "oak.glb", "-o", "s", "--plan", "scene"][..], &at].concat();
    let ran = bench.run(&study).succeeded();
    assert_eq!(ran.stderr, "");
    let rows = rows(&bench);
    let of = |case: &str| -> Vec<&Value> {
        let is_it = |row: &&Value| row["seen_from"]["case"] == case;
        rows.iter().filter(is_it).collect()
    };
    let number = |value: &Value| value.as_f64().unwrap();
    for case in ["for-distances", "fixed-shares", "impostor"] {
        let distances: Vec<f64> = (of(case).iter())
            .map(|row| number(&row["seen_from"]["distance_m"]))
            .collect();
        assert_eq!(distances, [400.0, 800.0], "{case}");
    }
    let ours = of("for-distances");
    for pair in ours.windows(2) {
        let [near, far] = [pair[0], pair[1]];
        assert!(number(&near["triangles_final"]) >= number(&far["triangles_final"]));
        let [near, far] = [near, far].map(|row| number(&row["seen_from"]["pixels_high"]));
        assert!((near / far - 2.0).abs() < 1e-9);
    }
    for (fixed, ours) in of("fixed-shares").iter().zip(&ours) {
        let [fixed, ours] = [*fixed, *ours].map(|row| number(&row["values"]["difference"]));
        assert!(fixed <= ours.max(0.28), "{fixed} beside {ours}");
    }
    for mesh in of("mesh-of-same-cost") {
        let same =
            |row: &&&Value| row["seen_from"]["distance_m"] == mesh["seen_from"]["distance_m"];
        let impostor = of("impostor");
        let impostor = impostor.iter().find(same).unwrap();
        assert!(number(&mesh["triangles_final"]) <= number(&impostor["triangles_final"]));
    }
    for chart in ["triangles", "difference"] {
        let svg = bench.read(&format!("s/charts/distances-oak-{chart}.svg"));
        assert!(svg.starts_with(b"<svg"));
    }
    let page = String::from_utf8(bench.read("s/report.html")).unwrap();
    assert!(page.contains("At the distances of a walk") && page.contains("<svg"));
    let readme = readme(&bench);
    assert!(readme.contains("### oak at each distance") && !readme.contains("of the leaves:"));
    // Nothing is run again.
    let text = bench.read("s/rows.jsonl");
    bench.run(&study).succeeded();
    assert_eq!(bench.read("s/rows.jsonl"), text);
    // A row's command makes it again.
    let command = of("for-distances")[0]["command"].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    bench
        .run(&[&words[..], &["--report", "r.json"]].concat())
        .succeeded();
    let level = bench.json("r.json")["levels"][0].clone();
    assert_eq!(level["triangles"], ours[0]["triangles_final"]);
    // Both judge alike.
    let [by_lods, by_study] = [&level, &ours[0]["values"]].map(|said| number(&said["difference"]));
    assert!(
        (by_study / by_lods - 1.0).abs() < 0.1,
        "{by_study} for {by_lods}"
    );
}
