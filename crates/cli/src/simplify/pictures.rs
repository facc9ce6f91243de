//! Pictures beside the result of `secateur simplify`.

use std::path::Path;

use secateur::{
    Foliage, LevelParts, Lod, Options, Plant, PreparedLod, Simplified, StagedFiles, Stopped,
    WoodMode,
};
use secateur_raster::Scene;

use super::super::args;
use super::super::failure::Failure;
use super::super::picture::{self, Exhibit};
use super::super::summary::{grouped, share};

/// The bytes of the picture of the original and the result.
pub(super) fn picture_of(
    prepared: &PreparedLod,
    args: &args::Simplify,
    plant: &Plant,
    level: &LevelParts,
) -> Result<Vec<u8>, Failure> {
    let selectors = &args.foliage.foliage;
    let after = prepared.document()?;
    let leaves = plant.leaves();
    let left = level.simplified.lod.foliage(leaves);
    // Triangles are those that the target counts.
    let counts = |foliage: &Foliage, wood_triangles: u64| {
        let wood = match plant.wood_mode() {
            WoodMode::Ignore => 0,
            _ => wood_triangles as usize,
        };
        [foliage.leaves().len(), foliage.triangles().len() + wood]
    };
    let before = counts(leaves, plant.wood_triangle_count());
    let now = counts(&left, level.wood_triangles);
    let in_words = |counts: [usize; 2]| {
        let [leaves, triangles] = counts.map(|n| grouped(n as u64));
        format!("{leaves} leaves, {triangles} triangles")
    };
    let exhibits = [
        Exhibit {
            title: "original".to_owned(),
            subtitle: in_words(before),
            surfaces: picture::surfaces(plant.tree().document(), selectors)?,
        },
        Exhibit {
            title: match level.simplified.stopped {
                Stopped::AtTriangles => share(now[1] as u64, before[1] as u64),
                Stopped::AtLeafCount | Stopped::AtMaxError => {
                    share(now[0] as u64, before[0] as u64)
                }
            },
            subtitle: in_words(now),
            // No leaf may be left to select.
            surfaces: picture::surfaces(&after, &[])?,
        },
    ];
    picture::sheet(&exhibits)
}

/// Stages what the views see before and after.
pub(super) fn stage_debug_images(
    staged: &mut StagedFiles,
    folder: &Path,
    options: &Options,
    plant: &Plant,
    result: &Simplified,
) -> Result<(), Failure> {
    let foliage = secateur::as_seen(plant.leaves(), options.alpha, options.sides);
    let original = Lod::original(foliage.leaves().len());
    for (name, lod) in [("before", &original), ("after", &result.lod)] {
        let scene = Scene {
            foliage: &foliage,
            lod,
            views: &result.views,
            resolution: result.resolution,
        };
        picture::stage_leaf_ids(staged, plant.tree().document(), folder, name, &scene)?;
    }
    Ok(())
}
