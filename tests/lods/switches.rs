//! Levels that cast shadows, and what a switch from a level to the next shows.

use secateur::Document;
use serde_json::Value;

use super::levels;
use crate::program::Bench;

#[test]
fn shadows_are_cast_by_coarser_levels() {
    let bench = Bench::for_small_screen();
    for (steps, expected) in [("0", [0, 1, 2]), ("1", [1, 2, 2]), ("2", [2, 2, 2])] {
        let lods = [
            "lods",
            "oak.glb",
            "--effort=fast",
            "-o",
            "s.glb",
            "--no-original",
            "--levels",
            "0.5,0.2,0.08",
            "--shadow-steps",
            steps,
            "--report",
            "r.json",
            "--overwrite",
        ];
        bench.run(&lods).succeeded();
        let record = bench.json("r.json");
        let document = Document::open(&bench.path("s.glb")).unwrap();
        let nodes = document.json()["nodes"].as_array().unwrap();
        for (k, level) in levels(&record).iter().enumerate() {
            let shadow = format!("oak_LOD{}", expected[k]);
            assert_eq!(level["shadow"]["node"], shadow);
            let node = nodes.iter().find(|n| n["name"] == level["node"]).unwrap();
            assert_eq!(node["extras"]["shadow"], shadow);
            assert!(nodes.iter().any(|n| n["name"] == shadow));
        }
    }
    bench
        .run(&["lods", "oak.glb", "-o", "t.glb", "--shadow-steps", "3"])
        .misused_saying(&["0..=2"]);
}

#[test]
fn what_a_switch_shows_is_measured_and_bounded() {
    let bench = Bench::for_small_screen();
    let lods = |max_pop: &str| {
        let lods = [
            "lods",
            "oak.glb",
            "--effort=fast",
            "-o",
            "c",
            "--no-original",
            "--levels",
            "0.5,0.3,0.1",
            "--max-pop",
            max_pop,
            "--report",
            "r.json",
            "--overwrite",
        ];
        bench.run(&lods).succeeded();
        bench.json("r.json")
    };
    let free = lods("1");
    let pops: Vec<Option<f64>> = levels(&free).iter().map(|l| l["pop"].as_f64()).collect();
    assert_eq!(
        (pops.len(), pops[0]),
        (3, None),
        "nothing comes before the first"
    );
    let pops = pops[1..].iter().map(|pop| pop.unwrap());
    let largest = pops.clone().fold(0.0, f64::max);
    assert!(pops.clone().all(|pop| pop > 0.0));
    assert_eq!(free["largest_pop"].as_f64(), Some(largest));
    let most = 0.9 * largest;
    let bounded = lods(&most.to_string());
    let left = levels(&bounded);
    assert!(left.len() < 3);
    for level in &left[1..] {
        assert!(level["pop"].as_f64().unwrap() <= most, "{level}");
    }
    let notes = bounded["notes"].as_array().unwrap();
    let says = |note: &Value| note.as_str().unwrap().contains("to switch to it");
    assert!(notes.iter().any(says), "{notes:?}");
    let last = left.last().unwrap();
    assert_eq!(last["screen_coverage"], 0.0, "the last is drawn on");
}
