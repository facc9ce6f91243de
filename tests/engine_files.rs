//! What `lods --for` writes beside levels: read by the engine itself where it can be had, else held against its format.

use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use crate::program::Bench;

/// Levels of the oak for an engine, and their records.
fn levels_for(engine: &str) -> (Bench, Vec<Value>) {
    let bench = Bench::for_small_screen();
    let lods = ["lods", "oak.glb", "-o", "out", "--levels", "0.5,0.2"];
    let more = [
        "--impostor=none",
        "--effort=fast",
        "--format=json",
        "--for",
        engine,
    ];
    let ran = bench.run(&[&lods[..], &more].concat()).succeeded();
    let record: Value = serde_json::from_str(&ran.stdout).unwrap();
    let files = record["files"].as_array().unwrap().iter();
    for file in files {
        assert!(bench.path(file.as_str().unwrap()).exists(), "{file}");
    }
    (bench, record["levels"].as_array().unwrap().clone())
}

fn text(bench: &Bench, file: &str) -> String {
    let text = String::from_utf8(bench.read(file)).unwrap();
    assert!(!text.contains('@') || !text.contains("@LEVELS@"), "{text}");
    text
}

/// The distances at which levels switch, as four digits say them.
fn switches(levels: &[Value]) -> Vec<f64> {
    let all = levels
        .iter()
        .map(|level| level["distance"].as_f64().unwrap());
    all.map(|m| (m * 1e4).round() / 1e4).collect()
}

#[test]
fn godot_gets_a_scene_whose_ranges_join() {
    let (bench, levels) = levels_for("godot");
    let scene = text(&bench, "out/oak.tscn");
    assert!(scene.starts_with("[gd_scene load_steps=2 format=3]\n"));
    assert!(scene.contains("type=\"PackedScene\" path=\"oak.glb\" id=\"1\""));
    let values = |key: &str| -> Vec<f64> {
        let lines = scene.lines().filter_map(|line| line.strip_prefix(key));
        let values = lines.filter_map(|rest| rest.strip_prefix(" = "));
        values.map(|value| value.parse().unwrap()).collect()
    };
    // Godot fades from a margin before a range's end to one behind it: from where the next level begins on.
    let ends = values("visibility_range_end").into_iter();
    let bands = ends.zip(values("visibility_range_end_margin"));
    for ((end, margin), level) in bands.zip(&levels) {
        let close = |a: f64, key: &str| (a - level["blend"][key].as_f64().unwrap()).abs() < 1e-3;
        assert!(
            close(end - margin, "begin") && close(end + margin, "end"),
            "{end} {margin}"
        );
    }
    for key in ["", "_margin"] {
        let [begins, ends] =
            ["begin", "end"].map(|side| values(&format!("visibility_range_{side}{key}")));
        assert_eq!((begins.len(), &begins), (levels.len() - 1, &ends));
    }
    // The band begins where the next level does, and no nearer.
    let begins = levels
        .iter()
        .filter_map(|level| level["blend"]["begin"].as_f64());
    let begins: Vec<f64> = begins.map(|m| (m * 1e4).round() / 1e4).collect();
    assert_eq!(begins, switches(&levels)[1..]);
    assert_eq!(values("visibility_range_fade_mode"), [1.0; 3]);
    for k in 0..3 {
        let node = format!("[node name=\"oak_LOD{k}\" parent=\"oak\" index=\"{k}\"]");
        assert!(scene.contains(&node), "{scene}");
    }
}

