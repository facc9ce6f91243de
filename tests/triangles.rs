//! Budgets of triangles, and leaves that become coarser for them.

use secateur::{Foliage, Tree, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::{Value, json};

use crate::program::{Bench, OAK_LEAVES};
use crate::small_files::put_changed;

/// 40 leaves of 18 triangles, with cut-outs.
fn with_rowan() -> Bench {
    let bench = Bench::new();
    let options = GrowOptions {
        leaves: 40,
        seed: 2,
    };
    bench.put(
        "rowan.glb",
        &plant_to_glb(&grow(Species::Rowan, &options).unwrap()),
    );
    bench
}

fn simplified(bench: &Bench, tree: &str, options: &[&str]) -> (Foliage, Value) {
    let files = [tree, "-o", "out.glb", "--report", "r.json", "--audit"];
    let of_leaves = ["--wood", "ignore"];
    bench
        .simplify(&[&files, options, &of_leaves].concat())
        .succeeded();
    let tree = Tree::open(&bench.path("out.glb"), &[]).unwrap();
    (tree.foliage().clone(), bench.json("r.json"))
}

#[test]
fn no_method_exceeds_a_budget_of_triangles() {
    let bench = Bench::new();
    for method in ["vds", "fsa", "stochastic", "meshopt", "chain", "merge"] {
        for budget in ["121", "0.25", "0"] {
            let options = [
                "--method",
                method,
                "--triangles",
                budget,
                "--wood",
                "ignore",
            ];
            let files = ["oak.glb", "-o", "out.glb", "--report", "r.json", "--audit"];
            bench.simplify(&[&files[..], &options].concat()).succeeded();
            let report = bench.json("r.json");
            assert_eq!(report["stopped"], "triangles", "{method}");
            assert_eq!(report["foliage_triangles"]["original"], 2 * OAK_LEAVES);
            let left = report["foliage_triangles"]["final"].as_u64().unwrap();
            let most = match budget {
                "121" => 121,
                "0.25" => OAK_LEAVES / 2,
                _ => 0,
            };
            assert!(left <= most, "{method} {budget}: {left}");
            // Leaves of vds become single triangles, those of fsa stay cards.
            match method {
                "vds" => assert_eq!(left, most, "{budget}"),
                "fsa" => assert_eq!(left, most / 2 * 2, "{budget}"),
                _ => (),
            }
        }
    }
}

#[test]
fn leaves_become_coarser_before_they_go() {
    let bench = with_rowan();
    let original = Tree::open(&bench.path("rowan.glb"), &[]).unwrap();
    assert_eq!(original.foliage().triangles().len(), 720);
    let area = |foliage: &Foliage| foliage.leaves().iter().map(|l| l.area()).sum::<f64>();

    let (half, report) = simplified(&bench, "rowan.glb", &["--triangles", "360"]);
    assert_eq!(half.leaves().len(), 40);
    assert!(half.triangles().len() <= 360 && half.triangles().len() > 300);
    assert_eq!(report["settings"]["leaf_triangles"], "auto");
    assert_eq!(report["max_area_scale"], 1.0);

    // Folded leaves with a cut-out get down to one triangle, with all of their texture.
    let (tenth, report) = simplified(&bench, "rowan.glb", &["--triangles", "0.05"]);
    assert_eq!((tenth.leaves().len(), tenth.triangles().len()), (36, 36));
    assert_eq!(report["leaves"]["final"], 36);
    let (solid, _) = simplified(
        &bench,
        "rowan.glb",
        &["--triangles", "0.05", "--alpha", "ignore"],
    );
    assert_eq!((solid.leaves().len(), solid.triangles().len()), (36, 36));

    // What is asked for is done within the budget too.
    let (coarse, _) = simplified(
        &bench,
        "rowan.glb",
        &["--triangles", "1.0", "--leaf-triangles", "4"],
    );
    assert_eq!((coarse.leaves().len(), coarse.triangles().len()), (40, 160));
    assert!((area(&coarse) / area(original.foliage()) - 1.0).abs() < 1e-5);
    let keep = ["--triangles", "360", "--leaf-triangles", "keep"];
    let (kept, _) = simplified(&bench, "rowan.glb", &keep);
    assert_eq!((kept.leaves().len(), kept.triangles().len()), (20, 360));
    let coarse = ["--leaves", "10", "--leaf-triangles", "4"];
    let (coarse, _) = simplified(&bench, "rowan.glb", &coarse);
    assert_eq!((coarse.leaves().len(), coarse.triangles().len()), (10, 40));
    crate::validator::assert_valid(&[bench.path("out.glb")]);
}

/// Fewer views drive what is left; it is looked at from those of its last step.
#[test]
fn a_variable_number_of_views_is_that_of_the_last_step() {
    let bench = with_rowan();
    for (budget, views) in [("0.95", 20), ("0.03", 8)] {
        let files = [
            "rowan.glb",
            "-o",
            "out.glb",
            "--report",
            "r.json",
            "--audit",
        ];
        let rest = [
            "--triangles",
            budget,
            "--wood",
            "ignore",
            "--views",
            "vnc",
            "--resolution",
            "64",
        ];
        bench
            .run(&[&["simplify"], &files[..], &rest].concat())
            .succeeded();
        let report = bench.json("r.json");
        assert_eq!(report["settings"]["view_count"], views, "{budget}");
    }
}

/// In pictures of 16 pixels no leaf is larger than one of them.
#[test]
fn a_record_names_the_views_that_were_found_and_why() {
    let bench = Bench::new();
    for (target, name, count, reason) in [
        ("--triangles", "60", 60, "at most a pixel"),
        ("--ratio", "dodecahedron", 20, "budget of triangles"),
    ] {
        let files = ["simplify", "oak.glb", "-o", "out.glb", "--overwrite"];
        let rest = ["--report", "r.json", target, "0.5", "--resolution", "16"];
        bench.run(&[&files[..], &rest].concat()).succeeded();
        let settings = bench.json("r.json")["settings"].clone();
        assert_eq!(
            (&settings["views"], &settings["view_count"]),
            (&name.into(), &count.into())
        );
        let said = settings["views_reason"].as_str().unwrap();
        assert!(said.contains(reason), "{said}");
        assert_eq!(settings["views_that_judge"], 0);
    }
}

/// By shares of leaves nothing becomes coarser unless it is asked for, and the
/// order over coarser leaves is the literal algorithm's too.
#[test]
fn coarser_leaves_go_in_the_order_of_the_literal_algorithm() {
    let bench = with_rowan();
    let hashes = |options: &[&str]| {
        let (_, report) = simplified(&bench, "rowan.glb", options);
        [&report["order_sha256"], &report["areas_sha256"]].map(Value::clone)
    };
    let coarse = ["--ratio", "0.5", "--leaf-triangles", "2"];
    let literal = [&coarse[..], &["--method", "vds-reference"]].concat();
    assert_eq!(hashes(&coarse), hashes(&literal));
    let keep = [&coarse[..3], &["keep"]].concat();
    assert_eq!(hashes(&coarse[..2]), hashes(&keep));
    assert_ne!(hashes(&coarse), hashes(&keep));
}

#[test]
fn an_error_is_one_against_the_leaves_as_they_were() {
    let bench = with_rowan();
    let run = |target: [&str; 2]| {
        let coarse = [
            "--leaf-triangles",
            "2",
            "--preset",
            "information",
            "--fit=none",
        ];
        let options = [&target[..], &coarse].concat();
        let (left, report) = simplified(&bench, "rowan.glb", &options);
        let error = report["driving_vmi_error_percent"].as_f64().unwrap();
        (left.leaves().len(), error, report["stopped"].clone())
    };
    let (leaves, error, stopped) = run(["--max-error", "12"]);
    assert_eq!(stopped, "max error");
    assert!(
        error <= 12.0 && (1..40).contains(&leaves),
        "{error} {leaves}"
    );
    let (_, next, _) = run(["--leaves", &(leaves - 1).to_string()]);
    assert!(next > 12.0, "{next}");
    // Coarser leaves alone are too much: nothing is done, and that is said.
    let (leaves, error, _) = run(["--max-error", "0"]);
    assert_eq!((leaves, error), (40, 0.0));
    let warnings = bench.json("r.json")["warnings"].to_string();
    assert!(warnings.contains("no leaf became coarser"), "{warnings}");
}

#[test]
fn what_is_no_budget_is_refused() {
    let bench = Bench::new();
    let files = ["oak.glb", "-o", "out.glb"];
    for budget in ["1.5", "-2", "NaN"] {
        let run = bench.simplify(&[&files[..], &["--triangles", budget]].concat());
        run.misused_saying(&[budget, "from 0 to 1"]);
    }
    for wrong in [["--triangles", "few"], ["--leaf-triangles", "0"]] {
        let run = bench.simplify(&[&files[..], &wrong].concat());
        assert_eq!(run.code, Some(2), "{}", run.stderr);
    }
    let more = ["--triangles", "1000", "--wood", "ignore"];
    let run = bench.simplify(&[&files[..], &more].concat()).succeeded();
    assert!(
        run.stderr
            .contains("1000 triangles were asked for and there are 480")
    );
    assert_eq!(bench.names(), ["oak.glb", "out.glb"]);
}

/// Collapses are decided in f32 by C++, which rounds alike everywhere only where
/// it is told to (`.cargo/config.toml`); `tests/architectures.sh` compares more.
#[test]
fn coarser_leaves_are_the_same_on_every_processor() {
    let bench = with_rowan();
    for (options, order, areas) in [
        (
            &["--preset", "information", "--triangles", "0.04"][..],
            "cd5777229bef",
            "ebe1b42d9238",
        ),
        (&["--triangles", "0.04"], "e20e1f93a088", "0e928900d4ec"),
        (
            &["--method", "meshopt", "--triangles", "0.3"],
            "27bf9c8f23dc",
            "bead9989a9c8",
        ),
    ] {
        let (_, report) = simplified(&bench, "rowan.glb", options);
        let found =
            ["order_sha256", "areas_sha256"].map(|key| &report[key].as_str().unwrap()[..12]);
        assert_eq!(found, [order, areas], "{options:?}");
    }
}

/// Two leaves of two triangles, and no wood.
#[test]
fn a_budget_is_met_or_refused_with_what_is_possible() {
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    let files = [
        "simplify",
        "tree.gltf",
        "-o",
        "out.glb",
        "--report",
        "r.json",
    ];
    for budget in ["1", "2", "3", "4"] {
        bench
            .run(&[&files[..], &["--triangles", budget]].concat())
            .succeeded();
        assert_eq!(
            bench.json("r.json")["triangles"]["final"].to_string(),
            budget
        );
    }
    let whole = ["--leaf-triangles", "keep"];
    for (budget, options, said) in [
        ("0", &[][..], "1 is the least that is possible"),
        ("3", &whole, "2 is the most that is possible"),
    ] {
        let arguments = [&files[..], &["--triangles", budget], options].concat();
        bench.run(&arguments).failed_saying(&[said]);
    }
}
