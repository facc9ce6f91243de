//! Buffers, and the way back from them.

use std::sync::mpsc;

use super::{Device, GpuError};

/// A storage buffer that is made anew when it must be larger.
#[derive(Debug)]
pub(super) struct GrowingBuffer {
    label: &'static str,
    buffer: Option<wgpu::Buffer>,
}

impl GrowingBuffer {
    pub(super) fn new(label: &'static str) -> Self {
        Self {
            label,
            buffer: None,
        }
    }

    /// The buffer, of at least `bytes`; its contents are unknown.
    pub(super) fn at_least(&mut self, device: &Device, bytes: u64) -> wgpu::Buffer {
        match &self.buffer {
            Some(buffer) if buffer.size() >= bytes => buffer.clone(),
            _ => {
                let buffer = device.storage(self.label, bytes);
                self.buffer.insert(buffer).clone()
            }
        }
    }
}

/// Parts of buffers on their way to the CPU, one behind the other.
#[derive(Debug)]
pub(super) struct Download {
    buffer: wgpu::Buffer,
    ends: Vec<u64>,
    mapped: Option<mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

/// What is copied: a buffer, from a byte, so many bytes; all multiples of 4.
pub(super) type Part<'a> = (&'a wgpu::Buffer, u64, u64);

impl Download {
    /// Records the copies. `spare` is the buffer of an earlier download.
    pub(super) fn record(
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        parts: &[Part<'_>],
        spare: Option<wgpu::Buffer>,
    ) -> Self {
        let mut ends = Vec::with_capacity(parts.len());
        let mut end = 0u64;
        for (_, _, bytes) in parts {
            end += bytes.next_multiple_of(wgpu::MAP_ALIGNMENT);
            ends.push(end);
        }
        let size = end.max(wgpu::MAP_ALIGNMENT);
        let buffer = match spare {
            Some(buffer) if buffer.size() >= size => buffer,
            _ => device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("download"),
                size,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        };
        let mut at = 0;
        for (&(source, from, bytes), &end) in parts.iter().zip(&ends) {
            if bytes > 0 {
                encoder.copy_buffer_to_buffer(source, from, &buffer, at, bytes);
            }
            at = end;
        }
        Self {
            buffer,
            ends,
            mapped: None,
        }
    }

    /// Asks for the bytes, once the copies are submitted.
    pub(super) fn request(&mut self) {
        let (sender, receiver) = mpsc::channel();
        self.buffer
            .slice(..)
            .map_async(wgpu::MapMode::Read, move |result| {
                // Nobody listens where an earlier error ended the run.
                let _ = sender.send(result);
            });
        self.mapped = Some(receiver);
    }

    fn has_arrived(&self) -> bool {
        let answer = self.mapped.as_ref().map(mpsc::Receiver::try_recv);
        matches!(answer, Some(Ok(Ok(()))))
    }

    /// Hands each part's bytes to `read`, then gives the buffer back as a spare.
    pub(super) fn read<R>(
        self,
        device: &Device,
        read: impl FnOnce(&[&[u8]]) -> R,
    ) -> Result<(R, wgpu::Buffer), GpuError> {
        if !self.has_arrived() {
            device.wait()?;
            if !self.has_arrived() {
                return Err(GpuError::Failed("results cannot be read".to_owned()));
            }
        }
        let view = self
            .buffer
            .slice(..)
            .get_mapped_range()
            .map_err(|e| GpuError::Failed(e.to_string()))?;
        let mut parts = Vec::with_capacity(self.ends.len());
        let mut at = 0;
        for &end in &self.ends {
            parts.push(&view[at as usize..end as usize]);
            at = end;
        }
        let result = read(&parts);
        drop(parts);
        drop(view);
        self.buffer.unmap();
        device.check()?;
        Ok((result, self.buffer))
    }
}

impl Device {
    /// A storage buffer; its contents are zero.
    pub(super) fn storage(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(16).max(16),
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// A storage buffer with these words.
    pub(super) fn storage_of(&self, label: &str, words: &[u32]) -> wgpu::Buffer {
        let buffer = self.storage(label, 4 * words.len() as u64);
        self.queue
            .write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        buffer
    }

    /// A uniform buffer of four words.
    pub(super) fn uniform(&self, words: &[u32; 4]) -> wgpu::Buffer {
        let buffer = self.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("uniform"),
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue
            .write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        buffer
    }

    pub(super) fn encoder(&self) -> wgpu::CommandEncoder {
        self.wgpu
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    pub(super) fn pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default())
    }

    /// Submits, waits, and returns the first `bytes` bytes of a buffer as words.
    pub(super) fn read_back_now(
        &self,
        mut encoder: wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        bytes: u64,
    ) -> Result<Vec<u32>, GpuError> {
        let mut download = Download::record(self, &mut encoder, &[(buffer, 0, bytes)], None);
        self.queue.submit([encoder.finish()]);
        download.request();
        let (words, _) = download.read(self, |parts| {
            bytemuck::cast_slice(&parts[0][..bytes as usize]).to_vec()
        })?;
        Ok(words)
    }
}
