//! The program in pipes and scripts: `-`, errors for programs, exit codes, completions.

use serde_json::Value;

use crate::program::Bench;

#[cfg(unix)]
#[test]
fn plants_flow_through_pipes() {
    let bench = Bench::new();
    let few = "--ratio 0.5 --views 6 --resolution 64";
    let line = format!(
        "\"$SECATEUR\" simplify oak.glb -o out.glb {few} -q && \
         \"$SECATEUR\" simplify - -o - {few} --report r.json < oak.glb > piped.glb && \
         \"$SECATEUR\" inspect - --format json < piped.glb > i.json && \
         \"$SECATEUR\" lods oak.glb -o lods.glb --levels 0.5 --screen-height 270 > lods.txt && \
         cat oak.glb | \"$SECATEUR\" lods - -o - --levels 0.5 --screen-height 270 > lods-piped.glb"
    );
    let ran = bench.run_in_shell(&line).succeeded();
    assert_eq!(ran.stdout, "");
    assert_eq!(bench.read("piped.glb"), bench.read("out.glb"));
    assert_eq!(bench.json("r.json")["output"][0], "-");
    assert_eq!(bench.json("i.json")["run"]["command"], "inspect");
    let piped = bench.read("lods-piped.glb");
    assert!(piped.starts_with(b"glTF"));
    // Levels are called after the plant, which has no name in a pipe.
    let named = String::from_utf8_lossy(&bench.read("lods.glb")).replace("oak_LOD", "plant_LOD");
    assert!(named.contains("plant_LOD1"));
    assert!(String::from_utf8_lossy(&piped).contains("plant_LOD1"));
    let files = "\"$SECATEUR\" lods oak.glb -o - --layout files";
    bench.run_in_shell(files).failed_with(2, &["one file"]);
    let nothing = "\"$SECATEUR\" inspect - < /dev/null";
    bench
        .run_in_shell(nothing)
        .failed_saying(&["standard input"]);
}

#[test]
fn errors_are_told_to_programs_too() {
    let bench = Bench::new();
    bench.put("x.glb", b"not a tree");
    let inspect = |more: &[&str]| bench.run(&[&["inspect"], more].concat());
    for (ran, code, kind) in [
        (inspect(&["x.glb", "--format", "json"]), 1, "input"),
        (inspect(&["x.glb", "--format=json", "--shape"]), 2, "usage"),
        (
            inspect(&["oak.glb", "--format", "json", "--memory", "1K"]),
            4,
            "machine",
        ),
    ] {
        assert_eq!(ran.code, Some(code), "{}", ran.stderr);
        assert_eq!(ran.stdout, "");
        let error: Value = serde_json::from_str(&ran.stderr).unwrap();
        assert_eq!(error["kind"], kind);
        assert_eq!(error["exit_code"], code);
        assert_eq!(error["schema_version"], 1);
        assert!(error["error"].as_str().unwrap().len() > 10);
    }
}

#[test]
fn shells_complete_and_commands_have_man_pages() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = bench.run(&["completions", shell]).succeeded().stdout;
        assert!(script.contains("max-difference"), "{shell}");
    }
    bench
        .run(&["completions", "man"])
        .failed_with(2, &["--output"]);
    bench.run(&["completions", "man", "-o", "man"]).succeeded();
    let page = String::from_utf8(bench.read("man/secateur-lods.1")).unwrap();
    assert!(page.contains("max\\-difference"));
}

#[test]
fn a_dry_run_makes_nothing() {
    let bench = Bench::new();
    let dry = ["lods", "oak.glb", "-o", "levels", "--dry-run"];
    let ran = bench.run(&dry).succeeded();
    assert!(ran.stdout.contains("240 leaves") && ran.stdout.contains("would be made"));
    assert_eq!(bench.names(), ["oak.glb"]);
    bench.put("x.glb", b"not a tree");
    let dry = ["lods", "x.glb", "-o", "levels", "--dry-run"];
    bench.run(&dry).failed_saying(&["x.glb"]);
}
