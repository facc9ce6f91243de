//! A crate of a user, made of README's own words: its dependency line and its example.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::{Bench, Ran};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn text(path: &str) -> String {
    std::fs::read_to_string(Path::new(ROOT).join(path)).unwrap()
}

/// The first block of a language in a text.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let from = text.split(&format!("```{language}\n")).nth(1).unwrap();
    from.split("```").next().unwrap()
}

/// The first example of the crate guide, without what marks it as a comment.
fn example_of_guide() -> String {
    let guide = text("crates/secateur/src/lib.rs");
    let lines = guide.lines().map_while(|line| line.strip_prefix("//!"));
    let lines = lines.map(|line| line.strip_prefix(' ').unwrap_or(line));
    let guide: Vec<&str> = lines.collect();
    let example = block(&guide.join("\n"), "no_run").to_owned();
    let shown = example.lines().filter(|line| !line.starts_with("# "));
    shown.map(|line| format!("{line}\n")).collect()
}

/// Writes the crate. Locked versions and profiles of dependencies are those of this repository, so that what is compiled
/// here serves.
fn put_crate(bench: &Bench, dependency: &str) {
    let profiles = text("Cargo.toml");
    let profiles = &profiles[profiles.find("[profile.dev]").unwrap()..];
    let manifest = format!(
        "[package]\nname = \"user\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
         [dependencies]\n{dependency}\n\n{profiles}"
    );
    bench.put("Cargo.toml", manifest.as_bytes());
    bench.put("Cargo.lock", text("Cargo.lock").as_bytes());
    std::fs::create_dir_all(bench.path("src")).unwrap();
    bench.put("src/main.rs", program_of_readme().as_bytes());
}

/// README's example as a program.
fn program_of_readme() -> String {
    let readme = text("README.md");
    let example = block(&readme, "rust");
    format!("fn main() -> Result<(), Box<dyn std::error::Error>> {{\n{example}Ok(())\n}}\n")
}

/// The folder into which this test was compiled.
fn target() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.ancestors().nth(3).unwrap().to_owned()
}

fn check_crate(bench: &Bench) -> Ran {
    let output = Command::new(env!("CARGO"))
        .args(["check", "--offline", "--quiet", "--target-dir"])
        .arg(target())
        .current_dir(bench.path(""))
        .output()
        .unwrap();
    Ran::of(&["cargo", "check"], output)
}

/// README's example, compiled with these tests.
mod example {
    include!("user_crate/example.rs");
}

/// Set where [`readmes_example`] is to run.
const RUNS_HERE: &str = "SECATEUR_RUNS_EXAMPLE_HERE";

/// Writes into the working folder, and so runs only in a process of its own.
#[test]
fn readmes_example() {
    if std::env::var_os(RUNS_HERE).is_some() {
        example::main().unwrap();
    }
}

fn run_example(bench: &Bench) {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "user_crate::readmes_example"])
        .env(RUNS_HERE, "1")
        .current_dir(bench.path(""))
        .output()
        .unwrap();
    Ran::of(&["README's example"], output).succeeded();
}

/// What README says compiles with the features that it names, runs, and writes the bytes of the program.
#[test]
fn a_user_of_readme_gets_the_programs_bytes() {
    let readme = text("README.md");
    assert_eq!(example_of_guide(), block(&readme, "rust"));

    let bench = Bench::new();
    let library = Path::new(ROOT).join("crates/secateur");
    let library = library.canonicalize().unwrap().display().to_string();
    let line = block(&readme, "toml");
    let line = line.replace("path/to/crates/secateur", &library);
    assert!(line.contains(&library));
    put_crate(&bench, &line);
    check_crate(&bench).succeeded();
    let example = text("tests/user_crate/example.rs");
    assert_eq!(example, format!("pub(super) {}", program_of_readme()));
    run_example(&bench);

    let grow = [
        "grow", "oak", "--leaves", "200", "--seed", "1", "-o", "oak.glb",
    ];
    let simplify = [
        "simplify",
        "oak.glb",
        "-o",
        "of-program.glb",
        "--triangles",
        "0.25",
    ];
    let lods = ["lods", "oak.glb", "-o", "of-program"];
    for arguments in [&grow[..], &simplify, &lods] {
        bench.run(arguments).succeeded();
    }
    assert!(bench.read("oak-25.glb") == bench.read("of-program.glb"));
    let levels = std::fs::read_dir(bench.path("levels")).unwrap();
    let names: Vec<_> = levels.map(|entry| entry.unwrap().file_name()).collect();
    assert!(names.len() > 1);
    for name in names {
        let name = name.to_string_lossy();
        let of = |folder: &str| bench.read(&format!("{folder}/{name}"));
        assert!(of("levels") == of("of-program"), "{name}");
    }
}
