//! What can be written on the command line.

use std::path::PathBuf;

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use secateur::{Fitting, LeafTriangles, Memory, Resolution, Selector, Target};
use secateur_plant::{MAX_LEAVES, Scheme};

use super::grow_lod::Amount;
use super::names::{
    AlphaName, ChainPresetName, ClusterSizeName, CornersName, EngineName, HausdorffName,
    JudgingViewsName, MeshoptModeName, MethodName, MetricName, PresetName, ReferenceName,
    ResizeName, SidesName, TiesName, WoodName,
};

/// Makes the foliage of plants and trees light enough for real-time scenes.
#[derive(Debug, Parser)]
#[command(
    name = "secateur",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done; 1 the input or the machine does not allow it; 2 wrong usage."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Grow a tree, simplify it, write LODs, a report and a picture: no input needed.
    Demo(Demo),
    /// Show what is in a tree: leaves, wood, materials; what was taken for foliage and why.
    Inspect(Inspect),
    /// Make the foliage of a tree lighter and write the result.
    Simplify(Box<Simplify>),
    /// Write any level along the removal order of an earlier `simplify`, without simplifying again.
    Lod(Lod),
    /// Make a chain of levels of detail for an engine, wood and leaves alike.
    Lods(Box<Lods>),
    /// Judge a simplified tree against its original, from four sets of 12 views, none of them near
    /// one that drives by default.
    Measure(Measure),
    /// Compare methods and settings over trees: raw rows, charts of time against error, a report.
    Study(Study),
    /// Grow a plant from rules: a species, or a file of your own.
    Grow(Grow),
}

/// Headings that part the many options of `simplify`, and those of all commands.
const OF_VDS: &str = "Of vds";
const OF_OTHERS: &str = "Of other methods";
const OF_RECORDS: &str = "Checks and records";
const OF_ALL: &str = "Of every command";

#[derive(Args, Debug)]
#[command(next_help_heading = OF_ALL)]
pub(crate) struct Common {
    /// How to print the result.
    #[arg(long, value_enum, default_value_t = Format::Pretty, global = true)]
    pub(crate) format: Format,
    /// Threads to use [default: as many as there are cores].
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
    /// Print nothing but errors.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say what is being done; twice: in detail.
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Lines for a reader.
    Pretty,
    /// The same record as in reports.
    Json,
    /// A line of names and lines of values.
    Csv,
    /// A Markdown table.
    Md,
}

#[derive(Args, Debug)]
pub(crate) struct Demo {
    /// The folder for the results; made if it is not there.
    #[arg(short, long, value_name = "DIR", default_value = "secateur-demo")]
    pub(crate) output: PathBuf,
    /// How many leaves to grow.
    #[arg(long, value_name = "N", default_value_t = 3000, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    pub(crate) leaves: u32,
    /// Which of the trees to grow.
    #[arg(long, value_name = "S", default_value_t = 3)]
    pub(crate) seed: u64,
    /// Where images are drawn; the result is the same, bit for bit.
    #[arg(long, value_enum, default_value_t = EngineName::Auto)]
    pub(crate) engine: EngineName,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
}

#[derive(Args, Debug)]
pub(crate) struct Inspect {
    /// The tree, .glb or .gltf.
    #[arg(value_name = "TREE.glb")]
    pub(crate) tree: PathBuf,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// Write the record to this file too.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Measure {
    /// The original tree, .glb or .gltf.
    #[arg(value_name = "ORIGINAL.glb")]
    pub(crate) original: PathBuf,
    /// The simplified tree, .glb or .gltf.
    #[arg(value_name = "SIMPLIFIED.glb")]
    pub(crate) simplified: PathBuf,
    /// Where to judge from.
    #[arg(long, value_enum, default_value_t = JudgingViewsName::HeldOut)]
    pub(crate) views: JudgingViewsName,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// Whether holes of leaf textures count.
    #[arg(long, value_enum, default_value_t = AlphaName::Mask)]
    pub(crate) alpha: AlphaName,
    /// From which sides leaves are seen.
    #[arg(long, value_enum, default_value_t = SidesName::Material)]
    pub(crate) sides: SidesName,
    /// Also draw pictures this many pixels wide as clients do (mip maps, alpha test, culling), and
    /// compare them with the original as it truly looks.
    #[arg(long, value_name = "WIDTH", value_parser = clap::value_parser!(u32).range(8..=2048))]
    pub(crate) as_drawn: Option<u32>,
    /// Write the record to this file too.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Study {
    /// The trees, .glb or .gltf; the plans failures and paper make their own too.
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
    pub(crate) plan: Vec<PlanName>,
    /// Instead of plans: a method and options of `simplify`, such as 'vds --views 8'; can be given
    /// several times. With `--triangles`, without a number, its levels are shares of the triangles.
    #[arg(long, value_name = "CASE")]
    pub(crate) case: Vec<String>,
    /// Shares of the leaves, 0 to 1 [default: 0.5,0.25,0.1,0.01; for failures 0.5,0.1].
    #[arg(long, value_name = "R,R", value_delimiter = ',', value_parser = level)]
    pub(crate) levels: Vec<f64>,
    /// Of all these trees, study only the one of this name; can be given several times.
    #[arg(long, value_name = "NAME", conflicts_with = "redraw")]
    pub(crate) only: Vec<String>,
    /// How many seeds of methods that draw lots.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) seeds: u32,
    /// Run nothing: draw charts and report from the rows again.
    #[arg(long)]
    pub(crate) redraw: bool,
}

