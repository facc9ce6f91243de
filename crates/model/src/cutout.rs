//! Alpha cut-outs: the part of a leaf card that is leaf, as bits.

/// How a texture coordinate outside 0..1 finds its texel (glTF sampler
/// `wrapS`, `wrapT`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Wrap {
    /// glTF 10497: the texture repeats.
    Repeat = 0,
    /// glTF 33071: the border texel goes on.
    ClampToEdge = 1,
    /// glTF 33648: the texture repeats, every other time mirrored.
    MirroredRepeat = 2,
}

impl Wrap {
    /// The texel, `0..size`, that a texel coordinate of any sign stands for.
    /// `size` is a power of two. The twin in WGSL is `wrap_texel`.
    #[inline]
    pub fn texel(self, coordinate: i32, size: u32) -> u32 {
        let last = size as i32 - 1;
        match self {
            Wrap::Repeat => (coordinate & last) as u32,
            Wrap::ClampToEdge => coordinate.clamp(0, last) as u32,
            Wrap::MirroredRepeat => {
                let t = coordinate & (2 * last + 1);
                (if t > last { 2 * last + 1 - t } else { t }) as u32
            }
        }
    }
}

/// An alpha mask of `width` x `height` texels, one bit each: set where the
/// texture's alpha reaches the material's cutoff.
///
/// Sizes are powers of two, at most [`Cutout::MAX_SIZE`], so that texel
/// addresses stay small integers on every device; textures of other sizes are
/// resampled to the nearest texel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cutout {
    width: u32,
    height: u32,
    wrap: [Wrap; 2],
    /// Row by row from v = 0 downwards; texel t is bit `t % 32` of word `t / 32`.
    words: Vec<u32>,
}

impl Cutout {
    /// The largest width or height of a mask, in texels.
    pub const MAX_SIZE: u32 = 2048;

    /// A mask from a test of source texels.
    ///
    /// `source_size` is the texture's width and height (at least 1 x 1);
    /// `opaque(x, y)` says whether the texel in column `x` of row `y`, rows
    /// from the top, belongs to the leaf.
    ///
    /// # Panics
    /// If a side of `source_size` is zero.
    pub fn from_fn(
        source_size: [u32; 2],
        wrap: [Wrap; 2],
        mut opaque: impl FnMut(u32, u32) -> bool,
    ) -> Self {
        assert!(
            source_size[0] > 0 && source_size[1] > 0,
            "a texture has at least one texel"
        );
        let side = |n: u32| n.min(Self::MAX_SIZE).next_power_of_two();
        let (width, height) = (side(source_size[0]), side(source_size[1]));
        let source = |t: u32, n: u32, source_n: u32| {
            ((2 * u64::from(t) + 1) * u64::from(source_n) / (2 * u64::from(n))) as u32
        };
        let mut words = vec![0u32; (width as usize * height as usize).div_ceil(32)];
        for y in 0..height {
            for x in 0..width {
                if opaque(
                    source(x, width, source_size[0]),
                    source(y, height, source_size[1]),
                ) {
                    let texel = (y * width + x) as usize;
                    words[texel / 32] |= 1 << (texel % 32);
                }
            }
        }
        Self {
            width,
            height,
            wrap,
            words,
        }
    }

    /// Width in texels, a power of two.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels, a power of two.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How u and v wrap.
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// The bits, row by row from the top; texel t is bit `t % 32` of word `t / 32`.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// Whether the texel at these texel coordinates, wrapped, belongs to the leaf.
    #[inline]
    pub fn is_opaque(&self, u_texel: i32, v_texel: i32) -> bool {
        let x = self.wrap[0].texel(u_texel, self.width);
        let y = self.wrap[1].texel(v_texel, self.height);
        let texel = y * self.width + x;
        self.words[(texel / 32) as usize] >> (texel % 32) & 1 == 1
    }

    /// The share of texels that belong to the leaf, 0 to 1.
    pub fn coverage(&self) -> f64 {
        let set: u32 = self.words.iter().map(|w| w.count_ones()).sum();
        f64::from(set) / (f64::from(self.width) * f64::from(self.height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_follows_gltf() {
        let at = |wrap: Wrap| (-5..9).map(|c| wrap.texel(c, 4)).collect::<Vec<_>>();
        assert_eq!(at(Wrap::Repeat), [3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0]);
        assert_eq!(
            at(Wrap::ClampToEdge),
            [0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3]
        );
        assert_eq!(
            at(Wrap::MirroredRepeat),
            [3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0]
        );
    }

    #[test]
    fn other_sizes_take_the_nearest_texel() {
        // Three columns, the middle one solid, become four: texel centres at
        // 1/8, 3/8, 5/8, 7/8 fall into columns 0, 1, 1, 2.
        let mask = Cutout::from_fn([3, 1], [Wrap::Repeat; 2], |x, _| x == 1);
        let row: Vec<bool> = (0..4).map(|u| mask.is_opaque(u, 0)).collect();
        assert_eq!(row, [false, true, true, false]);
        assert_eq!(mask.coverage(), 0.5);
    }
}
