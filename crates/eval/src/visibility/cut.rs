//! The alpha test of a triangle.

use std::ops::Range;

use glam::{Vec2, Vec4};
use secateur_model::{AlphaMode, Material, Surface};

use super::{BLOCK, lanes_of, weighted};
use crate::cut_mask::CutMask;
use crate::mips::MipSampler;
use crate::point_in_triangle::{
    PointInTriangle, face_weights, four_divisors, four_face_weights, uv_steps,
};
use crate::screen_triangle::ScreenTriangle;
use crate::texel::{alpha_cutoff, sample_alpha};

/// The alpha test of one triangle, if it has one.
pub(crate) struct Cut<'a>(Option<CutFace<'a>>);

/// From what the alpha of one surface is read.
#[derive(Clone, Copy, Default)]
pub(crate) struct Alpha<'a> {
    pub(crate) mips: Option<MipSampler<'a>>,
    pub(crate) mask: Option<&'a CutMask>,
}

struct CutFace<'a> {
    material: &'a Material,
    alpha: Alpha<'a>,
    cutoff: f32,
    uvs: [Vec2; 3],
    alphas: [f32; 3],
}

impl<'a> Cut<'a> {
    pub(crate) fn of(triangle: &ScreenTriangle, surface: &'a Surface, alpha: Alpha<'a>) -> Self {
        let corners = surface.triangles[triangle.face.triangle as usize].map(|c| c as usize);
        let material = &*surface.material;
        // A client that blends shows the mean alpha of its mip maps: as much as there is without them.
        let alpha = match material.alpha_mode {
            AlphaMode::Blend => Alpha {
                mips: None,
                ..alpha
            },
            AlphaMode::Opaque | AlphaMode::Mask(_) => alpha,
        };
        Self(
            alpha_cutoff(material).map(|cutoff| CutFace {
                material,
                alpha,
                cutoff,
                uvs: corners.map(|c| surface.uvs.get(c).copied().unwrap_or_default()),
                alphas: corners
                    .map(|c| material.base_color[3] * surface.colors.get(c).map_or(1.0, |c| c.w)),
            }),
        )
    }

    /// Of the `sought` among samples of a row, from a place on, those at which the face is there: a bit each.
    pub(super) fn there(
        &self,
        triangle: &ScreenTriangle,
        place: &PointInTriangle,
        first: Vec2,
        weights: &[[Vec4; 3]; BLOCK / 4],
        sought: u32,
    ) -> u32 {
        let Some(face) = &self.0 else {
            return sought;
        };
        let mask = face.alpha.mask.filter(|_| face.alpha.mips.is_none());
        let mut there = 0;
        for (half, weights) in weights.iter().enumerate() {
            let bits = sought >> (4 * half) & 0b1111;
            if bits == 0 {
                continue;
            }
            let weights = four_face_weights(triangle, *weights);
            let uvs = face.four_uvs(weights);
            let texels = mask.and_then(|mask| mask.four_texels(uvs, face.alphas));
            let [us, vs] = uvs.map(|four| four.to_array());
            for lane in lanes_of(bits) {
                let uv = Vec2::new(us[lane], vs[lane]);
                let known = match (mask, texels) {
                    (Some(mask), Some(texels)) => mask.of_texel(texels[lane] as usize),
                    (Some(mask), None) => mask.passes(uv, face.alphas),
                    (None, _) => None,
                };
                let is_there = known.unwrap_or_else(|| {
                    let at = Vec2::new(first.x + (4 * half + lane) as f32, first.y);
                    let weights = weights.map(|of_corner| of_corner.to_array()[lane]);
                    face.alpha_at(triangle, place, (at, uv), weights) >= face.cutoff
                });
                there |= u32::from(is_there) << (4 * half + lane);
            }
        }
        there
    }

    /// Whether the face is there at all samples of a block, or at none; nothing where that differs, or takes a look at
    /// each.
    pub(super) fn there_in_block(
        &self,
        triangle: &ScreenTriangle,
        place: &PointInTriangle,
        columns: &Range<usize>,
        rows: &Range<usize>,
    ) -> Option<bool> {
        /// More than texture coordinates are rounded by, as a share of the numbers that they are made of.
        const ROUNDING: f32 = 1e-5;
        /// The least divisor for which that holds, as a share of the largest.
        const LEAST_DIVISOR: f32 = 0.5;
        let face = self.0.as_ref()?;
        let mask = face.alpha.mask.filter(|_| face.alpha.mips.is_none())?;
        let (weights, size) = place.outermost(columns, rows);
        let divisors = four_divisors(triangle, weights);
        let inverse_ws = triangle.corners.iter().map(|corner| corner.inverse_w);
        let largest = inverse_ws.fold(0.0, f32::max);
        let uvs = face.uvs.iter().map(|uv| uv.abs().max_element());
        let off = ROUNDING * size * uvs.fold(0.0, f32::max);
        // By half a texel less than a mask looks at on either side.
        let is_exact = off * mask.most_texels() <= 0.5;
        if !(is_exact && divisors.min_element() >= LEAST_DIVISOR * largest) {
            return None;
        }
        // With a positive divisor the outermost of what is divided by it is at the outermost places.
        let uvs = face.four_uvs(four_face_weights(triangle, weights));
        let low = Vec2::new(uvs[0].min_element(), uvs[1].min_element());
        let high = Vec2::new(uvs[0].max_element(), uvs[1].max_element());
        mask.passes_between(low, high, face.alphas)
    }

    /// The ratio of alpha to its cutoff; infinite where there is none, or it is 0.
    pub(crate) fn strength(
        &self,
        triangle: &ScreenTriangle,
        place: &PointInTriangle,
        at: Vec2,
        weights: [f32; 3],
    ) -> f32 {
        match &self.0 {
            Some(face) if face.cutoff > 0.0 => {
                let weights = face_weights(triangle, weights);
                let uv = face.uv(weights);
                face.alpha_at(triangle, place, (at, uv), weights) / face.cutoff
            }
            _ => f32::INFINITY,
        }
    }
}

impl CutFace<'_> {
    fn uv(&self, weights: [f32; 3]) -> Vec2 {
        self.uvs[0] * weights[0] + self.uvs[1] * weights[1] + self.uvs[2] * weights[2]
    }

    /// As [`Self::uv`], of four samples.
    fn four_uvs(&self, weights: [Vec4; 3]) -> [Vec4; 2] {
        let of = |uv: fn(&Vec2) -> f32| {
            let [a, b, c] = self.uvs.each_ref().map(uv);
            weights[0] * a + weights[1] * b + weights[2] * c
        };
        [of(|uv| uv.x), of(|uv| uv.y)]
    }

    /// Alpha where the face has these weights, the material's and the vertices' included.
    fn alpha_at(
        &self,
        triangle: &ScreenTriangle,
        place: &PointInTriangle,
        (at, uv): (Vec2, Vec2),
        weights: [f32; 3],
    ) -> f32 {
        let alpha = match self.alpha.mips {
            Some(mips) => mips.sample_alpha(uv, uv_steps(triangle, place, at, self.uvs)),
            None => sample_alpha(self.material.texture.as_deref(), uv),
        };
        alpha * weighted(self.alphas, weights)
    }
}
