//! Levels that a scene asks for: what three.js shows of them, specks, obstacles, and what impostors and
//! a chain cost. How light they are beside fixed shares, and how impostors look beside meshes, is in
//! `secateur study --plan scene`.
//!
//! `cargo bench --bench scene_levels [-- PART]`; PART picks cases by name, such as `bake` or
//! `specks, ez_bush2`. Coverage needs node, Chromium and `npm ci --prefix tests/clients`.

#[allow(unreachable_pub, reason = "other crates include this file too")]
#[path = "../tests/clients/clients.rs"]
mod clients;
#[path = "../crates/levels/examples/forest/clock.rs"]
mod clock;
#[allow(dead_code, reason = "its main is the example's")]
#[path = "../crates/cli/examples/obstacles.rs"]
mod obstacles;
mod rows;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use clock::timed;
use rows::{Rows, Wanted, shared_tree};
use secateur_gltf::Document;
use secateur_levels::impostor::Impostor;
use secateur_levels::impostor::crossed::Planes;
use secateur_model::Surface;
use serde_json::{Value, json};

const COMMAND: &str = "cargo bench --bench scene_levels";

const TREES: [&str; 4] = [
    "ez_oak_20k",
    "ez_bush2",
    "sap_birch_hex_9k",
    "quat_commontree_1",
];

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut bench = Bench {
        rows: Rows::create("scene_levels"),
        folder: folder.path().to_owned(),
        wanted: Wanted::from_command_line(),
    };
    bench.coverage();
    bench.specks();
    bench.bake();
    bench.chain();
    bench.obstacles();
}

struct Bench {
    rows: Rows,
    folder: PathBuf,
    wanted: Wanted,
}

impl Bench {
    /// Runs the program; its record, and the seconds that it took.
    fn run(&self, arguments: &[&str]) -> (Value, f64) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_secateur"));
        command.args(arguments).args(["--format", "json"]);
        let start = Instant::now();
        let output = command.current_dir(&self.folder).output();
        let output = output.expect("the command starts");
        let seconds = start.elapsed().as_secs_f64();
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {complaint}");
        let record = serde_json::from_slice(&output.stdout).expect("a record");
        (record, seconds)
    }

    /// The chain of a tree, in a folder called `chain`.
    fn lods(&self, tree: &Path, options: &[&str]) -> (Value, f64) {
        let tree = tree.to_str().expect("a path in UTF-8");
        let files = ["lods", tree, "-o", "chain", "--overwrite"];
        self.run(&[&files[..], options].concat())
    }

    /// Of the trees that a part is asked for of, names and files of those that are there.
    fn trees<'a>(&self, part: &str, names: &[&'a str]) -> Vec<(&'a str, PathBuf)> {
        let is_wanted = |name: &&&str| self.wanted.has(&format!("{part}, {name}"));
        let found = |name: &&'a str| Some((*name, shared_tree(&format!("{name}.glb"))?));
        names.iter().filter(is_wanted).filter_map(found).collect()
    }

    fn note(&mut self, part: &str, what: &str, quantity: &str, unit: &str, value: f64) {
        let case = format!("{part}, {what}");
        let command = format!("{COMMAND} -- {part}");
        self.rows.note(&case, quantity, unit, value, &command);
    }

    /// What three.js shows of levels from where they begin and from where they end.
    fn coverage(&mut self) {
        for (name, tree) in self.trees("coverage", &TREES[..3]) {
            let distances = distances_of(&tree, &[540.0, 270.0, 135.0, 64.0]);
            let cards = ["--distances", &distances, "--impostor", "cards"];
            let chains: [(&str, &[&str]); 3] = [
                ("50, 25, 10 %", &["--levels", "0.5,0.25,0.1"]),
                ("by heights", &[]),
                ("with cards", &cards),
            ];
            for (chain, options) in chains {
                let (record, _) = self.lods(&tree, options);
                std::fs::copy(&tree, self.folder.join("original.glb")).expect("a copy");
                let jobs = self.folder.join("jobs.json");
                std::fs::write(&jobs, coverage_job(&record).to_string()).expect("a file");
                let Some(seen) = clients::show("coverage.js", &jobs) else {
                    return;
                };
                for level in seen {
                    let number = |key: &str| level[key].as_f64().unwrap_or(f64::NAN);
                    let what = format!(
                        "{name} {chain}, LOD{} at {:.0} m",
                        level["level"],
                        number("distance")
                    );
                    for key in ["coverage_over_truth", "original_coverage_over_truth"] {
                        self.note("coverage", &what, key, "", number(key));
                    }
                }
            }
        }
    }

    /// Islands of up to 3 pixels beyond the original's, in simplified trees, in levels of a chain, and in
    /// chains of one level, which that level alone has to serve.
    fn specks(&mut self) {
        let all = [&TREES[..], &["sap_pine_needles_48k"]].concat();
        for (name, tree) in self.trees("specks", &all) {
            let file = |record: &Value, number: usize| -> String {
                let file = record["levels"][number]["file"].as_str();
                file.expect("levels have files").to_owned()
            };
            let (chain, _) = self.lods(&tree, &["--levels", "0.5,0.25,0.1"]);
            for (number, share) in [(0, "0.5"), (2, "0.1")] {
                let kind = "lods of 50, 25, 10 %";
                self.specks_of(name, &tree, share, kind, &file(&chain, number));
            }
            for share in ["0.5", "0.1"] {
                let from = tree.to_str().expect("a path in UTF-8");
                let command = ["simplify", from, "-o", "simplified.glb", "--overwrite"];
                self.run(&[&command[..], &["--triangles", share]].concat());
                self.specks_of(name, &tree, share, "simplify", "simplified.glb");
                let (alone, _) = self.lods(&tree, &["--levels", share]);
                self.specks_of(name, &tree, share, "lods alone", &file(&alone, 0));
            }
        }
    }

    fn specks_of(&mut self, name: &str, tree: &Path, share: &str, kind: &str, file: &str) {
        let from = tree.to_str().expect("a path in UTF-8");
        for width in ["512", "128"] {
            let (record, _) = self.run(&["measure", from, file, "--as-drawn", width]);
            let drawn = &record["as_drawn"];
            let number = |key: &str| drawn[key].as_f64().unwrap_or(f64::NAN);
            let more = number("specks_per_view") - number("original_specks_per_view");
            let what = format!("{name} to {share} by {kind}, {width} pixels");
            self.note("specks", &what, "specks_beyond_original", "a view", more);
        }
    }

    /// Atlases of 1024 x 1024 texels.
    fn bake(&mut self) {
        for (name, tree) in self.trees("bake", &TREES[..1]) {
            let surfaces = surfaces_of(&tree);
            let crossed = timed(|| Impostor::crossed(&surfaces, Planes::ALL[2], 512.0));
            let octahedral = timed(|| Impostor::octahedral(&surfaces, 128.0));
            let made = [
                ("crossed planes", crossed),
                ("octahedral views", octahedral),
            ];
            for (kind, (made, seconds)) in made {
                let facts = made.expect("a plant to see").facts();
                assert_eq!(facts["atlas"], json!([1024, 1024]), "{kind}");
                let what = format!("{name}, {kind}");
                self.note("bake", &what, "wall", "s", seconds.wall);
                if let Some(cores) = seconds.cores {
                    self.note("bake", &what, "cpu", "s", cores);
                }
            }
        }
    }

    /// A chain by distances beside one simplification to its coarsest mesh.
    fn chain(&mut self) {
        for (name, tree) in self.trees("chain", &TREES[..1]) {
            let distances = distances_of(&tree, &[1080.0, 540.0, 270.0, 135.0, 64.0]);
            let options = ["--distances", &distances, "--impostor", "crossed"];
            let (record, seconds) = self.lods(&tree, &options);
            let levels = record["levels"].as_array().expect("levels");
            let meshes = levels.iter().filter(|level| level["kind"] == "mesh");
            let coarsest = meshes.filter_map(|level| level["triangles"].as_u64()).min();
            let coarsest = coarsest.expect("a mesh").to_string();
            let from = tree.to_str().expect("a path in UTF-8");
            let simplify = ["simplify", from, "-o", "one.glb", "--overwrite"];
            let (_, one) = self.run(&[&simplify[..], &["--triangles", &coarsest]].concat());
            self.note("chain", name, "levels", "", levels.len() as f64);
            self.note("chain", name, "wall", "s", seconds);
            self.note("chain", name, "wall_of_one_simplification", "s", one);
            self.note("chain", name, "ratio", "", seconds / one);
        }
    }

    /// Leaves that an obstacle hides from all cameras, at a quarter of all leaves.
    fn obstacles(&mut self) {
        if !self.wanted.has("obstacles") {
            return;
        }
        let found = obstacles::compare_all(&self.folder).expect("both scenes");
        for (what, ratio) in found {
            self.note("obstacles", &what, "behind_over_before", "", ratio);
        }
    }
}

