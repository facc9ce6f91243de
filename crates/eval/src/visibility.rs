//! The z-buffer: which triangle is frontmost at each sample.

mod bands;
mod cut;

use std::ops::Range;

use glam::{Vec2, Vec4};
use rayon::prelude::*;
use secateur_model::Surface;

pub(crate) use bands::{BandSamples, Bands, SeenRows};
pub(crate) use cut::{Alpha, Cut};

use crate::cut_mask::CutMasks;
use crate::lens::Lens;
use crate::mips::MipChains;
use crate::point_in_triangle::{EDGE_SLACK, PointInTriangle};
use crate::screen_triangle::ScreenTriangle;

/// Rows of samples that one task fills.
const BAND_ROWS: usize = 32;
/// Width and height of the blocks of samples that are skipped where all of them are nearer.
const BLOCK: usize = 8;
/// No triangle is in front.
pub(crate) const NOTHING: u32 = u32::MAX;

/// The frontmost triangle of every sample.
pub(crate) struct Visibility {
    pub(crate) width: usize,
    pub(crate) triangles: Vec<ScreenTriangle>,
    /// Row by row: a place in `triangles`, or [`NOTHING`].
    pub(crate) frontmost: Vec<u32>,
    /// Row by row: how near it is, negative infinity for [`NOTHING`].
    pub(crate) nearness: Vec<f32>,
}

impl Visibility {
    /// All rows of it.
    pub(crate) fn rows(&self) -> SeenRows<'_> {
        SeenRows {
            first_row: 0,
            width: self.width,
            frontmost: &self.frontmost,
        }
    }
}

/// Whether back faces of materials that are not double-sided are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Culling {
    /// Back faces of such materials are left out, as clients do.
    Material,
    /// All faces are drawn: what is culled still casts a shadow.
    None,
}

/// From what alpha is read.
#[derive(Clone, Copy, Default)]
pub(crate) struct AlphaFrom<'a> {
    /// Without them from the textures themselves.
    pub(crate) mips: Option<&'a MipChains>,
    /// What is known of these.
    pub(crate) masks: Option<&'a CutMasks>,
}

impl<'a> AlphaFrom<'a> {
    pub(crate) fn mips(mips: Option<&'a MipChains>) -> Self {
        Self { mips, masks: None }
    }

    pub(crate) fn masks(masks: &'a CutMasks) -> Self {
        let masks = Some(masks);
        Self { mips: None, masks }
    }
}

/// Draws surfaces through a lens. Corners run counterclockwise on a front face.
pub(crate) fn visibility(
    surfaces: &[&Surface],
    lens: &Lens,
    culling: Culling,
    alpha: AlphaFrom<'_>,
) -> Visibility {
    drawn(surfaces, lens, (culling, Seek::Frontmost), alpha)
}

/// By sample, row by row, whether a client draws anything there: as [`visibility`], but what is
/// covered is looked at no more.
pub(crate) fn outline(surfaces: &[&Surface], lens: &Lens, alpha: AlphaFrom<'_>) -> Vec<bool> {
    let seen = drawn(surfaces, lens, (Culling::Material, Seek::Any), alpha);
    let is_covered = seen.frontmost.iter().map(|index| *index != NOTHING);
    is_covered.collect()
}

/// Which triangle is sought at each sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seek {
    /// The one that hides all others.
    Frontmost,
    /// Whichever is found first.
    Any,
}

fn drawn(
    surfaces: &[&Surface],
    lens: &Lens,
    how: (Culling, Seek),
    alpha: AlphaFrom<'_>,
) -> Visibility {
    let bands = Bands::of(surfaces, lens, how, alpha, BAND_ROWS);
    let width = lens.width as usize;
    let samples = width * lens.height as usize;
    let mut frontmost = vec![NOTHING; samples];
    let mut nearness = vec![f32::NEG_INFINITY; samples];
    let band_samples = BAND_ROWS * width.max(1);
    frontmost
        .par_chunks_mut(band_samples)
        .zip(nearness.par_chunks_mut(band_samples))
        .enumerate()
        .for_each(|(band, samples)| bands.draw(band, samples));
    Visibility {
        width,
        triangles: bands.triangles,
        frontmost,
        nearness,
    }
}

/// Rows count downwards, so a front face runs clockwise on the raster.
pub(crate) fn is_front(triangle: &ScreenTriangle) -> bool {
    let [a, b, c] = triangle.corners.map(|corner| corner.at);
    (b - a).perp_dot(c - a) < 0.0
}

