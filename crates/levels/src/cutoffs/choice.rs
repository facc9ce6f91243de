//! The choice between the tree's alpha cutoffs and some that are chosen for a level.

use secateur_simplify::Options;
use serde::{Deserialize, Serialize};

use super::MaterialChange;

/// Which alpha cutoffs a level has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum CutoffChoice {
    /// [`Self::Fit`] where [`Options::chooses_cutoffs`], else [`Self::Keep`].
    #[default]
    #[cfg_attr(feature = "cli", value(skip))]
    Auto,
    /// Such that clients show as much of the crown from afar as there is, and near by what they did; where no
    /// cutoff does, textures are read without mip maps, or clear texels get an alpha below the cutoff.
    Fit,
    /// As fit, but all textures are read with mip maps.
    FitWithMips,
    /// Cutoffs stay as the tree has them, raised only where single triangles would show specks.
    Keep,
}

impl CutoffChoice {
    /// What may be done to the cutoffs of a level that is made with these options; none where they stay.
    pub fn change(self, options: &Options) -> Option<MaterialChange> {
        match self {
            Self::Keep => None,
            Self::Auto if !options.chooses_cutoffs() => None,
            Self::FitWithMips => Some(MaterialChange::Cutoffs),
            Self::Auto | Self::Fit => Some(MaterialChange::CutoffsOrMips),
        }
    }
}
