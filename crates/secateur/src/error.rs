//! What can keep a tree from being simplified or measured, in one sentence each.

use secateur_gltf::GltfError;
use secateur_raster::CamerasError;

/// Why a tree could not be read, simplified, measured or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file can't be read or written.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// The foliage can't be simplified as asked.
    #[error(transparent)]
    Simplify(#[from] secateur_simplify::Error),
    /// A camera file is not what it should be.
    #[error(transparent)]
    Cameras(#[from] CamerasError),
    /// A plant can't be grown.
    #[cfg(feature = "plant")]
    #[error(transparent)]
    Grow(#[from] secateur_plant::GrowError),
    /// No page can be made of levels.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Preview(#[from] secateur_scene::preview::PreviewError),
    /// Nothing can be measured.
    #[cfg(feature = "eval")]
    #[error(transparent)]
    Measure(#[from] secateur_eval::MeasureError),
}
