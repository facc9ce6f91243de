//! The smallest triangle around what a texture shows on a card.

use std::ops::Range;

use glam::DVec2;
use rustc_hash::FxHashMap;
use secateur_model::{Cutout, Wrap};

use super::k_dop::{GridTriangle, directions, side_triples};

/// Largest number of a texture's repetitions along a card's side; cards with more stay as they are.
const MAX_REPEATS: f64 = 4.0;

/// Largest texture coordinate of a triangle: beyond it the raster is not exact.
const MAX_UV: f64 = 6.0;

/// One part in 100 of the cells that the triangle shows may be none of the card's, if the texture
/// does not repeat: there its border goes on, and a stem gets a little longer. In a texture that
/// repeats they would be specks in the air.
const WRONG_PART: usize = 100;

/// Part of the card's cells, one in this many, that each side of the triangle may cut off. Tried
/// in this order, so that tips are cut only where no triangle holds them without showing
/// something else.
const CUT_PARTS: [usize; 6] = [usize::MAX, 800, 400, 200, 100, 64];

/// How many triangles, the smallest first, are counted for the cells that they show wrongly.
const MAX_CANDIDATES: usize = 4096;

/// A triangle that shows less wrong may have this many times the area of another.
const MAX_AREA_RATIO: f64 = 1.25;

/// Samples along each side of a cell. With four, no texel is missed if a cell is at most four
/// texels wide, nor where cells and texels lie askew.
const SAMPLES_PER_CELL_SIDE: usize = 4;

/// The texels along an axis under the samples of a cell.
type SampleTexels = [i32; SAMPLES_PER_CELL_SIDE];

/// How far a triangle may reach beyond the card on each side, in widths of the card.
const MAX_REACH_CARDS: i64 = 2;

/// Barycentric coordinates of a point in the plane of a triangle; they sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weights(pub(super) [f64; 3]);

impl Weights {
    /// The coordinates of a point; not finite if the triangle has no area.
    pub(super) fn of(triangle: &[DVec2; 3], point: DVec2) -> Self {
        let [a, b, c] = *triangle;
        let area = (b - a).perp_dot(c - a);
        let y = (point - a).perp_dot(c - a) / area;
        let z = (b - a).perp_dot(point - a) / area;
        Self([1.0 - y - z, y, z])
    }

    pub(super) fn at(self, triangle: &[DVec2; 3]) -> DVec2 {
        let pairs = self.0.iter().zip(triangle);
        pairs.map(|(weight, corner)| *weight * *corner).sum()
    }

    fn is_within(self) -> bool {
        self.0.iter().all(|weight| *weight >= -1e-9)
    }
}

/// A card's triangles in texture space, and the mask that says what they show.
pub(super) struct CardTexture<'a> {
    /// Texture coordinates of the card's triangles, at least one.
    pub(super) triangles: Vec<[DVec2; 3]>,
    pub(super) mask: &'a Cutout,
}

/// A triangle that shows what the card shows and hardly more; none if there is no such triangle.
/// Its corners are weights of the corners of the card's first triangle, and it faces the same
/// side. The card is divided into at most `cells_per_side` cells along each side.
pub(super) fn enclosing_triangle(
    texture: &CardTexture<'_>,
    cells_per_side: usize,
) -> Option<[Weights; 3]> {
    let grid = CellGrid::of(texture, cells_per_side)?;
    let seen = grid.seen(texture);
    let right = seen.iter().filter(|is_seen| **is_seen).count();
    let repeats = texture.mask.wrap() != [Wrap::ClampToEdge; 2];
    let most_wrong = if repeats { 0 } else { right / WRONG_PART };
    let foreign = grid.foreign(texture, &seen, repeats);
    let reach_counts = grid.reach_counts(&seen);
    let best = CUT_PARTS.iter().find_map(|part| {
        let beyond = (right / part) as u32;
        let reach: Option<Vec<i64>> = reach_counts
            .iter()
            .map(|depth| depth.reach(beyond))
            .collect();
        grid.best(&reach?, &foreign, most_wrong)
    })?;
    let first = &texture.triangles[0];
    let mut corners = best.corners.map(|corner| grid.uv(corner));
    if (first[1] - first[0]).perp_dot(first[2] - first[0]) < 0.0 {
        corners.reverse();
    }
    Some(corners.map(|uv| Weights::of(first, uv)))
}

