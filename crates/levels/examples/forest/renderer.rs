//! Draws a frame and waits for it.

use glam::{DMat4, DVec3, DVec4};
use image::RgbaImage;
use secateur_runtime::stand::StandCamera;
use wgpu::{BufferUsages, IndexFormat};

use crate::draw_list::{Call, ChainKind, DrawList};
use crate::gpu::Gpu;
use crate::pipelines::{COLOR, DEPTH, Pipelines, SAMPLES};
use crate::uploaded::{ChainLevel, Uploaded, UploadedMesh};

/// Nearer and farther than this nothing is drawn, in metres.
const DEPTH_RANGE_M: [f64; 2] = [0.5, 4000.0];

/// Where frames are drawn to.
pub(crate) struct Renderer<'a> {
    gpu: &'a Gpu,
    pipelines: &'a Pipelines,
    uploaded: &'a Uploaded,
    leaf_indices: u32,
    /// Several samples a pixel, depth, and one sample a pixel.
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
    /// GPU memory that the frame's targets take, in bytes.
    pub(crate) target_bytes: u64,
}

/// What a frame took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameCost {
    pub(crate) triangles: u64,
    pub(crate) calls: usize,
    /// Bytes of records that were uploaded for it.
    pub(crate) bytes: u64,
}

impl<'a> Renderer<'a> {
    pub(crate) fn new(
        gpu: &'a Gpu,
        pipelines: &'a Pipelines,
        uploaded: &'a Uploaded,
        leaf_indices: u32,
        size: [u32; 2],
    ) -> Self {
        let before = gpu.bytes_made();
        let resolved = gpu.target(size, COLOR, 1);
        let view = |texture: wgpu::Texture| texture.create_view(&Default::default());
        Self {
            samples: view(gpu.target(size, COLOR, SAMPLES)),
            depth: view(gpu.target(size, DEPTH, SAMPLES)),
            resolved,
            target_bytes: gpu.bytes_made() - before,
            gpu,
            pipelines,
            uploaded,
            leaf_indices,
        }
    }

