//! A GPU to compare shaders with their twins.

/// A device, or nothing where there is no adapter and none is required.
pub(crate) fn gpu() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions::default();
    let adapter = pollster::block_on(instance.request_adapter(&options)).ok();
    let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
    assert!(adapter.is_some() || !is_required, "there is no GPU adapter");
    let descriptor = wgpu::DeviceDescriptor::default();
    pollster::block_on(adapter?.request_device(&descriptor)).ok()
}

/// Runs a shader (its source, entry point and constants) on these buffers, by their bindings, and
/// returns the words of the last one.
pub(crate) fn compute(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    (source, entry_point, constants): (&str, &str, &[(&str, f64)]),
    buffers: &[wgpu::Buffer],
    groups: u32,
) -> Vec<u32> {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants,
            ..Default::default()
        },
        cache: None,
    });
    let entries = (buffers.iter().zip(0..)).map(|(buffer, binding)| wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries.collect::<Vec<_>>(),
    });
    let last = buffers.last().expect("a buffer for the results");
    let read = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: last.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(groups, 1, 1);
    }
    encoder.copy_buffer_to_buffer(last, 0, &read, 0, last.size());
    queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let view = read.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&view[..])
}
