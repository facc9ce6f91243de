//! What bad input gets: one sentence, exit code 1, and nothing is written.

use serde_json::{Value, json};

use crate::program::{Bench, Ran, oak};
use crate::small_files::{put_changed, two_leaves};

/// Runs something that must fail, and checks that the folder is as it was.
#[track_caller]
pub(crate) fn refused(bench: &Bench, run: impl FnOnce() -> Ran, parts: &[&str]) {
    refused_with(1, bench, run, parts);
}

/// Refuses a run, as [`refused`] does, with another exit code.
#[track_caller]
pub(crate) fn refused_with(code: i32, bench: &Bench, run: impl FnOnce() -> Ran, parts: &[&str]) {
    let contents = |names: &[String]| -> Vec<Vec<u8>> {
        let files = names.iter().filter(|name| bench.path(name).is_file());
        files.map(|name| bench.read(name)).collect()
    };
    let names = bench.names();
    let before = contents(&names);
    run().failed_with(code, parts);
    assert_eq!(bench.names(), names, "nothing is written");
    assert!(contents(&names) == before, "nothing is changed");
}

#[track_caller]
fn input_refused(bench: &Bench, input: &str, parts: &[&str]) {
    let arguments = [
        input, "-o", "out.glb", "--leaves", "1", "--report", "r.json",
    ];
    refused(bench, || bench.simplify(&arguments), parts);
}

/// The tree of two leaves with one thing changed.
#[track_caller]
fn change_refused(pointer: &str, value: Value, parts: &[&str]) {
    let bench = Bench::new();
    put_changed(&bench, pointer, value);
    input_refused(&bench, "tree.gltf", &[&["tree.gltf: "], parts].concat());
}

#[test]
fn files_that_are_no_gltf() {
    let bench = Bench::new();
    bench.put("no.glb", b"hello");
    bench.put("empty.glb", b"");
    bench.put("short.glb", &oak()[..1000]);
    input_refused(&bench, "no.glb", &["no.glb: is not glTF"]);
    input_refused(&bench, "empty.glb", &["empty.glb: is not glTF"]);
    input_refused(&bench, "short.glb", &["short.glb: is truncated"]);
    input_refused(&bench, "gone.glb", &["gone.glb: cannot be read"]);
    input_refused(&bench, ".", &[".: cannot be read"]);
    change_refused(
        "/asset/version",
        json!("1.0"),
        &["is glTF 1.0; only version 2.0"],
    );
}

#[test]
fn buffers_that_are_not_there() {
    let uri = "/buffers/0/uri";
    change_refused(
        uri,
        json!("gone.bin"),
        &["the file `gone.bin` cannot be read"],
    );
    for foreign in [
        "../tree.bin",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://a/b.bin",
    ] {
        change_refused(uri, json!(foreign), &["buffers[0]", foreign]);
    }
    change_refused(uri, json!("a%zz.bin"), &["buffers[0]", "malformed"]);
    change_refused(
        "/buffers/0/byteLength",
        json!(121),
        &["buffers[0]", "121 bytes"],
    );
}

#[test]
fn numbers_that_lie() {
    let count = "/accessors/0/count";
    change_refused(count, json!(9), &["accessors[0]", "asks for bytes"]);
    change_refused(count, json!(u64::MAX), &["accessors[0]"]);
    change_refused(count, json!(1u64 << 62), &["accessors[0]"]);
    change_refused(count, json!(-1), &["accessors[0]", "`count`"]);
    let endless = json!({ "componentType": 5126, "count": 4_000_000_000u64, "type": "VEC3" });
    change_refused(
        "/accessors/0",
        endless,
        &["accessors[0]", "bytes are allowed"],
    );
    change_refused(
        "/bufferViews/0/byteOffset",
        json!(1u64 << 40),
        &["bufferViews[0]"],
    );
    change_refused(
        "/meshes/0/primitives/0/indices",
        json!(7),
        &["`accessors[7]`"],
    );
    change_refused("/nodes/0/children", json!([0]), &["nodes[0]"]);
}

#[test]
fn positions_that_are_no_numbers() {
    for bad in [f32::NAN, f32::INFINITY] {
        let bench = Bench::new();
        put_changed(&bench, "/nodes/0/name", json!("tree"));
        let mut bytes = two_leaves();
        bytes[12..16].copy_from_slice(&bad.to_le_bytes());
        bench.put("tree.bin", &bytes);
        let parts = ["tree.gltf: ", "is not a finite number"];
        input_refused(&bench, "tree.gltf", &parts);
    }
    let huge = json!([1e300, 1e300, 1e300]);
    change_refused("/nodes/0/scale", huge.clone(), &[]);
    change_refused("/nodes/0/translation", huge, &[]);
    let large = json!([1e40, 1e40, 1e40]);
    change_refused("/nodes/0/scale", large, &["out of range"]);
}

