//! Mip maps as a client makes and reads them: each level is the mean of the one before, alpha
//! for itself, and a sample reads the level whose texels are as large as its pixel.
//!
//! The mean of an alpha mask falls below the cutoff sooner than the mask gets empty. So what a
//! client draws of small cut-outs fades away at a distance, which pictures without mip maps do
//! not show.

use std::borrow::Borrow;
use std::collections::HashMap;
use std::ops::{Add, Mul};
use std::sync::Arc;

use glam::{Vec2, Vec4};
use secateur_model::{Material, Mips, Surface, Texture};

use crate::srgb_byte;
use crate::surface_references::references;
use crate::texel::{alpha_cutoff, blend_texels, color_of, is_whole, nearest_texel};

/// A texture and its mip levels.
#[derive(Debug)]
pub(crate) struct MipChain {
    /// The texture itself, then each level half as large, down to one texel.
    levels: Vec<Arc<Texture>>,
}

/// The mip maps of textures that are drawn again and again.
#[derive(Clone, Debug, Default)]
pub struct MipMaps(Vec<Arc<MipChain>>);

impl MipMaps {
    /// Of those base colour textures of these surfaces that cut something out.
    pub fn of_cut_outs<S: Borrow<Surface>>(surfaces: &[S]) -> Self {
        let surfaces = &references(surfaces)[..];
        let mut all = Self::default();
        let chains = MipChains::of_cut_outs(surfaces, &all).chains;
        for chain in chains.into_iter().flatten() {
            if all.find(chain.texture()).is_none() {
                all.0.push(chain);
            }
        }
        all
    }

    /// The chain of this very texture, not of one like it.
    fn find(&self, texture: &Arc<Texture>) -> Option<&Arc<MipChain>> {
        let mut chains = self.0.iter();
        chains.find(|chain| Arc::ptr_eq(chain.texture(), texture))
    }
}

/// The mip chains of all textures of a scene.
pub(crate) struct MipChains {
    /// One for each surface of the scene, in their order; none where its texture is not needed.
    chains: Vec<Option<Arc<MipChain>>>,
    /// What its samplers add to mip levels, in levels: see [`MipSampler::level_bias`].
    level_bias: f32,
}

/// A mip chain, and how a level of it is chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MipSampler<'a> {
    chain: &'a MipChain,
    /// Levels added to the one whose texels are as large as a sample, since a pixel of several samples reads a
    /// coarser one: 2 for 4 samples along a side.
    level_bias: f32,
}

impl MipChains {
    /// Makes the chains of all base colour textures, each once.
    pub(crate) fn of(surfaces: &[&Surface]) -> Self {
        Self::of_those(surfaces, |_| true, &MipMaps::default())
    }

    /// Only those that cut something out, but for chains that are known.
    pub(crate) fn of_cut_outs(surfaces: &[&Surface], known: &MipMaps) -> Self {
        Self::of_those(surfaces, |m| alpha_cutoff(m).is_some(), known)
    }

    fn of_those(
        surfaces: &[&Surface],
        is_needed: impl Fn(&Material) -> bool,
        known: &MipMaps,
    ) -> Self {
        let mut made: HashMap<*const Texture, Arc<MipChain>> = HashMap::new();
        let chains = surfaces.iter().map(|surface| {
            let material = &surface.material;
            let texture = material.texture.as_ref().filter(|_| is_needed(material));
            let texture = texture.filter(|texture| is_whole(texture))?;
            if let Some(known) = known.find(texture) {
                return Some(Arc::clone(known));
            }
            let chain = made.entry(Arc::as_ptr(texture));
            let chain = chain.or_insert_with(|| Arc::new(MipChain::of(texture)));
            Some(Arc::clone(chain))
        });
        Self {
            chains: chains.collect(),
            level_bias: 0.0,
        }
    }

    /// These chains for pictures with this many samples along a side of each pixel, which all read the levels
    /// whose texels are as large as the pixel.
    pub(crate) fn for_pixels_of(&self, samples: u32) -> Self {
        Self {
            chains: self.chains.clone(),
            level_bias: (samples as f32).log2(),
        }
    }

