//! Studies: rows that are kept, taken up and drawn again.

mod committed;
mod distances;
mod walk;
mod whole;

use secateur::plant_to_glb;
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

use crate::program::{Bench, Ran, oak};

const CASES: [&str; 4] = [
    "--case",
    "vds --views 6 --resolution 64",
    "--case",
    "fsa --views 6 --resolution 64",
];

/// One set of views judges four times as fast as all of them.
const QUICKLY: [&str; 2] = ["--views", "icosahedron"];

fn study(bench: &Bench, cases: &[&str]) -> Ran {
    let files = ["study", "oak.glb", "-o", "s", "--levels", "0.25"];
    bench.run(&[&files[..], &QUICKLY, cases].concat())
}

fn rows(bench: &Bench) -> Vec<Value> {
    let text = String::from_utf8(bench.read("s/rows.jsonl")).unwrap();
    let row = |line: &str| serde_json::from_str(line).unwrap();
    text.lines().map(row).collect()
}

#[test]
fn a_killed_study_goes_on_and_is_drawn_again_from_its_rows() {
    let bench = Bench::new();
    let study = |bench: &Bench| {
        let files = ["study", "oak.glb", "-o", "s", "--levels", "0.25"];
        bench.run(&[&files[..], &CASES].concat())
    };
    let ran = study(&bench).succeeded();
    assert!(ran.stdout.contains("2 rows"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "no progress bar in a pipe");
    let first = rows(&bench);
    assert_eq!(first.len(), 2);
    for row in &first {
        assert_eq!(row["leaves_final"], 60);
        assert!(row["values"]["ssim"].as_f64().unwrap() > 0.5);
        assert_eq!(row["rigs"].as_array().unwrap().len(), 4);
        assert_eq!(row["judged_by"], "held-out");
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
    study(&bench).succeeded();
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
    bench
        .run(&[&files[..], &QUICKLY, &cases].concat())
        .succeeded();
    let found = rows(&bench);
    assert_eq!(found[0]["judged_by"], "icosahedron");
    assert_eq!(found[0]["rigs"].as_array().unwrap().len(), 1);
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
    let measure = ["measure", "oak.glb", "out.glb", "--format", "json"];
    let ran = bench.run(&[&measure[..], &QUICKLY].concat());
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
    run(&["--plan", "walk", "--only", "elm"]).failed_saying(&["no tree", "elm"]);
    run(&["oak.glb", "--only", "elm"]).failed_saying(&["no tree", "elm"]);
    run(&["oak.glb", "--plan", "scene", "--levels", "0"]).failed_saying(&["no triangles"]);
    assert!(!bench.path("s").exists(), "nothing is begun");
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

/// An oak of the same name and other leaves.
fn other_oak() -> Vec<u8> {
    let options = GrowOptions {
        leaves: 160,
        seed: 9,
    };
    plant_to_glb(&grow(Species::Oak, &options).unwrap())
}

const FSA: [&str; 2] = ["--case", "fsa --resolution 64"];

fn readme(bench: &Bench) -> String {
    String::from_utf8(bench.read("s/README.md")).unwrap()
}

/// Rows know the tree by its bytes: another one of the same name is run anew, and what is drawn
/// is of one tree only, the one that was studied last.
#[test]
fn another_tree_of_the_same_name_is_not_taken_for_the_first() {
    let bench = Bench::new();
    study(&bench, &FSA).succeeded();
    bench.put("oak.glb", &other_oak());
    study(&bench, &FSA).succeeded();
    let found = rows(&bench);
    let leaves = |row: &Value| row["leaves_original"].as_u64();
    assert_eq!(
        found.iter().map(leaves).collect::<Vec<_>>(),
        [Some(240), Some(160)],
        "no row is lost"
    );
    assert_ne!(found[0]["tree_sha256"], found[1]["tree_sha256"]);
    assert!(readme(&bench).contains("- 1 rows of 1 tree: oak (160 leaves)"));

    // The first tree is back: its row is still there, and is what is drawn.
    bench.put("oak.glb", oak());
    study(&bench, &FSA).succeeded();
    let again = rows(&bench);
    assert_eq!(again.len(), 2);
    assert!(again.contains(&found[0]));
    assert!(readme(&bench).contains("- 1 rows of 1 tree: oak (240 leaves)"));
}

/// A .gltf is another tree if its buffer is.
#[test]
fn a_tree_is_all_of_its_files() {
    let bench = Bench::new();
    let share = ["simplify", "oak.glb", "--ratio", "1", "-o", "split.gltf"];
    bench.run(&share).succeeded();
    let run = ["study", "split.gltf", "-o", "s", "--levels", "0.25"];
    bench.run(&[&run[..], &QUICKLY, &FSA].concat()).succeeded();
    let mut buffer = bench.read("split.bin");
    // Even a byte that nothing reads.
    buffer.push(0);
    bench.put("split.bin", &buffer);
    bench.run(&[&run[..], &QUICKLY, &FSA].concat()).succeeded();
    let hash = |row: &Value| row["tree_sha256"].as_str().map(str::to_owned);
    let hashes: Vec<Option<String>> = rows(&bench).iter().map(hash).collect();
    assert_eq!(hashes.len(), 2);
    assert!(hashes[0].is_some() && hashes[0] != hashes[1]);
}

/// Rows of before have no hash: they are drawn, but nobody knows what tree they are of.
#[test]
fn a_row_without_a_hash_is_drawn_and_run_anew() {
    let bench = Bench::new();
    study(&bench, &FSA).succeeded();
    let mut row = rows(&bench).remove(0);
    row.as_object_mut().unwrap().remove("tree_sha256").unwrap();
    let line = format!("{row}\n");
    bench.put("s/rows.jsonl", line.as_bytes());
    bench.run(&["study", "--redraw", "-o", "s"]).succeeded();
    assert!(readme(&bench).contains("- 1 rows of 1 tree: oak (240 leaves)"));
    study(&bench, &FSA).succeeded();
    assert_eq!(rows(&bench).len(), 2);
    assert!(readme(&bench).contains("- 1 rows of 1 tree: oak (240 leaves)"));
}

/// Two studies would write over each other's rows. A lock of a process that is gone is none.
#[test]
fn a_folder_has_one_study_at_a_time() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("s")).unwrap();
    let lock = std::fs::File::create(bench.path("s/.secateur-study.lock")).unwrap();
    lock.lock().unwrap();
    study(&bench, &FSA).failed_saying(&["s: another study"]);
    bench
        .run(&["study", "--redraw", "-o", "s"])
        .failed_saying(&["s: another study"]);
    assert!(!bench.path("s/rows.jsonl").exists());
    drop(lock);
    assert!(bench.path("s/.secateur-study.lock").exists());
    study(&bench, &FSA).succeeded();
    assert_eq!(rows(&bench).len(), 1);
    assert!(!bench.path("s/.secateur-study.lock").exists());
}

/// A finished row stays as it is, its time too.
#[test]
fn pictures_that_are_missing_are_made_again() {
    let bench = Bench::new();
    study(&bench, &CASES).succeeded();
    let before = bench.read("s/rows.jsonl");
    let row = &rows(&bench)[1];
    let of_row = ["picture", "difference"].map(|key| row[key].as_str().unwrap().to_owned());
    let names = std::fs::read_dir(bench.path("s/pictures")).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let original = { names }
        .find(|name| name.ends_with("-original.jpg"))
        .unwrap();
    let pictures = [&of_row[..], &[format!("pictures/{original}")]].concat();
    for missing in [&pictures[..], &pictures[2..]] {
        let paths: Vec<String> = missing.iter().map(|name| format!("s/{name}")).collect();
        let read = || {
            paths
                .iter()
                .map(|path| bench.read(path))
                .collect::<Vec<_>>()
        };
        let drawn = read();
        for path in &paths {
            std::fs::remove_file(bench.path(path)).unwrap();
        }
        study(&bench, &CASES).succeeded();
        assert_eq!(read(), drawn);
        assert_eq!(bench.read("s/rows.jsonl"), before);
    }
}

/// Small pictures are judged over frames as they are, large ones on request; rows of before are then judged
/// anew, once.
#[test]
fn large_pictures_are_judged_over_frames_on_request() {
    let bench = Bench::new();
    let study = |more: &[&str]| {
        let case = [
            "study", "oak.glb", "-o", "s", "--levels", "0.25", "--case", "fsa",
        ];
        bench.run(&[&case[..], more].concat())
    };
    let has = |row: &Value, key: &str| row["values"][key].is_number();
    let both = ["flip_over_frames_128", "flip_over_frames_512"];
    study(&[]).succeeded();
    let first = rows(&bench);
    assert_eq!(both.map(|key| has(&first[0], key)), [true, false]);
    study(&["--frames-up-to", "512"]).succeeded();
    let second = rows(&bench);
    let last = second.last().unwrap();
    assert_eq!(
        (second.len(), both.map(|key| has(last, key))),
        (2, [true; 2])
    );
    let flicker = |shown: &str| last[shown]["flicker_over_frames_512"].as_f64().unwrap();
    assert!(flicker("original") > 0.0 && flicker("original_without_mips") > 0.0);
    assert_eq!(
        last["original"]["flip_as_drawn_128"],
        first[0]["original"]["flip_as_drawn_128"]
    );
    study(&["--frames-up-to", "512"]).succeeded();
    study(&[]).succeeded();
    assert_eq!(rows(&bench), second[1..], "the later of the two stays");
    let wrong = study(&["--frames-up-to", "256"]);
    assert_eq!(wrong.code, Some(2));
    assert!(
        wrong.stderr.contains("write 128 or 512"),
        "{}",
        wrong.stderr
    );
}

/// What a tree is called is up to whoever made it.
#[test]
fn a_spreadsheet_computes_nothing_of_a_study() {
    let bench = Bench::new();
    bench.put("=1+1.glb", oak());
    let run = ["study", "=1+1.glb", "-o", "s", "--levels", "0.25"];
    bench.run(&[&run[..], &QUICKLY, &FSA].concat()).succeeded();
    let csv = String::from_utf8(bench.read("s/rows.csv")).unwrap();
    let line = csv.lines().nth(1).unwrap();
    assert!(line.starts_with("\"'=1+1\",fsa,"), "{line}");
}

/// A case is what it asks for, however it is written.
#[test]
fn cases_that_ask_for_the_same_are_run_once() {
    let bench = Bench::new();
    let cases = [
        "--case",
        "vds --resolution 64 --views 6 --fit=none",
        "--case",
        "vds --fit=none --views octahedron --ties order --resolution 64",
    ];
    study(&bench, &cases).succeeded();
    let found = rows(&bench);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["setting"], "views 6 resolution 64 fit=none");
    for (case, says) in [
        ("vds --report x.json", "--report"),
        ("vds --ratio 0.5", "--ratio"),
        ("vds --views no.json", "no.json"),
        ("", "no method"),
    ] {
        study(&bench, &["--case", case]).failed_saying(&[says]);
    }
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
    bench.run(&[&run[..], &QUICKLY, &only].concat()).succeeded();
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
