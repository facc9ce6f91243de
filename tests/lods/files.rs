//! What `lods` writes over and what it leaves: files of other runs, of earlier ones, and its own inputs.

use serde_json::Value;

use crate::program::{Bench, assert_stages_add_up};

/// A report where a level goes would be lost, or the level.
#[test]
fn nothing_else_goes_where_a_level_or_the_input_is() {
    let bench = Bench::for_small_screen();
    std::fs::create_dir(bench.path("chain")).unwrap();
    let lods = |more: &[&str]| {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            "chain",
            "--levels",
            "0.2",
            "--overwrite",
        ];
        bench.run(&[&lods[..], more].concat())
    };
    lods(&["--report", "chain/oak_LOD0.glb"]).failed_saying(&["two outputs are this file"]);
    lods(&["--preview", "p", "--report", "./p"]).failed_saying(&["two outputs are this file"]);
    lods(&["--report", "oak.glb"]).failed_saying(&["oak.glb", "is the input"]);
    assert_eq!(std::fs::read_dir(bench.path("chain")).unwrap().count(), 0);
    // A folder stands where the second level should go: the first does not appear.
    std::fs::create_dir(bench.path("chain/oak_LOD1.glb")).unwrap();
    let two = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--levels",
        "0.2,0.1",
        "--overwrite",
    ];
    bench.run(&two).lacked_saying(&["oak_LOD1.glb"]);
    assert_eq!(std::fs::read_dir(bench.path("chain")).unwrap().count(), 1);
}

#[test]
fn levels_of_another_run_are_not_replaced_unasked() {
    let bench = Bench::for_small_screen();
    let lods = ["lods", "oak.glb", "-o", "chain", "--levels", "0.2"];
    bench.run(&lods).succeeded();
    let others = ["lods", "oak.glb", "-o", "chain", "--levels", "0.3"];
    bench
        .run(&others)
        .failed_saying(&["oak_LOD0.glb", "is there already", "--overwrite"]);
    bench
        .run(&[&others[..], &["--overwrite"]].concat())
        .succeeded();
}

/// Two trees, of which one call makes both, the next none, and others what is missing or has changed.
#[test]
fn what_is_finished_and_unchanged_is_not_done_again() {
    let bench = Bench::for_small_screen();
    std::fs::copy(bench.path("oak.glb"), bench.path("ash.glb")).unwrap();
    let run = |levels: &str| {
        bench.run(&[
            "lods", "oak.glb", "ash.glb", "-o", "chain", "--levels", levels, "--report", "r.json",
        ])
    };
    let refused = |levels: &str, file: &str| {
        let ran = run(levels);
        assert_eq!(ran.code, Some(3), "{}", ran.stderr);
        let sentence = format!("chain/{file}: is there already");
        assert!(ran.stderr.contains(&sentence), "{}", ran.stderr);
    };
    // A record a line, of the shape that one tree alone has.
    let records = || -> Vec<Value> {
        let text = String::from_utf8(bench.read("r.json")).unwrap();
        let lines = text.lines();
        lines
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    };
    let kept = || -> Vec<bool> {
        let records = records().into_iter();
        records
            .map(|record| record["kept"].as_bool().unwrap())
            .collect()
    };
    run("0.2,0.1").succeeded();
    assert_eq!(kept(), [false, false]);
    let first = records();
    assert_eq!(first[1]["input"], "ash.glb");
    for record in &first {
        assert_stages_add_up(record);
    }
    let level = bench.read("chain/oak_LOD1.glb");
    let ran = run("0.2,0.1").succeeded();
    assert_eq!(kept(), [true, true]);
    assert!(
        ran.stdout.contains("as it was made before"),
        "{}",
        ran.stdout
    );
    assert_eq!(records()[0]["levels"], first[0]["levels"]);
    // Ended before its last level had its name: that tree is done again, to the same bytes.
    std::fs::remove_file(bench.path("chain/oak_LOD1.glb")).unwrap();
    run("0.2,0.1").succeeded();
    assert_eq!(kept(), [false, true]);
    assert_eq!(bench.read("chain/oak_LOD1.glb"), level);
    // A level that someone has changed is not the program's own any more.
    std::fs::write(bench.path("chain/ash_LOD0.glb"), "mine").unwrap();
    refused("0.2,0.1", "ash_LOD0.glb");
    assert_eq!(bench.read("chain/ash_LOD0.glb"), b"mine");
    std::fs::remove_file(bench.path("chain/ash_LOD0.glb")).unwrap();
    // Other options, and another tree of the same name, are other levels.
    refused("0.2,0.05", "oak_LOD0.glb");
    let fewer = [
        "simplify",
        "oak.glb",
        "-o",
        "oak.glb.glb",
        "--leaves",
        "100",
    ];
    bench.run(&fewer).succeeded();
    std::fs::rename(bench.path("oak.glb.glb"), bench.path("oak.glb")).unwrap();
    refused("0.2,0.1", "oak_LOD0.glb");
}

