//! Octahedral views: a plant from directions all over the upper half of the sphere, and what a
//! sampler makes of them.
//!
//! Directions lie on a square grid onto which the upper half of an octahedron is unfolded (Engelhardt,
//! Dachsbacher, Octahedral Environment Maps, 2008). Between them the three nearest are blended.
//! From below, a plant has the mirrored outline that it has from the opposite direction above.
//! `docs/impostors.md` has the sampler as shaders; this is its twin, by which impostors are judged.

use std::array;
use std::borrow::Borrow;

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use secateur_eval::{LINEAR_FROM_SRGB, ParallelView, srgb_byte};
use secateur_model::{Mips, Surface};

pub use super::atlas::BORDER;
use super::atlas::{Atlas, direction_byte, material};
use super::cell::bake;
pub use super::coverage::CUTOFF;
use super::quads::Quads;

/// Views along a side of the grid.
pub const FRAMES: u32 = 7;

/// Cells along a side of the atlas, a power of two; the last row has room for crossed planes.
pub const CELLS: u32 = 8;

/// All views of a plant.
#[derive(Clone, Debug)]
pub struct Octahedral {
    /// The middle of what is seen.
    pub centre: DVec3,
    /// Half of the width and height of a view, its border left out.
    pub radius: f64,
    /// Texels a side of a cell.
    pub cell: u32,
    size: u32,
    rgba: Vec<u8>,
    normals: Vec<u8>,
}

/// The direction toward the eye at a place of the grid, -1 to 1 along both sides.
pub fn direction(place: DVec2) -> DVec3 {
    let (x, z) = ((place.x + place.y) / 2.0, (place.x - place.y) / 2.0);
    DVec3::new(x, (1.0 - x.abs() - z.abs()).max(0.0), z).normalize()
}

/// The place on the grid of a direction of the upper half.
pub fn place(direction: DVec3) -> DVec2 {
    let flat = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    DVec2::new(flat.x + flat.z, flat.x - flat.z)
}

/// Right, up and toward the eye of a view; right is level.
pub fn axes(toward: DVec3) -> [DVec3; 3] {
    let right = DVec3::Y.cross(toward);
    let right = match right.length() < 1e-3 {
        true => DVec3::X,
        false => right.normalize(),
    };
    [right, toward.cross(right), toward]
}

/// The three views about a direction of the upper half, and what each counts.
fn nearest(direction: DVec3) -> [([u32; 2], f32); 3] {
    let most = f64::from(FRAMES - 1);
    let at = (place(direction) * 0.5 + 0.5).clamp(DVec2::ZERO, DVec2::ONE) * most;
    let low = at.floor().min(DVec2::splat(most - 1.0));
    let part = (at - low).as_vec2();
    let [x, y] = [low.x as u32, low.y as u32];
    let is_first = part.x + part.y < 1.0;
    let corner = match is_first {
        true => ([x, y], 1.0 - part.x - part.y),
        false => ([x + 1, y + 1], part.x + part.y - 1.0),
    };
    let [across, down] = match is_first {
        true => [part.x, part.y],
        false => [1.0 - part.y, 1.0 - part.x],
    };
    [corner, ([x + 1, y], across), ([x, y + 1], down)]
}

/// The direction of a view of the grid.
fn direction_of([x, y]: [u32; 2]) -> DVec3 {
    let most = f64::from(FRAMES - 1);
    direction(DVec2::new(x.into(), y.into()) / most * 2.0 - 1.0)
}

/// Bakes all views into an atlas of cells of this side.
pub(super) fn bake_views<S: Borrow<Surface> + Sync>(
    surfaces: &[S],
    (centre, radius): (DVec3, f64),
    cell: u32,
    atlas: &mut Atlas,
) {
    let texel = 2.0 * radius / (f64::from(cell) * (1.0 - 2.0 * BORDER));
    let places: Vec<[u32; 2]> = (0..FRAMES * FRAMES)
        .map(|k| [k % FRAMES, k / FRAMES])
        .collect();
    let of_view = |place: &[u32; 2]| {
        let [_, up, toward] = axes(direction_of(*place));
        let view = ParallelView {
            centre,
            toward,
            up,
            texel,
        };
        bake(surfaces, &view, cell)
    };
    let cells: Vec<_> = places.par_iter().map(of_view).collect();
    for (place, baked) in places.iter().zip(&cells) {
        atlas.put(baked, place.map(|cells| cells * cell));
    }
}

impl Octahedral {
    pub(super) fn new(centre: DVec3, radius: f64, cell: u32, atlas: Atlas) -> Self {
        Self {
            centre,
            radius,
            cell,
            size: atlas.size[0],
            rgba: atlas.rgba,
            normals: atlas.normals,
        }
    }

