//! The options of `secateur stand`.

use std::path::PathBuf;

use clap::Args;
use secateur::{Effort, Engine};
use secateur_levels::chain::CostWeights;
use secateur_levels::impostor::Choice as ImpostorChoice;

use super::lods::{difference, texture_size};
use super::{MemoryArg, leaves};

#[derive(Args, Clone, Debug)]
pub(crate) struct Stand {
    /// The scene: a .glb or .gltf with plants as nodes or instances and with cameras, or a .json that lists plants,
    /// places and cameras.
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// The folder for the scene with levels, its record and the pictures of each camera, made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// The largest difference between a camera's pictures of the scene before and after, over the pixels of plants
    /// [default: 0.28, where no other limit or budget is given].
    #[arg(long, value_name = "F", value_parser = difference)]
    pub(crate) max_difference: Option<f64>,
    /// The largest mean FLIP between them over the whole picture, such as 0.02.
    #[arg(long, value_name = "F", value_parser = difference)]
    pub(crate) max_flip: Option<f64>,
    /// The most triangles of all plants together.
    #[arg(long, value_name = "N", value_parser = leaves)]
    pub(crate) triangles: Option<u64>,
    /// The most that all levels may take on the GPU, such as 64M.
    #[arg(long, value_name = "SIZE", value_parser = texture_size)]
    pub(crate) gpu_bytes: Option<u64>,
    /// What triangles, draws, KiB on disk and KiB on the GPU count for, or some of these.
    #[arg(long, value_name = "WEIGHTS", default_value_t = CostWeights::default())]
    pub(crate) cost: CostWeights,
    /// The height of the cameras' pictures in pixels, 16 to 4320.
    #[arg(long, value_name = "PX", default_value_t = 1080, value_parser = clap::value_parser!(u32).range(16..=4320))]
    pub(crate) screen_height: u32,
    /// The pictures that the levels of a kind may end in.
    #[arg(long, value_enum, default_value_t = ImpostorChoice::Auto)]
    pub(crate) impostor: ImpostorChoice,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// How much work goes into the search for levels.
    #[arg(long, value_enum, default_value_t = Effort::Normal)]
    pub(crate) effort: Effort,
    /// Where to rasterise; results are the same.
    #[arg(long, value_enum, default_value_t = Engine::Auto)]
    pub(crate) engine: Engine,
    /// Replace what an earlier call wrote there.
    #[arg(long)]
    pub(crate) overwrite: bool,
}
