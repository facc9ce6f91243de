//! Scripts of engines: a template each, beside this file, and the levels' figures.

use super::{EngineLevels, FADE, identifier, number, quoted};

/// A template with the words that stand for names and figures replaced.
fn filled(template: &str, levels: &EngineLevels, file: &str, figures: &[String]) -> String {
    template
        .replace("@IDENT@", &identifier(&levels.name))
        .replace("@FILE@", &quoted(file))
        .replace("@FOV@", &number(levels.field_of_view_degrees))
        .replace("@LEVELS@", &figures.join("\n"))
}

/// An editor script for Unity: a prefab with a LOD Group, made anew whenever the file is imported.
pub(super) fn unity(levels: &EngineLevels, file: &str) -> String {
    let last = levels.levels.len() - 1;
    let figures = levels.levels.iter().enumerate().map(|(k, level)| {
        let height = if k == last { 0.0 } else { level.coverage };
        format!("        ({}, {}f),", quoted(&level.node), number(height))
    });
    filled(
        include_str!("unity.cs"),
        levels,
        file,
        &figures.collect::<Vec<_>>(),
    )
}

/// A script for Unreal's editor: one static mesh of all files, with screen sizes.
pub(super) fn unreal(levels: &EngineLevels) -> String {
    let mut before = 1.0;
    let figures = levels.levels.iter().enumerate().map(|(k, level)| {
        // The first is drawn however near, and sizes fall.
        let size = match k {
            0 => f64::max(2.0, levels.diameter_over_extent),
            _ => before * levels.diameter_over_extent,
        };
        before = level.coverage;
        let file = format!("{}.glb", level.node);
        format!("    ({}, {}),", quoted(&file), number(size))
    });
    let figures: Vec<String> = figures.collect();
    filled(include_str!("unreal.py"), levels, &levels.name, &figures)
}

/// A plugin for Bevy: a visibility range for each mesh below a level's node.
pub(super) fn bevy(levels: &EngineLevels) -> String {
    let margin = |at: Option<f64>| match at {
        Some(at) if at > 0.0 => format!("{}..{}", number(at), number(at * (1.0 + FADE))),
        Some(_) => "0.0..0.0".to_owned(),
        None => "f32::MAX..f32::MAX".to_owned(),
    };
    let figures = levels.levels.iter().map(|level| {
        let (node, begin) = (quoted(&level.node), margin(Some(level.begin_m)));
        format!("    ({node}, {begin}, {}),", margin(level.end_m))
    });
    filled(
        include_str!("bevy.rs.in"),
        levels,
        "",
        &figures.collect::<Vec<_>>(),
    )
}

/// A module for three.js: a `LOD` of the file.
pub(super) fn three(levels: &EngineLevels, file: &str) -> String {
    filled(
        include_str!("three.js.in"),
        levels,
        file,
        &distances(levels),
    )
}

/// A module for Babylon.js: levels of the finest meshes.
pub(super) fn babylon(levels: &EngineLevels, file: &str) -> String {
    filled(
        include_str!("babylon.js.in"),
        levels,
        file,
        &distances(levels),
    )
}

fn distances(levels: &EngineLevels) -> Vec<String> {
    let of = levels.levels.iter();
    of.map(|level| format!("  [{}, {}],", quoted(&level.node), number(level.begin_m)))
        .collect()
}

/// A script for Blender: a collection for each level, of which the finest is shown.
pub(super) fn blender(levels: &EngineLevels, file: &str) -> String {
    let figures = levels.levels.iter();
    let figures =
        figures.map(|level| format!("    ({}, {}),", quoted(&level.node), number(level.begin_m)));
    // The script imports nothing but what Blender has: what it shares with the extension is put into it.
    let shared = include_str!("blender_import.py");
    let (_, functions) = shared.split_once("import bpy\n").expect("its imports");
    filled(
        &include_str!("blender.py").replace("@IMPORT@", functions.trim()),
        levels,
        file,
        &figures.collect::<Vec<_>>(),
    )
}
