//! Leaves to fragments: the A-buffer. The twin of `cpu::fragments`.
//!
//! A chunk of views at a time: snap on the CPU; count each pixel's fragments;
//! prefix sum; emit into the pixels' slots; sort each list. While the GPU emits
//! and sorts, the CPU snaps the next chunk.

use std::ops::Range;

use super::chunk::{Window, chunks_of_views, windows_of_at_most};
use super::memory::{Download, GrowingBuffer};
use super::pieces::{Piece, PiecePool};
use super::stages::{
    HEAP_MAX, PIXEL_WORKGROUP, PIXELS_PER_WORKGROUP, SCAN_BLOCK, TRIANGLE_WORKGROUP,
};
use super::{Device, GpuError, cutouts, long_lists};
use crate::{AreaTable, Fragment, Fragments, Scene, TooManyFragments, ViewFragments};

/// Bytes of a fragment.
const FRAGMENT_BYTES: u64 = 8;

/// Bytes of fragments to have on the GPU at a time.
const MAX_LIST_BYTES: u64 = 64 << 20;

/// The fragments of all views of a scene, equal to those of
/// [`cpu::fragments`](crate::cpu::fragments).
///
/// # Errors
/// [`GpuError`] if the device fails, or something does not fit it.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn fragments(device: &Device, scene: &Scene<'_>) -> Result<Fragments, GpuError> {
    let (lists, _) = Run::new(device, scene, false)?.all()?;
    Ok(lists)
}

/// [`fragments`], if there are at most so many. The count is known before the
/// memory is taken.
///
/// # Errors
/// As [`fragments`]; [`GpuError::TooManyFragments`].
///
/// # Panics
/// As [`fragments`].
pub(super) fn fragments_within(
    device: &Device,
    scene: &Scene<'_>,
    most: u64,
) -> Result<Fragments, GpuError> {
    let mut run = Run::new(device, scene, false)?;
    run.most = most;
    let (lists, _) = run.all()?;
    Ok(lists)
}

/// [`fragments`] and, from their heads, the area table.
///
/// # Errors
/// As [`fragments`].
///
/// # Panics
/// As [`fragments`].
pub fn fragments_and_areas(
    device: &Device,
    scene: &Scene<'_>,
) -> Result<(Fragments, AreaTable), GpuError> {
    Run::new(device, scene, true)?.all()
}

/// [`fragments_and_areas`], if there are at most this many fragments.
///
/// # Errors
/// As [`fragments`]; [`GpuError::TooManyFragments`].
///
/// # Panics
/// As [`fragments`].
pub(super) fn fragments_and_areas_within(
    device: &Device,
    scene: &Scene<'_>,
    most: u64,
) -> Result<(Fragments, AreaTable), GpuError> {
    let mut run = Run::new(device, scene, true)?;
    run.most = most;
    run.all()
}

/// Everything that lives as long as the work on one scene.
struct Run<'a> {
    device: &'a Device,
    scene: &'a Scene<'a>,
    wants_areas: bool,
    cutouts: wgpu::Buffer,
    /// Fragments of a pixel; the next free slot; fragments left.
    per_pixel: GrowingBuffer,
    starts: GrowingBuffer,
    blocks: GrowingBuffer,
    lists: GrowingBuffer,
    image: GrowingBuffer,
    table: GrowingBuffer,
    most_in_window: u32,
    /// Fragments that there may be over all views.
    most: u64,
    spare: Option<wgpu::Buffer>,
    pending: Option<Job>,
    result: Lists,
}

/// What has come back.
struct Lists {
    pixels_per_view: usize,
    views: Vec<ViewFragments>,
    /// Lists of the view after those.
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
    /// Number of fragments over all views.
    len: u64,
    area_px: Vec<u32>,
}

/// A window whose lists are on their way back.
struct Job {
    window: Window,
    table_bytes: usize,
    download: Download,
}

/// Buffers of the chunk at work.
struct Chunk {
    views: usize,
    pixels: u32,
    pieces: Vec<Piece>,
    per_pixel: wgpu::Buffer,
    starts: wgpu::Buffer,
    fragments: u32,
    fullest: u32,
}