    /// The chain of a surface's texture; none if it has no texture, or one that is not needed.
    pub(crate) fn of_surface(&self, surface: u32) -> Option<MipSampler<'_>> {
        let chain = self.chains[surface as usize].as_deref()?;
        Some(MipSampler {
            chain,
            level_bias: self.level_bias,
        })
    }
}

impl MipChain {
    fn texture(&self) -> &Arc<Texture> {
        &self.levels[0]
    }

    fn of(texture: &Arc<Texture>) -> Self {
        let mut levels = vec![Arc::clone(texture)];
        if texture.filters.mips != Mips::None {
            while let Some(last) = levels.last()
                && (last.width > 1 || last.height > 1)
            {
                let half = Arc::new(half(last));
                levels.push(half);
            }
        }
        Self { levels }
    }
}

impl MipSampler<'_> {
    /// Linear colour and alpha at these coordinates, where a step of a sample to the right and one
    /// down go by these coordinates.
    pub(crate) fn sample(&self, uv: Vec2, steps: [Vec2; 2]) -> Vec4 {
        self.read(steps, |texture, is_smooth| match is_smooth {
            true => blend_texels(Some(texture), uv, Vec4::ONE, color_of),
            false => nearest_texel(texture, uv, color_of),
        })
    }

    /// The alpha of [`Self::sample`].
    pub(crate) fn sample_alpha(&self, uv: Vec2, steps: [Vec2; 2]) -> f32 {
        let alpha = |texture: &Texture, index: usize| f32::from(texture.rgba[index + 3]) / 255.0;
        self.read(steps, |texture, is_smooth| match is_smooth {
            true => blend_texels(Some(texture), uv, 1.0, alpha),
            false => nearest_texel(texture, uv, alpha),
        })
    }

    fn read<T>(&self, steps: [Vec2; 2], one: impl Fn(&Texture, bool) -> T) -> T
    where
        T: Mul<f32, Output = T> + Add<Output = T>,
    {
        let levels = &self.chain.levels;
        let (base, last) = (&levels[0], levels.len() - 1);
        let filters = base.filters;
        let level = level_of(base, steps) + self.level_bias;
        if level.is_nan() || level <= 0.0 {
            return one(base, filters.is_smooth_near);
        }
        let level = level.min(last as f32);
        let at = |number: usize| one(&levels[number.min(last)], filters.is_smooth_far);
        match filters.mips {
            Mips::None => at(0),
            Mips::Nearest => at((level + 0.5) as usize),
            Mips::Blended => {
                let (low, share) = (level as usize, level.fract());
                at(low) * (1.0 - share) + at(low + 1) * share
            }
        }
    }
}

/// The mip level of a pixel, not rounded: the binary logarithm of its longer side in texels
/// (OpenGL ES 3.0, section 3.8.10).
fn level_of(texture: &Texture, steps: [Vec2; 2]) -> f32 {
    let size = Vec2::new(texture.width as f32, texture.height as f32);
    let [right, down] = steps.map(|step| (step * size).length_squared());
    0.5 * right.max(down).log2()
}

/// The next mip level: each texel the mean of those it covers, colours in linear light.
fn half(texture: &Texture) -> Texture {
    let (width, height) = (texture.width / 2, texture.height / 2);
    let (width, height) = (width.max(1), height.max(1));
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        let rows = covered(y, height, texture.height);
        for x in 0..width {
            let mut sum = Vec4::ZERO;
            let mut total = 0.0;
            for (row, row_share) in rows.clone() {
                for (column, column_share) in covered(x, width, texture.width) {
                    let share = row_share * column_share;
                    let index = 4 * (row as usize * texture.width as usize + column as usize);
                    sum += color_of(texture, index) * share;
                    total += share;
                }
            }
            let mean = sum / total;
            rgba.extend(mean.truncate().to_array().map(srgb_byte));
            rgba.push((mean.w * 255.0 + 0.5) as u8);
        }
    }
    Texture {
        width,
        height,
        rgba,
        wrap: texture.wrap,
        filters: texture.filters,
    }
}

