//! Python's package: its own tests, on the library that was built beside the program.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The compiled part, if it was built just before: tests/run.sh does so, and says it by this variable.
fn compiled() -> Option<PathBuf> {
    if std::env::var("SECATEUR_REQUIRE_PYTHON").is_err() {
        eprintln!("SKIPPED: tests/run.sh builds Python's package and runs its tests");
        return None;
    }
    let beside = Path::new(env!("CARGO_BIN_EXE_secateur")).parent().unwrap();
    let names = [
        "libsecateur_python.so",
        "libsecateur_python.dylib",
        "secateur_python.dll",
    ];
    let found = names.iter().map(|name| beside.join(name));
    Some(found.into_iter().find(|file| file.exists()).unwrap())
}

#[test]
fn the_tests_of_pythons_package_pass() {
    let Some(compiled) = compiled() else {
        return;
    };
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python");
    let site = tempfile::tempdir().unwrap();
    let package = site.path().join("secateur");
    std::fs::create_dir(&package).unwrap();
    for entry in std::fs::read_dir(crate_folder.join("python/secateur")).unwrap() {
        let entry = entry.unwrap();
        if entry.file_type().unwrap().is_file() {
            std::fs::copy(entry.path(), package.join(entry.file_name())).unwrap();
        }
    }
    let ending = match cfg!(windows) {
        true => "pyd",
        false => "abi3.so",
    };
    std::fs::copy(compiled, package.join(format!("_secateur.{ending}"))).unwrap();
    let mut folders = vec![site.path().to_owned()];
    folders.extend(std::env::var_os("SECATEUR_PYTHON_PACKAGES").map(PathBuf::from));
    let output = Command::new("python3")
        .args(["-m", "unittest", "discover", "--start-directory"])
        .arg(crate_folder.join("tests"))
        .env("PYTHONPATH", std::env::join_paths(folders).unwrap())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("SECATEUR", env!("CARGO_BIN_EXE_secateur"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("\nOK"), "{said}");
}
