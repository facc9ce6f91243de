//! Looks up texels as a sampler does: wraps, filters and mip levels.

use glam::{Vec2, Vec3, Vec4};
use secateur_model::{AlphaMode, Material, Texture, Wrap};

use crate::srgb::LINEAR_FROM_SRGB;

/// The alpha below which a material is not there, or `None` where alpha does not
/// matter. A picture without blending takes half-transparent for cut out.
pub(crate) fn alpha_cutoff(material: &Material) -> Option<f32> {
    match material.alpha_mode {
        AlphaMode::Opaque => None,
        AlphaMode::Mask(cutoff) => Some(cutoff),
        AlphaMode::Blend => Some(0.5),
    }
}

/// Linear colour and alpha of a texture at these coordinates, white without
/// a texture: a mean of the four nearest texels.
pub(crate) fn sample(texture: Option<&Texture>, uv: Vec2) -> Vec4 {
    blend_texels(texture, uv, Vec4::ONE, color_of)
}

/// Linear colour and alpha of the texel whose bytes start at this index.
///
/// # Panics
/// If there are no four bytes at the index.
pub fn color_of(texture: &Texture, index: usize) -> Vec4 {
    let rgba: [u8; 4] = std::array::from_fn(|i| texture.rgba[index + i]);
    let linear = &*LINEAR_FROM_SRGB;
    let rgb = Vec3::new(
        linear[usize::from(rgba[0])],
        linear[usize::from(rgba[1])],
        linear[usize::from(rgba[2])],
    );
    rgb.extend(f32::from(rgba[3]) / 255.0)
}

/// The alpha of a texture at these coordinates, 1 without a texture: a mean of the four nearest
/// texels.
pub fn sample_alpha(texture: Option<&Texture>, uv: Vec2) -> f32 {
    blend_texels(texture, uv, 1.0, |texture, index| {
        f32::from(texture.rgba[index + 3]) / 255.0
    })
}

/// Red, green and blue of a texture that holds directions, from -1 to 1.
pub(crate) fn sample_plain(texture: &Texture, uv: Vec2) -> Vec3 {
    blend_texels(Some(texture), uv, Vec3::Z, |texture, index| {
        let [r, g, b]: [u8; 3] = std::array::from_fn(|i| texture.rgba[index + i]);
        Vec3::new(r.into(), g.into(), b.into()) / 127.5 - 1.0
    })
}

/// The texel that these coordinates lie in, of a texture that [is whole](is_whole).
pub(crate) fn nearest_texel<T>(
    texture: &Texture,
    uv: Vec2,
    texel: impl Fn(&Texture, usize) -> T,
) -> T {
    let size = [texture.width, texture.height];
    let at = uv * Vec2::new(size[0] as f32, size[1] as f32);
    let at = at.clamp(Vec2::splat(-1e9), Vec2::splat(1e9));
    let x = wrapped(texture.wrap[0], floor(at.x), size[0]);
    let y = wrapped(texture.wrap[1], floor(at.y), size[1]);
    texel(texture, 4 * (y * size[0] as usize + x))
}

/// The mean of the four nearest texels, by how near they are; `plain` without a texture.
pub(crate) fn blend_texels<T>(
    texture: Option<&Texture>,
    uv: Vec2,
    plain: T,
    texel: impl Fn(&Texture, usize) -> T,
) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let Some(texture) = texture.filter(|t| is_whole(t)) else {
        return plain;
    };
    let four = FourTexels::at([texture.width, texture.height], texture.wrap, uv);
    four.blended(|number| texel(texture, 4 * number as usize))
}

/// The four texels that a smooth sampler reads, and how much of each.
#[derive(Clone, Copy, Debug)]
pub struct FourTexels {
    /// Numbers of texels, row by row: two of the upper row, two of the lower one.
    pub texels: [u32; 4],
    /// The shares of the right column and of the lower row.
    pub shares: Vec2,
}

impl FourTexels {
    /// The texels at these coordinates, in a texture of this width and height, of at least a texel and at most
    /// 2^32.
    pub fn at(size: [u32; 2], wrap: [Wrap; 2], uv: Vec2) -> Self {
        let at = uv * Vec2::new(size[0] as f32, size[1] as f32) - 0.5;
        // Keeps texel numbers in range; beyond it a coordinate has no texel left.
        let at = at.clamp(Vec2::splat(-1e9), Vec2::splat(1e9));
        let low = [floor(at.x), floor(at.y)];
        let columns = [0, 1].map(|dx| wrapped(wrap[0], low[0] + dx, size[0]));
        let rows = [0, 1].map(|dy| wrapped(wrap[1], low[1] + dy, size[1]));
        let number = |x: usize, y: usize| (rows[y] * size[0] as usize + columns[x]) as u32;
        Self {
            texels: [number(0, 0), number(1, 0), number(0, 1), number(1, 1)],
            shares: at - Vec2::new(low[0] as f32, low[1] as f32),
        }
    }

