//! Chains of levels of whole plants.

use std::path::Path;

use secateur::{Document, Tree};
use serde_json::Value;

use crate::program::Bench;

/// The levels of a record, finest first.
fn levels(record: &Value) -> &Vec<Value> {
    record["levels"].as_array().unwrap()
}

fn count(value: &Value) -> u64 {
    value.as_u64().unwrap()
}

fn triangles_of(path: &Path) -> u64 {
    Tree::open(path, &[]).unwrap().triangle_count()
}

#[test]
fn a_chain_has_the_triangles_that_were_asked_for_wood_and_leaves_alike() {
    let bench = Bench::new();
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--levels",
        "0.5,0.2,0.08",
        "--report",
        "r.json",
        "--preview",
        "oak.html",
    ];
    let ran = bench.run(&lods).succeeded();
    assert!(ran.stdout.contains("LOD2"), "{}", ran.stdout);
    let record = bench.json("r.json");
    let all = triangles_of(&bench.path("oak.glb"));
    assert_eq!(count(&record["triangles"]["original"]), all);
    assert_eq!(levels(&record).len(), 3);
    let mut last = Value::Null;
    for (k, (level, share)) in levels(&record).iter().zip([0.5, 0.2, 0.08]).enumerate() {
        let triangles = count(&level["triangles"]);
        let budget = (share * all as f64).round() as u64;
        assert!(
            triangles <= budget && triangles * 10 >= budget * 7,
            "{level}"
        );
        let [foliage, wood] = ["foliage_triangles", "wood_triangles"].map(|key| count(&level[key]));
        assert_eq!(foliage + wood, triangles);
        assert!(foliage > 0 && wood > 0, "{level}");
        let file = bench.path(level["file"].as_str().unwrap());
        assert!(file.ends_with(format!("chain/oak_LOD{k}.glb")));
        assert_eq!(triangles_of(&file), triangles);
        if last != Value::Null {
            let farther = |key: &str| level[key].as_f64().unwrap() - last[key].as_f64().unwrap();
            assert!(farther("distance") > 0.0 && farther("pixels_high") < 0.0);
            assert!(farther("screen_coverage") < 0.0);
        }
        for key in ["flip_mean", "silhouette_iou"] {
            let value = level[key].as_f64().unwrap();
            assert!((0.0..=1.0).contains(&value), "{key} {value}");
        }
        last = level.clone();
    }
    assert_eq!(last["screen_coverage"], 0.0);
    let page = String::from_utf8(bench.read("oak.html")).unwrap();
    assert!(page.contains("<canvas") && page.contains("LOD2"));
    assert!(!page.contains("http://") && !page.contains("src=\"http"));
}

#[test]
fn the_default_chain_keeps_the_difference_where_it_can() {
    let bench = Bench::new();
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "oak_lods.glb",
        "--report",
        "r.json",
    ];
    bench.run(&lods).succeeded();
    let record = bench.json("r.json");
    assert_eq!(record["layout"], "siblings");
    let made = levels(&record);
    assert!((1..=4).contains(&made.len()), "{made:?}");
    for level in made {
        let is_finest = count(&level["triangles"]) == count(&made[0]["triangles"]);
        assert!(
            level["flip_mean"].as_f64().unwrap() <= 0.05 || is_finest,
            "{level}"
        );
    }
    let document = Document::open(&bench.path("oak_lods.glb")).unwrap();
    let names: Vec<&str> = document.json()["nodes"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|node| node["name"].as_str())
        .collect();
    for level in made {
        assert!(
            names.contains(&level["node"].as_str().unwrap()),
            "{names:?}"
        );
    }
}

