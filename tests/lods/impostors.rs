//! Chains that end in pictures of the tree.

use std::path::PathBuf;

use secateur::{Document, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::Value;

use super::{count, height_of, levels};
use crate::program::Bench;
use crate::tab::{DESKTOP, Tab};
use crate::validator;

/// The files of a run's record, in its folder.
fn files(bench: &Bench, record: &Value) -> Vec<PathBuf> {
    let files = record["files"].as_array().unwrap();
    let path = |file: &Value| bench.path(file.as_str().unwrap());
    files.iter().map(path).collect()
}

#[test]
fn crossed_planes_end_a_chain_in_every_layout() {
    let bench = Bench::for_small_screen();
    for (layout, output) in [("files", "c"), ("siblings", "s.glb"), ("msft", "m.glb")] {
        let lods = [
            "lods",
            "oak.glb",
            "--effort=fast",
            "-o",
            output,
            "--layout",
            layout,
            "--no-original",
            "--levels",
            "0.3,0.1",
            "--impostor",
            "crossed",
            "--report",
            "r.json",
            "--preview",
            "oak.html",
        ];
        bench.run(&lods).succeeded();
        let record = bench.json("r.json");
        let made = levels(&record);
        // The impostor was asked for by name, and stands there whatever it looks like.
        let notes = record["notes"].to_string();
        assert!(notes.contains("as `--impostor` asks for it"), "{notes}");
        let kinds: Vec<&str> = made.iter().map(|l| l["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds, ["mesh", "mesh", "impostor"]);
        let last = &made[2];
        assert!((4..=8).contains(&count(&last["triangles"])), "{last}");
        assert_eq!(last["leaves"], 0);
        assert_eq!(last["silhouette_iou"], Value::Null);
        for figure in [&last["flip_mean"], &last["impostor"]["mesh_difference"]] {
            assert!((0.0..1.0).contains(&figure.as_f64().unwrap()), "{last}");
        }
        assert!(last["distance"].as_f64() > made[1]["distance"].as_f64());
        let written = files(&bench, &record);
        validator::assert_valid(&written);
        let document = Document::open(written.last().unwrap()).unwrap();
        let nodes = document.json()["nodes"].as_array().unwrap();
        let node = nodes.iter().find(|n| n["name"] == "oak_LOD2").unwrap();
        assert_eq!(node["extras"]["kind"], "impostor");
        assert_eq!(node["extras"]["impostor"]["layout"], "crossed");
        let mesh = node["mesh"].as_u64().unwrap() as usize;
        let primitive = &document.json()["meshes"][mesh]["primitives"][0];
        let material = primitive["material"].as_u64().unwrap() as usize;
        assert_eq!(document.json()["materials"][material]["alphaMode"], "MASK");
        // Any client draws it, about as large as the tree.
        if layout == "files" {
            let all = document.surfaces(&[]).unwrap();
            let is_it = |s: &secateur::Surface| s.material.name == "oak_LOD2";
            let (picture, _) = all.iter().find(|(s, _)| is_it(s)).unwrap();
            let top = picture.positions.iter().map(|p| p.y).fold(0.0, f64::max);
            let height = height_of(&bench.path("oak.glb"));
            assert!((top / height - 1.0).abs() < 0.1, "{top} of {height}");
        }
        let page = String::from_utf8(bench.read("oak.html")).unwrap();
        assert!(page.contains("LOD2"));
    }
}

#[test]
fn octahedral_views_say_how_they_lie() {
    let bench = Bench::new();
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "o.glb",
        "--distances",
        "20,200",
        "--no-original",
        "--impostor",
        "octahedral",
        "--report",
        "r.json",
    ];
    bench.run(&lods).succeeded();
    let record = bench.json("r.json");
    let last = levels(&record).last().unwrap();
    assert_eq!(last["kind"], "impostor");
    assert!((last["distance"].as_f64().unwrap() - 200.0).abs() < 1e-6);
    // No mesh is made for where it stands, though a lighter one would do there.
    let [mesh, _] = &levels(&record)[..] else {
        panic!("two levels in {record}")
    };
    assert_eq!(last["impostor"]["mesh_triangles"], mesh["triangles"]);
    assert_eq!(
        last["triangles"], 4,
        "two planes for clients without a sampler"
    );
    let document = Document::open(&bench.path("o.glb")).unwrap();
    let nodes = document.json()["nodes"].as_array().unwrap();
    let named = |n: &&Value| n["name"] == last["node"];
    let said = &nodes.iter().find(named).unwrap()["extras"]["impostor"];
    assert_eq!((&said["frames"], &said["cells"]), (&7.into(), &8.into()));
    let cell = said["cell"].as_u64().unwrap();
    assert_eq!(said["atlas"], serde_json::json!([8 * cell, 8 * cell]));
    let height = height_of(&bench.path("oak.glb"));
    assert!(said["radius"].as_f64().unwrap() >= height / 2.0);
    validator::assert_valid(&[bench.path("o.glb")]);
}

#[test]
fn an_impostor_is_taken_unasked_only_where_it_looks_no_worse() {
    let bench = Bench::new();
    for (max_difference, is_taken) in [("0.9", true), ("0.2", false)] {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            "c",
            "--no-original",
            "--distances",
            "200",
            "--max-difference",
            max_difference,
            "--report",
            "r.json",
            "--overwrite",
        ];
        bench.run(&lods).succeeded();
        let record = bench.json("r.json");
        let last = levels(&record).last().unwrap();
        assert_eq!(last["kind"] == "impostor", is_taken, "{last}");
        let notes = record["notes"].as_array().unwrap();
        let says = |note: &Value| note.as_str().unwrap().starts_with("no impostor at 200 m");
        assert_eq!(notes.iter().any(says), !is_taken, "{notes:?}");
    }
}

/// Crossed planes with the cutoff that planes have at first would cover .57 of what there is where these begin.
#[test]
fn planes_that_nobody_asked_for_show_what_there_is_of_the_plant() {
    let bench = Bench::new();
    let options = GrowOptions {
        leaves: 30,
        seed: 5,
    };
    let small = grow(Species::Oak, &options).unwrap();
    bench.put("small.glb", &plant_to_glb(&small));
    let lods = ["lods", "small.glb", "-o", "c", "--distances", "400,800"];
    // Of so few leaves planes may differ by two thirds of that.
    let far = ["--max-difference", "0.36", "--report", "r.json"];
    bench.run(&[&lods[..], &far].concat()).succeeded();
    let record = bench.json("r.json");
    let last = levels(&record).last().unwrap();
    assert_eq!(last["impostor"]["layout"], "crossed", "{record}");
    let covers = last["coverage_as_drawn"].as_f64().unwrap();
    assert!((0.8..=1.25).contains(&covers), "{last}");
}

/// Cards are ordinary quads, as few as are within the difference, which show as much as there is of the plant.
#[test]
fn cards_stand_for_a_plant_far_off() {
    let bench = Bench::new();
    let lods = |impostor: &str, max_difference: &str, output: &str| {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            output,
            "--distances",
            "20,60",
            "--max-difference",
            max_difference,
            "--impostor",
            impostor,
            "--report",
            "r.json",
            "--overwrite",
        ];
        bench.run(&lods).succeeded();
        bench.json("r.json")
    };
    let record = lods("cards", "0.5", "c");
    let last = levels(&record).last().unwrap();
    assert_eq!(last["kind"], "impostor");
    let said = &last["impostor"];
    assert_eq!(said["layout"], "cards");
    assert_eq!(count(&last["triangles"]), 2 * count(&said["cards"]));
    assert!(last["difference"].as_f64().unwrap() <= 0.5, "{last}");
    for coverage in ["coverage_as_drawn", "coverage_as_drawn_at_end"] {
        let coverage = last[coverage].as_f64().unwrap();
        assert!((0.9..=1.1).contains(&coverage), "{last}");
    }
    let written = files(&bench, &record);
    validator::assert_valid(&written);
    let document = Document::open(written.last().unwrap()).unwrap();
    let surfaces = document.surfaces(&[]).unwrap();
    let [(cards, _)] = &surfaces[..] else {
        panic!("one material: {}", surfaces.len())
    };
    let height = height_of(&bench.path("oak.glb"));
    let top = cards.positions.iter().map(|p| p.y).fold(0.0, f64::max);
    assert!((top / height - 1.0).abs() < 0.1, "{top} of {height}");
    // A client reads the mips with which the coverage was looked at.
    let read = cards.material.texture.as_ref().unwrap().filters.mips;
    let sampler = &document.json()["samplers"][0];
    let reads_none = sampler["minFilter"] == 9729;
    assert_eq!(read == secateur::Mips::None, reads_none, "{sampler}");
    // With a smaller difference there are more of them.
    let finer = lods("cards", "0.36", "f");
    let finer = levels(&finer).last().unwrap();
    assert!(count(&finer["triangles"]) > count(&last["triangles"]));
}

