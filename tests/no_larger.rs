//! Levels take no more bytes and no more draws than their input, however that was packed.

use std::path::Path;

use secateur::Document;
use serde_json::{Value, json};

use crate::glb::{chunks, joined};
use crate::program::Bench;
use crate::validator::assert_valid;

/// Leaves of the instanced plant.
pub(crate) const INSTANCES: usize = 240;

/// Bytes of numbers, one list behind the other, and where each list begins.
fn packed(lists: &[&[f32]]) -> (Vec<u8>, Vec<usize>) {
    let mut bytes = Vec::new();
    let mut starts = Vec::new();
    for list in lists {
        starts.push(bytes.len());
        bytes.extend(list.iter().flat_map(|number| number.to_le_bytes()));
    }
    (bytes, starts)
}

/// A crown of one folded card that is drawn in many places by `EXT_mesh_gpu_instancing`.
pub(crate) fn instanced_crown() -> Vec<u8> {
    let card: Vec<f32> = [
        [-0.1, 0.0, 0.0],
        [0.1, 0.0, 0.0],
        [-0.1, 0.15, 0.04],
        [0.1, 0.15, 0.04],
        [-0.1, 0.3, 0.0],
        [0.1, 0.3, 0.0],
    ]
    .concat();
    let mut places: Vec<f32> = Vec::new();
    let mut turns: Vec<f32> = Vec::new();
    for k in 0..INSTANCES {
        let share = (k as f32 + 0.5) / INSTANCES as f32;
        let (up, around) = (1.0 - 2.0 * share, 2.4 * k as f32);
        let wide = (1.0 - up * up).sqrt();
        places.extend([wide * around.cos(), 2.0 + up, wide * around.sin()]);
        turns.extend([0.0, (0.5 * around).sin(), 0.0, (0.5 * around).cos()]);
    }
    let sizes = [1.0; 3 * INSTANCES];
    let (mut bin, starts) = packed(&[&card, &places, &turns, &sizes]);
    let corners: [u16; 12] = [0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4];
    let of_corners = bin.len();
    bin.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    let view =
        |start: usize, bytes: usize| json!({"buffer": 0, "byteOffset": start, "byteLength": bytes});
    let root = json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "leaves", "mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": 1, "ROTATION": 2, "SCALE": 4}}}}],
        "materials": [{"name": "leaf", "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.5, 0.1, 1.0]}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 3, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3",
                "min": [-0.1, 0.0, 0.0], "max": [0.1, 0.3, 0.04]},
            {"bufferView": 1, "componentType": 5126, "count": INSTANCES, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": INSTANCES, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5123, "count": 12, "type": "SCALAR"},
            {"bufferView": 4, "componentType": 5126, "count": INSTANCES, "type": "VEC3"}],
        "bufferViews": [view(starts[0], 72), view(starts[1], 12 * INSTANCES),
            view(starts[2], 16 * INSTANCES), view(of_corners, 24), view(starts[3], 12 * INSTANCES)],
        "buffers": [{"byteLength": bin.len()}],
    });
    joined(&root, &bin)
}

/// Instances that stay share a mesh, whatever their sizes: they are drawn at once, and take a transform each.
#[test]
fn levels_of_an_instanced_crown_are_instanced() {
    let bench = Bench::new();
    let crown = instanced_crown();
    bench.put("crown.glb", &crown);
    for share in ["0.7", "0.5", "0.2"] {
        let simplify = ["simplify", "crown.glb", "-o", "level.glb", "--overwrite"];
        bench
            .run(&[&simplify[..], &["--triangles", share]].concat())
            .succeeded();
        let level = std::fs::read(bench.path("level.glb")).unwrap();
        let root: Value = serde_json::from_slice(chunks(&level).0).unwrap();
        let primitives = |mesh: &Value| mesh["primitives"].as_array().unwrap().len();
        let meshes = root["meshes"].as_array().unwrap();
        assert_eq!(meshes.iter().map(primitives).sum::<usize>(), 1, "{root}");
        let places = &root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
        assert!(places.is_object(), "{share}: {root}");
        // Names and bounds take a little more.
        assert!(
            level.len() < crown.len() + 256,
            "{} of {}",
            level.len(),
            crown.len()
        );
    }
}

