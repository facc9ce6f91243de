//! Colours as FLIP compares them.

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

    pub(super) fn of(&self, difference: f32) -> f32 {
        let difference = difference.powf(COLOR_EXPONENT);
        if difference < self.end_of_small {
            return difference * (MOST_OF_SMALL / self.end_of_small);
        }
        let beyond = (difference - self.end_of_small) / (self.largest - self.end_of_small);
        MOST_OF_SMALL + beyond * (1.0 - MOST_OF_SMALL)
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
        const KNEE: f32 = 6.0 / 29.0;
        let root = |t: f32| match t > KNEE * KNEE * KNEE {
            true => t.cbrt(),
            false => t / (3.0 * KNEE * KNEE) + 4.0 / 29.0,
        };
        let [x, y, z] = self.relative_xyz(rgb).map(root);
        let lightness = 116.0 * y - 16.0;
        let [a, b] = [500.0 * (x - y), 200.0 * (y - z)].map(|c| 0.01 * lightness * c);
        [lightness, a, b]
    }
}

fn product(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}
