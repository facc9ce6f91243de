//! Shows chains to the libraries that draw glTF on the web: three.js and
//! Babylon.js, in a browser without a window. What is drawn and counted is in the pages there.
//!
//! Included with `#[path]` by the crates whose tests need it. The libraries are
//! npm packages: `npm ci --prefix tests/clients` installs them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

/// What a page, `page.js` or `coverage.js`, saw of the chains that `jobs` names; see `clients.mjs`.
///
/// Where node, the packages or the browser are missing it says so and gives
/// nothing, unless the environment has `SECATEUR_REQUIRE_CLIENTS=1`: then it
/// panics.
pub fn show(page: &str, jobs: &Path) -> Option<Vec<Value>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/clients");
    let is_installed = folder.join("node_modules/@babylonjs/loaders").is_dir();
    let (Some(browser), true) = (browser(), is_installed && runs(Path::new("node"))) else {
        let hint = "node, Chromium or the npm packages are missing; npm ci --prefix tests/clients";
        let is_required = std::env::var("SECATEUR_REQUIRE_CLIENTS").is_ok_and(|v| v == "1");
        assert!(!is_required, "{hint}");
        eprintln!("SKIPPED: {hint}");
        return None;
    };
    let mut command = Command::new("node");
    command
        .arg(folder.join("clients.mjs"))
        .arg(browser)
        .args([jobs, Path::new(page)]);
    let output = command.stdin(Stdio::null()).output().unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

fn browser() -> Option<PathBuf> {
    let own = std::env::var_os("SECATEUR_BROWSER").map(PathBuf::from);
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ];
    own.into_iter()
        .chain(names.map(PathBuf::from))
        .find(|name| runs(name))
}

fn runs(program: &Path) -> bool {
    let version = Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    version.is_ok_and(|status| status.success())
}
