//! A leaf texture for a distance: texels about as large as pixels, which cover what the original's
//! do.
//!
//! Alpha becomes the share of each texel that the original's mask covers, times a factor: the one
//! at which as much of what the level draws passes the alpha test as with the original (Castaño,
//! Computing Alpha Mipmaps, 2010, but counted over the level's own triangles: they know which parts
//! of a texture are seen, and which lie beyond its rim).

use std::borrow::Cow;

use glam::{Vec2, Vec3};
use secateur_eval::{FourTexels, color_of, sample_alpha, srgb_byte};
use secateur_model::{Filters, Mips, Surface, Texture, Wrap};

use crate::dilate::dilated;

/// Points of triangles at which masks are compared.
const SAMPLES: usize = 1 << 15;

/// Fewer texels along a side would be no outline of a leaf.
const LEAST_SIDE: u32 = 8;

/// The factors of alpha that are tried, as binary logarithms.
const FACTORS: [f32; 2] = [-6.0, 6.0];

/// How often masks are smoothed for [`Outline::Smooth`]: each time each texel becomes a mean of it and its
/// neighbours, 1 to 2 to 1, along rows and columns. Two times are about a Gaussian whose standard deviation
/// is a texel.
const SMOOTHINGS: usize = 2;

/// Halvings of that range: beyond them no byte of alpha changes but those next to 255.
const HALVINGS: usize = 14;

/// How exactly a texture keeps the outline of what it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    /// As exactly as its texels can.
    Exact,
    /// Without what is thinner than a texel or two, which breaks up into specks where the level is shown larger.
    Smooth,
}

/// What a level draws of a material.
pub(super) struct Seen {
    /// Texture coordinates of points spread evenly over the triangles.
    points: Vec<Vec2>,
    /// Length in the texture over length in the world.
    density: f64,
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

    /// How many texels of a texture of this width and height, along a side, a pixel shows on the mean where a unit of
    /// length is `pixels` pixels.
    pub(super) fn texels_a_pixel(&self, [width, height]: [u32; 2], pixels: f64) -> f64 {
        let side = (f64::from(width) * f64::from(height)).sqrt();
        self.density * side / pixels
    }

    /// Whether a texture passes the test, point by point.
    fn passes(&self, texture: &Texture, cutoff: f32) -> Vec<bool> {
        let passes = |uv: &Vec2| sample_alpha(Some(texture), *uv) >= cutoff;
        self.points.iter().map(passes).collect()
    }

    /// Whether no point lies beyond a texture.
    fn is_inside(&self) -> bool {
        let is_inside = |uv: &Vec2| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all();
        self.points.iter().all(is_inside)
    }
}

/// The share of those that are true.
fn share_of(are: impl ExactSizeIterator<Item = bool>) -> f64 {
    let count = are.len() as f64;
    are.filter(|is| *is).count() as f64 / count
}

/// Points of the unit square, evenly spread however many there are (the additive recurrence of the
/// plastic number; Roberts, 2018).
fn spread(k: usize) -> [f32; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    STEPS.map(|step| ((k as f64 + 0.5) * step).fract() as f32)
}

/// The textures that a level may have for one of its materials, all of one size.
pub(super) struct LeafTextures {
    reduced: Reduced,
    cutoff: f32,
    /// Whether the original passes the test, point by point, and at what share of the points.
    is_original: Vec<bool>,
    share: f64,
    /// What the points read of a texture of this size, by how it wraps.
    wraps: Vec<([Wrap; 2], Vec<FourTexels>)>,
}

/// How a texture is made of one for which masks were compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Make {
    pub(super) mips: Mips,
    pub(super) outline: Outline,
    /// How many times as much passes the test as of the original.
    pub(super) gain: f64,
}

impl LeafTextures {
    /// Textures that show `texels` of the original's on a pixel. `None` where nothing of the original passes
    /// the test, or where alpha cannot be made to keep what does.
    pub(super) fn new(original: &Texture, cutoff: f32, seen: &Seen, texels: f64) -> Option<Self> {
        if !(cutoff > 0.0 && cutoff <= 1.0) {
            return None;
        }
        let is_original = seen.passes(original, cutoff);
        let share = share_of(is_original.iter().copied());
        if share == 0.0 {
            return None;
        }
        let size = [original.width, original.height].map(|side| side_for(side, texels));
        // Where nothing lies beyond the rim, nothing need come in from the other side.
        let mut wraps = vec![[Wrap::ClampToEdge; 2]];
        if !seen.is_inside() {
            wraps.push(original.wrap);
        }
        let read = |wrap: [Wrap; 2]| {
            let points = seen.points.iter();
            let read = points.map(|uv| FourTexels::at(size, wrap, *uv)).collect();
            (wrap, read)
        };
        Some(Self {
            reduced: Reduced::of(original, cutoff, size),
            cutoff,
            is_original,
            share,
            wraps: wraps.into_iter().map(read).collect(),
        })
    }

