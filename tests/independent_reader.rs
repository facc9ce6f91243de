//! Outputs read by the crate `gltf`, which shares no code with this project.

use std::path::Path;

use gltf::{Gltf, Node};
use serde_json::Value;

use crate::program::Bench;

/// A file as the other reader has it.
fn read(path: &Path) -> Gltf {
    Gltf::from_slice(&std::fs::read(path).unwrap())
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The triangles below a node; every index names a vertex, and every position is finite.
fn triangles_below(node: &Node<'_>, blob: &[u8]) -> u64 {
    let of_mesh = node.mesh().map_or(0, |mesh| {
        let of_primitive = |primitive: gltf::Primitive<'_>| {
            let reader = primitive.reader(|_| Some(blob));
            let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
            assert!(positions.as_flattened().iter().all(|x| x.is_finite()));
            let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            assert!(indices.iter().all(|&i| (i as usize) < positions.len()));
            indices.len() as u64 / 3
        };
        mesh.primitives().map(of_primitive).sum()
    });
    let of_children = node.children().map(|child| triangles_below(&child, blob));
    of_mesh + of_children.sum::<u64>()
}

fn triangles_of_scene(file: &Gltf) -> u64 {
    let blob = file.blob.as_deref().unwrap();
    let scene = file.default_scene().unwrap();
    scene.nodes().map(|n| triangles_below(&n, blob)).sum()
}

/// The triangles of each level that a record tells of, finest first.
fn told(record: &Value) -> Vec<u64> {
    let levels = record["levels"].as_array().unwrap().iter();
    levels.map(|l| l["triangles"].as_u64().unwrap()).collect()
}

#[test]
fn another_reader_finds_the_levels_of_every_layout() {
    let bench = Bench::for_small_screen();
    let lods = [
        "lods",
        "oak.glb",
        "--effort=fast",
        "--levels",
        "0.5,0.2",
        "--report",
        "r.json",
        "--overwrite",
    ];
    for layout in ["files", "siblings", "msft"] {
        let place = match layout {
            "files" => "levels",
            _ => "levels.glb",
        };
        let args = [&lods[..], &["--layout", layout, "-o", place]].concat();
        bench.run(&args).succeeded();
        let record = bench.json("r.json");
        let told = told(&record);
        assert_eq!(told.len(), 3, "{layout}");
        if layout == "files" {
            for (k, triangles) in told.iter().enumerate() {
                let file = read(&bench.path(&format!("levels/oak_LOD{k}.glb")));
                assert_eq!(triangles_of_scene(&file), *triangles, "level {k}");
            }
            continue;
        }
        let file = read(&bench.path(place));
        let blob = file.blob.as_deref().unwrap();
        let named = |k: usize| {
            let name = record["levels"][k]["node"].as_str().unwrap().to_owned();
            let node = file.nodes().find(|n| n.name() == Some(&name));
            node.unwrap_or_else(|| panic!("{layout} has no node {name}"))
        };
        for (k, triangles) in told.iter().enumerate() {
            assert_eq!(
                triangles_below(&named(k), blob),
                *triangles,
                "{layout}, level {k}"
            );
        }
    }
}

#[test]
fn another_reader_finds_the_triangles_of_a_level() {
    let bench = Bench::for_small_screen();
    let simplify = ["simplify", "oak.glb", "-o", "out.glb", "--triangles", "0.3"];
    bench
        .run(&[&simplify[..], &["--report", "r.json"]].concat())
        .succeeded();
    let told = bench.json("r.json")["triangles"]["final"].as_u64();
    assert_eq!(
        Some(triangles_of_scene(&read(&bench.path("out.glb")))),
        told
    );
}