/// The texels along one axis that a texel of the next level covers, and how much of each.
fn covered(texel: u32, count: u32, count_before: u32) -> impl Iterator<Item = (u32, f32)> + Clone {
    let size = count_before as f32 / count as f32;
    let (start, end) = (texel as f32 * size, (texel + 1) as f32 * size);
    let last = (end.ceil() as u32).min(count_before);
    (start as u32..last).map(move |k| {
        let share = end.min((k + 1) as f32) - start.max(k as f32);
        (k, share)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::{Filters, Wrap};

    fn texture(width: u32, height: u32, alpha: &[u8]) -> Arc<Texture> {
        let rgba = alpha.iter().flat_map(|a| [255, 255, 255, *a]).collect();
        Arc::new(Texture {
            width,
            height,
            rgba,
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        })
    }

    fn alphas(level: &Texture) -> Vec<u8> {
        level.rgba.chunks(4).map(|texel| texel[3]).collect()
    }

    fn sampler(chain: &MipChain) -> MipSampler<'_> {
        MipSampler {
            chain,
            level_bias: 0.0,
        }
    }

    #[test]
    fn each_level_is_the_mean_of_the_one_before() {
        let chain = MipChain::of(&texture(4, 2, &[0, 255, 255, 255, 0, 255, 0, 0]));
        let sizes: Vec<[u32; 2]> = chain.levels.iter().map(|l| [l.width, l.height]).collect();
        assert_eq!(sizes, [[4, 2], [2, 1], [1, 1]]);
        assert_eq!(alphas(&chain.levels[1]), [128, 128]);
        // Three texels become one: the mean of all.
        let odd = MipChain::of(&texture(3, 1, &[255, 0, 0]));
        assert_eq!(alphas(&odd.levels[1]), [85]);
    }

    /// Black and white texels meet at half the light, which is 188 in sRGB.
    #[test]
    fn colours_meet_in_linear_light() {
        let mut two = (*texture(2, 1, &[255, 255])).clone();
        two.rgba[..3].fill(0);
        let chain = MipChain::of(&Arc::new(two));
        assert_eq!(chain.levels[1].rgba, [188, 188, 188, 255]);
    }

    /// A checkerboard: at its own size opaque or clear, in pixels of two texels half of both.
    #[test]
    fn pixels_of_two_texels_read_the_first_level() {
        let chain = MipChain::of(&texture(2, 2, &[255, 0, 0, 255]));
        let alpha = |texels: f32, uv: [f32; 2]| {
            let step = texels / 2.0;
            let steps = [Vec2::new(step, 0.0), Vec2::new(0.0, step)];
            sampler(&chain).sample_alpha(Vec2::from_array(uv), steps)
        };
        assert_eq!(alpha(1.0, [0.25, 0.25]), 1.0);
        assert_eq!(alpha(1.0, [0.75, 0.25]), 0.0);
        let half = 128.0 / 255.0;
        assert!((alpha(2.0, [0.25, 0.25]) - half).abs() < 1e-6);
        // Between the two levels, as far as the logarithm of the size.
        let between = alpha(2f32.sqrt(), [0.25, 0.25]);
        assert!((between - 0.5 * (1.0 + half)).abs() < 1e-5, "{between}");
        assert_eq!(alpha(f32::NAN, [0.25, 0.25]), 1.0);
        assert!((alpha(1e30, [0.25, 0.25]) - half).abs() < 1e-6);
    }

    #[test]
    fn without_mips_only_the_texture_is_read() {
        let mut plain = (*texture(2, 2, &[255, 0, 0, 255])).clone();
        plain.filters.mips = Mips::None;
        let chain = MipChain::of(&Arc::new(plain));
        let steps = [Vec2::new(8.0, 0.0), Vec2::new(0.0, 8.0)];
        let alpha = sampler(&chain).sample_alpha(Vec2::splat(0.25), steps);
        assert_eq!(alpha, 1.0);
    }
}
