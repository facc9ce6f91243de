//! Chains of levels of detail of whole plants: which levels, and for which distances.

mod blend;
mod card_cutoffs;
mod cards;
mod charts;
mod cost;
mod error;
#[cfg(test)]
mod far_tests;
mod fitted_textures;
mod goals;
mod height_search;
mod impostor_ending;
mod impostors;
mod ladder;
mod leaf_texture;
mod level;
mod level_as_drawn;
mod level_choice;
mod level_report;
mod level_surfaces;
mod look;
mod maker;
mod memory;
#[cfg(test)]
mod nested_tests;
mod next_step;
mod options;
mod placed;
mod scene_look;
mod seen_from_nearer;
mod smaller_base_colors;
mod smaller_images;
mod stage_clock;
mod stands;
#[cfg(test)]
mod tests;
mod texture_bytes;
mod textures;
mod uncut_leaves;

use secateur_gltf::WholeTree;
use secateur_gltf::chain::MAX_LEVELS;
use secateur_model::Lod;
use secateur_raster::OpenEngine;
use secateur_simplify::{Observer, Progress, sphere_of};

use crate::morph::morph;
pub use blend::BlendBand;
use cards::CardSearch;
pub use charts::filled_charts;
pub use cost::{CostWeights, LevelParts};
pub use error::{BadOptions, ChainError};
use height_search::lightest;
pub use level::{Chain, ChainLevel, ImpostorLevel, Shape};
pub use level_as_drawn::LevelAsDrawn;
use level_choice::{asked, join_places};
pub use level_report::{ClearTexels, ImpostorReport, LevelKind, LevelReport};
pub use level_surfaces::show;
use maker::Maker;
pub use options::{ChainOptions, DISTANCES, HEIGHTS_PX, MOST_DIFFERENCE, Wanted};
pub use scene_look::SceneLook;
use stage_clock::ChainStage;
pub(crate) use texture_bytes::bytes_of;
pub use texture_bytes::texture_bytes;
pub use textures::Textures;

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
    let mut notes = maker.remarks()?;
    let mut cards = CardSearch::new(&maker);
    let (placed, far) = match &options.wanted {
        Wanted::Triangles(amounts) => {
            let placed = asked(&maker, amounts, &client, &mut notes, observer)?;
            (placed, Vec::new())
        }
        Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Distances(_) => {
            lightest(&maker, &mut cards, &client, &mut notes, observer)?
        }
    };
    Progress::Level { done: 1, of: 1 }.tell(observer)?;
    let clock = &maker.look.clock;
    let impostors = clock.time(ChainStage::Impostors, || {
        maker.impostors((&placed, far), &mut cards, &client, &mut notes, observer)
    })?;
    let mut levels = clock.time(ChainStage::Figures, || {
        maker.ending(placed, impostors, &client, &mut notes, observer)
    })?;
    notes.extend(maker.look.note_of_estimates(&levels));
    match (options.original, levels.len()) {
        (true, MAX_LEVELS) => {
            let most = format!("as a chain has at most {MAX_LEVELS} levels");
            let note = format!("the plant itself is left out, {most}; keep it before the first");
            notes.push(note.into());
        }
        (true, _) => levels.insert(0, maker.original()),
        (false, 0) => {
            return Err(ChainError::NoLighterLevel);
        }
        (false, _) => {}
    }
    if options.morph {
        set_morphs(tree, &mut levels);
    }
    let bands = levels.iter().skip(1);
    let bands: Vec<BlendBand> = bands
        .map(|next| BlendBand::before(next.distance, next.pixels_high))
        .collect();
    let is_picture = |level: &ChainLevel| matches!(level.shape, Shape::Impostor(_));
    let last_mesh = levels
        .iter()
        .rposition(|level| !is_picture(level))
        .unwrap_or(0);
    for (index, level) in levels.iter_mut().enumerate() {
        level.blend = bands.get(index).copied();
        let end_px = level.blend.map_or(0.0, |band| band.begin_px);
        level.screen_coverage = end_px / options.screen.height_px;
        // A picture casts the shadow of a picture.
        level.shadow = match is_picture(level) {
            true => index,
            false => (index + options.shadow_steps).min(last_mesh),
        };
    }
    Ok(Chain {
        levels,
        notes: join_places(notes),
        seconds: clock.seconds(),
    })
}

/// Says of each mesh before another where its vertices go on the way to that one.
fn set_morphs(tree: &WholeTree, levels: &mut [ChainLevel]) {
    let lod_of = |level: &ChainLevel| match &level.shape {
        Shape::Original(lod) | Shape::Mesh(lod) => Some(lod.clone()),
        Shape::Impostor(_) => None,
    };
    let lods: Vec<Option<Lod>> = levels.iter().map(lod_of).collect();
    for (level, pair) in levels.iter_mut().zip(lods.windows(2)) {
        if let [Some(lod), Some(next)] = pair {
            level.morph = Some(morph(tree, lod, next));
        }
    }
}
