//! Chains of levels of whole plants.

mod files;
mod impostors;
mod morph;
mod switches;

use std::path::Path;

use secateur::{Document, Tree, surfaces_to_glb};
use secateur_levels::chain::HEIGHTS_PX;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

use crate::program::{Bench, shared_tree};

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

/// Of all that is drawn.
fn height_of(path: &Path) -> f64 {
    let surfaces = Document::open(path).unwrap().surfaces(&[]).unwrap();
    let ys = || {
        surfaces
            .iter()
            .flat_map(|(s, _)| s.positions.iter().map(|p| p.y))
    };
    ys().fold(f64::MIN, f64::max) - ys().fold(f64::MAX, f64::min)
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
    assert_eq!(levels(&record).len(), 4);
    let mut last = Value::Null;
    // The tree itself comes first.
    for (k, (level, share)) in levels(&record)
        .iter()
        .zip([1.0, 0.5, 0.2, 0.08])
        .enumerate()
    {
        let triangles = count(&level["triangles"]);
        let budget = (share * all as f64).round() as u64;
        assert!(
            triangles <= budget && triangles * 10 >= budget * 9,
            "{level}"
        );
        let is_original = k == 0;
        assert_eq!(level["kind"] == "original", is_original);
        assert_eq!(level["distance"] == 0.0, is_original);
        assert_eq!(level["pixels_high"] == Value::Null, is_original);
        assert_eq!(level["difference"] == 0.0, is_original);
        let [foliage, wood] = ["foliage_triangles", "wood_triangles"].map(|key| count(&level[key]));
        assert_eq!(foliage + wood, triangles);
        assert!(foliage > 0 && wood > 0, "{level}");
        let file = bench.path(level["file"].as_str().unwrap());
        assert!(file.ends_with(format!("chain/oak_LOD{k}.glb")));
        assert_eq!(triangles_of(&file), triangles);
        if last != Value::Null {
            let farther = |key: &str| level[key].as_f64().unwrap() - last[key].as_f64().unwrap();
            assert!(farther("distance") > 0.0);
            assert!(k == 1 || farther("pixels_high") < 0.0);
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
    assert!(page.contains("<canvas") && page.contains("LOD3"));
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
    assert_eq!(made[0]["kind"], "original");
    assert!(made.len() > 1, "{}", record["notes"]);
    for pair in made.windows(2) {
        let (before, level) = (&pair[0], &pair[1]);
        let number = |key: &str| level[key].as_f64().unwrap();
        assert!(HEIGHTS_PX.contains(&number("pixels_high")));
        let is_mesh = level["kind"] == "mesh";
        assert!(!is_mesh || level["view_count"] == 20, "{level}");
        assert!(number("difference") <= 0.28, "{level}");
        assert!(number("block_coverage") <= 0.2, "{level}");
        // Each pays, or it would not be there.
        let of_before = |key: &str| before[key].as_f64().unwrap();
        assert!(number("cost") < of_before("cost"), "{level}");
        let most = 2.0 * of_before("triangles");
        assert!(!is_mesh || 3.0 * number("triangles") <= most, "{level}");
    }
    // The first is about as light as the difference lets it be.
    assert!(
        made[1]["difference"].as_f64().unwrap() > 0.23,
        "{}",
        made[1]
    );
    // Each height has a level of its own, or a note says which level serves there.
    let notes = record["notes"].as_array().unwrap();
    let places = |note: &Value| {
        let places = note.as_str()?.strip_prefix("no level begins at ")?;
        let (places, _) = places.split_once(" pixels:")?;
        Some(places.replace(" and ", ", ").split(", ").count())
    };
    let serves: usize = notes.iter().filter_map(places).sum();
    assert_eq!(made.len() - 1 + serves, HEIGHTS_PX.len(), "{notes:?}");
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

/// One mesh at one height has one figure, whichever command says it.
#[test]
fn a_record_says_of_a_level_what_measure_says_of_its_file() {
    let bench = Bench::new();
    let lods = ["lods", "oak.glb", "-o", "chain", "--levels", "0.3,0.15"];
    bench
        .run(&[&lods[..], &["--report", "r.json"]].concat())
        .succeeded();
    let record = bench.json("r.json");
    let made = &levels(&record)[1..];
    assert_eq!(made.len(), 2);
    for level in made {
        let file = level["file"].as_str().unwrap();
        let height = level["pixels_high"].to_string();
        let measure = ["measure", "oak.glb", file, "--report", "m.json"];
        bench
            .run(&[&measure[..], &["--pixels-high", &height]].concat())
            .succeeded();
        let measured = bench.json("m.json");
        for key in ["difference", "block_coverage"] {
            let [ours, theirs] = [level, &measured].map(|said| said[key].as_f64().unwrap());
            assert!((ours - theirs).abs() < 1e-3, "{key}: {ours} for {theirs}");
        }
    }
}

/// Where nothing lighter may be told from the tree, the chain is the tree, and that is said.
#[test]
fn a_default_chain_says_where_no_level_is_light_enough() {
    let bench = Bench::new();
    let lods = ["lods", "oak.glb", "-o", "chain", "--impostor", "none"];
    let strict = ["--max-difference", "0.0125", "--report", "r.json"];
    bench.run(&[&lods[..], &strict].concat()).succeeded();
    let record = bench.json("r.json");
    assert_eq!(levels(&record).len(), 1);
    assert_eq!(levels(&record)[0]["kind"], "original");
    let notes = record["notes"].as_array().unwrap();
    let begins = "no level begins at 1080, 540, 270, 135, 64, 32 and 16 pixels: the plant itself";
    let says = |note: &&Value| note.as_str().unwrap().starts_with(begins);
    assert_eq!(notes.iter().filter(says).count(), 1, "{notes:?}");
}

#[test]
fn each_distance_gets_the_fewest_triangles_within_the_difference_at_its_height() {
    let bench = Bench::new();
    let height = height_of(&bench.path("oak.glb"));
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--distances",
        "5,20,21,80",
        "--fov",
        "60",
        "--screen-height",
        "1080",
        "--report",
        "r.json",
        "--preview",
        "oak.html",
    ];
    bench.run(&lods).succeeded();
    let record = bench.json("r.json");
    let made = &levels(&record)[1..];
    let asked = [5.0, 20.0, 21.0, 80.0];
    let mut before = count(&levels(&record)[0]["triangles"]) as f64;
    for level in made {
        let number = |key: &str| level[key].as_f64().unwrap();
        assert!(asked.iter().any(|d| (d - number("distance")).abs() < 1e-9));
        // 1080 pixels see 2 tan(30 degrees) of the distance.
        let pixels = 1080.0 * height / (2.0 * number("distance") * 30f64.to_radians().tan());
        assert!(
            (number("pixels_high") / pixels - 1.0).abs() < 1e-6,
            "{level}"
        );
        assert!(number("difference") <= 0.28, "{level}");
        let triangles = number("triangles");
        assert!(triangles <= before * 0.9, "saves a tenth: {level}");
        before = triangles;
    }
    // 21 m is too near 20 m for a level of its own, which is said.
    let notes = record["notes"].as_array().unwrap();
    let says = |note: &Value| note.as_str().unwrap().contains("no level begins at 21 m");
    assert!(notes.iter().any(says), "{notes:?}");
    // A note names every place that it speaks of.
    let left_out = notes.iter().filter_map(|note| {
        let places = note.as_str()?.strip_prefix("no level begins at ")?;
        Some(places.split(':').next()?.split([',', 'd']).count())
    });
    assert_eq!(
        made.len() + left_out.sum::<usize>(),
        asked.len(),
        "{notes:?}"
    );
    // Each is drawn down to where the next begins.
    for pair in made.windows(2) {
        let next = pair[1]["pixels_high"].as_f64().unwrap() / 1080.0;
        assert!((pair[0]["screen_coverage"].as_f64().unwrap() - next).abs() < 1e-9);
    }
}

#[test]
fn wood_gets_coarser_as_it_is_asked_for_or_stays() {
    let bench = Bench::for_small_screen();
    let chain = |folder: &str, options: &[&str]| {
        let report = format!("{folder}.json");
        let lods = ["lods", "oak.glb", "-o", folder, "--report", &report];
        bench
            .run(&[&lods[..], &["--no-original"], options].concat())
            .succeeded();
        bench.json(&report)
    };
    let level = |folder: &str| bench.read(&format!("{folder}/oak_LOD0.glb"));
    let [auto, geometry] = ["auto", "geometry"].map(|wood| {
        let record = chain(wood, &["--wood", wood, "--levels", "0.2"]);
        assert_eq!(record["wood"], "geometry");
        (record, level(wood))
    });
    assert_eq!(geometry.1, auto.1);

    let wood = count(&auto.0["wood_triangles"]["original"]);
    let budgets = [wood + 200, wood + 100];
    let budget = budgets.map(|n| n.to_string()).join(",");
    let kept = chain("kept", &["--wood", "keep", "--triangles", &budget]);
    assert_eq!(kept["wood"], "keep");
    for (level, budget) in levels(&kept).iter().zip(budgets) {
        assert_eq!(count(&level["wood_triangles"]), wood, "{level}");
        assert_eq!(count(&level["triangles"]), budget, "{level}");
    }
    // Nearly all of the oak is wood: nothing that keeps it would save a third.
    let keep = ["lods", "oak.glb", "-o", "sought", "--wood", "keep"];
    bench
        .run(&[&keep[..], &["--no-original", "--impostor", "none"]].concat())
        .failed_saying(&["no level would have fewer triangles"]);
    let below = (wood - 1).to_string();
    let says = format!("ask for {wood} or more");
    let keep = ["lods", "oak.glb", "-o", "below", "--wood", "keep"];
    let run = bench.run(&[&keep[..], &["--triangles", &below]].concat());
    run.failed_saying(&["the wood alone has", &says]);
    assert!(!bench.names().contains(&"below".to_owned()));
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
        "--no-original",
        "--triangles",
        "6000,3000",
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
    let bench = Bench::for_small_screen();
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
    lods(&["--levels", nine]).failed_with(2, &["9 levels", "at most 8"]);
    let eight = "0.9,0.8,0.7,0.6,0.5,0.4,0.3,0.2";
    lods(&["--levels", eight, "--impostor", "crossed"]).failed_with(2, &["one too many"]);
    lods(&["--levels", "0.1,0.5"]).failed_with(2, &["from fine to coarse"]);
    lods(&["--triangles", "500,500"]).failed_with(2, &["from fine to coarse"]);
    lods(&["--levels", "0.5,0"]).failed_with(2, &["a level of no triangles"]);
    lods(&["--triangles", "0"]).failed_with(2, &["a level of no triangles"]);
    lods(&["--levels", "0.000001"]).failed_saying(&["no leaf and no piece of wood is left"]);
    lods(&["--levels", "1.5"]).misused_saying(&["from 0 to 1"]);
    lods(&["--levels", "0.5", "--triangles", "9"]).misused_saying(&["cannot be used with"]);
    lods(&["--max-difference", "0"]).misused_saying(&["above 0"]);
    lods(&["--distances", "20,5"]).misused_saying(&["distances must rise"]);
    lods(&["--distances", "5,5"]).misused_saying(&["distances must rise"]);
    lods(&["--distances", "0,5"]).misused_saying(&["from 0.01 to 1000000"]);
    lods(&["--distances", "-5"]).misused_saying(&["from 0.01 to 1000000"]);
    lods(&["--distances", "5,inf"]).misused_saying(&["from 0.01 to 1000000"]);
    lods(&["--distances", "1e-300"]).misused_saying(&["from 0.01 to 1000000"]);
    lods(&["--distances", "5,1e9"]).misused_saying(&["from 0.01 to 1000000"]);
    lods(&["--screen-height", "1e-9"]).misused_saying(&["from 16 to 100000"]);
    lods(&["--screen-height", "1e300"]).misused_saying(&["from 16 to 100000"]);
    lods(&["--wood", "ignore"]).misused_saying(&["invalid value"]);
    lods(&["--distances", "5", "--levels", "0.5"]).misused_saying(&["cannot be used with"]);
    lods(&["--max-pop", "0"]).misused_saying(&["above 0"]);
    lods(&["--impostor", "cloud"]).misused_saying(&["invalid value"]);
    lods(&["--screen-height", "0"]).misused_saying(&["from 16 to 100000"]);
    lods(&["--fov", "180"]).misused_saying(&["from 1 to 179"]);
    let into_file = ["lods", "oak.glb", "-o", "x.glb", "--layout", "files"];
    bench
        .run(&into_file)
        .failed_with(2, &["x.glb", "needs a folder"]);
    let twice = ["lods", "oak.glb", "./oak.glb", "-o", "chain"];
    bench.run(&twice).failed_with(2, &["same name"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// The birch's leaves are polygons without a texture.
#[test]
fn coverage_cannot_be_kept_where_nothing_is_cut_out() {
    let Some(birch) = shared_tree("sap_birch_hex_9k.glb") else {
        return;
    };
    let bench = Bench::new();
    let lods = ["lods", birch.to_str().unwrap(), "-o", "chain"];
    let run = bench.run(&[&lods[..], &["--textures", "fit"]].concat());
    run.failed_saying(&["no texture with alpha cuts out its leaves"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// Two plants of a file are told apart and said, unless they are taken for one.
#[test]
fn plants_that_stand_apart_are_said_and_may_be_one() {
    let bench = Bench::for_small_screen();
    let two = surfaces_to_glb(
        "hedge",
        &[0.0, 40.0].map(|x| {
            let options = GrowOptions {
                leaves: 30,
                seed: 5,
            };
            let mut wood = grow(Species::Bush, &options).unwrap().wood;
            for position in &mut wood.positions {
                position.x += x;
            }
            (wood, false)
        }),
    );
    bench.put("hedge.glb", &two);
    let said = |more: &[&str]| {
        let lods = [
            "lods",
            "hedge.glb",
            "-o",
            "levels",
            "--levels",
            "0.5",
            "--overwrite",
        ];
        let effort = ["--effort", "fast", "--report", "r.json"];
        bench.run(&[&lods[..], &effort, more].concat()).succeeded();
        let record = bench.json("r.json");
        let notes = record["notes"].as_array().unwrap().iter();
        notes
            .filter_map(Value::as_str)
            .find(|note| note.contains("stand apart"))
            .map(str::to_owned)
    };
    let apart = said(&[]).expect("a note");
    assert!(
        apart.starts_with("2 plants stand apart") && apart.contains("`--as-one`"),
        "{apart}"
    );
    assert_eq!(said(&["--as-one"]), None);
}

/// Where no level looks near enough and the plant itself is left out, the error says that.
#[test]
fn a_level_that_looks_like_another_plant_is_refused_with_the_reason() {
    let bench = Bench::for_small_screen();
    let grow = [
        "grow", "bush", "--leaves", "20", "--seed", "204", "-o", "bush.glb",
    ];
    bench.run(&grow).succeeded();
    let lods = [
        "lods",
        "bush.glb",
        "-o",
        "levels",
        "--levels",
        "0.2",
        "--no-original",
    ];
    bench
        .run(&[&lods[..], &["--impostor", "none"]].concat())
        .failed_saying(&["differs by more than 0.28 even 8 pixels high: ask for more triangles"]);
}
