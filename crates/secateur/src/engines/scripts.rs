//! Scripts of engines: a template each, beside this file, and the levels' figures.

use secateur_levels::chain::BlendBand;

use super::{EngineLevels, identifier, number, quoted};

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
    let mut before = 1.0;
    let figures = levels.levels.iter().map(|level| {
        // Unity fades before a level ends, over a share of the heights that it is shown at.
        let end = level
            .blend
            .map_or(0.0, |band| level.coverage * band.end_px / band.begin_px);
        let fade = (level.coverage - end) / f64::max(before - end, f64::MIN_POSITIVE);
        before = end;
        let (node, fade) = (quoted(&level.node), number(fade.clamp(0.0, 1.0)));
        format!("        ({node}, {}f, {fade}f),", number(end))
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
    let margin = |band: Option<BlendBand>, none: &str| {
        let text = |band: BlendBand| format!("{}..{}", number(band.begin), number(band.end));
        band.map_or_else(|| format!("{none}..{none}"), text)
    };
    let mut before = None;
    let figures = levels.levels.iter().map(|level| {
        let (begin, end) = (margin(before, "0.0"), margin(level.blend, "f32::MAX"));
        before = level.blend;
        format!("    ({}, {begin}, {end}),", quoted(&level.node))
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
    let mut before: Option<BlendBand> = None;
    let figures = levels.levels.iter().map(|level| {
        let [begin, hysteresis] = before.map_or([0.0; 2], |band| [band.begin, band.hysteresis]);
        before = level.blend;
        let (node, out) = (quoted(&level.node), number(begin + hysteresis));
        format!("  [{node}, {out}, {}],", number(hysteresis))
    });
    let figures: Vec<String> = figures.collect();
    filled(include_str!("three.js.in"), levels, file, &figures)
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
