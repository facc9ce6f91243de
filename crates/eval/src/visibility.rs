//! The z-buffer: which triangle is frontmost at each sample.

use std::borrow::Borrow;

use glam::Vec2;
use rayon::prelude::*;
use secateur_model::{Material, Surface};

use crate::lens::Lens;
use crate::mips::{MipChain, MipChains};
use crate::screen_triangle::{ScreenTriangle, screen_triangles};
use crate::texel::{alpha_cutoff, sample_alpha};

/// Rows of samples that one task fills.
const BAND_ROWS: usize = 32;
/// Shared edges must not show the background through rounding.
const EDGE_SLACK: f32 = -1e-5;
/// No triangle is in front.
pub(crate) const NOTHING: u32 = u32::MAX;

/// The frontmost triangle of every sample.
pub(crate) struct Visibility {
    pub(crate) width: usize,
    pub(crate) triangles: Vec<ScreenTriangle>,
    /// Row by row: a place in `triangles`, or [`NOTHING`].
    pub(crate) frontmost: Vec<u32>,
    /// Row by row: how near it is, negative infinity for [`NOTHING`].
    pub(crate) nearness: Vec<f32>,
}

/// What is needed to find a place within a triangle.
#[derive(Clone, Copy)]
pub(crate) struct PointInTriangle {
    origin: Vec2,
    second: Vec2,
    third: Vec2,
}

impl PointInTriangle {
    /// `None` for a triangle that is seen edge-on.
    pub(crate) fn within(triangle: &ScreenTriangle) -> Option<Self> {
        let [a, b, c] = triangle.corners.map(|corner| corner.at);
        let (ab, ac) = (b - a, c - a);
        let area = ab.perp_dot(ac);
        let inverse = 1.0 / area;
        (area != 0.0 && inverse.is_finite()).then(|| Self {
            origin: a,
            second: Vec2::new(ac.y, -ac.x) * inverse,
            third: Vec2::new(-ab.y, ab.x) * inverse,
        })
    }

    /// The shares of the three corners at a point of the raster.
    pub(crate) fn weights(&self, at: Vec2) -> [f32; 3] {
        let offset = at - self.origin;
        let (second, third) = (self.second.dot(offset), self.third.dot(offset));
        [1.0 - second - third, second, third]
    }
}

/// The shares of the face's own three corners, perspective undone.
pub(crate) fn face_weights(triangle: &ScreenTriangle, weights: [f32; 3]) -> [f32; 3] {
    let mut shares = Vec2::ZERO;
    let mut total = 0.0;
    for (i, weight) in weights.into_iter().enumerate() {
        let part = weight * triangle.corners[i].inverse_w;
        shares += triangle.shares[i] * part;
        total += part;
    }
    shares /= total;
    [1.0 - shares.x - shares.y, shares.x, shares.y]
}

/// How far texture coordinates go from a sample to the next pixel to the right, and down.
pub(crate) fn uv_steps(
    triangle: &ScreenTriangle,
    place: &PointInTriangle,
    at: Vec2,
    uvs: [Vec2; 3],
) -> [Vec2; 2] {
    let uv = |at: Vec2| {
        let weights = face_weights(triangle, place.weights(at));
        uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
    };
    let here = uv(at);
    [Vec2::X, Vec2::Y].map(|step| uv(at + step) - here)
}

/// Whether back faces of materials that are not double-sided are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Culling {
    /// They are, as clients do.
    Material,
    /// All faces are drawn: what is culled still casts a shadow.
    None,
}

/// Draws surfaces through a lens. Corners run counterclockwise on a front face. Alpha is read
/// from `mips`, or without them from the textures themselves.
pub(crate) fn visibility<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    lens: &Lens,
    culling: Culling,
    mips: Option<&MipChains>,
) -> Visibility {
    let mut triangles = screen_triangles(surfaces, lens);
    if culling == Culling::Material {
        triangles.retain(|triangle| {
            let surface = surfaces[triangle.face.surface as usize].borrow();
            surface.material.double_sided || is_front(triangle)
        });
    }
    let width = lens.width as usize;
    let samples = width * lens.height as usize;
    let mut frontmost = vec![NOTHING; samples];
    let mut nearness = vec![f32::NEG_INFINITY; samples];
    let bands = triangles_by_band(&triangles, lens.height as usize);
    let band_samples = BAND_ROWS * width.max(1);
    frontmost
        .par_chunks_mut(band_samples)
        .zip(nearness.par_chunks_mut(band_samples))
        .zip(&bands)
        .enumerate()
        .for_each(|(index, ((frontmost, nearness), members))| {
            let mut band = Band {
                first_row: index * BAND_ROWS,
                width,
                frontmost,
                nearness,
            };
            for &member in members {
                let triangle = &triangles[member as usize];
                let surface = surfaces[triangle.face.surface as usize].borrow();
                let chain = mips.and_then(|mips| mips.of_surface(triangle.face.surface));
                band.draw(member, triangle, surface, chain);
            }
        });
    Visibility {
        width,
        triangles,
        frontmost,
        nearness,
    }
}

