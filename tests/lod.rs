//! `secateur simplify --order` and `secateur lod`: levels along an order, without simplifying again.

use serde_json::Value;

use crate::program::Bench;

/// Methods whose every prefix is what a run to fewer steps writes.
const METHODS: [&[&str]; 7] = [
    &["--fit=none"],
    &["--preset", "information", "--fit=none"],
    &["--preset", "information", "--fit=none", "--neighbours", "3"],
    &["--method", "fsa"],
    &["--method", "stochastic"],
    &["--method", "chain"],
    &["--method", "merge"],
];

/// An order knows no materials: cutoffs stay.
fn simplify(bench: &Bench, out: &str, target: &[&str], method: &[&str]) {
    let files = ["oak.glb", "-o", out, "--cutoffs", "keep"];
    let arguments = [&files[..], target, method].concat();
    bench.simplify(&arguments).succeeded();
}

fn lod(bench: &Bench, out: &str, level: &[&str]) {
    let arguments = [
        &["lod", "oak.glb", "-o", out, "--order", "oak.order"],
        level,
    ]
    .concat();
    bench.run(&arguments).succeeded();
}

#[test]
fn a_level_of_an_order_is_the_file_that_a_run_to_it_writes() {
    let bench = Bench::new();
    let order = ["--leaves", "24", "--order", "oak.order"];
    for method in METHODS {
        simplify(&bench, "end.glb", &order, method);
        assert!(
            bench.read("oak.order").len() < 16 * 240 + 64
                || method.contains(&"merge")
                || method.contains(&"3")
        );
        lod(&bench, "level.glb", &["--leaves", "24"]);
        assert_eq!(bench.read("level.glb"), bench.read("end.glb"), "{method:?}");
        for leaves in ["240", "239", "120", "57"] {
            let target = ["--leaves", leaves, "--report", "r.json"];
            simplify(&bench, "run.glb", &target, method);
            lod(
                &bench,
                "level.glb",
                &["--leaves", leaves, "--report", "l.json"],
            );
            let same = bench.read("level.glb") == bench.read("run.glb");
            assert!(same, "{method:?} to {leaves}");
            let [run, level] = ["r.json", "l.json"].map(|name| bench.json(name));
            for key in ["leaves", "triangles", "foliage_triangles", "order_sha256"] {
                assert_eq!(level[key], run[key], "{method:?} to {leaves}: {key}");
            }
        }
    }
}

/// Coarser leaves are a step before, fitted sizes one after the removals.
#[test]
fn the_end_of_an_order_is_the_run_that_made_it_whatever_passes_ran() {
    let bench = Bench::new();
    let runs: [&[&str]; 5] = [
        &["--ratio", "0.2", "--fit=coverage"],
        &["--ratio", "0.2", "--preset", "information", "--fit=2"],
        &[
            "--triangles",
            "0.2",
            "--leaf-triangles",
            "1",
            "--wood",
            "ignore",
        ],
        &["--max-error", "5", "--fit=none"],
        &["--ratio", "0.2", "--method", "meshopt"],
    ];
    for run in runs {
        simplify(
            &bench,
            "end.glb",
            run,
            &["--order", "oak.order", "--report", "r.json"],
        );
        let leaves = bench.json("r.json")["leaves"]["final"].to_string();
        lod(
            &bench,
            "level.glb",
            &["--leaves", &leaves, "--report", "l.json"],
        );
        assert!(bench.read("level.glb") == bench.read("end.glb"), "{run:?}");
        let steps = bench.json("l.json")["steps"]["original"].to_string();
        lod(&bench, "level.glb", &["--steps", &steps]);
        assert!(bench.read("level.glb") == bench.read("end.glb"), "{run:?}");
        // And at its other end the tree as it was.
        lod(&bench, "level.glb", &["--ratio", "1"]);
        simplify(&bench, "all.glb", &["--ratio", "1"], &["--fit=none"]);
        assert!(bench.read("level.glb") == bench.read("all.glb"), "{run:?}");
    }
}

#[test]
fn the_order_may_lie_in_the_tree() {
    let bench = Bench::new();
    for with in ["with.glb", "with.gltf"] {
        simplify(&bench, "end.glb", &["--leaves", "24"], &["--order", with]);
        bench
            .run(&["lod", with, "-o", "level.glb", "--leaves", "24"])
            .succeeded();
        assert!(bench.read("level.glb") == bench.read("end.glb"));
    }
    // Nothing but the order came to it, and a level of fewer leaves has none.
    let order = |name: &str| {
        let tree = secateur::Tree::open(&bench.path(name), &[]).unwrap();
        tree.order_base64().map(str::len)
    };
    assert!(order("with.glb").is_some_and(|length| length > 1000));
    assert_eq!(order("level.glb"), None);
    crate::validator::assert_valid(&[bench.path("with.glb"), bench.path("level.glb")]);
    let none = ["lod", "oak.glb", "-o", "x.glb", "--leaves", "24"];
    bench
        .run(&none)
        .failed_saying(&["oak.glb", "no removal order in its extras", "--order"]);
}

#[test]
fn an_order_that_is_none_of_this_tree_is_refused_in_a_sentence() {
    let bench = Bench::new();
    simplify(
        &bench,
        "end.glb",
        &["--leaves", "24"],
        &["--order", "oak.order"],
    );
    let order = bench.read("oak.order");
    bench.put("cut", &order[..order.len() / 2]);
    bench.put("empty", b"");
    bench.put(
        "png",
        b"\x89PNG\r\n\x1a\n and more bytes than a head has, whatever they may say....",
    );
    let mut newer = order.clone();
    newer[12] = 9;
    bench.put("newer", &newer);
    let grow = [
        "grow",
        "oak",
        "-o",
        "other.glb",
        "--leaves",
        "240",
        "--seed",
        "6",
    ];
    bench.run(&grow).succeeded();
    let before = bench.names();
    let refused = |tree: &str, order: &str, level: [&str; 2], parts: &[&str]| {
        let arguments = [&["lod", tree, "-o", "x.glb", "--order", order], &level[..]].concat();
        bench.run(&arguments).failed_saying(parts);
        assert_eq!(bench.names(), before, "nothing is written");
    };
    let some = ["--leaves", "100"];
    refused(
        "oak.glb",
        "cut",
        some,
        &["cut: ", "is cut short: it ends in step"],
    );
    refused("oak.glb", "empty", some, &["this is no removal order"]);
    refused("oak.glb", "png", some, &["this is no removal order"]);
    refused("oak.glb", "newer", some, &["of version 9"]);
    refused("oak.glb", "nowhere", some, &["nowhere", "cannot be read"]);
    refused("other.glb", "oak.order", some, &["of another tree"]);
    refused("end.glb", "oak.order", some, &["of another tree"]);
    let few = ["ends at 24 leaves; 23 are fewer", "simplify further"];
    refused("oak.glb", "oak.order", ["--leaves", "23"], &few);
    let more = ["--steps", "100000"];
    refused("oak.glb", "oak.order", more, &["steps; 100000 are more"]);
    // In the extras the same.
    let mut root: Value = serde_json::from_slice(&{
        simplify(
            &bench,
            "end.glb",
            &["--leaves", "24"],
            &["--order", "with.gltf"],
        );
        bench.read("with.gltf")
    })
    .unwrap();
    root["extras"]["secateur_order"]["base64"] = "?".into();
    bench.put("with.gltf", root.to_string().as_bytes());
    bench
        .run(&["lod", "with.gltf", "-o", "x.glb", "--leaves", "24"])
        .failed_saying(&["with.gltf", "no base64"]);
}