    /// The texture that is asked for, by the way to wrap with which it shows most nearly what the original does.
    pub(super) fn made(&self, make: Make) -> Texture {
        let wanted = (self.share * make.gain).min(1.0);
        let made = self.wraps.iter().map(|(wrap, read)| {
            let shares = match make.outline {
                Outline::Exact => Cow::Borrowed(&self.reduced.shares),
                Outline::Smooth => Cow::Owned(self.reduced.smooth_shares(*wrap)),
            };
            let factor = self.factor_for(wanted, read, &shares);
            let alphas = alphas(&shares, factor);
            let passes = read.iter().map(|four| self.passes(four, &alphas));
            let pairs = passes.zip(&self.is_original);
            let difference = share_of(pairs.map(|(is, was)| is != *was));
            (difference, *wrap, alphas)
        });
        let (_, wrap, alphas) = made
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("at least one way to wrap");
        self.reduced.texture(&alphas, wrap, make.mips)
    }

    /// The factor of alpha at which this share of the points passes the test.
    fn factor_for(&self, wanted: f64, read: &[FourTexels], shares: &[f32]) -> f32 {
        let [mut low, mut high] = FACTORS;
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            let alphas = alphas(shares, middle.exp2());
            let share = share_of(read.iter().map(|four| self.passes(four, &alphas)));
            match share < wanted {
                true => low = middle,
                false => high = middle,
            }
        }
        high.exp2()
    }

    fn passes(&self, four: &FourTexels, alphas: &[f32]) -> bool {
        four.blended(|texel| alphas[texel as usize]) >= self.cutoff
    }
}

/// A power of two for a side where a pixel shows `texels` of its texels, not larger than it is.
pub(super) fn side_for(side: u32, texels: f64) -> u32 {
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

    /// The shares without what is thinner than a texel or two. Beyond the rim of a texture that does not
    /// repeat there is nothing: what touches the rim would else reach on from there as far as a card does.
    fn smooth_shares(&self, wrap: [Wrap; 2]) -> Vec<f32> {
        let size = self.size;
        let near = |axis: usize, texel: i32| {
            let is_beyond = !(0..size[axis] as i32).contains(&texel);
            let is_nothing = is_beyond && wrap[axis] == Wrap::ClampToEdge;
            (!is_nothing).then(|| wrap[axis].texel(texel, size[axis]))
        };
        let mut shares = self.shares.clone();
        for axis in (0..2).cycle().take(2 * SMOOTHINGS) {
            let smooth = |k: usize| {
                let at = [k as u32 % size[0], k as u32 / size[0]];
                let share = |step: i32| {
                    let mut of = at;
                    match near(axis, at[axis] as i32 + step) {
                        Some(texel) => of[axis] = texel,
                        None => return 0.0,
                    }
                    shares[(of[1] * size[0] + of[0]) as usize]
                };
                (share(-1) + 2.0 * share(0) + share(1)) / 4.0
            };
            shares = (0..shares.len()).map(smooth).collect();
        }
        shares
    }

    fn texture(&self, alphas: &[f32], wrap: [Wrap; 2], mips: Mips) -> Texture {
        let texel =
            |([r, g, b], alpha): (&[u8; 3], &f32)| [*r, *g, *b, (alpha * 255.0).round() as u8];
        let texels = self.colors.iter().zip(alphas);
        Texture {
            width: self.size[0],
            height: self.size[1],
            rgba: texels.flat_map(texel).collect(),
            wrap,
            filters: Filters {
                mips,
                ..Filters::default()
            },
        }
    }
}

/// Shares times a factor, as bytes that are read as 0 to 1.
fn alphas(shares: &[f32], factor: f32) -> Vec<f32> {
    let alpha = |share: &f32| alpha_byte(*share, factor) / 255.0;
    shares.iter().map(alpha).collect()
}

