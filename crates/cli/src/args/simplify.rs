//! The options of `secateur simplify`.

use std::path::PathBuf;

use clap::Args;
use secateur::{
    Alpha, ChainOptions, ColorChoice, CutoffChoice, Effort, Engine, FieldOfView, Fitting,
    FsaOptions, LeafTriangles, MergeOptions, MeshoptMode, Needles, PartLevel, Preset, Reference,
    Resize, Resolution, Sides, StochasticOptions, Target, Ties, WoodMode,
};

use super::super::names::MethodName;
use super::{
    Foliage, MemoryArg, NotPlantArg, OF_OTHERS, OF_RECORDS, OF_VDS, PackingArgs, SceneArgs,
    VertexAlphaArg, WindArg, from_zero, leaves, share,
};

#[derive(Args, Debug)]
pub(crate) struct Simplify {
    /// The tree, .glb or .gltf; - reads standard input.
    #[arg(value_name = "TREE.glb")]
    pub(crate) tree: PathBuf,
    /// The result, .glb or .gltf; - writes a GLB to standard output.
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: PathBuf,
    /// Let the buffer of a .gltf replace a file beside it that is not its own.
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) packing: PackingArgs,
    #[command(flatten)]
    pub(crate) target: TargetArgs,
    /// What becomes of the wood [default: auto with `--triangles`, which then counts the whole
    /// plant, and with `--level-of`; else ignore].
    #[arg(long, value_enum)]
    pub(crate) wood: Option<WoodMode>,
    #[command(flatten)]
    pub(crate) foliage: Foliage,
    #[command(flatten)]
    pub(crate) not_plant: NotPlantArg,
    /// Parts that keep a share of their own triangles, named as for `--foliage`, wood too: such as
    /// material:bark=0.1; can be given several times, and the last that names a part counts. The target is the
    /// rest's.
    #[arg(long, value_name = "SELECTOR=R", conflicts_with = "order")]
    pub(crate) level_of: Vec<PartLevel>,
    #[command(flatten)]
    pub(crate) vertex_alpha: VertexAlphaArg,
    #[command(flatten)]
    pub(crate) wind: WindArg,
    #[command(flatten)]
    pub(crate) memory: MemoryArg,
    /// Whether holes of leaf textures count [default: mask; ignore for the paper's presets].
    #[arg(long, value_enum)]
    pub(crate) alpha: Option<Alpha>,
    /// From which sides leaves are seen [default: material; both for the paper's presets].
    #[arg(long, value_enum)]
    pub(crate) sides: Option<Sides>,
    /// How leaves are chosen.
    #[arg(long, value_enum, default_value_t = MethodName::Vds)]
    pub(crate) method: MethodName,
    /// Where to rasterise; results are the same.
    #[arg(long, value_enum, default_value_t = Engine::Auto)]
    pub(crate) engine: Engine,
    /// Where to look from: auto (dodecahedron; 60 with a budget of triangles where most leaves cover at most a pixel),
    /// dodecahedron (20 views), turning (20 at a time, which turn between stages), icosahedron (12), 32, 60, 92, 8, 6, vnc (20 views, later 12, 8 and 6), or a JSON
    /// file {"cameras": [{"eye": [x,y,z], "target": [x,y,z], "up", "fov_y_degrees", "near"}]}
    /// [default: auto for the look, turning for information, dodecahedron for the paper's presets].
    #[arg(long, value_name = "VIEWS", conflicts_with = "scene")]
    pub(crate) views: Option<String>,
    /// How much views see: tight (the crown just fits, 38.9 degrees), or degrees above 0 and below
    /// 180 [default: 60].
    #[arg(long, value_name = "tight|DEGREES", allow_negative_numbers = true, value_parser = field_of_view)]
    pub(crate) field_of_view: Option<FieldOfView>,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Width and height of the images in pixels: 1 to 2048, or auto: 256, for information more where the leaves
    /// need it [default: auto; 256 for the look and the paper's presets].
    #[arg(long, value_name = "auto|N")]
    pub(crate) resolution: Option<Resolution>,
    /// What the result is for; other options override what look and information set, and
    /// contradict the paper's.
    #[arg(long, value_enum, default_value_t = Preset::Look)]
    pub(crate) preset: Preset,
    /// How much work goes into what other options leave to the program.
    #[arg(long, value_enum, default_value_t = Effort::Normal)]
    pub(crate) effort: Effort,
    /// Whether to change the sizes of the remaining leaves at the end until other views than those
    /// that chose them (your own cameras: the same ones) look like the original. coverage: each
    /// part of the crown gets as dense as it was. A weight W from 0 to 100: the outline and the
    /// information are fitted, and a pixel of outline counts W (0.95 after --fit alone). auto: what
    /// the preset does, for vds if --resize and --max-coverage are the preset's.
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
    /// Which alpha cutoffs cut-out leaves have in the result [default: fit for the look by vds, if masks
    /// count; else keep].
    #[arg(long, value_enum)]
    pub(crate) cutoffs: Option<CutoffChoice>,
    /// Which colours clear texels of leaf textures have in the result: mip maps mix them in, so that leaves
    /// over black get darker from afar [default: dilate where cutoffs are chosen; else keep].
    #[arg(long, value_enum)]
    pub(crate) colors: Option<ColorChoice>,
    /// What the cost of a leaf is measured against [default: previous for the look, original for
    /// information].
    #[arg(long, help_heading = OF_VDS, value_enum)]
    pub(crate) reference: Option<Reference>,
    /// The share of a pruned leaf's area that its neighbours gain [default: full for the look,
    /// normalised for information].
    #[arg(long, help_heading = OF_VDS, value_enum)]
    pub(crate) resize: Option<Resize>,
    /// How many nearest neighbours share that area.
    #[arg(long, help_heading = OF_VDS, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) neighbours: u32,
    /// Let no leaf grow while the views show at least C times as much foliage as at first: keeps
    /// gaps and the outline, at the cost of more VMI error [default: 1 for the look, none for
    /// information].
    #[arg(long, help_heading = OF_VDS, value_name = "C|none", allow_negative_numbers = true, value_parser = max_coverage)]
    pub(crate) max_coverage: Option<MaxCoverage>,
    /// Which of equally cheap leaves goes first: the first in the file, or spread over the crown.
    #[arg(long, help_heading = OF_VDS, value_enum, default_value_t = Ties::Order)]
    pub(crate) ties: Ties,
    /// How many triangles a leaf keeps at most: a number; keep: all; auto: with `--triangles`
    /// fewer, so that more leaves stay (a leaf with holes keeps as many as show the same, or two),
    /// else all [default: auto; keep for the paper's presets].
    #[arg(long, help_heading = OF_VDS, value_name = "auto|keep|N")]
    pub(crate) leaf_triangles: Option<LeafTriangles>,
    /// With `--triangles`: whether flat leaves more than four times as long as wide, without a cut-out,
    /// grow across only, or as every leaf does [default: widen for the look, else scale].
    #[arg(long, help_heading = OF_VDS, value_enum)]
    pub(crate) needles: Option<Needles>,
    #[command(flatten, next_help_heading = OF_OTHERS)]
    pub(crate) stochastic: StochasticOptions,
    #[command(flatten, next_help_heading = OF_OTHERS)]
    pub(crate) fsa: FsaOptions,
    /// meshopt: which of its simplifiers to use.
    #[arg(long, help_heading = OF_OTHERS, value_enum, default_value_t = MeshoptMode::Prune)]
    pub(crate) meshopt_mode: MeshoptMode,
    /// meshopt: move the borders of what is left outwards, to give back lost area.
    #[arg(long, help_heading = OF_OTHERS)]
    pub(crate) preserve_area: bool,
    /// meshopt: move them after each halving of the triangles, as meshoptimizer's example does.
    #[arg(long, help_heading = OF_OTHERS, conflicts_with = "preserve_area")]
    pub(crate) dilate_borders: bool,
    #[command(flatten, next_help_heading = OF_OTHERS)]
    pub(crate) chain: ChainOptions,
    #[command(flatten, next_help_heading = OF_OTHERS)]
    pub(crate) merge: MergeOptions,
    /// Draw the result again in another way, and fail if its areas differ [default: in debug
    /// builds].
    #[arg(long, help_heading = OF_RECORDS, overrides_with = "no_audit")]
    pub(crate) audit: bool,
    /// Do not draw the result again.
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

fn field_of_view(text: &str) -> Result<FieldOfView, String> {
    match text.parse() {
        Ok(FieldOfView::Auto) | Err(_) => {
            Err("write tight, or degrees above 0 and below 180".to_owned())
        }
        Ok(own) => Ok(own),
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
