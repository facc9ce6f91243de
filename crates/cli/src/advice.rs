//! The library's options as the command line calls them.

use secateur::{LevelWarning, NamedOption, Note, Simplified, Warning};

fn flag(option: NamedOption) -> String {
    match option {
        NamedOption::Foliage => "--foliage".to_owned(),
        NamedOption::KeepVertexAlpha => "--vertex-alpha keep".to_owned(),
        NamedOption::MaxDifference(Some(value)) => format!("--max-difference {value}"),
        NamedOption::MaxDifference(None) => "--max-difference".to_owned(),
        NamedOption::Impostor => "--impostor".to_owned(),
        NamedOption::ImpostorTextures => "--impostor-textures".to_owned(),
        NamedOption::PlantHeight => "--plant-height M".to_owned(),
        NamedOption::AsOne => "--as-one".to_owned(),
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

/// What has to be said of a level, with the flag that helps where there is one.
pub(crate) fn of_level(warning: &LevelWarning) -> String {
    match warning {
        LevelWarning::Run(warning) => of_run(warning),
        LevelWarning::NoOtherColors => "--colors dilate changes no texture: mip maps of leaf textures that are cut out, if there are any, mix in hardly any other colours".to_owned(),
        LevelWarning::CutoffsStay(_)
        | LevelWarning::TexturesStay(_)
        | LevelWarning::AnotherPlant(_)
        | LevelWarning::LookUnknown(_) => warning.to_string(),
    }
}

fn of_run(warning: &Warning) -> String {
    match warning {
        Warning::FitCostsInformation { .. } => format!("{warning} (`--fit=none`)"),
        _ => warning.to_string(),
    }
}

/// The warnings of a run.
pub(crate) fn of_all_of_run(result: &Simplified) -> Vec<String> {
    result.warnings.iter().map(of_run).collect()
}

/// Says these on standard error.
pub(crate) fn warn_all(warnings: &[String]) {
    for warning in warnings {
        tracing::warn!("{warning}");
    }
}
