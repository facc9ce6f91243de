//! Where leaves are rasterised: a GPU or the CPU, opened once.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

#[cfg(feature = "gpu")]
use crate::gpu::{Device, Preference};
use crate::{
    AreaTable, CpuRasteriser, Fragments, RasterError, Rasteriser, Scene, TooManyFragments,
};

/// Where leaves are rasterised; the results are the same, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// The CPU; most whole commands gain nothing by a GPU.
    ///
    /// The CPU. The one GPU that was measured made some whole commands up to an
    /// eighth faster and others up to a half slower (`docs/benchmarks.md`).
    #[default]
    Auto,
    /// A GPU, software drivers included.
    Gpu,
    /// The CPU, with as many threads as `--threads` says.
    Cpu,
}

/// An engine at work.
///
/// Both engines give the same bits; the GPU's part is rasterising (fragments,
/// areas), the greedy loop itself stays on the CPU.
#[derive(Debug, Default)]
pub struct OpenEngine {
    #[cfg(feature = "gpu")]
    device: Option<Device>,
    /// Whether the CPU takes over where the GPU fails.
    falls_back: bool,
    failure: OnceLock<String>,
}

impl OpenEngine {
    /// An engine that draws on the CPU and opens no GPU.
    pub fn cpu() -> Self {
        Self::default()
    }

    /// The engine that is asked for.
    ///
    /// # Errors
    /// [`RasterError`] if [`Engine::Gpu`] is asked for and there is none.
    pub fn open(engine: Engine) -> Result<Self, RasterError> {
        match engine {
            Engine::Auto | Engine::Cpu => Ok(Self::cpu()),
            Engine::Gpu => Self::open_gpu(),
        }
    }

    #[cfg(feature = "gpu")]
    fn open_gpu() -> Result<Self, RasterError> {
        Ok(Self::on_device(Device::find(Preference::Any)?))
    }

    #[cfg(not(feature = "gpu"))]
    fn open_gpu() -> Result<Self, RasterError> {
        Err("this secateur was built without the feature `gpu`; run on the CPU".into())
    }

    /// A GPU that was opened before, such as one's own
    /// ([`Device::from_wgpu`]).
    #[cfg(feature = "gpu")]
    pub fn on_device(device: Device) -> Self {
        Self {
            device: Some(device),
            ..Self::default()
        }
    }

    /// This engine, but where the GPU fails (lost, out of memory) the CPU takes
    /// over and [`failure`](Self::failure) says why. For programs that bring a
    /// device of their own; [`open`](Self::open) fails with the GPU.
    pub fn falling_back(self) -> Self {
        Self {
            falls_back: true,
            ..self
        }
    }

    /// `gpu` or `cpu`, whichever did the work; `cpu` once it took over.
    pub fn name(&self) -> &'static str {
        if self.is_gpu() { "gpu" } else { "cpu" }
    }

    /// The adapter's name and driver, or `None` on the CPU.
    #[cfg(feature = "gpu")]
    pub fn adapter(&self) -> Option<String> {
        let device = self.device.as_ref().filter(|_| self.is_gpu())?;
        Some(format!("{} ({})", device.adapter(), device.driver()))
    }

    /// The adapter's name and driver, or `None` on the CPU.
    #[cfg(not(feature = "gpu"))]
    pub fn adapter(&self) -> Option<String> {
        None
    }

    /// Why the GPU failed and the CPU took over, if it did.
    pub fn failure(&self) -> Option<String> {
        self.failure.get().cloned()
    }

    /// The device if one is open, else the CPU's twin.
    fn rasteriser(&self) -> &dyn Rasteriser {
        #[cfg(feature = "gpu")]
        if let Some(device) = self.device.as_ref().filter(|_| self.is_gpu()) {
            return device;
        }
        &CpuRasteriser
    }

    fn with_fallback<T>(
        &self,
        work: impl Fn(&dyn Rasteriser) -> Result<T, RasterError>,
    ) -> Result<T, RasterError> {
        match work(self.rasteriser()) {
            // The CPU would find as many.
            Err(error) if error.is::<TooManyFragments>() => Err(error),
            Err(error) if self.is_gpu() && self.falls_back => {
                // Another thread may have been first; its reason will do.
                let _ = self.failure.set(error.to_string());
                work(&CpuRasteriser)
            }
            result => result,
        }
    }
}

impl Rasteriser for OpenEngine {
    fn fragments(&self, scene: &Scene<'_>) -> Result<Fragments, RasterError> {
        self.with_fallback(|rasteriser| rasteriser.fragments(scene))
    }

    fn fragments_within(&self, scene: &Scene<'_>, most: u64) -> Result<Fragments, RasterError> {
        self.with_fallback(|rasteriser| rasteriser.fragments_within(scene, most))
    }

    fn fragments_and_areas_within(
        &self,
        scene: &Scene<'_>,
        most: u64,
    ) -> Result<(Fragments, AreaTable), RasterError> {
        self.with_fallback(|rasteriser| rasteriser.fragments_and_areas_within(scene, most))
    }

    fn areas(&self, scene: &Scene<'_>) -> Result<AreaTable, RasterError> {
        self.with_fallback(|rasteriser| rasteriser.areas(scene))
    }

    #[cfg(feature = "gpu")]
    fn is_gpu(&self) -> bool {
        self.device.is_some() && self.failure.get().is_none()
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::*;
    use crate::{ViewSet, cpu};
    use glam::DVec3;
    use secateur_model::{Foliage, LeafTriangle, Lod};

    #[test]
    fn the_cpu_takes_over_where_the_gpu_fails() {
        let Ok(device) = Device::find(Preference::Any) else {
            let is_required = std::env::var("SECATEUR_REQUIRE_GPU").is_ok_and(|v| v == "1");
            assert!(!is_required, "there is no GPU adapter");
            eprintln!("SKIPPED: there is no GPU adapter");
            return;
        };
        let mut foliage = Foliage::default();
        let triangle = LeafTriangle::plain([DVec3::ZERO, DVec3::X, DVec3::Y]);
        foliage.push_leaf(&[triangle], None).unwrap();
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let scene = Scene {
            foliage: &foliage,
            lod: &Lod::original(1),
            views: &views,
            resolution: 64,
        };
        // Not one row of a view fits a binding of 16 bytes.
        let strict = OpenEngine::on_device(device.with_binding_limit(16));
        assert!(strict.fragments(&scene).is_err());
        assert_eq!((strict.name(), strict.failure()), ("gpu", None));

        let lenient = strict.falling_back();
        assert_eq!(lenient.fragments(&scene).unwrap(), cpu::fragments(&scene));
        assert_eq!(lenient.areas(&scene).unwrap(), cpu::areas(&scene));
        assert_eq!((lenient.name(), lenient.adapter()), ("cpu", None));
        assert!(lenient.failure().is_some());
    }
}
