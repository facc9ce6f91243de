//! Studies that are committed say what their rows say, and so do the pages that cite them.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::Bench;

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

/// Tables of pages are those of the rows that they name.
#[test]
fn pages_say_what_committed_rows_say() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for page in ["README.md", "docs/results.md"] {
        let text = std::fs::read_to_string(root.join(page)).unwrap();
        let text = text.replace("\r\n", "\n");
        let filled = secateur_study::fill_tables(&text, &root).unwrap();
        assert!(
            filled == text,
            "{page}: cargo run --package secateur-study --example fill_tables {page}"
        );
    }
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
                    for key in [
                        "leaves_final",
                        "triangles_final",
                        "values",
                        "rigs",
                        "per_view",
                    ] {
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
