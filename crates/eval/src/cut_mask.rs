//! Where a texture surely passes an alpha test, and where it surely does not: two bits a texel, so that few
//! samples have to read the texels themselves.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use glam::{Vec2, Vec4};
use secateur_model::{Material, Texture, Wrap};

use crate::texel::{alpha_cutoff, floor, is_whole, low_texel};

/// By how much, as a share, a mean of texels must be beyond the cutoff to be surely so: more than
/// rounding moves it.
const SURE: f32 = 1e-4;

/// A sample here passes the test, or does not; neither bit where the texels differ.
const PASSES: u8 = 1;
const FAILS: u8 = 2;

/// What a test comes to wherever a smooth sampler may read a texture.
#[derive(Debug)]
pub(crate) struct CutMask {
    size: [u32; 2],
    wrap: [Wrap; 2],
    /// The factor of alpha that it is of.
    factor: f32,
    /// Four texels a byte, row by row: what is so of a texel and of those to its right and below.
    bits: Vec<u8>,
    /// What is so of all texels of a square: squares of [`LEAST_SQUARE`] texels a side, and ever twice as many.
    squares: Vec<Squares>,
}

/// The least squares of texels of which a mask knows as a whole, in texels a side: a power of two.
const LEAST_SQUARE: u32 = 4;

/// Squares of a texture's texels; the last of a row and of a column may have fewer.
#[derive(Debug)]
struct Squares {
    columns: usize,
    /// Row by row what is so of all texels of each.
    flags: Vec<u8>,
}

impl Squares {
    /// The squares of `side` x `side` texels of a texture of `width` texels a row, from what is so of each texel.
    fn of(flags: &[u8], width: usize, side: usize) -> Self {
        let columns = width.div_ceil(side);
        let of_rows = flags.chunks(width * side).flat_map(|rows| {
            let mut all = vec![PASSES | FAILS; columns];
            for row in rows.chunks(width) {
                for (all, flags) in all.iter_mut().zip(row.chunks(side)) {
                    *all &= flags.iter().fold(PASSES | FAILS, |all, flags| all & flags);
                }
            }
            all
        });
        Self {
            flags: of_rows.collect(),
            columns,
        }
    }

    fn all_of(flags: &[u8], width: usize) -> Vec<Self> {
        let mut all = vec![Self::of(flags, width, LEAST_SQUARE as usize)];
        while let Some(last) = all.last().filter(|last| last.flags.len() > 1) {
            all.push(Self::of(&last.flags, last.columns, 2));
        }
        all
    }
}

impl CutMask {
    fn of(texture: &Texture, cutoff: f32, factor: f32) -> Option<Self> {
        // Mirrored, a texel has neighbours on either side.
        let is_mirrored = texture.wrap.contains(&Wrap::MirroredRepeat);
        if is_mirrored || !is_whole(texture) || !(factor > 0.0 && cutoff > 0.0) {
            return None;
        }
        let of_byte: [u8; 256] = std::array::from_fn(|byte| {
            let alpha = byte as f32 / 255.0 * factor;
            match alpha {
                alpha if alpha >= cutoff * (1.0 + SURE) => PASSES,
                alpha if alpha <= cutoff * (1.0 - SURE) => FAILS,
                _ => 0,
            }
        });
        let [width, height] = [texture.width as usize, texture.height as usize];
        let next = |at: usize, size: usize, wrap: Wrap| match wrap {
            Wrap::Repeat => (at + 1) % size,
            _ => (at + 1).min(size - 1),
        };
        let texels = texture.rgba.chunks_exact(4).take(width * height);
        let own: Vec<u8> = texels.map(|rgba| of_byte[usize::from(rgba[3])]).collect();
        let mut bits = vec![0; (width * height).div_ceil(4)];
        let mut flags = vec![0; width * height];
        for (y, row) in own.chunks_exact(width).enumerate() {
            let below = next(y, height, texture.wrap[1]) * width;
            let below = &own[below..below + width];
            for x in 0..width {
                let right = next(x, width, texture.wrap[0]);
                let all = row[x] & row[right] & below[x] & below[right];
                let number = y * width + x;
                bits[number / 4] |= all << (2 * (number % 4));
                flags[number] = all;
            }
        }
        Some(Self {
            size: [texture.width, texture.height],
            wrap: texture.wrap,
            factor,
            bits,
            squares: Squares::all_of(&flags, width),
        })
    }

    /// The larger of the texture's width and height, in texels.
    pub(crate) fn most_texels(&self) -> f32 {
        self.size[0].max(self.size[1]) as f32
    }

