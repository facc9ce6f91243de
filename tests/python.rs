//! Python's package: its wheel, installed, passes its own tests.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The wheel, if it was made just before: tests/run.sh does so, and says where by this variable.
fn wheel() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SECATEUR_WHEELS") else {
        eprintln!("SKIPPED: tests/run.sh makes Python's wheel and tests it");
        return None;
    };
    let mut wheels = std::fs::read_dir(folder).unwrap();
    Some(wheels.next().unwrap().unwrap().path())
}

#[test]
fn the_tests_of_pythons_package_pass() {
    let Some(wheel) = wheel() else {
        return;
    };
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python/tests");
    let site = tempfile::tempdir().unwrap();
    let installed = Command::new("python3")
        .args(["-m", "pip", "install", "--quiet", "--no-deps", "--no-index"])
        .args(["--root-user-action", "ignore", "--target"])
        .args([site.path(), &wheel])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&installed.stderr);
    assert!(installed.status.success(), "{said}");
    let mut folders = vec![site.path().to_owned()];
    folders.extend(std::env::var_os("SECATEUR_PYTHON_PACKAGES").map(PathBuf::from));
    let folders = std::env::join_paths(folders).unwrap();
    let program = Command::new(site.path().join("bin/secateur"))
        .arg("--version")
        .env("PYTHONPATH", &folders)
        .output()
        .unwrap();
    assert!(program.stdout.starts_with(b"secateur "), "{program:?}");
    let output = Command::new("python3")
        .args(["-m", "unittest", "discover", "--start-directory"])
        .arg(tests)
        .env("PYTHONPATH", &folders)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("SECATEUR", env!("CARGO_BIN_EXE_secateur"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("\nOK"), "{said}");
}
