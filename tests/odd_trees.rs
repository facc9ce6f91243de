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

/// A tube of 80 triangles with 20 single ones around it, all of one primitive.
fn put_leaves_and_wood_in_one(bench: &Bench) {
    const SIDES: u16 = 40;
    const LEAVES: u16 = 20;
    let turned = |part: f32, radius: f32, y: f32| {
        let angle = part * std::f32::consts::TAU;
        [radius * angle.cos(), y, radius * angle.sin()]
    };
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut indices: Vec<u16> = Vec::new();
    for k in 0..SIDES {
        let part = f32::from(k) / f32::from(SIDES);
        corners.extend([turned(part, 0.2, 0.0), turned(part, 0.2, 4.0)]);
        let (a, b) = (2 * k, 2 * ((k + 1) % SIDES));
        indices.extend([a, a + 1, b, b, a + 1, b + 1]);
    }
    for k in 0..LEAVES {
        let (part, y) = (f32::from(k) / f32::from(LEAVES), 2.0 + 0.1 * f32::from(k));
        let first = corners.len() as u16;
        corners.extend([
            turned(part, 0.3, y),
            turned(part, 1.0, y),
            turned(part, 0.6, y + 0.4),
        ]);
        indices.extend([first, first + 1, first + 2]);
    }
    let mut bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let of_corners = bytes.len();
    bytes.extend(indices.iter().flat_map(|k| k.to_le_bytes()));
    let mut json = crate::small_files::two_leaves_json();
    json["accessors"] = json!([
        { "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3",
          "min": [-1, 0, -1], "max": [1, 4.5, 1] },
        { "bufferView": 1, "componentType": 5123, "count": indices.len(), "type": "SCALAR" }
    ]);
    json["bufferViews"] = json!([
        { "buffer": 0, "byteLength": of_corners },
        { "buffer": 0, "byteOffset": of_corners, "byteLength": bytes.len() - of_corners }
    ]);
    json["buffers"][0]["byteLength"] = json!(bytes.len());
    bench.put("tree.gltf", json.to_string().as_bytes());
    bench.put("tree.bin", &bytes);
}

#[test]
fn leaves_and_wood_in_one_primitive_are_kept_as_one_and_said() {
    let bench = Bench::for_small_screen();
    put_leaves_and_wood_in_one(&bench);
    let choice = ["--foliage", "material:leaf"];
    for arguments in [
        &["lods", "tree.gltf", "-o", "chain", "--levels", "0.5"][..],
        &["simplify", "tree.gltf", "-o", "out.glb", "--ratio", "0.5"],
    ] {
        let ran = bench.run(&[arguments, &choice].concat()).succeeded();
        let said: Vec<&str> = ran
            .stderr
            .lines()
            .filter(|line| line.contains("leaves and wood in one primitive"))
            .collect();
        let [said] = said[..] else {
            panic!("one sentence, not {}", ran.stderr)
        };
        let expected =
            "20 of its pieces are small and flat and 1 large and round, like leaves and wood";
        assert!(said.starts_with("secateur: warning: ") && said.contains(expected));
        assert!(said.contains("all of it is taken for leaves"), "{said}");
    }
    let inspected = bench.run(&[&["inspect", "tree.gltf"][..], &choice].concat());
    assert!(
        inspected
            .stdout
            .contains("leaves and wood in one primitive")
    );
    // What is one or the other is not.
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    let ran = bench.run(&["inspect", "tree.gltf"]).succeeded();
    assert!(!ran.stdout.contains("in one primitive"), "{}", ran.stdout);
}
