//! What becomes of the wood of a plant.

use serde::{Deserialize, Serialize};

/// What becomes of the wood while leaves are simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum WoodMode {
    /// The wood is simplified with the leaves, under one budget of triangles.
    Auto,
    /// The wood stays as it was; the leaves get what it leaves of a budget of triangles.
    ///
    /// Wood stays as it was: [`simplify_keeping_wood`](super::simplify_keeping_wood).
    Keep,
    /// The wood stays as it was; a budget of triangles counts the leaves alone.
    ///
    /// Wood is not looked at: triangles count the leaves alone, as in
    /// [`simplify`](crate::simplify()).
    Ignore,
    /// As auto does now: pieces of wood get coarser by their geometry.
    ///
    /// Wood is simplified too; pieces get coarser by meshoptimizer, by their geometry: [`Wood::by_geometry`](crate::wood::Wood::by_geometry).
    Geometry,
}

impl WoodMode {
    /// What runs: [`Self::Geometry`] for [`Self::Auto`].
    pub fn decided(self) -> Self {
        match self {
            Self::Auto => Self::Geometry,
            said => said,
        }
    }
}
