//! The options of `secateur grow`.

use std::path::PathBuf;

use clap::Args;
use secateur_plant::{BranchAmount, BranchMethod, ClusterSize, MAX_LEAVES, Scheme, Thresholds};

#[derive(Args, Debug)]
pub(crate) struct Grow {
    /// What to grow: oak, carya, birch, alder, maple, rowan, pine, palmetto, willow, bush; or a
    /// rule file of your own, FILE.lsys.
    #[arg(value_name = "SPECIES")]
    pub(crate) species: String,
    /// The file to write, .glb.
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: PathBuf,
    /// How many leaves the plant has, exactly [default: as many as suit the species].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_LEAVES)))]
    pub(crate) leaves: Option<u32>,
    /// The seed: equal seeds grow equal plants, others grow siblings.
    #[arg(long, value_name = "S", default_value_t = 3)]
    pub(crate) seed: u64,
    /// Write only a level of detail of the plant: K for the first K paths of its chain of branches,
    /// or a share of the leaves such as 0.25 for as many paths as bear at most that share; with
    /// `--lod-method merge`, K for level K of the scheme or
    /// the thresholds, the finest first.
    #[arg(long, value_name = "K|R", allow_negative_numbers = true)]
    pub(crate) lod: Option<BranchAmount>,
    /// How levels of detail are made.
    #[arg(long, value_enum, default_value_t = BranchMethod::Chain, requires = "lod")]
    pub(crate) lod_method: BranchMethod,
    /// merge: which share of the sticks each level takes away, in per cent.
    #[arg(
        long,
        value_name = "P-P-...",
        default_value = "50-25-12.5-12.5",
        requires = "lod"
    )]
    pub(crate) scheme: Scheme,
    /// merge: in place of the scheme, how thick a stick must be to stay, in metres, a level each; or
    /// with `hr:` before the numbers its largest height over radius.
    #[arg(
        long,
        value_name = "M,M,...|hr:N,N,...",
        requires = "lod",
        conflicts_with = "scheme",
        allow_hyphen_values = true
    )]
    pub(crate) thresholds: Option<Thresholds>,
    /// merge: how large clusters of leaves are.
    #[arg(long, value_enum, default_value_t = ClusterSize::Paper, requires = "lod")]
    pub(crate) cluster_size: ClusterSize,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write a picture of the plant.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
}
