//! Names on the command line for values of the library.

use clap::ValueEnum;
use secateur::{Preset, WoodMode};

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
    /// Viewpoint-driven by the paper's algorithm, literally; for a few hundred leaves
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
/// What becomes of the wood in a chain.
ChainWoodName => WoodMode {
    /// The wood is simplified with the leaves, by what looks better a triangle, geometry
    Auto,
    /// The wood stays as it was in every level; the leaves get what it leaves of the triangles
    Keep,
    /// Pieces of wood get coarser by their geometry
    Geometry,
});
names!(
/// What a chain for an engine can be for.
ChainPresetName => Preset {
    /// Pictures that look like the original: the crown stays as dense as it was
    Look,
    /// The least VMI error, at the price of a crown that gets too dense
    Information,
});