impl<'a> Run<'a> {
    fn new(device: &'a Device, scene: &'a Scene<'a>, wants_areas: bool) -> Result<Self, GpuError> {
        scene.assert_in_range();
        device.check()?;
        let list_bytes = MAX_LIST_BYTES.min(device.binding_limit());
        Ok(Self {
            device,
            scene,
            wants_areas,
            cutouts: cutouts::upload(device, scene.foliage.cutouts())?,
            per_pixel: GrowingBuffer::new("per pixel"),
            starts: GrowingBuffer::new("starts"),
            blocks: GrowingBuffer::new("blocks"),
            lists: GrowingBuffer::new("lists"),
            image: GrowingBuffer::new("leaf IDs"),
            table: GrowingBuffer::new("areas"),
            most_in_window: (list_bytes / FRAGMENT_BYTES) as u32,
            most: u64::MAX,
            spare: None,
            pending: None,
            result: Lists::new(scene.pixels_per_view()),
        })
    }

    fn all(mut self) -> Result<(Fragments, AreaTable), GpuError> {
        let mut pool = PiecePool::new(self.device, self.scene);
        for views in chunks_of_views(self.device, self.scene, &pool)? {
            let pieces = pool.snap(views.clone())?;
            let chunk = self.count(views, pieces)?;
            // The chunk before is through by now.
            pool.recycle()?;
            self.emit_all(&chunk)?;
            pool.give_back(chunk.pieces);
        }
        self.collect()?;
        let Lists { views, area_px, .. } = self.result;
        let leaf_count = self.scene.foliage.leaves().len();
        Ok((
            Fragments::from_views(self.scene.resolution, views),
            AreaTable::from_rows(leaf_count, area_px),
        ))
    }

    /// Counts the fragments of each pixel, and where its list starts.
    fn count(&mut self, views: Range<usize>, pieces: Vec<Piece>) -> Result<Chunk, GpuError> {
        let device = self.device;
        let pixels = (views.len() * self.scene.pixels_per_view()) as u32;
        let block_count = pixels.div_ceil(SCAN_BLOCK);
        let per_pixel = self.per_pixel.at_least(device, 4 * u64::from(pixels));
        let starts = self.starts.at_least(device, 4 * (u64::from(pixels) + 1));
        let blocks = self.blocks.at_least(device, 4 * u64::from(block_count));
        let totals = device.storage("totals", 8);
        let window = whole(pixels, 0).uniform(device, self.scene.resolution);
        let mut encoder = device.encoder();
        for piece in &pieces {
            piece.record_upload(&mut encoder);
        }
        encoder.clear_buffer(&per_pixel, 0, None);
        {
            let mut pass = device.pass(&mut encoder);
            for piece in &pieces {
                let bindings = [
                    (0, &window),
                    (1, piece.buffer()),
                    (2, &self.cutouts),
                    (3, &per_pixel),
                    (6, piece.masks()),
                ];
                let workgroups = piece.triangle_count().div_ceil(TRIANGLE_WORKGROUP);
                let count = &device.stages.count;
                count.run(device, &mut pass, &bindings, [workgroups, 1, 1]);
            }
            let sum = [(0, &window), (1, &per_pixel), (2, &blocks), (4, &totals)];
            let scan = [(0, &window), (2, &blocks), (3, &starts), (4, &totals)];
            let write = [(0, &window), (1, &per_pixel), (2, &blocks), (3, &starts)];
            let workgroups = [block_count.div_ceil(PIXEL_WORKGROUP), 1, 1];
            let stages = &device.stages;
            stages.sum_blocks.run(device, &mut pass, &sum, workgroups);
            stages.scan_blocks.run(device, &mut pass, &scan, [1, 1, 1]);
            stages
                .write_starts
                .run(device, &mut pass, &write, workgroups);
        }
        let mut download = Download::record(device, &mut encoder, &[(&totals, 0, 8)], None);
        device.queue.submit([encoder.finish()]);
        download.request();
        self.collect()?;
        let (words, _) = download.read(device, |parts| {
            let words: &[u32] = bytemuck::cast_slice(parts[0]);
            [words[0], words[1]]
        })?;
        Ok(Chunk {
            views: views.len(),
            pixels,
            pieces,
            per_pixel,
            starts,
            fragments: words[0],
            fullest: words[1],
        })
    }

