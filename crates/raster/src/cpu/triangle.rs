//! One snapped triangle to its pixels.

use std::sync::Arc;

use secateur_model::Cutout;

use crate::SnappedTriangle;

/// Calls `emit(column, row, depth)` for each pixel whose centre the triangle
/// covers and its cut-out keeps, row by row.
///
/// `cutouts` are those of the foliage. The twins are `pixels_inside`
/// and `is_covered` in `rasterise.wgsl`.
#[inline]
pub fn rasterise(
    triangle: &SnappedTriangle,
    cutouts: &[Arc<Cutout>],
    mut emit: impl FnMut(u32, u32, u32),
) {
    let cutout = match triangle.cutout {
        0 => None,
        name => Some(&*cutouts[name as usize - 1]),
    };
    let (x0, y0) = (triangle.first_pixel & 0xFFFF, triangle.first_pixel >> 16);
    let (width, height) = (triangle.size & 0xFFFF, triangle.size >> 16);
    let at = |plane: [i32; 3], x: u32, y: u32| {
        plane[0]
            .wrapping_add(plane[1].wrapping_mul(x as i32))
            .wrapping_add(plane[2].wrapping_mul(y as i32))
    };
    let [ea, eb, ec] = triangle.edges;
    for y in 0..height {
        let (mut a, mut b, mut c) = (at(ea, 0, y), at(eb, 0, y), at(ec, 0, y));
        let mut was_inside = false;
        for x in 0..width {
            if (a | b | c) >= 0 {
                was_inside = true;
                let opaque = cutout.is_none_or(|mask| {
                    mask.is_opaque(at(triangle.u, x, y) >> 16, at(triangle.v, x, y) >> 16)
                });
                if opaque {
                    emit(x0 + x, y0 + y, at(triangle.depth, x, y) as u32);
                }
            } else if was_inside {
                break;
            }
            a = a.wrapping_add(ea[1]);
            b = b.wrapping_add(eb[1]);
            c = c.wrapping_add(ec[1]);
        }
    }
}
