//! Studies: rows that are kept, taken up and drawn again.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{Bench, Ran};

const CASES: [&str; 4] = [
    "--case",
    "vds --views 6 --resolution 64",
    "--case",
    "fsa --views 6 --resolution 64",
];

fn study(bench: &Bench, cases: &[&str]) -> Ran {
    let files = ["study", "oak.glb", "-o", "s", "--levels", "0.25"];
    bench.run(&[&files[..], cases].concat())
}

fn rows(bench: &Bench) -> Vec<Value> {
    let text = String::from_utf8(bench.read("s/rows.jsonl")).unwrap();
    let row = |line: &str| serde_json::from_str(line).unwrap();
    text.lines().map(row).collect()
}

#[test]
fn a_killed_study_goes_on_and_is_drawn_again_from_its_rows() {
    let bench = Bench::new();
    let ran = study(&bench, &CASES).succeeded();
    assert!(ran.stdout.contains("2 rows"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "no progress bar in a pipe");
    let first = rows(&bench);
    assert_eq!(first.len(), 2);
    for row in &first {
        assert_eq!(row["leaves_final"], 60);
        assert!(row["values"]["ssim"].as_f64().unwrap() > 0.5);
        assert_eq!(row["per_view"].as_array().unwrap().len(), 12);
        assert!(!row["commit"].as_str().unwrap().is_empty());
        let picture = bench.read(&format!("s/{}", row["picture"].as_str().unwrap()));
        assert!(picture.starts_with(&[0xFF, 0xD8]), "a JPEG");
        let difference = bench.read(&format!("s/{}", row["difference"].as_str().unwrap()));
        assert!(difference.starts_with(&[0xFF, 0xD8]) && difference != picture);
        if cfg!(target_os = "linux") {
            assert!(row["peak_rss_bytes"].as_u64().unwrap() > 1 << 20);
        }
    }
    // Killed within the second row.
    let text = bench.read("s/rows.jsonl");
    let first_end = text.iter().position(|b| *b == b'\n').unwrap();
    bench.put("s/rows.jsonl", &text[..first_end + 40]);
    study(&bench, &CASES).succeeded();
    let again = rows(&bench);
    assert_eq!(again[0], first[0], "a finished row is kept, its time too");
    assert_eq!(again[1]["values"], first[1]["values"]);

    let drawn = [
        "s/report.html",
        "s/README.md",
        "s/rows.csv",
        "s/charts/silhouette_iou-25.svg",
    ];
    let before = drawn.map(|name| bench.read(name));
    for name in drawn {
        std::fs::remove_file(bench.path(name)).unwrap();
    }
    std::fs::remove_file(bench.path("oak.glb")).unwrap();
    bench.run(&["study", "--redraw", "-o", "s"]).succeeded();
    assert_eq!(drawn.map(|name| bench.read(name)), before);
    let html = String::from_utf8(before[0].clone()).unwrap();
    assert!(html.contains("data:image/jpeg;base64,") && html.contains("<svg"));
}

/// One run to the coarsest level gives the finer ones too.
#[test]
fn levels_by_branches_are_rows_beside_others() {
    let bench = Bench::new();
    let files = ["study", "oak.glb", "-o", "s", "--levels", "0.5,0.25"];
    let cases = ["--case", "chain", "--case", "merge"];
    bench.run(&[&files[..], &cases].concat()).succeeded();
    let found = rows(&bench);
    let of = |row: &Value| (row["method"].clone(), row["leaves_final"].as_u64());
    let expected = [("chain", 120), ("chain", 60), ("merge", 120), ("merge", 60)];
    let expected = expected.map(|(method, leaves)| (Value::from(method), Some(leaves)));
    assert_eq!(found.iter().map(of).collect::<Vec<_>>(), expected);
}

#[test]
fn a_row_says_how_to_get_it_again() {
    let bench = Bench::new();
    let case = "meshopt --preserve-area --views 6 --resolution 64";
    study(&bench, &["--case", case]).succeeded();
    let row = &rows(&bench)[0];
    let command = row["command"].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    bench.run(&words).succeeded();
    let ran = bench.run(&["measure", "oak.glb", "out.glb", "--format", "json"]);
    let measured: Value = serde_json::from_str(&ran.succeeded().stdout).unwrap();
    for key in ["ssim", "flip_mean", "coverage_ratio"] {
        let [row, again] = [&row["values"][key], &measured[key]].map(|v| v.as_f64().unwrap());
        assert!((row - again).abs() < 2e-3, "{key}: {row} {again}");
    }
}

#[test]
fn what_cannot_be_studied_is_one_sentence() {
    let bench = Bench::new();
    bench.put("no.glb", b"not a tree");
    let run = |arguments: &[&str]| bench.run(&[&["study", "-o", "s"], arguments].concat());
    run(&["no.glb"]).failed_saying(&["no.glb: is not glTF"]);
    run(&["oak.glb", "no.glb"]).failed_saying(&["no.glb: is not glTF"]);
    assert!(!bench.path("s").exists(), "nothing is begun");
    run(&["oak.glb", "--case", "nonsense"]).failed_saying(&["`nonsense", "no method"]);
    run(&["--redraw"]).failed_saying(&["no rows"]);
    run(&["--plan", "methods"]).failed_saying(&["no tree was given"]);
    run(&["oak.glb", "--only", "elm"]).failed_saying(&["no tree", "elm"]);
    run(&["oak.glb", "--plan", "failures"]).failed_saying(&["add methods"]);
    run(&["oak.glb", "./oak.glb"]).failed_saying(&["both be called oak"]);
    std::fs::create_dir_all(bench.path("s")).unwrap();
    bench.put("s/rows.jsonl", b"{\"tree\":1}\n");
    run(&["--redraw"]).failed_saying(&["rows.jsonl", "line 1"]);
}

#[test]
fn lots_are_drawn_for_every_seed() {
    let bench = Bench::new();
    let few = ["--case", "stochastic --resolution 64", "--seeds", "2"];
    study(&bench, &few).succeeded();
    let seed = |row: &Value| row["seed"].as_u64().unwrap();
    let found: Vec<Value> = rows(&bench);
    assert_eq!(found.iter().map(seed).collect::<Vec<_>>(), [0, 1]);
    assert_ne!(found[0]["values"], found[1]["values"]);
}

/// Views change nothing for a method that has none, so all leaves are shared;
/// another seed keeps others.
#[test]
fn kept_leaves_are_held_against_the_first_case_of_a_method() {
    let bench = Bench::new();
    let cases = ["fsa", "stochastic", "fsa --views 6", "stochastic --seed 7"];
    let cases: Vec<&str> = cases.iter().flat_map(|case| ["--case", case]).collect();
    study(&bench, &cases[..4]).succeeded();
    // Taken up: the first cases are there already.
    study(&bench, &cases).succeeded();
    let found = rows(&bench);
    let overlap = |row: &Value| row["kept_overlap"].as_f64();
    assert_eq!(
        found.iter().map(overlap).take(3).collect::<Vec<_>>(),
        [None, None, Some(1.0)]
    );
    assert_eq!(found[2]["overlap_with"], "fsa");
    let lots = overlap(&found[3]).unwrap();
    // Two draws of 60 of 240 share 15 of 105 on average.
    assert!((0.02..0.4).contains(&lots), "{lots}");
}

/// Scenes made for a failure run with all that is tried on them, and the report
/// says what to do about each.
#[test]
fn scenes_made_for_failures_have_a_verdict_each() {
    let bench = Bench::new();
    let run = ["study", "--plan", "failures", "-o", "s", "--levels", "0.1"];
    let only = ["--only", "scene-interior", "--only", "scene-sparse"];
    bench.run(&[&run[..], &only].concat()).succeeded();
    let found = rows(&bench);
    let near = |row: &&Value| row["setting"] == "preset information views near";
    let near = found.iter().find(near).unwrap();
    assert_eq!(near["tree"], "scene-interior");
    let command = near["command"].as_str().unwrap();
    // As it is given within the study's folder, wherever that is.
    assert!(!command.contains("s/trees"), "{command}");
    let command = command.replace("trees/", "s/trees/");
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    bench.run(&words).succeeded();
    for page in ["s/report.html", "s/README.md"] {
        let page = String::from_utf8(bench.read(page)).unwrap();
        assert!(page.contains("Where methods fail"));
        for scene in ["An interior seen from near", "A sparse crown"] {
            assert!(page.contains(scene), "{scene}");
        }
        assert!(!page.contains("Thin needles"), "did not run");
        assert!(page.contains("At 10 % of the leaves"));
    }
}

fn committed_studies() -> Vec<PathBuf> {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/results");
    let below = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().path())
    };
    let folders = below(results).filter(|folder| folder.is_dir());
    let studies = folders.flat_map(below);
    studies.filter(|s| s.join("rows.jsonl").is_file()).collect()
}

