//! Makes the foliage of plants and trees light enough for real-time scenes.
//!
//! secateur reads a glTF tree, finds its leaves, decides leaf by leaf what can
//! go and what must grow, and writes the result as glTF. Leaves are chosen by
//! what a viewer would miss: viewpoint mutual information over cameras all
//! around the crown (Gasch, Remolar, Chover, Rebollo: Viewpoint-Driven
//! Simplification of Plant and Tree Foliage, Entropy 2018, 20, 213).
//!
//! # From a tree to a lighter tree
//! ```no_run
//! use secateur::plant::{GrowOptions, Species};
//! use secateur::{Layout, LevelOptions, LevelsOptions, Plant, judge};
//!
//! // Any .glb or .gltf will do: Plant::open(path). This one grows here.
//! let oak = Plant::grow(Species::Oak, &GrowOptions { leaves: 200, seed: 1 })?;
//!
//! // What `secateur simplify --triangles 0.25` writes, material changes included.
//! let level = oak.level(&LevelOptions::triangles(0.25))?;
//! level.write("oak-25.glb")?;
//! let judged = judge(&oak, &Plant::open("oak-25.glb")?)?;
//! assert!(judged.difference_at(540.0).difference < 0.5);
//!
//! // Levels for an engine, as `secateur lods` writes them.
//! oak.levels(&LevelsOptions::default())?.write("levels", Layout::Files)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it flows
//! ```text
//! .glb -> Document -> Tree { Foliage } -> coarsen -> select -> size -> Lod -> write_lod -> .glb
//!                                                       |
//!                                views -> fragments -> areas -> VMI
//! ```
//! - [`Document`] is a file as it was found, [`Tree`] one whose leaves are known.
//!   Which part is foliage the user names by [`Selector`]s, or the evidence
//!   shows ([`Document::inspect`] says why).
//! - A leaf is a set of triangles that hang together; a [`LeafId`] names it, from
//!   1, in file order. 0 is the background wherever leaves are drawn.
//! - [`simplify()`] is a row of passes. Where triangles are the target, leaves first become
//!   coarser. Then a [`Method`] removes leaves one by one: VDS each time the one that changes the
//!   measure least, and its nearest neighbour grows. At last the sizes of what is left are fitted
//!   to the original. [`Passes`] holds what each of them did; every prefix of its [`RemovalOrder`]
//!   is a LOD ([`Passes::lod_after`]), so one run to the coarsest level gives all finer ones.
//! - `Plant` and `Level` do all of this as the program does, and choose what changes in materials too.
//! - A `Session` tells progress and can be cancelled; `Surroundings` say from where a plant is seen and what hides it.
//!   [`simplify_on`] does the same for a foliage alone.
//! - [`Tree::write_lod`] keeps everything that is no removed or resized leaf as
//!   it was: wood, materials, textures, attributes, names, extensions.
//! - `judge` compares a result with its plant from views that [`simplify()`] never saw.
//!
//! Equal trees and options give the same order on every machine, on the CPU
//! and on every GPU, bit for bit: from the snapped triangles on all arithmetic
//! is on integers. Which triangles of a coarser leaf are left is
//! decided in floating point before that, and may differ between kinds of processors.
//!
//! # What it refuses
//! glTF 1, unknown required extensions, broken or hostile files, foliage that can't be told from wood
//! without being named, positions that are not finite. Every refusal is an
//! [`Error`] of one sentence: the file, the place, what is wrong, what to do.
//! Skins are read in bind pose and morph targets at rest.
//!
//! # What it costs
//! 20,000 leaves to a tenth, 20 views of 256 x 256: some seconds and some
//! hundred megabytes on two CPU cores. Time grows about in proportion to the
//! leaves at equal crown density.
//!
//! # Map
//! | for | look at |
//! |---|---|
//! | what the program does | `Plant`, `Level`, `Levels`, `chain` |
//! | one engine and one memory for many calls; progress, cancelling | `Session` |
//! | what a plant stands within | `Surroundings` |
//! | many plants and the cameras that see them | `stand::Stand` |
//! | options in files | [`Versioned`] |
//! | reading and writing | [`Document`], [`Tree`], [`Selector`], [`VertexAlpha`], [`Inspection`], [`Written`], [`PreparedLod`], [`GltfError`] |
//! | leaves | [`Foliage`], [`Leaf`], [`LeafTriangle`], [`LeafId`], [`Cutout`] |
//! | simplifying | [`simplify()`], [`Options`], [`Target`], [`Simplified`], [`Progress`], [`Warning`] |
//! | the look or the information; how much work | [`Preset`], [`Effort`] |
//! | methods and their options | [`Method`], [`VdsOptions`], [`FsaOptions`], [`StochasticOptions`], [`MeshoptOptions`] |
//! | one's own cameras | [`Views::Cameras`], [`read_cameras`], [`View`] |
//! | a scene's cameras, and what hides leaves | [`Document::cameras`], [`scene_views`], [`Document::occluders`], [`Options::occluders`] |
//! | one's own GPU | [`OpenEngine::on_device`], [`simplify_on`] |
//! | results | [`Passes`], [`RemovalOrder`], [`Lod`], [`AreaTable`], [`Vmi`], [`observe`] |
//! | all levels of an order | [`LodModel`], [`UniformLevel`], [`Forest`] |
//! | judging | `judge`, `Judged`, `Figures` |
//! | methods that follow branches | [`Tree::skeleton`], [`PlantSkeleton`], [`Options::skeleton`] |
//! | trees without files | `plant` |
//!
//! Each stage by itself is a crate of its own: `secateur-model`, `secateur-gltf`,
//! `secateur-raster`, `secateur-simplify`, `secateur-eval`, `secateur-plant`. The program
//! is `secateur-cli`; `secateur-study` compares methods.
//!
//! # Features
//! All but the last are on by default. `gpu`: rasterising on a GPU through wgpu. `plant`: growing plants, and
//! methods that follow their branches. `eval`: judging. `scene`: levels with their materials (`Plant`, `Level`).
//! `cli`: options and records as command lines and JSON schemas know them, for the program of `secateur-cli`.

