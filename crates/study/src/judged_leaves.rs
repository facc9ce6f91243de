//! As what leaves are judged: as the file has them, or as the paper's are.

use std::borrow::Cow;

use secateur_model::Foliage;
use secateur_simplify::{Alpha, Sides, as_seen};
use serde::{Deserialize, Serialize};

/// As what the leaves of a tree and of its levels are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JudgedLeaves {
    /// With the alpha cut-outs and the sides of the file.
    #[default]
    AsInFile,
    /// As whole polygons that are seen from both sides, as the leaves of the paper are.
    Solid,
}

impl JudgedLeaves {
    /// The foliage that is counted.
    pub(crate) fn of(self, foliage: &Foliage) -> Cow<'_, Foliage> {
        match self {
            Self::AsInFile => Cow::Borrowed(foliage),
            Self::Solid => as_seen(foliage, Alpha::Ignore, Sides::Both),
        }
    }

    /// As rows spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsInFile => "as-in-file",
            Self::Solid => "solid",
        }
    }
}