/// What a study runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlanName {
    /// Every method, one setting each, and variants that explain them
    Methods,
    /// vds from fewer views and at other resolutions, beside the other methods
    Speed,
    /// Methods under turned views, jittered corners, shuffled leaves and other settings
    Stability,
    /// Small scenes made for one failure each, and what to do about it
    Failures,
    /// The paper's studies: its figures beside those of plants with as many leaves
    Paper,
}

fn level(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(level) if (0.0..=1.0).contains(&level) => Ok(level),
        _ => Err("write shares from 0 to 1 with commas between them".to_owned()),
    }
}

#[derive(Args, Debug)]
pub(crate) struct Grow {
    /// What to grow: oak, carya, birch, alder, maple, rowan, pine, palmetto, willow, bush; or a
    /// rule file of your own, FILE.lsys.
    #[arg(value_name = "SPECIES")]
    pub(crate) species: String,
    /// The result, .glb.
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: PathBuf,
    /// How many leaves it has, exactly [default: as many as suit the species].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_LEAVES)))]
    pub(crate) leaves: Option<u32>,
    /// Which sibling; equal seeds grow equal plants.
    #[arg(long, value_name = "S", default_value_t = 3)]
    pub(crate) seed: u64,
    /// Only a level of detail of the plant: K for the first K paths of its chain of branches, or
    /// a share of the leaves such as 0.25 for as many paths as bear no more; with `--lod-method
    /// merge`, K for level K of the scheme.
    #[arg(long, value_name = "K|R", allow_negative_numbers = true)]
    pub(crate) lod: Option<Amount>,
    /// How levels of detail are made.
    #[arg(long, value_enum, default_value_t = LodMethod::Chain, requires = "lod")]
    pub(crate) lod_method: LodMethod,
    /// merge: which share of the sticks each level takes away, in per cent.
    #[arg(
        long,
        value_name = "P-P-...",
        default_value = "50-25-12.5-12.5",
        requires = "lod"
    )]
    pub(crate) scheme: Scheme,
    /// merge: how large clusters of leaves are.
    #[arg(long, value_enum, default_value_t = ClusterSizeName::Paper, requires = "lod")]
    pub(crate) cluster_size: ClusterSizeName,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write a picture of the plant.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
}

/// How `grow` makes levels of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LodMethod {
    /// Paths of branches, the longest branching first; every prefix is a plant
    Chain,
    /// Sticks and leaf clusters merged from the twigs down, by a scheme
    Merge,
}

#[derive(Args, Debug)]
pub(crate) struct Foliage {
    /// What is foliage: material:NAME, mesh:NAME or node:NAME, with * and ? as wildcards, #N for
    /// numbers; can be given several times [default: what the evidence shows, see `inspect`].
    #[arg(long, value_name = "SELECTOR")]
    pub(crate) foliage: Vec<Selector>,
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct MemoryArg {
    /// How much memory to take at most, such as 2G or 800M: what takes more is refused before it
    /// is taken [default: half of what the machine has].
    #[arg(
        long,
        value_name = "SIZE",
        default_value = "auto",
        hide_default_value = true
    )]
    pub(crate) memory: Memory,
}