#![forbid(unsafe_code)]

#[cfg(feature = "scene")]
mod cutoffs_record;
#[cfg(feature = "scene")]
pub mod engines;
mod error;
mod error_kind;
#[cfg(feature = "scene")]
mod judged;
#[cfg(feature = "scene")]
mod level;
#[cfg(feature = "scene")]
mod level_options;
#[cfg(feature = "scene")]
mod level_record;
#[cfg(feature = "scene")]
mod level_warning;
#[cfg(feature = "scene")]
mod levels;
#[cfg(feature = "scene")]
mod opened_plant;
#[cfg(feature = "scene")]
mod part_levels;
#[cfg(feature = "scene")]
mod preview_page;
mod progress_share;
mod scene;
#[cfg(feature = "scene")]
mod session;
#[cfg(feature = "scene")]
pub mod stand;
#[cfg(feature = "scene")]
mod surroundings;
mod versioned;

#[cfg(feature = "scene")]
pub use cutoffs_record::{CutoffsRecord, RaisedRecord, ShownRecord};
pub use error::Error;
pub use error_kind::ErrorKind;
#[cfg(feature = "scene")]
pub use judged::{
    AllScores, DifferenceAt, Differences, Figures, JudgeOptions, Judged, Misplaced, SetFigures,
    judge, judge_document,
};
#[cfg(feature = "scene")]
pub use level::{Level, LevelParts};
#[cfg(feature = "scene")]
pub use level_options::{ColorChoice, LevelOptions};
#[cfg(feature = "scene")]
pub use level_record::{ColorRecord, Counts, LevelRecord};
#[cfg(feature = "scene")]
pub use level_warning::LevelWarning;
#[cfg(feature = "scene")]
pub use levels::{LevelPlace, Levels, PlacedLevel};
#[cfg(feature = "scene")]
pub use opened_plant::{Opening, Plant};
#[cfg(feature = "scene")]
pub use part_levels::{PartLevel, PartLevelError};
pub use progress_share::ProgressShare;
pub use scene::scene_views;
#[cfg(feature = "scene")]
pub use secateur_gltf::chain::Layout;
#[cfg(feature = "scene")]
pub use secateur_levels::CutoffChoice;
#[cfg(feature = "scene")]
pub use secateur_levels::chain::ChainOptions as LevelsOptions;
#[cfg(feature = "scene")]
pub use session::Session;
#[cfg(feature = "scene")]
pub use surroundings::Surroundings;
pub use versioned::Versioned;

