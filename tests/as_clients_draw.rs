//! Levels as three.js draws them, with the settings that files ask for.

use serde_json::{Value, json};

use crate::clients;
use crate::program::{Bench, shared_tree};

/// From one and from the other side of each switch, a level covers what the original truly does.
///
/// The bush's own cut-outs fade away in a client: without textures made for the distance its
/// levels would cover a tenth and less of that.
#[test]
fn levels_cover_what_the_original_truly_does_at_each_switch() {
    let Some(tree) = shared_tree("ez_bush2.glb") else {
        return;
    };
    let bench = Bench::new();
    bench.put("original.glb", &std::fs::read(&tree).unwrap());
    let wanted = ["lods", "original.glb", "-o", ".", "--levels", "0.25,0.1"];
    let run = bench.run(&[&wanted[..], &["--report", "r.json"]].concat());
    run.succeeded();
    let record = bench.json("r.json");
    let levels = record["levels"].as_array().unwrap();
    let distance = |level: &Value| level["distance"].as_f64().unwrap();
    let shown = |(k, level): (usize, &Value)| {
        let end = levels.get(k + 1).map(distance);
        let distances: Vec<f64> = [Some(distance(level)), end].into_iter().flatten().collect();
        json!({ "file": format!("original_LOD{k}.glb"), "distances": distances })
    };
    let levels: Vec<Value> = levels.iter().enumerate().map(shown).collect();
    let jobs = json!([{
        "name": "bush",
        "original": "original.glb",
        "screen": record["screen"],
        "most_px": 128,
        "levels": levels,
    }]);
    bench.put("jobs.json", jobs.to_string().as_bytes());
    let Some(seen) = clients::show("coverage.js", &bench.path("jobs.json")) else {
        return;
    };
    assert_eq!(seen.len(), 3);
    for level in &seen {
        let coverage = level["coverage_over_truth"].as_f64().unwrap();
        assert!((0.9..=1.1).contains(&coverage), "{level}");
    }
    // What a client makes of the original itself at the switch.
    let original = seen[2]["original_coverage_over_truth"].as_f64().unwrap();
    assert!(original < 0.5, "{original}");
}