    /// Draws a list, and waits until it is done.
    pub(crate) fn draw(&self, list: &DrawList, camera: &StandCamera) -> FrameCost {
        let before = self.gpu.bytes_made();
        let frame = self.gpu.buffer(&frame(camera), BufferUsages::UNIFORM);
        let items = self.gpu.buffer(&list.items, BufferUsages::STORAGE);
        let listed = self.gpu.buffer(&list.listed, BufferUsages::STORAGE);
        let bytes = self.gpu.bytes_made() - before;
        let resources = [
            frame.as_entire_binding(),
            items.as_entire_binding(),
            listed.as_entire_binding(),
            wgpu::BindingResource::Sampler(&self.pipelines.sampler),
        ];
        let entries: Vec<wgpu::BindGroupEntry<'_>> = resources
            .into_iter()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self
            .gpu
            .device
            .create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.pipelines.frame,
                entries: &entries,
            });
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut drawn = FrameCost {
            bytes,
            ..FrameCost::default()
        };
        {
            let view = self.resolved.create_view(&Default::default());
            let mut pass = self.begin(&mut encoder, &view);
            pass.set_bind_group(1, &group, &[]);
            pass.set_pipeline(&self.pipelines.sky);
            pass.draw(0..3, 0..1);
            self.calls(&mut pass, list, &mut drawn);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait();
        drawn
    }

    fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        resolved: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    fn calls(&self, pass: &mut wgpu::RenderPass<'_>, list: &DrawList, drawn: &mut FrameCost) {
        let (uploaded, pipelines) = (self.uploaded, self.pipelines);
        // Calls of one kind after each other: pipelines are set as seldom as can be.
        let kinds: [fn(&Call) -> bool; 5] = [
            |call| matches!(call, Call::Level { .. }),
            |call| matches!(call, Call::Wood { .. }),
            |call| matches!(call, Call::Leaves { .. }),
            |call| matches!(call, Call::Listed),
            |call| matches!(call, Call::Box { .. }),
        ];
        for (kind, is_of_kind) in kinds.iter().enumerate() {
            let mut calls = list.calls.iter().filter(|call| is_of_kind(call)).peekable();
            if calls.peek().is_none() {
                continue;
            }
            match kind {
                1 => {
                    set_mesh(pass, &uploaded.wood.prefix);
                    pass.set_pipeline(&pipelines.prefix_wood);
                    pass.set_bind_group(0, &uploaded.wood.tables, &[]);
                    pass.set_bind_group(2, &uploaded.wood.material, &[]);
                }
                0 | 2 | 3 => {
                    set_mesh(pass, &uploaded.leaves.prefix);
                    pass.set_pipeline(match kind {
                        2 => &pipelines.prefix_leaves,
                        _ => &pipelines.listed_leaves,
                    });
                    pass.set_bind_group(0, &uploaded.leaves.tables, &[]);
                    pass.set_bind_group(2, &uploaded.leaves.material, &[]);
                }
                _ => {
                    pass.set_pipeline(&pipelines.boxes);
                    pass.set_bind_group(3, uploaded.boxes.as_ref(), &[]);
                }
            }
            for call in calls {
                drawn.calls += 1;
                drawn.triangles += self.call(pass, call, list);
            }
        }
    }

    fn call(&self, pass: &mut wgpu::RenderPass<'_>, call: &Call, list: &DrawList) -> u64 {
        match call {
            Call::Level {
                chain,
                level,
                items,
            } => {
                let levels = match chain {
                    ChainKind::Halvings => &self.uploaded.halvings,
                    ChainKind::Shares => &self.uploaded.shares,
                };
                let ChainLevel { leaves, wood, .. } = &levels[*level];
                pass.set_pipeline(&self.pipelines.plain_leaves);
                pass.set_bind_group(2, &self.uploaded.leaves.material, &[]);
                set_mesh(pass, leaves);
                pass.draw_indexed(0..leaves.index_count, 0, items.clone());
                pass.set_pipeline(&self.pipelines.plain_wood);
                pass.set_bind_group(2, &self.uploaded.wood.material, &[]);
                set_mesh(pass, wood);
                pass.draw_indexed(0..wood.index_count, 0, items.clone());
                u64::from((leaves.index_count + wood.index_count) / 3) * items.len() as u64
            }
            Call::Leaves { indices, item } | Call::Wood { indices, item } => {
                pass.draw_indexed(0..*indices, 0, *item..*item + 1);
                u64::from(indices / 3)
            }
            Call::Listed => {
                let indices = list.listed.len() as u32 * self.leaf_indices;
                pass.draw(0..indices, 0..1);
                u64::from(indices / 3)
            }
            Call::Box { index, items } => {
                let first = 36 * *index as u32;
                pass.draw(first..first + 36, items.clone());
                12 * items.len() as u64
            }
        }
    }

    /// What was drawn last.
    pub(crate) fn picture(&self) -> RgbaImage {
        let (width, height) = (self.resolved.width(), self.resolved.height());
        let texels = self.gpu.read(&self.resolved);
        RgbaImage::from_raw(width, height, texels).expect("four bytes a pixel")
    }
}

fn set_mesh(pass: &mut wgpu::RenderPass<'_>, mesh: &UploadedMesh) {
    pass.set_vertex_buffer(0, mesh.vertices.slice(..));
    pass.set_index_buffer(mesh.indices.slice(..), IndexFormat::Uint32);
}

/// What the shader knows of the camera.
fn frame(camera: &StandCamera) -> [f32; 36] {
    let forward = camera.forward.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let [x, y] = camera.half_tangents();
    let [near, far] = DEPTH_RANGE_M;
    // Depth from 0 at `near` to 1 at `far`.
    let (depth, offset) = (far / (far - near), -near * far / (far - near));
    let row = |axis: DVec3, by: f64| (by * axis).extend(-by * axis.dot(camera.eye));
    let ahead = row(forward, 1.0);
    let view_projection = DMat4::from_cols(
        row(right, 1.0 / x),
        row(up, 1.0 / y),
        depth * ahead + offset * DVec4::W,
        ahead,
    )
    .transpose();
    let sun = DVec3::new(-0.45, 0.75, 0.5).normalize();
    let vectors = [camera.eye, forward, x * right, y * up, sun];
    let mut words = [0.0; 36];
    words[..16].copy_from_slice(&view_projection.as_mat4().to_cols_array());
    for (k, vector) in vectors.iter().enumerate() {
        words[16 + 4 * k..19 + 4 * k].copy_from_slice(&vector.as_vec3().to_array());
    }
    words
}
