//! What a result is for: the values that options begin with.

use serde::{Deserialize, Serialize};

use crate::vds::{Reference, Resize, VdsOptions};

/// What a result is for. Each option can be changed afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Preset {
    /// Pictures that look like the original: costs are measured against the foliage before each
    /// step, a neighbour takes over all of a pruned leaf's area while the views show less
    /// foliage than at first, and at the end sizes are fitted so that each part of the crown is
    /// as dense as it was.
    #[default]
    Look,
    /// The least VMI error, at the price of a crown that gets too dense: costs are measured
    /// against the original, growth is in proportion to cost, and sizes of a budget of triangles
    /// are fitted to outline and information.
    Information,
}

impl Preset {
    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Look => "look",
            Self::Information => "information",
        }
    }

    /// How VDS chooses leaves and lets others grow.
    pub fn vds(self) -> VdsOptions {
        match self {
            Self::Look => VdsOptions {
                reference: Reference::Previous,
                resize: Resize::Full,
                max_coverage: Some(1.0),
                ..VdsOptions::default()
            },
            Self::Information => VdsOptions::default(),
        }
    }
}
