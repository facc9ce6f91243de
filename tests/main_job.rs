//! From a tree to a simplified tree, with its record.

use serde_json::Value;

use crate::program::{Bench, OAK_LEAVES, assert_stages_add_up};

fn number(record: &Value, pointer: &str) -> f64 {
    let value = record.pointer(pointer);
    value
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{pointer} is {value:?}"))
}

#[test]
fn a_tree_becomes_a_lighter_tree_that_can_be_read_again() {
    let bench = Bench::new();
    let before = bench.read("oak.glb");
    let ran = bench
        .simplify(&[
            "oak.glb", "-o", "out.glb", "--ratio", "0.1", "--report", "r.json",
        ])
        .succeeded();
    assert!(ran.stdout.contains("leaves"), "{}", ran.stdout);
    // No progress bar in a pipe; a tenth of so few leaves is another tree.
    let warning = "secateur: warning: the result looks like another plant";
    assert!(ran.stderr.starts_with(warning), "{}", ran.stderr);
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    assert_eq!(bench.names(), ["oak.glb", "out.glb", "r.json"]);
    assert_eq!(bench.read("oak.glb"), before, "the input is untouched");

    let inspected = bench
        .run(&["inspect", "out.glb", "--format", "json"])
        .succeeded();
    let record: Value = serde_json::from_str(&inspected.stdout).unwrap();
    assert_eq!(number(&record, "/foliage/leaves"), 24.0);
    let report = bench.json("r.json");
    assert_eq!(number(&report, "/leaves/final"), 24.0);
    // The file has the triangles that the report says: two a leaf, and the wood.
    let triangles = number(&record, "/foliage/triangles") + number(&record, "/wood_triangles");
    assert_eq!(number(&report, "/triangles/final"), triangles);
    let removed = number(&report, "/triangles/original") - triangles;
    assert_eq!(removed, 2.0 * (OAK_LEAVES as f64 - 24.0));
}

#[test]
fn reports_have_their_keys() {
    let bench = Bench::new();
    bench
        .simplify(&[
            "oak.glb", "-o", "out.glb", "--leaves", "100", "--report", "r.json", "--audit",
        ])
        .succeeded();
    let report = bench.json("r.json");
    assert_eq!(number(&report, "/leaves/original"), OAK_LEAVES as f64);
    assert_eq!(number(&report, "/leaves/final"), 100.0);
    for key in [
        "/triangles/original",
        "/triangles/final",
        "/seconds/total",
        "/seconds/load",
        "/seconds/simplify",
        "/seconds/audit",
        "/seconds/write",
    ] {
        assert!(number(&report, key) > 0.0, "{key}");
    }
    assert_eq!(report["method"], "vds");
    assert_eq!(report["engine"], "cpu", "what auto is");
    assert_eq!(report["adapter"], Value::Null);
    for key in ["order_sha256", "areas_sha256"] {
        let text = report[key].as_str().unwrap();
        assert!(text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit()));
    }
    assert!(number(&report, "/max_area_scale") >= 1.0);
    assert_eq!(report["vmi_bits"].as_array().unwrap().len(), 6);
    assert!(report["vmi_bits"][0].is_f64());
    if cfg!(target_os = "linux") {
        assert!(number(&report, "/peak_rss_bytes") > 1e6);
    }
    assert_eq!(number(&report, "/settings/resolution"), 64.0);
    assert_eq!(report["settings"]["preset"], "look");
    assert_eq!(report["settings"]["resize"], "full");
    assert_eq!(report["settings"]["ties"], "order");
    assert_eq!(report["settings"]["seed"], 0);
    assert_eq!(report["foliage"][0]["material"], "oak leaf");
    assert_eq!(report["run"]["arguments"][0], "simplify");
    assert!(report["audit"].is_string());
}

/// Of a whole plant most of the time is the wood's.
#[test]
fn stages_add_up_to_the_time() {
    let bench = Bench::new();
    let half = ["simplify", "oak.glb", "-o", "out.glb", "--triangles", "0.5"];
    bench
        .run(&[&half[..], &["--report", "r.json"]].concat())
        .succeeded();
    let report = bench.json("r.json");
    assert_stages_add_up(&report);
    assert!(number(&report, "/seconds/wood") > 0.0);
}

#[test]
fn a_coarser_order_begins_with_the_finer_one() {
    // Every prefix is a LOD: what goes first does not depend on the target.
    use secateur::{Document, Fitting, Options, Resolution, Target, Views, simplify};
    let oak = crate::program::oak().to_vec();
    let document = Document::from_bytes("oak", oak, None).unwrap();
    let tree = document.into_tree(&[]).unwrap();
    let to = |ratio| {
        let options = Options {
            views: Views::Octahedron,
            resolution: Resolution::Pixels(64),
            fit: Fitting::None,
            ..Options::to(Target::leaf_share(ratio))
        };
        simplify(tree.foliage(), &options).unwrap().passes.order
    };
    let (half, mut tenth) = (to(0.5), to(0.1));
    assert_eq!((half.len(), tenth.len()), (120, 216));
    tenth.truncate(120);
    assert_eq!(half, tenth);
}

