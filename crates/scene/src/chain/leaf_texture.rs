//! A leaf texture for a distance: texels about as large as pixels, which cover what the original's
//! do.
//!
//! Alpha becomes the share of each texel that the original's mask covers, times a factor: the one
//! at which as much of what the level draws passes the alpha test as with the original (Castaño,
//! Computing Alpha Mipmaps, 2010, but counted over the level's own triangles: they know which parts
//! of a texture are seen, and which lie beyond its rim).

use glam::{Vec2, Vec3};
use secateur_eval::{color_of, sample_alpha};
use secateur_model::{Filters, Mips, Surface, Texture, Wrap};

use crate::dilate::dilated;
use crate::impostor::srgb_byte;

/// Points of triangles at which masks are compared.
const SAMPLES: usize = 1 << 15;

/// Fewer texels along a side would be no outline of a leaf.
const LEAST_SIDE: u32 = 8;

/// The factors of alpha that are tried, as binary logarithms.
const FACTORS: [f32; 2] = [-6.0, 6.0];

/// Halvings of that range.
const HALVINGS: usize = 20;

/// What a level draws of a material.
pub(super) struct Seen {
    /// Texture coordinates of points spread evenly over the triangles.
    points: Vec<Vec2>,
    /// Length in the texture over length in the world.
    pub(super) density: f64,
}

impl Seen {
    /// Of all surfaces of a material; none where nothing has an area.
    pub(super) fn of(surfaces: &[&Surface]) -> Option<Self> {
        let mut areas = Vec::new();
        let (mut area, mut area_in_texture) = (0.0, 0.0);
        for surface in surfaces.iter().filter(|surface| !surface.uvs.is_empty()) {
            for corners in &surface.triangles {
                let [a, b, c] = corners.map(|k| surface.positions[k as usize]);
                let [ua, ub, uc] = corners.map(|k| surface.uvs[k as usize]);
                let own = 0.5 * (b - a).cross(c - a).length();
                let in_texture = 0.5 * f64::from((ub - ua).perp_dot(uc - ua).abs());
                if own > 0.0 && own.is_finite() && in_texture.is_finite() {
                    area += own;
                    area_in_texture += in_texture;
                    areas.push((area, [ua, ub, uc]));
                }
            }
        }
        let density = (area_in_texture / area).sqrt();
        if !(density > 0.0 && density.is_finite()) {
            return None;
        }
        let mut next = 0;
        let point = |k: usize| {
            let at = (k as f64 + 0.5) / SAMPLES as f64 * area;
            while next + 1 < areas.len() && areas[next].0 < at {
                next += 1;
            }
            let [a, b, c] = areas[next].1;
            let [s, t] = spread(k);
            // What is beyond the diagonal of the square is mirrored into the triangle.
            let [s, t] = if s + t > 1.0 {
                [1.0 - s, 1.0 - t]
            } else {
                [s, t]
            };
            a + (b - a) * s + (c - a) * t
        };
        let points = (0..SAMPLES).map(point).collect();
        Some(Self { points, density })
    }

    /// The share of the points at which a texture passes the test.
    fn share(&self, texture: &Texture, cutoff: f32) -> f64 {
        let passes = |uv: &&Vec2| sample_alpha(Some(texture), **uv) >= cutoff;
        self.points.iter().filter(passes).count() as f64 / self.points.len() as f64
    }

    /// The share of the points at which two textures do not agree.
    fn difference(&self, a: &Texture, b: &Texture, cutoff: f32) -> f64 {
        let passes = |texture, uv: &Vec2| sample_alpha(Some(texture), *uv) >= cutoff;
        let differ = |uv: &&Vec2| passes(a, uv) != passes(b, uv);
        self.points.iter().filter(differ).count() as f64 / self.points.len() as f64
    }
}

/// Points of the unit square, evenly spread however many there are (the additive recurrence of the
/// plastic number; Roberts, 2018).
fn spread(k: usize) -> [f32; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    STEPS.map(|step| ((k as f64 + 0.5) * step).fract() as f32)
}

