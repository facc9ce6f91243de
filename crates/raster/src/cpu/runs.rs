//! One snapped triangle to runs of pixels.

use crate::SnappedTriangle;

/// Up to this width of its box every pixel of a triangle is looked at.
const NARROW_PX: u32 = 12;

/// Calls `emit(row, first column, column after the last)`, counted from the
/// triangle's box, for each row in which the triangle covers pixel centres.
///
/// What is covered is what [`rasterise`](super::rasterise) finds by looking at every
/// pixel of the box.
#[inline]
pub(super) fn runs(triangle: &SnappedTriangle, emit: impl FnMut(u32, u32, u32)) {
    match triangle.size & 0xFFFF <= NARROW_PX {
        true => narrow_runs(triangle, emit),
        false => wide_runs(triangle, emit),
    }
}

/// Without a branch for each pixel.
#[inline(always)]
fn narrow_runs(triangle: &SnappedTriangle, mut emit: impl FnMut(u32, u32, u32)) {
    let (width, height) = (triangle.size & 0xFFFF, triangle.size >> 16);
    let [mut a, mut b, mut c] = triangle.edges.map(|[value, ..]| value);
    let [step_a, step_b, step_c] = triangle.edges.map(|[_, step, _]| step);
    let [down_a, down_b, down_c] = triangle.edges.map(|[.., down]| down);
    for y in 0..height {
        let (mut at_a, mut at_b, mut at_c) = (a, b, c);
        let mut inside = 0u32;
        for x in 0..width {
            inside |= u32::from((at_a | at_b | at_c) >= 0) << x;
            at_a = at_a.wrapping_add(step_a);
            at_b = at_b.wrapping_add(step_b);
            at_c = at_c.wrapping_add(step_c);
        }
        if inside != 0 {
            emit(y, inside.trailing_zeros(), 32 - inside.leading_zeros());
        }
        a = a.wrapping_add(down_a);
        b = b.wrapping_add(down_b);
        c = c.wrapping_add(down_c);
    }
}

/// An edge function along a row, and where it changes sign there.
struct Edge {
    /// What the value gains from one pixel to the next in a row.
    step: i32,
    /// What the value gains from one row to the next.
    down: i32,
    /// Where pixels begin to be inside, or stop to be; from 0 to the box's width.
    limit: u32,
    /// The value at the pixel next to `limit` on the side that is inside, which may
    /// be one beside the box; at the first pixel if there is no step.
    value: i32,
}

/// From the limits of each row to those of the next.
#[inline(always)]
fn wide_runs(triangle: &SnappedTriangle, mut emit: impl FnMut(u32, u32, u32)) {
    let (width, height) = (triangle.size & 0xFFFF, triangle.size >> 16);
    let mut edges = triangle.edges.map(|[value, step, down]| {
        let limit = if step < 0 { 1 } else { 0 };
        Edge {
            step,
            down,
            limit,
            value,
        }
    });
    for y in 0..height {
        let (mut first, mut end) = (0, width);
        for Edge {
            step,
            down,
            limit,
            value,
        } in &mut edges
        {
            if *step > 0 {
                while *value < 0 && *limit < width {
                    *value += *step;
                    *limit += 1;
                }
                while *limit > 0 && *value >= *step {
                    *value -= *step;
                    *limit -= 1;
                }
                first = first.max(*limit);
            } else if *step < 0 {
                while *value < 0 && *limit > 0 {
                    *value -= *step;
                    *limit -= 1;
                }
                while *limit < width && *value + *step >= 0 {
                    *value += *step;
                    *limit += 1;
                }
                end = end.min(*limit);
            } else if *value < 0 {
                end = 0;
            }
            *value = value.wrapping_add(*down);
        }
        if first < end {
            emit(y, first, end);
        }
    }
}
