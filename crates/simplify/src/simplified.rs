//! What a run hands back.

use secateur_model::{BoundingSphere, Lod};
use secateur_raster::measure::vmi::{ScaledBits, Vmi};
use secateur_raster::{AreaTable, ViewSet};

use crate::passes::Passes;
use crate::stage::Stage;
use crate::warning::Warning;
use crate::{Options, Views};

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The asked number of leaves is left.
    AtLeafCount,
    /// The asked number of triangles is left, or fewer.
    AtTriangles,
    /// One more step would exceed the asked error.
    AtMaxError,
}

impl Stopped {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::AtLeafCount => "leaf count",
            Self::AtTriangles => "triangles",
            Self::AtMaxError => "max error",
        }
    }
}

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// What each pass did.
    pub passes: Passes,
    /// The leaves that are left, and how large.
    pub lod: Lod,
    /// Cost of each step of the removal order; empty for methods without such costs. Steps at its end
    /// without one took leaves away that would hang in the air.
    pub costs: Vec<ScaledBits>,
    /// Why the run ended.
    pub stopped: Stopped,
    /// The views of the last step.
    pub views: ViewSet,
    /// What [`Options::views`](crate::Options::views) stood for.
    pub driven_by: Views,
    /// Why these views, in words, where the run decided.
    pub views_reason: Option<String>,
    /// Areas of the leaves that are left in those views, in pixels. A row for
    /// each original leaf, or, where leaves were made, for each of
    /// [`Lod::foliage`]. Nothing without [`Options::shows_what_is_left`](crate::Options::shows_what_is_left).
    pub areas: Option<AreaTable>,
    /// VMI of the original foliage in those views.
    pub vmi_original: Vmi,
    /// VMI of what is left in those views; nothing where there are no areas.
    pub vmi_final: Option<Vmi>,
    /// Width and height of the images in pixels.
    pub resolution: u32,
    /// Why that resolution, in words.
    pub resolution_reason: String,
    /// Where the images were drawn: `gpu` or `cpu`.
    pub engine: &'static str,
    /// The GPU and its driver.
    pub adapter: Option<String>,
    /// What the result was audited against, if it was.
    pub audited_by: Option<&'static str>,
    /// Stages and how long they took.
    pub seconds: Vec<(Stage, f64)>,
    /// What is not as one might expect.
    pub warnings: Vec<Warning>,
}

impl Simplified {
    /// All sets of views that a run of these options, which this came of, looked from, about a foliage with this
    /// bounding sphere.
    pub fn driving(&self, options: &Options, sphere: BoundingSphere) -> Vec<ViewSet> {
        let driven = Options {
            views: self.driven_by.clone(),
            ..options.clone()
        };
        driven.driving(sphere)
    }

    /// VMI error against the original foliage on the driving views, in per cent; nothing where there
    /// are no areas.
    pub fn driving_error_percent(&self) -> Option<f64> {
        let vmi_final = self.vmi_final.as_ref()?;
        Some(self.vmi_original.error_percent(vmi_final))
    }
}
