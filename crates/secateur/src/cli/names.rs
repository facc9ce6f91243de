//! Names on the command line for values of the library.

use clap::ValueEnum;
use secateur::{
    Alpha, ColorChoice, CutoffChoice, Engine, JudgingViews, Needles, Preset, Reference, Resize,
    Sides, Ties, WoodMode,
};
use secateur_plant::{ClusterSize, Metric};
use secateur_simplify::fsa::{Corners, Hausdorff};
use secateur_simplify::meshopt::Mode;

/// An enum of names, each with what it says in `--help`, and the values they stand for.
macro_rules! names {
    ($(#[$doc:meta])* $name:ident => $library:ident { $($(#[$help:meta])* $value:ident),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub(crate) enum $name { $($(#[$help])* $value),+ }

        impl From<$name> for $library {
            fn from(name: $name) -> Self {
                match name { $($name::$value => $library::$value),+ }
            }
        }
    };
}

/// A name as it is written on the command line.
pub(crate) fn text(name: impl ValueEnum) -> String {
    let possible = name.to_possible_value();
    possible
        .map(|v| v.get_name().to_owned())
        .unwrap_or_default()
}

/// The methods by the names of `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Viewpoint-driven simplification, by an exact and fast engine
    Vds,
    /// The same by the paper's algorithm, literally; for a few hundred leaves
    VdsReference,
    /// Leaf collapse: the two nearest leaves, most in one plane, become one
    Fsa,
    /// Stochastic pruning: a random order, all that are left grow alike
    Stochastic,
    /// The mesh simplifier of meshoptimizer: triangles to the share that is asked for, not leaves
    Meshopt,
    /// Whole branches go, the shortest first; for trees with a skeleton, as `grow` writes them
    Chain,
    /// Sticks and leaf clusters merge from the twigs down; for trees with a skeleton
    Merge,
}

names!(
/// Which alpha cutoffs leaves have.
CutoffsName => CutoffChoice {
    /// Such that clients show as much of the crown from afar as there is, and near by what they did; where
    /// no cutoff does, textures are read without mip maps, or clear texels get an alpha below the cutoff
    Fit,
    /// As fit, but all textures are read with mip maps
    FitWithMips,
    /// Those of the tree, raised only where single triangles would show specks
    Keep,
});

names!(
/// Which colours clear texels of leaf textures have in the result.
ColorsName => ColorChoice {
    /// Those of the leaves near them, where mip maps would mix in others
    Dilate,
    /// Those of the tree
    Keep,
});

names!(
/// What becomes of the wood.
WoodName => WoodMode {
    /// The wood is simplified with the leaves, under one budget of triangles
    Auto,
    /// The wood stays as it was; the leaves get what it leaves of a budget of triangles
    Keep,
    /// The wood stays as it was; a budget of triangles counts the leaves alone
    Ignore,
    /// As auto, and pieces of wood get coarser by collapses that change the views' information least
    Vmi,
    /// As auto, and pieces of wood get coarser by their geometry
    Geometry,
});
names!(
/// What becomes of the wood in a chain.
ChainWoodName => WoodMode {
    /// The wood is simplified with the leaves, by what looks better a triangle, geometry
    Auto,
    /// The wood stays as it was in every level; the leaves get what it leaves of the triangles
    Keep,
    /// Pieces of wood get coarser by collapses that change the views' information least
    Vmi,
    /// Pieces of wood get coarser by their geometry
    Geometry,
});
names!(PresetName => Preset {
    /// Pictures that look like the original: the crown stays as dense as it was
    Look,
    /// The least VMI error, at the price of a crown that gets too dense
    Information,
    /// The paper as it is written: 20 views of 256 x 256, solid leaves, costs against the original,
    /// growth by the cost in bits; options that say otherwise are refused
    Paper,
    /// The same, but a leaf's growth is its cost over the largest cost of the step
    PaperNormalised,
    /// The same, but a neighbour takes over all of the area
    PaperFull,
    /// The same, but a neighbour takes over all of the area only while the views have lost
    /// information
    PaperDeficit,
    /// The same, but no leaf grows
    PaperNone,
});
names!(
/// What a chain for an engine can be for.
ChainPresetName => Preset {
    /// Pictures that look like the original: the crown stays as dense as it was
    Look,
    /// The least VMI error, at the price of a crown that gets too dense
    Information,
});
names!(JudgingViewsName => JudgingViews {
    /// Four sets of 12, none near a view that drives: the mean over the four, and the worst
    HeldOut,
    /// The paper's one set of 12, each 11 degrees from a view that drives
    Icosahedron,
});
names!(CornersName => Corners {
    /// Of the larger leaf the two corners furthest from the other leaf's middle, of the other leaf the
    /// two furthest from those: no slivers
    Spread,
    /// Of each leaf the two corners furthest from the other leaf, as it is published
    Furthest,
});
names!(HausdorffName => Hausdorff {
    /// Between the corners of the two leaves
    Corners,
    /// Between the surfaces of the two leaves
    Surface,
});
names!(MetricName => Metric {
    /// How many branches grow from the branch
    Children,
    /// How many branches grow from the branch, from those, and so on
    Descendants,
    /// The longest way from the branch's start to a tip
    LongestPath,
    /// The length of the branch and of all its descendants
    BranchingLength,
});
names!(EngineName => Engine {
    /// The CPU; most whole commands gain nothing by a GPU
    Auto,
    /// A GPU, software drivers included
    Gpu,
    /// The CPU, with as many threads as `--threads` says
    Cpu,
});
names!(ReferenceName => Reference {
    /// Compare with the original foliage
    Original,
    /// Compare with the foliage before the step
    Previous,
});
names!(ResizeName => Resize {
    /// The cost over the largest cost of the step
    Normalised,
    /// Like `normalised`, scaled so that other numbers of views grow about as much as 20 do
    Steady,
    /// The cost in bits, at most 1
    Literal,
    /// 1: neighbours take over the whole area
    Full,
    /// 1 while the views together have lost information, else 0
    Deficit,
    /// 0: no leaf grows
    None,
});
names!(MeshoptModeName => Mode {
    /// `simplify`, then small parts are dropped
    Prune,
    /// `simplify` alone, which only collapses edges
    Plain,
    /// `simplify_sloppy`, which joins vertices that share a cell of a grid
    Sloppy,
});
names!(ClusterSizeName => ClusterSize {
    /// The paper's radius: the mean distance and the mean radius of the leaves
    Paper,
    /// The radius at which cluster leaves have as much area as the leaves that they stand for
    Area,
});
names!(NeedlesName => Needles { Widen, Scale });
names!(TiesName => Ties { Order, Spread });
names!(SidesName => Sides {
    /// As the material says: clients cull back faces where it is not doubleSided
    Material,
    /// Every leaf is seen from both sides
    Both,
});
names!(AlphaName => Alpha {
    /// What an alpha mask cuts out is not there
    Mask,
    /// Leaves are solid polygons
    Ignore,
});