/// The texture of a level that shows `texels` of the original's on a pixel, and `gain` times as much
/// of what passes the test. `None` where nothing of
/// it passes the test, or where alpha cannot be made to keep what does.
pub(super) fn fitted(
    original: &Texture,
    cutoff: f32,
    seen: &Seen,
    texels: f64,
    mips: Mips,
    gain: f64,
) -> Option<Texture> {
    if !(cutoff > 0.0 && cutoff <= 1.0) {
        return None;
    }
    let wanted = (seen.share(original, cutoff) * gain).min(1.0);
    if wanted == 0.0 {
        return None;
    }
    let size = [original.width, original.height].map(|side| side_for(side, texels));
    let reduced = Reduced::of(original, cutoff, size);
    let is_inside = |uv: &Vec2| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all();
    // Where nothing lies beyond the rim, nothing need come in from the other side.
    let wraps: &[[Wrap; 2]] = match seen.points.iter().all(is_inside) {
        true => &[[Wrap::ClampToEdge; 2]],
        false => &[[Wrap::ClampToEdge; 2], original.wrap],
    };
    let made = wraps.iter().map(|&wrap| {
        let texture = reduced.with_share(seen, wanted, cutoff, wrap, mips);
        let difference = seen.difference(original, &texture, cutoff);
        (texture, difference)
    });
    made.min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(texture, _)| texture)
}

/// A power of two for a side where a pixel shows `texels` of its texels, not larger than it is.
fn side_for(side: u32, texels: f64) -> u32 {
    let most = 1 << side.max(1).ilog2();
    let wanted = (f64::from(side) / texels)
        .ceil()
        .clamp(1.0, f64::from(most)) as u32;
    wanted.next_power_of_two().max(LEAST_SIDE).min(most)
}

/// An image made smaller.
struct Reduced {
    size: [u32; 2],
    /// sRGB, with what is near where there is nothing.
    colors: Vec<[u8; 3]>,
    /// The share of each texel that passes the test in the original.
    shares: Vec<f32>,
}

impl Reduced {
    fn of(original: &Texture, cutoff: f32, size: [u32; 2]) -> Self {
        let columns: Vec<_> = (0..size[0])
            .map(|x| covered(x, size[0], original.width))
            .collect();
        let mut texels = Vec::new();
        let mut shares = Vec::new();
        for y in 0..size[1] {
            let rows = covered(y, size[1], original.height);
            for columns in &columns {
                let (mut color, mut passed, mut all) = (Vec3::ZERO, 0.0, 0.0);
                for &(row, row_share) in &rows {
                    for &(column, column_share) in columns {
                        let share = row_share * column_share;
                        let index = 4 * (row as usize * original.width as usize + column as usize);
                        let texel = color_of(original, index);
                        all += share;
                        if texel.w >= cutoff {
                            color += texel.truncate() * share;
                            passed += share;
                        }
                    }
                }
                texels.push(([color], passed));
                shares.push(passed / all);
            }
        }
        let filled = dilated(texels, size.map(|side| side as usize), [Vec3::ZERO]);
        Self {
            size,
            colors: filled
                .iter()
                .map(|[color]| color.to_array().map(srgb_byte))
                .collect(),
            shares,
        }
    }

    /// With the factor of alpha at which as much passes the test as is wanted.
    fn with_share(
        &self,
        seen: &Seen,
        wanted: f64,
        cutoff: f32,
        wrap: [Wrap; 2],
        mips: Mips,
    ) -> Texture {
        let of = |factor: f32| {
            let texel = |([r, g, b], share): (&[u8; 3], &f32)| {
                let alpha = (share * factor).min(1.0);
                [*r, *g, *b, (alpha * 255.0).round() as u8]
            };
            Texture {
                width: self.size[0],
                height: self.size[1],
                rgba: self
                    .colors
                    .iter()
                    .zip(&self.shares)
                    .flat_map(texel)
                    .collect(),
                wrap,
                filters: Filters {
                    mips,
                    ..Filters::default()
                },
            }
        };
        let [mut low, mut high] = FACTORS;
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            match seen.share(&of(middle.exp2()), cutoff) < wanted {
                true => low = middle,
                false => high = middle,
            }
        }
        of(high.exp2())
    }
}

