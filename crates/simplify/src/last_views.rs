//! What the views of a run's last step show, as far as anyone asks.

use secateur_model::{Foliage, Lod};
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, Rasteriser, ViewSet};

use crate::fit::Objective;
use crate::observe::{Shown, observe};
use crate::{Error, Options, Target};

/// What the views of the last step show.
pub(crate) struct LastLook {
    pub(crate) views: ViewSet,
    pub(crate) vmi_original: Vmi,
    /// Areas and VMI of what is left, where that is looked at.
    pub(crate) left: Option<(AreaTable, Vmi)>,
}

impl LastLook {
    /// VMI error of what is left in these views, in per cent.
    pub(crate) fn error_percent(&self) -> Option<f64> {
        let (_, vmi) = self.left.as_ref()?;
        Some(self.vmi_original.error_percent(vmi))
    }

    /// Whether no leaf of the original is seen in these views.
    pub(crate) fn shows_nothing(
        &self,
        original: &Foliage,
        resolution: u32,
        rasteriser: &dyn Rasteriser,
    ) -> Result<bool, Error> {
        // Where nothing is seen there is no information: else nothing needs to be drawn for it.
        if self.vmi_original.scaled().iter().any(|bits| *bits != 0) {
            return Ok(false);
        }
        let all = Lod::original(original.leaves().len());
        let areas = observe(original, &all, &self.views, resolution, rasteriser)?;
        let shows_none = |row: &[u32]| row[1..].iter().all(|area_px| *area_px == 0);
        Ok(areas.rows().all(shows_none))
    }
}

impl From<Shown> for LastLook {
    fn from(shown: Shown) -> Self {
        Self {
            views: shown.views,
            vmi_original: shown.vmi_original,
            left: Some((shown.areas, shown.vmi)),
        }
    }
}

/// Whether anyone asks what the views show of what is left: the caller, an audit, or passes that keep to
/// an error.
pub(crate) fn is_left_looked_at(options: &Options, target: Target) -> bool {
    let is_information = |of: Objective| matches!(of, Objective::Information { .. });
    options.shows_what_is_left
        || options.audit
        || matches!(target, Target::MaxErrorPercent(_))
        || options.objective().is_some_and(is_information)
}
