//! Wind: what leaves and wood hang on is in the tree and in every level of it, and what is left moves as
//! it moved in the original.

use std::collections::{HashMap, HashSet};

use secateur::glam::{DVec2, Vec3};
use secateur::{Detail, Document, Hold, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_runtime::wind::Wind;
use serde_json::{Value, json};

use crate::glb::{chunks, joined};
use crate::no_larger::{INSTANCES, instanced_crown};
use crate::program::Bench;
use crate::tab::{DESKTOP, Tab};

/// The materials of a grown plant.
const BOTH: [&str; 2] = ["leaf", "bark"];

/// A vertex, by its bits: what it hangs on.
type Key = (Option<usize>, [u32; 3], u32);

fn key(hold: &Hold) -> Key {
    (
        hold.segment.map(|segment| segment.index()),
        hold.pivot.to_array().map(f32::to_bits),
        hold.along_m.to_bits(),
    )
}

/// Vertices of a file with what they hang on: mesh by mesh, primitive by primitive.
fn vertices(file: &Opened, material: &str) -> Vec<(Vec3, Hold)> {
    let root = file.document.json();
    let mut found = Vec::new();
    for (mesh, json) in root["meshes"].as_array().unwrap().iter().enumerate() {
        for (primitive, json) in json["primitives"].as_array().unwrap().iter().enumerate() {
            let number = json["material"].as_u64().unwrap() as usize;
            if !root["materials"][number]["name"]
                .as_str()
                .unwrap()
                .contains(material)
            {
                continue;
            }
            let holds = file.document.holds(mesh, primitive).unwrap();
            let holds = holds.expect("every primitive of a level says what it hangs on");
            let positions = file.vectors(&json["attributes"]["POSITION"]);
            assert_eq!(positions.len(), holds.len());
            found.extend(positions.into_iter().zip(holds));
        }
    }
    found
}

/// A GLB: what `secateur` reads of it, and its bytes.
struct Opened {
    document: Document,
    bin: Vec<u8>,
}

impl Opened {
    /// The vectors of an accessor of floats.
    fn vectors(&self, accessor: &Value) -> Vec<Vec3> {
        let root = self.document.json();
        let accessor = &root["accessors"][accessor.as_u64().unwrap() as usize];
        assert_eq!(accessor["componentType"], 5126);
        let view = &root["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |of: &Value| of.as_u64().unwrap_or(0) as usize;
        let first = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
        let stride = number(&view["byteStride"]).max(12);
        let float = |at: usize| f32::from_le_bytes(self.bin[at..at + 4].try_into().unwrap());
        (0..number(&accessor["count"]))
            .map(|k| first + k * stride)
            .map(|at| Vec3::new(float(at), float(at + 4), float(at + 8)))
            .collect()
    }
}

fn opened(bench: &Bench, name: &str) -> Opened {
    let bytes = bench.read(name);
    let (_, bin) = chunks(&bytes);
    Opened {
        bin: bin.to_vec(),
        document: Document::from_bytes(name, bytes, None).unwrap(),
    }
}

/// A GLB with another JSON.
fn edited(glb: &[u8], edit: impl Fn(&mut Value)) -> Vec<u8> {
    let (json, bin) = chunks(glb);
    let mut root: Value = serde_json::from_slice(json).unwrap();
    edit(&mut root);
    joined(&root, bin)
}

/// A grown plant whose file does not say what leaves and wood hang on.
pub(crate) fn silent(grown: &[u8]) -> Vec<u8> {
    edited(grown, |root| {
        root.as_object_mut().unwrap().shift_remove("extras");
        for mesh in root["meshes"].as_array_mut().unwrap() {
            for primitive in mesh["primitives"].as_array_mut().unwrap() {
                let attributes = primitive["attributes"].as_object_mut().unwrap();
                attributes.retain(|name, _| !name.starts_with("_WIND"));
            }
        }
    })
}

/// A bench with a maple whose leaves have four triangles: they can get coarser.
fn maple() -> Bench {
    let bench = Bench::for_small_screen();
    let options = GrowOptions {
        leaves: 150,
        seed: 2,
    };
    bench.put(
        "maple.glb",
        &plant_to_glb(&grow(Species::Maple, &options).unwrap()),
    );
    bench
}

/// Whatever is left hangs where it hung in the original, and so moves as it did, at any time.
fn moves_as_before(original: &Opened, level: &Opened, name: &str, materials: &[&str]) {
    let wind = Wind::new(DVec2::new(1.0, 0.5), 8.0, 0.6, 30.0);
    for material in materials {
        let mut motion: HashMap<Key, Hold> = HashMap::new();
        for (_, hold) in vertices(original, material) {
            motion.insert(key(&hold), hold);
        }
        let left = vertices(level, material);
        assert!(!left.is_empty(), "{name}: {material}");
        let mut seen = HashSet::new();
        for (position, hold) in &left {
            let before = motion.get(&key(hold));
            let before = before.unwrap_or_else(|| panic!("{name}: {material} hangs elsewhere"));
            seen.insert(key(hold));
            for second in [0.0, 1.7, 4.1] {
                let wind = wind.at(second, 5.0);
                let [now, then] = [hold, before].map(|hold| {
                    let ends = [*position, hold.pivot].map(|p| wind.swayed(p, hold));
                    ends.map(|p| p.to_array().map(f32::to_bits))
                });
                assert_eq!(now, then, "{name}: {material}");
            }
        }
        assert!(seen.len() > 10, "{name}: {material}");
    }
}

#[test]
fn every_level_hangs_where_the_original_hung() {
    let bench = maple();
    let original = opened(&bench, "maple.glb");
    let simplify: [(&str, &[&str]); 3] = [
        ("grown.glb", &["--ratio", "0.3", "--order", "maple.order"]),
        (
            "coarser.glb",
            &["--triangles", "0.3", "--leaf-triangles", "1"],
        ),
        ("fsa.glb", &["--method", "fsa", "--leaves", "40"]),
    ];
    for (name, arguments) in simplify {
        let all = [&["maple.glb", "-o", name], arguments].concat();
        bench.simplify(&all).succeeded();
        moves_as_before(&original, &opened(&bench, name), name, &BOTH);
    }
    let lod = [
        "lod",
        "maple.glb",
        "-o",
        "lod.glb",
        "--order",
        "maple.order",
        "--leaves",
        "70",
    ];
    bench.run(&lod).succeeded();
    moves_as_before(&original, &opened(&bench, "lod.glb"), "lod.glb", &BOTH);
    // A stream's prefix is a plant that says it, too.
    let stream = ["stream", "maple.glb", "-o", "maple.stream"];
    let more = ["--order", "maple.order", "--report", "s.json"];
    bench.run(&[&stream[..], &more].concat()).succeeded();
    let bytes = bench.json("s.json")["pieces"][2]["bytes"].to_string();
    let read = ["stream", "--read", "maple.stream", "-o", "prefix.glb"];
    bench
        .run(&[&read[..], &["--bytes", &bytes]].concat())
        .succeeded();
    moves_as_before(
        &original,
        &opened(&bench, "prefix.glb"),
        "prefix.glb",
        &BOTH,
    );
    let lods = [
        "lods",
        "maple.glb",
        "-o",
        "lods.glb",
        "--levels",
        "0.4,0.15",
    ];
    bench.run(&lods).succeeded();
    moves_as_before(&original, &opened(&bench, "lods.glb"), "lods.glb", &BOTH);
    bench
        .run(&["lods", "maple.glb", "-o", "chain", "--levels", "0.4"])
        .succeeded();
    let level = "chain/maple_LOD0.glb";
    moves_as_before(&original, &opened(&bench, level), level, &BOTH);
}

/// Of a plant whose file does not say it, what leaves and wood hang on is found by where they are: about where the rules
/// of the plant have it, and every level moves as the plant does.
#[test]
fn what_a_silent_plant_hangs_on_is_found() {
    let bench = maple();
    let silent = silent(&bench.read("maple.glb"));
    bench.put("silent.glb", &silent);
    let lods = [
        "lods",
        "silent.glb",
        "-o",
        "chain",
        "--levels",
        "0.4",
        "--wind",
    ];
    bench.run(&lods).succeeded();
    let [said, found] = ["maple.glb", "chain/silent_LOD0.glb"].map(|name| opened(&bench, name));
    moves_as_before(
        &found,
        &opened(&bench, "chain/silent_LOD1.glb"),
        "LOD1",
        &BOTH,
    );
    for (material, most) in [("leaf", 0.06), ("bark", 0.2)] {
        let said: HashMap<[u32; 3], Hold> = vertices(&said, material)
            .into_iter()
            .map(|(at, hold)| (at.to_array().map(f32::to_bits), hold))
            .collect();
        let found = vertices(&found, material);
        let (mut apart_m, mut more_m, mut high_m) = (0.0, 0.0, 0.0f32);
        for (at, hold) in &found {
            let said = said[&at.to_array().map(f32::to_bits)];
            apart_m += said.pivot.distance(hold.pivot);
            more_m += (said.along_m - hold.along_m).abs();
            high_m = high_m.max(said.along_m);
        }
        let [apart, more] = [apart_m, more_m].map(|sum| sum / found.len() as f32 / high_m);
        assert!(apart < most && more < 0.1, "{material}: {apart} {more}");
    }
    // A level made by itself moves alike.
    let level = ["silent.glb", "-o", "one.glb", "--ratio", "0.3", "--wind"];
    bench.simplify(&level).succeeded();
    moves_as_before(&found, &opened(&bench, "one.glb"), "one.glb", &BOTH);
}

/// Leaves that are instances, or nodes of one mesh, hang each where it is.
#[test]
fn leaves_of_one_mesh_hang_apart() {
    let bench = Bench::for_small_screen();
    let instances = instanced_crown();
    let nodes = edited(&instances, |root| {
        let node =
            |k: usize| json!({"mesh": 0, "translation": [0.3 * k as f64, 0.1 * k as f64, 0.0]});
        root["nodes"] = (0..40).map(node).collect();
        root["scenes"][0]["nodes"] = (0..40).collect();
        root.as_object_mut().unwrap().remove("extensionsRequired");
        root.as_object_mut().unwrap().remove("extensionsUsed");
    });
    for (name, glb, leaves) in [("nodes", nodes, 40), ("instances", instances, INSTANCES)] {
        let file = format!("{name}.glb");
        bench.put(&file, &glb);
        let lods = [
            "lods", &file, "-o", name, "--levels", "0.6", "--as-one", "--wind",
        ];
        bench.run(&lods).succeeded();
        let [plant, level] =
            ["LOD0", "LOD1"].map(|level| opened(&bench, &format!("{name}/{name}_{level}.glb")));
        let pivots: HashSet<Key> = vertices(&plant, "leaf")
            .iter()
            .map(|(_, hold)| key(hold))
            .collect();
        assert_eq!(pivots.len(), leaves, "{name}");
        moves_as_before(&plant, &level, name, &["leaf"]);
    }
}

/// A node that moves a plant moves what it hangs on, where the plant is drawn and where a level is put
/// into the space of the scene.
#[test]
fn pivots_stand_where_nodes_put_them() {
    let bench = maple();
    let moved = edited(&bench.read("maple.glb"), |root| {
        let nodes = root["nodes"].as_array_mut().unwrap();
        let tree = nodes.iter_mut().find(|node| node["name"] == "Tree");
        let tree = tree.unwrap();
        tree["translation"] = json!([3.0, 0.0, -2.0]);
        tree["scale"] = json!([2.0, 2.0, 2.0]);
    });
    bench.put("moved.glb", &moved);
    let holds = |name: &str| -> Vec<Hold> {
        let document = opened(&bench, name).document;
        let surfaces = document.surfaces_with(Detail::Full, &[]).unwrap();
        surfaces.into_iter().flat_map(|(s, _)| s.holds).collect()
    };
    let (plain, placed) = (holds("maple.glb"), holds("moved.glb"));
    assert!(!plain.is_empty() && plain.len() == placed.len());
    for (plain, placed) in plain.iter().zip(&placed) {
        let expected = 2.0 * plain.pivot + Vec3::new(3.0, 0.0, -2.0);
        assert!(placed.pivot.distance(expected) < 1e-5);
        assert!((placed.along_m - 2.0 * plain.along_m).abs() < 1e-5);
        assert_eq!(placed.segment, plain.segment);
    }
    let lods = ["lods", "moved.glb", "-o", "level.glb", "--levels", "0.4"];
    bench.run(&lods).succeeded();
    let of_original: HashSet<Key> = placed.iter().map(key).collect();
    let of_level = holds("level.glb");
    assert!(!of_level.is_empty());
    let is_known = |hold: &Hold| of_original.contains(&key(hold));
    assert!(of_level.iter().all(is_known));
}

/// Other people's trees say what leaves hang on in colours, attributes and extras of their own.
#[test]
fn wind_data_of_other_programs_stays_as_it_is() {
    let bench = maple();
    let theirs = edited(&bench.read("maple.glb"), |root| {
        let attributes = &mut root["meshes"][1]["primitives"][0]["attributes"];
        attributes["_PIVOT"] = attributes["_WIND_PIVOT"].clone();
        attributes["COLOR_1"] = attributes["COLOR_0"].clone();
        root["meshes"][1]["extras"] = json!({"pivots": [[0.0, 1.5, 0.0]], "sway": 0.25});
    });
    bench.put("theirs.glb", &theirs);
    let simplify = ["simplify", "theirs.glb", "-o", "one.glb", "--ratio", "0.3"];
    let lods = ["lods", "theirs.glb", "-o", "many.glb", "--levels", "0.4"];
    for (name, arguments) in [("one.glb", simplify), ("many.glb", lods)] {
        bench.run(&arguments).succeeded();
        let level = opened(&bench, name);
        let root = level.document.json();
        let meshes = root["meshes"].as_array().unwrap().iter();
        let theirs: Vec<&Value> = meshes
            .flat_map(|mesh| mesh["primitives"].as_array().unwrap())
            .map(|primitive| &primitive["attributes"])
            .filter(|attributes| attributes.get("_PIVOT").is_some())
            .collect();
        assert!(!theirs.is_empty(), "{name}");
        for attributes in theirs {
            assert!(attributes.get("COLOR_1").is_some(), "{name}");
            let pivots = ["_WIND_PIVOT", "_PIVOT"].map(|of| level.vectors(&attributes[of]));
            assert_eq!(pivots[0], pivots[1], "{name}");
        }
        let text = root.to_string();
        assert!(
            text.contains(r#""pivots":[[0.0,1.5,0.0]]"#),
            "{name}: {text:.2000}"
        );
    }
}

/// The GLSL that is handed out compiles in a browser, and sways as the twin in Rust does.
#[test]
fn the_glsl_sways_as_its_twin_does() {
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let html = "<!DOCTYPE html><link rel=\"icon\" href=\"data:,\"><canvas></canvas><script>document.documentElement.dataset.ready = 1</script>";
    std::fs::write(&page, html).unwrap();
    tab.visit(&page);
    let bench = maple();
    let leaves = vertices(&opened(&bench, "maple.glb"), "leaf");
    let leaves = &leaves[..200];
    let wind = Wind::new(DVec2::new(-0.3, 0.8), 6.0, 0.4, 50.0).at(12.3, 4.0);
    let shader = format!(
        "#version 300 es\n{}\nin vec3 a_position; in vec3 a_pivot; in float a_along; in uvec2 a_segment; out vec3 v_found;\nvoid main() {{ v_found = swayed(a_position, a_pivot, a_along, a_segment.x | a_segment.y << 16); }}",
        secateur_shaders::WIND_GLSL
    );
    let of = |vector: fn(&(Vec3, Hold)) -> Vec<f32>| -> Value {
        json!(leaves.iter().flat_map(vector).collect::<Vec<f32>>())
    };
    let segments = leaves.iter().flat_map(|(_, hold)| {
        let number = hold.segment.map_or(0, |segment| segment.index() + 1);
        [number & 0xffff, number >> 16]
    });
    let told = json!({
        "shader": shader,
        "positions": of(|(position, _)| position.to_array().to_vec()),
        "pivots": of(|(_, hold)| hold.pivot.to_array().to_vec()),
        "along": of(|(_, hold)| vec![hold.along_m]),
        "segments": segments.collect::<Vec<usize>>(),
        "toward": wind.toward.to_array(),
        "axis": wind.axis.to_array(),
        "turns": wind.turns,
        "bend": wind.bend,
        "flutter": wind.flutter,
    });
    let script = include_str!("browser/sway.js");
    let found = tab.ask(&format!("({script})({told})"));
    let found = found.as_array().unwrap_or_else(|| panic!("{found}"));
    assert_eq!(found.len(), 3 * leaves.len());
    let mut most = 0.0f32;
    for ((position, hold), found) in leaves.iter().zip(found.chunks(3)) {
        let found = Vec3::from_array([0, 1, 2].map(|k| found[k].as_f64().unwrap() as f32));
        let expected = wind.swayed(*position, hold);
        assert!(found.distance(expected) < 1e-5, "{found} {expected}");
        most = most.max(position.distance(expected));
    }
    assert!(most > 0.05, "{most} m is no wind");
}