fn surfaces_of(tree: &Path) -> Vec<Surface> {
    let document = Document::open(tree).expect("a tree");
    let surfaces = document.surfaces(&[]).expect("surfaces");
    surfaces.into_iter().map(|(surface, _)| surface).collect()
}

fn height_of(tree: &Path) -> f64 {
    let surfaces = surfaces_of(tree);
    let ys = || {
        surfaces
            .iter()
            .flat_map(|s| s.positions.iter().map(|p| p.y))
    };
    ys().fold(f64::MIN, f64::max) - ys().fold(f64::MAX, f64::min)
}

/// From how many metres off the screen shows a plant as many pixels high as each of these, with commas between.
fn distances_of(tree: &Path, heights_px: &[f64]) -> String {
    let (plant, screen) = (height_of(tree), secateur_runtime::Screen::default());
    let distance = |height: &f64| screen.distance(plant, *height).to_string();
    let distances: Vec<String> = heights_px.iter().map(distance).collect();
    distances.join(",")
}

fn coverage_job(record: &Value) -> Value {
    let levels = record["levels"].as_array().expect("levels");
    let number = |level: &Value, key: &str| level[key].as_f64().unwrap_or(f64::NAN);
    let shown = |(k, level): (usize, &Value)| {
        let begin = number(level, "distance");
        // The last is seen down to 64 pixels, or to half as many as it begins with.
        let high = number(level, "pixels_high");
        let last = begin * high / (high / 2.0).min(64.0);
        let end = levels
            .get(k + 1)
            .map_or(last, |next| number(next, "distance"));
        json!({ "file": level["file"], "distances": [begin, end] })
    };
    let levels: Vec<Value> = levels.iter().enumerate().map(shown).collect();
    json!([{
        "name": record["name"],
        "original": "original.glb",
        "screen": record["screen"],
        "most_px": 256,
        "levels": levels,
    }])
}