/// Of two trees the second is broken: nothing is made of the first, where that is asked for.
#[test]
fn a_broken_tree_among_others_may_stop_them_all_before_anything_is_written() {
    let bench = Bench::for_small_screen();
    std::fs::write(bench.path("broken.glb"), &bench.read("oak.glb")[..500]).unwrap();
    let run = bench.run(&[
        "lods",
        "oak.glb",
        "broken.glb",
        "-o",
        "chain",
        "--levels",
        "0.2",
        "--keep-going=false",
    ]);
    run.failed_saying(&["broken.glb"]);
    assert_eq!(bench.names(), ["broken.glb", "oak.glb"]);
}

/// One bad file stops none of the others, unless that is asked for.
#[test]
fn of_several_trees_those_that_can_be_done_are() {
    let bench = Bench::for_small_screen();
    bench.put("bad.glb", b"glTF");
    bench.put("ash.glb", &bench.read("oak.glb"));
    let lods = ["lods", "bad.glb", "oak.glb", "none.glb", "ash.glb"];
    let how = [
        "-o",
        "levels",
        "--levels",
        "0.3",
        "--no-original",
        "--format",
        "json",
    ];
    let ran = bench.run(&[&lods[..], &how].concat());
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    let errors: Vec<&str> = ran.stderr.lines().filter(|l| l.contains("error")).collect();
    assert_eq!(errors.len(), 2, "{}", ran.stderr);
    let records = ran
        .stdout
        .lines()
        .map(|line| serde_json::from_str(line).unwrap());
    let records: Vec<Value> = records.collect();
    let inputs: Vec<&str> = records
        .iter()
        .map(|r| r["input"].as_str().unwrap())
        .collect();
    assert_eq!(inputs, ["oak.glb", "ash.glb", "bad.glb", "none.glb"]);
    for (record, is_done) in records.iter().zip([true, true, false, false]) {
        assert_eq!(record["schema_version"], 1);
        assert_eq!(record["levels"].is_array(), is_done);
        assert_eq!(record["error"].is_string(), !is_done);
    }
    let there = |name: &str| bench.path(&format!("levels/{name}_LOD0.glb")).is_file();
    assert!(there("oak") && there("ash"));
    // Only what is done is told of once more.
    let pretty = bench.run(&[&lods[..], &how[..5]].concat());
    assert_eq!(pretty.code, Some(3));
    assert!(pretty.stdout.contains("2 of 4 failed"), "{}", pretty.stdout);
    // Or else the first failure ends it, before anything is made.
    let stops = ["-o", "others", "--keep-going=false"];
    let ran = bench.run(&[&lods[..], &stops].concat());
    ran.failed_saying(&["bad.glb"]);
    assert!(!bench.path("others").exists());
    // A single tree fails as it did.
    let alone = bench.run(&["lods", "bad.glb", "-o", "others"]);
    alone.failed_saying(&["bad.glb"]);
}

#[test]
fn no_input_of_a_call_is_overwritten() {
    let bench = Bench::for_small_screen();
    bench.put("oak_LOD0.glb", &bench.read("oak.glb"));
    let before = bench.read("oak_LOD0.glb");
    let how = ["-o", ".", "--levels", "0.3", "--overwrite"];
    let two = bench.run(&[&["lods", "oak.glb", "oak_LOD0.glb"], &how[..]].concat());
    two.failed_saying(&["oak_LOD0.glb", "is an input of this call"]);
    let hidden = ["--occluder", "oak_LOD0.glb"];
    let behind = bench.run(&[&["lods", "oak.glb"], &how[..], &hidden].concat());
    behind.failed_saying(&["oak_LOD0.glb", "is an input of this call"]);
    assert_eq!(bench.read("oak_LOD0.glb"), before);
    assert_eq!(bench.names(), ["oak.glb", "oak_LOD0.glb"]);
}

/// Levels are passed on with what is noted beside them: neither says in which folders they were made. The next call
/// finds them all the same.
#[test]
fn files_name_no_folder_of_the_machine() {
    let bench = Bench::for_small_screen();
    let [tree, folder, page, report] = ["oak.glb", "out", "page.html", "r.json"]
        .map(|file| bench.path(file).display().to_string());
    let call = [
        "lods",
        &tree,
        "-o",
        &folder,
        "--levels",
        "0.3",
        "--preview",
        &page,
        "--report",
        &report,
    ];
    bench.run(&call).succeeded();
    let first = bench.json("r.json");
    let machine = bench.path("").display().to_string();
    let machine = machine.trim_end_matches('/');
    for file in [
        "out/oak_LOD0.glb",
        "out/oak_LOD1.glb",
        "out/.oak_lods.json",
        "page.html",
    ] {
        let text = String::from_utf8_lossy(&bench.read(file)).into_owned();
        assert!(!text.contains(machine), "{file}");
    }
    let again = bench.run(&call).succeeded();
    assert!(
        again.stdout.contains(&format!("{folder}/oak_LOD1.glb")),
        "{}",
        again.stdout
    );
    let kept = bench.json("r.json");
    assert_eq!(kept["kept"], true);
    for key in ["input", "files", "preview", "levels"] {
        assert_eq!(kept[key], first[key], "{key}");
    }
    let level = bench.read("out/oak_LOD1.glb");
    let root: Value = serde_json::from_slice(crate::glb::chunks(&level).0).unwrap();
    let materials = root["materials"].as_array().unwrap();
    let is_of_level = |material: &Value| material["name"].as_str().unwrap().ends_with("_LOD1");
    assert!(materials.iter().all(is_of_level), "{materials:?}");
}
