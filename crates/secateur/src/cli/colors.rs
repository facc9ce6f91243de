//! Colours of clear texels in a result, and what is said of them.

use secateur_scene::Dilated;
use serde_json::{Value, json};

/// What the record says of them; nothing where all stay.
pub(crate) fn record(chosen: &[Dilated]) -> Value {
    let one = |one: &Dilated| json!({"material": one.material, "difference": one.difference});
    match chosen {
        [] => Value::Null,
        _ => chosen.iter().map(one).collect(),
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
