//! Chains of levels of detail of whole plants: which levels, and for which distances.

mod ending;
mod error;
mod ladder;
mod leaf_texture;
mod level;
mod look;
mod maker;
mod options;
mod scene_look;
mod textures;

use secateur_gltf::WholeTree;
use secateur_raster::OpenEngine;
use secateur_simplify::Observer;

use ending::Pictured;
pub use error::ChainError;
use ladder::Ladder;
pub use level::{Chain, ChainLevel, ImpostorLevel, Shape};
use maker::{Made, Maker};
pub use options::{ChainOptions, HEIGHTS_PX, MAX_FLIP, MAX_LEVELS, Wanted};
pub use scene_look::SceneLook;
pub use textures::{LevelAsDrawn, Textures, show};

/// A level that is sought has at most this share of the triangles of the one before it: to switch
/// for less would not pay.
const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// Makes a chain of a tree.
///
/// # Errors
/// [`ChainError`] if the levels are none, or the tree can't be simplified.
pub fn chain(
    tree: &WholeTree,
    options: &ChainOptions,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<Chain, ChainError> {
    options.check()?;
    let maker = Maker::new(tree, options, engine)?;
    let mut notes = Vec::new();
    let mut made: Vec<(Made, f64, f64)> = Vec::new();
    match &options.wanted {
        Wanted::Triangles(amounts) => {
            for amount in amounts {
                let level = maker.level(amount.of(maker.all), observer)?;
                if is_no_less(&level, made.last().map(|(level, ..)| level), maker.all) {
                    notes.push(format!(
                        "a level of {} triangles is left out: it would be as large as the one before",
                        level.triangles()
                    ));
                    continue;
                }
                let before = made.last().map_or(f64::INFINITY, |(_, height, _)| *height);
                let (height, flip) = maker.height_for(&level, before);
                made.push((level, height, flip));
            }
        }
        Wanted::Heights(_) | Wanted::Distances(_) => {
            let mut ladder = Ladder::new(&maker);
            let mut first = 0;
            for (height, place) in maker.heights() {
                let rung = ladder.lightest(height, first, observer)?;
                let level = ladder.level(rung, observer)?;
                if let Some((before, ..)) = made.last()
                    && level.triangles() as f64 > MOST_OF_BEFORE * before.triangles() as f64
                {
                    notes.push(format!(
                        "no level begins at {place}: the lightest within the difference has {} triangles, which saves less than a third of the {} before",
                        level.triangles(),
                        before.triangles()
                    ));
                    continue;
                }
                let flip = maker.flip(level, height);
                made.push((level.clone(), height, flip));
                first = rung;
            }
        }
    }
    let impostor = maker.impostor(&made, &mut notes, observer)?;
    if let Some((_, height, _)) = &impostor {
        made.retain(|(_, begins, _)| begins > height);
    }
    let mut levels = Vec::new();
    for (level, height, flip) in made {
        let pictured = Pictured::Mesh(level.drawn.level.clone());
        levels.push((pictured, maker.finished(level, height, flip)?));
    }
    if let Some((level, height, flip)) = impostor {
        let pictured = Pictured::Impostor(level.impostor.clone());
        levels.push((pictured, maker.finished_impostor(level, height, flip)));
    }
    let levels = maker.without_pops(levels, &mut notes)?;
    let mut levels = maker.with_textures(levels)?;
    let ends: Vec<f64> = levels
        .iter()
        .skip(1)
        .map(|level| level.pixels_high)
        .collect();
    let is_mesh = |level: &ChainLevel| matches!(level.shape, Shape::Mesh(_));
    let last_mesh = levels.iter().rposition(is_mesh).unwrap_or(0);
    for (index, level) in levels.iter_mut().enumerate() {
        let end = ends.get(index).copied().unwrap_or(0.0);
        level.screen_coverage = end / options.screen.height_px;
        // A picture casts the shadow of a picture.
        level.shadow = match level.shape {
            Shape::Mesh(_) => (index + options.shadow_steps).min(last_mesh),
            Shape::Impostor(_) => index,
        };
    }
    if levels.is_empty() {
        return Err(ChainError::Wanted(
            "no level would have fewer triangles than the tree has".to_owned(),
        ));
    }
    Ok(Chain { levels, notes })
}

fn is_no_less(level: &Made, before: Option<&Made>, all: usize) -> bool {
    match before {
        Some(before) => level.triangles() >= before.triangles(),
        // The first level may be the tree as it is.
        None => level.triangles() > all,
    }
}
