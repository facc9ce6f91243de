//! How far a simplified tree is from its original, and what it looks like
//! beside it.
//!
//! - [`measure`](measure()): original against simplified foliage, a value for
//!   each of [`METRICS`](measure::METRICS).
//! - [`pictures`]: the same for what the trees look like, a value for each of
//!   [`PICTURE_METRICS`](pictures::PICTURE_METRICS).
//! - [`measure_as_drawn`]: the same for what a client draws, with mip maps and one sample a pixel.
//! - [`render`]: textured triangles to a picture, on the CPU.
//! - [`framing`]: a [`Camera`] that takes in a whole tree, to be shared by all
//!   panels of a sheet.
//! - [`StandPicture`]: what a camera sees of many plants of a few kinds; [`JudgedStand`] compares two of them.
//! - [`seen_along`]: colour, coverage and normals along parallel rays, which impostors are baked
//!   from.
//! - [`contact_sheet`]: pictures side by side, with captions.
//!
//! Nothing here knows how a tree was simplified: only geometry and images.

#![forbid(unsafe_code)]

mod as_drawn;
mod as_drawn_coverage;
mod averaged;
mod camera;
mod caption;
mod contact_sheet;
mod cut_mask;
mod difference;
mod flip;
mod lens;
mod light_depth;
pub mod measure;
mod mips;
mod outlines;
mod over_frames;
mod parallel;
pub mod pictures;
mod point_in_triangle;
mod render;
#[cfg(feature = "cli")]
mod schema;
mod screen_triangle;
mod shading;
mod srgb;
mod stand;
mod strengths;
mod surface_references;
mod texel;
mod truth;
mod visibility;

pub use as_drawn::{AsDrawn, AsDrawnMeasurement, OriginalAsDrawn, measure_as_drawn};
pub use as_drawn_coverage::{AsDrawnCoverage, Shown};
pub use camera::{Camera, framing};
pub use contact_sheet::{Panel, contact_sheet};
pub use difference::{Difference, DifferenceJudge, Enlargement, Limits, ViewCount};
pub use measure::{
    Judging, JudgingViews, MeasureError, Measurement, Original, RigMeasurement, measure,
    measure_lod,
};
pub use mips::MipMaps;
pub use outlines::Outlines;
pub use over_frames::OverFrames;
pub use parallel::{ParallelView, SeenTexel, seen_along};
pub use pictures::{PictureMeasurement, PictureRigMeasurement, Pictures};
pub use render::{RenderOptions, render};
pub use srgb::{LINEAR_FROM_SRGB, srgb_byte};
pub use stand::{JudgedStand, StandCamera, StandDifference, StandKind, StandPicture, StandPlace};
pub use strengths::Strengths;
pub use texel::{FourTexels, color_of, sample_alpha};