#[derive(Args, Debug)]
pub(crate) struct Simplify {
    /// The tree, .glb or .gltf.
    #[arg(value_name = "TREE.glb")]
    pub(crate) tree: PathBuf,
    /// The result, .glb or .gltf.
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: PathBuf,
    /// Let the buffer of a .gltf replace a file beside it that is not its own.
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) target: TargetArgs,
    /// What becomes of the wood [default: auto with `--triangles`, which then counts the whole
    /// plant; else ignore].
    #[arg(long, value_enum)]
    pub(crate) wood: Option<WoodName>,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// Whether holes of leaf textures count [default: mask; ignore for the paper's presets].
    #[arg(long, value_enum)]
    pub(crate) alpha: Option<AlphaName>,
    /// From which sides leaves are seen [default: material; both for the paper's presets].
    #[arg(long, value_enum)]
    pub(crate) sides: Option<SidesName>,
    /// How leaves are chosen.
    #[arg(long, value_enum, default_value_t = MethodName::Vds)]
    pub(crate) method: MethodName,
    /// Where to rasterise; results are the same.
    #[arg(long, value_enum, default_value_t = EngineName::Auto)]
    pub(crate) engine: EngineName,
    /// Where to look from: dodecahedron (20 views), icosahedron (12), 92, 8, 6, vnc (20 views,
    /// later 12, 8 and 6), or a JSON file {"cameras": [{"eye": [x,y,z], "target": [x,y,z], "up",
    /// "fov_y_degrees", "near"}]}.
    #[arg(long, value_name = "VIEWS", default_value = "dodecahedron")]
    pub(crate) views: String,
    /// Width and height of the images in pixels: 1 to 2048, or auto: 256, more where the leaves
    /// need it [default: auto; 256 for the paper's presets].
    #[arg(long, value_name = "auto|N")]
    pub(crate) resolution: Option<Resolution>,
    /// What the result is for; other options override what look and information set, and
    /// contradict the paper's.
    #[arg(long, value_enum, default_value_t = PresetName::Look)]
    pub(crate) preset: PresetName,
    /// Whether to fit the sizes of the remaining leaves to the original at the end, in other
    /// views than those they were chosen in (with your own cameras, in these). coverage: each part of the crown as dense as it
    /// was. A weight W: the outline pixel by pixel and the information, where a pixel of outline
    /// counts W (0 to 100; 0.95 after --fit alone). auto: as the preset has it, for vds where
    /// --resize and --max-coverage are the preset's.
    #[arg(
        long,
        value_name = "auto|none|coverage|W",
        num_args = 0..=1,
        require_equals = true,
        default_value = "auto",
        default_missing_value = "0.95",
        allow_negative_numbers = true
    )]
    pub(crate) fit: Fitting,
    /// What the cost of a leaf is measured against [default: previous for the look, original for
    /// information].
    #[arg(long, help_heading = OF_VDS, value_enum)]
    pub(crate) reference: Option<ReferenceName>,
    /// The share of a pruned leaf's area that its neighbours gain [default: full for the look,
    /// normalised for information].
    #[arg(long, help_heading = OF_VDS, value_enum)]
    pub(crate) resize: Option<ResizeName>,
    /// How many nearest neighbours share it.
    #[arg(long, help_heading = OF_VDS, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) neighbours: u32,
    /// Let no leaf grow while the views show C times as much foliage as at first or more: keeps
    /// gaps open and the outline, at the cost of more VMI error [default: 1 for the look, none
    /// for information].
    #[arg(long, help_heading = OF_VDS, value_name = "C|none", allow_negative_numbers = true, value_parser = max_coverage)]
    pub(crate) max_coverage: Option<MaxCoverage>,
    /// Which of equally cheap leaves goes first: the first in the file, or spread over the crown.
    #[arg(long, help_heading = OF_VDS, value_enum, default_value_t = TiesName::Order)]
    pub(crate) ties: TiesName,
    /// vds: how many triangles a leaf keeps at most: a number, keep (all), or auto: with
    /// `--triangles` fewer, so that as many leaves as possible stay, but of one with holes those
    /// that show the same, or two; else all [default: auto; keep for the paper's presets].
    #[arg(long, help_heading = OF_VDS, value_name = "auto|keep|N")]
    pub(crate) leaf_triangles: Option<LeafTriangles>,
    /// For methods that draw lots: which of them.
    #[arg(long, help_heading = OF_OTHERS, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// stochastic: the share of the lost area that the survivors regain, 0 to 1.
    #[arg(
        long, help_heading = OF_OTHERS,
        value_name = "W",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = share
    )]
    pub(crate) area_weight: f64,
    /// fsa: how much the distance of two leaves counts, in units of a leaf's size.
    #[arg(
        long, help_heading = OF_OTHERS,
        value_name = "W",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = above_zero
    )]
    pub(crate) distance_weight: f64,
    /// fsa: how much it counts that two leaves are not in one plane.
    #[arg(
        long, help_heading = OF_OTHERS,
        value_name = "W",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = from_zero
    )]
    pub(crate) planarity_weight: f64,
    /// fsa: which two corners each of two leaves gives to the one that takes their place.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = CornersName::Spread)]
    pub(crate) corners: CornersName,
    /// fsa: between what the distance of two leaves (of Hausdorff) is taken.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = HausdorffName::Corners)]
    pub(crate) hausdorff: HausdorffName,
    /// meshopt: which of its simplifiers.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = MeshoptModeName::Prune)]
    pub(crate) meshopt_mode: MeshoptModeName,
    /// meshopt: move the borders of what is left outwards, to give back lost area.
    #[arg(long, help_heading = OF_OTHERS)]
    pub(crate) preserve_area: bool,
    /// chain: by what branches go, those with the least first.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = MetricName::BranchingLength)]
    pub(crate) branch_metric: MetricName,
    /// merge: how large clusters of leaves are.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = ClusterSizeName::Paper)]
    pub(crate) cluster_size: ClusterSizeName,
    /// Rasterise the result from scratch another way and compare [default: in debug builds].
    #[arg(long, help_heading = OF_RECORDS, overrides_with = "no_audit")]
    pub(crate) audit: bool,
    /// Do not rasterise the result again.
    #[arg(long, help_heading = OF_RECORDS, overrides_with = "audit")]
    pub(crate) no_audit: bool,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, help_heading = OF_RECORDS, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write the removal order to this file: `lod` makes any level along it later. To a name that
    /// ends in .glb or .gltf: the tree as it is, with the order in its extras.
    #[arg(long, help_heading = OF_RECORDS, value_name = "FILE")]
    pub(crate) order: Option<PathBuf>,
    /// Write a picture of the original and the result side by side.
    #[arg(long, help_heading = OF_RECORDS, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Write what the views see before and after, a colour for each leaf, into this folder.
    #[arg(long, help_heading = OF_RECORDS, value_name = "DIR")]
    pub(crate) debug_images: Option<PathBuf>,
}

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

