//! Tests of `secateur measure`: figures, view sets and refusals.

use serde_json::{Value, json};

use crate::glb::{chunks, joined};
use crate::program::{Bench, oak};

#[test]
fn a_tree_is_equal_to_itself() {
    let bench = Bench::new();
    let ran = bench
        .run(&[
            "measure", "oak.glb", "oak.glb", "--format", "json", "--report", "r.json",
        ])
        .succeeded();
    let printed: Value = serde_json::from_str(&ran.stdout).unwrap();
    for record in [printed, bench.json("r.json")] {
        assert_eq!(record["vmi_error_percent"], 0.0);
        for key in ["silhouette_iou", "precision", "recall", "coverage_ratio"] {
            assert_eq!(record[key], 1.0, "{key}");
        }
        assert!(record["ssim"].as_f64().unwrap() > 1.0 - 1e-9);
        for (of, key) in [("worst", "flip_mean"), ("worst", "vmi_error_percent")] {
            assert_eq!(record[of][key], 0.0, "{of} {key}");
        }
        assert_eq!(record["flip_mean"], 0.0);
        assert_eq!(record["per_view"][47]["flip_mean"], 0.0);
        assert_eq!(record["views"], 48);
        assert_eq!(record["rigs"].as_array().unwrap().len(), 4);
        for rig in record["rigs"].as_array().unwrap() {
            assert_eq!(rig["vmi_error_percent"], 0.0);
            assert_eq!(rig["worst"]["silhouette_iou"], 1.0);
            assert_eq!(rig["per_view"].as_array().unwrap().len(), 12);
        }
        assert_eq!(record["resolution"], 512);
    }
}

/// From a quarter of the views, in a quarter of the time.
const FEW_VIEWS: [&str; 2] = ["--views", "icosahedron"];

/// What `measure` says of `out.glb`.
fn judged(bench: &Bench, options: &[&str]) -> Value {
    let files = ["measure", "oak.glb", "out.glb", "--format", "json"];
    let ran = bench.run(&[&files, options].concat());
    serde_json::from_str(&ran.succeeded().stdout).unwrap()
}

#[test]
fn less_is_worse_and_its_silhouette_smaller() {
    let bench = Bench::new();
    let measured = |leaves: &str| {
        let few = [
            "oak.glb", "-o", "out.glb", "--resize", "none", "--leaves", leaves,
        ];
        bench.simplify(&few).succeeded();
        let record = judged(&bench, &FEW_VIEWS);
        [
            "vmi_error_percent",
            "silhouette_iou",
            "precision",
            "coverage_ratio",
        ]
        .map(|key| record[key].as_f64().unwrap())
    };
    let [error, iou, precision, coverage] = measured("120");
    let [more_error, less_iou, ..] = measured("24");
    assert!(error > 0.0 && more_error > error);
    assert!(iou < 1.0 && less_iou < iou);
    // Leaves that only go, and don't grow, add no pixel: those left were there.
    assert_eq!(precision, 1.0);
    assert!((coverage - iou).abs() < 1e-9, "{coverage} {iou}");
}

