//! Why there is no chain.

use secateur_gltf::chain::MAX_LEVELS;
use secateur_simplify::Error as SimplifyError;

use super::options::LEAST_PX;

/// Why there is no chain.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The plant can't be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// A level can't be written or drawn.
    #[error(transparent)]
    Gltf(#[from] secateur_gltf::GltfError),
    /// A level can't be judged.
    #[error(transparent)]
    Measure(#[from] secateur_eval::MeasureError),
    /// The options contradict each other, or one is out of range.
    #[error(transparent)]
    Options(#[from] BadOptions),
    /// A distance is inside the crown.
    #[error(
        "a distance of {distance_m} m is inside the plant, which reaches {reach_m:.1} m from its middle: begin at {least_m:.1} m"
    )]
    InsidePlant {
        /// The distance that was asked for.
        distance_m: f64,
        /// How far the plant reaches.
        reach_m: f64,
        /// From which distance on there may be levels.
        least_m: f64,
    },
    /// So few triangles that nothing is left.
    #[error(
        "no leaf and no piece of wood is left with {triangles} of {there} triangles: ask for more"
    )]
    NothingLeft {
        /// Triangles that were asked for.
        triangles: usize,
        /// Triangles of the plant.
        there: usize,
    },
    /// No level of the triangles that were asked for looks near enough at any height.
    #[error(
        "a level of {triangles} triangles differs by more than {max_difference} even {LEAST_PX} pixels high: ask for more triangles, or let levels differ more"
    )]
    NoneWithin {
        /// Triangles of the finest level that was tried.
        triangles: usize,
        /// The largest difference that a level may have.
        max_difference: f64,
    },
    /// The plant is as light as any level would be.
    #[error("no level would have fewer triangles than the tree has")]
    NoLighterLevel,
}

/// What is wrong with what is asked of levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BadOptions {
    /// No level is asked for.
    #[error("a chain needs at least one level")]
    NoLevel,
    /// More levels than engines take.
    #[error("{0} levels were asked for: a chain has at most {MAX_LEVELS}")]
    TooManyLevels(usize),
    /// There are as many levels as engines take already.
    #[error(
        "an impostor after {MAX_LEVELS} levels is one too many: a chain has at most {MAX_LEVELS}"
    )]
    NoRoomForImpostor,
    /// A level without triangles.
    #[error("a level of no triangles shows nothing: ask for more than 0")]
    NoTriangles,
    /// A level is not coarser than the one before.
    #[error("levels go from fine to coarse: each must be less than the one before")]
    NotCoarser,
    /// A distance is not larger than the one before.
    #[error("distances must rise: each level is farther off than the one before")]
    NotFarther,
    /// A number is out of range: which, and what it must be.
    #[error("{0}")]
    OutOfRange(&'static str),
    /// The plant was opened with its wood ignored.
    #[error("levels are of wood and leaves: open the plant without ignoring its wood")]
    WoodIgnored,
}

impl ChainError {
    /// Whether it says only that the plant can't be made as light as was asked for.
    pub(super) fn is_not_so_light(&self) -> bool {
        matches!(
            self,
            Self::Simplify(
                SimplifyError::BudgetNotMet { .. }
                    | SimplifyError::BudgetBelowWood { .. }
                    | SimplifyError::NoLeaf
            ) | Self::NothingLeft { .. }
        )
    }
}
