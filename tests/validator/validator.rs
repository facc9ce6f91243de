//! Runs the Khronos glTF validator on files that a test wrote.
//!
//! Included with `#[path]` by the crates whose tests need it. The validator is
//! an npm package: `npm ci --prefix tests/validator` installs it.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Panics if the validator finds an error in one of the files.
///
/// Where node or the validator are missing it says so and does nothing, unless
/// the environment has `SECATEUR_REQUIRE_VALIDATOR=1`: then it panics.
pub fn assert_valid(files: &[PathBuf]) {
    if files.is_empty() {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/validator");
    let is_installed = folder.join("node_modules/gltf-validator").is_dir();
    let script = folder.join("validate.mjs");
    let output = Command::new("node").arg(script).args(files).output();
    let output = match output {
        Ok(output) if is_installed => output,
        _ => {
            let hint = "the Khronos validator is missing; npm ci --prefix tests/validator";
            let is_required = std::env::var("SECATEUR_REQUIRE_VALIDATOR").is_ok_and(|v| v == "1");
            assert!(!is_required, "{hint}");
            eprintln!("SKIPPED validation of {} files: {hint}", files.len());
            return;
        }
    };
    let report = String::from_utf8_lossy(&output.stdout);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{report}{complaint}");
    assert_eq!(report.lines().count(), files.len(), "a line for each file");
}
