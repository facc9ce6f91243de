//! A GPU, and how buffers and textures get there. Counts the bytes.

use std::cell::Cell;

use secateur_model::Texture;
use wgpu::util::DeviceExt as _;

/// An open graphics device, with the name of its adapter.
pub(crate) struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// The adapter and its driver.
    pub(crate) adapter: String,
    bytes: Cell<u64>,
}

impl Gpu {
    /// Opens the adapter that wgpu takes for the best.
    pub(crate) fn open() -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| format!("there is no GPU adapter: {error}"))?;
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| format!("{} cannot be opened: {error}", info.name))?;
        let adapter = format!("{} {} {}", info.name, info.driver, info.driver_info);
        Ok(Self {
            device,
            queue,
            adapter: adapter.trim().to_owned(),
            bytes: Cell::new(0),
        })
    }

    /// Bytes of all buffers and textures made so far, those that were freed too.
    pub(crate) fn bytes_made(&self) -> u64 {
        self.bytes.get()
    }

    fn count(&self, bytes: u64) {
        self.bytes.set(self.bytes.get() + bytes);
    }

    /// A buffer with contents; of at least 16 bytes, since none may be empty.
    pub(crate) fn buffer<T: bytemuck::Pod>(
        &self,
        contents: &[T],
        usage: wgpu::BufferUsages,
    ) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(contents);
        let padded;
        let contents = match bytes.len() < 16 {
            true => {
                padded = [bytes, &[0; 16][bytes.len()..]].concat();
                &padded
            }
            false => bytes,
        };
        self.count(contents.len() as u64);
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage,
        };
        self.device.create_buffer_init(&descriptor)
    }

    /// A texture that is drawn to.
    pub(crate) fn target(
        &self,
        size: [u32; 2],
        format: wgpu::TextureFormat,
        samples: u32,
    ) -> wgpu::Texture {
        let bytes = u64::from(size[0] * size[1] * samples) * 4;
        self.count(bytes);
        let mut usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        if samples == 1 {
            usage |= wgpu::TextureUsages::COPY_SRC;
        }
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size, 1),
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// Pictures of one size, four bytes a texel, with all their mips, as the layers of a texture.
    pub(crate) fn layers(
        &self,
        size: [u32; 2],
        pictures: &[Vec<u8>],
        format: wgpu::TextureFormat,
    ) -> wgpu::TextureView {
        let mips = size[0].min(size[1]).ilog2() + 1;
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size, pictures.len() as u32),
            mip_level_count: mips,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (layer, picture) in pictures.iter().enumerate() {
            let mut level = (size, picture.clone());
            for mip in 0..mips {
                self.count(level.1.len() as u64);
                self.write(&texture, &level.1, level.0, mip, layer as u32);
                level = halved(level.0, &level.1);
            }
        }
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(match pictures.len() {
                1 => wgpu::TextureViewDimension::D2,
                _ => wgpu::TextureViewDimension::D2Array,
            }),
            ..Default::default()
        })
    }

    fn write(&self, texture: &wgpu::Texture, texels: &[u8], size: [u32; 2], mip: u32, layer: u32) {
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: mip,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: 0,
                    z: layer,
                },
                aspect: wgpu::TextureAspect::All,
            },
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * size[0]),
                rows_per_image: None,
            },
            extent(size, 1),
        );
    }

    /// A material's picture; white where it has none.
    pub(crate) fn picture(&self, texture: Option<&Texture>) -> wgpu::TextureView {
        let white = (([1, 1]), vec![vec![255; 4]]);
        let (size, pictures) = texture.map_or(white, |texture| {
            ([texture.width, texture.height], vec![texture.rgba.clone()])
        });
        self.layers(size, &pictures, wgpu::TextureFormat::Rgba8UnormSrgb)
    }

    /// Waits until all that was submitted is done.
    pub(crate) fn wait(&self) {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        polled.expect("the device is there");
    }

    /// The texels of a texture of four bytes a texel, row by row from the top.
    pub(crate) fn read(&self, texture: &wgpu::Texture) -> Vec<u8> {
        let (width, height) = (texture.width(), texture.height());
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            extent([width, height], 1),
        );
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |mapped| {
            mapped.expect("a buffer of ours");
        });
        self.wait();
        let bytes = buffer.get_mapped_range(..).expect("it is mapped");
        let rows = bytes.chunks(row as usize);
        rows.flat_map(|bytes| &bytes[..4 * width as usize])
            .copied()
            .collect()
    }
}

fn extent([width, height]: [u32; 2], layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: layers,
    }
}

/// A picture half as wide and high: each texel the mean of four, of those that are not clear.
fn halved(size: [u32; 2], texels: &[u8]) -> ([u32; 2], Vec<u8>) {
    let half = size.map(|side| (side / 2).max(1));
    let mut out = Vec::with_capacity(4 * (half[0] * half[1]) as usize);
    for y in 0..half[1] {
        for x in 0..half[0] {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
                let [x, y] = [(2 * x + dx).min(size[0] - 1), (2 * y + dy).min(size[1] - 1)];
                let at = 4 * (y * size[0] + x) as usize;
                [0, 1, 2, 3].map(|k| u32::from(texels[at + k]))
            });
            let alpha: u32 = four.iter().map(|texel| texel[3]).sum();
            for k in 0..3 {
                // A clear texel's colour is of no meaning, but where all are clear.
                let sum = |weight: fn(&[u32; 4]) -> u32| {
                    let all: u32 = four.iter().map(weight).sum();
                    let sum: u32 = four.iter().map(|texel| texel[k] * weight(texel)).sum();
                    (sum + all / 2) / all.max(1)
                };
                let mean = match alpha {
                    0 => sum(|_| 1),
                    _ => sum(|texel| texel[3]),
                };
                out.push(mean as u8);
            }
            out.push(((alpha + 2) / 4) as u8);
        }
    }
    (half, out)
}