/// Rows count downwards, so a front face runs clockwise on the raster.
fn is_front(triangle: &ScreenTriangle) -> bool {
    let [a, b, c] = triangle.corners.map(|corner| corner.at);
    (b - a).perp_dot(c - a) < 0.0
}

fn triangles_by_band(triangles: &[ScreenTriangle], height: usize) -> Vec<Vec<u32>> {
    let mut bands = vec![Vec::new(); height.div_ceil(BAND_ROWS)];
    for (index, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.corners.map(|corner| corner.at.y);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let first = low.max(0.0) as usize / BAND_ROWS;
        let last = (high as usize / BAND_ROWS).min(bands.len().saturating_sub(1));
        for band in bands.iter_mut().take(last + 1).skip(first) {
            band.push(index as u32);
        }
    }
    bands
}

/// Some rows of the raster.
struct Band<'a> {
    first_row: usize,
    width: usize,
    frontmost: &'a mut [u32],
    nearness: &'a mut [f32],
}

impl Band<'_> {
    fn draw(
        &mut self,
        index: u32,
        triangle: &ScreenTriangle,
        surface: &Surface,
        mips: Option<&MipChain>,
    ) {
        let Some(place) = PointInTriangle::within(triangle) else {
            return;
        };
        let cutout = Cut::of(triangle, surface, mips);
        let [a, b, c] = triangle.corners.map(|corner| corner.at);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let rows = self.first_row..self.first_row + self.nearness.len() / self.width;
        let columns = sample_range(low.x, high.x, 0..self.width);
        for row in sample_range(low.y, high.y, rows) {
            for column in columns.clone() {
                let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let weights = place.weights(at);
                if weights.iter().any(|&w| w < EDGE_SLACK) {
                    continue;
                }
                let near = weighted(triangle.corners.map(|corner| corner.nearness), weights);
                let sample = (row - self.first_row) * self.width + column;
                if near > self.nearness[sample] && cutout.is_there(triangle, &place, at, weights) {
                    self.nearness[sample] = near;
                    self.frontmost[sample] = index;
                }
            }
        }
    }
}

/// The samples whose centres lie between two coordinates, within a range.
fn sample_range(low: f32, high: f32, within: std::ops::Range<usize>) -> std::ops::Range<usize> {
    let first = ((low - 0.5).floor().max(0.0) as usize).max(within.start);
    let end = ((high + 0.5).ceil().max(0.0) as usize).min(within.end);
    first..end.max(first)
}

fn weighted(values: [f32; 3], weights: [f32; 3]) -> f32 {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

/// The alpha test of one triangle, if it has one.
struct Cut<'a>(Option<CutFace<'a>>);

struct CutFace<'a> {
    material: &'a Material,
    mips: Option<&'a MipChain>,
    cutoff: f32,
    uvs: [Vec2; 3],
    alphas: [f32; 3],
}

impl<'a> Cut<'a> {
    fn of(triangle: &ScreenTriangle, surface: &'a Surface, mips: Option<&'a MipChain>) -> Self {
        let corners = surface.triangles[triangle.face.triangle as usize].map(|c| c as usize);
        let material = &*surface.material;
        Self(
            alpha_cutoff(material).map(|cutoff| CutFace {
                material,
                mips,
                cutoff,
                uvs: corners.map(|c| surface.uvs.get(c).copied().unwrap_or_default()),
                alphas: corners
                    .map(|c| material.base_color[3] * surface.colors.get(c).map_or(1.0, |c| c.w)),
            }),
        )
    }

    fn is_there(
        &self,
        triangle: &ScreenTriangle,
        place: &PointInTriangle,
        at: Vec2,
        weights: [f32; 3],
    ) -> bool {
        let Some(face) = &self.0 else {
            return true;
        };
        let weights = face_weights(triangle, weights);
        let uv = face.uvs[0] * weights[0] + face.uvs[1] * weights[1] + face.uvs[2] * weights[2];
        let alpha = match face.mips {
            Some(mips) => mips.sample_alpha(uv, uv_steps(triangle, place, at, face.uvs)),
            None => sample_alpha(face.material.texture.as_deref(), uv),
        };
        alpha * weighted(face.alphas, weights) >= face.cutoff
    }
}
