//! Levels of whole plants by gltfpack, as its users make them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use secateur_gltf::Document;
use secateur_model::{Memory, Surface};

use super::{PlantOutcome, count};
use crate::shell;
use crate::{Error, Host};

/// At most this many ratios are tried for a level.
const MOST_TRIES: usize = 8;

/// A level is near enough below its budget with this much of it.
const NEAR: f64 = 0.98;

/// gltfpack, where the system finds it.
#[derive(Debug)]
pub(crate) struct Gltfpack {
    /// As it says itself: `gltfpack 1.3`.
    version: String,
}

/// What one ratio gave.
struct Try {
    ratio: f64,
    surfaces: Vec<Surface>,
    seconds: f64,
}

impl Gltfpack {
    /// The program of that name, if it runs.
    pub(crate) fn find() -> Option<Self> {
        let said = Command::new("gltfpack")
            .arg("-v")
            .stdin(Stdio::null())
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&said.stdout).into_owned();
        let version = text.lines().find(|line| line.starts_with("gltfpack"))?;
        Some(Self {
            version: version.trim().to_owned(),
        })
    }

    /// The file with as many triangles as it has at most within the budget. gltfpack stops short of
    /// the share that it is asked for, mostly below it, so that larger ones are tried too; where the
    /// level's own leaves more than the budget, that is what it can do.
    pub(super) fn made(
        &self,
        tree: &Path,
        level: f64,
        budget: u64,
        memory: Memory,
        host: &dyn Host,
    ) -> Result<PlantOutcome, Error> {
        let mut best = run(tree, level, memory)?;
        let (mut low, mut high) = (level, 1.0);
        for _ in 1..MOST_TRIES {
            let near = NEAR * budget as f64;
            let found = count(&best.surfaces);
            if found > budget || found as f64 >= near || host.is_stop_asked() {
                break;
            }
            let ratio = f64::sqrt(low * high);
            let other = run(tree, ratio, memory)?;
            if count(&other.surfaces) > budget {
                high = ratio;
                continue;
            }
            low = ratio;
            if count(&other.surfaces) > found {
                best = other;
            }
        }
        Ok(PlantOutcome {
            leaves_final: 0,
            wood_triangles_final: None,
            seconds: best.seconds,
            peak_rss_bytes: None,
            resolution: 0,
            engine: self.version.clone(),
            adapter: None,
            command: format!(
                "gltfpack -i {} -o out.glb -si {} -sa",
                shell::path(tree),
                best.ratio
            ),
            surfaces: best.surfaces,
        })
    }
}

/// Runs it with a ratio, and reads what it writes.
fn run(tree: &Path, ratio: f64, memory: Memory) -> Result<Try, Error> {
    // What a command of a row can say again.
    let ratio = (1e4 * ratio).round() / 1e4;
    let failed = |reason: String| Error::Tree {
        path: tree.to_owned(),
        reason: format!("gltfpack makes nothing of it: {reason}"),
    };
    let folder = tempfile::tempdir().map_err(|e| failed(e.to_string()))?;
    let output: PathBuf = folder.path().join("out.glb");
    let begun = Instant::now();
    let ran = Command::new("gltfpack")
        .arg("-i")
        .arg(tree)
        .arg("-o")
        .arg(&output)
        .args(["-si", &ratio.to_string(), "-sa"])
        .stdin(Stdio::null())
        .output()
        .map_err(|e| failed(e.to_string()))?;
    // Nobody knows where the folder was.
    let without_folder = |said: &str| said.replace(&output.display().to_string(), "out.glb");
    let seconds = begun.elapsed().as_secs_f64();
    if !ran.status.success() {
        let said = String::from_utf8_lossy(&ran.stderr).into_owned();
        let said = said.lines().next().unwrap_or("it does not say why");
        return Err(failed(without_folder(said)));
    }
    let document = Document::open_within(&output, memory);
    // Nothing has to be told apart.
    let surfaces = document.and_then(|document| document.surfaces(&[]));
    let surfaces = surfaces.map_err(|e| failed(without_folder(&e.to_string())))?;
    Ok(Try {
        ratio,
        surfaces: surfaces.into_iter().map(|(surface, _)| surface).collect(),
        seconds,
    })
}