/// Some rows of the raster.
struct Band<'a> {
    first_row: usize,
    width: usize,
    seek: Seek,
    frontmost: &'a mut [u32],
    /// Infinite where no other triangle is sought.
    nearness: &'a mut [f32],
    /// Row by row of blocks, how near the farthest sample of each is: what is farther is hidden there.
    blocks: Vec<Block>,
}

/// What is known of a block of [`BLOCK`] x [`BLOCK`] samples.
#[derive(Clone, Copy)]
struct Block {
    /// Nothing in it is farther than this.
    farthest: f32,
    /// Whether something came nearer since.
    is_stale: bool,
}

impl<'a> Band<'a> {
    fn new(
        first_row: usize,
        width: usize,
        seek: Seek,
        (frontmost, nearness): (&'a mut [u32], &'a mut [f32]),
    ) -> Self {
        let empty = Block {
            farthest: f32::NEG_INFINITY,
            is_stale: false,
        };
        let block_rows = (nearness.len() / width.max(1)).div_ceil(BLOCK);
        Self {
            first_row,
            width,
            seek,
            frontmost,
            nearness,
            blocks: vec![empty; block_rows * width.div_ceil(BLOCK)],
        }
    }

    fn draw(&mut self, index: u32, triangle: &ScreenTriangle, surface: &Surface, alpha: Alpha<'_>) {
        let Some(place) = PointInTriangle::within(triangle) else {
            return;
        };
        // Most triangles are hidden: what is needed for a test is looked up where one is.
        let mut cutout = None;
        let [a, b, c] = triangle.corners.map(|corner| corner.at);
        let nearness = triangle.corners.map(|corner| corner.nearness);
        let lanes = Lanes { place, nearness };
        let nearest = nearest_of(nearness);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let rows = self.first_row..self.first_row + self.nearness.len() / self.width;
        let columns = sample_range(low.x, high.x, 0..self.width);
        let rows = sample_range(low.y, high.y, rows);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let rows = rows.start - self.first_row..rows.end - self.first_row;
        for block_row in rows.start / BLOCK..rows.end.div_ceil(BLOCK) {
            let rows = rows.start.max(block_row * BLOCK)..rows.end.min((block_row + 1) * BLOCK);
            for block_column in columns.start / BLOCK..columns.end.div_ceil(BLOCK) {
                if nearest < self.farthest_in(block_row, block_column) {
                    continue;
                }
                let first = block_column * BLOCK;
                let end = self.width.min(first + BLOCK);
                let in_block = columns.start.max(first)..columns.end.min(end);
                let on_raster = [rows.start, rows.end].map(|row| row + self.first_row);
                if place.misses(&in_block, on_raster[0]..on_raster[1]) {
                    continue;
                }
                let on_raster = on_raster[0]..on_raster[1];
                let cutout = cutout.get_or_insert_with(|| Cut::of(triangle, surface, alpha));
                let in_all = cutout.there_in_block(triangle, &place, &in_block, &on_raster);
                if in_all == Some(false) {
                    continue;
                }
                let in_box = (1u32 << (in_block.end - first)) - (1u32 << (in_block.start - first));
                let mut is_changed = false;
                for row in rows.clone() {
                    let start = row * self.width + first;
                    let known = &self.nearness[start..row * self.width + end];
                    let y = (row + self.first_row) as f32 + 0.5;
                    let found = lanes.at([first, row + self.first_row], known);
                    let mut sought = found.nearer & in_box;
                    // Of equally near triangles the first of the scene is seen, whichever is drawn first.
                    for lane in lanes_of(sought & found.equal) {
                        if index > self.frontmost[start + lane] {
                            sought &= !(1 << lane);
                        }
                    }
                    if sought == 0 {
                        continue;
                    }
                    let corner = Vec2::new(first as f32 + 0.5, y);
                    let there = match in_all {
                        Some(true) => sought,
                        _ => cutout.there(triangle, &place, corner, &found.weights, sought),
                    };
                    is_changed |= there != 0;
                    let near = found.near();
                    for lane in lanes_of(there) {
                        self.nearness[start + lane] = match self.seek {
                            Seek::Frontmost => near[lane],
                            Seek::Any => f32::INFINITY,
                        };
                        self.frontmost[start + lane] = index;
                    }
                }
                let block = block_row * self.width.div_ceil(BLOCK) + block_column;
                self.blocks[block].is_stale |= is_changed;
            }
        }
    }

