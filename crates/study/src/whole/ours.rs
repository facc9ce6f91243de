//! Levels of whole plants by this program, with and without the wood.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use secateur_gltf::WholeTree;
use secateur_levels::{MaterialChange, choose_cutoffs};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{WholePlant, simplify_keeping_wood};
use secateur_simplify::{Error as SimplifyError, Options, Preset, Progress, Target};

use super::{PlantOutcome, WholeCase};
use crate::judge::{surfaces_of, with_material_changes};
use crate::shell;
use crate::{Error, Host};

/// The level; nothing if the wood that is kept has more triangles than may be left.
pub(super) fn made(
    tree: &WholeTree,
    path: &Path,
    case: WholeCase,
    level: f64,
    host: &dyn Host,
) -> Result<Option<PlantOutcome>, Error> {
    let options = Options {
        audit: false,
        memory: tree.items().memory_left(),
        ..Options::with_preset(Preset::default(), Target::triangle_share(level))
    };
    let (leaves, wood) = (tree.leaves(), tree.wood());
    let engine = OpenEngine::open(options.engine).map_err(SimplifyError::from)?;
    let mut observer = |_: Progress| match host.is_stop_asked() {
        false => ControlFlow::Continue(()),
        true => ControlFlow::Break(()),
    };
    host.forget_peak_rss();
    let begun = Instant::now();
    let made = match case {
        WholeCase::LeavesOnly => {
            simplify_keeping_wood(leaves, wood, &options, &engine, &mut observer)
        }
        WholeCase::Auto | WholeCase::Gltfpack => {
            WholePlant::new(tree.items().foliage(), leaves, wood, &engine)
                .and_then(|plant| plant.simplified(&options, &engine, &mut observer))
        }
    };
    let seconds = begun.elapsed().as_secs_f64();
    let peak_rss_bytes = host.peak_rss_bytes();
    let made = match made {
        Err(SimplifyError::BudgetBelowWood { .. }) => return Ok(None),
        made => made?,
    };
    let lod = tree.joined(&made.leaves.lod, &made.wood);
    let cutoffs = choose_cutoffs(tree.items(), &lod, MaterialChange::CutoffsOrMips)?;
    let cutoffs = with_material_changes(tree.items(), &lod, cutoffs)?;
    let [_, setting] = case.method_and_setting();
    Ok(Some(PlantOutcome {
        surfaces: surfaces_of(tree.items(), path, &lod, &cutoffs)?,
        leaves_final: made.leaves.lod.foliage(leaves).leaves().len() as u64,
        wood_triangles_final: Some(made.wood_triangles as u64),
        seconds,
        peak_rss_bytes,
        resolution: made.leaves.resolution,
        engine: made.leaves.engine.to_owned(),
        adapter: made.leaves.adapter.clone(),
        // A share has a point.
        command: format!(
            "secateur simplify {} -o out.glb --triangles {level:?} --no-audit --{setting}",
            shell::path(path)
        ),
    }))
}
