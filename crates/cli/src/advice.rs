//! The library's options as the command line calls them.

use secateur::{NamedOption, Note};

fn flag(option: NamedOption) -> String {
    match option {
        NamedOption::Foliage => "--foliage".to_owned(),
        NamedOption::KeepVertexAlpha => "--vertex-alpha keep".to_owned(),
        NamedOption::MaxDifference(Some(value)) => format!("--max-difference {value}"),
        NamedOption::MaxDifference(None) => "--max-difference".to_owned(),
        NamedOption::Impostor => "--impostor".to_owned(),
        NamedOption::ImpostorTextures => "--impostor-textures".to_owned(),
        NamedOption::PlantHeight => "--plant-height M".to_owned(),
    }
}

/// Notes with the flags of the options that they speak of.
pub(crate) fn with_flags(notes: &[Note]) -> Vec<Note> {
    notes.iter().map(|note| note.calling(flag)).collect()
}

/// As [`with_flags`], as sentences.
pub(crate) fn sentences(notes: &[Note]) -> Vec<String> {
    let notes = with_flags(notes);
    notes.iter().map(Note::to_string).collect()
}
