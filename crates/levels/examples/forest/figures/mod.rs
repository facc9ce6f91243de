//! Figures: what stands take on the GPU, and what each method draws beside full geometry.
//!
//! Methods take turns frame by frame, so that what else the machine does meets all of them. Ratios are of
//! core time, which other programs change less than the clock.

mod paths;
mod stands;

use secateur_runtime::stand::Instance;
use secateur_runtime::view_dependent::ViewDependent;

use crate::clock::Seconds;
use crate::gpu::Gpu;
use crate::methods::{Method, RULE, Stand};
use crate::pipelines::Pipelines;
use crate::placing;
use crate::renderer::Renderer;
use crate::rows::{Row, Rows, Wanted};
use crate::species::Species;
use crate::uploaded::Uploaded;

/// Of the picture that methods are compared by.
const LARGE: [u32; 2] = [1280, 720];

/// Width and height in pixels of the frames along a path.
const SMALL: [u32; 2] = [640, 360];

const STAND_SEED: u64 = 1;

/// All that figures are taken with.
pub(crate) struct Figures<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pipelines: &'a Pipelines,
    pub(crate) species: &'a Species,
    pub(crate) uploaded: &'a Uploaded,
    pub(crate) cut: ViewDependent,
    pub(crate) leaf_indices: u32,
    pub(crate) rows: Rows,
}

/// A part of the figures, which notes its own.
type Part<'a> = fn(&mut Figures<'a>);

/// What frames of one method took together.
#[derive(Clone, Copy, Debug, Default)]
struct Frames {
    count: usize,
    triangles: u64,
    wall_s: f64,
    core_s: f64,
}

impl Frames {
    fn add(&mut self, triangles: u64, seconds: Seconds) {
        self.count += 1;
        self.triangles += triangles;
        self.wall_s += seconds.wall;
        self.core_s += seconds.cores.unwrap_or(seconds.wall);
    }

    fn triangles_a_frame(&self) -> f64 {
        self.triangles as f64 / self.count as f64
    }

    fn wall_ms(&self) -> f64 {
        1e3 * self.wall_s / self.count as f64
    }

    fn core_ms(&self) -> f64 {
        1e3 * self.core_s / self.count as f64
    }
}

impl<'a> Figures<'a> {
    pub(crate) fn all(&mut self, wanted: &Wanted) {
        let parts: [(&str, Part<'a>); 6] = [
            ("memory", Self::memory),
            ("stand", Self::stand),
            ("above", Self::above),
            ("towards", Self::towards),
            ("schemes", Self::schemes),
            ("counts", Self::counts),
        ];
        for (name, part) in parts {
            if wanted.has(name) {
                part(self);
            }
        }
    }

    fn renderer(&self, size: [u32; 2]) -> Renderer<'a> {
        Renderer::new(
            self.gpu,
            self.pipelines,
            self.uploaded,
            self.leaf_indices,
            size,
        )
    }

    fn instances(&self, count: usize) -> Vec<Instance> {
        placing::square(count, self.species.sphere.radius, STAND_SEED)
    }

    fn note(&mut self, case: &str, quantity: &str, unit: &str, value: f64) {
        let frames = std::env::var("FRAMES").map_or(String::new(), |n| format!("FRAMES={n} "));
        let command = format!("{frames}cargo run -p secateur-levels --example forest -- figures");
        self.rows.add(&Row {
            case,
            quantity,
            unit,
            value,
            repeat: 0,
            adapter: &self.gpu.adapter,
            command: &command,
        });
    }

    fn note_frames(&mut self, case: &str, frames: &Frames) {
        self.note(
            case,
            "triangles a frame",
            "",
            frames.triangles_a_frame().round(),
        );
        self.note(case, "time a frame", "ms", frames.wall_ms());
        self.note(case, "core time a frame", "ms", frames.core_ms());
    }

    /// How much faster frames are than those of full geometry.
    fn note_ratios(&mut self, case: &str, frames: &Frames, full: &Frames) {
        let (wall, core) = (
            full.wall_ms() / frames.wall_ms(),
            full.core_ms() / frames.core_ms(),
        );
        self.note(case, "frame rate over full geometry's", "x", wall);
        // A GPU leaves the cores too little for a clock of 100 ticks a second.
        if frames.core_s.min(full.core_s) >= 0.2 {
            self.note(case, "the same by core time", "x", core);
        }
    }

    /// Bytes on the GPU.
    fn memory(&mut self) {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let count = 2000;
        let instances = self.instances(count);
        let camera = placing::overlook(count, self.species.sphere.radius, LARGE);
        let list = stand(self, &instances).frame(Method::Continuous, &camera, camera.eye);
        let renderer = self.renderer(LARGE);
        let drawn = renderer.draw(&list, &camera);
        let targets = renderer.target_bytes;
        let bytes = self.uploaded.bytes;
        let continuous = bytes.prefix + bytes.pictures + drawn.bytes;
        for (quantity, value) in [
            ("a plant as it is", bytes.full),
            ("a chain of halvings", bytes.chain),
            ("prefix buffers with their tables", bytes.prefix),
            ("pictures of materials", bytes.pictures),
            ("pictures of boxes", bytes.boxes),
            ("records of 2000 trees at continuous levels", drawn.bytes),
            ("2000 trees at continuous levels", continuous),
            ("these and the frame's targets", continuous + targets),
        ] {
            self.note("memory", quantity, "MiB", mib(value));
        }
    }
}

fn stand<'a>(figures: &Figures<'a>, instances: &'a [Instance]) -> Stand<'a> {
    Stand {
        species: figures.species,
        uploaded: figures.uploaded,
        instances,
        cut: figures.cut.clone(),
        rule: RULE,
    }
}
