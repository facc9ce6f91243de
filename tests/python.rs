//! Python's package: its wheel, installed, passes its own tests.

use std::ffi::OsString;
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

/// Installs the wheel into a folder; where Python finds modules then, those of a variable included.
fn installed(wheel: &Path, site: &Path, packages: &str) -> OsString {
    let installed = Command::new("python3")
        .args(["-m", "pip", "install", "--quiet", "--no-deps", "--no-index"])
        .args(["--root-user-action", "ignore", "--target"])
        .args([site, wheel])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&installed.stderr);
    assert!(installed.status.success(), "{said}");
    let mut folders = vec![site.to_owned()];
    folders.extend(std::env::var_os(packages).map(PathBuf::from));
    std::env::join_paths(folders).unwrap()
}

/// The extension for Blender is whole, and works in Blender without a window where that can be had: `pip install bpy`.
#[cfg(unix)]
#[test]
fn the_extension_for_blender_makes_levels() {
    let Some(wheel) = wheel() else {
        return;
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = tempfile::tempdir().unwrap();
    let built = Command::new("bash")
        .args([&root.join("blender/build.sh"), &wheel])
        .env("CARGO_TARGET_DIR", target.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{said}");
    let extension = target.path().join("blender/extension");
    let manifest = std::fs::read_to_string(extension.join("blender_manifest.toml")).unwrap();
    let packed = format!("./wheels/{}", wheel.file_name().unwrap().to_str().unwrap());
    assert!(manifest.contains(&packed), "{manifest}");
    assert!(extension.join(packed).is_file());
    if std::env::var_os("SECATEUR_BPY_PACKAGES").is_none() {
        eprintln!("SKIPPED: SECATEUR_BPY_PACKAGES names no folder with Blender as a module (bpy)");
        return;
    }
    let site = tempfile::tempdir().unwrap();
    let folders = installed(&wheel, site.path(), "SECATEUR_BPY_PACKAGES");
    let output = Command::new("python3")
        .arg(root.join("blender/tests/test_extension.py"))
        .arg(&extension)
        .env("PYTHONPATH", folders)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("\nOK"), "{said}");
}

#[test]
fn the_tests_of_pythons_package_pass() {
    let Some(wheel) = wheel() else {
        return;
    };
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python/tests");
    let site = tempfile::tempdir().unwrap();
    let folders = installed(&wheel, site.path(), "SECATEUR_PYTHON_PACKAGES");
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
