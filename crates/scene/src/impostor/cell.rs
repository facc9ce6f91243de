//! A square of an atlas: what one view sees of a plant, such that filters find nothing wrong in it.

use std::borrow::Borrow;

use glam::Vec3;
use secateur_eval::{ParallelView, SeenTexel, seen_along};
use secateur_model::Surface;

use super::coverage::alpha_that_keeps_coverage;

/// Samples along a side of a cell, at least: finer cells have fewer a texel.
const SAMPLES: u32 = 384;

/// A baked view.
pub(super) struct Cell {
    /// Texels a side.
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
    let filled = filled(&seen, side as usize);
    Cell {
        side,
        colors: filled.iter().map(|(color, _)| *color).collect(),
        normals: filled
            .iter()
            .map(|(_, normal)| normal.normalize_or(Vec3::Z))
            .collect(),
        alphas: alpha_that_keeps_coverage(&coverage, side as usize),
    }
}

/// Colours and normals, and where there is nothing those of the smallest mip texel above that has
/// any, weighted by coverage: mips and blends then mix in nothing dark (pull and push; Gortler et
/// al., The Lumigraph, 1996).
fn filled(seen: &[SeenTexel], side: usize) -> Vec<(Vec3, Vec3)> {
    struct Mip {
        side: usize,
        sums: Vec<(Vec3, Vec3, f32)>,
    }
    let weighted = |t: &SeenTexel| (t.color * t.coverage, t.normal * t.coverage, t.coverage);
    let mut mips = vec![Mip {
        side,
        sums: seen.iter().map(weighted).collect(),
    }];
    while let Some(finer) = mips.last().filter(|mip| mip.side > 1) {
        let side = finer.side / 2;
        let sum = |at: usize| {
            let first = 2 * (at / side) * finer.side + 2 * (at % side);
            let four = [first, first + 1, first + finer.side, first + finer.side + 1];
            four.iter().fold((Vec3::ZERO, Vec3::ZERO, 0.0), |sum, &k| {
                let (color, normal, weight) = finer.sums[k];
                (sum.0 + color, sum.1 + normal, sum.2 + weight)
            })
        };
        let sums = (0..side * side).map(sum).collect();
        mips.push(Mip { side, sums });
    }
    let mut above: Vec<(Vec3, Vec3)> = vec![(Vec3::ZERO, Vec3::Z)];
    for mip in mips.iter().rev() {
        let of_texel = |at: usize| {
            let (color, normal, weight) = mip.sums[at];
            match weight > 0.0 {
                true => (color / weight, normal / weight),
                false => {
                    let (x, y) = (at % mip.side / 2, at / mip.side / 2);
                    above[(y * (mip.side / 2) + x).min(above.len() - 1)]
                }
            }
        };
        above = (0..mip.side * mip.side).map(of_texel).collect();
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_texels_have_the_colours_of_what_is_near() {
        let mut seen = vec![SeenTexel::default(); 64];
        let red = Vec3::X;
        for (at, texel) in seen.iter_mut().enumerate() {
            if at % 8 < 2 {
                let color = if at < 32 { red } else { Vec3::Y };
                *texel = SeenTexel {
                    coverage: 0.5,
                    color,
                    normal: Vec3::Z,
                };
            }
        }
        let filled = filled(&seen, 8);
        // The right half is as near to one as to the other.
        for (at, (color, normal)) in filled.iter().enumerate().filter(|(at, _)| at % 8 < 4) {
            let expected = if at < 32 { red } else { Vec3::Y };
            assert!(color.distance(expected) < 1e-6, "texel {at}: {color}");
            assert!(normal.distance(Vec3::Z) < 1e-6);
        }
    }

    #[test]
    fn nothing_at_all_is_black_and_faces_the_eye() {
        let filled = filled(&[SeenTexel::default(); 4], 2);
        assert_eq!(filled, [(Vec3::ZERO, Vec3::Z); 4]);
    }
}
