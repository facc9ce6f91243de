//! Methods that views do not drive, from a file to a file.

use secateur::Tree;
use serde_json::Value;

use crate::program::{Bench, OAK_LEAVES};

fn number(record: &Value, pointer: &str) -> f64 {
    record.pointer(pointer).and_then(Value::as_f64).unwrap()
}

const METHODS: [&[&str]; 14] = [
    &["chain"],
    &["merge"],
    &["merge", "--cluster-size", "area"],
    &["chain", "--branch-metric", "children"],
    &["chain", "--branch-metric", "descendants"],
    &["chain", "--branch-metric", "longest-path"],
    &["fsa"],
    &["fsa", "--corners", "furthest"],
    &["fsa", "--corners", "furthest", "--hausdorff", "surface"],
    &["stochastic"],
    &["meshopt"],
    &["meshopt", "--meshopt-mode", "sloppy"],
    &["meshopt", "--preserve-area"],
    &["meshopt", "--dilate-borders"],
];

#[test]
fn every_method_writes_a_valid_tree_with_the_leaves_that_it_reports() {
    let bench = Bench::new();
    let mut files = Vec::new();
    for (k, method) in METHODS.iter().enumerate() {
        let out = format!("out{k}.glb");
        let rest = [
            "--ratio", "0.25", "--report", "r.json", "--audit", "--method",
        ];
        let arguments = [&["oak.glb", "-o", &out], &rest[..], method].concat();
        bench.simplify(&arguments).succeeded();
        let report = bench.json("r.json");
        assert_eq!(report["method"], method[0]);
        assert!(report["audit"].is_string());
        let leaves = number(&report, "/leaves/final");
        if method[0] != "meshopt" {
            assert_eq!(leaves, 0.25 * OAK_LEAVES as f64);
        }
        assert!(0.0 < leaves && leaves <= OAK_LEAVES as f64, "{leaves}");
        let tree = Tree::open(&bench.path(&out), &[]).unwrap();
        // Sloppy triangles hang several leaves together.
        if !method.contains(&"sloppy") {
            assert_eq!(tree.foliage().leaves().len() as f64, leaves, "{method:?}");
        }
        assert_eq!(
            tree.triangle_count() as f64,
            number(&report, "/triangles/final")
        );
        files.push(bench.path(&out));
    }
    crate::validator::assert_valid(&files);
}

#[test]
fn the_same_seed_draws_the_same_lots() {
    let bench = Bench::new();
    let order = |seed: &str| {
        let rest = ["--method", "stochastic", "--ratio", "0.5", "--seed", seed];
        let files = ["oak.glb", "-o", "out.glb", "--report", "r.json"];
        bench.simplify(&[&files[..], &rest].concat()).succeeded();
        bench.json("r.json")["order_sha256"].clone()
    };
    assert_eq!(order("1"), order("1"));
    assert_ne!(order("1"), order("2"));
}

#[test]
fn an_error_is_not_exceeded_and_one_more_step_would() {
    let bench = Bench::new();
    for method in ["fsa", "stochastic", "chain", "merge"] {
        let run = |target: [&str; 2]| {
            let files = [
                "oak.glb", "-o", "out.glb", "--report", "r.json", "--method", method,
            ];
            bench.simplify(&[&files[..], &target].concat()).succeeded();
            let report = bench.json("r.json");
            let error = number(&report, "/driving_vmi_error_percent");
            (
                number(&report, "/leaves/final") as u64,
                error,
                report["stopped"].clone(),
            )
        };
        let (leaves, error, stopped) = run(["--max-error", "20"]);
        assert_eq!(stopped, "max error");
        assert!(
            error <= 20.0 && 0 < leaves && leaves < OAK_LEAVES,
            "{method} {leaves}"
        );
        let (_, next, _) = run(["--leaves", &(leaves - 1).to_string()]);
        assert!(next > 20.0, "{method}: {next}");
    }
}

#[test]
fn weights_out_of_range_are_wrong_usage() {
    let bench = Bench::new();
    let files = ["oak.glb", "-o", "out.glb", "--ratio", "0.5", "--method"];
    for (method, option, value, says) in [
        ("stochastic", "--area-weight", "1.5", "from 0 to 1"),
        ("fsa", "--distance-weight", "0", "above 0"),
        ("fsa", "--planarity-weight", "-1", "from 0 upwards"),
        ("fsa", "--planarity-weight", "NaN", "from 0 upwards"),
    ] {
        let run = bench.simplify(&[&files[..], &[method, option, value]].concat());
        run.misused_saying(&[value, says]);
    }
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// Branches go whole, so levels of the chain that have been simplified before
/// give the same as those of the grown tree.
#[test]
fn a_simplified_tree_keeps_its_skeleton() {
    let bench = Bench::new();
    let run = |from: &str, to: &str, leaves: &str| {
        let rest = ["--leaves", leaves, "--method", "chain", "--no-audit"];
        let ran = bench.simplify(&[&[from, "-o", to], &rest[..]].concat());
        ran.succeeded();
        Tree::open(&bench.path(to), &[]).unwrap()
    };
    run("oak.glb", "half.glb", "120");
    let twice = run("half.glb", "twice.glb", "60");
    let once = run("oak.glb", "once.glb", "60");
    assert_eq!(twice.foliage().triangles(), once.foliage().triangles());
    assert_eq!(twice.skeleton().unwrap(), once.skeleton().unwrap());
}

#[test]
fn a_tree_without_skeleton_is_refused_in_one_sentence() {
    let bench = Bench::new();
    let oak = secateur_plant::GrowOptions {
        leaves: 20,
        seed: 1,
    };
    let mut plant = secateur_plant::grow(secateur_plant::Species::Oak, &oak).unwrap();
    plant.skeleton = None;
    bench.put("bare.glb", &secateur::plant_to_glb(&plant));
    for method in ["chain", "merge"] {
        let rest = ["-o", "out.glb", "--ratio", "0.5", "--method", method];
        let said = format!(
            "bare.glb: the method {method} needs a tree with a skeleton, which this one has not: \
             `secateur grow` writes one"
        );
        bench
            .simplify(&[&["bare.glb"], &rest[..]].concat())
            .failed_saying(&[&said]);
    }
    assert!(!bench.path("out.glb").exists());
}

#[test]
fn a_damaged_skeleton_matters_only_where_it_is_needed() {
    let bench = Bench::new();
    let glb = bench.read("oak.glb");
    let name = b"\"segment_sides\"";
    let at = glb.windows(name.len()).position(|w| w == name).unwrap();
    let mut damaged = glb;
    damaged[at + 1] = b'S';
    bench.put("damaged.glb", &damaged);
    let run = |method| {
        let rest = ["--ratio", "0.5", "--method", method];
        bench.simplify(&[&["damaged.glb", "-o", "out.glb"], &rest[..]].concat())
    };
    run("merge").failed_saying(&[
        "damaged.glb: extras.secateur_skeleton.accessors: has no `segment_sides`",
    ]);
    run("stochastic").succeeded();
}
