//! The pipelines that draw a stand, and what they bind.

use crate::gpu::Gpu;

/// Samples a pixel takes in multisampling.
pub(crate) const SAMPLES: u32 = 4;

pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// One for each kind of thing that is drawn.
pub(crate) struct Pipelines {
    pub(crate) sky: wgpu::RenderPipeline,
    pub(crate) plain_leaves: wgpu::RenderPipeline,
    pub(crate) plain_wood: wgpu::RenderPipeline,
    pub(crate) prefix_leaves: wgpu::RenderPipeline,
    pub(crate) prefix_wood: wgpu::RenderPipeline,
    pub(crate) listed_leaves: wgpu::RenderPipeline,
    pub(crate) boxes: wgpu::RenderPipeline,
    /// Sizes and centres of a model's leaves; and vertices and indices to pull.
    pub(crate) model: wgpu::BindGroupLayout,
    /// Camera, items, lists, sampler.
    pub(crate) frame: wgpu::BindGroupLayout,
    /// The layout of a material's bindings: its texture and sampler.
    pub(crate) material: wgpu::BindGroupLayout,
    /// Pictures and planes of boxes.
    pub(crate) box_pictures: wgpu::BindGroupLayout,
    pub(crate) sampler: wgpu::Sampler,
}

const STORAGE: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};

const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

const fn texture(view_dimension: wgpu::TextureViewDimension) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    }
}

fn layout(gpu: &Gpu, bindings: &[(u32, wgpu::BindingType)]) -> wgpu::BindGroupLayout {
    let entries: Vec<wgpu::BindGroupLayoutEntry> = bindings
        .iter()
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding: *binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: *ty,
            count: None,
        })
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device.create_bind_group_layout(&descriptor)
}

impl Pipelines {
    /// `leaf_indices`: three for each triangle of the largest leaf.
    pub(crate) fn new(gpu: &Gpu, leaf_indices: u32) -> Self {
        let source = [secateur_shaders::LEAF_SIZES, include_str!("forest.wgsl")].concat();
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("forest"),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
        let array = texture(wgpu::TextureViewDimension::D2Array);
        let model = layout(gpu, &[1, 2, 3, 5, 6, 7].map(|binding| (binding, STORAGE)));
        let frame = layout(
            gpu,
            &[(0, UNIFORM), (1, STORAGE), (2, STORAGE), (3, SAMPLER)],
        );
        let material = layout(gpu, &[(0, texture(wgpu::TextureViewDimension::D2))]);
        let box_pictures = layout(gpu, &[(0, array), (1, array), (2, STORAGE)]);
        let of_leaves = [Some(&model), Some(&frame), Some(&material)];
        let of_boxes = [None, Some(&frame), None, Some(&box_pictures)];
        let pipeline = |groups: &[Option<&wgpu::BindGroupLayout>],
                        [vertex, fragment]: [&str; 2],
                        culled: bool| {
            make(
                gpu,
                &module,
                groups,
                [vertex, fragment],
                culled,
                leaf_indices,
            )
        };
        Self {
            sky: pipeline(&[None, Some(&frame)], ["vs_sky", "fs_sky"], false),
            plain_leaves: pipeline(&of_leaves, ["vs_plain", "fs_leaf"], false),
            plain_wood: pipeline(&of_leaves, ["vs_plain", "fs_wood"], true),
            prefix_leaves: pipeline(&of_leaves, ["vs_prefix", "fs_leaf"], false),
            prefix_wood: pipeline(&of_leaves, ["vs_prefix", "fs_wood"], true),
            listed_leaves: pipeline(&of_leaves, ["vs_listed", "fs_leaf"], false),
            boxes: pipeline(&of_boxes, ["vs_box", "fs_box"], false),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            model,
            frame,
            material,
            box_pictures,
        }
    }
}

fn make(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    groups: &[Option<&wgpu::BindGroupLayout>],
    [vertex, fragment]: [&str; 2],
    culled: bool,
    leaf_indices: u32,
) -> wgpu::RenderPipeline {
    let pipeline_layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: groups,
            immediate_size: 0,
        });
    let attributes = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4, 3 => Float32x2, 4 => Uint32
    ];
    let corners = wgpu::VertexBufferLayout {
        array_stride: 32,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let has_corners = matches!(vertex, "vs_plain" | "vs_prefix");
    let buffers = [Some(corners)];
    let is_sky = vertex == "vs_sky";
    let constants = [("LEAF_INDICES", f64::from(leaf_indices))];
    let vertex_options = wgpu::PipelineCompilationOptions {
        constants: if vertex == "vs_listed" {
            &constants
        } else {
            &[]
        },
        ..Default::default()
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: vertex_options,
                buffers: if has_corners { &buffers } else { &[] },
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: culled.then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(!is_sky),
                depth_compare: Some(match is_sky {
                    true => wgpu::CompareFunction::Always,
                    false => wgpu::CompareFunction::Less,
                }),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: SAMPLES,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
}