    /// Emits and sorts the chunk's lists, window by window.
    fn emit_all(&mut self, chunk: &Chunk) -> Result<(), GpuError> {
        let too_many = |count: u64| {
            Err(GpuError::TooLarge {
                what: "the fragments of all views",
                bytes: FRAGMENT_BYTES * count,
                limit: FRAGMENT_BYTES * u64::from(u32::MAX),
            })
        };
        let total = self.result.len + u64::from(chunk.fragments);
        if total > self.most {
            return Err(GpuError::TooManyFragments(TooManyFragments {
                found: total,
                most: self.most,
            }));
        }
        if chunk.fragments == u32::MAX || total > u64::from(u32::MAX) {
            return too_many(total);
        }
        let fits = chunk.fragments <= self.most_in_window;
        // The starts are needed here only where lists are many or long.
        let starts = if fits && chunk.fullest <= HEAP_MAX {
            None
        } else {
            let bytes = 4 * (u64::from(chunk.pixels) + 1);
            Some(self.device.run(&[], &chunk.starts, bytes)?)
        };
        let windows = match &starts {
            Some(starts) if !fits => windows_of_at_most(self.most_in_window, starts)?,
            _ => vec![whole(chunk.pixels, chunk.fragments)],
        };
        for (k, window) in windows.iter().enumerate() {
            let is_last = k + 1 == windows.len();
            let job = self.emit(chunk, *window, starts.as_deref(), is_last);
            self.collect()?;
            self.pending = Some(job);
        }
        Ok(())
    }

    /// Emits and sorts one window; `starts` are those of the chunk.
    fn emit(
        &mut self,
        chunk: &Chunk,
        window: Window,
        starts: Option<&[u32]>,
        is_last: bool,
    ) -> Job {
        let device = self.device;
        let list_bytes = FRAGMENT_BYTES * u64::from(window.fragment_count);
        let reserved = list_bytes
            .next_power_of_two()
            .min(FRAGMENT_BYTES * u64::from(self.most_in_window));
        let lists = self.lists.at_least(device, reserved);
        let dropped = device.storage("dropped", 4);
        let uniform = window.uniform(device, self.scene.resolution);
        let mut encoder = device.encoder();
        let mut pass = device.pass(&mut encoder);
        for piece in &chunk.pieces {
            let bindings = [
                (0, &uniform),
                (1, piece.buffer()),
                (2, &self.cutouts),
                (3, &chunk.per_pixel),
                (4, &lists),
                (6, piece.masks()),
            ];
            let workgroups = piece.triangle_count().div_ceil(TRIANGLE_WORKGROUP);
            let emit = &device.stages.emit;
            emit.run(device, &mut pass, &bindings, [workgroups, 1, 1]);
        }
        let workgroups = [window.pixel_count.div_ceil(PIXEL_WORKGROUP), 1, 1];
        let bindings = [
            (0, &uniform),
            (1, &chunk.starts),
            (2, &lists),
            (3, &chunk.per_pixel),
            (4, &dropped),
        ];
        let sort = &device.stages.sort_lists;
        sort.run(device, &mut pass, &bindings, workgroups);
        if let Some(starts) = starts.filter(|_| chunk.fullest > HEAP_MAX) {
            let buffers = [&lists, &chunk.per_pixel, &dropped];
            long_lists::sort(device, &mut pass, &window, starts, buffers);
        }
        let table = self.wants_areas.then(|| {
            let bytes = 4 * u64::from(chunk.pixels);
            let image = self.image.at_least(device, bytes);
            let bindings = [(0, &uniform), (1, &chunk.starts), (2, &lists), (3, &image)];
            let leaf_ids = &device.stages.leaf_ids;
            leaf_ids.run(device, &mut pass, &bindings, workgroups);
            image
        });
        drop(pass);
        let table = table
            .filter(|_| is_last)
            .map(|image| self.histogram(&mut encoder, &image, chunk.views));
        let pixel_bytes = 4 * u64::from(window.pixel_count);
        let at = 4 * u64::from(window.first_pixel);
        let table_bytes = table.as_ref().map_or(0, |(_, bytes)| *bytes);
        let parts = [
            (&dropped, 0, 4),
            (&chunk.starts, at, pixel_bytes + 4),
            (&chunk.per_pixel, at, pixel_bytes),
            (&lists, 0, list_bytes),
            (table.as_ref().map_or(&dropped, |(t, _)| t), 0, table_bytes),
        ];
        let mut download = Download::record(device, &mut encoder, &parts, self.spare.take());
        device.queue.submit([encoder.finish()]);
        download.request();
        Job {
            window,
            table_bytes: table_bytes as usize,
            download,
        }
    }