    /// What [`Self::passes`] comes to for all coordinates between these, rounding included; nothing where it differs
    /// from place to place, or none of this is known of the whole.
    pub(crate) fn passes_between(&self, low: Vec2, high: Vec2, alphas: [f32; 3]) -> Option<bool> {
        if alphas != [self.factor; 3] {
            return None;
        }
        let axis = |k: usize| texels_between([low[k], high[k]], self.wrap[k], self.size[k]);
        let (columns, rows) = (axis(0)?, axis(1)?);
        let count = (columns.end - columns.start).max(rows.end - rows.start);
        let doubled = count.div_ceil(LEAST_SQUARE).next_power_of_two().ilog2();
        let doubled = doubled.min(self.squares.len() as u32 - 1);
        let squares = &self.squares[doubled as usize];
        let side = LEAST_SQUARE << doubled;
        let of = |texels: &Range<u32>| {
            (texels.start / side) as usize..texels.end.div_ceil(side) as usize
        };
        let mut all = PASSES | FAILS;
        for row in of(&rows) {
            let first = row * squares.columns;
            for column in of(&columns) {
                all &= squares.flags[first + column];
            }
        }
        flags_say(all)
    }

    /// Whether a smooth sample of the texture at these coordinates, times these alphas at the corners of its
    /// triangle, passes the test; nothing where the texels must be asked.
    #[inline]
    pub(crate) fn passes(&self, uv: Vec2, alphas: [f32; 3]) -> Option<bool> {
        if alphas != [self.factor; 3] || uv.is_nan() {
            return None;
        }
        self.of_texel(low_texel(self.size, self.wrap, uv))
    }

    /// What the test comes to for samples that read this texel first; nothing where the texels must be asked.
    #[inline]
    pub(crate) fn of_texel(&self, number: usize) -> Option<bool> {
        flags_say(self.bits[number / 4] >> (2 * (number % 4)) & 3)
    }

    /// The texels that four samples read first, for [`Self::of_texel`]; nothing where each must be asked by itself.
    #[inline]
    pub(crate) fn four_texels(&self, uvs: [Vec4; 2], alphas: [f32; 3]) -> Option<[u32; 4]> {
        if alphas != [self.factor; 3] {
            return None;
        }
        let [width, height] = self.size;
        let columns = texels_of(uvs[0] * width as f32 - 0.5, self.wrap[0], width)?;
        let rows = texels_of(uvs[1] * height as f32 - 0.5, self.wrap[1], height)?;
        let mut texels = columns;
        for (texel, row) in texels.iter_mut().zip(rows) {
            *texel += row * width;
        }
        Some(texels)
    }
}

fn flags_say(flags: u8) -> Option<bool> {
    match flags {
        PASSES => Some(true),
        FAILS => Some(false),
        _ => None,
    }
}

/// The texels that smooth samplers read first along an axis between two coordinates, and one on either side; nothing
/// where they go over the border of a texture that repeats, or are no numbers.
fn texels_between(coordinates: [f32; 2], wrap: Wrap, size: u32) -> Option<Range<u32>> {
    let [low, high] = coordinates.map(|at| at * size as f32 - 0.5);
    // NaN is neither.
    if !(low > -4_194_304.0 && high < 4_194_304.0) {
        return None;
    }
    let (first, end) = (floor(low) - 1, floor(high) + 2);
    let size = i64::from(size);
    let (first, end) = match wrap {
        Wrap::ClampToEdge => (first.clamp(0, size - 1), end.clamp(1, size)),
        Wrap::Repeat | Wrap::MirroredRepeat => {
            let before = first.div_euclid(size) * size;
            (first - before, end - before)
        }
    };
    (first < end && end <= size).then_some(first as u32..end as u32)
}

/// The whole numbers not above four values, wrapped; nothing where that takes a division, or for a value that is not
/// within 2^22 of 0.
#[inline]
fn texels_of(at: Vec4, wrap: Wrap, size: u32) -> Option<[u32; 4]> {
    /// Values of this size differ by 1 from one to the next: what is added to them is rounded.
    const WHOLE: f32 = 12_582_912.0;
    /// The bits of such a sum that hold the whole number.
    const NUMBER: u32 = (1 << 22) - 1;
    if !at.abs().cmplt(Vec4::splat(4_194_304.0)).all() {
        return None;
    }
    let nearest = (at + WHOLE) - WHOLE;
    let floor = nearest - Vec4::select(nearest.cmpgt(at), Vec4::ONE, Vec4::ZERO);
    let (floor, mask) = match wrap {
        _ if size > NUMBER => return None,
        Wrap::Repeat if size.is_power_of_two() => (floor, size - 1),
        Wrap::ClampToEdge => {
            let last = Vec4::splat((size - 1) as f32);
            (floor.max(Vec4::ZERO).min(last), NUMBER)
        }
        Wrap::Repeat | Wrap::MirroredRepeat => return None,
    };
    let [a, b, c, d] = (floor + WHOLE).to_array();
    let texel = |sum: f32| sum.to_bits() & mask;
    Some([texel(a), texel(b), texel(c), texel(d)])
}

/// The masks of what is drawn again and again.
#[derive(Debug, Default)]
pub(crate) struct CutMasks(Mutex<Vec<Known>>);

#[derive(Debug)]
struct Known {
    texture: Arc<Texture>,
    cutoff: f32,
    factor: f32,
    mask: Option<Arc<CutMask>>,
}

