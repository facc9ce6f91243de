//! The filters of FLIP: what an eye sees of a picture from a distance, and how strong its edges and points are.
//!
//! Every filter is a sum of products of a filter along rows and one along columns. Borders are repeated outwards.

use super::PIXELS_PER_DEGREE;
use super::color::HypotOf;

/// What the exponents of lightness, red against green, and blue against yellow are divided by, in
/// degrees squared (table 1 of the paper).
pub(super) const LIGHTNESS_WIDTH: f32 = 0.0047;
pub(super) const RED_GREEN_WIDTH: f32 = 0.0053;
/// Blue against yellow has two, with their weights.
const BLUE_YELLOW: [(f32, f32); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Width of the filter that finds edges and points, in degrees.
const FEATURE_WIDTH: f32 = 0.082;

/// Pixels from the middle of the widest filter of the eye to its end: three standard deviations.
fn radius_px() -> usize {
    let widest = BLUE_YELLOW[0].1;
    (3.0 * deviation_px(widest)).ceil() as usize
}

/// The standard deviation of exp(-(pi x)^2 / width) in pixels.
fn deviation_px(width: f32) -> f32 {
    (width / 2.0).sqrt() / std::f32::consts::PI * PIXELS_PER_DEGREE
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
pub(super) fn gaussian(width: f32) -> Vec<f32> {
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
pub(super) fn blue_yellow(grid: &Grid, plane: &[f32]) -> Vec<f32> {
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

/// What the filters of edges, or of points, find in a plane along rows and along columns.
pub(super) struct Responses {
    pub(super) across: Vec<f32>,
    pub(super) down: Vec<f32>,
}

impl Responses {
    /// How strong they are, pixel by pixel.
    fn strengths(self) -> Vec<f32> {
        let pairs = self.across.into_iter().zip(self.down);
        pairs.map(|(across, down)| across.hypot_of(down)).collect()
    }
}

/// How strong edges and points are, pixel by pixel.
pub(super) fn features(grid: &Grid, grey: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let [edges, points] = responses(grid, grey);
    (edges.strengths(), points.strengths())
}

/// What the filters of edges and of points find in a plane. Both are linear, and find nothing in a plane of one
/// value.
pub(super) fn responses(grid: &Grid, grey: &[f32]) -> [Responses; 2] {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
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
    [edge, point].map(|kernel| Responses {
        across: grid.down(&grid.across(grey, &kernel), &smooth),
        down: grid.down(&smooth_across, &kernel),
    })
}

/// Where the values of a plane lie.
pub(super) struct Grid {
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Grid {
    pub(super) fn filtered(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
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
