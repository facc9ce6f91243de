//! The GitHub action, run through its script as its composite step runs it.
#![cfg(unix)]

use std::process::Command;

use crate::program::{Bench, Ran, oak};

/// Runs the script on `plants` and `levels`.
fn action(bench: &Bench, mode: &str, options: &[&str]) -> Ran {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../action/run.sh");
    let arguments = [&[script, mode, "plants", "levels"], options].concat();
    let output = Command::new("bash")
        .args(&arguments)
        .env("SECATEUR", env!("CARGO_BIN_EXE_secateur"))
        .env("GITHUB_STEP_SUMMARY", bench.path("summary.md"))
        .current_dir(bench.path("."))
        .output()
        .unwrap();
    Ran::of(&arguments, output)
}

#[test]
fn levels_of_folders_are_made_and_checked() {
    let bench = Bench::new();
    let fast = ["--levels=0.3", "--effort=fast"];
    let more = ["--no-original", "--impostor=none", "--screen-height=270"];
    let options = [&fast[..], &more].concat();
    std::fs::create_dir_all(bench.path("plants/small ones")).unwrap();
    let empty = action(&bench, "make", &options);
    assert!(empty.code == Some(1) && empty.stderr.starts_with("plants: has no .glb"));
    bench.put("plants/oak.glb", oak());
    let bush = "plants/small ones/bush.glb";
    bench
        .run(&["grow", "bush", "--leaves", "40", "-o", bush])
        .succeeded();
    action(&bench, "make", &options).succeeded();
    for file in ["levels/oak_LOD0.glb", "levels/small ones/bush_LOD0.glb"] {
        assert!(bench.path(file).is_file(), "{file}");
    }
    let summary = String::from_utf8(bench.read("summary.md")).unwrap();
    assert!(summary.contains("| "), "{summary}");
    let made = bench.read("levels/oak_LOD0.glb");
    action(&bench, "check", &options).succeeded();
    // Levels that somebody touched, and plants that changed, are named.
    bench.put("levels/oak_LOD0.glb", b"mine");
    let checked = action(&bench, "check", &options);
    assert_eq!(checked.code, Some(1));
    assert!(checked.stdout.contains("plants/oak.glb: "), "{checked:?}");
    assert!(!checked.stdout.contains("bush.glb: "), "{checked:?}");
    bench.put("levels/oak_LOD0.glb", &made);
    bench.put(bush, oak());
    let checked = action(&bench, "check", &options);
    assert!(checked.stdout.contains("plants/small ones/bush.glb: "));
    assert!(!checked.stdout.contains("oak.glb: "), "{checked:?}");
}

/// What the step names is declared, and what is declared is used.
#[test]
fn the_step_takes_each_input() {
    let text = include_str!("../action/action.yml");
    let (inputs, steps) = text.split_once("\nruns:\n").unwrap();
    let inputs = inputs.split_once("\ninputs:\n").unwrap().1;
    let names = inputs.lines().filter_map(|line| line.strip_prefix("  "));
    let names = names.filter(|line| !line.starts_with(' '));
    let mut count = 0;
    for name in names {
        let name = name.trim_end_matches(':');
        assert!(steps.contains(&format!("inputs.{name}")), "{name}");
        count += 1;
    }
    assert_eq!(count, 5);
}
