//! Leaves to leaf-ID images and areas with a depth buffer, without lists. The
//! twin of `cpu::draw_leaf_ids`; it shares only the triangle rasteriser with
//! [`fragments`](super::fragments) and so serves as its check.
//!
//! A chunk of views at a time: snap on the CPU; least depth of each pixel;
//! lowest leaf at that depth; histogram. While the GPU draws, the CPU snaps the
//! next chunk.

use super::chunk::chunks_of_views;
use super::fragments::{record_histogram, whole};
use super::memory::{Download, GrowingBuffer};
use super::pieces::{Piece, PiecePool};
use super::stages::{PIXEL_WORKGROUP, TRIANGLE_WORKGROUP};
use super::{Device, GpuError, cutouts};
use crate::{AreaTable, LeafIdImage, Scene};

/// The leaf-ID images of a scene, view 0 first, equal to those of
/// [`cpu::draw_leaf_ids`](crate::cpu::draw_leaf_ids).
///
/// # Errors
/// [`GpuError`] if the device fails, or something does not fit it.
///
/// # Panics
/// If the scene's resolution or pixels are out of range.
pub fn leaf_ids(device: &Device, scene: &Scene<'_>) -> Result<Vec<LeafIdImage>, GpuError> {
    let words = draw_all(device, scene, Wanted::Images)?;
    let image = |leaf_ids: &[u32]| LeafIdImage {
        resolution: scene.resolution,
        leaf_ids: leaf_ids.to_vec(),
    };
    Ok(words
        .chunks_exact(scene.pixels_per_view())
        .map(image)
        .collect())
}

/// The area table of a scene, equal to that of
/// [`cpu::areas`](crate::cpu::areas).
///
/// # Errors
/// As [`leaf_ids`].
///
/// # Panics
/// As [`leaf_ids`].
pub fn areas(device: &Device, scene: &Scene<'_>) -> Result<AreaTable, GpuError> {
    let words = draw_all(device, scene, Wanted::Areas)?;
    Ok(AreaTable::from_rows(scene.foliage.leaves().len(), words))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    Images,
    Areas,
}

/// Buffers for any chunk.
struct DrawJob<'a> {
    device: &'a Device,
    scene: &'a Scene<'a>,
    wanted: Wanted,
    cutouts: wgpu::Buffer,
    nearness: GrowingBuffer,
    image: GrowingBuffer,
    table: GrowingBuffer,
    spare: Option<wgpu::Buffer>,
}

fn draw_all(device: &Device, scene: &Scene<'_>, wanted: Wanted) -> Result<Vec<u32>, GpuError> {
    scene.assert_in_range();
    device.check()?;
    let mut run = DrawJob {
        device,
        scene,
        wanted,
        cutouts: cutouts::upload(device, scene.foliage.cutouts())?,
        nearness: GrowingBuffer::new("nearness"),
        image: GrowingBuffer::new("leaf IDs"),
        table: GrowingBuffer::new("areas"),
        spare: None,
    };
    let mut pool = PiecePool::new(device, scene);
    let mut words = Vec::new();
    let mut pending: Option<(Download, usize)> = None;
    for views in chunks_of_views(device, scene, &pool)? {
        let pieces = pool.snap(views.clone())?;
        if let Some(before) = pending.take() {
            run.collect(before, &mut words)?;
            pool.recycle()?;
        }
        pending = Some(run.draw(views.len(), &pieces));
        pool.give_back(pieces);
    }
    if let Some(last) = pending {
        run.collect(last, &mut words)?;
    }
    Ok(words)
}

impl DrawJob<'_> {
    /// Draws a chunk; returns what was wanted of it and its bytes.
    fn draw(&mut self, views: usize, pieces: &[Piece]) -> (Download, usize) {
        let device = self.device;
        let pixels = (views * self.scene.pixels_per_view()) as u32;
        let image_bytes = 4 * u64::from(pixels);
        let nearness = self.nearness.at_least(device, image_bytes);
        let image = self.image.at_least(device, image_bytes);
        let window = whole(pixels, 0).uniform(device, self.scene.resolution);
        let mut encoder = device.encoder();
        for piece in pieces {
            piece.record_upload(&mut encoder);
        }
        encoder.clear_buffer(&nearness, 0, None);
        encoder.clear_buffer(&image, 0, None);
        let mut pass = device.pass(&mut encoder);
        let stages = &device.stages;
        for stage in [&stages.nearest_depth, &stages.nearest_leaf] {
            for piece in pieces {
                let bindings = [
                    (0, &window),
                    (1, piece.buffer()),
                    (2, &self.cutouts),
                    (3, &nearness),
                    (5, &image),
                ];
                let is_leaf = std::ptr::eq(stage, &stages.nearest_leaf);
                let used = if is_leaf { 5 } else { 4 };
                let workgroups = piece.triangle_count().div_ceil(TRIANGLE_WORKGROUP);
                stage.run(device, &mut pass, &bindings[..used], [workgroups, 1, 1]);
            }
        }
        let workgroups = [pixels.div_ceil(PIXEL_WORKGROUP), 1, 1];
        let bindings = [(0, &window), (5, &image)];
        stages.uncover.run(device, &mut pass, &bindings, workgroups);
        drop(pass);
        let (wanted, bytes) = match self.wanted {
            Wanted::Images => (image, image_bytes),
            Wanted::Areas => {
                let row = self.scene.foliage.leaves().len() + 1;
                let bytes = 4 * (views * row) as u64;
                let table = self.table.at_least(device, bytes);
                record_histogram(device, &mut encoder, self.scene, views, &image, &table);
                (table, bytes)
            }
        };
        let parts = [(&wanted, 0, bytes)];
        let mut download = Download::record(device, &mut encoder, &parts, self.spare.take());
        device.queue.submit([encoder.finish()]);
        download.request();
        (download, bytes as usize)
    }

    fn collect(
        &mut self,
        (download, bytes): (Download, usize),
        words: &mut Vec<u32>,
    ) -> Result<(), GpuError> {
        let ((), spare) = download.read(self.device, |parts| {
            words.extend_from_slice(bytemuck::cast_slice(&parts[0][..bytes]));
        })?;
        self.spare = Some(spare);
        Ok(())
    }
}