#[test]
fn unity_and_bevy_get_code_with_the_levels() {
    let (bench, levels) = levels_for("unity");
    let script = text(&bench, "out/Editor/oakLods.cs");
    assert!(script.contains("const string File = \"oak.glb\";"));
    let heights: Vec<f64> = script
        .lines()
        .filter_map(|line| line.trim().strip_prefix("(\"oak_LOD"))
        .map(|rest| {
            let height = rest.split(", ").nth(1).unwrap();
            height.trim_end_matches('f').parse().unwrap()
        })
        .collect();
    assert_eq!(heights.len(), levels.len());
    // Unity refuses transitions that do not fall.
    assert!(heights.windows(2).all(|pair| pair[0] > pair[1]));
    assert_eq!(heights.last(), Some(&0.0));
    let opened = |c| script.matches(c).count();
    assert_eq!(opened('{'), opened('}'));

    let (bench, levels) = levels_for("bevy");
    let plugin = text(&bench, "out/oak_lods.rs");
    let ranges: Vec<&str> = plugin.lines().filter(|l| l.contains("\"oak_LOD")).collect();
    assert_eq!(ranges.len(), levels.len());
    // What a level fades out in, the next fades in.
    for pair in ranges.windows(2) {
        let parts = |line: &str| {
            line.trim()
                .split(", ")
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        let out = parts(pair[0])[2].trim_end_matches("),").to_owned();
        assert_eq!(out, parts(pair[1])[1]);
    }
}

/// The script runs as it is, in an editor that only notes what it is told.
#[test]
fn unreal_gets_a_script_that_makes_one_mesh() {
    let (bench, levels) = levels_for("unreal");
    assert!(text(&bench, "out/oak_unreal.py").contains("oak_LOD2.glb"));
    bench.put(
        "unreal.py",
        br#"
import json, os, types
told = []
class StaticMesh:
    def __init__(self, path): self.path = path
class AssetImportTask: pass
class StaticMeshEditorSubsystem: pass
def imports(tasks):
    for task in tasks:
        assert os.path.exists(task.filename), task.filename
        task.imported_object_paths = [task.destination_path + "/it"]
AssetToolsHelpers = types.SimpleNamespace(
    get_asset_tools=lambda: types.SimpleNamespace(import_asset_tasks=imports))
load_asset = StaticMesh
def set_lod(mesh, level, source, source_level, reuse):
    told.append([mesh.path, level, source.path])
    return level
def set_sizes(mesh, sizes):
    told.append(sizes)
    return True
get_editor_subsystem = lambda kind: types.SimpleNamespace(
    set_lod_from_static_mesh=set_lod, set_lod_screen_sizes=set_sizes)
EditorAssetLibrary = types.SimpleNamespace(
    save_loaded_asset=lambda mesh: print(json.dumps(told)))
"#,
    );
    let output = Command::new("python3")
        .arg(bench.path("out/oak_unreal.py"))
        .env("PYTHONPATH", bench.path("."))
        .output();
    let Ok(output) = output else {
        eprintln!("SKIPPED: there is no Python");
        return;
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let of = |k: usize| format!("/Game/oak/oak_LOD{k}/it");
    assert_eq!(told[0], json!([of(0), 1, of(1)]));
    assert_eq!(told[1], json!([of(0), 2, of(2)]));
    let sizes: Vec<f64> = serde_json::from_value(told[2].clone()).unwrap();
    assert!(sizes.windows(2).all(|pair| pair[0] > pair[1]), "{sizes:?}");
    // The second level begins where the first ends, by the sphere about the plant instead of its height.
    let ratio = sizes[1] / levels[0]["screen_coverage"].as_f64().unwrap();
    assert!((1.0..3f64.sqrt()).contains(&ratio), "{ratio}");
}

/// three.js and Babylon.js load the levels by the modules, and switch where the report says.
#[cfg(unix)]
#[test]
fn modules_for_the_web_switch_where_they_should() {
    let packages = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/clients/node_modules");
    if !packages.is_dir() {
        let is_required = std::env::var("SECATEUR_REQUIRE_CLIENTS").is_ok_and(|v| v == "1");
        assert!(!is_required, "{} is missing", packages.display());
        eprintln!("SKIPPED: npm ci --prefix tests/clients");
        return;
    }
    let script = include_str!("clients/engine_files.mjs");
    for engine in ["three", "babylon"] {
        let (bench, levels) = levels_for(engine);
        text(&bench, &format!("out/oak.{engine}.js"));
        bench.put("out/package.json", br#"{"type": "module"}"#);
        bench.put("out/look.mjs", script.as_bytes());
        std::os::unix::fs::symlink(&packages, bench.path("out/node_modules")).unwrap();
        let output = Command::new("node")
            .args(["look.mjs", engine])
            .current_dir(bench.path("out"))
            .output()
            .unwrap();
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{engine}: {complaint}");
        let seen: Vec<String> = serde_json::from_slice(&output.stdout).unwrap();
        // Just before and just after each switch.
        let expected: Vec<String> = (0..levels.len() - 1)
            .flat_map(|k| [format!("oak_LOD{k}"), format!("oak_LOD{}", k + 1)])
            .collect();
        assert_eq!(seen, expected, "{engine}");
    }
}

/// usd-core opens the layer, finds the triangles and points of each level, and switches where the report says.
#[test]
fn usd_gets_a_layer_whose_levels_switch() {
    let (bench, levels) = levels_for("usd");
    let layer = text(&bench, "out/oak.usda");
    assert!(layer.starts_with("#usda 1.0\n"));
    for part in [
        "[\"LODRootAPI\"]",
        "inputs:opacityThreshold = ",
        "@./oak_textures/",
    ] {
        assert!(layer.contains(part), "{part}");
    }
    let compressed = ["lods", "oak.glb", "-o", "c", "--for", "usd", "--compress"];
    bench.run(&compressed).failed_with(2, &["--compress"]);
    let Some(packages) = std::env::var_os("SECATEUR_USD_PACKAGES") else {
        let is_required = std::env::var("SECATEUR_REQUIRE_USD").is_ok_and(|v| v == "1");
        assert!(!is_required, "tests/run.sh fetches usd-core, and could not");
        eprintln!("SKIPPED: tests/run.sh fetches usd-core, which opens levels as USD");
        return;
    };
    bench.put("usd.py", include_bytes!("clients/usd.py"));
    // Just before each switch, and where the next level is alone.
    let distances = switches(&levels)[1..].to_vec();
    let at = distances.iter().flat_map(|m| [m * 0.99, m * 1.12]);
    let output = Command::new("python3")
        .args(["usd.py", "out/oak.usda", "60"])
        .args(at.map(|m| m.to_string()))
        .current_dir(bench.path("."))
        .env("PYTHONPATH", packages)
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["up"], "Y");
    let names = |k: &Value| k["name"].as_str().unwrap().to_owned();
    for (k, (level, told)) in found["levels"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&levels)
        .enumerate()
    {
        assert_eq!(names(level), format!("oak_LOD{k}"));
        assert_eq!(level["triangles"], told["triangles"]);
        assert_eq!(level["facts"]["triangles"], told["triangles"]);
        assert_ne!(level["thresholds"], json!([]), "leaves are cut out");
    }
    let points = found["levels"].as_array().unwrap().iter();
    let points: Vec<u64> = points
        .map(|level| level["points"].as_u64().unwrap())
        .collect();
    assert!(
        points.windows(2).all(|pair| pair[0] > pair[1]),
        "{points:?}"
    );
    assert_eq!(found["drawn"], json!([0.0, 1.0, 1.0, 2.0]));
    let all: Vec<String> = found["levels"]
        .as_array()
        .unwrap()
        .iter()
        .map(names)
        .collect();
    assert_eq!(found["alone"][3], json!(all), "auto has all levels");
    for (k, name) in all.iter().enumerate() {
        assert_eq!(found["alone"][k], json!([name]));
    }
}

#[test]
fn blender_gets_a_script_that_python_reads() {
    let (bench, _) = levels_for("blender");
    let script = text(&bench, "out/oak_blender.py");
    assert!(script.contains("\"oak.glb\""));
    let read = "import ast, sys; ast.parse(open(sys.argv[1]).read())";
    let status = Command::new("python3")
        .args(["-c", read])
        .arg(bench.path("out/oak_blender.py"))
        .status();
    assert!(status.map_or(true, |status| status.success()));
    let Some(packages) = std::env::var_os("SECATEUR_BPY_PACKAGES") else {
        eprintln!("SKIPPED: SECATEUR_BPY_PACKAGES names no folder with Blender as a module (bpy)");
        return;
    };
    let run = "import bpy, runpy, sys; bpy.ops.wm.read_factory_settings(use_empty=True); runpy.run_path(sys.argv[1]); \
        print('found', [(it.name, it.hide_viewport, len(it.all_objects)) for it in bpy.data.collections])";
    let output = Command::new("python3")
        .args(["-c", run])
        .arg(bench.path("out/oak_blender.py"))
        .env("PYTHONPATH", packages)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    let collections = "[('oak_LOD0', False, 1), ('oak_LOD1', True, 1), ('oak_LOD2', True, 1)]";
    assert!(told.contains(collections), "{output:?}");
}

#[test]
fn an_engine_chooses_the_layout() {
    let bench = Bench::for_small_screen();
    let lods = ["lods", "oak.glb", "-o", "out"];
    let both = ["--for", "unity", "--layout", "files"];
    bench
        .run(&[&lods[..], &both].concat())
        .misused_saying(&["--layout"]);
    let one = ["lods", "oak.glb", "-o", "one.glb", "--for", "unreal"];
    bench.run(&one).failed_with(2, &["name a folder"]);
    // What is there already is not overwritten.
    std::fs::create_dir(bench.path("out")).unwrap();
    bench.put("out/oak.tscn", b"mine");
    let godot = [&lods[..], &["--for", "godot"]].concat();
    bench
        .run(&godot)
        .failed_saying(&["oak.tscn", "--overwrite"]);
}
