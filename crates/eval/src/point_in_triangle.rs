//! Places within a triangle on the raster.

use std::ops::Range;

use glam::{Vec2, Vec4};

use crate::screen_triangle::ScreenTriangle;

/// Shared edges must not show the background through rounding.
pub(crate) const EDGE_SLACK: f32 = -1e-5;

/// What is needed to find a place within a triangle.
#[derive(Clone, Copy)]
pub(crate) struct PointInTriangle {
    pub(crate) origin: Vec2,
    pub(crate) second: Vec2,
    pub(crate) third: Vec2,
}

impl PointInTriangle {
    /// `None` for a triangle that is seen edge-on.
    pub(crate) fn within(triangle: &ScreenTriangle) -> Option<Self> {
        let [a, b, c] = triangle.corners.map(|corner| corner.at);
        let (ab, ac) = (b - a, c - a);
        let area = ab.perp_dot(ac);
        let inverse = 1.0 / area;
        (area != 0.0 && inverse.is_finite()).then(|| Self {
            origin: a,
            second: Vec2::new(ac.y, -ac.x) * inverse,
            third: Vec2::new(-ab.y, ab.x) * inverse,
        })
    }

    /// The shares of the three corners at a point of the raster.
    pub(crate) fn weights(&self, at: Vec2) -> [f32; 3] {
        let offset = at - self.origin;
        let (second, third) = (self.second.dot(offset), self.third.dot(offset));
        [1.0 - second - third, second, third]
    }

    /// Where the middle of a block's samples lies from the triangle's first corner, and how far they reach from there.
    fn middle_and_half(&self, columns: &Range<usize>, rows: &Range<usize>) -> [Vec2; 2] {
        let low = Vec2::new(columns.start as f32, rows.start as f32) + 0.5 - self.origin;
        let high = Vec2::new(columns.end as f32, rows.end as f32) - 0.5 - self.origin;
        [0.5 * (low + high), 0.5 * (high - low)]
    }

    /// As large as any number from which weights of a block's samples are made: what they are rounded by is a share of it.
    fn size_of_terms(&self, [middle, half]: [Vec2; 2]) -> f32 {
        1.0 + (self.second.abs() + self.third.abs()).dot(middle.abs() + half)
    }

    /// The shares of the triangle's corners at the outermost samples of a block, and how large the numbers are from
    /// which those of all its samples are made.
    pub(crate) fn outermost(
        &self,
        columns: &Range<usize>,
        rows: &Range<usize>,
    ) -> ([Vec4; 3], f32) {
        let [middle, half] = self.middle_and_half(columns, rows);
        let right = middle.x + half.x * Vec4::new(-1.0, 1.0, -1.0, 1.0);
        let down = middle.y + half.y * Vec4::new(-1.0, -1.0, 1.0, 1.0);
        let [second, third] = [self.second, self.third].map(|to| right * to.x + down * to.y);
        let size = self.size_of_terms([middle, half]);
        ([Vec4::ONE - second - third, second, third], size)
    }

    /// Whether no sample of a block is in the triangle, as far as can be told at once: each weight is
    /// largest at some corner of the block.
    pub(crate) fn misses(&self, columns: &Range<usize>, rows: Range<usize>) -> bool {
        // More than rounding moves a weight.
        const SLACK: f32 = 1e-5;
        let [middle, half] = self.middle_and_half(columns, &rows);
        let size = self.size_of_terms([middle, half]);
        let is_out = |toward: Vec2, start: f32| {
            start + toward.dot(middle) + toward.abs().dot(half) + SLACK * size < EDGE_SLACK
        };
        is_out(self.second, 0.0)
            || is_out(self.third, 0.0)
            || is_out(-(self.second + self.third), 1.0)
    }
}

/// The shares of the face's own three corners, perspective undone.
pub(crate) fn face_weights(triangle: &ScreenTriangle, weights: [f32; 3]) -> [f32; 3] {
    let mut shares = Vec2::ZERO;
    let mut total = 0.0;
    for (i, weight) in weights.into_iter().enumerate() {
        let part = weight * triangle.corners[i].inverse_w;
        shares += triangle.shares[i] * part;
        total += part;
    }
    shares /= total;
    [1.0 - shares.x - shares.y, shares.x, shares.y]
}

/// As [`face_weights`], of four samples: each rounds as it would alone.
pub(crate) fn four_face_weights(triangle: &ScreenTriangle, weights: [Vec4; 3]) -> [Vec4; 3] {
    let (mut second, mut third, mut total) = (Vec4::ZERO, Vec4::ZERO, Vec4::ZERO);
    for (i, weight) in weights.into_iter().enumerate() {
        let part = weight * triangle.corners[i].inverse_w;
        second += part * triangle.shares[i].x;
        third += part * triangle.shares[i].y;
        total += part;
    }
    (second, third) = (second / total, third / total);
    [Vec4::ONE - second - third, second, third]
}

/// By what [`four_face_weights`] divides.
pub(crate) fn four_divisors(triangle: &ScreenTriangle, weights: [Vec4; 3]) -> Vec4 {
    let parts = weights.iter().zip(&triangle.corners);
    parts
        .map(|(weight, corner)| *weight * corner.inverse_w)
        .sum()
}

/// How far texture coordinates go from a sample to the next pixel to the right, and down.
pub(crate) fn uv_steps(
    triangle: &ScreenTriangle,
    place: &PointInTriangle,
    at: Vec2,
    uvs: [Vec2; 3],
) -> [Vec2; 2] {
    let uv = |at: Vec2| {
        let weights = face_weights(triangle, place.weights(at));
        uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
    };
    let here = uv(at);
    [Vec2::X, Vec2::Y].map(|step| uv(at + step) - here)
}
