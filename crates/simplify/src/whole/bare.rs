//! Plants without leaves: all that there is of them is wood.

use secateur_model::{BoundingSphere, Foliage, Lod, RemovalOrder};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{OpenEngine, ViewSet};

use crate::observe::observe;
use crate::passes::Passes;
use crate::{Error, Options, Simplified, Stopped, Views};

/// Width of the pictures in pixels, which show nothing.
const RESOLUTION: u32 = 1;

/// What a run over no leaf at all hands back.
pub(super) fn simplified_nothing(
    sphere: BoundingSphere,
    options: &Options,
    engine: &OpenEngine,
) -> Result<Simplified, Error> {
    let views = ViewSet::dodecahedron(sphere);
    let nothing = Foliage::default();
    let areas = observe(&nothing, &Lod::original(0), &views, RESOLUTION, engine)?;
    let vmi = Vmi::of(&areas, &LgTable::new());
    let passes = Passes {
        coarse: None,
        order: RemovalOrder::new(0),
        needles: Vec::new(),
        sizes: None,
    };
    Ok(Simplified {
        lod: passes.lod(),
        passes,
        costs: Vec::new(),
        stopped: Stopped::AtTriangles,
        views,
        driven_by: Views::Dodecahedron,
        views_reason: None,
        vmi_final: options.shows_what_is_left.then(|| vmi.clone()),
        areas: options.shows_what_is_left.then_some(areas),
        vmi_original: vmi,
        resolution: RESOLUTION,
        resolution_reason: "there are no leaves".to_owned(),
        engine: engine.name(),
        adapter: engine.adapter(),
        audited_by: None,
        seconds: Vec::new(),
        warnings: Vec::new(),
    })
}
