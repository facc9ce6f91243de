//! Tells the program which commit it is built from.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=SECATEUR_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--path-format=absolute", "--git-path", name])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    if env::var_os("SECATEUR_COMMIT").is_none()
        && let Some(commit) = git(&["rev-parse", "HEAD"])
    {
        println!("cargo::rustc-env=SECATEUR_COMMIT={commit}");
    }
}

/// What git says on one line, if it is there and the sources are its own.
fn git(arguments: &[&str]) -> Option<String> {
    let folder = env::var_os("CARGO_MANIFEST_DIR")?;
    let run = Command::new("git")
        .args(arguments)
        .current_dir(folder)
        .output()
        .ok()?;
    let text = String::from_utf8(run.stdout).ok()?;
    let line = text.trim();
    (run.status.success() && !line.is_empty()).then(|| line.to_owned())
}
