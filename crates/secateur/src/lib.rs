//! Makes the foliage of plants and trees light enough for real-time scenes.
//!
//! secateur reads a glTF tree, finds its leaves, decides leaf by leaf what can
//! go and what must grow, and writes the result as glTF. Leaves are chosen by
//! what a viewer would miss: viewpoint mutual information over cameras all
//! around the crown (Gasch, Remolar, Chover, Rebollo: Viewpoint-Driven
//! Simplification of Plant and Tree Foliage, Entropy 2018, 20, 213).
//!
//! # From a tree to a lighter tree
//! ```
//! use std::ops::ControlFlow;
//! use secateur::plant::{GrowOptions, Species, grow};
//! use secateur::{Document, Resolution, Simplify, Target, plant_to_glb, simplify};
//!
//! // Any .glb or .gltf will do: Tree::open(path, &[]). This one grows here.
//! let oak = grow(Species::Oak, &GrowOptions { leaves: 200, seed: 1 })?;
//! let tree = Document::from_bytes("oak.glb", plant_to_glb(&oak), None)?.into_tree(&[])?;
//!
//! let mut settings = Simplify::to(Target::Ratio(0.25));
//! settings.resolution = Resolution::Pixels(64);
//! let result = simplify(tree.foliage(), &settings, &mut |_| ControlFlow::Continue(()))?;
//! assert_eq!(result.lod.leaf_count(), 50);
//!
//! let glb = tree.lod_to_bytes(&result.lod)?; // or tree.write_lod(&result.lod, path)
//! # assert!(glb.starts_with(b"glTF"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it flows
//! ```text
//! .glb -> Document -> Tree { Foliage } -> Fragments -> AreaTable -> Vmi
//!                       |                                            |
//!                       |                       RemovalOrder <- simplify
//!                       +------ write_lod <- Lod <---+
//! ```
//! - [`Document`] is a file as it was found, [`Tree`] one whose leaves are known.
//!   Which part is foliage the user names by [`Selector`]s, or the evidence
//!   shows ([`Document::inspect`] says why).
//! - A leaf is a set of triangles that hang together; a [`LeafId`] names it, from
//!   1, in file order. 0 is the background wherever leaves are drawn.
//! - [`simplify`] takes leaves away one by one, each time the one that changes
//!   the measure least, and lets its nearest neighbour grow. The outcome is a
//!   [`RemovalOrder`]; *every prefix of it is a LOD*, but for a last
//!   step that fits sizes: [`Lod::after`]. So one run to
//!   the coarsest level gives all finer ones, unless triangles are the target: then
//!   leaves first become as coarse as that target needs.
//! - [`Tree::write_lod`] keeps everything that is no removed or resized leaf as
//!   it was: wood, materials, textures, attributes, names, extensions.
//! - [`measure`] judges a result by views that [`simplify`] never saw.
//!
//! The same tree and settings give the same order on every machine, on the CPU
//! and on every GPU, bit for bit: from the snapped triangles on all arithmetic
//! is on integers. Which triangles of a coarser leaf are left ([`mod@coarsen`]) is
//! decided in floating point before that, and may differ between kinds of processors.
//!
//! # What it refuses
//! Draco-compressed files (decode them first), glTF 1, unknown required
//! extensions, broken or hostile files, foliage that can't be told from wood
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
//! | reading and writing | [`Document`], [`Tree`], [`Selector`], [`Inspection`], [`Written`], [`PreparedLod`], [`GltfError`] |
//! | leaves | [`Foliage`], [`Leaf`], [`LeafTriangle`], [`LeafId`], [`Cutout`] |
//! | simplifying | [`simplify()`], [`Simplify`], [`Target`], [`Simplified`], [`Progress`] |
//! | one's own cameras | [`Views::Cameras`], [`read_cameras`], [`raster::View`] |
//! | one's own GPU | [`OpenEngine::on_device`], [`simplify_on`] |
//! | results | [`RemovalOrder`], [`Lod`], [`raster::AreaTable`], [`vmi`] |
//! | judging | [`measure()`], [`measure_pictures`], [`eval`] |
//! | one stage alone | [`raster`], [`vds`], [`vmi`] |
//! | budgets of triangles | [`Target::Triangles`], [`LeafTriangles`], [`mod@coarsen`] |
//! | the look or the information | [`Preset`] |
//! | sizes of what is left | [`Simplify::fit`], [`mod@fit`] |
//! | other methods | [`Method`], [`fsa`], [`stochastic`], [`meshopt`](mod@meshopt) |
//! | methods that follow branches | [`Tree::skeleton`], [`PlantSkeleton`], [`plant::chain_order`], [`plant::merge_order`] |
//! | trees without files | [`plant`] |
//!
//! # Features
//! `gpu` (default): rasterising on a GPU through wgpu. `cli` (default): the
//! program `secateur`; turn it off where only the library is wanted.

mod audit;
mod baseline;
mod cameras;
mod clock;
mod driven;
mod engine;
mod error;
mod fitted;
mod measure;
mod preset;
mod run;
mod settings;
mod warnings;

pub use cameras::{cameras_from_json, read_cameras};
pub use engine::OpenEngine;
pub use error::Error;
pub use measure::{measure, measure_pictures};
pub use preset::Preset;
pub use run::{Progress, Simplified, simplify, simplify_on, sphere_of};
pub use settings::{
    Alpha, Engine, Fitting, LeafTriangles, Method, Resolution, Simplify, Target, Views,
};

pub use secateur_eval::{MeasureError, Measurement, PictureMeasurement};
pub use secateur_gltf::{
    CommitError, Document, FoliageReport, GltfError, Inspection, PreparedLod, PrimitiveReport,
    Problem, Reason, Selector, SelectorError, Spread, StagedFiles, TakenFor, Tree, WriteOptions,
    WriteProblem, Written, plant_into_glb, plant_to_glb,
};
pub use secateur_model::{
    AlphaMode, BoundingSphere, CornerRef, Cutout, Foliage, FoliageError, Growth, Leaf, LeafId,
    LeafTriangle, Lod, Material, NewCorner, NewLeaf, Place, Plant, PlantSkeleton, RemovalOrder,
    Segment, SegmentIndex, SkeletonError, Step, Surface, Texture, Wrap,
};
pub use secateur_simplify::vds::{Reference, Resize, Stopped, Ties};

/// The vectors of this interface.
pub use glam;
/// What a result looks like beside its original.
pub use secateur_eval as eval;
/// Growing plants.
pub use secateur_plant as plant;
/// Views, fragments and areas, on the CPU and the GPU.
pub use secateur_raster as raster;
/// Coarser leaves, below [`simplify`].
pub use secateur_simplify::coarsen;
/// Sizes of what is left, below [`simplify`].
pub use secateur_simplify::fit;
/// Leaf collapse, below [`simplify`].
pub use secateur_simplify::fsa;
/// Mesh simplification, below [`simplify`].
pub use secateur_simplify::meshopt;
/// Stochastic pruning, below [`simplify`].
pub use secateur_simplify::stochastic;
/// VDS itself, below [`simplify`].
pub use secateur_simplify::vds;
/// The measure, in integers.
pub use secateur_simplify::vmi;
