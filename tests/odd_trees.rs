//! Odd trees that are ordinary input all the same.

use serde_json::json;

use crate::program::Bench;
use crate::small_files::{put_changed, two_leaves};

#[track_caller]
fn works(bench: &Bench) {
    for leaves in ["2", "1", "0"] {
        let arguments = [
            "tree.gltf",
            "-o",
            "out.glb",
            "--leaves",
            leaves,
            "--report",
            "r.json",
        ];
        bench.simplify(&arguments).succeeded();
        let report = bench.json("r.json");
        assert_eq!(report["leaves"]["final"].to_string(), leaves);
        // Two triangles a leaf.
        let triangles = 2 * leaves.parse::<u64>().unwrap();
        assert_eq!(report["triangles"]["final"], triangles);
    }
}

#[test]
fn leaves_of_any_size_anywhere() {
    for scale in [1e-20, 1e-4, 1e6, 1e20] {
        let bench = Bench::new();
        put_changed(&bench, "/nodes/0/scale", json!([scale, -scale, scale]));
        works(&bench);
    }
    for place in [1e3, 1e6] {
        let bench = Bench::new();
        put_changed(
            &bench,
            "/nodes/0/translation",
            json!([place, place, -place]),
        );
        works(&bench);
    }
}

#[test]
fn leaves_without_area_and_in_the_same_place() {
    for scale in [[1.0, 0.0, 1.0], [0.0, 0.0, 0.0]] {
        let bench = Bench::new();
        put_changed(&bench, "/nodes/0/scale", json!(scale));
        works(&bench);
    }
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    let mut bytes = two_leaves();
    // The second leaf's corners are the first one's.
    bytes.copy_within(0..48, 48);
    bench.put("tree.bin", &bytes);
    let ran = bench.run(&["simplify", "tree.gltf", "-o", "out.glb", "--leaves", "1"]);
    // Equal triangles are back faces of one leaf or two leaves in one place:
    // whichever, it is no failure.
    ran.succeeded();
}

#[test]
fn cameras_that_see_nothing_or_stand_within() {
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    let away = r#"{"eye": [0, 0, 9], "target": [0, 0, 99]}"#;
    let within = r#"{"eye": [0.5, 0.5, 0.0001], "target": [0.5, 0.5, -1], "near": 0.00001}"#;
    bench.put(
        "cameras.json",
        format!(r#"{{"cameras": [{away}, {within}]}}"#).as_bytes(),
    );
    bench
        .run(&[
            "simplify",
            "tree.gltf",
            "-o",
            "out.glb",
            "--leaves",
            "1",
            "--views",
            "cameras.json",
        ])
        .succeeded();
}
