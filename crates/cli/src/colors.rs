//! Colours of clear texels in a result, and what is said of them.

use schemars::JsonSchema;
use secateur_levels::Dilated;
use serde::Serialize;

/// A texture with other colours in its clear texels.
#[derive(Serialize, JsonSchema)]
pub(crate) struct ColorRecord {
    /// The number of the material that shows it.
    material: usize,
    /// By how much mip maps of an eighth of the size differ by it, in the mean over what they show, of 255.
    difference: f64,
}

impl From<&Dilated> for ColorRecord {
    fn from(one: &Dilated) -> Self {
        Self {
            material: one.material,
            difference: one.difference,
        }
    }
}

/// A line of the summary.
pub(crate) fn in_words(chosen: &[Dilated]) -> String {
    let most = chosen.iter().map(|one| one.difference).fold(0.0, f64::max);
    let textures = match chosen.len() {
        1 => "the texture of a material has".to_owned(),
        count => format!("the textures of {count} materials have"),
    };
    format!(
        "{textures} the colours of leaves in clear texels; others, mixed in by mip maps, moved them by {most:.0} of 255"
    )
}
