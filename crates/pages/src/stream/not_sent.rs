//! What of a tree a stream leaves behind.

use std::collections::BTreeSet;

use serde_json::Value;

/// What a stream has of a vertex beside what is drawn.
const WIND: [&str; 3] = ["_WIND_PIVOT", "_WIND_ALONG", "_WIND_SEGMENT"];

/// What a file of this JSON has and its stream has not, by the names that the file format has for it: skins, morph
/// targets, animations, and attributes that are for programs to read or for a second colour.
pub fn not_sent(root: &Value) -> Vec<String> {
    let items = |of: &'static str| root[of].as_array().into_iter().flatten();
    let primitives = || items("meshes").flat_map(|mesh| mesh["primitives"].as_array());
    let mut names = Vec::new();
    if items("skins").next().is_some() {
        names.push("skins".to_owned());
    }
    let has_targets = |primitive: &Value| primitive["targets"].as_array().is_some();
    if primitives().flatten().any(has_targets) {
        names.push("morph targets".to_owned());
    }
    if items("animations").next().is_some() {
        names.push("animations".to_owned());
    }
    let attributes: BTreeSet<&str> = primitives()
        .flatten()
        .filter_map(|primitive| primitive["attributes"].as_object())
        .flat_map(|attributes| attributes.keys())
        .map(String::as_str)
        .filter(|name| is_other(name) && !WIND.contains(name))
        .collect();
    names.extend(attributes.into_iter().map(str::to_owned));
    names
}

fn is_other(name: &str) -> bool {
    name.starts_with('_') || name.starts_with("COLOR_") && name != "COLOR_0"
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::not_sent;

    #[test]
    fn what_moves_a_plant_is_named_but_for_the_wind() {
        let wind = json!({"POSITION": 0, "COLOR_0": 1, "_WIND_PIVOT": 2, "_WIND_ALONG": 3});
        let plain = json!({"meshes": [{"primitives": [{"attributes": wind}]}], "skins": []});
        assert_eq!(not_sent(&plain), [""; 0]);
        let other = json!({"POSITION": 0, "JOINTS_0": 1, "COLOR_1": 2, "_SWAY": 3});
        let rich = json!({
            "meshes": [{"primitives": [{"attributes": other, "targets": [{}]}]}],
            "skins": [{}],
            "animations": [{}],
        });
        let expected = ["skins", "morph targets", "animations", "COLOR_1", "_SWAY"];
        assert_eq!(not_sent(&rich), expected);
        assert_eq!(not_sent(&json!({})), [""; 0]);
    }
}