    fn histogram(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        image: &wgpu::Buffer,
        views: usize,
    ) -> (wgpu::Buffer, u64) {
        let row = self.scene.foliage.leaves().len() + 1;
        let bytes = 4 * (row * views) as u64;
        let table = self.table.at_least(self.device, bytes);
        record_histogram(self.device, encoder, self.scene, views, image, &table);
        (table, bytes)
    }

    /// Takes in the pending window, if there is one.
    fn collect(&mut self) -> Result<(), GpuError> {
        let Some(job) = self.pending.take() else {
            return Ok(());
        };
        let result = &mut self.result;
        let ((), spare) = job.download.read(self.device, |parts| {
            result.append(&job.window, job.table_bytes, parts);
        })?;
        self.spare = Some(spare);
        Ok(())
    }
}

impl Lists {
    fn new(pixels_per_view: usize) -> Self {
        Self {
            pixels_per_view,
            views: Vec::new(),
            starts: Vec::new(),
            fragments: Vec::new(),
            len: 0,
            area_px: Vec::new(),
        }
    }

    fn append(&mut self, window: &Window, table_bytes: usize, parts: &[&[u8]]) {
        let pixels = window.pixel_count as usize;
        let dropped: &[u32] = bytemuck::cast_slice(parts[0]);
        let starts: &[u32] = bytemuck::cast_slice(&parts[1][..4 * (pixels + 1)]);
        let kept: &[u32] = bytemuck::cast_slice(&parts[2][..4 * pixels]);
        let list_bytes = FRAGMENT_BYTES as usize * window.fragment_count as usize;
        let lists: &[Fragment] = bytemuck::cast_slice(&parts[3][..list_bytes]);
        let kept = (dropped[0] > 0).then_some(kept);
        let mut pixel = 0;
        while pixel < pixels {
            // A window may end within a view, and go on over several.
            let end = pixels.min(pixel + self.pixels_per_view - self.starts.len());
            let first = (starts[pixel] - window.first_fragment) as usize;
            let size = (starts[end] - starts[pixel]) as usize;
            let kept = kept.map(|kept| &kept[pixel..end]);
            self.append_to_view(&starts[pixel..end], kept, &lists[first..first + size]);
            pixel = end;
        }
        self.area_px
            .extend_from_slice(bytemuck::cast_slice(&parts[4][..table_bytes]));
    }

    /// Lists of pixels that follow each other; of each `kept` fragments, or all.
    fn append_to_view(&mut self, starts: &[u32], kept: Option<&[u32]>, lists: &[Fragment]) {
        let before = self.fragments.len();
        // And for the end of the last.
        self.starts.reserve(starts.len() + 1);
        self.fragments.reserve(lists.len());
        match kept {
            None => {
                let own = starts.iter().map(|s| s - starts[0] + before as u32);
                self.starts.extend(own);
                self.fragments.extend_from_slice(lists);
            }
            Some(kept) => {
                for (start, kept) in starts.iter().zip(kept) {
                    self.starts.push(self.fragments.len() as u32);
                    let list = &lists[(start - starts[0]) as usize..][..*kept as usize];
                    self.fragments.extend_from_slice(list);
                }
            }
        }
        self.len += (self.fragments.len() - before) as u64;
        if self.starts.len() == self.pixels_per_view {
            self.starts.push(self.fragments.len() as u32);
            self.views.push(ViewFragments::from_lists(
                std::mem::take(&mut self.starts),
                std::mem::take(&mut self.fragments),
            ));
        }
    }
}

