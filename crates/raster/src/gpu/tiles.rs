//! Large triangles in parts, so that no invocation goes over a whole image.

use crate::SnappedTriangle;

/// The largest width and height of a box that one invocation goes over.
pub const TILE_PX: u32 = 64;

/// Calls `emit` with triangles that together cover what `triangle` covers, at
/// the same depths and texels, each in a box of at most `tile_px` x `tile_px`
/// pixels. Tiles that an edge leaves out altogether are not emitted.
///
/// # Panics
/// If `tile_px` is zero.
#[inline]
pub fn split_into_tiles(
    triangle: &SnappedTriangle,
    tile_px: u32,
    mut emit: impl FnMut(&SnappedTriangle),
) {
    let (width, height) = (triangle.size & 0xFFFF, triangle.size >> 16);
    if width <= tile_px && height <= tile_px {
        return emit(triangle);
    }
    for y in (0..height).step_by(tile_px as usize) {
        for x in (0..width).step_by(tile_px as usize) {
            let size = [tile_px.min(width - x), tile_px.min(height - y)];
            let tile = part(triangle, [x, y], size);
            if tile.edges.iter().all(|edge| reaches(*edge, size)) {
                emit(&tile);
            }
        }
    }
}

/// The part of a triangle in the box at `corner`, seen from the triangle's own.
fn part(triangle: &SnappedTriangle, corner: [u32; 2], size: [u32; 2]) -> SnappedTriangle {
    let [x, y] = corner.map(|c| c as i32);
    let moved = |plane: [i32; 3]| {
        let start = plane[0]
            .wrapping_add(plane[1].wrapping_mul(x))
            .wrapping_add(plane[2].wrapping_mul(y));
        [start, plane[1], plane[2]]
    };
    SnappedTriangle {
        first_pixel: triangle.first_pixel + (corner[0] | corner[1] << 16),
        size: size[0] | size[1] << 16,
        edges: triangle.edges.map(moved),
        depth: moved(triangle.depth),
        u: moved(triangle.u),
        v: moved(triangle.v),
        ..*triangle
    }
}

/// Whether an edge function is `>= 0` at one of the tile's corner pixels, and
/// so possibly inside. Values at pixels of the box fit 32 bits, whatever the
/// steps wrap to.
fn reaches(edge: [i32; 3], size: [u32; 2]) -> bool {
    let [right, down] = size.map(|s| s as i32 - 1);
    let at = |x: i32, y: i32| {
        edge[0]
            .wrapping_add(edge[1].wrapping_mul(x))
            .wrapping_add(edge[2].wrapping_mul(y))
    };
    [at(0, 0), at(right, 0), at(0, down), at(right, down)]
        .iter()
        .any(|value| *value >= 0)
}
