//! A leaf in one view, as its triangles are drawn one over the other.

use std::sync::Arc;

use secateur_model::Cutout;

use super::runs::runs;
use crate::SnappedTriangle;

/// The depth of a pixel where nothing is drawn: larger than any depth.
const NOTHING: u32 = u32::MAX;

/// The nearest depths in a box of pixels. Between two leaves it is empty.
#[derive(Clone, Debug, Default)]
pub(super) struct Canvas {
    depths: Vec<u32>,
    /// By row, the first column drawn to and the one after the last.
    drawn: Vec<(u32, u32)>,
}

impl Canvas {
    /// Calls `emit(column, row, depth)` for each pixel that a leaf's triangles cover,
    /// row by row.
    pub(super) fn draw(
        &mut self,
        triangles: &[SnappedTriangle],
        cutouts: &[Arc<Cutout>],
        mut emit: impl FnMut(u32, u32, u32),
    ) {
        if let [triangle] = triangles {
            return draw_alone(triangle, cutouts, emit);
        }
        let Some(frame) = Frame::around(triangles) else {
            return;
        };
        let Self { depths, drawn } = self;
        let width = (frame.x1 - frame.x0) as usize;
        let height = (frame.y1 - frame.y0) as usize;
        if depths.len() < width * height {
            depths.resize(width * height, NOTHING);
        }
        drawn.clear();
        drawn.resize(height, (u32::MAX, 0));
        for triangle in triangles {
            let cutout = cutout_of(triangle, cutouts);
            let left = (triangle.first_pixel & 0xFFFF) - frame.x0;
            let top = (triangle.first_pixel >> 16) - frame.y0;
            runs(triangle, |y, first, end| {
                let row = (top + y) as usize;
                let (from, to) = &mut drawn[row];
                *from = (*from).min(left + first);
                *to = (*to).max(left + end);
                let start = row * width + (left + first) as usize;
                let depths = &mut depths[start..start + (end - first) as usize];
                let mut depth = at(triangle.depth, first, y) as u32;
                let step = triangle.depth[1] as u32;
                match cutout {
                    None => {
                        for known in depths {
                            *known = (*known).min(depth);
                            depth = depth.wrapping_add(step);
                        }
                    }
                    Some(mask) => {
                        for (x, known) in (first..).zip(depths) {
                            if mask
                                .is_opaque(at(triangle.u, x, y) >> 16, at(triangle.v, x, y) >> 16)
                            {
                                *known = (*known).min(depth);
                            }
                            depth = depth.wrapping_add(step);
                        }
                    }
                }
            });
        }
        for (row, &(from, to)) in drawn.iter().enumerate() {
            if from < to {
                let start = row * width;
                let depths = &mut depths[start + from as usize..start + to as usize];
                for (x, depth) in (frame.x0 + from..).zip(depths) {
                    if *depth != NOTHING {
                        emit(x, frame.y0 + row as u32, *depth);
                        *depth = NOTHING;
                    }
                }
            }
        }
    }
}

/// A triangle that nothing else of its leaf covers needs no canvas.
fn draw_alone(
    triangle: &SnappedTriangle,
    cutouts: &[Arc<Cutout>],
    mut emit: impl FnMut(u32, u32, u32),
) {
    let cutout = cutout_of(triangle, cutouts);
    let (left, top) = (triangle.first_pixel & 0xFFFF, triangle.first_pixel >> 16);
    runs(triangle, |y, first, end| {
        let mut depth = at(triangle.depth, first, y) as u32;
        for x in first..end {
            let is_there = cutout.is_none_or(|mask| {
                mask.is_opaque(at(triangle.u, x, y) >> 16, at(triangle.v, x, y) >> 16)
            });
            if is_there && depth != NOTHING {
                emit(left + x, top + y, depth);
            }
            depth = depth.wrapping_add(triangle.depth[1] as u32);
        }
    });
}

/// What its texture leaves out.
fn cutout_of<'a>(triangle: &SnappedTriangle, cutouts: &'a [Arc<Cutout>]) -> Option<&'a Cutout> {
    match triangle.cutout {
        0 => None,
        name => Some(&*cutouts[name as usize - 1]),
    }
}

/// A plane at a pixel of its triangle's box.
#[inline]
fn at(plane: [i32; 3], x: u32, y: u32) -> i32 {
    plane[0]
        .wrapping_add(plane[1].wrapping_mul(x as i32))
        .wrapping_add(plane[2].wrapping_mul(y as i32))
}

/// A box of pixels; `x1` and `y1` are the column and row after its last.
struct Frame {
    x0: u32,
    y0: u32,
    x1: u32,
    y1: u32,
}

impl Frame {
    fn around(triangles: &[SnappedTriangle]) -> Option<Self> {
        let frames = triangles.iter().map(|t| {
            let (x0, y0) = (t.first_pixel & 0xFFFF, t.first_pixel >> 16);
            Self {
                x0,
                y0,
                x1: x0 + (t.size & 0xFFFF),
                y1: y0 + (t.size >> 16),
            }
        });
        frames.reduce(|a, b| Self {
            x0: a.x0.min(b.x0),
            y0: a.y0.min(b.y0),
            x1: a.x1.max(b.x1),
            y1: a.y1.max(b.y1),
        })
    }
}
