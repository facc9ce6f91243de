//! The filters of FLIP: what an eye sees of a picture from a distance, and how strong its edges and points are.
//!
//! Every filter is a sum of products of a filter along rows and one along columns. Borders are repeated outwards.

use std::ops::Range;

use glam::Vec4;

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
pub(crate) fn reach_px() -> usize {
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
    let radius = reach_px().min((5.7 * deviation).ceil() as usize) as i32;
    let value = |x: i32| (-0.5 * (x as f32 / deviation).powi(2)).exp();
    (-radius..=radius).map(value).collect()
}

/// A [`bell`] with a sum of 1.
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
#[derive(Clone, Debug)]
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

/// Side of the tiles of a plane that are filtered or left out, in pixels: no filter reaches farther than this.
const TILE_PX: usize = 16;

/// Where the values of a plane lie, and which of them are filtered.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    width: usize,
    height: usize,
    /// By row, the columns that are filtered, in runs of whole tiles.
    runs: Vec<Vec<Range<usize>>>,
    /// By row, the columns that a filter along columns reads for them.
    reached: Vec<Vec<Range<usize>>>,
}

impl Grid {
    /// All of a plane.
    pub(super) fn whole(width: usize, height: usize) -> Self {
        let of_row: Vec<Range<usize>> = (width > 0).then_some(0..width).into_iter().collect();
        let runs = vec![of_row; height];
        Self {
            width,
            height,
            reached: runs.clone(),
            runs,
        }
    }

    /// The tiles in which a plane is not 0, and those about them: whatever is 0 where this is stays 0 elsewhere.
    pub(super) fn about(width: usize, height: usize, plane: &[f32]) -> Self {
        let columns = width.div_ceil(TILE_PX);
        let mut is_near = vec![vec![false; columns]; height.div_ceil(TILE_PX)];
        for (y, row) in plane.chunks_exact(width.max(1)).enumerate() {
            for (column, tile) in row.chunks(TILE_PX).enumerate() {
                if tile.iter().any(|value| *value != 0.0) {
                    let tile_row = y / TILE_PX;
                    let rows = tile_row.saturating_sub(1)..(tile_row + 2).min(is_near.len());
                    for near in &mut is_near[rows] {
                        near[column.saturating_sub(1)..(column + 2).min(columns)].fill(true);
                    }
                }
            }
        }
        let of_rows = is_near.iter().map(|is_near| runs_of(is_near, width));
        let of_rows: Vec<Vec<Range<usize>>> = of_rows.collect();
        let runs: Vec<_> = (0..height).map(|y| of_rows[y / TILE_PX].clone()).collect();
        Self {
            width,
            height,
            reached: runs.clone(),
            runs,
        }
    }

    /// Some pixels of a plane, named row by row: in each row the tiles that have any.
    pub(super) fn at(width: usize, height: usize, pixels: &[u32]) -> Self {
        let columns = width.div_ceil(TILE_PX);
        let mut is_wanted = vec![vec![false; columns]; height];
        for pixel in pixels {
            let pixel = *pixel as usize;
            is_wanted[pixel / width][pixel % width / TILE_PX] = true;
        }
        let mut is_reached = vec![vec![false; columns]; height];
        for (y, is_wanted) in is_wanted.iter().enumerate() {
            let rows = y.saturating_sub(reach_px())..(y + reach_px() + 1).min(height);
            for column in (0..columns).filter(|column| is_wanted[*column]) {
                for is_reached in &mut is_reached[rows.clone()] {
                    is_reached[column] = true;
                }
            }
        }
        let [runs, reached] = [is_wanted, is_reached]
            .map(|rows| rows.iter().map(|row| runs_of(row, width)).collect());
        Self {
            width,
            height,
            runs,
            reached,
        }
    }

