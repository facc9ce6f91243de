//! Chains of levels of detail of whole plants: which levels, and for which distances.

mod card_cutoffs;
mod cards;
mod ending;
mod error;
mod fitted_textures;
mod impostors;
mod ladder;
mod leaf_texture;
mod level;
mod level_as_drawn;
mod level_surfaces;
mod look;
mod maker;
mod nearer;
mod opaque;
mod options;
mod scene_look;
#[cfg(test)]
mod tests;
mod texture_bytes;
mod textures;
mod which;

use secateur_gltf::WholeTree;
use secateur_raster::OpenEngine;
use secateur_simplify::{Observer, sphere_of};

pub use error::ChainError;
pub use level::{Chain, ChainLevel, ImpostorLevel, Shape};
pub use level_as_drawn::LevelAsDrawn;
pub use level_surfaces::show;
use maker::Maker;
pub use options::{
    ChainOptions, DISTANCES, HEIGHTS_PX, MAX_FLIP, MAX_LEVELS, SCREEN_HEIGHTS_PX, Wanted,
};
pub use scene_look::SceneLook;
pub use textures::Textures;
use which::{asked, lightest, spread};

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
    // Cameras stand around all of it, whatever becomes of the wood.
    sphere_of(tree.items().foliage())?;
    let maker = Maker::new(tree, options, engine)?;
    let client = maker.client();
    let mut notes = Vec::new();
    let made = match &options.wanted {
        Wanted::Triangles(amounts) => asked(&maker, amounts, &mut notes, observer)?,
        Wanted::Heights(_) => spread(&maker, &mut notes, observer)?,
        Wanted::Distances(_) => lightest(&maker, &mut notes, observer)?,
    };
    let impostors = maker.impostors(&made, &client, &mut notes, observer)?;
    let levels = maker.ending(made, impostors, &client, &mut notes, observer)?;
    let mut levels = maker.with_textures(levels, &client, observer)?;
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
