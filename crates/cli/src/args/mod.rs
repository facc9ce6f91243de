//! What can be written on the command line; the commands with many options have a file each.

mod batch;
mod grow;
mod lod;
mod lods;
mod short_help;
mod simplify;
mod stand;
mod stream;
mod study;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgAction, Args, FromArgMatches, Parser, Subcommand, ValueEnum};
use secateur::{
    Alpha, Engine, ImageFormat, JudgingViews, Memory, Opening, Selector, Sides, VertexAlpha,
    WoodMode, WriteOptions,
};
use secateur_simplify::option_numbers::{from_zero, number, share};

use super::schema::RecordName;

pub(crate) use batch::{Batch, BatchCollect, BatchRun, Completions};
pub(crate) use grow::Grow;
pub(crate) use lod::{LevelArgs, Lod};
pub(crate) use lods::Lods;
pub(crate) use short_help::command;
pub(crate) use simplify::{MaxCoverage, Simplify};
pub(crate) use stand::Stand;
pub(crate) use stream::Stream;
pub(crate) use study::Study;

/// Makes the foliage of plants and trees light enough for real-time scenes.
#[derive(Debug, Parser)]
#[command(
    name = "secateur",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done; 1 the input does not allow it; 2 wrong usage; 3 some of several inputs failed; \
                  4 the machine does not allow it (memory, disk, GPU); 130 interrupted."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Grow a tree and make levels of detail of it, a page to look at them, a picture and a report: no input needed.
    Demo(Demo),
    /// Show what is in a tree: leaves, wood, materials; what was taken for foliage and why.
    Inspect(Inspect),
    /// Make the foliage of a tree lighter and write the result.
    Simplify(Box<Simplify>),
    /// Write any level along the removal order of an earlier `simplify`, without simplifying again.
    Lod(Lod),
    /// Make a chain of levels of detail for an engine, wood and leaves alike.
    Lods(Box<Lods>),
    /// Give each of many plants in a scene the level that its cameras need, within a difference or a budget.
    Stand(Box<Stand>),
    /// Judge a simplified tree against its original, from four sets of 12 views, none of them near
    /// a view that `simplify` uses by default.
    Measure(Measure),
    /// Compare methods and settings over trees: raw rows, charts of time against error, a report.
    Study(Study),
    /// Write a tree as a stream of which every prefix is a plant, the coarsest level first; or read
    /// one.
    Stream(Box<Stream>),
    /// Grow a plant from rules: a species, or a file of your own.
    Grow(Grow),
    /// Split levels of many trees into items for an engine of batches, do an item, gather what was done.
    #[command(subcommand)]
    Batch(Batch),
    /// Print the JSON Schema of a record that a command writes, or which records there are.
    Schema(Schema),
    /// Print what a shell needs to complete commands and options, or write man pages.
    Completions(Completions),
}

