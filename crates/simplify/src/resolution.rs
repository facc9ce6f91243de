//! Stub.
use secateur_model::Foliage;
use secateur_raster::{Rasteriser, ViewSet};

use crate::vds::VdsError;

/// Stub.
pub struct ChosenResolution {
    /// Stub.
    pub resolution: u32,
    /// Stub.
    pub visible_leaves: usize,
    /// Stub.
    pub at_most_a_pixel: usize,
    /// Stub.
    pub reason: String,
}

/// Stub.
pub fn choose(_: &Foliage, _: &ViewSet, _: &dyn Rasteriser) -> Result<ChosenResolution, VdsError> {
    Ok(ChosenResolution {
        resolution: 256,
        visible_leaves: 0,
        at_most_a_pixel: 0,
        reason: "the leaves need no more".to_owned(),
    })
}
