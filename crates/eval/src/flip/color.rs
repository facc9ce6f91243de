//! Colours as FLIP compares them.

use glam::Vec3A;
use image::RgbaImage;

use crate::LINEAR_FROM_SRGB;

/// The exponent of colour differences.
const COLOR_EXPONENT: f32 = 0.7;
/// Colour differences up to this share of the largest make up [`MOST_OF_SMALL`] of the range.
const SMALL: f32 = 0.4;
const MOST_OF_SMALL: f32 = 0.95;

/// Linear RGB of sRGB's primaries to XYZ (D65).
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

pub(super) trait HypotOf {
    /// The root of the sum of both squares: values are far from the ends of the range.
    fn hypot_of(self, other: Self) -> Self;
}

impl HypotOf for f32 {
    fn hypot_of(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
}

/// Colour differences spread over 0 to 1.
pub(super) struct ColorScale {
    largest: f32,
    end_of_small: f32,
}

impl ColorScale {
    pub(super) fn new() -> Self {
        let colors = Colors::new();
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| colors.hunt_lab(rgb));
        let color = (green[1] - blue[1]).hypot_of(green[2] - blue[2]);
        let largest = ((green[0] - blue[0]).abs() + color).powf(COLOR_EXPONENT);
        Self {
            largest,
            end_of_small: SMALL * largest,
        }
    }

    pub(super) fn of<const N: usize>(&self, differences: [f32; N]) -> [f32; N] {
        differences.map(|difference| {
            let difference = power(difference, COLOR_EXPONENT);
            let small = difference * (MOST_OF_SMALL / self.end_of_small);
            let beyond = (difference - self.end_of_small) / (self.largest - self.end_of_small);
            let large = MOST_OF_SMALL + beyond * (1.0 - MOST_OF_SMALL);
            if difference < self.end_of_small {
                small
            } else {
                large
            }
        })
    }
}

/// Ways between spaces of colours.
pub(super) struct Colors {
    linear: [f32; 256],
    xyz_from_rgb: [[f32; 3]; 3],
    rgb_from_xyz: [[f32; 3]; 3],
    /// White (D65) in XYZ, by which colours are divided before they become L*a*b*.
    white: [f32; 3],
}

impl Colors {
    pub(super) fn new() -> Self {
        let inverse = glam::DMat3::from_cols_array_2d(&XYZ_FROM_RGB).inverse();
        Self {
            linear: *LINEAR_FROM_SRGB,
            xyz_from_rgb: XYZ_FROM_RGB.map(|row| row.map(|x| x as f32)),
            rgb_from_xyz: inverse.to_cols_array_2d().map(|row| row.map(|x| x as f32)),
            white: XYZ_FROM_RGB.map(|row| row.iter().sum::<f64>() as f32),
        }
    }

    /// The planes of a space of opponent colours that is linear in light: lightness, red against
    /// green, blue against yellow.
    pub(super) fn opponent(&self, image: &RgbaImage) -> [Vec<f32>; 3] {
        let mut planes = [(); 3].map(|()| Vec::with_capacity(image.len() / 4));
        for pixel in image.pixels() {
            let [r, g, b, _] = pixel.0.map(|byte| self.linear[usize::from(byte)]);
            let [x, y, z] = self.relative_xyz([r, g, b]);
            let opponent = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
            for (plane, value) in planes.iter_mut().zip(opponent) {
                plane.push(value);
            }
        }
        planes
    }

    /// XYZ over that of white.
    pub(super) fn relative_xyz(&self, rgb: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = product(&self.xyz_from_rgb, rgb);
        [x / self.white[0], y / self.white[1], z / self.white[2]]
    }

    /// Back from opponent colours, as far as a screen shows them.
    pub(super) fn rgb_of_opponent(&self, [y, cx, cz]: [f32; 3]) -> [f32; 3] {
        let y = (y + 16.0) / 116.0;
        let [x, z] = [y + cx / 500.0, y - cz / 200.0];
        let xyz = [x * self.white[0], y * self.white[1], z * self.white[2]];
        product(&self.rgb_from_xyz, xyz).map(|x| x.clamp(0.0, 1.0))
    }

