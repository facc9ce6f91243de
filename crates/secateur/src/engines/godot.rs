//! A Godot 4 scene: the levels' file, with a visibility range at each level.

use std::fmt::Write as _;

use secateur_levels::chain::BlendBand;

use super::{EngineLevels, number, quoted};

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
    let mut before = None;
    for (k, level) in levels.levels.iter().enumerate() {
        let parent = quoted(&node_name(&levels.name));
        let node = quoted(&node_name(&level.node));
        let _ = write!(text, "\n[node name={node} parent={parent} index=\"{k}\"]\n");
        for (side, band) in [("begin", before), ("end", level.blend)] {
            // Godot fades as far before a range's end as behind it.
            if let Some([at, margin]) = band.map(|band: BlendBand| band.middle_and_margin()) {
                let (at, margin) = (number(at), number(margin));
                let _ = write!(
                    text,
                    "visibility_range_{side} = {at}\nvisibility_range_{side}_margin = {margin}\n",
                );
            }
        }
        before = level.blend;
        let _ = writeln!(text, "visibility_range_fade_mode = {FADE_SELF}");
    }
    text
}

/// A node's name as Godot's importer has it: without what paths of nodes are made of.
fn node_name(name: &str) -> String {
    name.replace(['.', ':', '@', '/', '"', '%'], "_")
}