#[test]
fn foliage_that_cannot_be_told() {
    let wood = json!({ "name": "bark" });
    change_refused(
        "/materials/0",
        wood,
        &["no foliage was found", "--foliage all"],
    );
    let bench = Bench::new();
    put_changed(&bench, "/materials/0", json!({ "name": "bark" }));
    // To look at it is no failure.
    let shown = bench.run(&["inspect", "tree.gltf"]).succeeded();
    let note = "note: no leaves were found";
    assert!(shown.stdout.contains(note), "{}", shown.stdout);
    let arguments = |selector| {
        [
            "tree.gltf",
            "-o",
            "out.glb",
            "--leaves",
            "1",
            "--foliage",
            selector,
        ]
    };
    let none = || bench.simplify(&arguments("material:leaf"));
    refused(
        &bench,
        none,
        &["`material:leaf` matches nothing", "material:bark"],
    );
    bench.simplify(&arguments("material:b?rk")).succeeded();
}

#[test]
fn foliage_without_a_triangle() {
    let bench = Bench::new();
    put_changed(&bench, "/meshes/0/primitives/0/mode", json!(1));
    let arguments = [
        "tree.gltf",
        "-o",
        "out.glb",
        "--leaves",
        "1",
        "--foliage",
        "material:leaf",
    ];
    let run = || bench.simplify(&arguments);
    refused(&bench, run, &["tree.gltf: ", "no triangle"]);
}

#[test]
fn extensions_that_are_not_known() {
    let required = "/extensionsRequired";
    change_refused(
        required,
        json!(["VND_magic"]),
        &["needs the extension VND_magic"],
    );
}

/// The paper's presets are the paper's in all that they choose; those of this program are where
/// options begin.
#[test]
fn options_that_contradict_a_preset_are_wrong_usage() {
    let bench = Bench::new();
    let files = ["simplify", "oak.glb", "-o", "out.glb", "--leaves", "200"];
    let paper =
        |preset, more: &[&str]| bench.run(&[&files[..], &["--preset", preset], more].concat());
    for (option, value) in [
        ("--resolution", "512"),
        ("--resolution", "auto"),
        ("--alpha", "mask"),
        ("--reference", "previous"),
        ("--resize", "full"),
        ("--max-coverage", "1"),
        ("--neighbours", "4"),
        ("--ties", "spread"),
        ("--leaf-triangles", "auto"),
        ("--views", "92"),
        ("--method", "fsa"),
    ] {
        let says = [option, "contradicts `--preset paper`"];
        paper("paper", &[option, value]).misused_saying(&says);
    }
    paper("paper-none", &["--resize", "literal"])
        .misused_saying(&["`--resize` contradicts `--preset paper-none`"]);
    paper("paper", &["--fit=coverage"]).misused_saying(&["--fit", "contradicts"]);
    assert_eq!(bench.names(), ["oak.glb"]);

    let agreeing = [
        "--resolution",
        "256",
        "--alpha",
        "ignore",
        "--resize",
        "literal",
        "--fit=none",
        "--max-coverage",
        "none",
        "--views",
        "20",
        "--report",
        "r.json",
    ];
    paper("paper", &agreeing).succeeded();
    let settings = &bench.json("r.json")["settings"];
    assert_eq!(settings["preset"], "paper");
    assert_eq!(
        (&settings["resolution"], &settings["view_count"]),
        (&256.into(), &20.into())
    );
    assert_eq!(
        (&settings["reference"], &settings["resize"]),
        (&"original".into(), &"literal".into())
    );
    assert!(settings["fit"].is_null() && settings["max_coverage"].is_null());
    let of_plain = bench.json("r.json")["order_sha256"].clone();
    paper("paper", &["--overwrite", "--report", "r.json"]).succeeded();
    assert_eq!(bench.json("r.json")["order_sha256"], of_plain);
    paper(
        "information",
        &["--overwrite", "--resize", "literal", "--resolution", "64"],
    )
    .succeeded();
}