/// The four sets by themselves, their mean and the worst; and the paper's one set, whose worst is
/// a view.
#[test]
fn sets_of_views_stand_beside_their_mean_and_the_worst() {
    let bench = Bench::for_small_screen();
    let few = ["oak.glb", "-o", "out.glb", "--leaves", "40"];
    bench.simplify(&few).succeeded();
    let record = judged(&bench, &[]);
    let rigs = record["rigs"].as_array().unwrap();
    for (key, lower_is_better) in [
        ("vmi_error_percent", true),
        ("flip_mean", true),
        ("silhouette_iou", false),
        ("ssim", false),
    ] {
        let values: Vec<f64> = rigs.iter().map(|r| r[key].as_f64().unwrap()).collect();
        let mean = values.iter().sum::<f64>() / 4.0;
        assert!(
            (record[key].as_f64().unwrap() - mean).abs() < 1e-12,
            "{key}"
        );
        let worst = values.iter().copied().reduce(match lower_is_better {
            true => f64::max,
            false => f64::min,
        });
        assert_eq!(record["worst"][key].as_f64(), worst, "{key}");
    }
    let one = [
        "measure",
        "oak.glb",
        "out.glb",
        "--views",
        "icosahedron",
        "--format",
        "json",
    ];
    let one: Value = serde_json::from_str(&bench.run(&one).succeeded().stdout).unwrap();
    assert_eq!(one["judged_by"], "icosahedron");
    assert_eq!(
        (&one["views"], one["rigs"].as_array().unwrap().len()),
        (&12.into(), 1)
    );
    assert_eq!(
        one["vmi_error_percent"],
        one["rigs"][0]["vmi_error_percent"]
    );
    assert_eq!(one["worst"], one["rigs"][0]["worst"]);
    let said = bench
        .run(&["measure", "oak.glb", "out.glb"])
        .succeeded()
        .stdout;
    assert!(
        said.contains("4 sets of 12 views of 512 x 512 pixels: mean and worst set"),
        "{said}"
    );
}

/// 92 views hold the dual icosahedron: the report says so, and so does what is printed.
#[test]
fn a_run_that_knows_its_judges_says_so() {
    let bench = Bench::new();
    for (views, count) in [("92", 12), ("icosahedron", 0), ("vnc", 0), ("20", 0)] {
        let few = [
            "simplify",
            "oak.glb",
            "-o",
            "out.glb",
            "--leaves",
            "20",
            "--views",
            views,
            "--report",
            "r.json",
            "--overwrite",
            "--resolution",
            "64",
        ];
        let said = bench.run(&few).succeeded().stdout;
        assert_eq!(
            bench.json("r.json")["settings"]["views_that_judge"],
            count,
            "{views}"
        );
        assert_eq!(
            said.contains("judges by 12 of them too"),
            count > 0,
            "{views}: {said}"
        );
    }
}

#[test]
fn a_crown_gets_no_denser_than_asked() {
    let bench = Bench::new();
    let coverage = |more: &[&str]| {
        let few = [
            "oak.glb",
            "-o",
            "out.glb",
            "--reference",
            "original",
            "--leaves",
            "12",
        ];
        bench.simplify(&[&few, more].concat()).succeeded();
        judged(&bench, &FEW_VIEWS)["coverage_ratio"]
            .as_f64()
            .unwrap()
    };
    let free = coverage(&["--max-coverage", "none"]);
    let kept = coverage(&["--max-coverage", "1", "--fit=none"]);
    let thin = coverage(&["--max-coverage", "0.8"]);
    let never = coverage(&["--max-coverage", "0"]);
    // Judged by other views than those that drive, and after one growth more.
    assert!(free > kept + 0.02, "{free} {kept}");
    assert!((kept - 1.0).abs() < 0.03, "{kept}");
    assert!((thin - 0.8).abs() < 0.06, "{thin}");
    assert!(never < 0.1, "{never}");
}

#[test]
fn what_is_no_tree_is_one_sentence() {
    let bench = Bench::new();
    bench.put("no.glb", b"not a tree");
    for arguments in [["no.glb", "oak.glb"], ["oak.glb", "no.glb"]] {
        bench
            .run(&[&["measure"], &arguments[..]].concat())
            .failed_saying(&["no.glb: is not glTF"]);
    }
}

