//! What an engine needs beside the files of levels, so that they switch without a hand on them.

mod godot;
mod scripts;

use std::path::PathBuf;

use secateur_gltf::chain::Layout;
use secateur_levels::chain::BlendBand;

use crate::Levels;

/// The engine that levels are for: it chooses the layout, and what is written beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum EngineName {
    /// One file, and a scene (.tscn) with visibility ranges that fade
    Godot,
    /// One file, and an editor script that makes a prefab with a LOD Group
    Unity,
    /// A file for each level, and a Python script that makes a static mesh of them
    Unreal,
    /// One file, and a plugin that gives meshes their `VisibilityRange`
    Bevy,
    /// One file, and a module that makes a `LOD` of it
    Three,
    /// One file, and a module that calls `addLODLevel`
    Babylon,
    /// One file, and a Python script that imports it as a collection for each level
    Blender,
    /// A layer of USD whose levels switch by their size on the screen
    Usd,
}

/// A level as engines ask for it.
struct EngineLevel {
    /// The name of its node.
    node: String,
    /// From how far off it is used, in metres.
    begin_m: f64,
    /// Where it blends into the next one; none for the last.
    blend: Option<BlendBand>,
    /// The least share of the screen's height at which it is drawn.
    coverage: f64,
}

/// Levels of a plant as engines ask for them.
struct EngineLevels {
    name: String,
    levels: Vec<EngineLevel>,
    /// The diameter of the bounding sphere over the largest extent.
    diameter_over_extent: f64,
    field_of_view_degrees: f64,
}

impl EngineName {
    /// How levels lie in files.
    pub fn layout(self) -> Layout {
        match self {
            Self::Unreal => Layout::Files,
            Self::Godot
            | Self::Unity
            | Self::Bevy
            | Self::Three
            | Self::Babylon
            | Self::Blender => Layout::Siblings,
            Self::Usd => Layout::Usd,
        }
    }

    /// The file that is written beside levels of this name, relative to their folder; none where they say all.
    pub fn companion(self, name: &str) -> Option<PathBuf> {
        let ident = identifier(name);
        let file = match self {
            Self::Usd => return None,
            Self::Godot => format!("{name}.tscn"),
            Self::Unity => format!("Editor/{ident}Lods.cs"),
            Self::Unreal => format!("{ident}_unreal.py"),
            Self::Bevy => format!("{ident}_lods.rs"),
            Self::Three => format!("{name}.three.js"),
            Self::Babylon => format!("{name}.babylon.js"),
            Self::Blender => format!("{ident}_blender.py"),
        };
        Some(file.into())
    }

    fn text(self, levels: &EngineLevels, file: &str) -> Option<String> {
        Some(match self {
            Self::Usd => return None,
            Self::Godot => godot::scene(levels, file),
            Self::Unity => scripts::unity(levels, file),
            Self::Unreal => scripts::unreal(levels),
            Self::Bevy => scripts::bevy(levels),
            Self::Three => scripts::three(levels, file),
            Self::Babylon => scripts::babylon(levels, file),
            Self::Blender => scripts::blender(levels, file),
        })
    }
}

impl Levels {
    /// What the [companion](EngineName::companion) of the levels says to an engine, where they are in a file of the name
    /// `file`, such as `oak.glb`; none where there is no companion.
    pub fn engine_file(&self, engine: EngineName, file: &str) -> Option<String> {
        engine.text(&EngineLevels::of(self), file)
    }
}

impl EngineLevels {
    fn of(levels: &Levels) -> Self {
        let reports: Vec<_> = levels.chain.levels.iter().map(|l| &l.report).collect();
        let of = |k: usize| EngineLevel {
            node: levels.node(k),
            begin_m: reports[k].distance,
            blend: reports[k].blend,
            coverage: reports[k].screen_coverage,
        };
        Self {
            name: levels.name().to_owned(),
            levels: (0..reports.len()).map(of).collect(),
            diameter_over_extent: diameter_over_extent(levels),
            field_of_view_degrees: levels.screen.field_of_view_degrees,
        }
    }
}

/// The diagonal of the plant's box over its largest side; 1 where it has none.
fn diameter_over_extent(levels: &Levels) -> f64 {
    let Some([low, high]) = levels.plant().inspection().extents else {
        return 1.0;
    };
    let sides: [f64; 3] = std::array::from_fn(|k| high[k] - low[k]);
    let largest = sides.into_iter().fold(0.0, f64::max);
    let diagonal = sides.iter().map(|side| side * side).sum::<f64>().sqrt();
    if largest > 0.0 {
        diagonal / largest
    } else {
        1.0
    }
}

/// A name that programming languages take.
fn identifier(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let text: String = name
        .chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .collect();
    match text.starts_with(|c: char| c.is_ascii_digit()) || text.is_empty() {
        true => format!("_{text}"),
        false => text,
    }
}

/// A text as a literal that JSON, JavaScript, Python, C# and Rust read alike. Names in files are not to be trusted.
fn quoted(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    serde_json::to_string(&plain).expect("a text")
}

/// A number with a point, as all of them read it.
fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0');
    match text.ends_with('.') {
        true => format!("{text}0"),
        false => text.to_owned(),
    }
}
