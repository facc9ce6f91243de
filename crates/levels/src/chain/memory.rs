//! What levels take of the memory beside the runs over leaves, reckoned before it is taken.

use secateur_gltf::WholeTree;
use secateur_model::{Budget, OverMemory, Remedy};
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Error, check_run, take_plant};

use super::options::{ChainOptions, Wanted};

/// The most triangles that all kept levels of a search have together, as a multiple of the plant's triangles.
const MOST_KEPT: usize = 2;

/// As many triangles are kept of any plant, 20 MB as they are drawn: a search comes back to levels of small plants, and
/// made one of `base.glb` seven times.
const ALWAYS_KEPT: usize = 100_000;

/// The most triangles that all kept levels of a search have together; `plant_triangles` are those of the plant.
pub(super) fn most_kept(plant_triangles: usize) -> usize {
    (MOST_KEPT * plant_triangles).max(ALWAYS_KEPT)
}

/// What a triangle of a level that is kept takes, as it is drawn.
const BYTES_A_DRAWN_TRIANGLE: u64 = 200;

/// What a pixel takes of the pictures in which levels are judged, those that are kept and those of the level
/// (`tests/peak_memory`: 640 MiB with six views of 1,024 pixels).
const BYTES_A_PICTURE_PIXEL: f64 = 107.0;

/// From how many views a level is judged.
const VIEWS: f64 = 6.0;

/// Pictures are no larger, in pixels.
const MOST_SIDE_PX: f64 = 1024.0;

/// Takes what making and judging levels of a plant needs, if a run over its leaves fits in what that leaves: else minutes
/// would pass before it is refused. The error is about all of it together.
pub(super) fn take_levels(
    budget: &mut Budget,
    tree: &WholeTree,
    options: &ChainOptions,
) -> Result<(), Error> {
    let allowed = budget.left();
    let fits = take_all(budget, tree, options)
        .and_then(|()| check_run(budget, tree.leaves(), &options.leaves));
    fits.map_err(|over| {
        let [leaves, wood] = [tree.leaves().leaves().len(), tree.wood().triangles().len()];
        let taken = allowed - over.left;
        Error::from(OverMemory {
            what: format!("levels of {leaves} leaves and {wood} triangles of wood"),
            bytes: taken.saturating_add(over.bytes),
            left: allowed,
            remedy: over.remedy,
        })
    })
}

fn take_all(
    budget: &mut Budget,
    tree: &WholeTree,
    options: &ChainOptions,
) -> Result<(), OverMemory> {
    let (leaves, wood) = (tree.leaves(), tree.wood());
    if options.wood != WoodMode::Keep {
        take_plant(budget, leaves, wood)?;
    }
    let highest_px = match &options.wanted {
        Wanted::Triangles(_) => options.screen.height_px,
        Wanted::UsualHeights | Wanted::Heights(_) => {
            options.heights_px().first().copied().unwrap_or_default()
        }
        Wanted::Distances(_) => MOST_SIDE_PX,
    };
    let side_px = highest_px.min(MOST_SIDE_PX);
    let pictures = (BYTES_A_PICTURE_PIXEL * VIEWS * side_px * side_px) as u64;
    let what = || format!("pictures of {side_px} pixels a side, to judge levels by,");
    budget.take(pictures, what, Remedy::FewerPixels)?;
    if let Wanted::Triangles(_) = options.wanted {
        return Ok(());
    }
    let triangles = most_kept(leaves.triangles().len() + wood.triangles().len());
    let bytes = BYTES_A_DRAWN_TRIANGLE * triangles as u64;
    let what = || format!("levels that are tried, of {triangles} triangles together,");
    budget.take(bytes, what, Remedy::FewerPixels)
}