    /// The rows that are filtered, each with a run of its columns.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        each_run(&self.runs)
    }

    pub(super) fn filtered(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        self.down(&self.across(plane, kernel), kernel)
    }

    /// The plane filtered along each row; beyond a border its last pixel is repeated.
    fn across(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        let mut filtered = vec![0.0; plane.len()];
        let radius = kernel.len() / 2;
        let mut wide = vec![0.0; self.width + 2 * radius];
        for (y, run) in each_run(&self.reached) {
            let row = &plane[y * self.width..][..self.width];
            wide[..radius].fill(row[0]);
            wide[radius..radius + self.width].copy_from_slice(row);
            wide[radius + self.width..].fill(row[self.width - 1]);
            let filtered = &mut filtered[y * self.width..][..self.width];
            for (x, sums) in chunks(filtered, run) {
                weighted_sums(sums, kernel, |tap| &wide[x + tap..]);
            }
        }
        filtered
    }

    /// The plane filtered along each column; beyond a border its last pixel is repeated.
    fn down(&self, plane: &[f32], kernel: &[f32]) -> Vec<f32> {
        let mut filtered = vec![0.0; plane.len()];
        let radius = kernel.len() / 2;
        for (y, run) in self.rows() {
            let row = |tap: usize| (y + tap).saturating_sub(radius).min(self.height - 1);
            let filtered = &mut filtered[y * self.width..][..self.width];
            for (x, sums) in chunks(filtered, run) {
                weighted_sums(sums, kernel, |tap| &plane[row(tap) * self.width + x..]);
            }
        }
        filtered
    }
}

/// The columns of a row, `width` pixels wide, whose tiles are wanted.
fn runs_of(is_wanted: &[bool], width: usize) -> Vec<Range<usize>> {
    let alike = is_wanted.chunk_by(|a, b| a == b);
    let mut first = 0;
    let runs = alike.filter_map(|tiles| {
        let run = first * TILE_PX..((first + tiles.len()) * TILE_PX).min(width);
        first += tiles.len();
        tiles[0].then_some(run)
    });
    runs.collect()
}

/// Each run with its row.
fn each_run(rows: &[Vec<Range<usize>>]) -> impl Iterator<Item = (usize, Range<usize>)> {
    let rows = rows.iter().enumerate();
    rows.flat_map(|(y, runs)| runs.iter().map(move |run| (y, run.clone())))
}

/// A run of a row in chunks, each with its column.
fn chunks(row: &mut [f32], run: Range<usize>) -> impl Iterator<Item = (usize, &mut [f32])> {
    let columns = run.clone().step_by(TILE_PX);
    columns.zip(row[run].chunks_mut(TILE_PX))
}

/// The sums over all taps of a filter of its weights times the values at the tap.
#[inline]
fn weighted_sums<'a>(sums: &mut [f32], kernel: &[f32], values: impl Fn(usize) -> &'a [f32]) {
    let Some(sums) = sums.first_chunk_mut::<TILE_PX>() else {
        for (tap, weight) in kernel.iter().enumerate() {
            for (sum, value) in sums.iter_mut().zip(values(tap)) {
                *sum += weight * value;
            }
        }
        return;
    };
    // As many as registers hold.
    let mut fours = [Vec4::ZERO; TILE_PX / 4];
    for (tap, weight) in kernel.iter().enumerate() {
        let values = &values(tap)[..TILE_PX];
        for (sum, four) in fours.iter_mut().zip(values.chunks_exact(4)) {
            *sum += Vec4::from_slice(four) * *weight;
        }
    }
    for (four, sum) in sums.chunks_exact_mut(4).zip(fours) {
        sum.write_to_slice(four);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two spots, one at a corner, in a plane whose sides are no whole numbers of tiles.
    #[test]
    fn tiles_far_from_what_is_there_filter_to_nothing() {
        let [width, height] = [103, 90];
        let mut plane = vec![0.0; width * height];
        for (x, y) in [(40, 20), (41, 20), (40, 21), (102, 89), (101, 89)] {
            plane[y * width + x] = 0.3 + 0.01 * x as f32;
        }
        let near = Grid::about(width, height, &plane);
        let filtered_px: usize = near.rows().map(|(_, run)| run.len()).sum();
        assert!(filtered_px < width * height / 2, "{filtered_px}");
        let whole = Grid::whole(width, height);
        assert_eq!(features(&near, &plane), features(&whole, &plane));
        assert_eq!(blue_yellow(&near, &plane), blue_yellow(&whole, &plane));
        // At pixels that are asked for it is the same too, and elsewhere nothing is done.
        let pixels = [20 * width + 44, 25 * width + 47, 89 * width + 100];
        let some = Grid::at(width, height, &pixels.map(|pixel| pixel as u32));
        let of = |grid: &Grid| [features(grid, &plane).0, blue_yellow(grid, &plane)];
        for (own, all) in of(&some).iter().zip(of(&whole)) {
            assert!(pixels.iter().all(|k| own[*k] == all[*k] && all[*k] != 0.0));
        }
        assert_eq!(some.rows().count(), 3);
    }
}
