//! Snapped triangles on their way to the GPU, in pieces of one view each.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::memory::Mapping;
use super::stages::KNOWN_BLOCKS;
use super::tiles::{TILE_PX, split_into_tiles};
use super::{Device, GpuError};
use crate::snap::Snapper;
use crate::{Scene, SnappedTriangle};

const TRIANGLE_BYTES: u64 = size_of::<SnappedTriangle>() as u64;

/// Words before a piece's triangles: their number and the view's first pixel.
const HEADER_BYTES: u64 = 8;

/// Bytes for the pixels of a block of a triangle's box.
const MASK_BYTES: u64 = 8;

/// The most triangles of a piece: a megabyte or two, a short dispatch, and work for many cores.
const MAX_PIECE_TRIANGLES: u64 = 1 << 14;

/// Bytes of triangles to have on the GPU at a time, roughly. With more, a GPU with memory of its own
/// takes longer: memory that the CPU writes for it takes long to get, and each chunk uses that of the one before.
const CHUNK_BYTES: u64 = 32 << 20;

/// Triangles of one view; its layout is `Piece` of `rasterise.wgsl`.
#[derive(Debug)]
pub(super) struct Piece {
    /// What the CPU writes; what the GPU reads too where memory is shared.
    host: wgpu::Buffer,
    device: Option<wgpu::Buffer>,
    /// Which pixels of the first blocks are covered, from `count` to `emit`.
    masks: wgpu::Buffer,
    triangle_count: u32,
}

impl Piece {
    pub(super) fn triangle_count(&self) -> u32 {
        self.triangle_count
    }

    /// The buffer that shaders bind.
    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        self.device.as_ref().unwrap_or(&self.host)
    }

    pub(super) fn masks(&self) -> &wgpu::Buffer {
        &self.masks
    }

    /// Records the copy to the GPU where one is needed.
    pub(super) fn record_upload(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(device) = &self.device {
            let bytes = HEADER_BYTES + TRIANGLE_BYTES * u64::from(self.triangle_count);
            encoder.copy_buffer_to_buffer(&self.host, 0, device, 0, bytes);
        }
    }
}

/// Makes pieces and uses them again.
pub(super) struct PiecePool<'a> {
    device: &'a Device,
    scene: &'a Scene<'a>,
    leaves_per_piece: usize,
    capacity: u32,
    free: Mutex<Vec<Piece>>,
    /// In a lock only because receivers must be.
    used: Mutex<Vec<(Piece, Mapping)>>,
}

impl<'a> PiecePool<'a> {
    pub(super) fn new(device: &'a Device, scene: &'a Scene<'a>) -> Self {
        let leaves = scene.foliage.leaves().len().max(1) as u64;
        let triangles = scene.foliage.triangles().len().max(1) as u64;
        let bindable = (device.binding_limit() - HEADER_BYTES) / TRIANGLE_BYTES;
        let most = MAX_PIECE_TRIANGLES.min(bindable).max(1);
        let capacity = triangles
            .next_power_of_two()
            .clamp(64, most.max(64))
            .min(most);
        Self {
            device,
            scene,
            leaves_per_piece: (capacity * leaves / triangles).max(1) as usize,
            capacity: capacity as u32,
            free: Mutex::new(Vec::new()),
            used: Mutex::new(Vec::new()),
        }
    }

    /// How many views to snap at a time.
    pub(super) fn views_per_chunk(&self) -> usize {
        let view_bytes = TRIANGLE_BYTES * self.scene.foliage.triangles().len().max(1) as u64;
        (CHUNK_BYTES / view_bytes).max(1) as usize
    }

    /// The triangles of these views, on all cores. Pixels count from the first
    /// view's first.
    pub(super) fn snap(&self, views: Range<usize>) -> Result<Vec<Piece>, GpuError> {
        let leaf_count = self.scene.foliage.leaves().len();
        let blocks = leaf_count.div_ceil(self.leaves_per_piece);
        let pieces: Result<Vec<Vec<Piece>>, GpuError> = (0..views.len() * blocks)
            .into_par_iter()
            .map(|task| {
                let (view, block) = (task / blocks, task % blocks);
                // Blocks of one size: the last is no stub.
                let leaves = block * leaf_count / blocks..(block + 1) * leaf_count / blocks;
                self.snap_leaves(views.start + view, view, leaves)
            })
            .collect();
        Ok(pieces?.into_iter().flatten().collect())
    }

