//! The options of `secateur lods`.

use std::path::PathBuf;

use clap::Args;
use secateur::engines::EngineName;
use secateur::{Alpha, Effort, Engine, Memory, Sides};

use super::super::names::{ChainPresetName, ChainWoodName};
use super::{OF_RECORDS, PackingArgs, PlantArgs, SceneArgs, WindArg, leaves, number, share};
use secateur_eval::Limits;
use secateur_gltf::chain::Layout;
use secateur_levels::chain::{CostWeights, DISTANCES, MOST_DIFFERENCE, Textures};
use secateur_levels::impostor::Choice as ImpostorChoice;
use secateur_runtime::Screen;

#[derive(Args, Clone, Debug)]
pub(crate) struct Lods {
    /// The trees, .glb or .gltf; - reads one from standard input.
    #[arg(value_name = "TREE.glb", required = true)]
    pub(crate) trees: Vec<PathBuf>,
    /// The folder for the levels, made if it is not there; or, for one tree, a file that holds all
    /// of them, - for standard output.
    #[arg(short, long, value_name = "DIR|OUT.glb")]
    pub(crate) output: PathBuf,
    /// Whether trees that cannot be done are left out, and told of at the end with exit code 3, instead of ending the
    /// call [default: true for several trees].
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub(crate) keep_going: Option<bool>,
    /// The levels as shares of all triangles, the finest first, such as 0.5,0.25,0.1 [default: levels
    /// for heights on the screen of 1080, 540, 270, 135, 64, 32 and 16 pixels, each as light as `--max-difference`
    /// lets it be].
    #[arg(long, value_name = "R,R,...", value_delimiter = ',', value_parser = share, conflicts_with = "triangles")]
    pub(crate) levels: Vec<f64>,
    /// The levels as numbers of triangles, the finest first, such as 20000,5000,1000.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', value_parser = leaves)]
    pub(crate) triangles: Vec<u64>,
    /// The distances in metres from which levels are seen, the nearest first, such as 5,20,80: for
    /// each the lightest level within `--max-difference` at the height that the screen shows there; for the
    /// last of several none, if `--impostor` asks for crossed planes, cards or octahedral views.
    #[arg(long, value_name = "M,M,...", value_parser = distances, allow_negative_numbers = true, conflicts_with_all = ["triangles", "levels"])]
    pub(crate) distances: Option<Distances>,
    /// How the levels lie in files [default: files in a folder, siblings in one file].
    #[arg(long, value_enum)]
    pub(crate) layout: Option<Layout>,
    /// The engine that levels are for: chooses the layout, and writes what makes it switch them beside the files.
    #[arg(
        long = "for",
        value_name = "ENGINE",
        value_enum,
        conflicts_with = "layout"
    )]
    pub(crate) for_engine: Option<EngineName>,
    /// The largest difference that a level may have where it begins to be seen: .18 cannot be told at its size, .28
    /// is good, .50 is coarse, for backgrounds.
    #[arg(long, value_name = "F", default_value_t = Limits::GOOD.difference, value_parser = difference)]
    pub(crate) max_difference: f64,
    /// How high the plant really is in metres, where the unit of its file is not a metre.
    #[arg(long, value_name = "M", value_parser = metres)]
    pub(crate) plant_height: Option<f64>,
    /// Take what stands apart for one plant, such as a hedge [default: each plant is judged by itself].
    #[arg(long)]
    pub(crate) as_one: bool,
    /// Leave out the plant itself, which is else the level from 0 m on.
    #[arg(long)]
    pub(crate) no_original: bool,
    /// The pictures that the chain ends in: crossed planes, cards, octahedral views (docs/impostors.md has
    /// their sampler; other clients draw two crossed planes), none, or crossed planes where they
    /// look no worse than the lightest mesh and, up to 100 pixels high or with --distances, cards where they are
    /// within --max-difference and save a third of the cost of the mesh there [default: auto, none with --levels and --triangles].
    #[arg(long, value_enum)]
    pub(crate) impostor: Option<ImpostorChoice>,
    /// How many levels coarser the level that casts a level's shadow is, 0 to 2.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub(crate) shadow_steps: u8,
    /// The largest difference that a switch from a level to the next may show; levels that would show more are left
    /// out.
    #[arg(long, value_name = "F", value_parser = difference)]
    pub(crate) max_pop: Option<f64>,
    /// Nest levels: what is gone from one does not come back in a coarser one. And write where each vertex goes on the
    /// way to the next mesh, as the attribute _MORPH.
    #[arg(long)]
    pub(crate) morph: bool,
    /// What triangles, draws, KiB on disk and KiB on the GPU count for where a mesh and an impostor are compared, or
    /// some of these.
    #[arg(long, value_name = "WEIGHTS", default_value_t = CostWeights::default())]
    pub(crate) cost: CostWeights,
    /// How much the textures of all impostors together may take on the GPU, such as 4M [default: as much as the plant's
    /// own, at least 1M].
    #[arg(long, value_name = "SIZE", value_parser = texture_size)]
    pub(crate) impostor_textures: Option<u64>,
    /// What becomes of the wood.
    #[arg(long, value_enum, default_value_t = ChainWoodName::Auto)]
    pub(crate) wood: ChainWoodName,
    /// Which textures cut-out leaves have [default: fit, where leaves are cut out].
    #[arg(long, value_enum)]
    pub(crate) textures: Option<Textures>,
    #[command(flatten)]
    pub(crate) screen: Screen,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    #[command(flatten)]
    pub(crate) wind: WindArg,
    /// Whether holes of leaf textures count.
    #[arg(long, value_enum, default_value_t = Alpha::Mask)]
    pub(crate) alpha: Alpha,
    /// From which sides leaves are seen.
    #[arg(long, value_enum, default_value_t = Sides::Material)]
    pub(crate) sides: Sides,
    /// What the leaves are simplified for.
    #[arg(long, value_enum, default_value_t = ChainPresetName::Look)]
    pub(crate) preset: ChainPresetName,
    /// How much work goes into the search for levels.
    #[arg(long, value_enum, default_value_t = Effort::Normal)]
    pub(crate) effort: Effort,
    /// Where to rasterise; results are the same.
    #[arg(long, value_enum, default_value_t = Engine::Auto)]
    pub(crate) engine: Engine,
    /// Write a page to look at the original and the chain side by side; it needs nothing else.
    #[arg(long, value_name = "FILE.html")]
    pub(crate) preview: Option<PathBuf>,
    /// Only check everything, and say what would be made.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Replace levels of other runs that have the same names.
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) packing: PackingArgs,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, help_heading = OF_RECORDS, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Distances of levels, rising.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Distances(pub(crate) Vec<f64>);

pub(super) fn distances(text: &str) -> Result<Distances, String> {
    let within = |text: &str| number(text, |d| DISTANCES.contains(&d), "");
    let all: Result<Vec<f64>, String> = text.split(',').map(|d| within(d.trim())).collect();
    let all =
        all.map_err(|_| "write distances from 0.01 to 1000000, such as 5,20,80".to_owned())?;
    match all.windows(2).all(|w| w[0] < w[1]) {
        true => Ok(Distances(all)),
        false => Err("distances must rise, such as 5,20,80".to_owned()),
    }
}

pub(super) fn difference(text: &str) -> Result<f64, String> {
    let is_one = |n: f64| n > 0.0 && n <= MOST_DIFFERENCE;
    number(text, is_one, "above 0 and at most 2")
}

pub(super) fn texture_size(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(Memory::Bytes(bytes)) => Ok(bytes),
        Ok(Memory::Auto) | Err(_) => Err("write a size above 0 such as 4M or 800K".to_owned()),
    }
}

fn metres(text: &str) -> Result<f64, String> {
    let is_height = |m: f64| m > 0.0 && m.is_finite();
    number(text, is_height, "of metres above 0")
}
