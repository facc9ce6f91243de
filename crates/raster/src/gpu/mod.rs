//! The twins that run on a GPU, through wgpu; they give the same bits as
//! [`cpu`](crate::cpu).
//!
//! Open a [`Device`] once, then call [`fragments`], [`areas`] or [`leaf_ids`]
//! with it as often as needed. Snapping stays on the CPU; the shaders see only
//! integers of 32 bits, on which every driver agrees. Scenes larger than the
//! adapter's bindings are worked on in chunks of views, and views with more
//! fragments than fit in windows of pixels, so only a single view, cut-out
//! collection or pixel can be too large.
//!
//! Each shader of `shaders/` opens with how invocations map to its data.

mod chunk;
mod cutouts;
mod device;
mod draw;
mod error;
mod fragments;
mod lists;
mod long_lists;
mod memory;
mod pieces;
mod stages;
mod tiles;

use crate::{AreaTable, Fragments, RasterError, Rasteriser, Scene};

pub use device::{Device, Preference};
pub use draw::{areas, leaf_ids};
pub use error::GpuError;
pub use fragments::{fragments, fragments_and_areas};
use fragments::{fragments_and_areas_within, fragments_within};
pub use tiles::{TILE_PX, split_into_tiles};
pub use wgpu;

/// Too many fragments are no failure of the device, and known by their own type.
fn raster_error(error: GpuError) -> RasterError {
    match error {
        GpuError::TooManyFragments(too_many) => too_many.into(),
        other => other.into(),
    }
}

impl Rasteriser for Device {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        Ok(fragments(self, scene)?)
    }

    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        fragments_within(self, scene, most).map_err(raster_error)
    }

    fn fragments_and_areas_within(
        &self,
        scene: &Scene<'_>,
        most: u64,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        fragments_and_areas_within(self, scene, most).map_err(raster_error)
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        Ok(areas(self, scene)?)
    }

    fn is_gpu(&self) -> bool {
        true
    }
}