/// A grid of equal cells over a card's part of the texture, which goes on beyond the card.
struct CellGrid {
    origin: DVec2,
    step: DVec2,
    /// Number of columns and rows over the card.
    size: [i64; 2],
}

impl CellGrid {
    fn of(texture: &CardTexture<'_>, cells_per_side: usize) -> Option<Self> {
        let corners = || texture.triangles.iter().flatten();
        let low = corners().copied().reduce(DVec2::min)?;
        let high = corners().copied().reduce(DVec2::max)?;
        let span = high - low;
        if !(span.min_element() > 0.0 && span.max_element() <= MAX_REPEATS) {
            return None;
        }
        let texels = span * DVec2::new(texture.mask.width().into(), texture.mask.height().into());
        let size = texels.ceil().min(DVec2::splat(cells_per_side as f64));
        Some(Self {
            origin: low,
            step: span / size,
            size: [size.x as i64, size.y as i64],
        })
    }

    fn uv(&self, at: DVec2) -> DVec2 {
        self.origin + at * self.step
    }

    /// Whether the mask is opaque at a cell's centre.
    fn is_opaque(&self, mask: &Cutout, x: i64, y: i64) -> bool {
        let centre = DVec2::new(x as f64, y as f64) + 0.5;
        let texel = self.uv(centre) * DVec2::new(mask.width().into(), mask.height().into());
        mask.is_opaque(texel.x.floor() as i32, texel.y.floor() as i32)
    }

    /// The texels along an axis under the samples of each of these cells.
    fn sample_texels(&self, mask: &Cutout, axis: usize, cells: Range<i64>) -> Vec<SampleTexels> {
        let texels = f64::from([mask.width(), mask.height()][axis]);
        let texel = |cell: i64, sample: usize| {
            let spot = (sample as f64 + 0.5) / SAMPLES_PER_CELL_SIDE as f64;
            let uv = self.origin[axis] + (cell as f64 + spot) * self.step[axis];
            (uv * texels).floor() as i32
        };
        let of_cell = |cell: i64| std::array::from_fn(|sample| texel(cell, sample));
        cells.map(of_cell).collect()
    }

    /// Row by row of these cells, whether the mask is opaque at any sample of a cell.
    fn opaque_anywhere(&self, mask: &Cutout, [columns, rows]: [Range<i64>; 2]) -> Vec<Vec<bool>> {
        let wrapped = |texel| mask.wrap()[0].texel(texel, mask.width()) as usize;
        let columns = self.sample_texels(mask, 0, columns).into_iter();
        let columns: Vec<_> = columns.map(|texels| texels.map(wrapped)).collect();
        let rows = self.sample_texels(mask, 1, rows);
        // By row of texels: a texture that repeats has the same ones again and again.
        let mut known: FxHashMap<u32, Vec<bool>> = FxHashMap::default();
        let of_row = |row: &SampleTexels| {
            let mut is_opaque = vec![false; columns.len()];
            let mut last = None;
            for texel in row {
                if last.replace(texel) == Some(texel) {
                    continue;
                }
                let wrapped = mask.wrap()[1].texel(*texel, mask.height());
                let of_texels = known.entry(wrapped).or_insert_with(|| {
                    let texels = (0..mask.width() as i32).map(|u| mask.is_opaque(u, *texel));
                    let texels: Vec<bool> = texels.collect();
                    let any = |us: &[usize; SAMPLES_PER_CELL_SIDE]| us.iter().any(|u| texels[*u]);
                    columns.iter().map(any).collect()
                });
                for (cell, texel) in is_opaque.iter_mut().zip(of_texels) {
                    *cell |= *texel;
                }
            }
            is_opaque
        };
        rows.iter().map(of_row).collect()
    }

