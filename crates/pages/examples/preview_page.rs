//! Writes a page to look at levels of detail that lie in files, the original
//! first:
//!
//! ```text
//! cargo run --release --package secateur-pages --example preview_page -- \
//!     tree.html tree.glb half.glb tenth.glb
//! ```
//!
//! Each level is taken to be meant for half the height in pixels of the one
//! before, the first one for the whole height of the screen.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use secateur_gltf::{Detail, Document};
use secateur_levels::chain::LevelReport;
use secateur_model::Surface;
use secateur_pages::preview::{Facts, Level, Preview, page};
use secateur_runtime::Screen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [output, trees @ ..] = &arguments[..] else {
        eprintln!("usage: preview_page OUT.html ORIGINAL.glb LEVEL.glb...");
        return ExitCode::from(2);
    };
    match write(output, trees) {
        Ok(bytes) => {
            println!("{output}: {:.2} MB", bytes as f64 / 1e6);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn write(output: &str, trees: &[String]) -> Result<usize, Box<dyn Error>> {
    let read = |tree: &String| Document::open(Path::new(tree))?.surfaces_with(Detail::Full, &[]);
    let surfaces: Vec<Vec<(Surface, bool)>> = trees.iter().map(read).collect::<Result<_, _>>()?;
    let screen = Screen::default();
    let height = surfaces.first().map_or(0.0, |original| height_of(original));
    let levels: Vec<Level<'_>> = surfaces
        .iter()
        .enumerate()
        .map(|(k, surfaces)| {
            let pixels_high = (k > 0).then(|| screen.height_px / f64::powi(2.0, k as i32 - 1));
            Level {
                surfaces,
                ends: None,
                facts: facts(
                    k,
                    surfaces,
                    pixels_high.map(|px| (screen.distance(height, px), px)),
                ),
            }
        })
        .collect();
    let title = trees.first().and_then(|tree| Path::new(tree).file_stem());
    let html = page(&Preview {
        title: &title.unwrap_or_default().to_string_lossy(),
        screen,
        levels: &levels,
        continuous: None,
    })?;
    std::fs::write(output, &html)?;
    Ok(html.len())
}

/// `at`: from which distance the level is used, and its height in pixels there.
fn facts(k: usize, surfaces: &[(Surface, bool)], at: Option<(f64, f64)>) -> Facts {
    let triangles = |foliage: bool| -> u64 {
        let of = surfaces
            .iter()
            .filter(|(_, is_foliage)| *is_foliage == foliage);
        of.map(|(surface, _)| surface.triangles.len() as u64).sum()
    };
    let report = LevelReport {
        triangles: triangles(true) + triangles(false),
        foliage_triangles: triangles(true),
        wood_triangles: triangles(false),
        distance: at.map_or(0.0, |(distance, _)| distance),
        pixels_high: at.map_or(f64::INFINITY, |(_, pixels)| pixels),
        ..LevelReport::default()
    };
    Facts {
        name: format!("LOD{k}"),
        report,
    }
}

fn height_of(surfaces: &[(Surface, bool)]) -> f64 {
    let heights = || {
        surfaces
            .iter()
            .flat_map(|(s, _)| s.positions.iter().map(|p| p.y))
    };
    let highest = heights().fold(f64::NEG_INFINITY, f64::max);
    let lowest = heights().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}
