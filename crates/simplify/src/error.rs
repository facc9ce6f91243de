//! What can keep a run from its end, in one sentence each.

use secateur_model::{FoliageError, OverMemory, SkeletonError};
use secateur_raster::RasterError;

use crate::vds::VdsError;

/// Why a foliage could not be simplified.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The foliage has no leaf.
    #[error("there is no leaf to simplify")]
    NoLeaf,
    /// The foliage is so large, so small or so far away that cameras around it
    /// cannot be computed.
    #[error(
        "the foliage is out of range: a sphere of radius {radius:.1e}, {distance:.1e} from the origin; scale it to a size between 1e-30 and 1e30 and move it nearer than 1e9 times its size"
    )]
    OutOfRange {
        /// Radius of its bounding sphere in world units.
        radius: f64,
        /// Distance of that sphere's centre from the origin.
        distance: f64,
    },
    /// The target is no number of leaves, share or error.
    #[error("the target of {0} must be {1}")]
    Target(String, &'static str),
    /// The wood stays as it is, and alone has more triangles than the plant may keep.
    #[error(
        "{asked} triangles were asked for and the wood alone has {least}, which stay: ask for {least} or more, or have the wood simplified too"
    )]
    BudgetBelowWood {
        /// Triangles that the plant may keep.
        asked: usize,
        /// Triangles of the wood.
        least: usize,
    },
    /// The plant cannot be brought to a number of triangles.
    #[error(
        "{asked} of {there} triangles were asked for, and {nearest} is the {} that is possible: ask for {nearest}",
        if nearest > asked { "least" } else { "most" }
    )]
    BudgetNotMet {
        /// Triangles that the plant may keep.
        asked: usize,
        /// The number that it comes to.
        nearest: usize,
        /// Triangles of the plant as it is.
        there: usize,
    },
    /// What hides leaves hides all, or the views look elsewhere.
    #[error(
        "no leaf is seen in any of the {views} views: all are hidden, or out of sight; move what stands before them, or the cameras"
    )]
    NothingSeen {
        /// The number of views that were looked from.
        views: usize,
    },
    /// Leaves and what hides them are together too many.
    #[error(transparent)]
    Foliage(#[from] FoliageError),
    /// A method that follows branches, and a plant whose branches are not known.
    #[error("the method {method} needs a tree with a skeleton, which this one has not")]
    NoSkeleton {
        /// The name of the method.
        method: &'static str,
    },
    /// The skeleton is none, or one of another foliage.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// The skeleton is too deep for methods that follow branches.
    #[cfg(feature = "plant")]
    #[error(transparent)]
    TooDeep(#[from] secateur_plant::TooDeep),
    /// A weight is out of range.
    #[error("{0} must be a number {1}")]
    Setting(String, &'static str),
    /// The run takes more memory than is allowed.
    #[error("{0}")]
    Memory(#[from] OverMemory),
    /// VDS could not be run.
    #[error(transparent)]
    Vds(VdsError),
    /// The GPU that was asked for is missing or failed.
    #[error("{0}")]
    Gpu(#[source] RasterError),
    /// The caller asked to stop.
    #[error("stopped; nothing was written")]
    Stopped,
    /// The final areas are not those that drawing the foliage anew gives.
    #[error(
        "the result does not pass its audit ({0}): this is a mistake in secateur; please report it with the tree and the command"
    )]
    Audit(String),
}

/// What takes too much memory is no matter of the GPU.
impl From<RasterError> for Error {
    fn from(error: RasterError) -> Self {
        match error.downcast::<OverMemory>() {
            Ok(over) => Self::Memory(*over),
            Err(other) => Self::Gpu(other),
        }
    }
}

impl From<VdsError> for Error {
    fn from(error: VdsError) -> Self {
        match error {
            VdsError::Cancelled => Self::Stopped,
            VdsError::Raster(reason) => Self::Gpu(reason),
            VdsError::Memory(over) => Self::Memory(over),
            other => Self::Vds(other),
        }
    }
}