    fn snap_leaves(
        &self,
        view: usize,
        view_in_chunk: usize,
        leaves: Range<usize>,
    ) -> Result<Vec<Piece>, GpuError> {
        let Scene {
            foliage,
            lod,
            views,
            resolution,
        } = *self.scene;
        let snapper = Snapper::new(&views.views()[view], resolution);
        let view_pixel = (view_in_chunk * self.scene.pixels_per_view()) as u32;
        let mut writer = PieceWriter::new(self, view_pixel);
        for leaf in leaves.map(secateur_model::LeafId::from_index) {
            let Some(area_scale) = lod.area_scale(leaf) else {
                continue;
            };
            let geometry = foliage.leaf(leaf);
            snapper.snap_leaf(
                leaf.get(),
                geometry,
                foliage.triangles_of(leaf),
                area_scale,
                geometry
                    .cutout()
                    .map(|index| &*foliage.cutouts()[index as usize]),
                |triangle| split_into_tiles(triangle, TILE_PX, |tile| writer.push(tile)),
            );
        }
        writer.finish()
    }

    fn take(&self) -> Piece {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        free.pop().unwrap_or_else(|| self.make())
    }

    fn make(&self) -> Piece {
        let size = HEADER_BYTES + TRIANGLE_BYTES * u64::from(self.capacity);
        let shared = self.device.shares_memory();
        let use_of_host = if shared {
            wgpu::BufferUsages::STORAGE
        } else {
            wgpu::BufferUsages::COPY_SRC
        };
        Piece {
            host: self.device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("triangles"),
                size,
                usage: wgpu::BufferUsages::MAP_WRITE | use_of_host,
                mapped_at_creation: true,
            }),
            device: (!shared).then(|| self.device.storage("triangles", size)),
            masks: self.device.storage(
                "masks",
                MASK_BYTES * u64::from(KNOWN_BLOCKS * self.capacity),
            ),
            triangle_count: 0,
        }
    }

    /// Takes pieces back once all work with them is submitted.
    pub(super) fn give_back(&mut self, pieces: Vec<Piece>) {
        let request = |piece: Piece| {
            let mapping = Mapping::request(&piece.host, wgpu::MapMode::Write);
            (piece, mapping)
        };
        let used = self.used.get_mut().unwrap_or_else(PoisonError::into_inner);
        used.extend(pieces.into_iter().map(request));
    }

    /// Waits for the work with those pieces and makes them free again.
    pub(super) fn recycle(&mut self) -> Result<(), GpuError> {
        let free = self.free.get_mut().unwrap_or_else(PoisonError::into_inner);
        let used = self.used.get_mut().unwrap_or_else(PoisonError::into_inner);
        for (piece, mapping) in used.drain(..) {
            mapping.wait(self.device)?;
            free.push(piece);
        }
        Ok(())
    }
}

/// Fills pieces one after the other.
struct PieceWriter<'p> {
    pool: &'p PiecePool<'p>,
    view_pixel: u32,
    open: Option<(Piece, wgpu::BufferViewMut)>,
    done: Vec<Piece>,
    failed: Option<GpuError>,
}

impl<'p> PieceWriter<'p> {
    fn new(pool: &'p PiecePool<'p>, view_pixel: u32) -> Self {
        Self {
            pool,
            view_pixel,
            open: None,
            done: Vec::new(),
            failed: None,
        }
    }

    #[inline]
    fn push(&mut self, triangle: &SnappedTriangle) {
        let has_room = |open: &(Piece, _)| open.0.triangle_count < self.pool.capacity;
        if !self.open.as_ref().is_some_and(has_room) {
            self.turn_over();
        }
        // Nothing is open after a failure.
        if let Some((piece, bytes)) = &mut self.open {
            let at = (HEADER_BYTES + TRIANGLE_BYTES * u64::from(piece.triangle_count)) as usize;
            bytes
                .slice(at..at + TRIANGLE_BYTES as usize)
                .copy_from_slice(bytemuck::bytes_of(triangle));
            piece.triangle_count += 1;
        }
    }

    #[cold]
    fn turn_over(&mut self) {
        self.close();
        if self.failed.is_some() {
            return;
        }
        let mut piece = self.pool.take();
        piece.triangle_count = 0;
        match piece.host.get_mapped_range_mut(..) {
            Ok(bytes) => self.open = Some((piece, bytes)),
            Err(error) => self.failed = Some(GpuError::Failed(error.to_string())),
        }
    }

    fn close(&mut self) {
        if let Some((piece, mut bytes)) = self.open.take() {
            let header = [piece.triangle_count, self.view_pixel];
            bytes
                .slice(..HEADER_BYTES as usize)
                .copy_from_slice(bytemuck::bytes_of(&header));
            drop(bytes);
            piece.host.unmap();
            self.done.push(piece);
        }
    }

    fn finish(mut self) -> Result<Vec<Piece>, GpuError> {
        self.close();
        match self.failed {
            Some(error) => Err(self.pool.device.check().err().unwrap_or(error)),
            None => Ok(self.done),
        }
    }
}
