//! The shaders as pipelines, with the constants they take from here.

use rayon::prelude::*;

use super::Device;

/// Lanes of a workgroup where an invocation takes a triangle, or the histogram
/// a run of pixels.
pub(super) const TRIANGLE_WORKGROUP: u32 = 64;

/// Lanes of a workgroup where an invocation takes a pixel or a fragment: the
/// largest image in fewer than 65,536 workgroups.
pub(super) const PIXEL_WORKGROUP: u32 = 256;

/// Blocks of 8 x 8 pixels of a triangle's box whose covered pixels are kept from
/// counting to emitting.
pub(super) const KNOWN_BLOCKS: u32 = 4;

/// Pixels that one invocation of the prefix sum adds up.
pub(super) const SCAN_BLOCK: u32 = 256;

/// Pixels of a view that one workgroup of the histogram takes.
pub(super) const PIXELS_PER_WORKGROUP: u32 = 4096;

/// The longest list that is sorted by insertion.
pub(super) const INSERTION_MAX: u32 = 32;

/// The longest list that one invocation sorts.
pub(super) const HEAP_MAX: u32 = 1024;

/// One entry point of a shader, compiled for a device.
#[derive(Debug)]
pub(super) struct ComputeStage {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// A stage at work on some buffers.
#[derive(Clone, Copy)]
pub(super) struct Dispatch<'a> {
    /// The compute pipeline to run.
    pub(super) stage: &'a ComputeStage,
    /// Buffers by their number in group 0: exactly those the entry point uses.
    pub(super) bindings: &'a [(u32, &'a wgpu::Buffer)],
    /// Workgroups in each direction, at most 65,535; nothing is run where one
    /// is 0.
    pub(super) workgroups: [u32; 3],
}

/// Every compute pipeline of the rasteriser.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) probe: ComputeStage,
    pub(super) count: ComputeStage,
    pub(super) emit: ComputeStage,
    pub(super) nearest_depth: ComputeStage,
    pub(super) nearest_leaf: ComputeStage,
    pub(super) uncover: ComputeStage,
    pub(super) sum_blocks: ComputeStage,
    pub(super) scan_blocks: ComputeStage,
    pub(super) write_starts: ComputeStage,
    pub(super) sort_lists: ComputeStage,
    pub(super) exchange: ComputeStage,
    pub(super) mark: ComputeStage,
    pub(super) leaf_ids: ComputeStage,
    pub(super) histogram: ComputeStage,
}

/// A dispatch's bindings in group 0, by number.
pub(super) type Bindings<'a> = [(u32, &'a wgpu::Buffer)];

impl ComputeStage {
    /// Records a dispatch of `workgroups` in each direction; none of nothing.
    pub(super) fn run(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        bindings: &Bindings<'_>,
        workgroups: [u32; 3],
    ) {
        if workgroups.contains(&0) {
            return;
        }
        let entries: Vec<wgpu::BindGroupEntry<'_>> = bindings
            .iter()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = device.wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &entries,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let [x, y, z] = workgroups;
        pass.dispatch_workgroups(x, y, z);
    }
}

impl Stages {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let rasterise = module(device, "rasterise", secateur_shaders::RASTERISE);
        let scan = module(device, "fragments_scan", secateur_shaders::FRAGMENTS_SCAN);
        let sort = module(device, "fragments_sort", secateur_shaders::FRAGMENTS_SORT);
        let sort_long = module(
            device,
            "fragments_sort_long",
            secateur_shaders::FRAGMENTS_SORT_LONG,
        );
        let leaf_ids = module(device, "leaf_ids", secateur_shaders::LEAF_IDS);
        let histogram = module(device, "histogram", secateur_shaders::HISTOGRAM);
        let probe = module(device, "probe", secateur_shaders::PROBE);
        let lanes = ("WORKGROUP", TRIANGLE_WORKGROUP);
        let blocks = ("KNOWN_BLOCKS", KNOWN_BLOCKS);
        let pixel_lanes = ("WORKGROUP", PIXEL_WORKGROUP);
        let block = ("BLOCK", SCAN_BLOCK);
        let insertion = ("INSERTION_MAX", INSERTION_MAX);
        let heap = ("HEAP_MAX", HEAP_MAX);
        let pixels = ("PIXELS_PER_WORKGROUP", PIXELS_PER_WORKGROUP);
        let wanted: [EntryPoint<'_>; 14] = [
            (&probe, "count_up", &[]),
            (&rasterise, "count", &[lanes, blocks]),
            (&rasterise, "emit", &[lanes, blocks]),
            (&rasterise, "nearest_depth", &[lanes]),
            (&rasterise, "nearest_leaf", &[lanes]),
            (&rasterise, "uncover", &[pixel_lanes]),
            (&scan, "sum_blocks", &[pixel_lanes, block]),
            (&scan, "scan_blocks", &[block]),
            (&scan, "write_starts", &[pixel_lanes, block]),
            (&sort, "sort_lists", &[pixel_lanes, insertion, heap]),
            (&sort_long, "exchange", &[pixel_lanes]),
            (&sort_long, "mark", &[pixel_lanes]),
            (&leaf_ids, "leaf_ids", &[pixel_lanes]),
            (&histogram, "histogram", &[lanes, pixels]),
        ];
        // One after the other they take some tenths of a second where the driver has not kept them.
        let stages: Vec<ComputeStage> = wanted
            .into_par_iter()
            .map(|(module, entry, constants)| stage(device, module, entry, constants))
            .collect();
        let mut stages = stages.into_iter();
        // In the order in which they are wanted.
        let mut next = || stages.next().expect("a stage for each");
        Self {
            probe: next(),
            count: next(),
            emit: next(),
            nearest_depth: next(),
            nearest_leaf: next(),
            uncover: next(),
            sum_blocks: next(),
            scan_blocks: next(),
            write_starts: next(),
            sort_lists: next(),
            exchange: next(),
            mark: next(),
            leaf_ids: next(),
            histogram: next(),
        }
    }
}

/// A shader, the name of one of its entry points, and the constants that this takes.
type EntryPoint<'a> = (&'a wgpu::ShaderModule, &'a str, &'a [(&'a str, u32)]);

/// A shader, compiled; `stage` is what errors call it.
fn module(device: &wgpu::Device, stage: &str, wgsl: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(stage),
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
    })
}

pub(super) fn stage(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    entry: &str,
    constants: &[(&str, u32)],
) -> ComputeStage {
    let constants: Vec<(&str, f64)> = constants
        .iter()
        .map(|&(name, value)| (name, f64::from(value)))
        .collect();
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: None,
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &constants,
            ..Default::default()
        },
        cache: None,
    });
    let layout = pipeline.get_bind_group_layout(0);
    ComputeStage { pipeline, layout }
}