#[cfg(feature = "eval")]
pub use secateur_eval::{
    AsDrawnMeasurement, Difference, Judging, JudgingViews, MeasureError, OriginalAsDrawn,
};
pub use secateur_gltf::{
    CommitError, Cutoffs, Detail, Document, FoliageReport, GltfError, ImageFormat, Inspection,
    LeafSurface, NoImageFormat, OtherPieces, Piece, PreparedLod, PrimitiveReport, Problem, Reason,
    SceneCamera, ScenePieces, Selector, SelectorError, Spread, StagedFiles, TakenFor, Tree,
    VertexAlpha, WholeTree, WriteOptions, WriteProblem, Written, has_extension, is_gltf_name,
    plant_into_glb, plant_to_glb, surfaces_to_glb,
};
pub use secateur_model::{
    AlphaMode, BoundingSphere, CollapseIndex, CornerRef, Cutout, Facing, Filters, Finish, Foliage,
    FoliageError, Forest, Growth, Heirs, Hold, Leaf, LeafId, LeafTriangle, Lod, LodModel, Material,
    Memory, Mips, NamedOption, NewCorner, NewLeaf, NoHeirs, Node, NodeIndex, NormalMap, Note,
    OrderError, OverMemory, Place, Plant as GrownPlant, PlantHolds, PlantSkeleton, Remedy,
    RemovalOrder, Segment, SegmentIndex, SkeletonError, Step, Surface, Texture, UniformLevel, Wrap,
};
pub use secateur_raster::measure::vmi::{ScaledBits, Vmi};
pub use secateur_raster::{
    AreaTable, CamerasError, Engine, OpenEngine, View, ViewError, ViewSet, cameras_from_json,
    read_cameras,
};
#[cfg(feature = "plant")]
pub use secateur_simplify::by_branches::{ChainOptions, MergeOptions};
pub use secateur_simplify::coarsen::Coarse;
pub use secateur_simplify::fit::Objective;
pub use secateur_simplify::fsa::{Corners, FsaOptions, Hausdorff};
pub use secateur_simplify::meshopt::{
    Borders as MeshoptBorders, MeshoptOptions, Mode as MeshoptMode,
};
pub use secateur_simplify::stochastic::StochasticOptions;
pub use secateur_simplify::vds::{Reference, Resize, Ties, VdsError, VdsOptions};
pub use secateur_simplify::whole::{WholeLevel, WholePlant, WoodMode, simplify_keeping_wood};
pub use secateur_simplify::{
    Alpha, Amount, Effort, Error as SimplifyError, FieldOfView, Fitting, LeafTriangles, Method,
    Needles, Observer, Options, Passes, Preset, Progress, Resolution, Sides, Simplified, Stage,
    Stopped, Target, Views, Warning, as_seen, observe, simplify, simplify_on, sphere_of,
};

/// The vectors of this interface.
pub use glam;

/// What [`Plant::levels`] takes and gives.
#[cfg(feature = "scene")]
pub mod chain {
    pub use secateur_gltf::chain::{
        ChainFile, ChainFiles, Layout, PreparedChain, UnknownLayout, WrittenChain,
    };
    pub use secateur_levels::chain::{
        BadOptions, Chain, ChainError, ChainLevel, ChainOptions as LevelsOptions, LevelReport,
        SceneLook, Shape, Textures, Wanted,
    };
    pub use secateur_levels::impostor::Choice as ImpostorChoice;
    pub use secateur_runtime::Screen;
}

/// A GPU to rasterise on.
#[cfg(feature = "gpu")]
pub mod gpu {
    pub use secateur_raster::gpu::{Device, GpuError, Preference, wgpu};
}

/// Plants grown from L-systems: species, and crowns for tests.
#[cfg(feature = "plant")]
pub mod plant {
    pub use secateur_plant::{
        ClusterSize, EllipsoidCrown, GrowOptions, Species, ellipsoid_crown, grow,
    };
}
