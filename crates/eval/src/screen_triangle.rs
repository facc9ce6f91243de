//! Triangles on a raster, clipped where they reach behind the eye.

use glam::{DVec3, Vec2};
use rayon::prelude::*;
use secateur_model::Surface;

use crate::lens::{Lens, Projected};

/// A triangle of a scene: which surface, and which triangle of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Face {
    pub(crate) surface: u32,
    pub(crate) triangle: u32,
}

/// The part of a face in front of the eye, or one of two such parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenTriangle {
    pub(crate) face: Face,
    pub(crate) corners: [Projected; 3],
    /// The shares of the face's second and third corner in each of these corners.
    pub(crate) shares: [Vec2; 3],
}

/// All faces that a lens sees, in scene order. Faces with a position that is not
/// finite or missing are left out.
pub(crate) fn screen_triangles(surfaces: &[&Surface], lens: &Lens) -> Vec<ScreenTriangle> {
    let mut all = Vec::new();
    for (index, surface) in surfaces.iter().enumerate() {
        let views: Vec<DVec3> = surface
            .positions
            .par_iter()
            .map(|&p| lens.to_view(p))
            .collect();
        let faces = surface.triangles.par_iter().enumerate();
        all.par_extend(faces.flat_map_iter(|(triangle, corners)| {
            let face = Face {
                surface: index as u32,
                triangle: triangle as u32,
            };
            let corners = corners.map(|c| views.get(c as usize).copied().unwrap_or(DVec3::NAN));
            on_screen(face, corners, lens)
        }));
    }
    all
}

fn on_screen(face: Face, corners: [DVec3; 3], lens: &Lens) -> impl Iterator<Item = ScreenTriangle> {
    let mut polygon = [(DVec3::ZERO, Vec2::ZERO); 4];
    let count = if corners.iter().all(|c| c.is_finite()) {
        clip(corners, lens, &mut polygon)
    } else {
        0
    };
    let lens = *lens;
    (2..count).filter_map(move |last| {
        let part = [polygon[0], polygon[last - 1], polygon[last]];
        let triangle = ScreenTriangle {
            face,
            corners: part.map(|(view, _)| lens.project(view)),
            shares: part.map(|(_, share)| share),
        };
        touches_raster(&triangle, &lens).then_some(triangle)
    })
}

/// The corners of the part in front of the near plane, at most four, with their
/// shares (Sutherland and Hodgman 1974, for one plane).
fn clip(corners: [DVec3; 3], lens: &Lens, polygon: &mut [(DVec3, Vec2); 4]) -> usize {
    const SHARES: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];
    let mut count = 0;
    for this in 0..3 {
        let next = (this + 1) % 3;
        let (d, d_next) = (lens.in_front(corners[this]), lens.in_front(corners[next]));
        if d >= 0.0 {
            polygon[count] = (corners[this], SHARES[this]);
            count += 1;
        }
        if (d >= 0.0) != (d_next >= 0.0) {
            let t = d / (d - d_next);
            polygon[count] = (
                corners[this].lerp(corners[next], t),
                SHARES[this].lerp(SHARES[next], t as f32),
            );
            count += 1;
        }
    }
    count
}

fn touches_raster(triangle: &ScreenTriangle, lens: &Lens) -> bool {
    let [a, b, c] = triangle.corners.map(|corner| corner.at);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    high.x >= 0.0 && high.y >= 0.0 && low.x <= lens.width as f32 && low.y <= lens.height as f32
}
