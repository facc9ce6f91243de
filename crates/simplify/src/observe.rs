//! What views show of a LOD.

use secateur_model::{Foliage, Lod};
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, Rasteriser, Scene, ViewSet};

use crate::Error;

/// Draws a LOD of a foliage in all views and counts.
///
/// The areas have a row for each original leaf, or, where the LOD has leaves of its own, for each
/// leaf of [`Lod::foliage`].
///
/// # Errors
/// [`Error::Gpu`] if the rasteriser fails.
///
/// # Panics
/// If the resolution is out of range, or the LOD is one of another foliage.
pub fn observe(
    foliage: &Foliage,
    lod: &Lod,
    views: &ViewSet,
    resolution: u32,
    rasteriser: &dyn Rasteriser,
) -> Result<AreaTable, Error> {
    let draw = |foliage: &Foliage, lod: &Lod| {
        let scene = Scene {
            foliage,
            lod,
            views,
            resolution,
        };
        Ok(rasteriser.areas(&scene)?)
    };
    if lod.is_of_originals() {
        return draw(foliage, lod);
    }
    let left = lod.foliage(foliage);
    draw(&left, &Lod::original(left.leaves().len()))
}

/// For each leaf the pixels that show it, summed over all views; `resolution` is the width and height of a view.
///
/// # Errors
/// As [`observe`].
pub(crate) fn seen_px(
    foliage: &Foliage,
    views: &ViewSet,
    resolution: u32,
    rasteriser: &dyn Rasteriser,
) -> Result<Vec<f64>, Error> {
    let count = foliage.leaves().len();
    let areas = observe(
        foliage,
        &Lod::original(count),
        views,
        resolution,
        rasteriser,
    )?;
    let mut seen_px = vec![0.0; count];
    for row in areas.rows() {
        for (sum, area_px) in seen_px.iter_mut().zip(&row[1..]) {
            *sum += f64::from(*area_px);
        }
    }
    Ok(seen_px)
}

/// What views show of a LOD, and of the foliage that it is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The views from which both were looked at.
    pub views: ViewSet,
    /// Areas of the LOD's leaves in those views, in pixels: see [`observe`].
    pub areas: AreaTable,
    /// VMI of the original foliage in those views.
    pub vmi_original: Vmi,
    /// VMI of the LOD in those views.
    pub vmi: Vmi,
}

impl Shown {
    /// VMI error of the LOD in these views, in per cent.
    pub fn error_percent(&self) -> f64 {
        self.vmi_original.error_percent(&self.vmi)
    }
}
