//! Whole plants and their default chains: what they look like, cost and weigh.
//!
//! `cargo bench --bench chains [-- PART]`; PART picks cases by name: `tenth` (a tenth of all triangles),
//! `leaves-only` (against the same number of leaves on all of the wood), `cost` (a chain, stage by stage, and
//! over one simplification to the coarsest) or `page` (the preview; needs Chromium). Seconds count only at rest.
//! Pictures against gltfpack are those of `secateur study --plan whole`.

#[allow(dead_code, reason = "tests use more of it")]
#[path = "../tests/browser/browser.rs"]
mod browser;
mod rows;
#[allow(dead_code, reason = "tests use more of it")]
#[path = "../tests/browser/tab.rs"]
mod tab;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use rows::{Rows, Wanted, shared_tree};
use serde_json::Value;
use tab::{DESKTOP, Tab};

const COMMAND: &str = "cargo bench --bench chains";

const TREES: [&str; 4] = [
    "ez_oak_20k",
    "ez_bush2",
    "sap_birch_hex_9k",
    "quat_commontree_1",
];

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut bench = Bench {
        rows: Rows::create("chains"),
        folder: folder.path().to_owned(),
        wanted: Wanted::from_command_line(),
    };
    for name in TREES {
        let Some(tree) = shared_tree(&format!("{name}.glb")) else {
            continue;
        };
        if bench.wanted.has(&format!("tenth, {name}")) {
            bench.tenth(name, &tree);
        }
        if bench.wanted.has(&format!("leaves-only, {name}")) {
            bench.leaves_only(name, &tree);
        }
        if bench.wanted.has(&format!("cost, {name}")) {
            bench.cost(name, &tree);
        }
    }
    if bench.wanted.has("page, ez_oak_20k")
        && let Some(tree) = shared_tree(&format!("{}.glb", TREES[0]))
    {
        bench.page(TREES[0], &tree);
    }
}

struct Bench {
    rows: Rows,
    folder: PathBuf,
    wanted: Wanted,
}

