//! The options of `secateur lod`.

use std::path::PathBuf;

use clap::Args;

use super::{Foliage, NotPlantArg, VertexAlphaArg, leaves, share};

#[derive(Args, Debug)]
pub(crate) struct Lod {
    /// The tree that was simplified, .glb or .gltf.
    #[arg(value_name = "TREE.glb")]
    pub(crate) tree: PathBuf,
    /// The level, .glb or .gltf.
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: PathBuf,
    /// The removal order that `simplify --order` wrote [default: the one in the tree's extras].
    #[arg(long, value_name = "FILE")]
    pub(crate) order: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) level: LevelArgs,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) not_plant: NotPlantArg,
    #[command(flatten)]
    pub(crate) vertex_alpha: VertexAlphaArg,
    /// Let the buffer of a .gltf replace a file beside it that is not its own.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

#[derive(Args, Clone, Copy, Debug)]
#[group(required = true, multiple = false)]
pub(crate) struct LevelArgs {
    /// The level of N leaves; of those that the order has, the finest with no more.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = leaves)]
    pub(crate) leaves: Option<u64>,
    /// The level of this share of the leaves, 0 to 1 (rounded to the nearest number of leaves).
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = share)]
    pub(crate) ratio: Option<f64>,
    /// The level after the first K steps of the order.
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = leaves)]
    pub(crate) steps: Option<u64>,
}
