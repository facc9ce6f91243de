//! Crossed planes: upright quads along the crown's main axes, and one that lies.
//!
//! Ordinary quads with a cut-out texture, which any client draws. Each plane shows what is seen
//! along its normal; from behind that is the mirrored outline, as it is of the plant.

use std::borrow::Borrow;
use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;
use secateur_eval::ParallelView;
use secateur_model::Surface;

use super::atlas::{Atlas, BORDER};
use super::cell::bake;
use super::quads::Quads;

/// How many planes stand upright, and whether one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Planes {
    /// Upright ones, evenly turned, the first along the crown's longer axis.
    pub upright: u32,
    /// Whether one lies in the middle of the plant.
    pub is_one_lying: bool,
}

impl Planes {
    /// All that are tried.
    pub const ALL: [Self; 3] = [
        Self {
            upright: 2,
            is_one_lying: false,
        },
        Self {
            upright: 2,
            is_one_lying: true,
        },
        Self {
            upright: 3,
            is_one_lying: true,
        },
    ];

    /// How many there are.
    pub fn count(self) -> u32 {
        self.upright + u32::from(self.is_one_lying)
    }
}

/// A plane through a plant: what it faces, and what it has to hold.
pub(super) struct Plane {
    pub(super) centre: DVec3,
    pub(super) toward: DVec3,
    up: DVec3,
    /// Half of its width and height.
    half: DVec2,
}

impl Plane {
    fn view(&self, texel: f64) -> ParallelView {
        ParallelView {
            centre: self.centre,
            toward: self.toward,
            up: self.up,
            texel,
        }
    }
}

/// The planes of a plant, `None` where there is nothing to see.
pub(super) fn planes<S: Borrow<Surface>>(surfaces: &[S], wanted: Planes) -> Option<Vec<Plane>> {
    let (mut area, mut mean) = (0.0, DVec3::ZERO);
    let mut spread = [0.0; 3];
    for_each_triangle(surfaces, |[a, b, c]| {
        let own = (b - a).cross(c - a).length();
        area += own;
        mean += (a + b + c) / 3.0 * own;
    });
    let mean = mean / area;
    for_each_triangle(surfaces, |[a, b, c]| {
        let own = (b - a).cross(c - a).length();
        let off = (a + b + c) / 3.0 - mean;
        for (sum, product) in spread
            .iter_mut()
            .zip([off.x * off.x, off.x * off.z, off.z * off.z])
        {
            *sum += own * product;
        }
    });
    if !(area > 0.0 && mean.is_finite()) {
        return None;
    }
    // The angle of the longer axis, from x towards z.
    let [xx, xz, zz] = spread;
    let longer = 0.5 * (2.0 * xz).atan2(xx - zz);
    let mut faced: Vec<(DVec3, DVec3)> = (0..wanted.upright)
        .map(|k| {
            let angle = longer + FRAC_PI_2 + PI * f64::from(k) / f64::from(wanted.upright);
            (DVec3::new(angle.cos(), 0.0, angle.sin()), DVec3::Y)
        })
        .collect();
    if wanted.is_one_lying {
        let away = DVec3::new((longer + FRAC_PI_2).cos(), 0.0, (longer + FRAC_PI_2).sin());
        faced.push((DVec3::Y, -away));
    }
    let plane = |(toward, up): (DVec3, DVec3)| {
        let [right, up, toward] = ParallelView {
            centre: mean,
            toward,
            up,
            texel: 1.0,
        }
        .axes();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for_each_triangle(surfaces, |corners| {
            for corner in corners {
                let at = DVec2::new((corner - mean).dot(right), (corner - mean).dot(up));
                (low, high) = (low.min(at), high.max(at));
            }
        });
        let middle = (low + high) / 2.0;
        Plane {
            centre: mean + right * middle.x + up * middle.y,
            toward,
            up,
            half: (high - low) / 2.0,
        }
    };
    Some(faced.into_iter().map(plane).collect())
}

/// Sees each triangle of finite corners.
fn for_each_triangle<S: Borrow<Surface>>(surfaces: &[S], mut see: impl FnMut([DVec3; 3])) {
    for surface in surfaces {
        let surface = surface.borrow();
        for corners in &surface.triangles {
            let corners = corners.map(|corner| surface.positions[corner as usize]);
            if corners.iter().all(|c| c.is_finite()) {
                see(corners);
            }
        }
    }
}

/// The length of a texel such that the largest plane fits into a cell.
fn texel(planes: &[Plane], cell: u32) -> f64 {
    let largest = planes
        .iter()
        .map(|p| p.half.max_element())
        .fold(0.0, f64::max);
    let room = f64::from(cell) * (1.0 - 2.0 * BORDER);
    // A plant without width still has a picture.
    (2.0 * largest / room).max(f64::MIN_POSITIVE)
}

/// Bakes planes into cells of an atlas, of which this is the side, and gives the quads that show them. Places are
/// counted in cells.
pub(super) fn quads<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    planes: &[Plane],
    cell: u32,
    places: &[[u32; 2]],
    atlas: &mut Atlas,
) -> Quads {
    let texel = texel(planes, cell);
    let baked = planes
        .par_iter()
        .map(|plane| bake(surfaces, &plane.view(texel), cell));
    let baked: Vec<_> = baked.collect();
    let mut quads = Quads::default();
    for ((plane, baked), &place) in planes.iter().zip(&baked).zip(places) {
        atlas.put(baked, place.map(|cells| cells * cell));
        // The texels at the rim are whole.
        let half = plane.half + texel;
        let in_texels = (half / texel).as_vec2();
        let [across, down] = place.map(|cells| cells as f32 + 0.5);
        let middle = Vec2::new(across, down) * cell as f32;
        let uvs = [-1.0, 1.0].map(|side| atlas.uv(middle + in_texels * side));
        quads.push(plane.centre, plane.view(texel).axes(), half, uvs);
    }
    quads
}
