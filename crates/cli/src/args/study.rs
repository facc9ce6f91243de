//! The options of `secateur study`.

use std::path::PathBuf;

use clap::Args;
use secateur::JudgingViews;
use secateur_study::{DRAWN_WIDTHS_PX, FRAMES_UP_TO_PX, Plan};

use super::lods::{Distances, distances};
use super::{Foliage, MemoryArg};

#[derive(Args, Debug)]
pub(crate) struct Study {
    /// The trees, .glb or .gltf; the plans failures, paper, walk and metrics make their own too.
    #[arg(
        value_name = "TREE.glb",
        required_unless_present_any = ["redraw", "plan"],
        conflicts_with = "redraw"
    )]
    pub(crate) trees: Vec<PathBuf>,
    /// The folder of rows, charts and report. Rows that are in it already are kept and not run
    /// again.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// What is run; several with commas between them.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "methods")]
    pub(crate) plan: Vec<Plan>,
    /// Instead of plans: a method and options of `simplify`, such as 'vds --views 8'; can be given
    /// several times. If it has `--triangles`, without a number, its levels are shares of the
    /// triangles.
    #[arg(long, value_name = "CASE")]
    pub(crate) case: Vec<String>,
    /// Where to judge from [default: held-out; for the paper's plants, and for the plan paper alone,
    /// icosahedron].
    #[arg(long, value_enum, conflicts_with = "redraw")]
    pub(crate) views: Option<JudgingViews>,
    /// Shares of the leaves, 0 to 1 [default: 0.5,0.25,0.1,0.01; for failures 0.5,0.1, for metrics 0.5,0.25,0.1]; for whole
    /// plants, and as fixed shares of scene, of all triangles [default: 0.5,0.25,0.1].
    #[arg(long, value_name = "R,R", value_delimiter = ',', value_parser = level)]
    pub(crate) levels: Vec<f64>,
    /// The distances of the plan scene in metres, rising [default: 5,10,20,40,80].
    #[arg(long, value_name = "M,M,...", value_parser = distances, allow_negative_numbers = true, conflicts_with = "redraw")]
    pub(crate) distances: Option<Distances>,
    /// Study only the tree of this name; can be given several times.
    #[arg(long, value_name = "NAME", conflicts_with = "redraw")]
    pub(crate) only: Vec<String>,
    /// Judge pictures up to this width over frames too (the mean of 16, as temporal anti-aliasing shows it): 128 or
    /// 512 pixels. 512 takes some 3 s a row more for a tree of 20,000 leaves.
    #[arg(long, value_name = "PX", default_value_t = FRAMES_UP_TO_PX, value_parser = frames_up_to, conflicts_with = "redraw")]
    pub(crate) frames_up_to: u32,
    /// How many seeds to run of methods that choose at random.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) seeds: u32,
    /// Run nothing: draw charts and report from the rows again.
    #[arg(long)]
    pub(crate) redraw: bool,
}

fn level(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(level) if (0.0..=1.0).contains(&level) => Ok(level),
        _ => Err("write shares from 0 to 1 with commas between them".to_owned()),
    }
}

fn frames_up_to(text: &str) -> Result<u32, String> {
    let is_judged = |width_px: &u32| DRAWN_WIDTHS_PX.contains(width_px);
    let width_px = text.parse().ok().filter(is_judged);
    width_px.ok_or_else(|| "write 128 or 512".to_owned())
}