/// A trunk whose vertices lie interleaved, as glTF-Transform writes them, below a node that moves it.
fn interleaved_trunk() -> Vec<u8> {
    const RINGS: usize = 60;
    const STEPS: usize = 24;
    let mut bin: Vec<u8> = Vec::new();
    let mut corners: Vec<u16> = Vec::new();
    for ring in 0..=RINGS {
        for step in 0..STEPS {
            let around = std::f32::consts::TAU * step as f32 / STEPS as f32;
            let (x, z) = (around.cos(), around.sin());
            let up = ring as f32 / RINGS as f32;
            let vertex = [0.2 * x, 3.0 * up, 0.2 * z, x, 0.0, z, around, up];
            bin.extend(vertex.iter().flat_map(|number| number.to_le_bytes()));
            if ring < RINGS {
                let at = |ring: usize, step: usize| (ring * STEPS + step % STEPS) as u16;
                let [a, b] = [at(ring, step), at(ring, step + 1)];
                let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
                corners.extend([a, c, b, b, c, d]);
            }
        }
    }
    let (vertices, count) = (bin.len(), bin.len() / 32);
    bin.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    let attribute = |start: usize, kind: &str| json!({"bufferView": 0, "byteOffset": start, "componentType": 5126, "count": count, "type": kind});
    let mut positions = attribute(0, "VEC3");
    positions["min"] = json!([-0.2, 0.0, -0.2]);
    positions["max"] = json!([0.2, 3.0, 0.2]);
    let root = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "trunk", "mesh": 0, "scale": [2.0, 2.0, 2.0], "rotation": [0.0, 0.6, 0.0, 0.8]}],
        "materials": [{"name": "bark"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2},
            "indices": 3, "material": 0}]}],
        "accessors": [positions, attribute(12, "VEC3"), attribute(24, "VEC2"),
            {"bufferView": 1, "componentType": 5123, "count": corners.len(), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": vertices, "byteStride": 32},
            {"buffer": 0, "byteOffset": vertices, "byteLength": bin.len() - vertices}],
        "buffers": [{"byteLength": bin.len()}],
    });
    joined(&root, &bin)
}

/// The transform of the node goes into positions and normals: their old places between the texture coordinates must
/// not stay.
#[test]
fn vertices_that_lay_interleaved_are_there_once() {
    let bench = Bench::new();
    let trunk = interleaved_trunk();
    bench.put("trunk.glb", &trunk);
    bench
        .run(&["lods", "trunk.glb", "-o", "levels", "--levels", "0.5"])
        .succeeded();
    for (level, share) in [("0", 102), ("1", 70)] {
        let level = std::fs::read(bench.path(&format!("levels/trunk_LOD{level}.glb"))).unwrap();
        assert!(
            level.len() * 100 < trunk.len() * share + 51_200,
            "{} of {}",
            level.len(),
            trunk.len()
        );
    }
}

