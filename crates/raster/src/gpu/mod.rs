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
pub use tiles::{TILE_PX, split_into_tiles};
pub use wgpu;

impl Rasteriser for Device {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        Ok(fragments(self, scene)?)
    }

    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        match self::fragments::fragments_within(self, scene, most) {
            Err(GpuError::TooManyFragments(too_many)) => Err(too_many.into()),
            other => Ok(other?),
        }
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        Ok(areas(self, scene)?)
    }
}