impl Cli {
    /// What these words ask for, the first of which is the program's name.
    pub(crate) fn of(
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Self, clap::Error> {
        let matches = command().try_get_matches_from(words)?;
        Self::from_arg_matches(&matches)
    }
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
    /// The record that reports have.
    Json,
    /// A line of names and lines of values.
    Csv,
    /// A table in Markdown.
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
    /// The seed of the tree.
    #[arg(long, value_name = "S", default_value_t = 3)]
    pub(crate) seed: u64,
    /// Where images are drawn; the result is the same, bit for bit.
    #[arg(long, value_enum, default_value_t = Engine::Auto)]
    pub(crate) engine: Engine,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
}

#[derive(Args, Debug)]
pub(crate) struct Inspect {
    /// The tree, .glb or .gltf; - reads standard input.
    #[arg(value_name = "TREE.glb")]
    pub(crate) tree: PathBuf,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Write the record to this file too.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Schema {
    /// The record; without a name all are listed.
    #[arg(value_enum, value_name = "NAME")]
    pub(crate) name: Option<RecordName>,
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
    #[arg(long, value_enum, default_value_t = JudgingViews::HeldOut)]
    pub(crate) views: JudgingViews,
    #[command(flatten)]
    pub(crate) plant: PlantArgs,
    /// Whether holes of leaf textures count.
    #[arg(long, value_enum, default_value_t = Alpha::Mask)]
    pub(crate) alpha: Alpha,
    /// From which sides leaves are seen.
    #[arg(long, value_enum, default_value_t = Sides::Material)]
    pub(crate) sides: Sides,
    /// The heights on the screen in pixels at which the difference that people see is taken, such as 1080,270.
    #[arg(long, value_name = "PX,PX,...", value_delimiter = ',', default_value = "540", value_parser = height)]
    pub(crate) pixels_high: Vec<f64>,
    /// Also draw pictures this many pixels wide as clients do (mip maps, alpha test, culling), and
    /// compare them with the original as it truly looks.
    #[arg(long, value_name = "WIDTH", value_parser = clap::value_parser!(u32).range(8..=2048))]
    pub(crate) as_drawn: Option<u32>,
    /// Write the record to this file too.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

fn height(text: &str) -> Result<f64, String> {
    number(
        text,
        |px| (8.0..=1e5).contains(&px),
        "of pixels from 8 to 100000",
    )
}

/// How a plant is opened.
#[derive(Args, Clone, Debug)]
pub(crate) struct PlantArgs {
    #[command(flatten)]
    foliage: Foliage,
    #[command(flatten)]
    not_plant: NotPlantArg,
    #[command(flatten)]
    vertex_alpha: VertexAlphaArg,
    #[command(flatten)]
    memory: MemoryArg,
}

impl PlantArgs {
    /// Parts that `--foliage` names as foliage; none where the program decides.
    pub(crate) fn selectors(&self) -> &[Selector] {
        &self.foliage.foliage
    }

    /// Parts that `--not-plant` names.
    pub(crate) fn not_plant(&self) -> &[Selector] {
        &self.not_plant.not_plant
    }

    /// How much memory may be taken.
    pub(crate) fn memory(&self) -> Memory {
        self.memory.memory
    }

    /// What the alpha of vertex colours does.
    pub(crate) fn vertex_alpha(&self) -> VertexAlpha {
        self.vertex_alpha.vertex_alpha
    }

    /// How a plant of these options is opened.
    pub(crate) fn opening(&self, wood: WoodMode) -> Opening {
        Opening {
            foliage: self.foliage.foliage.clone(),
            not_plant: self.not_plant().to_vec(),
            vertex_alpha: self.vertex_alpha(),
            wood,
            wind: false,
            memory: self.memory(),
        }
    }
}

/// How the geometry and images of a written file are packed.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct PackingArgs {
    /// Quantise and compress geometry (meshopt), and write images as webp or ktx2 [default of the flag alone: webp].
    #[arg(
        long,
        value_name = "IMAGES",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "webp"
    )]
    pub(crate) compress: Option<ImageFormat>,
    /// Write triangles as strips in place of lists, made from the coarse to the fine.
    #[arg(long)]
    pub(crate) strips: bool,
}

impl PackingArgs {
    /// These, with whether files may be replaced.
    pub(crate) fn write_options(self, overwrite: bool) -> WriteOptions {
        WriteOptions::default()
            .overwrite(overwrite)
            .compress(self.compress)
            .strips(self.strips)
    }
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct WindArg {
    /// Write beside each vertex what it hangs on, found by where leaves and wood are, so that a shader sways all levels
    /// alike (docs/wind.md).
    #[arg(long)]
    pub(crate) wind: bool,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct Foliage {
    /// What is foliage: material:NAME, mesh:NAME or node:NAME, with * and ? as wildcards, #N for
    /// numbers; can be given several times [default: what the evidence shows, see `inspect`].
    #[arg(long, value_name = "SELECTOR")]
    pub(crate) foliage: Vec<Selector>,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct NotPlantArg {
    /// What is not the plant, named as for `--foliage`: it stays as it is, and is neither drawn nor counted; can be
    /// given several times [default: ground and helpers].
    #[arg(long, value_name = "SELECTOR")]
    pub(crate) not_plant: Vec<Selector>,
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct VertexAlphaArg {
    /// Whether the alpha of vertex colours hides leaves: keep, ignore (where it is wind data), or auto:
    /// unless it would hide most of a primitive.
    #[arg(long, value_name = "auto|keep|ignore", default_value_t)]
    pub(crate) vertex_alpha: VertexAlpha,
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct MemoryArg {
    /// How much memory to take at most, such as 2G or 800M: what takes more is refused before it
    /// is taken [default: half of what the machine, or its limits, let the program have].
    #[arg(
        long,
        value_name = "SIZE",
        default_value = "auto",
        hide_default_value = true
    )]
    pub(crate) memory: Memory,
}

#[derive(Args, Clone, Debug, Default)]
pub(crate) struct SceneArgs {
    /// A glTF scene in the tree's world space: its perspective cameras are where to look from
    /// (`extras.weight`, 1 to 16, says how often one counts), all its meshes hide leaves.
    #[arg(long, value_name = "SCENE.glb", value_hint = clap::ValueHint::AnyPath)]
    pub(crate) scene: Option<PathBuf>,
    /// Something else that hides leaves, in the tree's world space: a fence, a wall, terrain; can
    /// be given several times.
    #[arg(long, value_name = "FILE.glb", value_hint = clap::ValueHint::AnyPath)]
    pub(crate) occluder: Vec<PathBuf>,
}

fn leaves(text: &str) -> Result<u64, String> {
    let wrong = |_| "write a whole number from 0 upwards".to_owned();
    text.parse().map_err(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use secateur::Fitting;

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
}
