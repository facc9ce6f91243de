//! Plants without leaves: all that there is of them is wood.

use secateur_model::{BoundingSphere, Foliage, Lod, RemovalOrder};
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{OpenEngine, ViewSet};

use super::{Budget, Sharing, WholeLevel, WholePlant};
use crate::observe::observe;
use crate::passes::Passes;
use crate::stage::Observer;
use crate::wood::sides_apart;
use crate::{Error, Options, Shared, Simplified, Stopped, Views, Warning, sphere_of};

/// Width of the pictures in pixels, which show nothing.
const RESOLUTION: u32 = 1;

impl WholePlant<'_> {
    /// [`Self::level`] of a plant without leaves.
    pub(super) fn bare_level(
        &self,
        budget: Budget,
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let sphere = sphere_of(&self.wood)?;
        let mut leaves = simplified_nothing(sphere, options, engine)?;
        let lod = match (budget.sharing, &self.crowned) {
            (Sharing::Evenly, _) => self.levels.evenly(&self.wood, budget.triangles),
            (_, Some(crowned)) => {
                let alone = Options {
                    finer: None,
                    ..options.clone()
                };
                let (lod, level) = crowned.level(budget, &alone, engine, shared, observer)?;
                let warnings = level.leaves.warnings.into_iter();
                let of_wood = |warning: &Warning| matches!(warning, Warning::SupportsGone { .. });
                leaves.warnings.extend(warnings.filter(of_wood));
                Some(lod)
            }
            (_, None) => None,
        };
        let lod = match lod {
            Some(lod) => lod,
            None => {
                let mut wood = self.wood_of(&[], budget);
                self.use_rest(&mut wood, 0, budget.triangles);
                leaves.warnings.extend(self.warning_of(&wood));
                wood.lod
            }
        };
        let lod = sides_apart(&self.wood, lod);
        Ok(WholeLevel {
            leaves,
            wood_gone: Vec::new(),
            wood_triangles: lod.foliage(&self.wood).triangles().len(),
            wood: lod,
            leaf_gap: None,
        })
    }
}

/// What a run over no leaf at all hands back.
fn simplified_nothing(
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
