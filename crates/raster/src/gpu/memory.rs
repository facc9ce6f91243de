//! Buffers, and the way back from them.

use std::sync::mpsc;
use std::time::Duration;

use super::stages::Dispatch;
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

/// How long a callback may take after its work is done: another thread may be
/// the one that runs it.
const CALLBACK_TIMEOUT: Duration = Duration::from_secs(10);

/// A buffer about to be mapped.
#[derive(Debug)]
pub(super) struct Mapping(mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>);

impl Mapping {
    /// Asks for the whole buffer, once the work with it is submitted.
    pub(super) fn request(buffer: &wgpu::Buffer, mode: wgpu::MapMode) -> Self {
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(mode, .., move |result| {
            // Nobody listens where an earlier error ended the run.
            let _ = sender.send(result);
        });
        Self(receiver)
    }

    /// Waits until the work is done and the buffer mapped.
    pub(super) fn wait(&self, device: &Device) -> Result<(), GpuError> {
        if let Ok(Ok(())) = self.0.try_recv() {
            return device.check();
        }
        device.wait()?;
        match self.0.recv_timeout(CALLBACK_TIMEOUT) {
            Ok(Ok(())) => Ok(()),
            Ok(Err(error)) => Err(GpuError::Failed(error.to_string())),
            Err(error) => Err(GpuError::Failed(error.to_string())),
        }
    }
}

/// Parts of buffers on their way to the CPU, one behind the other.
#[derive(Debug)]
pub(super) struct Download {
    buffer: wgpu::Buffer,
    ends: Vec<u64>,
    mapping: Option<Mapping>,
}

/// What is copied: a buffer, the first byte, the number of bytes; both multiples of 4.
pub(super) type BufferRange<'a> = (&'a wgpu::Buffer, u64, u64);

impl Download {
    /// Records the copies. `spare` is the buffer of an earlier download.
    pub(super) fn record(
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        parts: &[BufferRange<'_>],
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
            mapping: None,
        }
    }

    /// Asks for the bytes, once the copies are submitted.
    pub(super) fn request(&mut self) {
        self.mapping = Some(Mapping::request(&self.buffer, wgpu::MapMode::Read));
    }

    /// Hands each part's bytes to `read`, then gives the buffer back as a spare.
    pub(super) fn read<R>(
        self,
        device: &Device,
        read: impl FnOnce(&[&[u8]]) -> R,
    ) -> Result<(R, wgpu::Buffer), GpuError> {
        let mapping = self.mapping.as_ref();
        mapping
            .expect("a download is requested before it is read")
            .wait(device)?;
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
    /// A storage buffer of at least this many bytes, filled with zeros.
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

    /// Runs dispatches one after the other, waits, and returns the first
    /// `bytes` bytes of a buffer as words.
    ///
    /// # Errors
    /// [`GpuError`] if the device fails or the dispatches break a rule of wgpu.
    pub(super) fn run(
        &self,
        dispatches: &[Dispatch<'_>],
        result: &wgpu::Buffer,
        bytes: u64,
    ) -> Result<Vec<u32>, GpuError> {
        let mut encoder = self.encoder();
        let mut pass = self.pass(&mut encoder);
        for dispatch in dispatches {
            let Dispatch {
                stage,
                bindings,
                workgroups,
            } = *dispatch;
            stage.run(self, &mut pass, bindings, workgroups);
        }
        drop(pass);
        let mut download = Download::record(self, &mut encoder, &[(result, 0, bytes)], None);
        self.queue.submit([encoder.finish()]);
        download.request();
        let (words, _) = download.read(self, |parts| {
            bytemuck::cast_slice(&parts[0][..bytes as usize]).to_vec()
        })?;
        Ok(words)
    }
}