/// Unasked, cards take the place of meshes of whose cost they save a third.
#[test]
fn cards_are_taken_unasked_where_they_are_lighter() {
    let bench = Bench::new();
    let lods = |options: &[&str]| {
        let lods = ["lods", "oak.glb", "-o", "c", "--report", "r.json"];
        let quickly = ["--overwrite", "--effort", "fast"];
        bench
            .run(&[&lods[..], options, &quickly].concat())
            .succeeded();
        bench.json("r.json")
    };
    let at = ["--distances", "20,60,200", "--max-difference", "0.6"];
    let chosen = lods(&at);
    let meshes = lods(&[&at[..], &["--impostor", "none"]].concat());
    let lightest = count(&levels(&meshes).last().unwrap()["triangles"]);
    let is_cards = |level: &&Value| level["impostor"]["layout"] == "cards";
    let cards: Vec<&Value> = levels(&chosen).iter().filter(is_cards).collect();
    assert!(!cards.is_empty(), "{chosen}");
    let cost = |level: &Value| level["cost"].as_f64().unwrap();
    let mut before = cost(levels(&meshes).last().unwrap());
    for level in cards {
        assert!(cost(level) < before, "{level}");
        assert!(level["difference"].as_f64().unwrap() <= 0.6, "{level}");
        assert!(count(&level["impostor"]["mesh_triangles"]) >= lightest);
        before = cost(level);
    }
    // No note says that there is nothing where there are cards.
    let notes = chosen["notes"].as_array().unwrap();
    let is_of_cards = |note: &&Value| note.as_str().unwrap().starts_with("no impostor at");
    assert_eq!(notes.iter().find(is_of_cards), None);
    let distances: Vec<f64> = levels(&chosen)
        .iter()
        .map(|level| level["distance"].as_f64().unwrap())
        .collect();
    assert!(
        distances.windows(2).all(|pair| pair[0] < pair[1]),
        "{distances:?}"
    );
    // Levels for heights on the screen are meshes where it shows them large.
    let heights = lods(&["--max-difference", "0.34", "--screen-height", "270"]);
    let is_near = |level: &&Value| level["pixels_high"].as_f64().is_some_and(|px| px > 100.0);
    let mut near = levels(&heights).iter().filter(is_near);
    assert!(!near.any(|level| is_cards(&level)));
}

/// A browser compiles the GLSL sampler of the manual.
#[test]
fn the_glsl_sampler_compiles() {
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    let manual = include_str!("../../docs/impostors.md");
    let (_, rest) = manual.split_once("```glsl\n").unwrap();
    let (shader, _) = rest.split_once("\n```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let html = "<!DOCTYPE html><link rel=\"icon\" href=\"data:,\"><canvas></canvas><script>document.documentElement.dataset.ready = 1</script>";
    std::fs::write(&page, html).unwrap();
    tab.visit(&page);
    let shader = Value::from(shader);
    let log = tab.ask(&format!(
        "(() => {{ const gl = document.querySelector('canvas').getContext('webgl2'); const s = gl.createShader(gl.FRAGMENT_SHADER); gl.shaderSource(s, {shader}); gl.compileShader(s); return gl.getShaderParameter(s, gl.COMPILE_STATUS) ? 'compiled' : gl.getShaderInfoLog(s); }})()"
    ));
    assert_eq!(log, "compiled");
}