impl CutMasks {
    /// The mask of a material, made when it is first asked for; none of what is not cut out by a texture.
    pub(crate) fn of(&self, material: &Material) -> Option<Arc<CutMask>> {
        let cutoff = alpha_cutoff(material)?;
        let texture = material.texture.as_ref()?;
        let factor = material.base_color[3];
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |known: &&Known| {
            Arc::ptr_eq(&known.texture, texture) && [known.cutoff, known.factor] == [cutoff, factor]
        };
        if let Some(known) = all.iter().find(is_it) {
            return known.mask.clone();
        }
        let mask = CutMask::of(texture, cutoff, factor).map(Arc::new);
        // Textures that nobody else has are drawn no more.
        all.retain(|known| Arc::strong_count(&known.texture) > 1);
        all.push(Known {
            texture: Arc::clone(texture),
            cutoff,
            factor,
            mask: mask.clone(),
        });
        mask
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texel::sample_alpha;
    use proptest::prelude::*;
    use secateur_model::Filters;

    proptest! {
        #[test]
        fn four_texels_are_those_of_each_sample(
            us in prop::array::uniform4(-3.0f32..3.0),
            vs in prop::array::uniform4(-3.0f32..3.0),
            (width, height) in (1u32..40, 1u32..40),
            wraps in (0usize..3, 0usize..3),
        ) {
            let wraps = [WRAPS[wraps.0], WRAPS[wraps.1]];
            let mask = CutMask { size: [width, height], wrap: wraps, factor: 1.0, bits: Vec::new(), squares: Vec::new() };
            let uvs = [us, vs].map(Vec4::from_array);
            if let Some(texels) = mask.four_texels(uvs, [1.0; 3]) {
                for lane in 0..4 {
                    let expected = low_texel(mask.size, wraps, Vec2::new(us[lane], vs[lane]));
                    prop_assert_eq!(texels[lane] as usize, expected);
                }
            } else {
                let sizes = [width, height];
                let takes_a_division = (0..2).any(|axis| match wraps[axis] {
                    Wrap::Repeat => !sizes[axis].is_power_of_two(),
                    Wrap::MirroredRepeat => true,
                    Wrap::ClampToEdge => false,
                });
                prop_assert!(takes_a_division);
            }
        }
    }

    #[test]
    fn four_samples_far_off_are_asked_one_by_one() {
        let far = Vec4::new(0.0, 1.0, f32::NAN, 0.5);
        assert_eq!(texels_of(far, Wrap::ClampToEdge, 8), None);
        assert_eq!(texels_of(Vec4::splat(5e6), Wrap::ClampToEdge, 8), None);
    }

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::ClampToEdge, Wrap::MirroredRepeat];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// What a mask knows is what the texels say, in and beyond the texture, up to its very rims.
        #[test]
        fn what_is_sure_is_so(
            alphas in prop::collection::vec(
                prop_oneof![Just(0u8), Just(255), Just(127), Just(128)], 15
            ),
            wraps in [0usize..3, 0usize..3],
            factor in prop_oneof![Just(1.0f32), Just(0.9)],
        ) {
            let texture = Texture {
                width: 5,
                height: 3,
                rgba: alphas.iter().flat_map(|a| [9, 9, 9, *a]).collect(),
                wrap: wraps.map(|k| WRAPS[k]),
                filters: Filters::default(),
            };
            let mask = CutMask::of(&texture, 0.5, factor);
            let is_mirrored = texture.wrap.contains(&Wrap::MirroredRepeat);
            prop_assert_eq!(mask.is_none(), is_mirrored);
            let Some(mask) = mask else { return Ok(()) };
            for (x, y) in (-35..70).flat_map(|x| (-14..35).map(move |y| (x, y))) {
                // A seventh of a texel apart, so that some lie on the middles of texels.
                let uv = Vec2::new(x as f32 / 35.0, y as f32 / 21.0);
                if let Some(passes) = mask.passes(uv, [factor; 3]) {
                    prop_assert_eq!(passes, sample_alpha(Some(&texture), uv) * factor >= 0.5);
                }
            }
        }
    }

    #[test]
    fn even_textures_are_known_all_over_and_others_where_texels_agree() {
        let texture = |alpha: [u8; 4]| Texture {
            width: 4,
            height: 1,
            rgba: alpha.iter().flat_map(|a| [0, 0, 0, *a]).collect(),
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters::default(),
        };
        let at = |alpha: [u8; 4], u: f32| {
            let mask = CutMask::of(&texture(alpha), 0.5, 1.0).unwrap();
            mask.passes(Vec2::new(u, 0.5), [1.0; 3])
        };
        assert_eq!(at([255; 4], 0.3), Some(true));
        assert_eq!(at([0; 4], 7.0), Some(false));
        let half = [255, 255, 0, 0];
        assert_eq!(at(half, 0.2), Some(true));
        assert_eq!(at(half, 0.5), None);
        assert_eq!(at(half, 0.8), Some(false));
        // Corners with an alpha of their own, and no place at all, are left to the texels.
        let mask = CutMask::of(&texture([255; 4]), 0.5, 1.0).unwrap();
        assert_eq!(mask.passes(Vec2::ZERO, [1.0, 0.2, 1.0]), None);
        assert_eq!(mask.passes(Vec2::NAN, [1.0; 3]), None);
    }
}
