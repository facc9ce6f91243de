//! FLIP (Andersson et al., FLIP: A Difference Evaluator for Alternating Images, HPG 2020) of pictures
//! that are compared more than once.
//!
//! Most of FLIP is done to each picture by itself: it is filtered as an eye does at a distance, its
//! colours become those of a uniform space, and its edges and points are found. Here that is done once
//! a picture. All filters are sums of products of a filter along rows and one along columns, and
//! borders are repeated outwards. The reference implementation (`nv-flip`), which does all of it for
//! each pair, is the judge of the tests.

use image::RgbaImage;
use nv_flip::DEFAULT_PIXELS_PER_DEGREE;

/// What the exponents of lightness, red against green, and blue against yellow are divided by, in
/// degrees squared (table 1 of the paper).
const LIGHTNESS_WIDTH: f32 = 0.0047;
const RED_GREEN_WIDTH: f32 = 0.0053;
/// Blue against yellow has two, with their weights.
const BLUE_YELLOW: [(f32, f32); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Width of the filter that finds edges and points, in degrees.
const FEATURE_WIDTH: f32 = 0.082;

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

/// A picture as FLIP sees it, one value a pixel in each list, row by row.
#[derive(Clone, Debug)]
pub(crate) struct FlipPicture {
    size: [u32; 2],
    /// L*, and a* and b* as far as the eye tells them apart at that lightness (Hunt).
    lightness: Vec<f32>,
    red_green: Vec<f32>,
    blue_yellow: Vec<f32>,
    edges: Vec<f32>,
    points: Vec<f32>,
}

impl FlipPicture {
    /// Of a picture without transparency, at the usual 67 pixels a degree.
    pub(crate) fn of(image: &RgbaImage) -> Self {
        let grid = Grid {
            width: image.width() as usize,
            height: image.height() as usize,
        };
        let colors = Colors::new();
        let [mut y, mut cx, mut cz] = colors.opponent(image);
        let mut grey = y.clone();
        for value in &mut grey {
            *value = (*value + 16.0) / 116.0;
        }
        let (edges, points) = features(&grid, &grey);
        y = grid.filtered(&y, &gaussian(LIGHTNESS_WIDTH));
        cx = grid.filtered(&cx, &gaussian(RED_GREEN_WIDTH));
        cz = blue_yellow(&grid, &cz);
        for ((y, cx), cz) in y.iter_mut().zip(&mut cx).zip(&mut cz) {
            [*y, *cx, *cz] = colors.hunt_lab(colors.rgb_of_opponent([*y, *cx, *cz]));
        }
        Self {
            size: [image.width(), image.height()],
            lightness: y,
            red_green: cx,
            blue_yellow: cz,
            edges,
            points,
        }
    }

    /// Mean FLIP of one against the other.
    ///
    /// # Panics
    /// If they are of other sizes, or of none.
    pub(crate) fn mean_error(&self, other: &Self) -> f64 {
        assert_eq!(self.size, other.size, "one size");
        assert!(!self.edges.is_empty(), "at least one pixel");
        let scale = ColorScale::new();
        let mut sum = 0.0;
        for k in 0..self.edges.len() {
            let lightness = (self.lightness[k] - other.lightness[k]).abs();
            let color = (self.red_green[k] - other.red_green[k])
                .hypot_of(self.blue_yellow[k] - other.blue_yellow[k]);
            let difference = lightness + color;
            // Where colours are the same FLIP is 0, whatever the edges are.
            if difference == 0.0 {
                continue;
            }
            let color = scale.of(difference);
            let edge = (self.edges[k] - other.edges[k]).abs();
            let point = (self.points[k] - other.points[k]).abs();
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            sum += f64::from(color.powf(1.0 - feature));
        }
        sum / self.edges.len() as f64
    }
}

trait HypotOf {
    /// The root of the sum of both squares: values are far from the ends of the range.
    fn hypot_of(self, other: Self) -> Self;
}

impl HypotOf for f32 {
    fn hypot_of(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
}

/// Colour differences spread over 0 to 1.
struct ColorScale {
    largest: f32,
    end_of_small: f32,
}

impl ColorScale {
    fn new() -> Self {
        let colors = Colors::new();
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| colors.hunt_lab(rgb));
        let color = (green[1] - blue[1]).hypot_of(green[2] - blue[2]);
        let largest = ((green[0] - blue[0]).abs() + color).powf(COLOR_EXPONENT);
        Self {
            largest,
            end_of_small: SMALL * largest,
        }
    }

    fn of(&self, difference: f32) -> f32 {
        let difference = difference.powf(COLOR_EXPONENT);
        if difference < self.end_of_small {
            return difference * (MOST_OF_SMALL / self.end_of_small);
        }
        let beyond = (difference - self.end_of_small) / (self.largest - self.end_of_small);
        MOST_OF_SMALL + beyond * (1.0 - MOST_OF_SMALL)
    }
}

/// Ways between spaces of colours.
struct Colors {
    linear: [f32; 256],
    xyz_from_rgb: [[f32; 3]; 3],
    rgb_from_xyz: [[f32; 3]; 3],
    /// White (D65) in XYZ, by which colours are divided before they become L*a*b*.
    white: [f32; 3],
}

impl Colors {
    fn new() -> Self {
        let linear = |byte: usize| {
            let s = byte as f64 / 255.0;
            let linear = match s <= 0.04045 {
                true => s / 12.92,
                false => ((s + 0.055) / 1.055).powf(2.4),
            };
            linear as f32
        };
        let inverse = glam::DMat3::from_cols_array_2d(&XYZ_FROM_RGB).inverse();
        Self {
            linear: std::array::from_fn(linear),
            xyz_from_rgb: XYZ_FROM_RGB.map(|row| row.map(|x| x as f32)),
            rgb_from_xyz: inverse.to_cols_array_2d().map(|row| row.map(|x| x as f32)),
            white: XYZ_FROM_RGB.map(|row| row.iter().sum::<f64>() as f32),
        }
    }

    /// The planes of a space of opponent colours that is linear in light: lightness, red against
    /// green, blue against yellow.
    fn opponent(&self, image: &RgbaImage) -> [Vec<f32>; 3] {
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
    fn relative_xyz(&self, rgb: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = product(&self.xyz_from_rgb, rgb);
        [x / self.white[0], y / self.white[1], z / self.white[2]]
    }

    /// Back from opponent colours, as far as a screen shows them.
    fn rgb_of_opponent(&self, [y, cx, cz]: [f32; 3]) -> [f32; 3] {
        let y = (y + 16.0) / 116.0;
        let [x, z] = [y + cx / 500.0, y - cz / 200.0];
        let xyz = [x * self.white[0], y * self.white[1], z * self.white[2]];
        product(&self.rgb_from_xyz, xyz).map(|x| x.clamp(0.0, 1.0))
    }

    /// L*a*b*, with a* and b* the less the darker it is.
    fn hunt_lab(&self, rgb: [f32; 3]) -> [f32; 3] {
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

/// Pixels from the middle of the widest filter of the eye to its end: three standard deviations.
fn radius_px() -> usize {
    let widest = BLUE_YELLOW[0].1;
    (3.0 * deviation_px(widest)).ceil() as usize
}

/// The standard deviation of exp(-(pi x)^2 / width) in pixels.
fn deviation_px(width: f32) -> f32 {
    (width / 2.0).sqrt() / std::f32::consts::PI * DEFAULT_PIXELS_PER_DEGREE
}

/// exp(-(pi x)^2 / width) at whole pixels, up to where it is less than 1e-7 of its middle, or the eye's
/// widest filter ends.
fn bell(width: f32) -> Vec<f32> {
    let deviation = deviation_px(width);
    let radius = radius_px().min((5.7 * deviation).ceil() as usize) as i32;
    let value = |x: i32| (-0.5 * (x as f32 / deviation).powi(2)).exp();
    (-radius..=radius).map(value).collect()
}

/// The same, with a sum of 1.
fn gaussian(width: f32) -> Vec<f32> {
    scaled(bell(width), |kernel| kernel.iter().sum())
}

fn scaled(mut kernel: Vec<f32>, sum: impl Fn(&[f32]) -> f32) -> Vec<f32> {
    let sum = sum(&kernel);
    for weight in &mut kernel {
        *weight /= sum;
    }
    kernel
}

/// Blue against yellow, filtered by the sum of two bells.
fn blue_yellow(grid: &Grid, plane: &[f32]) -> Vec<f32> {
    let bells = BLUE_YELLOW.map(|(weight, width)| {
        let height = weight * (std::f32::consts::PI / width).sqrt();
        (height, bell(width))
    });
    // Of each, summed over rows and columns.
    let total = |(height, bell): &(f32, Vec<f32>)| height * bell.iter().sum::<f32>().powi(2);
    let all: f32 = bells.iter().map(total).sum();
    let mut sum = vec![0.0; plane.len()];
    for (height, bell) in &bells {
        let filtered = grid.filtered(plane, bell);
        for (sum, value) in sum.iter_mut().zip(filtered) {
            *sum += value * (height / all);
        }
    }
    sum
}

/// How strong edges and points are, pixel by pixel.
fn features(grid: &Grid, grey: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let deviation = 0.5 * FEATURE_WIDTH * DEFAULT_PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let kernel = |value: &dyn Fn(f32, f32) -> f32| -> Vec<f32> {
        let at = |x: i32| {
            let x = x as f32 / deviation;
            value(x, (-0.5 * x * x).exp())
        };
        (-radius..=radius).map(at).collect()
    };
    let smooth = scaled(kernel(&|_, bell| bell), |k| k.iter().sum());
    let positive = |k: &[f32]| k.iter().filter(|w| **w > 0.0).sum();
    let edge = scaled(kernel(&|x, bell| -x * bell), positive);
    let mut point = kernel(&|x, bell| (x * x - 1.0) * bell);
    // What is above zero and what is below come to 1 each.
    let (above, below) = (
        positive(&point),
        -point.iter().filter(|w| **w < 0.0).sum::<f32>(),
    );
    for weight in &mut point {
        *weight /= if *weight > 0.0 { above } else { below };
    }
    let smooth_across = grid.across(grey, &smooth);
    let strength = |kernel: &[f32]| {
        let mut across = grid.down(&grid.across(grey, kernel), &smooth);
        let down = grid.down(&smooth_across, kernel);
        for (across, down) in across.iter_mut().zip(down) {
            *across = across.hypot_of(down);
        }
        across
    };
    (strength(&edge), strength(&point))
}

/// Where the values of a plane lie.
struct Grid {
    width: usize,
    height: usize,
}

impl Grid {
    fn filtered(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        self.down(&self.across(plane, kernel), kernel)
    }

    /// The plane filtered along each row; beyond a border its last pixel is repeated.
    fn across(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        let mut filtered = vec![0.0; plane.len()];
        let radius = kernel.len() / 2;
        let mut wide = vec![0.0; self.width + 2 * radius];
        let rows = plane.chunks_exact(self.width.max(1));
        for (row, filtered) in rows.zip(filtered.chunks_exact_mut(self.width.max(1))) {
            wide[..radius].fill(row[0]);
            wide[radius..radius + self.width].copy_from_slice(row);
            wide[radius + self.width..].fill(row[self.width - 1]);
            for (first, weight) in kernel.iter().enumerate() {
                add(filtered, &wide[first..first + self.width], *weight);
            }
        }
        filtered
    }

    /// The plane filtered along each column; beyond a border its last pixel is repeated.
    fn down(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        let mut filtered = vec![0.0; plane.len()];
        let radius = kernel.len() / 2;
        for (y, filtered) in filtered.chunks_exact_mut(self.width.max(1)).enumerate() {
            for (k, weight) in kernel.iter().enumerate() {
                let row = (y + k).saturating_sub(radius).min(self.height - 1);
                add(filtered, &plane[row * self.width..][..self.width], *weight);
            }
        }
        filtered
    }
}

fn add(sums: &mut [f32], values: &[f32], weight: f32) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use image::Rgba;

    use super::super::flip_mean;
    use super::*;

    /// Blobs of any colours before a gradient.
    fn picture(seed: u32, [width, height]: [u32; 2]) -> RgbaImage {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 16
        };
        let mut image = RgbaImage::from_fn(width, height, |x, y| {
            Rgba([
                200 + (x * 40 / width) as u8,
                210,
                250 - (y * 90 / height) as u8,
                255,
            ])
        });
        for _ in 0..(width * height / 1000).max(60) {
            let (left, top, side) = (next() % width, next() % height, 1 + next() % 9);
            let color = Rgba([next() as u8, next() as u8, next() as u8, 255]);
            for (x, y) in (left..left + side).flat_map(|x| (top..top + side).map(move |y| (x, y))) {
                if x < width && y < height {
                    image.put_pixel(x, y, color);
                }
            }
        }
        image
    }

    #[test]
    fn means_are_those_of_the_reference_implementation() {
        for (seed, size) in [
            (1, [64, 64]),
            (2, [97, 41]),
            (3, [256, 256]),
            (4, [9, 7]),
            (5, [512, 512]),
        ] {
            let [a, b] = [picture(seed, size), picture(seed + 100, size)];
            let ours = FlipPicture::of(&a).mean_error(&FlipPicture::of(&b));
            let theirs = flip_mean(&a, &b);
            assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
            assert!(theirs > 0.05);
        }
        let [black, white] = [0, 255].map(|v| RgbaImage::from_pixel(32, 32, Rgba([v, v, v, 255])));
        let [ours, theirs] = [
            FlipPicture::of(&black).mean_error(&FlipPicture::of(&white)),
            flip_mean(&black, &white),
        ];
        assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
    }

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let one = FlipPicture::of(&picture(5, [48, 48]));
        assert_eq!(one.mean_error(&one), 0.0);
    }
}
