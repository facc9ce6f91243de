//! What becomes of the wood of a plant.

use serde::{Deserialize, Serialize};

/// What becomes of the wood while leaves are simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum WoodMode {
    /// Wood is simplified too, by whichever of [`Self::Geometry`] and [`Self::Vmi`] looks better a
    /// triangle: see [`Self::decided`].
    Auto,
    /// Wood stays as it was: [`simplify_keeping_wood`](super::simplify_keeping_wood).
    Keep,
    /// Wood is not looked at: triangles count the leaves alone, as in
    /// [`simplify`](crate::simplify()).
    Ignore,
    /// Wood is simplified too; pieces get coarser by half-edge collapses that change the mutual
    /// information of views least: [`Wood::by_information`](crate::wood::Wood::by_information).
    Vmi,
    /// Wood is simplified too; pieces get coarser by meshoptimizer, by their geometry: [`Wood::by_geometry`](crate::wood::Wood::by_geometry).
    Geometry,
}

impl WoodMode {
    /// What runs: [`Self::Geometry`] for [`Self::Auto`]: of as many triangles it looks as good or better, and
    /// is found sooner.
    pub fn decided(self) -> Self {
        match self {
            Self::Auto => Self::Geometry,
            said => said,
        }
    }
}
