//! Why there is no chain.

use secateur_simplify::Error as SimplifyError;

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
    /// The levels that are asked for are none, too many or in no order.
    #[error("{0}")]
    Wanted(String),
}
