//! Tests what the commands print: summaries, tables and JSON.

use serde_json::Value;

use crate::program::Bench;

#[test]
fn every_format_says_the_same() {
    let bench = Bench::new();
    let run = |format| {
        let arguments = [
            "oak.glb", "-o", "out.glb", "--leaves", "60", "--format", format,
        ];
        bench.simplify(&arguments).succeeded().stdout
    };
    let json: Value = serde_json::from_str(&run("json")).unwrap();
    assert_eq!(json["leaves"]["final"], 60);
    let order = json["order_sha256"].as_str().unwrap();

    let csv = run("csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 2, "names and values");
    let place = lines[0].split(',').position(|name| name == "leaves.final");
    assert!(place.is_some() && csv.contains(order), "{csv}");

    let markdown = run("md");
    assert!(markdown.contains("| leaves.final | 60 |"), "{markdown}");
    assert!(markdown.contains(order));
    assert!(run("pretty").contains("leaves"));
}

#[test]
fn quiet_prints_nothing() {
    let bench = Bench::new();
    for arguments in [
        &["inspect", "oak.glb", "-q"][..],
        &[
            "simplify",
            "oak.glb",
            "-o",
            "o.glb",
            "--leaves",
            "999",
            "--resolution",
            "32",
            "-q",
        ],
        &["measure", "oak.glb", "oak.glb", "-q"],
    ] {
        let ran = bench.run(arguments).succeeded();
        assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    }
}

#[test]
fn verbose_tells_what_is_done_on_standard_error() {
    let bench = Bench::new();
    let ran = bench.simplify(&["oak.glb", "-o", "out.glb", "--leaves", "200", "-v"]);
    let ran = ran.succeeded();
    assert!(
        ran.stderr.contains("secateur: reading oak.glb"),
        "{}",
        ran.stderr
    );
}

#[test]
fn inspect_shows_what_was_taken_and_why() {
    let bench = Bench::new();
    let pretty = bench.run(&["inspect", "oak.glb"]).succeeded().stdout;
    assert!(
        pretty.contains("leaves       240 of 480 triangles"),
        "{pretty}"
    );
    assert!(pretty.contains("taken for foliage"), "{pretty}");
    let csv = bench.run(&["inspect", "oak.glb", "--format", "csv"]);
    let csv = csv.succeeded().stdout;
    // A line of names and one for each of the two primitives.
    assert_eq!(csv.lines().count(), 3, "{csv}");
    let by_name = bench.run(&["inspect", "oak.glb", "--foliage", "material:*bark"]);
    assert!(by_name.succeeded().stdout.contains("as selected"));
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_is_no_failure() {
    use std::process::{Command, Stdio};
    let bench = Bench::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_secateur"))
        .args(["inspect", "oak.glb"])
        .current_dir(bench.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stderr, b"");
}
