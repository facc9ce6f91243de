//! Leaves to fragments: the A-buffer. The twin of `cpu::fragments`.
//!
//! A chunk of views at a time: snap on the CPU; count each pixel's fragments;
//! prefix sum; emit into the pixels' slots; sort each list. While the GPU emits
//! and sorts, the CPU snaps the next chunk.

use std::ops::Range;

use super::chunk::{Window, chunks_of_views, windows_of_at_most};
use super::lists::{FRAGMENT_BYTES, Lists};
use super::memory::{Download, GrowingBuffer};
use super::pieces::{Piece, PiecePool};
use super::stages::{
    HEAP_MAX, PIXEL_WORKGROUP, PIXELS_PER_WORKGROUP, SCAN_BLOCK, TRIANGLE_WORKGROUP,
};
use super::{Device, GpuError, cutouts, long_lists};
use crate::{AreaTable, Fragments, Scene, TooManyFragments};

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
    let (lists, _) = FragmentJob::new(device, scene, false)?.all()?;
    Ok(lists)
}

/// [`fragments`], if there are at most `most`. The count is known before the memory is taken.
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
    let mut run = FragmentJob::new(device, scene, false)?;
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
    FragmentJob::new(device, scene, true)?.all()
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
    let mut run = FragmentJob::new(device, scene, true)?;
    run.most = most;
    run.all()
}

/// Everything that lives as long as the work on one scene.
struct FragmentJob<'a> {
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
    pending: Option<PendingWindow>,
    result: Lists,
}

/// A window whose lists are on their way back.
struct PendingWindow {
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

impl<'a> FragmentJob<'a> {
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
    ) -> PendingWindow {
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
        PendingWindow {
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
