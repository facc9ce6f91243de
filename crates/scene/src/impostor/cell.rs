//! A square of an atlas: what one view sees of a plant, such that filters find nothing wrong in it.

use std::borrow::Borrow;

use glam::Vec3;
use secateur_eval::{ParallelView, SeenTexel, seen_along};
use secateur_model::Surface;

use super::coverage::alpha_that_keeps_coverage;
use crate::dilate::dilated;

/// Samples along a side of a cell, at least: finer cells have fewer a texel.
const SAMPLES: u32 = 384;

/// One view of a plant, baked into texels.
pub(super) struct Cell {
    /// Width and height in texels.
    pub(super) side: u32,
    /// Linear; where nothing is seen, that of what is near.
    pub(super) colors: Vec<Vec3>,
    /// Along right, up and toward the eye, unit.
    pub(super) normals: Vec<Vec3>,
    pub(super) alphas: Vec<u8>,
}

/// Bakes what a view sees of surfaces into a cell, a power of two of texels a side.
pub(super) fn bake<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    view: &ParallelView,
    side: u32,
) -> Cell {
    let samples = (SAMPLES / side.max(1)).clamp(2, 4);
    let seen = seen_along(surfaces, view, [side, side], samples);
    let coverage: Vec<f32> = seen.iter().map(|texel| texel.coverage).collect();
    let weighted = |t: &SeenTexel| ([t.color * t.coverage, t.normal * t.coverage], t.coverage);
    let size = [side as usize; 2];
    let filled = dilated(
        seen.iter().map(weighted).collect(),
        size,
        [Vec3::ZERO, Vec3::Z],
    );
    Cell {
        side,
        colors: filled.iter().map(|[color, _]| *color).collect(),
        normals: filled
            .iter()
            .map(|[_, normal]| normal.normalize_or(Vec3::Z))
            .collect(),
        alphas: alpha_that_keeps_coverage(&coverage, side as usize),
    }
}
