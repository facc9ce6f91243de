//! Chains that end in pictures of the tree.

use std::path::PathBuf;

use secateur::Document;
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
    let bench = Bench::new();
    for (layout, output) in [("files", "c"), ("siblings", "s.glb"), ("msft", "m.glb")] {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            output,
            "--layout",
            layout,
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
        let kinds: Vec<&str> = made.iter().map(|l| l["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds, ["mesh", "mesh", "impostor"]);
        let last = &made[2];
        assert!((4..=8).contains(&count(&last["triangles"])), "{last}");
        assert_eq!(last["leaves"], 0);
        assert_eq!(last["silhouette_iou"], Value::Null);
        for figure in [&last["flip_mean"], &last["impostor"]["mesh_flip_mean"]] {
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
        // Any client draws it, about as large as the tree; of MSFT_lod only one that knows it.
        if layout != "msft" {
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
        "--max-flip",
        "0.05",
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
    for (max_flip, is_taken) in [("0.9", true), ("0.01", false)] {
        let lods = [
            "lods",
            "oak.glb",
            "-o",
            "c",
            "--distances",
            "200",
            "--max-flip",
            max_flip,
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