/// A whole number from 0 to 255.
fn alpha_byte(share: f32, factor: f32) -> f32 {
    // Rounded by hand: `f32::round` is a call.
    (((share * factor).min(1.0) * 255.0 + 0.5) as u8).into()
}

/// The texels along a side that one of `count` covers, and how much of each.
pub(super) fn covered(texel: u32, count: u32, count_before: u32) -> Vec<(u32, f32)> {
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

    fn fitted(original: &Texture, seen: &Seen, texels: f64) -> Option<Texture> {
        let textures = LeafTextures::new(original, 0.5, seen, texels)?;
        Some(textures.made(Make {
            mips: Mips::None,
            outline: Outline::Exact,
            gain: 1.0,
        }))
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
            let small = fitted(&specks, &seen, texels).unwrap();
            assert_eq!(small.width, (64.0 / texels) as u32);
            let share = |texture: &Texture| share_of(seen.passes(texture, 0.5).into_iter());
            let ratio = share(&small) / share(&specks);
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
        let small = fitted(&inner, &seen, 4.0).unwrap();
        let [before, after] = [&inner, &small].map(|texture| seen.passes(texture, 0.5));
        let differ = before.iter().zip(&after).map(|(a, b)| a != b);
        assert!(share_of(differ) < 0.02);
        // A tile is needed whole beyond the rim too.
        let half = mask(|x, _| x < 32);
        let surface = card(0.0, 2.0);
        let seen = Seen::of(&[&surface]).unwrap();
        let small = fitted(&half, &seen, 4.0).unwrap();
        assert_eq!(small.wrap, [Wrap::Repeat; 2]);
    }

    #[test]
    fn a_smooth_outline_has_no_thread_and_covers_as_much() {
        // A disc, and above it a thread that is a texel wide.
        let disc = |x: u32, y: u32| (x as i32 - 32).pow(2) + (y as i32 - 32).pow(2) < 256;
        let leaf = mask(|x, y| disc(x, y) || y == 8);
        let surface = card(0.0, 1.0);
        let seen = Seen::of(&[&surface]).unwrap();
        let textures = LeafTextures::new(&leaf, 0.5, &seen, 2.0).unwrap();
        let made = |outline: Outline| {
            textures.made(Make {
                mips: Mips::None,
                outline,
                gain: 1.0,
            })
        };
        let [exact, smooth] = [Outline::Exact, Outline::Smooth].map(made);
        let passes = |texture: &Texture| seen.passes(texture, 0.5);
        let share = |texture: &Texture| share_of(passes(texture).into_iter());
        let is_beside = |uv: &Vec2| (uv.x - 0.5).abs() > 0.4;
        let beside = |texture: &Texture| {
            let pairs = seen.points.iter().zip(passes(texture));
            let count = pairs
                .filter(|(uv, passes)| is_beside(uv) && *passes)
                .count();
            count as f64 / SAMPLES as f64
        };
        assert!(beside(&exact) > 0.001, "{}", beside(&exact));
        assert_eq!(beside(&smooth), 0.0);
        assert!((share(&smooth) / share(&leaf) - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_tile_stays_whole_when_it_is_smoothed() {
        let all = mask(|_, _| true);
        for wrap in [Wrap::Repeat, Wrap::MirroredRepeat] {
            let smooth = Reduced::of(&all, 0.5, [16, 8]).smooth_shares([wrap; 2]);
            assert!(smooth.iter().all(|share| (share - 1.0).abs() < 1e-6));
        }
        // Beyond a rim that does not repeat there is nothing.
        let smooth = Reduced::of(&all, 0.5, [16, 8]).smooth_shares([Wrap::ClampToEdge; 2]);
        let row: Vec<f32> = smooth[4 * 16..][..4].to_vec();
        assert_eq!(row, [0.625, 0.9375, 1.0, 1.0]);
        // What leaves a tile on one side comes in on the other.
        let first = mask(|x, _| x < 4);
        let of = |wrap: Wrap| Reduced::of(&first, 0.5, [16, 16]).smooth_shares([wrap; 2]);
        assert!(of(Wrap::Repeat)[15] > 0.2 && of(Wrap::ClampToEdge)[15] == 0.0);
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
        assert_eq!(fitted(&clear, &seen, 2.0), None);
        assert!(Seen::of(&[&card(0.5, 0.5)]).is_none());
        assert!(Seen::of(&[]).is_none());
    }
}
