//! The package for npm, as `web/build.sh` builds it: packed, unpacked elsewhere, and used by Node.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::program::Bench;

/// The package unpacked into `node_modules` of a folder, or nothing where it is not built or there is no npm.
fn installed(bench: &Bench) -> Option<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../target")),
        PathBuf::from,
    );
    let package = target.join("web-quick/package");
    let has_npm = Command::new("npm").arg("--version").output().is_ok();
    if !package.is_dir() || !has_npm {
        let hint = "it needs npm, and the package: bash web/build.sh quick";
        let is_required = std::env::var("SECATEUR_REQUIRE_WEB").is_ok_and(|v| v == "1");
        assert!(!is_required || !has_npm, "{hint}");
        eprintln!("SKIPPED: {hint}");
        return None;
    }
    let packed = Command::new("npm")
        .args(["pack", "--json", "--offline", "--pack-destination"])
        .args([bench.path("."), package])
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&packed.stderr);
    assert!(packed.status.success(), "{complaint}");
    let told: Value = serde_json::from_slice(&packed.stdout).unwrap();
    let files = told[0]["files"].as_array().unwrap().iter();
    let files: Vec<&str> = files.map(|file| file["path"].as_str().unwrap()).collect();
    for file in [
        "LICENSE",
        "README.md",
        "package.json",
        "nodejs/secateur.js",
        "nodejs/secateur.d.ts",
        "nodejs/secateur_bg.wasm",
        "bundler/secateur.js",
        "bundler/secateur.d.ts",
        "bundler/secateur_bg.wasm",
        "examples/node.mjs",
        "examples/worker.mjs",
    ] {
        assert!(files.contains(&file), "{file} is not in {files:?}");
    }
    let place = bench.path("node_modules/secateur");
    std::fs::create_dir_all(&place).unwrap();
    let archive = told[0]["filename"].as_str().unwrap();
    let unpacked = Command::new("tar")
        .args(["--strip-components", "1", "-xzf"])
        .arg(bench.path(archive))
        .arg("-C")
        .arg(&place)
        .status();
    assert!(unpacked.unwrap().success());
    Some(place)
}

#[track_caller]
fn node(bench: &Bench, arguments: &[&str]) -> String {
    let output = Command::new("node")
        .args(arguments)
        .current_dir(bench.path("."))
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {complaint}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn node_makes_the_bytes_of_the_program() {
    let bench = Bench::new();
    let Some(package) = installed(&bench) else {
        return;
    };
    bench
        .run(&["grow", "palmetto", "--leaves", "12", "-o", "palm.glb"])
        .succeeded();
    let lods = ["lods", "palm.glb", "-o", "levels", "--engine", "cpu"];
    bench.run(&lods).succeeded();
    let simplify = ["simplify", "palm.glb", "-o", "level.glb", "--triangles"];
    bench
        .run(&[&simplify[..], &["0.3", "--engine", "cpu"]].concat())
        .succeeded();

    let example = package.join("examples/node.mjs");
    node(&bench, &[example.to_str().unwrap(), "palm.glb", "theirs"]);
    let files = std::fs::read_dir(bench.path("theirs")).unwrap();
    let files: Vec<String> = files
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(files.len() > 1, "{files:?}");
    for file in files {
        let [ours, theirs] = ["levels", "theirs"].map(|folder| format!("{folder}/{file}"));
        assert_eq!(bench.read(&ours), bench.read(&theirs), "{file}");
    }

    // As a bundler loads it, in a Worker.
    bench.put(
        "bundled.mjs",
        br#"
import { readFileSync, writeFileSync } from "node:fs";
import { Worker } from "node:worker_threads";
const shim = `
  import { parentPort } from "node:worker_threads";
  globalThis.self = globalThis;
  globalThis.postMessage = (told) => parentPort.postMessage(told);
  parentPort.on("message", (data) => globalThis.onmessage({ data }));
  await import(${JSON.stringify(new URL("node_modules/secateur/examples/worker.mjs", import.meta.url).href)});
  parentPort.postMessage("ready");
`;
const worker = new Worker(new URL("data:text/javascript," + encodeURIComponent(shim)));
worker.on("error", (error) => { console.error(error); process.exit(1); });
worker.on("message", (told) => {
  if (told === "ready") worker.postMessage({ name: "palm.glb", bytes: readFileSync("palm.glb"), share: 0.3 });
  else if (told.error) { console.error(told.error); process.exit(1); }
  else if (told.glb) { writeFileSync("theirs.glb", told.glb); process.exit(0); }
});
"#,
    );
    node(&bench, &["--experimental-wasm-modules", "bundled.mjs"]);
    assert_eq!(bench.read("level.glb"), bench.read("theirs.glb"));
}

/// Crates, wheel, package for npm, extension for Blender and containers are of one version.
#[test]
fn everything_has_one_version() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let package: Value = serde_json::from_str(&read("web/package/package.json")).unwrap();
    assert_eq!(package["version"], version, "web/package/package.json");
    let workspace = read("Cargo.toml");
    let is_crate = |line: &&str| line.starts_with("secateur") && line.contains("path = ");
    for line in workspace.lines().filter(is_crate) {
        let own = format!("version = \"{version}\"");
        assert!(line.contains(&own), "Cargo.toml: {line}");
    }
    for member in std::fs::read_dir(root.join("crates")).unwrap() {
        let manifest = format!("{}/Cargo.toml", member.unwrap().path().display());
        let text = std::fs::read_to_string(&manifest).unwrap();
        assert!(text.contains("\nversion.workspace = true\n"), "{manifest}");
    }
    // The wheel takes its version from its crate.
    assert!(read("crates/python/pyproject.toml").contains("dynamic = [\"version\"]"));
    let blender = read("blender/extension/blender_manifest.toml");
    assert!(blender.contains(&format!("\nversion = \"{version}\"\n")));
    assert!(blender.contains(&format!("wheels/secateur-{version}-")));
}