/// A sheet that Draco compressed, below a node that moves it.
fn compressed_sheet() -> Vec<u8> {
    let mut bin = include_bytes!("../crates/gltf/tests/data/sheet_edgebreaker.drc").to_vec();
    let length = bin.len();
    bin.resize(length.next_multiple_of(4), 0);
    let root = json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_draco_mesh_compression"],
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "sheet", "mesh": 0, "scale": [3.0, 3.0, 3.0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "extensions": {
            "KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}}]}],
        "accessors": [
            {"componentType": 5126, "count": 625, "type": "VEC3",
                "min": [0.0, 0.0, -0.1], "max": [1.0, 1.0, 0.1]},
            {"componentType": 5125, "count": 3456, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": length}],
        "buffers": [{"byteLength": bin.len()}],
    });
    joined(&root, &bin)
}

/// The level that is the plant itself is as it came: what compressed it need not be undone.
#[test]
fn the_plant_itself_stays_compressed_as_it_was() {
    let bench = Bench::new();
    let sheet = compressed_sheet();
    bench.put("sheet.glb", &sheet);
    bench
        .run(&["lods", "sheet.glb", "-o", "levels", "--levels", "0.3"])
        .succeeded();
    let level = std::fs::read(bench.path("levels/sheet_LOD0.glb")).unwrap();
    assert!(
        level.len() < sheet.len() + 512,
        "{} of {}",
        level.len(),
        sheet.len()
    );
    let root: Value = serde_json::from_slice(chunks(&level).0).unwrap();
    assert_eq!(root["nodes"][0]["name"], "sheet_LOD0");
    let triangles = |file: &str| {
        let ran = bench.run(&["inspect", file, "--format", "json"]);
        let record: Value = serde_json::from_str(&ran.succeeded().stdout).unwrap();
        record["triangles"].clone()
    };
    assert_eq!(triangles("levels/sheet_LOD0.glb"), triangles("sheet.glb"));
}

/// The accessors of a compressed primitive have as many vertices, between these bounds, as a decoder finds.
#[track_caller]
fn assert_says_what_is_decoded(file: &Path, root: &Value) {
    let primitive = &root["meshes"][0]["primitives"][0];
    let accessor = |number: &Value| &root["accessors"][number.as_u64().unwrap() as usize];
    let positions = accessor(&primitive["attributes"]["POSITION"]);
    let surfaces = Document::open(file).unwrap().surfaces(&[]).unwrap();
    let decoded = &surfaces[0].0.positions;
    assert_eq!(positions["count"], decoded.len());
    for axis in 0..3 {
        // Below a node that makes it three times as large.
        let of_axis = decoded.iter().map(|position| position[axis] / 3.0);
        let bounds = [
            of_axis.clone().fold(f64::INFINITY, f64::min),
            of_axis.fold(f64::NEG_INFINITY, f64::max),
        ];
        for (bound, said) in bounds.iter().zip(["min", "max"]) {
            let said = positions[said][axis].as_f64().unwrap();
            assert!((bound - said).abs() < 1e-6, "{bound} {said}");
        }
    }
}

/// What is made of a compressed plant is compressed as it was: half of it is no larger than all of it.
#[test]
fn half_of_a_compressed_plant_is_compressed() {
    let bench = Bench::new();
    let sheet = compressed_sheet();
    bench.put("sheet.glb", &sheet);
    let half = [
        "simplify",
        "sheet.glb",
        "-o",
        "half.glb",
        "--triangles",
        "0.5",
    ];
    bench.run(&half).succeeded();
    let file = bench.path("half.glb");
    let bytes = std::fs::read(&file).unwrap();
    assert!(
        bytes.len() < sheet.len(),
        "{} of {}",
        bytes.len(),
        sheet.len()
    );
    let root: Value = serde_json::from_slice(chunks(&bytes).0).unwrap();
    assert_eq!(
        root["extensionsRequired"],
        json!(["KHR_draco_mesh_compression"])
    );
    assert_says_what_is_decoded(&file, &root);
    assert_valid(&[file]);
    // Levels in one file are compressed, too, and read again.
    let levels = ["lods", "sheet.glb", "-o", "all.glb", "--levels", "0.5,0.2"];
    bench.run(&levels).succeeded();
    let all = std::fs::read(bench.path("all.glb")).unwrap();
    assert!(
        all.len() < 3 * sheet.len(),
        "{} of {}",
        all.len(),
        sheet.len()
    );
    bench.run(&["inspect", "all.glb"]).succeeded();
    let strips = [
        "simplify",
        "sheet.glb",
        "-o",
        "strips.glb",
        "--triangles",
        "0.5",
        "--strips",
    ];
    bench.run(&strips).succeeded();
    bench.run(&["inspect", "strips.glb"]).succeeded();
}
