//! A Godot 4 scene: the levels' file, with a visibility range at each level.

use std::fmt::Write as _;

use super::{EngineLevels, FADE, number, quoted};

/// Fades this level itself, not what depends on it (`GeometryInstance3D.visibility_range_fade_mode`).
const FADE_SELF: u32 = 1;

/// The scene, which lies beside the file.
pub(super) fn scene(levels: &EngineLevels, file: &str) -> String {
    let mut text = format!(
        "[gd_scene load_steps=2 format=3]\n\n\
         [ext_resource type=\"PackedScene\" path={} id=\"1\"]\n\n\
         [node name={} instance=ExtResource(\"1\")]\n",
        quoted(file),
        quoted(&format!("{}_lods", levels.name)),
    );
    for (k, level) in levels.levels.iter().enumerate() {
        let parent = quoted(&node_name(&levels.name));
        let node = quoted(&node_name(&level.node));
        let _ = write!(text, "\n[node name={node} parent={parent} index=\"{k}\"]\n");
        if level.begin_m > 0.0 {
            let _ = write!(
                text,
                "visibility_range_begin = {}\nvisibility_range_begin_margin = {}\n",
                number(level.begin_m),
                number(FADE * level.begin_m)
            );
        }
        if let Some(end_m) = level.end_m {
            let _ = write!(
                text,
                "visibility_range_end = {}\nvisibility_range_end_margin = {}\n",
                number(end_m),
                number(FADE * end_m)
            );
        }
        let _ = writeln!(text, "visibility_range_fade_mode = {FADE_SELF}");
    }
    text
}

/// A node's name as Godot's importer has it: without what paths of nodes are made of.
fn node_name(name: &str) -> String {
    name.replace(['.', ':', '@', '/', '"', '%'], "_")
}