#[test]
fn levels_of_msft_have_falling_coverages() {
    let bench = Bench::new();
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "m.glb",
        "--layout",
        "msft",
        "--triangles",
        "2000,500",
    ];
    bench.run(&lods).succeeded();
    let document = Document::open(&bench.path("m.glb")).unwrap();
    let nodes = document.json()["nodes"].as_array().unwrap();
    let finest = nodes
        .iter()
        .find(|n| n["extensions"]["MSFT_lod"].is_object())
        .unwrap();
    let coverages: Vec<f64> = finest["extras"]["MSFT_screencoverage"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c.as_f64().unwrap())
        .collect();
    assert_eq!(coverages.len(), 2);
    assert!(
        coverages[0] > coverages[1] && coverages[1] == 0.0,
        "{coverages:?}"
    );
}

#[test]
fn equal_calls_give_equal_bytes() {
    let bench = Bench::new();
    for folder in ["a", "b"] {
        let lods = ["lods", "oak.glb", "-o", folder, "--levels", "0.3,0.1"];
        bench.run(&lods).succeeded();
    }
    for k in 0..2 {
        let [a, b] = ["a", "b"].map(|folder| bench.read(&format!("{folder}/oak_LOD{k}.glb")));
        assert_eq!(a, b);
    }
}

#[test]
fn bad_wishes_get_one_sentence_and_nothing_is_written() {
    let bench = Bench::new();
    let lods = |more: &[&str]| bench.run(&[&["lods", "oak.glb", "-o", "chain"], more].concat());
    let nine = "0.9,0.8,0.7,0.6,0.5,0.4,0.3,0.2,0.1";
    lods(&["--levels", nine]).failed_saying(&["9 levels", "at most 8"]);
    lods(&["--levels", "0.1,0.5"]).failed_saying(&["from fine to coarse"]);
    lods(&["--triangles", "500,500"]).failed_saying(&["from fine to coarse"]);
    lods(&["--levels", "1.5"]).misused_saying(&["from 0 to 1"]);
    lods(&["--levels", "0.5", "--triangles", "9"]).misused_saying(&["cannot be used with"]);
    lods(&["--max-flip", "0"]).misused_saying(&["above 0"]);
    lods(&["--fov", "180"]).misused_saying(&["from 1 to 179"]);
    let into_file = ["lods", "oak.glb", "-o", "x.glb", "--layout", "files"];
    bench
        .run(&into_file)
        .failed_saying(&["x.glb", "needs a folder"]);
    let twice = ["lods", "oak.glb", "./oak.glb", "-o", "chain"];
    bench.run(&twice).failed_saying(&["same name"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// A report where a level goes would be lost, or the level.
#[test]
fn nothing_else_goes_where_a_level_or_the_input_is() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("chain")).unwrap();
    let lods = |more: &[&str]| {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            "chain",
            "--levels",
            "0.2",
            "--overwrite",
        ];
        bench.run(&[&lods[..], more].concat())
    };
    lods(&["--report", "chain/oak_LOD0.glb"]).failed_saying(&["two outputs are this file"]);
    lods(&["--preview", "p", "--report", "./p"]).failed_saying(&["two outputs are this file"]);
    lods(&["--report", "oak.glb"]).failed_saying(&["oak.glb", "is the input"]);
    assert_eq!(std::fs::read_dir(bench.path("chain")).unwrap().count(), 0);
    // A folder stands where the second level should go: the first does not appear.
    std::fs::create_dir(bench.path("chain/oak_LOD1.glb")).unwrap();
    let two = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--levels",
        "0.2,0.1",
        "--overwrite",
    ];
    bench.run(&two).failed_saying(&["oak_LOD1.glb"]);
    assert_eq!(std::fs::read_dir(bench.path("chain")).unwrap().count(), 1);
}

#[test]
fn levels_of_another_run_are_not_replaced_unasked() {
    let bench = Bench::new();
    let lods = ["lods", "oak.glb", "-o", "chain", "--levels", "0.2"];
    bench.run(&lods).succeeded();
    bench
        .run(&lods)
        .failed_saying(&["oak_LOD0.glb", "is there already", "--overwrite"]);
    bench
        .run(&[&lods[..], &["--overwrite"]].concat())
        .succeeded();
}
