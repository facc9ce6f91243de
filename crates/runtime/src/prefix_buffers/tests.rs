use std::ops::ControlFlow;

use secateur_model::{Growth, LodModel, RemovalOrder};
use secateur_plant::{EllipsoidCrown, Random, ellipsoid_crown};
use secateur_simplify::fsa::{self, FsaOptions};
use secateur_simplify::stochastic::{self, StochasticOptions};
use wgpu::util::DeviceExt;

use super::*;

/// Sizes straddle the workgroup.
const WORKGROUP: usize = 64;

fn foliage(leaves: u32) -> Foliage {
    ellipsoid_crown(leaves, 5, &EllipsoidCrown::default()).unwrap()
}

/// Leaf collapse, stochastic pruning, and one that goes for one that grows.
fn models(foliage: &Foliage) -> Vec<LodModel> {
    let go_on = &mut |_| ControlFlow::Continue(());
    let collapsed = fsa::simplify(foliage, 2, &FsaOptions::default(), go_on).unwrap();
    let pruned = stochastic::simplify(foliage, 2, &StochasticOptions::default());
    let mut grown = RemovalOrder::new(foliage.leaves().len() as u32);
    let mut random = Random::new(9);
    for (index, leaf) in pruned.removed().iter().enumerate() {
        let others = &pruned.removed()[index + 1..];
        if others.is_empty() {
            break;
        }
        let heir = others[(random.bits() % others.len() as u64) as usize];
        let area_scale = 1.0 + index as f64 / 7.0;
        grown.push(
            *leaf,
            &[Growth {
                leaf: heir,
                area_scale,
            }],
        );
    }
    let orders = [collapsed, pruned, grown];
    orders
        .into_iter()
        .map(|order| LodModel::new(order, foliage).unwrap())
        .collect()
}

#[test]
fn a_prefix_holds_the_leaves_of_its_level_at_their_sizes() {
    let foliage = foliage(120);
    for model in models(&foliage) {
        let buffers = PrefixBuffers::new(&model, &foliage);
        let mut level = model.finest();
        for steps in 0..=model.order().len() {
            level.go_to(steps);
            let prefix = &buffers.leaves()[..buffers.places_after(steps as u32)];
            let mut drawn: Vec<(LeafId, u32)> = prefix
                .iter()
                .enumerate()
                .map(|(place, leaf)| (*leaf, buffers.scale_bits(place, steps as u32)))
                .filter(|(_, bits)| *bits != 0)
                .collect();
            drawn.sort_unstable();
            let all = (0..model.order().name_count()).map(LeafId::from_index);
            let expected = all.filter_map(|leaf| {
                let own = level.own_area_scale(leaf)?;
                Some((leaf, (own.sqrt() as f32).to_bits()))
            });
            assert!(drawn.into_iter().eq(expected), "after {steps} steps");
            let common = level.survivors_area_scale().sqrt() as f32;
            assert_eq!(buffers.common_linear_scale(steps as u32), common);
        }
        let last = model.order().len() as u32;
        assert!(buffers.triangles_after(last) < buffers.triangles_after(0));
    }
}

#[test]
fn a_leaf_fades_over_the_steps_before_it_goes() {
    let mut order = RemovalOrder::new(8);
    for number in 1..=7 {
        order.push(LeafId::new(number).unwrap(), &[]);
    }
    let foliage = foliage(8);
    let model = LodModel::new(order, &foliage).unwrap();
    let buffers = PrefixBuffers::new(&model, &foliage);
    // Leaf 7 goes in the last step, leaf 8 never.
    assert_eq!(
        buffers.leaves()[..2]
            .iter()
            .map(|l| l.get())
            .collect::<Vec<_>>(),
        [8, 7]
    );
    let shown = |steps| buffers.shown(1, steps, 4);
    assert_eq!(
        [0, 3, 4, 5, 6, 7].map(shown),
        [WHOLE, WHOLE, WHOLE / 4 * 3, WHOLE / 2, WHOLE / 4, 0]
    );
    assert_eq!([0, 7].map(|steps| buffers.shown(0, steps, 4)), [WHOLE; 2]);
    assert_eq!([6, 7].map(|steps| buffers.shown(1, steps, 0)), [WHOLE, 0]);
}

/// The lookup of the shader, leaf by leaf.
fn on_gpu(
    (device, queue): &(wgpu::Device, wgpu::Queue),
    buffers: &PrefixBuffers,
    steps: u32,
    fade_steps: u32,
) -> Vec<[u32; 2]> {
    let leaves = buffers.leaves().len();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(secateur_shaders::LEAF_SIZES.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("leaf_sizes"),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &[("WORKGROUP", WORKGROUP as f64)],
            ..Default::default()
        },
        cache: None,
    });
    let buffer = |words: &[u32], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(words),
            usage,
        })
    };
    let sizes: Vec<u32> = buffers
        .sizes()
        .iter()
        .flat_map(|size| [size.step, size.scale_bits])
        .collect();
    let storage = wgpu::BufferUsages::STORAGE;
    let found = vec![u32::MAX; 2 * leaves];
    let bound = [
        buffer(
            &[steps, fade_steps, leaves as u32, 0],
            wgpu::BufferUsages::UNIFORM,
        ),
        buffer(buffers.first_size(), storage),
        buffer(&sizes, storage),
        buffer(buffers.gone_after(), storage),
        buffer(&found, storage | wgpu::BufferUsages::COPY_SRC),
    ];
    let entries = bound
        .iter()
        .zip(0..)
        .map(|(buffer, binding)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries.collect::<Vec<_>>(),
    });
    let bytes = 8 * leaves as u64;
    let read = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(leaves.div_ceil(WORKGROUP) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&bound[4], 0, &read, 0, bytes);
    queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let view = read.get_mapped_range(..).unwrap();
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&view[..]);
    words.as_chunks().0.to_vec()
}

fn gpu() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions::default();
    let adapter = pollster::block_on(instance.request_adapter(&options)).ok();
    let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
    assert!(adapter.is_some() || !is_required, "there is no GPU adapter");
    let descriptor = wgpu::DeviceDescriptor::default();
    pollster::block_on(adapter?.request_device(&descriptor)).ok()
}

#[test]
fn the_shader_finds_what_its_twin_finds_bit_for_bit() {
    let Some(gpu) = gpu() else {
        eprintln!("SKIPPED: there is no GPU adapter");
        return;
    };
    for leaves in [2, 63, 64, 65, 500] {
        let foliage = foliage(leaves);
        for model in models(&foliage) {
            let buffers = PrefixBuffers::new(&model, &foliage);
            let last = model.order().len() as u32;
            for (steps, fade_steps) in [
                (0, 0),
                (last / 3, 5),
                (last.saturating_sub(1), 3),
                (last, 1),
            ] {
                let places = 0..buffers.leaves().len();
                let expected = places.map(|place| {
                    [
                        buffers.scale_bits(place, steps),
                        buffers.shown(place, steps, fade_steps),
                    ]
                });
                let found = on_gpu(&gpu, &buffers, steps, fade_steps);
                assert!(
                    found.into_iter().eq(expected),
                    "{leaves} leaves, {steps} steps"
                );
            }
        }
    }
}