#[derive(Args, Debug)]
pub(crate) struct Lods {
    /// The trees, .glb or .gltf.
    #[arg(value_name = "TREE.glb", required = true)]
    pub(crate) trees: Vec<PathBuf>,
    /// The folder for the levels, made if it is not there; or, for one tree, a file that holds all
    /// of them.
    #[arg(short, long, value_name = "DIR|OUT.glb")]
    pub(crate) output: PathBuf,
    /// The levels as shares of all triangles, the finest first, such as 0.5,0.25,0.1 [default: the
    /// lightest levels for heights on the screen of 1080, 540, 270 and 135 pixels].
    #[arg(long, value_name = "R,R,...", value_delimiter = ',', value_parser = share, conflicts_with = "triangles")]
    pub(crate) levels: Vec<f64>,
    /// The levels as numbers of triangles, the finest first, such as 20000,5000,1000.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', value_parser = leaves)]
    pub(crate) triangles: Vec<u64>,
    /// The distances in metres from which levels are seen, the nearest first, such as 5,20,80: for
    /// each the lightest level within `--max-flip` at the height that the screen shows there.
    #[arg(long, value_name = "M,M,...", value_parser = distances, allow_negative_numbers = true, conflicts_with_all = ["triangles", "levels"])]
    pub(crate) distances: Option<Distances>,
    /// How the levels lie in files [default: files in a folder, siblings in one file].
    #[arg(long, value_enum)]
    pub(crate) layout: Option<LayoutName>,
    /// The largest difference (mean FLIP) that a level may have where it begins to be seen.
    #[arg(long, value_name = "F", default_value_t = secateur_scene::chain::MAX_FLIP, value_parser = flip)]
    pub(crate) max_flip: f64,
    /// The picture that the chain ends in: crossed planes, octahedral views (docs/impostors.md has
    /// their sampler; other clients draw two crossed planes), none, or crossed planes where they
    /// look no worse than the lightest mesh [default: auto, none with --levels and --triangles].
    #[arg(long, value_enum)]
    pub(crate) impostor: Option<ImpostorName>,
    /// How many levels coarser the level that casts a level's shadow is, 0 to 2.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub(crate) shadow_steps: u8,
    /// The largest difference (mean FLIP of a view) that a switch from a level to the next may
    /// show; levels that would show more are left out.
    #[arg(long, value_name = "F", value_parser = flip)]
    pub(crate) max_pop: Option<f64>,
    /// Which textures cut-out leaves have.
    #[arg(long, value_enum, default_value_t = TexturesName::Fit)]
    pub(crate) textures: TexturesName,
    /// The height of the screen that the levels are for, in pixels.
    #[arg(long, value_name = "PX", default_value_t = 1080.0, value_parser = above_zero)]
    pub(crate) screen_height: f64,
    /// The vertical field of view of the camera that they are seen by, in degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = field_of_view)]
    pub(crate) fov: f64,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// Whether holes of leaf textures count.
    #[arg(long, value_enum, default_value_t = AlphaName::Mask)]
    pub(crate) alpha: AlphaName,
    /// From which sides leaves are seen.
    #[arg(long, value_enum, default_value_t = SidesName::Material)]
    pub(crate) sides: SidesName,
    /// What the leaves are simplified for.
    #[arg(long, value_enum, default_value_t = ChainPresetName::Look)]
    pub(crate) preset: ChainPresetName,
    /// Where to rasterise; results are the same.
    #[arg(long, value_enum, default_value_t = EngineName::Auto)]
    pub(crate) engine: EngineName,
    /// Write a page to look at the original and the chain side by side; it needs nothing else.
    #[arg(long, value_name = "FILE.html")]
    pub(crate) preview: Option<PathBuf>,
    /// Replace levels of other runs that have the same names.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Write the machine-readable record of the run to this file.
    #[arg(long, help_heading = OF_RECORDS, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Which impostor a chain ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ImpostorName {
    /// No impostor
    None,
    /// Crossed planes
    Crossed,
    /// Octahedral views
    Octahedral,
    /// Crossed planes where they look no worse
    Auto,
}

