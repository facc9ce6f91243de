//! How levels lie in files, by name, and by where they go.

use std::path::Path;
use std::str::FromStr;

use crate::file_kind::{has_extension, is_gltf_name};

/// How the levels of a chain lie in files. Engines exclude each other here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// A file for each level, as Unreal imports them: NAME_LOD0.glb, NAME_LOD1.glb, ...
    Files,
    /// One file with a node for each level under one parent, as Godot, Unity, Bevy, Blender and web viewers load it.
    Siblings,
    /// One file with the extension MSFT_lod, as UnityGLTF and glTFRuntime read it, and Babylon.js while it loads.
    ///
    /// The finest level is in the scene and names the others, which are not.
    Msft,
    /// A USD layer (.usda) with LODRootAPI, and its textures in a folder beside it.
    Usd,
}

/// A layout that there is not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the layout `{0}` is none of files, siblings, msft, usd")]
pub struct UnknownLayout(pub String);

impl FromStr for Layout {
    type Err = UnknownLayout;

    fn from_str(name: &str) -> Result<Self, UnknownLayout> {
        match name {
            "files" => Ok(Self::Files),
            "siblings" => Ok(Self::Siblings),
            "msft" => Ok(Self::Msft),
            "usd" => Ok(Self::Usd),
            other => Err(UnknownLayout(other.to_owned())),
        }
    }
}

impl Layout {
    /// The layout of levels that go to this place, where none was asked for: into a file what its name says, else files
    /// in a folder.
    pub fn of_place(path: &Path) -> Self {
        match (is_gltf_name(path), has_extension(path, &["usda"])) {
            (true, _) => Self::Siblings,
            (false, true) => Self::Usd,
            (false, false) => Self::Files,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_known_by_their_names() {
        for layout in [Layout::Files, Layout::Siblings, Layout::Msft, Layout::Usd] {
            let name = serde_json::to_value(layout).unwrap();
            assert_eq!(name.as_str().unwrap().parse(), Ok(layout));
        }
        let wrong = "file".parse::<Layout>().unwrap_err().to_string();
        assert_eq!(
            wrong,
            "the layout `file` is none of files, siblings, msft, usd"
        );
    }

    #[test]
    fn places_say_how_levels_lie() {
        let of = |place: &str| Layout::of_place(Path::new(place));
        assert_eq!(of("oak.GLB"), Layout::Siblings);
        assert_eq!(of("oak.gltf"), Layout::Siblings);
        assert_eq!(of("oak.usda"), Layout::Usd);
        assert_eq!(of("oak"), Layout::Files);
    }
}