    /// The mean of what the four have, by how much of each is read.
    pub fn blended<T>(&self, of: impl Fn(u32) -> T) -> T
    where
        T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c, d] = self.texels;
        let share = self.shares;
        let top = of(a) * (1.0 - share.x) + of(b) * share.x;
        let bottom = of(c) * (1.0 - share.x) + of(d) * share.x;
        top * (1.0 - share.y) + bottom * share.y
    }
}

/// The number of the first of the four texels that a smooth sampler reads: see [`FourTexels::at`].
#[inline]
pub(crate) fn low_texel(size: [u32; 2], wrap: [Wrap; 2], uv: Vec2) -> usize {
    let at = uv * Vec2::new(size[0] as f32, size[1] as f32) - 0.5;
    let at = at.clamp(Vec2::splat(-1e9), Vec2::splat(1e9));
    let column = wrapped(wrap[0], floor(at.x), size[0]);
    wrapped(wrap[1], floor(at.y), size[1]) * size[0] as usize + column
}

/// The largest whole number not above a value: `f32::floor` is a call on targets
/// without the instruction.
pub(crate) fn floor(value: f32) -> i64 {
    let whole = value as i64;
    whole - i64::from(whole as f32 > value)
}

/// Whether a texture has a texel, and as many bytes as its size says.
pub(crate) fn is_whole(texture: &Texture) -> bool {
    let texels = texture.width as usize * texture.height as usize;
    texels > 0 && texture.rgba.len() >= 4 * texels
}

/// [`Wrap::texel`] for sizes that are no power of two.
fn wrapped(wrap: Wrap, texel: i64, size: u32) -> usize {
    let is_power = size.is_power_of_two();
    let size = i64::from(size);
    let wrapped = match wrap {
        // The remainder without a division, which would take longer than all else.
        Wrap::Repeat if is_power => texel & (size - 1),
        Wrap::Repeat => texel.rem_euclid(size),
        Wrap::ClampToEdge => texel.clamp(0, size - 1),
        Wrap::MirroredRepeat => {
            let t = texel.rem_euclid(2 * size);
            t.min(2 * size - 1 - t)
        }
    };
    wrapped as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_agrees_with_the_model() {
        for wrap in [Wrap::Repeat, Wrap::ClampToEdge, Wrap::MirroredRepeat] {
            for (texel, size) in (-20..20).flat_map(|texel| [(texel, 8), (texel, 1)]) {
                assert_eq!(
                    wrapped(wrap, texel.into(), size),
                    wrap.texel(texel, size) as usize
                );
            }
        }
        // Three texels, mirrored: 0 1 2 2 1 0 0 1 2.
        let row: Vec<usize> = (0..9)
            .map(|t| wrapped(Wrap::MirroredRepeat, t, 3))
            .collect();
        assert_eq!(row, [0, 1, 2, 2, 1, 0, 0, 1, 2]);
    }

    #[test]
    fn texels_blend_between_their_centres() {
        let texture = Texture {
            width: 2,
            height: 1,
            rgba: vec![255, 0, 0, 0, 0, 0, 0, 255],
            wrap: [Wrap::ClampToEdge; 2],
            filters: secateur_model::Filters::default(),
        };
        let at = |u: f32| sample(Some(&texture), Vec2::new(u, 0.5));
        assert_eq!(at(0.25), Vec4::new(1.0, 0.0, 0.0, 0.0));
        assert_eq!(at(0.5), Vec4::new(0.5, 0.0, 0.0, 0.5));
        assert_eq!(at(9.0), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(sample_alpha(Some(&texture), Vec2::new(0.5, 0.5)), 0.5);
        assert_eq!(sample(None, Vec2::ZERO), Vec4::ONE);
        assert!(at(f32::INFINITY).is_finite() && at(f32::MIN).is_finite());
        sample_alpha(Some(&texture), Vec2::NAN);
    }

    #[test]
    fn floor_is_floor() {
        for value in [-2.0f32, -1.5, -1.0, -0.25, -0.0, 0.0, 0.75, 1.0, 7.9] {
            assert_eq!(floor(value), value.floor() as i64, "{value}");
        }
    }
}
