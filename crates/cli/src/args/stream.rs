//! The options of `secateur stream`.

use std::path::PathBuf;

use clap::Args;
use secateur::Engine;

use super::{PlantArgs, leaves, share};

#[derive(Args, Debug)]
pub(crate) struct Stream {
    /// The tree, .glb or .gltf; with `--read` a stream.
    #[arg(value_name = "TREE.glb|STREAM")]
    pub(crate) input: PathBuf,
    /// The stream; with `--read` the plant of it, .glb.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Read a stream, or as much as there is of one, and write the plant of it.
    #[arg(long)]
    pub(crate) read: bool,
    /// With `--read`: only the first N bytes.
    #[arg(long, value_name = "N", requires = "read", value_parser = leaves, allow_negative_numbers = true)]
    pub(crate) bytes: Option<u64>,
    #[command(flatten)]
    pub(crate) coarsest: Coarsest,
    /// Write a page too that shows the plant as it arrives.
    #[arg(long, value_name = "PAGE.html", conflicts_with = "read")]
    pub(crate) preview: Option<PathBuf>,
    /// Where images are drawn, where the tree is simplified; the result is the same, bit for bit.
    #[arg(long, value_enum, default_value_t = Engine::Auto, conflicts_with = "read")]
    pub(crate) engine: Engine,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

/// In which order leaves come, and how coarse the first level is.
#[derive(Args, Debug)]
pub(crate) struct Coarsest {
    /// The removal order that `simplify --order` wrote: the last leaf to go is the first to come
    /// [default: the one in the tree's extras, or else the tree is simplified].
    #[arg(long, value_name = "FILE", conflicts_with_all = ["read", "ratio", "leaves", "chain"])]
    pub(crate) order: Option<PathBuf>,
    /// The first level has this share of the leaves, 0 to 1 [default: 0.02].
    #[arg(long, value_name = "R", conflicts_with_all = ["read", "leaves"], value_parser = share, allow_negative_numbers = true)]
    pub(crate) ratio: Option<f64>,
    /// The first level has N leaves.
    #[arg(long, value_name = "N", conflicts_with = "read", value_parser = leaves, allow_negative_numbers = true)]
    pub(crate) leaves: Option<u64>,
    /// Branch after branch, those that matter most first, no leaf grows: for trees that know their
    /// branches, as those of `grow` do.
    #[arg(long, conflicts_with = "read")]
    pub(crate) chain: bool,
}
