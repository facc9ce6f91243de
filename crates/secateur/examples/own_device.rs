//! Rasterise on a wgpu device that the application has already.
//!
//! `cargo run --release --example own_device`

use std::error::Error;
use std::ops::ControlFlow;

use secateur::gpu::{Device, wgpu};
use secateur::plant::{EllipsoidCrown, ellipsoid_crown};
use secateur::{OpenEngine, Options, Resolution, Target, simplify_on};

fn main() -> Result<(), Box<dyn Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions::default();
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else {
        println!("there is no GPU adapter: nothing to show");
        return Ok(());
    };
    let descriptor = wgpu::DeviceDescriptor {
        // As large as they go: scenes are bound whole where they fit.
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;

    let device = Device::from_wgpu(device, queue, adapter.get_info())?;
    let on_gpu = OpenEngine::on_device(device);
    let foliage = ellipsoid_crown(500, 1, &EllipsoidCrown::default())?;
    let mut options = Options::to(Target::leaf_share(0.2));
    options.resolution = Resolution::Pixels(128);

    let mut orders = Vec::new();
    for engine in [&on_gpu, &OpenEngine::cpu()] {
        let result = simplify_on(engine, &foliage, &options, &mut |_| {
            ControlFlow::Continue(())
        })?;
        let name = result.adapter.unwrap_or("CPU".to_owned());
        println!("{name}: {}", result.passes.order.sha256());
        orders.push(result.passes.order);
    }
    assert_eq!(orders[0], orders[1], "the same, bit for bit");
    Ok(())
}