#[test]
fn numbers_out_of_range_are_wrong_usage() {
    let bench = Bench::new();
    let files = ["oak.glb", "-o", "out.glb"];
    for (option, value, says) in [
        ("--leaves", "-1", "a whole number from 0 upwards"),
        ("--ratio", "-0.5", "a number from 0 to 1"),
        ("--ratio", "1.5", "a number from 0 to 1"),
        ("--ratio", "nan", "a number from 0 to 1"),
        ("--max-error", "-2", "a number from 0 upwards"),
        ("--triangles", "-1", "number of triangles from 0 upwards"),
        ("--triangles", "1.5", "a share of them from 0 to 1"),
    ] {
        let run = bench.simplify(&[&files[..], &[option, value]].concat());
        run.misused_saying(&[option, value, says]);
    }
    for value in ["-0.1", "nan"] {
        let options = ["--leaves", "9", "--max-coverage", value];
        let run = bench.simplify(&[&files[..], &options].concat());
        run.misused_saying(&["--max-coverage", value, "a number from 0 upwards"]);
    }
    assert_eq!(bench.names(), ["oak.glb"]);
}

#[test]
fn cameras_that_are_none() {
    let bench = Bench::new();
    bench.put("text.json", b"cameras");
    bench.put("none.json", br#"{"cameras": []}"#);
    bench.put(
        "flat.json",
        br#"{"cameras": [{"eye": [0,0,0], "target": [0,0,0]}]}"#,
    );
    let camera = r#"{"eye": [0,0,9], "target": [0,0,0]}"#;
    let many = format!("{{\"cameras\": [{}]}}", vec![camera; 200].join(","));
    bench.put("many.json", many.as_bytes());
    for (views, parts) in [
        ("text.json", ["text.json: ", "is no list of cameras"]),
        ("none.json", ["none.json: ", "`cameras` is empty"]),
        ("flat.json", ["flat.json: ", "cameras[0]"]),
        (
            "dodecahedra",
            ["dodecahedra: ", "`--views` takes auto, dodecahedron"],
        ),
        ("many.json", ["200 views of 2048 x 2048", "out of range"]),
    ] {
        let arguments = [
            "simplify",
            "oak.glb",
            "-o",
            "out.glb",
            "--leaves",
            "9",
            "--resolution",
            "2048",
            "--views",
            views,
        ];
        refused(&bench, || bench.run(&arguments), &parts);
    }
}

/// Names in files are printed, not obeyed.
#[test]
fn escape_sequences_do_not_reach_the_terminal() {
    let bench = Bench::new();
    let name = "a\u{1b}[31m\u{7}.glb";
    bench.put(name, b"not a tree");
    let run = bench.run(&["inspect", name]);
    assert_eq!(run.code, Some(1));
    let printed = r"a\u{1b}[31m\u{7}.glb";
    assert!(run.stderr.contains(printed), "{}", run.stderr);
    assert!(!run.stderr.contains('\u{1b}'));

    std::fs::copy(bench.path("oak.glb"), bench.path(name)).unwrap();
    let args = [name, "-o", "out.glb", "--leaves", "9"];
    let run = bench.simplify(&args).succeeded();
    assert!(run.stdout.contains(printed), "{}", run.stdout);
    assert!(!run.stdout.contains('\u{1b}'));
}

/// A device that never ends is read as far as the budget allows, not until memory is used up.
#[cfg(target_os = "linux")]
#[test]
fn what_never_ends_is_refused() {
    let bench = Bench::new();
    let endless = "/dev/zero";
    for line in [
        "inspect /dev/zero --memory 4M",
        "simplify oak.glb -o o.glb --leaves 9 --memory 100M --occluder /dev/zero",
    ] {
        let words: Vec<&str> = line.split(' ').collect();
        bench
            .run(&words)
            .lacked_saying(&[endless, "the file", "`--memory`"]);
    }
    // The order has no option for memory: half of what the process may have is its budget.
    let lod =
        "ulimit -v 600000; exec \"$SECATEUR\" lod oak.glb --order /dev/zero --leaves 9 -o o.glb";
    bench
        .run_in_shell(lod)
        .lacked_saying(&[endless, "the file"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// `timeout` ends it by a signal after a second, and would kill it five seconds later.
#[cfg(unix)]
#[test]
fn who_waits_for_an_input_ends_when_it_is_asked_to() {
    let bench = Bench::new();
    for command in ["inspect pipe", "simplify pipe -o out.glb --leaves 1"] {
        let line = format!("rm -f pipe; mkfifo pipe; timeout -k 5 1 $SECATEUR {command}; echo $?");
        let ran = bench.run_in_shell(&line);
        assert_eq!(ran.stdout, "124\n", "{command}: {}", ran.stderr);
        assert!(ran.stderr.contains("stopped"), "{command}: {}", ran.stderr);
    }
}