impl From<ImpostorName> for secateur_scene::impostor::Choice {
    fn from(name: ImpostorName) -> Self {
        match name {
            ImpostorName::None => Self::None,
            ImpostorName::Crossed => Self::Crossed,
            ImpostorName::Octahedral => Self::Octahedral,
            ImpostorName::Auto => Self::Auto,
        }
    }
}

/// Which textures the leaves of a level have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TexturesName {
    /// Made for the distance of each level: texels of about a pixel, which cover what the tree's do
    Fit,
    /// Those of the tree
    Keep,
}

impl From<TexturesName> for secateur_scene::chain::Textures {
    fn from(name: TexturesName) -> Self {
        match name {
            TexturesName::Fit => Self::Fit,
            TexturesName::Keep => Self::Keep,
        }
    }
}

/// How levels lie in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LayoutName {
    /// A file for each level: NAME_LOD0.glb, NAME_LOD1.glb, ...
    Files,
    /// One file with a node for each level under one parent, as Unity and Unreal import it
    Siblings,
    /// One file with the extension MSFT_lod, as Babylon.js reads it
    Msft,
}

#[derive(Args, Clone, Copy, Debug)]
#[group(required = true, multiple = false)]
pub(crate) struct TargetArgs {
    /// Stop at N leaves.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = leaves)]
    leaves: Option<u64>,
    /// Stop at this share of the leaves, 0 to 1 (rounded to the nearest number of leaves).
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = share)]
    ratio: Option<f64>,
    /// Stop before the VMI error on the driving views exceeds this many per cent.
    #[arg(long, value_name = "PCT", allow_negative_numbers = true, value_parser = from_zero)]
    max_error: Option<f64>,
    /// Stop at N triangles of the whole plant, wood and leaves, or at a share of them such as 0.25;
    /// with `--wood ignore` of the foliage. See `--leaf-triangles`.
    #[arg(long, value_name = "N|R", allow_negative_numbers = true, value_parser = triangles)]
    triangles: Option<Target>,
}