    /// L*a*b*, with a* and b* the less the darker it is.
    pub(super) fn hunt_lab(&self, rgb: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = lab_roots(self.relative_xyz(rgb));
        let lightness = 116.0 * y - 16.0;
        let [a, b] = [500.0 * (x - y), 200.0 * (y - z)].map(|c| 0.01 * lightness * c);
        [lightness, a, b]
    }
}

/// a* and b* of linear light as [`Colors::hunt_lab`] has them.
pub(crate) fn chroma(light: impl Iterator<Item = [f32; 3]>) -> Vec<[f32; 2]> {
    let colors = Colors::new();
    let of = |rgb| {
        let [_, a, b] = colors.hunt_lab(rgb);
        [a, b]
    };
    light.map(of).collect()
}

/// What L*a*b* takes of parts of white's XYZ: cube roots, and a line where it is dark. Two steps of Halley's make
/// the roots of a first guess exact to the last bit or two.
fn lab_roots(parts: [f32; 3]) -> [f32; 3] {
    const KNEE: f32 = 6.0 / 29.0;
    /// Of the bits of 1, two thirds, less what makes the error of the guess even.
    const GUESS: u32 = 709_921_077;
    let parts = Vec3A::from_array(parts);
    let guess = parts
        .to_array()
        .map(|t| f32::from_bits(t.to_bits() / 3 + GUESS));
    let mut root = Vec3A::from_array(guess);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * parts) / (2.0 * cube + parts);
    }
    let line = parts / (3.0 * KNEE * KNEE) + 4.0 / 29.0;
    let is_bright = parts.cmpgt(Vec3A::splat(KNEE * KNEE * KNEE));
    Vec3A::select(is_bright, root, line).to_array()
}

/// A positive number to a power, within some millionths, in a fraction of the time of `f32::powf`, and with the same
/// bits on every machine.
#[inline]
pub(super) fn power(base: f32, exponent: f32) -> f32 {
    exp2(exponent * log2(base))
}

/// The binary logarithm of a positive number.
#[inline]
fn log2(value: f32) -> f32 {
    const SIGNIFICAND: u32 = (1 << 23) - 1;
    /// The bits of the root of a half: significands are taken from it to twice that.
    const LEAST: u32 = 0x3f35_04f3;
    let bits = value.max(f32::MIN_POSITIVE).to_bits();
    let exponent = (bits.wrapping_sub(LEAST) as i32) >> 23;
    let near_one = f32::from_bits((bits.wrapping_sub(LEAST) & SIGNIFICAND) + LEAST);
    // ln m = 2 artanh((m - 1) / (m + 1)).
    let s = (near_one - 1.0) / (near_one + 1.0);
    let t = s * s;
    let series = 1.0 + t * (1.0 / 3.0 + t * (0.2 + t * (1.0 / 7.0 + t / 9.0)));
    exponent as f32 + 2.0 * std::f32::consts::LOG2_E * s * series
}

/// 2 to a power of -126 to 127.
#[inline]
fn exp2(power: f32) -> f32 {
    let power = power.clamp(-126.0, 127.0);
    let whole = (power + 127.5) as i32 - 127;
    let rest = (power - whole as f32) * std::f32::consts::LN_2;
    let series = 1.0
        + rest
            * (1.0
                + rest / 2.0
                    * (1.0
                        + rest / 3.0
                            * (1.0
                                + rest / 4.0
                                    * (1.0
                                        + rest / 5.0 * (1.0 + rest / 6.0 * (1.0 + rest / 7.0))))));
    series * f32::from_bits(((whole + 127) as u32) << 23)
}

fn product(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_and_roots_are_near_those_of_the_library() {
        for k in 1..4000 {
            let base = 1e-6 * 1.005f32.powi(k);
            for exponent in [0.0, 0.3, COLOR_EXPONENT, 1.0] {
                let ratio = power(base, exponent) / base.powf(exponent);
                assert!((ratio - 1.0).abs() < 5e-6, "{base} {exponent}: {ratio}");
            }
        }
        for k in 0..2000 {
            let part = k as f32 / 1900.0;
            let [root, ..] = lab_roots([part, 0.5, 1.0]);
            let expected = match part > 0.008_856_452 {
                true => part.cbrt(),
                false => part * 7.787_037 + 0.137_931_03,
            };
            assert!((root - expected).abs() < 5e-7, "{part}: {root} {expected}");
        }
        assert_eq!(power(0.0, 0.0), 1.0);
    }
}