#[test]
fn the_error_asked_for_is_not_exceeded_and_one_more_step_would() {
    let bench = Bench::new();
    let run = |target: [&str; 2]| {
        let rest = [
            "oak.glb", "-o", "out.glb", "--report", "r.json", "--resize", "none",
        ];
        bench.simplify(&[&rest[..], &target].concat()).succeeded();
        let report = bench.json("r.json");
        let error = number(&report, "/driving_vmi_error_percent");
        (
            number(&report, "/leaves/final") as u64,
            error,
            report["stopped"].clone(),
        )
    };
    let (leaves, error, stopped) = run(["--max-error", "5"]);
    assert_eq!(stopped, "max error");
    assert!(error <= 5.0, "{error}");
    assert!(leaves > 0 && leaves < OAK_LEAVES);
    let (_, next, stopped) = run(["--leaves", &(leaves - 1).to_string()]);
    assert_eq!(stopped, "leaf count");
    assert!(next > 5.0, "{next}");
}

#[test]
fn more_leaves_than_there_are_is_the_tree_unchanged_with_a_warning() {
    let bench = Bench::new();
    let ran = bench
        .simplify(&[
            "oak.glb", "-o", "out.glb", "--leaves", "1000", "--report", "r.json",
        ])
        .succeeded();
    let warning = "secateur: warning: 1000 leaves were asked for and there are 240";
    assert!(ran.stderr.starts_with(warning), "{}", ran.stderr);
    let report = bench.json("r.json");
    assert_eq!(number(&report, "/leaves/final"), OAK_LEAVES as f64);
    assert!(report["warnings"][0].as_str().unwrap().contains("1000"));
}

#[test]
fn no_leaf_at_all_can_be_asked_for() {
    let bench = Bench::new();
    bench
        .simplify(&[
            "oak.glb",
            "-o",
            "out.glb",
            "--leaves",
            "0",
            "--picture",
            "p.png",
        ])
        .succeeded();
    let inspected = bench
        .run(&["inspect", "out.glb", "--format", "json"])
        .succeeded();
    let record: Value = serde_json::from_str(&inspected.stdout).unwrap();
    assert_eq!(record["foliage"], Value::Null, "only wood is left");
    assert!(number(&record, "/wood_triangles") > 0.0);
    assert!(bench.read("p.png").starts_with(b"\x89PNG"));
}

#[test]
fn settings_reach_the_method() {
    let bench = Bench::new();
    let order = |more: &[&str]| {
        let few = [
            "oak.glb", "-o", "out.glb", "--ratio", "0.5", "--report", "r.json",
        ];
        bench.simplify(&[&few, more].concat()).succeeded();
        bench.json("r.json")["order_sha256"].clone()
    };
    let plain = order(&[]);
    assert_eq!(order(&[]), plain, "the same again");
    assert_eq!(order(&["--threads", "1"]), plain, "on one thread");
    for other in [
        ["--preset", "information"],
        ["--reference", "original"],
        ["--resize", "none"],
        ["--neighbours", "3"],
        ["--max-coverage", "0.9"],
        ["--ties", "spread"],
        ["--alpha", "ignore"],
    ] {
        assert_ne!(order(&other), plain, "{other:?}");
    }
}

#[test]
fn the_literal_reference_gives_the_same_order() {
    let bench = Bench::new();
    let order = |method| {
        let few = ["--leaves", "232", "--report", "r.json", "--method", method];
        bench
            .simplify(&[&["oak.glb", "-o", "out.glb"], &few[..]].concat())
            .succeeded();
        bench.json("r.json")["order_sha256"].clone()
    };
    assert_eq!(order("vds-reference"), order("vds"));
}

#[test]
fn cameras_of_ones_own_and_images_of_what_they_see() {
    let bench = Bench::new();
    let cameras = r#"{"cameras": [{"eye": [0, 5, 20], "target": [0, 5, 0]},
                                  {"eye": [20, 5, 0], "target": [0, 5, 0], "fov_y_degrees": 40}]}"#;
    bench.put("cameras.json", cameras.as_bytes());
    bench
        .run(&[
            "simplify",
            "oak.glb",
            "-o",
            "out.gltf",
            "--ratio",
            "0.05",
            "--views",
            "cameras.json",
            "--resolution",
            "32",
            "--debug-images",
            "ids",
            "--report",
            "r.json",
        ])
        .succeeded();
    assert_eq!(bench.json("r.json")["settings"]["view_count"], 2);
    for name in [
        "before-view-00",
        "before-view-01",
        "after-view-00",
        "after-view-01",
    ] {
        let png = bench.read(&format!("ids/{name}.png"));
        assert!(png.starts_with(b"\x89PNG"), "{name}");
    }
    assert_ne!(
        bench.read("ids/before-view-00.png"),
        bench.read("ids/after-view-00.png")
    );
    assert!(bench.names().contains(&"out.bin".to_owned()));
}
