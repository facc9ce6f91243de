//! What can keep a plant from being made lighter, judged or shown, in one sentence each.

use std::error::Error as _;

use secateur_gltf::GltfError;
#[cfg(feature = "scene")]
use secateur_levels::chain::{BadOptions, ChainError};
use secateur_model::OverMemory;
use secateur_raster::CamerasError;

/// Why a plant could not be read, simplified, judged or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file can't be read or written.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// The plant can't be simplified as asked.
    #[error(transparent)]
    Simplify(#[from] secateur_simplify::Error),
    /// A camera file is not what it should be.
    #[error(transparent)]
    Cameras(#[from] CamerasError),
    /// A plant can't be grown.
    #[cfg(feature = "plant")]
    #[error(transparent)]
    Grow(#[from] secateur_plant::GrowError),
    /// Threads of a session can't be started.
    #[error("threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// There are no levels such as were asked for.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Levels(ChainError),
    /// A stand can't be read.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Stand(#[from] crate::stand::StandError),
    /// Parts that have a level of their own can't be brought to it.
    #[cfg(feature = "scene")]
    #[error("the level of {parts}: {source}")]
    Part {
        /// What names the parts.
        parts: secateur_gltf::Selector,
        /// Why not.
        source: secateur_simplify::Error,
    },
    /// No page can be made of levels.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Preview(#[from] secateur_pages::preview::PreviewError),
    /// Nothing can be measured.
    #[cfg(feature = "eval")]
    #[error(transparent)]
    Measure(#[from] secateur_eval::MeasureError),
}

impl Error {
    /// What would take more memory than is allowed, where that is why.
    pub fn over_memory(&self) -> Option<&OverMemory> {
        let mut cause = self.source();
        while let Some(error) = cause {
            if let Some(over) = error.downcast_ref() {
                return Some(over);
            }
            cause = error.source();
        }
        None
    }

    /// Whether an observer broke it off.
    pub fn is_stopped(&self) -> bool {
        match self {
            Self::Simplify(error) => matches!(error, secateur_simplify::Error::Stopped),
            #[cfg(feature = "scene")]
            Self::Part { source, .. } => matches!(source, secateur_simplify::Error::Stopped),
            _ => false,
        }
    }
}

/// What keeps one level from being made is the same error for several.
#[cfg(feature = "scene")]
impl From<ChainError> for Error {
    fn from(error: ChainError) -> Self {
        match error {
            ChainError::Simplify(error) => Self::Simplify(error),
            ChainError::Gltf(error) => Self::Gltf(error),
            ChainError::Measure(error) => Self::Measure(error),
            other => Self::Levels(other),
        }
    }
}

#[cfg(feature = "scene")]
impl From<BadOptions> for Error {
    fn from(error: BadOptions) -> Self {
        Self::Levels(error.into())
    }
}
