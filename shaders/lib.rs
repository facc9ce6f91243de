//! The WGSL sources of secateur's GPU stages.
//!
//! A shader has the name of its stage; `secateur-raster` runs them beside a twin in Rust, but for
//! `leaf_sizes`, `morph` and `wind`, which are for renderers: their twins are in `secateur-runtime`. All of them compute
//! with integers only, but for `morph` and the last steps of `wind`.

#![forbid(unsafe_code)]

/// Embeds the named shaders of this folder.
macro_rules! shaders {
    ($($(#[$doc:meta])* $name:ident = $file:literal;)*) => {
        $($(#[$doc])* pub const $name: &str = include_str!($file);)*

        /// Every shader: the name of its file, and its source.
        pub const ALL: &[(&str, &str)] = &[$(($file, $name)),*];
    };
}

shaders! {
    /// Fragments of each pixel to where each pixel's list starts.
    FRAGMENTS_SCAN = "fragments_scan.wgsl";
    /// Puts each pixel's list in order, each leaf once.
    FRAGMENTS_SORT = "fragments_sort.wgsl";
    /// Sorts lists that are too long for one invocation.
    FRAGMENTS_SORT_LONG = "fragments_sort_long.wgsl";
    /// Leaf-ID images to areas.
    HISTOGRAM = "histogram.wgsl";
    /// The front leaf of each pixel, from its list.
    LEAF_IDS = "leaf_ids.wgsl";
    /// The sizes of leaves at a level of a removal order.
    LEAF_SIZES = "leaf_sizes.wgsl";
    /// How a level becomes the next one.
    MORPH = "morph.wgsl";
    /// Counts to a bound that some drivers never reach.
    PROBE = "probe.wgsl";
    /// Snapped triangles to pixels.
    RASTERISE = "rasterise.wgsl";
    /// How leaves and wood sway, by what they hang on.
    WIND = "wind.wgsl";
}

/// [`MORPH`] for WebGL 2 and OpenGL: functions for a vertex shader in GLSL ES 3.00.
pub const MORPH_GLSL: &str = include_str!("morph.glsl");

/// [`MORPH`] for Godot 4: a file that a spatial shader includes.
pub const MORPH_GODOT: &str = include_str!("morph.gdshaderinc");

/// [`WIND`] for WebGL 2 and OpenGL: functions for a vertex shader in GLSL ES 3.00.
pub const WIND_GLSL: &str = include_str!("wind.glsl");

#[cfg(test)]
mod tests {
    use super::ALL;

    #[test]
    fn every_shader_of_the_folder_is_handed_out() {
        let entries = std::fs::read_dir(env!("CARGO_MANIFEST_DIR")).expect("the folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut files: Vec<String> = names
            .map(|name| name.to_string_lossy().into_owned())
            .filter(|name| name.ends_with(".wgsl"))
            .collect();
        files.sort();
        let handed_out: Vec<&str> = ALL.iter().map(|(name, _)| *name).collect();
        assert_eq!(files, handed_out);
    }
}