/// Nobody edits a result: what is committed is what its rows say.
#[test]
fn committed_studies_say_what_their_rows_say() {
    let mut checked = 0;
    for study in committed_studies() {
        let bench = Bench::new();
        std::fs::create_dir(bench.path("s")).unwrap();
        bench.put(
            "s/rows.jsonl",
            &std::fs::read(study.join("rows.jsonl")).unwrap(),
        );
        bench.run(&["study", "--redraw", "-o", "s"]).succeeded();
        for name in ["README.md", "rows.csv"] {
            let [drawn, committed] = [bench.path("s"), study.clone()]
                .map(|folder| std::fs::read_to_string(folder.join(name)).unwrap());
            let shown = study.join(name);
            let same = drawn == committed.replace("\r\n", "\n");
            assert!(
                same,
                "{}: secateur study --redraw -o {}",
                shown.display(),
                study.display()
            );
        }
        checked += 1;
    }
    assert!(checked > 0, "a study is committed");
}

/// What a run is the run of, but for where it ran.
fn name_of(row: &Value) -> String {
    let keys = ["tree", "method", "setting", "change", "seed", "level"];
    keys.map(|key| row[key].to_string()).join(" ")
}

/// Every machine gets the same bits: where two machines' studies of one day and name have
/// a run in common, every view was judged equal to the last digit. Of other days, the
/// program may be another.
#[test]
fn committed_studies_of_several_machines_agree() {
    let mut known: HashMap<String, Value> = HashMap::new();
    let mut compared = 0;
    for study in committed_studies() {
        let [folder, name] = [study.parent().unwrap(), &study]
            .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned());
        let date = &folder[.."2026-11-22".len()];
        let rows = std::fs::read_to_string(study.join("rows.jsonl")).unwrap();
        for row in rows.lines() {
            let row: Value = serde_json::from_str(row).unwrap();
            match known.entry(format!("{date} {name} {}", name_of(&row))) {
                Entry::Vacant(place) => {
                    place.insert(row);
                }
                Entry::Occupied(other) => {
                    let other = other.get();
                    assert_ne!(row["machine"], other["machine"]);
                    for key in ["leaves_final", "triangles_final", "values", "per_view"] {
                        assert_eq!(row[key], other[key], "{key} of {}", name_of(&row));
                    }
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} runs of two machines are equal");
    assert!(compared > 0, "two machines have run the same");
}