impl TargetArgs {
    /// The one target that is given.
    pub(crate) fn target(self) -> Target {
        match (self.leaves, self.ratio, self.triangles) {
            (Some(leaves), ..) => Target::leaves(leaves),
            (_, Some(ratio), _) => Target::leaf_share(ratio),
            (.., Some(triangles)) => triangles,
            _ => Target::MaxErrorPercent(self.max_error.unwrap_or(0.0)),
        }
    }
}

/// A number that passes a test, or what to write instead.
fn number(text: &str, is_right: fn(f64) -> bool, what: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| is_right(*number));
    number.ok_or_else(|| format!("write a number {what}"))
}

fn share(text: &str) -> Result<f64, String> {
    number(text, |n| (0.0..=1.0).contains(&n), "from 0 to 1")
}

fn from_zero(text: &str) -> Result<f64, String> {
    number(text, |n| n.is_finite() && n >= 0.0, "from 0 upwards")
}

fn above_zero(text: &str) -> Result<f64, String> {
    number(text, |n| n.is_finite() && n > 0.0, "above 0")
}

/// Distances of levels, rising.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Distances(pub(crate) Vec<f64>);

fn distances(text: &str) -> Result<Distances, String> {
    let all: Result<Vec<f64>, String> = text.split(',').map(|d| above_zero(d.trim())).collect();
    let all = all.map_err(|_| "write distances above 0, such as 5,20,80".to_owned())?;
    match all.windows(2).all(|w| w[0] < w[1]) {
        true => Ok(Distances(all)),
        false => Err("distances must rise, such as 5,20,80".to_owned()),
    }
}

fn flip(text: &str) -> Result<f64, String> {
    number(text, |n| n > 0.0 && n <= 1.0, "above 0 and at most 1")
}

fn field_of_view(text: &str) -> Result<f64, String> {
    number(
        text,
        |n| (1.0..179.0).contains(&n),
        "of degrees from 1 to 179",
    )
}

fn leaves(text: &str) -> Result<u64, String> {
    let wrong = |_| "write a whole number from 0 upwards".to_owned();
    text.parse().map_err(wrong)
}

/// A limit of coverage, or that there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MaxCoverage(pub(crate) Option<f64>);

fn max_coverage(text: &str) -> Result<MaxCoverage, String> {
    match (text, from_zero(text)) {
        ("none", _) => Ok(MaxCoverage(None)),
        (_, Ok(limit)) => Ok(MaxCoverage(Some(limit))),
        _ => Err("write none or a number from 0 upwards, such as 1".to_owned()),
    }
}

fn triangles(text: &str) -> Result<Target, String> {
    match (text.parse(), share(text)) {
        (Ok(count), _) => Ok(Target::triangles(count)),
        (_, Ok(share)) => Ok(Target::triangle_share(share)),
        _ => Err(
            "write a whole number of triangles from 0 upwards, or a share of them from 0 to 1 such \
             as 0.25"
                .to_owned(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_interface_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_weight_that_is_left_out_is_the_default() {
        let parse = |fit: &[&str]| {
            let words = [
                "secateur", "simplify", "a.glb", "-o", "b.glb", "--leaves", "9",
            ];
            let cli = Cli::try_parse_from([&words[..], fit].concat()).unwrap();
            match cli.command {
                Command::Simplify(args) => args.fit,
                _ => unreachable!("it is simplify"),
            }
        };
        let usual = Fitting::Weight(secateur_simplify::fit::DEFAULT_OUTLINE_WEIGHT);
        assert_eq!(parse(&["--fit"]), usual);
        assert_eq!(parse(&[]), Fitting::Auto);
        assert_eq!(parse(&["--fit=auto"]), Fitting::Auto);
        assert_eq!(parse(&["--fit=none"]), Fitting::None);
        assert_eq!(parse(&["--fit=coverage"]), Fitting::Coverage);
        assert_eq!(parse(&["--fit=0.25"]), Fitting::Weight(0.25));
    }

    #[test]
    fn whole_numbers_are_triangles_and_others_shares() {
        assert_eq!(triangles("1"), Ok(Target::triangles(1)));
        assert_eq!(triangles("1.0"), Ok(Target::triangle_share(1.0)));
        for wrong in ["-3", "1.5", "NaN", "many"] {
            let says = triangles(wrong).unwrap_err();
            assert!(says.contains("number of triangles"), "{wrong}: {says}");
        }
    }
}
