//! How much of a scene the GPU works on at a time.

use std::ops::Range;

use super::pieces::PiecePool;
use super::{Device, GpuError};
use crate::Scene;

/// The most pixels of a chunk of several views.
const MAX_CHUNK_PIXELS: usize = 1 << 22;

/// The most views of a chunk: the workgroups of a dispatch in one direction.
const MAX_CHUNK_VIEWS: usize = 65_535;

/// A run of the chunk's pixels; `Window` of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) first_pixel: u32,
    pub(super) pixel_count: u32,
    /// Number of its first fragment among the chunk's.
    pub(super) first_fragment: u32,
    /// Not known to the shaders.
    pub(super) fragment_count: u32,
}

impl Window {
    pub(super) fn uniform(&self, device: &Device, resolution: u32) -> wgpu::Buffer {
        device.uniform(&[
            resolution,
            self.first_pixel,
            self.pixel_count,
            self.first_fragment,
        ])
    }
}

/// The scene's views in runs whose pixels and areas fit the device's bindings.
pub(super) fn chunks_of_views(
    device: &Device,
    scene: &Scene<'_>,
    pool: &PiecePool<'_>,
) -> Result<Vec<Range<usize>>, GpuError> {
    let limit = device.binding_limit();
    let check = |what, bytes| {
        if bytes > limit {
            return Err(GpuError::TooLarge { what, bytes, limit });
        }
        Ok(())
    };
    let pixels = scene.pixels_per_view();
    let row_bytes = 4 * (scene.foliage.leaves().len() as u64 + 1);
    check("the pixels of a view", 4 * (pixels as u64 + 1))?;
    check("the areas of a view", row_bytes)?;
    let most = pool
        .views_per_chunk()
        .min(MAX_CHUNK_PIXELS / pixels)
        .min(((limit / 4 - 1) / pixels as u64) as usize)
        .min((limit / row_bytes) as usize)
        .clamp(1, MAX_CHUNK_VIEWS);
    let views = scene.views.len();
    // Even chunks: the last one is no stub.
    let count = views.div_ceil(most);
    Ok((0..count)
        .map(|k| k * views / count..(k + 1) * views / count)
        .collect())
}

/// Cuts a chunk's pixels into windows of at most `most` fragments; `starts` is
/// where each pixel's list begins, and the end of the last.
pub(super) fn windows_of_at_most(most: u32, starts: &[u32]) -> Result<Vec<Window>, GpuError> {
    let mut windows = Vec::new();
    let mut first = 0;
    for pixel in 0..starts.len() - 1 {
        let size = starts[pixel + 1] - starts[pixel];
        if size > most {
            return Err(GpuError::TooLarge {
                what: "the fragments of one pixel",
                bytes: 8 * u64::from(size),
                limit: 8 * u64::from(most),
            });
        }
        if starts[pixel + 1] - starts[first] > most {
            windows.push(window_between(starts, first, pixel));
            first = pixel;
        }
    }
    windows.push(window_between(starts, first, starts.len() - 1));
    Ok(windows)
}

fn window_between(starts: &[u32], first: usize, end: usize) -> Window {
    Window {
        first_pixel: first as u32,
        pixel_count: (end - first) as u32,
        first_fragment: starts[first],
        fragment_count: starts[end] - starts[first],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cut_between_pixels() {
        // Lists of 2, 0, 3, 1 and 4 fragments, at most 4 at a time.
        let windows = windows_of_at_most(4, &[0, 2, 2, 5, 6, 10]).unwrap();
        let bounds = |w: &Window| {
            (
                w.first_pixel,
                w.pixel_count,
                w.first_fragment,
                w.fragment_count,
            )
        };
        let bounds: Vec<_> = windows.iter().map(bounds).collect();
        assert_eq!(bounds, [(0, 2, 0, 2), (2, 2, 2, 4), (4, 1, 6, 4)]);
        assert!(windows_of_at_most(3, &[0, 2, 2, 5, 6, 10]).is_err());
    }
}