    /// For each cell over the card, row by row, whether it shows something.
    fn seen(&self, texture: &CardTexture<'_>) -> Vec<bool> {
        let rows = self.opaque_anywhere(texture.mask, self.size.map(|count| 0..count));
        let cells = rows.iter().zip(0..).flat_map(|(row, y)| {
            let columns = row.iter().zip(0..);
            columns.map(move |(is_opaque, x)| *is_opaque && self.is_over(texture, x, y))
        });
        cells.collect()
    }

    /// Whether a cell's centre is over the card.
    fn is_over(&self, texture: &CardTexture<'_>, x: i64, y: i64) -> bool {
        let uv = self.uv(DVec2::new(x as f64, y as f64) + 0.5);
        let is_within = |t: &[DVec2; 3]| Weights::of(t, uv).is_within();
        texture.triangles.iter().any(is_within)
    }

    /// For each direction, how many of the seen cells reach how far; each counts with a margin of
    /// one cell.
    fn reach_counts(&self, seen: &[bool]) -> Vec<ReachCounts> {
        let cells = || {
            let rows = seen.chunks_exact(self.size[0] as usize).zip(0..);
            rows.flat_map(|(row, y)| {
                let columns = row.iter().zip(0..);
                columns.filter_map(move |(is_seen, x)| is_seen.then_some((x, y)))
            })
        };
        let depth = |(dx, dy): (i64, i64)| {
            let beside = |d: i64| if d < 0 { -1 } else { 2 };
            let reach = |x: i64, y: i64| dx * (x + beside(dx)) + dy * (y + beside(dy));
            let ends = |d: i64, size: i64| if d < 0 { [size - 1, 0] } else { [0, size - 1] };
            let [[near_x, far_x], [near_y, far_y]] =
                [ends(dx, self.size[0]), ends(dy, self.size[1])];
            let most = reach(far_x, far_y);
            let mut counts = vec![0; (most - reach(near_x, near_y) + 1) as usize];
            for (x, y) in cells() {
                counts[(most - reach(x, y)) as usize] += 1;
            }
            ReachCounts { most, counts }
        };
        directions().map(depth).collect()
    }

    /// Of the triangles whose sides lie at `reach`, the one that shows the fewest foreign cells,
    /// at most `most_wrong`; of those that show none, the smallest.
    fn best(
        &self,
        reach: &[i64],
        foreign: &ForeignCells,
        most_wrong: usize,
    ) -> Option<GridTriangle> {
        let sides = side_triples().filter_map(|sides| GridTriangle::new(sides, reach));
        let mut triangles: Vec<GridTriangle> = sides.filter(|t| self.is_in_reach(t)).collect();
        triangles.sort_by(|a, b| a.twice_area.total_cmp(&b.twice_area));
        triangles.truncate(MAX_CANDIDATES);
        let mut best: Option<(usize, GridTriangle)> = None;
        let mut most_area = f64::INFINITY;
        for triangle in triangles {
            let least = best.as_ref().map(|(wrong, _)| *wrong);
            if triangle.twice_area > most_area || least == Some(0) {
                break;
            }
            let wrong = foreign.count_within(&triangle);
            if wrong > most_wrong || least.is_some_and(|least| least <= wrong) {
                continue;
            }
            most_area = most_area.min(MAX_AREA_RATIO * triangle.twice_area);
            best = Some((wrong, triangle));
        }
        best.map(|(_, triangle)| triangle)
    }

