//! Colours of clear texels in a result, and what is said of them.

use secateur::{Lod, Options, Tree};
use secateur_scene::{Dilated, dilated_textures};
use serde_json::{Value, json};

use super::names::ColorsName;
use super::{args, cutoffs};

/// What is said to whoever asked for other colours where no texture gets any.
const IN_VAIN: &str = "--colors dilate changes no texture: mip maps of leaf textures that are cut out, if there are any, mix in hardly any other colours";

/// The leaf textures of a level with other colours where they are clear; none of a level that is the tree. Where an
/// image can't be read all keep theirs, with a warning.
pub(crate) fn chosen(
    tree: &Tree,
    lod: &Lod,
    options: &Options,
    args: &args::Simplify,
    warnings: &mut Vec<String>,
) -> Vec<Dilated> {
    let is_wanted = match args.colors {
        Some(name) => name == ColorsName::Dilate,
        None => cutoffs::change(options, args).is_some(),
    };
    if !is_wanted || *lod == Lod::original(tree.foliage().leaves().len()) {
        return Vec::new();
    }
    let (dilated, warning) = match dilated_textures(tree) {
        Ok(dilated) => {
            let is_in_vain = dilated.is_empty() && args.colors == Some(ColorsName::Dilate);
            (dilated, is_in_vain.then(|| IN_VAIN.to_owned()))
        }
        Err(error) => (
            Vec::new(),
            Some(format!("leaf textures stay as they are: {error}")),
        ),
    };
    if let Some(warning) = warning {
        tracing::warn!("{warning}");
        warnings.push(warning);
    }
    dilated
}

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
