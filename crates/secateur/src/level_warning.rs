//! What has to be said of a level.

use std::fmt;

use secateur_eval::Difference;
use secateur_simplify::Warning;

/// What has to be said of a level. Prints as a sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum LevelWarning {
    /// What the run over the leaves warns of.
    Run(Warning),
    /// Cutoffs stay as they are, since the level can't be drawn: why.
    CutoffsStay(String),
    /// Textures stay as they are, since one can't be read: why.
    TexturesStay(String),
    /// Other colours were asked for, and no texture gets any.
    NoOtherColors,
    /// The level is another plant: its difference.
    AnotherPlant(f64),
    /// Whether it looks like the plant is not known: why.
    LookUnknown(String),
}

impl LevelWarning {
    /// What has to be said of a level with this difference; none where it is the plant still.
    pub fn of_difference(difference: f64) -> Option<Self> {
        (difference > Difference::ANOTHER_PLANT).then_some(Self::AnotherPlant(difference))
    }

    /// Whether it is about how the level looks.
    pub fn is_of_look(&self) -> bool {
        match self {
            Self::AnotherPlant(_) | Self::LookUnknown(_) => true,
            Self::Run(_) | Self::CutoffsStay(_) | Self::TexturesStay(_) | Self::NoOtherColors => {
                false
            }
        }
    }
}

impl fmt::Display for LevelWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run(warning) => warning.fmt(f),
            Self::CutoffsStay(why) => write!(
                f,
                "alpha cutoffs stay as they are, since the result can't be drawn: {why}"
            ),
            Self::TexturesStay(why) => write!(f, "leaf textures stay as they are: {why}"),
            Self::NoOtherColors => f.write_str(
                "no texture gets other colours: mip maps of leaf textures that are cut out, if there are any, mix in hardly any",
            ),
            Self::AnotherPlant(difference) => write!(
                f,
                "the result looks like another plant: its difference is {difference:.2}, where above {} it is coarser than for backgrounds",
                Difference::ANOTHER_PLANT
            ),
            Self::LookUnknown(why) => {
                write!(f, "whether the result looks like the plant is not known: {why}")
            }
        }
    }
}
