//! Triangles whose sides are sides of a k-DOP: each faces one of 64 directions, in whole
//! numbers of a grid's cells.

use std::ops::Range;

use glam::DVec2;

/// Half the side of a square: sides face the points with whole coordinates on its border. In
/// whole numbers every machine finds the same triangles.
const HALF_SQUARE: i64 = 8;

const DIRECTIONS: usize = 8 * HALF_SQUARE as usize;

/// A direction, and its number among [`directions`].
pub(super) type Side = (usize, (i64, i64));

/// All directions that a side can face, counterclockwise.
pub(super) fn directions() -> impl Iterator<Item = (i64, i64)> {
    (0..DIRECTIONS as i64).map(|k| {
        let (side, along) = (k / (2 * HALF_SQUARE), k % (2 * HALF_SQUARE) - HALF_SQUARE);
        match side {
            0 => (HALF_SQUARE, along),
            1 => (-along, HALF_SQUARE),
            2 => (-HALF_SQUARE, -along),
            _ => (along, -HALF_SQUARE),
        }
    })
}

fn cross(a: (i64, i64), b: (i64, i64)) -> i64 {
    a.0 * b.1 - a.1 * b.0
}

/// All triples of directions that the sides of a triangle can face, counterclockwise.
pub(super) fn side_triples() -> impl Iterator<Item = [Side; 3]> {
    let all: Vec<Side> = directions().enumerate().collect();
    let is_left = |a: Side, b: Side| cross(a.1, b.1) > 0;
    let count = all.len();
    (0..count).flat_map(move |a| {
        let all = all.clone();
        (a + 1..count).flat_map(move |b| {
            let all = all.clone();
            (b + 1..count).filter_map(move |c| {
                let (a, b, c) = (all[a], all[b], all[c]);
                (is_left(a, b) && is_left(b, c) && is_left(c, a)).then_some([a, b, c])
            })
        })
    })
}

/// A triangle on a grid: all that lies behind three lines.
pub(super) struct GridTriangle {
    /// For each line its direction, and its distance from the origin in lengths of that.
    sides: [((i64, i64), i64); 3],
    pub(super) corners: [DVec2; 3],
    pub(super) twice_area: f64,
}

impl GridTriangle {
    /// The triangle of three sides, `reach[n]` from the origin for direction n in lengths of that
    /// direction; none if it has no area.
    pub(super) fn new(sides: [Side; 3], reach: &[i64]) -> Option<Self> {
        let sides = sides.map(|(number, direction)| (direction, reach[number]));
        let corner = |k: usize| {
            let ((a, reach_a), (b, reach_b)) = (sides[k], sides[(k + 1) % 3]);
            let numerator = DVec2::new(
                (reach_a * b.1 - reach_b * a.1) as f64,
                (a.0 * reach_b - b.0 * reach_a) as f64,
            );
            numerator / cross(a, b) as f64
        };
        let corners = [0, 1, 2].map(corner);
        let twice_area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        (twice_area > 0.0).then_some(Self {
            sides,
            corners,
            twice_area,
        })
    }

    /// Of these columns, those whose cell in row `y` has its centre in the triangle.
    pub(super) fn columns(&self, y: i64, all: Range<i64>) -> Range<i64> {
        let mut columns = all.clone();
        for ((dx, dy), reach) in self.sides {
            // dx (2 x + 1) <= left.
            let left = 2 * reach - dy * (2 * y + 1);
            match dx {
                0 if left < 0 => columns.end = all.start,
                0 => (),
                1.. => columns.end = columns.end.min((left - dx).div_euclid(2 * dx) + 1),
                _ => {
                    let first = -(left - dx).div_euclid(-2 * dx);
                    columns.start = columns.start.max(first);
                }
            }
        }
        columns.start = columns.start.min(all.end);
        columns.end = columns.end.max(columns.start);
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row by row and place by place, of sides of every slope, within the columns looked at
    /// and beyond them.
    #[test]
    fn columns_of_a_row_are_those_whose_middles_lie_behind_all_sides() {
        let reach: Vec<i64> = directions().map(|(dx, dy)| 40 + 3 * dx - 5 * dy).collect();
        let triangles = side_triples().filter_map(|sides| GridTriangle::new(sides, &reach));
        let mut held = 0;
        for triangle in triangles.step_by(37) {
            for y in -20..20 {
                let columns = triangle.columns(y, -9..11);
                for x in -9..11 {
                    let is_behind = |((dx, dy), reach): &((i64, i64), i64)| {
                        dx * (2 * x + 1) + dy * (2 * y + 1) <= 2 * reach
                    };
                    let is_held = triangle.sides.iter().all(is_behind);
                    assert_eq!(columns.contains(&x), is_held, "{x} {y}");
                    held += u32::from(is_held);
                }
            }
        }
        assert!(held > 1000);
    }
}
