//! What views see of a plant, as texels in which filters find nothing wrong.

use std::borrow::Borrow;

use glam::Vec3;
use secateur_eval::{ParallelView, SeenTexel, seen_along};
use secateur_model::{Mips, Surface};

use super::coverage::{alpha_that_keeps_coverage, alpha_without_mips};
use crate::dilate::dilated;

/// Samples along a side of a cell, at least: finer cells have fewer a texel.
const SAMPLES: u32 = 384;

/// A rectangle of texels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The upper left one.
    pub(super) corner: [u32; 2],
    /// Width and height in texels.
    pub(super) size: [u32; 2],
}

/// One or more views of a plant, baked into texels.
pub(super) struct Cell {
    /// Width and height in texels.
    pub(super) size: [u32; 2],
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
    let size = [side; 2];
    let seen = seen_along(surfaces, view, size, samples);
    let corner = [0, 0];
    Cell::of_texels(seen, size, &[Place { corner, size }], Mips::Blended)
}

impl Cell {
    /// Of what is seen in texels, powers of two of them on each side, for a sampler that reads these mips; each of the
    /// pictures in it keeps its own coverage.
    pub(super) fn of_texels(
        seen: Vec<SeenTexel>,
        size: [u32; 2],
        pictures: &[Place],
        mips: Mips,
    ) -> Self {
        let coverage: Vec<f32> = seen.iter().map(|texel| texel.coverage).collect();
        let alphas = match mips {
            Mips::None => alpha_without_mips(&coverage, size, pictures),
            Mips::Nearest | Mips::Blended => alpha_that_keeps_coverage(&coverage, size, pictures),
        };
        let weighted = |t: SeenTexel| ([t.color * t.coverage, t.normal * t.coverage], t.coverage);
        let filled = dilated(
            seen.into_iter().map(weighted).collect(),
            size.map(|side| side as usize),
            [Vec3::ZERO, Vec3::Z],
        );
        Self {
            size,
            colors: filled.iter().map(|[color, _]| *color).collect(),
            normals: filled
                .iter()
                .map(|[_, normal]| normal.normalize_or(Vec3::Z))
                .collect(),
            alphas,
        }
    }
}
