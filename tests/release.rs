//! What people download: an archive of the program, with licences of all that it is built of.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use crate::program::Bench;

/// What `dist` would pack, and what the workflow packs, are for the same platforms.
#[test]
fn archives_are_for_the_same_platforms() {
    let dist = include_str!("../dist-workspace.toml").lines();
    let dist: Vec<&str> = dist
        .filter_map(|line| line.strip_prefix("    \"")?.strip_suffix("\","))
        .collect();
    let workflow = include_str!("../.github/workflows/release.yml").lines();
    let workflow: Vec<&str> = workflow
        .filter_map(|line| line.split_once("{ target: ")?.1.split(',').next())
        .collect();
    assert_eq!(dist, workflow);
    assert_eq!(dist.len(), 5);
}

/// Cargo forgets `strip` of the profile for a package with settings of its own: the program was 21.5 MB instead of 15.8.
#[test]
fn the_program_is_stripped() {
    let manifest = include_str!("../Cargo.toml").lines();
    let of_program = manifest.filter(|line| line.starts_with("secateur-cli = { opt-level"));
    let of_program: Vec<&str> = of_program.collect();
    assert!(
        of_program.iter().all(|line| line.contains("strip = true")),
        "{of_program:?}"
    );
}

#[test]
fn an_archive_has_the_program_its_pages_and_all_licences() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let bench = Bench::new();
    let host = "x86_64-unknown-linux-gnu";
    let has_python = Command::new("python3").arg("--version").output().is_ok();
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) || !has_python {
        eprintln!("SKIPPED: it packs for 64-bit Linux, with Python");
        return;
    }
    // A few bytes that run the program, which has many.
    let program = format!(
        "#!/bin/sh\nexec '{}' \"$@\"\n",
        env!("CARGO_BIN_EXE_secateur")
    );
    bench.put("program", program.as_bytes());
    let all = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(bench.path("program"), all).unwrap();
    let packed = Command::new("bash")
        .arg("release/archive.sh")
        .arg(host)
        .arg(bench.path("program"))
        .env("CARGO_TARGET_DIR", bench.path("target"))
        .env("CARGO_NET_OFFLINE", "true")
        .current_dir(root)
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&packed.stderr);
    assert!(packed.status.success(), "{complaint}");
    let name = format!("secateur-{}-{host}", env!("CARGO_PKG_VERSION"));
    let archive = format!("target/release-archives/{name}.tar.gz");
    assert!(bench.run_in_shell(&format!("tar -xzf {archive}")).code == Some(0));
    let version = format!("{name}/secateur --version");
    assert!(
        bench
            .run_in_shell(&version)
            .succeeded()
            .stdout
            .starts_with("secateur ")
    );
    for file in [
        "LICENSE",
        "README.md",
        "completions/secateur.zsh",
        "man/secateur-lods.1",
    ] {
        assert!(bench.path(&format!("{name}/{file}")).is_file(), "{file}");
    }
    let licences = String::from_utf8(bench.read(&format!("{name}/LICENCES.md"))).unwrap();
    for package in ["clap", "image", "wgpu"] {
        assert!(licences.contains(&format!("\n| {package} | ")), "{package}");
    }
    // Of tests alone.
    assert!(!licences.contains("\n| proptest | "));
    assert!(licences.contains("Permission is hereby granted"));
}