/// The texels along a side that one of `count` covers, and how much of each.
fn covered(texel: u32, count: u32, count_before: u32) -> Vec<(u32, f32)> {
    let size = f64::from(count_before) / f64::from(count);
    let (start, end) = (f64::from(texel) * size, f64::from(texel + 1) * size);
    let last = (end.ceil() as u32).min(count_before);
    let share = |k: u32| end.min(f64::from(k + 1)) - start.max(f64::from(k));
    (start as u32..last).map(|k| (k, share(k) as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::{AlphaMode, Finish, Material};
    use std::sync::Arc;

    /// A card of 1 x 1 with texture coordinates from `low` to `high` in both directions.
    fn card(low: f32, high: f32) -> Surface {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Surface {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            normals: Vec::new(),
            uvs: corners
                .map(|at| Vec2::splat(low) + Vec2::from_array(at.map(|c| c as f32)) * (high - low))
                .into(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture: None,
                alpha_mode: AlphaMode::Mask(0.5),
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    /// 64 x 64 texels, clear black where `is_there` is false and red where it is true.
    fn mask(is_there: impl Fn(u32, u32) -> bool) -> Texture {
        let texel = |k: u32| match is_there(k % 64, k / 64) {
            true => [200, 0, 0, 255],
            false => [0, 0, 0, 0],
        };
        Texture {
            width: 64,
            height: 64,
            rgba: (0..64 * 64).flat_map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        }
    }

    #[test]
    fn a_smaller_mask_covers_as_much() {
        // Specks strewn over a quarter of all: means of four texels would hardly pass.
        let specks =
            mask(|x, y| ((64 * y + x).wrapping_mul(2_654_435_761) >> 16).is_multiple_of(4));
        let surface = card(0.0, 1.0);
        let seen = Seen::of(&[&surface]).unwrap();
        assert!((seen.density - 1.0).abs() < 1e-9);
        for texels in [2.0, 4.0, 8.0] {
            let small = fitted(&specks, 0.5, &seen, texels, Mips::None, 1.0).unwrap();
            assert_eq!(small.width, (64.0 / texels) as u32);
            let ratio = seen.share(&small, 0.5) / seen.share(&specks, 0.5);
            assert!((0.9..=1.1).contains(&ratio), "{texels}: {ratio}");
            // Nothing lies beyond the rim; and nothing dark is mixed in.
            assert_eq!(small.wrap, [Wrap::ClampToEdge; 2]);
            assert!(small.rgba.chunks(4).all(|texel| texel[..3] == [200, 0, 0]));
        }
    }

    #[test]
    fn a_rim_that_is_clear_is_not_wrapped_in() {
        // Opaque but for a wide rim; the card reaches as far beyond the texture as the rim is wide.
        let inner = mask(|x, y| (16..48).contains(&x) && (16..48).contains(&y));
        let surface = card(-0.25, 1.25);
        let seen = Seen::of(&[&surface]).unwrap();
        let small = fitted(&inner, 0.5, &seen, 4.0, Mips::None, 1.0).unwrap();
        assert!(seen.difference(&inner, &small, 0.5) < 0.02);
        // A tile is needed whole beyond the rim too.
        let half = mask(|x, _| x < 32);
        let surface = card(0.0, 2.0);
        let seen = Seen::of(&[&surface]).unwrap();
        let small = fitted(&half, 0.5, &seen, 4.0, Mips::None, 1.0).unwrap();
        assert_eq!(small.wrap, [Wrap::Repeat; 2]);
    }

    #[test]
    fn sides_are_powers_of_two_and_no_larger_than_they_were() {
        assert_eq!(side_for(1024, 3.0), 512);
        assert_eq!(side_for(1024, 0.1), 1024);
        assert_eq!(side_for(1000, 1.0), 512);
        assert_eq!(side_for(1024, 1e6), LEAST_SIDE);
        assert_eq!(side_for(2, 1e6), 2);
        assert_eq!(side_for(1, 1.0), 1);
    }

    #[test]
    fn nothing_is_made_of_nothing() {
        let clear = mask(|_, _| false);
        let surface = card(0.0, 1.0);
        let seen = Seen::of(&[&surface]).unwrap();
        assert_eq!(fitted(&clear, 0.5, &seen, 2.0, Mips::None, 1.0), None);
        assert!(Seen::of(&[&card(0.5, 0.5)]).is_none());
        assert!(Seen::of(&[]).is_none());
    }
}