/// Cut-outs fade away where their mip levels' alpha falls below the cutoff: a client far off shows
/// less of the original than there is, and hardly any of the difference that is there near by.
#[test]
fn what_a_client_draws_is_held_against_what_is_there() {
    let bench = Bench::for_small_screen();
    let drawn = |width: &str| {
        let measure = ["measure", "oak.glb", "oak.glb", "--format", "json"];
        let ran = bench.run(&[&measure[..], &["--as-drawn", width]].concat());
        let record: Value = serde_json::from_str(&ran.succeeded().stdout).unwrap();
        let number = |key: &str| record["as_drawn"][key].as_f64().unwrap();
        assert_eq!(
            number("coverage_over_truth"),
            number("original_coverage_over_truth")
        );
        assert_eq!(
            number("specks_per_view"),
            number("original_specks_per_view")
        );
        assert_eq!(number("silhouette_iou"), 1.0);
        assert_eq!(number("truth_iou"), number("original_truth_iou"));
        let frames = ["over_frames", "original_over_frames"].map(|key| &record["as_drawn"][key]);
        assert_eq!(frames[0], frames[1]);
        assert_eq!(frames[0]["frames"], 16);
        // What fades in one frame fades in all.
        let coverage = frames[0]["coverage_over_truth"].as_f64().unwrap();
        assert!(
            (coverage - number("coverage_over_truth")).abs() < 0.05,
            "{coverage}"
        );
        let overlap = frames[0]["truth_iou"].as_f64().unwrap();
        assert!(
            overlap >= number("truth_iou") && overlap <= 1.0,
            "{overlap}"
        );
        let [flicker, true_flicker] =
            ["flicker", "truth_flicker"].map(|key| frames[0][key].as_f64().unwrap());
        // Fewer leaves are left to flicker where mip maps lose them.
        assert!(
            flicker < true_flicker || width == "512",
            "{flicker} {true_flicker}"
        );
        if width == "32" {
            let printed = bench.run(&["measure", "oak.glb", "oak.glb", "--as-drawn", width]);
            let told =
                format!("the original itself: {flicker:.4}, without mip maps {true_flicker:.4}");
            assert!(printed.succeeded().stdout.contains(&told), "{told}");
        }
        let without = &record["as_drawn"]["original_without_mips"];
        let without = without["coverage_over_truth"].as_f64().unwrap();
        (number("coverage_over_truth"), without)
    };
    let ((near, _), (far, without)) = (drawn("512"), drawn("32"));
    assert!((0.9..1.1).contains(&near), "{near}");
    assert!(far < near, "{far} of {near}");
    // Each pixel shows what is at its middle: all together as much as there is.
    assert!((0.9..1.1).contains(&without), "{without}");
    let wrong = bench.run(&["measure", "oak.glb", "oak.glb", "--as-drawn", "4"]);
    assert_eq!(wrong.code, Some(2));
}

/// Ten units beside its original, and half as large.
#[test]
fn another_size_and_another_place_are_said() {
    let bench = Bench::for_small_screen();
    let (json, bin) = chunks(oak());
    let mut root: Value = serde_json::from_slice(json).unwrap();
    let scene = root["scene"].as_u64().unwrap_or(0) as usize;
    let roots = root["scenes"][scene]["nodes"].clone();
    let count = root["nodes"].as_array().unwrap().len();
    let mut put = |name: &str, change: Value| {
        let mut parent = change;
        parent["children"] = roots.clone();
        let nodes = root["nodes"].as_array_mut().unwrap();
        nodes.truncate(count);
        nodes.push(parent);
        root["scenes"][scene]["nodes"] = json!([count]);
        bench.put(name, &joined(&root, bin));
    };
    put("beside.glb", json!({"translation": [10, 0, 0]}));
    put("half.glb", json!({"scale": [0.5, 0.5, 0.5]}));
    put("same.glb", json!({"translation": [0, 0, 0]}));
    for (other, is_said) in [
        ("beside.glb", true),
        ("half.glb", true),
        ("same.glb", false),
    ] {
        let ran = bench.run(&["measure", "oak.glb", other]).succeeded();
        let says = ran.stderr.contains("do not hold the same plant");
        assert_eq!(says, is_said, "{other}: {}", ran.stderr);
    }
}