impl Bench {
    /// Runs the program; its record, and the seconds of the whole command.
    fn run(&self, arguments: &[&str]) -> (Value, f64) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_secateur"));
        command.current_dir(&self.folder);
        command.args(arguments).args(["--format", "json"]);
        let start = Instant::now();
        let output = command.output().expect("the program runs");
        let seconds = start.elapsed().as_secs_f64();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
        let record = serde_json::from_slice(&output.stdout).expect("a record");
        (record, seconds)
    }

    /// A level made of a tree by these options: its record, its judgement and its seconds.
    fn level(&self, tree: &Path, options: &[&str]) -> (Value, Value, f64) {
        let tree = path(tree);
        let simplify = ["simplify", &tree, "-o", "level.glb", "--overwrite"];
        let (record, seconds) = self.run(&[&simplify[..], options].concat());
        let (judged, _) = self.run(&["measure", &tree, "level.glb"]);
        (record, judged, seconds)
    }

    fn note(&mut self, case: &str, quantity: &str, unit: &str, value: f64) {
        self.rows.note(case, quantity, unit, value, COMMAND);
    }

    fn tenth(&mut self, name: &str, tree: &Path) {
        let (record, judged, seconds) = self.level(tree, &["--triangles", "0.1"]);
        let case = format!("tenth, {name}");
        let triangles = number(&record["triangles"]["final"]);
        let bytes = number(&record["peak_rss_bytes"]);
        self.note(&case, "triangles", "", triangles);
        self.note(&case, "wall", "s", seconds);
        self.note(&case, "peak_memory", "MiB", bytes / f64::from(1 << 20));
        for key in ["flip_mean", "silhouette_iou", "coverage_ratio"] {
            self.note(&case, key, "", number(&judged[key]));
        }
    }

    /// As many leaves as a tenth of all triangles has, with all of the wood.
    fn leaves_only(&mut self, name: &str, tree: &Path) {
        let (whole, of_whole, _) = self.level(tree, &["--triangles", "0.1"]);
        let leaves = number(&whole["leaves"]["final"]).to_string();
        let (alone, of_alone, _) = self.level(tree, &["--leaves", &leaves]);
        let case = format!("leaves-only, {name}");
        let triangles = [&whole, &alone].map(|record| number(&record["triangles"]["final"]));
        let wood = number(&alone["wood_triangles"]["final"]);
        let flips = [&of_whole, &of_alone].map(|judged| number(&judged["flip_mean"]));
        self.note(&case, "wood_of_leaves_only", "", wood / triangles[1]);
        self.note(
            &case,
            "triangles_over_leaves_only",
            "",
            triangles[0] / triangles[1],
        );
        self.note(&case, "flip_mean", "", flips[0]);
        self.note(&case, "flip_mean_of_leaves_only", "", flips[1]);
        self.note(&case, "more_flip", "", flips[0] - flips[1]);
    }

    fn cost(&mut self, name: &str, tree: &Path) {
        let tree = path(tree);
        let lods = ["lods", &tree, "-o", "chain", "--overwrite"];
        let (record, seconds) = self.run(&lods);
        let levels = record["levels"].as_array().expect("levels");
        let meshes = levels.iter().filter(|level| level["kind"] == "mesh");
        let coarsest = meshes
            .map(|level| number(&level["triangles"]))
            .fold(f64::MAX, f64::min);
        let simplify = [
            "simplify",
            &tree,
            "-o",
            "one.glb",
            "--overwrite",
            "--triangles",
        ];
        let coarsest = coarsest.to_string();
        let (_, one) = self.run(&[&simplify[..], &[&coarsest]].concat());
        let case = format!("cost, {name}");
        for (k, level) in levels.iter().enumerate() {
            self.note(
                &case,
                &format!("triangles_{k}"),
                "",
                number(&level["triangles"]),
            );
            self.note(
                &case,
                &format!("flip_mean_{k}"),
                "",
                number(&level["flip_mean"]),
            );
        }
        self.note(&case, "levels", "", levels.len() as f64);
        self.note(&case, "wall", "s", seconds);
        let stages = record["seconds"].as_object().expect("stages");
        for (stage, seconds) in stages.iter().filter(|(stage, _)| *stage != "total") {
            self.note(&case, &format!("wall_of_{stage}"), "s", number(seconds));
        }
        self.note(&case, "wall_of_one_simplification", "s", one);
        self.note(&case, "ratio", "", seconds / one);
    }

    /// The page in a browser without a window, from its address until it shows the trees.
    fn page(&mut self, name: &str, tree: &Path) {
        let lods = [
            "lods",
            &path(tree),
            "-o",
            "pages",
            "--overwrite",
            "--preview",
            "page.html",
        ];
        self.run(&lods);
        let page = self.folder.join("page.html");
        let bytes = std::fs::metadata(&page).expect("the page").len() as f64;
        let case = format!("page, {name}");
        self.note(&case, "size", "MB", bytes / 1e6);
        for repeat in 0..3 {
            let Some(mut tab) = Tab::open(DESKTOP) else {
                eprintln!("SKIPPED: no Chromium");
                return;
            };
            let start = Instant::now();
            tab.visit(&page);
            let picture = tab.picture();
            let seconds = start.elapsed().as_secs_f64();
            let level = tab.part(&picture, "#half-level");
            let corner = *level.get_pixel(level.width() - 6, 6);
            let drawn = level.pixels().filter(|pixel| **pixel != corner).count();
            let share = drawn as f64 / f64::from(level.width() * level.height());
            assert!(share > 0.04, "the page shows no tree");
            self.rows.add(&rows::Row {
                case: &case,
                quantity: "load_and_first_picture",
                unit: "s",
                value: seconds,
                repeat,
                adapter: "headless Chromium",
                command: COMMAND,
            });
        }
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn path(tree: &Path) -> String {
    let tree = tree.canonicalize().expect("the tree");
    tree.to_str().expect("a path in UTF-8").to_owned()
}
