//! What has to be said of a level, in sentences.

use secateur::LevelWarning;

/// The sentence of a warning.
pub(crate) fn sentence(warning: &LevelWarning) -> String {
    match warning {
        LevelWarning::Run(warning) => warning.to_string(),
        LevelWarning::CutoffsStay(why) => {
            format!("alpha cutoffs stay as they are, since the level can't be drawn: {why}")
        }
        LevelWarning::TexturesStay(why) => format!("leaf textures stay as they are: {why}"),
        LevelWarning::NoOtherColors => "no texture gets other colours".to_owned(),
        LevelWarning::AnotherPlant(difference) => format!(
            "this looks like another plant (difference {difference:.2}): ask for more triangles"
        ),
        LevelWarning::LookUnknown(why) => {
            format!("whether it looks like the plant is not known: {why}")
        }
    }
}