    fn is_in_reach(&self, triangle: &GridTriangle) -> bool {
        triangle.corners.iter().all(|corner| {
            let within = |at: f64, size: i64| {
                (-MAX_REACH_CARDS * size) as f64 <= at
                    && at <= ((1 + MAX_REACH_CARDS) * size) as f64
            };
            within(corner.x, self.size[0])
                && within(corner.y, self.size[1])
                && self.uv(*corner).abs().max_element() <= MAX_UV
        })
    }

    /// The cells in which the texture shows something that the card does not. With `even_specks`
    /// all samples of a cell count, except beside what the card shows; else only its centre.
    fn foreign(&self, texture: &CardTexture<'_>, seen: &[bool], even_specks: bool) -> ForeignCells {
        let mask = texture.mask;
        let [width, height] = self.size;
        let [columns, rows] = self
            .size
            .map(|count| -MAX_REACH_CARDS * count..(1 + MAX_REACH_CARDS) * count);
        let is_card = |x: i64, y: i64| {
            (0..width).contains(&x) && (0..height).contains(&y) && seen[(y * width + x) as usize]
        };
        let is_beside_card = |x: i64, y: i64| neighbours(x, y).any(|(x, y)| is_card(x, y));
        let sums = |is_foreign: &dyn Fn(i64) -> bool| {
            let mut sum = 0;
            let sums = columns.clone().map(|x| {
                sum += u32::from(is_foreign(x));
                sum
            });
            std::iter::once(0).chain(sums).collect()
        };
        let sums: Vec<Vec<u32>> = match even_specks {
            true => {
                let opaque = self.opaque_anywhere(mask, [columns.clone(), rows.clone()]);
                let rows = rows.zip(&opaque);
                let of_row = |(y, opaque): (i64, &Vec<bool>)| {
                    sums(&|x| {
                        opaque[(x - columns.start) as usize]
                            && !is_beside_card(x, y)
                            && !self.is_over(texture, x, y)
                    })
                };
                rows.map(of_row).collect()
            }
            false => {
                let of_row = |y| sums(&|x| !is_card(x, y) && self.is_opaque(mask, x, y));
                rows.map(of_row).collect()
            }
        };
        ForeignCells {
            first: [-MAX_REACH_CARDS * width, -MAX_REACH_CARDS * height],
            sums,
        }
    }
}

/// A cell and the eight around it.
fn neighbours(x: i64, y: i64) -> impl Iterator<Item = (i64, i64)> {
    (-1..=1).flat_map(move |v| (-1..=1).map(move |u| (x + u, y + v)))
}

/// Cells in which the texture shows what is none of the card's.
struct ForeignCells {
    /// Lowest column and row, in cells.
    first: [i64; 2],
    /// For each row, running sums: the number of such cells before each column, and in all.
    sums: Vec<Vec<u32>>,
}

impl ForeignCells {
    fn count_within(&self, triangle: &GridTriangle) -> usize {
        let rows = self.sums.iter().zip(self.first[1]..);
        let in_row = |(sums, y): (&Vec<u32>, i64)| {
            let columns = self.first[0]..self.first[0] + sums.len() as i64 - 1;
            let held = triangle.columns(y, columns);
            let sum = |x: i64| sums[(x - self.first[0]) as usize];
            (sum(held.end) - sum(held.start)) as usize
        };
        rows.map(in_row).sum()
    }
}

/// Numbers of seen cells by how far they reach in a direction.
struct ReachCounts {
    /// The furthest reach, in lengths of the direction.
    most: i64,
    /// Number of cells that reach `most - k`, by k.
    counts: Vec<u32>,
}

impl ReachCounts {
    /// The reach that at most `beyond` cells exceed; none if there are no more than that.
    fn reach(&self, beyond: u32) -> Option<i64> {
        let held = self.counts.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        });
        let steps = held.zip(0..).find(|(held, _)| *held > beyond);
        steps.map(|(_, steps)| self.most - steps)
    }
}

#[cfg(test)]
mod tests;