    /// How near the farthest sample of a block is.
    fn farthest_in(&mut self, block_row: usize, block_column: usize) -> f32 {
        let number = block_row * self.width.div_ceil(BLOCK) + block_column;
        if self.blocks[number].is_stale {
            let columns = block_column * BLOCK..self.width.min((block_column + 1) * BLOCK);
            let rows = self.nearness.chunks(self.width);
            let rows = rows.skip(block_row * BLOCK).take(BLOCK);
            let samples = rows.flat_map(|row| &row[columns.clone()]);
            self.blocks[number] = Block {
                farthest: samples.copied().fold(f32::INFINITY, f32::min),
                is_stale: false,
            };
        }
        self.blocks[number].farthest
    }
}

/// A triangle, looked at in several samples of a row at a time: the processor does four of them in the
/// time of one.
struct Lanes {
    place: PointInTriangle,
    nearness: [f32; 3],
}

/// What a triangle is at up to [`BLOCK`] samples that follow each other.
struct LanesFound {
    /// A bit for each sample in the triangle at which it is as near as what is known, or nearer.
    nearer: u32,
    /// A bit for each of these at which it is as near.
    equal: u32,
    /// How near the triangle is, four samples a vector.
    nearness: [Vec4; BLOCK / 4],
    /// The barycentric weight of each corner, four samples a vector.
    weights: [[Vec4; 3]; BLOCK / 4],
}

impl LanesFound {
    /// How near the triangle is at each sample.
    fn near(&self) -> [f32; BLOCK] {
        let mut near = [0.0; BLOCK];
        for (near, four) in near.chunks_exact_mut(4).zip(self.nearness) {
            four.write_to_slice(near);
        }
        near
    }
}

/// The places of the bits that are set, the lowest first.
fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}

impl Lanes {
    /// What the triangle is at `known.len()` samples of a row, from this column and row of the raster on.
    /// `known` is the nearness that is drawn at each; where it is infinite the triangle is never nearer.
    #[inline]
    fn at(&self, [column, row]: [usize; 2], known: &[f32]) -> LanesFound {
        let PointInTriangle {
            origin,
            second,
            third,
        } = self.place;
        let down = row as f32 + 0.5 - origin.y;
        let behind: [f32; BLOCK] = known.try_into().unwrap_or_else(|_| {
            let mut behind = [f32::INFINITY; BLOCK];
            behind[..known.len()].copy_from_slice(known);
            behind
        });
        let mut found = LanesFound {
            nearer: 0,
            equal: 0,
            nearness: [Vec4::ZERO; BLOCK / 4],
            weights: [[Vec4::ZERO; 3]; BLOCK / 4],
        };
        for half in 0..BLOCK / 4 {
            let columns = Vec4::new(0.5, 1.5, 2.5, 3.5) + (column + 4 * half) as f32;
            let right = columns - origin.x;
            // In the order of `PointInTriangle::weights`, so that both round alike.
            let of_second = right * second.x + second.y * down;
            let of_third = right * third.x + third.y * down;
            let of_first = Vec4::ONE - of_second - of_third;
            let near = of_first * self.nearness[0]
                + of_second * self.nearness[1]
                + of_third * self.nearness[2];
            let behind = Vec4::from_slice(&behind[4 * half..]);
            let least = of_first.min(of_second).min(of_third);
            let is_nearer = least.cmpge(Vec4::splat(EDGE_SLACK))
                & near.cmpge(behind)
                & behind.cmplt(Vec4::INFINITY);
            found.nearer |= is_nearer.bitmask() << (4 * half);
            found.equal |= (is_nearer & near.cmpeq(behind)).bitmask() << (4 * half);
            found.nearness[half] = near;
            found.weights[half] = [of_first, of_second, of_third];
        }
        found
    }
}

/// At least as near as any sample of a triangle of these corners, rounding included.
fn nearest_of(corners: [f32; 3]) -> f32 {
    let nearest = corners.into_iter().fold(f32::MIN, f32::max);
    let largest = corners.into_iter().map(f32::abs).fold(0.0, f32::max);
    nearest + 1e-4 * largest
}

/// The samples whose centres lie between two coordinates, within a range.
pub(crate) fn sample_range(low: f32, high: f32, within: Range<usize>) -> Range<usize> {
    let first = ((low - 0.5).floor().max(0.0) as usize).max(within.start);
    let end = ((high + 0.5).ceil().max(0.0) as usize).min(within.end);
    first..end.max(first)
}

fn weighted(values: [f32; 3], weights: [f32; 3]) -> f32 {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

#[cfg(test)]
mod tests;