/// Records the histogram of the images of `views` views into `table`.
pub(super) fn record_histogram(
    device: &Device,
    encoder: &mut wgpu::CommandEncoder,
    scene: &Scene<'_>,
    views: usize,
    image: &wgpu::Buffer,
    table: &wgpu::Buffer,
) {
    let pixels = scene.pixels_per_view() as u32;
    let row = scene.foliage.leaves().len() as u32 + 1;
    let shape = device.uniform(&[pixels, row, 0, 0]);
    encoder.clear_buffer(table, 0, None);
    let mut pass = device.pass(encoder);
    let bindings = [(0, &shape), (1, image), (2, table)];
    let workgroups = [pixels.div_ceil(PIXELS_PER_WORKGROUP), views as u32, 1];
    let histogram = &device.stages.histogram;
    histogram.run(device, &mut pass, &bindings, workgroups);
}

/// All pixels of a chunk.
pub(super) fn whole(pixels: u32, fragments: u32) -> Window {
    Window {
        first_pixel: 0,
        pixel_count: pixels,
        first_fragment: 0,
        fragment_count: fragments,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three views of two pixels with lists of 1, 2, 1, 2, 0 and 3 fragments, in
    /// two windows of three pixels; of each list so many are kept.
    fn appended(kept: [u32; 6]) -> Lists {
        let starts = [0u32, 1, 3, 4, 6, 6, 9];
        let fragments: Vec<Fragment> = (1..=9).map(|leaf| Fragment::new(9, leaf)).collect();
        let mut lists = Lists::new(2);
        for pixels in [0..3usize, 3..6] {
            let (first, end) = (starts[pixels.start], starts[pixels.end]);
            let window = Window {
                first_pixel: pixels.start as u32,
                pixel_count: pixels.len() as u32,
                first_fragment: first,
                fragment_count: end - first,
            };
            let kept = &kept[pixels.clone()];
            let dropped = end - first - kept.iter().sum::<u32>();
            let parts: [&[u8]; 5] = [
                bytemuck::bytes_of(&dropped),
                bytemuck::cast_slice(&starts[pixels.start..=pixels.end]),
                bytemuck::cast_slice(kept),
                bytemuck::cast_slice(&fragments[first as usize..end as usize]),
                bytemuck::cast_slice::<u32, u8>(&[]),
            ];
            lists.append(&window, 0, &parts);
        }
        lists
    }

    fn leaves(lists: &Lists) -> Vec<Vec<Vec<u32>>> {
        let of_list = |list: &[Fragment]| list.iter().map(|f| f.leaf()).collect();
        let of_view = |view: &ViewFragments| view.pixels().map(of_list).collect();
        lists.views.iter().map(of_view).collect()
    }

    #[test]
    fn windows_begin_and_end_within_views() {
        let lists = appended([1, 2, 1, 2, 0, 3]);
        let expected = [
            [vec![1], vec![2, 3]],
            [vec![4], vec![5, 6]],
            [vec![], vec![7, 8, 9]],
        ];
        assert_eq!(leaves(&lists), expected);
        assert_eq!(lists.len, 9);
    }

    #[test]
    fn what_was_dropped_is_left_out() {
        let lists = appended([1, 1, 1, 1, 0, 2]);
        let expected = [[vec![1], vec![2]], [vec![4], vec![5]], [vec![], vec![7, 8]]];
        assert_eq!(leaves(&lists), expected);
        assert_eq!(lists.len, 6);
    }
}
