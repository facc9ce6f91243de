//! A GPU to run the stages on.

use std::sync::{Arc, Mutex, PoisonError};

use super::GpuError;
use super::stages::{Dispatch, Stages};

/// Which adapters will do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preference {
    /// A real GPU, no software driver.
    Hardware,
    /// A real GPU if there is one, else a software driver.
    Any,
}

/// A GPU with the stages' pipelines, made once and used for any number of
/// scenes, from one thread at a time or several.
#[derive(Debug)]
pub struct Device {
    pub(super) wgpu: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) stages: Stages,
    info: wgpu::AdapterInfo,
    binding_limit: u64,
    fault: Fault,
}

/// The first error the driver reported outside of a call.
type Fault = Arc<Mutex<Option<GpuError>>>;

/// How far the probe's loop must count; sound drivers do, Mesa 22 ends at 65,535.
const PROBE_ITERATIONS: u32 = 70_000;

impl Device {
    /// Opens the best adapter: discrete, integrated, virtual, and then software
    /// ones. One that fails the soundness probe is passed over.
    ///
    /// Takes some tenths of a second: keep the device.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if there is none of that kind; otherwise what
    /// the last one tried had wrong with it.
    pub fn find(preference: Preference) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let mut adapters: Vec<(wgpu::AdapterInfo, wgpu::Adapter)> =
            found.into_iter().map(|a| (a.get_info(), a)).collect();
        if preference == Preference::Hardware {
            adapters.retain(|(info, _)| info.device_type != wgpu::DeviceType::Cpu);
        }
        adapters.sort_by_key(|(info, _)| rank(info.device_type));
        let mut result = Err(GpuError::NoAdapter {
            wanted: match preference {
                Preference::Hardware => "hardware GPU",
                Preference::Any => "GPU adapter",
            },
        });
        for (info, adapter) in adapters {
            result = Self::open(&adapter, info);
            if result.is_ok() {
                break;
            }
        }
        result
    }

    fn open(adapter: &wgpu::Adapter, info: wgpu::AdapterInfo) -> Result<Self, GpuError> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("secateur"),
            required_features: adapter.features() & wgpu::Features::MAPPABLE_PRIMARY_BUFFERS,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| {
                GpuError::NotOpened {
                    adapter: info.name.clone(),
                    reason: e.to_string(),
                }
            })?;
        Self::from_wgpu(device, queue, info)
    }

    /// A device of one's own. `info` is that of its adapter, for reports and to
    /// refuse what is known to be unsound.
    ///
    /// Buffers are bound as large as the device's limits allow, so request the
    /// adapter's. The device's handlers for uncaptured errors and for its loss
    /// are replaced: both become a [`GpuError`] of the call at work.
    ///
    /// # Errors
    /// [`GpuError::Unsound`] if the adapter computes wrong results, or what
    /// else the driver says.
    pub fn from_wgpu(
        device: wgpu::Device,
        queue: wgpu::Queue,
        info: wgpu::AdapterInfo,
    ) -> Result<Self, GpuError> {
        let unsound = || GpuError::Unsound {
            adapter: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info),
        };
        if info.driver_info.starts_with("Mesa 22.") && info.device_type == wgpu::DeviceType::Cpu {
            return Err(unsound());
        }
        let fault = watch(&device);
        let limits = device.limits();
        let binding_limit = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        let stages = Stages::new(&device);
        let device = Self {
            wgpu: device,
            queue,
            stages,
            info,
            binding_limit,
            fault,
        };
        device.check()?;
        if device.probe()? != PROBE_ITERATIONS {
            return Err(GpuError::Unsound {
                adapter: device.info.name.clone(),
                driver: device.driver(),
            });
        }
        Ok(device)
    }

    /// This device, but never with more than this many bytes in one
    /// binding: for less memory at a time, and more chunks.
    pub fn with_binding_limit(mut self, bytes: u64) -> Self {
        self.binding_limit = self.binding_limit.min(bytes);
        self
    }

    /// Name of the adapter as its driver gives it.
    pub fn adapter(&self) -> &str {
        &self.info.name
    }

    /// The driver's name and version.
    pub fn driver(&self) -> String {
        format!("{} {}", self.info.driver, self.info.driver_info)
            .trim()
            .to_owned()
    }

    /// All that wgpu says about the adapter.
    pub fn info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// The most bytes a storage buffer is bound with.
    pub fn binding_limit(&self) -> u64 {
        self.binding_limit
    }

    /// Whether the GPU reads what the CPU writes without a copy.
    pub(super) fn shares_memory(&self) -> bool {
        use wgpu::DeviceType::{Cpu, IntegratedGpu};
        matches!(self.info.device_type, Cpu | IntegratedGpu)
            && self
                .wgpu
                .features()
                .contains(wgpu::Features::MAPPABLE_PRIMARY_BUFFERS)
    }

    /// The error reported since the last call, if any.
    pub(super) fn check(&self) -> Result<(), GpuError> {
        let mut fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        match &*fault {
            None => Ok(()),
            // A lost device stays lost.
            Some(lost @ GpuError::Lost(_)) => Err(lost.clone()),
            Some(_) => Err(fault.take().expect("matched above")),
        }
    }

    /// Waits until all submitted work is done.
    pub(super) fn wait(&self) -> Result<(), GpuError> {
        let polled = self.wgpu.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled
            .map(|_| ())
            .map_err(|e| GpuError::Failed(e.to_string()))
    }

    fn probe(&self) -> Result<u32, GpuError> {
        let params = self.uniform(&[PROBE_ITERATIONS, 0, 0, 0]);
        let counted = self.storage("probe", 4);
        let probe = Dispatch {
            stage: &self.stages.probe,
            bindings: &[(0, &params), (1, &counted)],
            workgroups: [1, 1, 1],
        };
        let words = self.run(&[probe], &counted, 4)?;
        Ok(words[0])
    }
}

fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn watch(device: &wgpu::Device) -> Fault {
    let fault = Fault::default();
    let report = {
        let fault = fault.clone();
        move |error: GpuError| {
            let mut first = fault.lock().unwrap_or_else(PoisonError::into_inner);
            if first.is_none() || matches!(error, GpuError::Lost(_)) {
                *first = Some(error);
            }
        }
    };
    let on_error = report.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        on_error(match error {
            wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory,
            other => GpuError::Failed(other.to_string()),
        });
    }));
    device.set_device_lost_callback(move |reason, message| {
        // Dropping the device is no loss.
        if reason != wgpu::DeviceLostReason::Destroyed {
            report(GpuError::Lost(message));
        }
    });
    fault
}

#[cfg(test)]
mod tests {
    use super::super::stages::stage;
    use super::*;

    /// A device, or `None` with a word on why; a failure where
    /// `SECATEUR_REQUIRE_GPU=1` is set.
    fn device() -> Option<Device> {
        match Device::find(Preference::Any) {
            Ok(device) => Some(device),
            Err(error) => {
                let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
                assert!(!is_required, "SECATEUR_REQUIRE_GPU=1, but: {error}");
                eprintln!("GPU errors skipped: {error}");
                None
            }
        }
    }

    #[test]
    fn a_broken_rule_is_an_error_and_no_panic() {
        let Some(own) = device() else { return };
        let words = own.storage("words", 4);
        let module = own.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl("fn main() { this is no shader }".into()),
        });
        let broken = stage(&own.wgpu, &module, "main", &[]);
        let dispatch = Dispatch {
            stage: &broken,
            bindings: &[(0, &words)],
            workgroups: [1, 1, 1],
        };
        let result = own.run(&[dispatch], &words, 4);
        assert!(matches!(result, Err(GpuError::Failed(_))), "{result:?}");
        // What was wrong is told once; the device goes on.
        assert_eq!(own.run(&[], &words, 4), Ok(vec![0]));
    }

    #[test]
    fn more_memory_than_there_is_is_an_error_and_no_panic() {
        let Some(own) = device() else { return };
        let words = own.storage("words", 1 << 60);
        assert!(own.run(&[], &words, 4).is_err());
    }
}