    /// What a sampler shows to an eye in this direction from the middle: a quad that faces it.
    pub fn facing(&self, toward_eye: DVec3) -> Surface {
        let toward = toward_eye.normalize_or(DVec3::Y);
        let own = axes(toward);
        let side = match toward.y < 0.0 {
            true => -1.0,
            false => 1.0,
        };
        let views = nearest(toward * side).map(|(place, weight)| {
            let axes = axes(direction_of(place));
            (place, weight, axes)
        });
        let cell = self.cell as usize;
        let mut rgba = Vec::with_capacity(4 * cell * cell);
        let mut normals = Vec::with_capacity(4 * cell * cell);
        for at in 0..cell * cell {
            // From -1 to 1, right and up.
            let x = 2.0 * ((at % cell) as f64 + 0.5) / cell as f64 - 1.0;
            let y = 1.0 - 2.0 * ((at / cell) as f64 + 0.5) / cell as f64;
            let point = own[0] * x + own[1] * y;
            let (mut color, mut normal) = (Vec4::ZERO, DVec3::ZERO);
            for (place, weight, [right, up, ahead]) in &views {
                let within = Vec2::new(point.dot(*right) as f32, -point.dot(*up) as f32);
                let (seen, bent) = self.sample(*place, within);
                color += seen * *weight;
                let [nx, ny, nz] = bent.as_dvec3().to_array();
                let bent = *right * nx + *up * ny + *ahead * nz;
                normal += bent * (f64::from(*weight) * side);
            }
            let [r, g, b, a] = color.to_array();
            let alpha = (a.clamp(0.0, 1.0) * 255.0).round() as u8;
            rgba.extend([srgb_byte(r), srgb_byte(g), srgb_byte(b), alpha]);
            let normal = normal.normalize_or(toward);
            let [x, y, z] = own.map(|axis| direction_byte(normal.dot(axis) as f32));
            normals.extend([x, y, z, 255]);
        }
        let mut quad = Quads::default();
        let half = DVec2::splat(self.radius);
        quad.push(self.centre, own, half, [Vec2::ZERO, Vec2::ONE]);
        quad.surface(material([self.cell; 2], rgba, normals, Mips::Blended))
    }

    /// Colour, alpha and normal at a place of a view, -1 to 1 right and down within its border.
    fn sample(&self, [across, down]: [u32; 2], within: Vec2) -> (Vec4, Vec3) {
        let cell = self.cell as f32;
        let inner = within * (0.5 - BORDER as f32) + 0.5;
        let inner = inner.clamp(Vec2::ZERO, Vec2::ONE) * cell - 0.5;
        let inner = inner.clamp(Vec2::ZERO, Vec2::splat(cell - 1.001));
        let (low, part) = (inner.floor(), inner - inner.floor());
        let (mut color, mut normal) = (Vec4::ZERO, Vec3::ZERO);
        for (dx, dy, weight) in [
            (0, 0, (1.0 - part.x) * (1.0 - part.y)),
            (1, 0, part.x * (1.0 - part.y)),
            (0, 1, (1.0 - part.x) * part.y),
            (1, 1, part.x * part.y),
        ] {
            let x = across * self.cell + (low.x as u32 + dx).min(self.cell - 1);
            let y = down * self.cell + (low.y as u32 + dy).min(self.cell - 1);
            let at = 4 * (y as usize * self.size as usize + x as usize);
            let [r, g, b] = array::from_fn(|k| LINEAR_FROM_SRGB[usize::from(self.rgba[at + k])]);
            color += Vec4::new(r, g, b, f32::from(self.rgba[at + 3]) / 255.0) * weight;
            let n: [f32; 3] = array::from_fn(|k| f32::from(self.normals[at + k]) / 127.5 - 1.0);
            normal += Vec3::from_array(n) * weight;
        }
        (color, normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_holds_the_upper_half_of_the_sphere() {
        // The middle is the zenith, the corners and the middles of the rim are level.
        assert!(direction(DVec2::ZERO).distance(DVec3::Y) < 1e-12);
        assert!(direction(DVec2::ONE).distance(DVec3::X) < 1e-12);
        assert!(direction(DVec2::new(1.0, -1.0)).distance(DVec3::Z) < 1e-12);
        assert!(direction(DVec2::new(1.0, 0.0)).y.abs() < 1e-12);
        for toward in [
            DVec3::new(0.3, 0.8, -0.2).normalize(),
            DVec3::new(-0.9, 0.1, 0.4).normalize(),
        ] {
            assert!(direction(place(toward)).distance(toward) < 1e-12);
        }
    }

    #[test]
    fn weights_are_shares_and_a_view_of_the_grid_counts_alone() {
        for toward in [
            DVec3::new(0.3, 0.8, -0.2).normalize(),
            DVec3::X,
            DVec3::Y,
            DVec3::new(-0.9, 0.01, 0.4).normalize(),
        ] {
            let found = nearest(toward);
            let sum: f32 = found.iter().map(|(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-5 && found.iter().all(|(_, w)| *w >= -1e-6));
        }
        let exact = nearest(direction_of([2, 4]));
        let [place, ..] = exact.map(|(place, weight)| (weight > 0.999).then_some(place));
        let all = exact.map(|(place, weight)| (weight > 0.999).then_some(place));
        assert!(all.contains(&Some([2, 4])), "{place:?} {exact:?}");
    }

    #[test]
    fn axes_are_square_and_right_handed_everywhere() {
        for toward in [
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::X,
            DVec3::new(0.1, -0.7, 0.6).normalize(),
        ] {
            let [right, up, ahead] = axes(toward);
            assert!(right.cross(up).distance(ahead) < 1e-9, "{toward}");
            assert!(right.y.abs() < 1e-12, "level");
        }
    }
}
