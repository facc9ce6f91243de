//! Helper nodes: what names say of nodes that engines read and do not show.
//!
//! Godot reads suffixes (`Tree-colonly`), Unreal Engine prefixes (`UCX_Tree_01`).

use super::roles::NotPlant;

/// A suffix of Godot's, what it makes of a node, and whether the node is drawn too.
const SUFFIXES: [(&str, NotPlant, bool); 8] = [
    ("-colonly", NotPlant::Collision, false),
    ("-convcolonly", NotPlant::Collision, false),
    ("-navmesh", NotPlant::Navigation, false),
    ("-occonly", NotPlant::Occlusion, false),
    ("-noimp", NotPlant::NotImported, false),
    ("-col", NotPlant::Collision, true),
    ("-convcol", NotPlant::Collision, true),
    ("-occ", NotPlant::Occlusion, true),
];

/// Prefixes of Unreal Engine's collision shapes.
const PREFIXES: [&str; 4] = ["UCX_", "UBX_", "USP_", "UCP_"];

/// What the name of a helper node says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Helper<'a> {
    pub(crate) kind: NotPlant,
    /// The name of what it helps, where its engine draws the helper too: `Trunk` of `Trunk-col`.
    pub(crate) drawn_as: Option<&'a str>,
}

/// What a name says of its node, `None` where it is no helper's. Numbers behind the name, as exporters add
/// them, say nothing: `Tree-colonly.001`, `Tree-colonly2`.
pub(crate) fn read(name: &str) -> Option<Helper<'_>> {
    if PREFIXES.iter().any(|prefix| name.starts_with(prefix)) {
        return Some(Helper {
            kind: NotPlant::Collision,
            drawn_as: None,
        });
    }
    let bare = without_numbers(name);
    SUFFIXES.iter().find_map(|&(suffix, kind, is_drawn)| {
        let stem = bare.strip_suffix(suffix)?;
        Some(Helper {
            kind,
            drawn_as: is_drawn.then_some(stem),
        })
    })
}

/// A name without the numbers behind it and what parts them from it.
fn without_numbers(name: &str) -> &str {
    let mut bare = name;
    loop {
        let shorter = bare.trim_end_matches(|c: char| c.is_ascii_digit());
        if shorter.len() == bare.len() {
            return bare;
        }
        bare = shorter
            .strip_suffix(['.', '_', '-', ' '])
            .unwrap_or(shorter);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn helpers_are_known_by_prefix_or_suffix_and_nobody_else() {
        let kind = |name| read(name).map(|helper| helper.kind);
        for (name, expected) in [
            ("Tree-colonly", Some(NotPlant::Collision)),
            ("Tree-colonly2", Some(NotPlant::Collision)),
            ("Tree-convcolonly.001", Some(NotPlant::Collision)),
            ("Tree-convcol_1.002", Some(NotPlant::Collision)),
            ("-col", Some(NotPlant::Collision)),
            ("UCX_Oak_01", Some(NotPlant::Collision)),
            ("UBX_Oak", Some(NotPlant::Collision)),
            ("USP_Oak", Some(NotPlant::Collision)),
            ("UCP_Oak", Some(NotPlant::Collision)),
            ("Ground-navmesh", Some(NotPlant::Navigation)),
            ("Tree-occ3", Some(NotPlant::Occlusion)),
            ("Tree-occonly", Some(NotPlant::Occlusion)),
            ("Sketch-noimp", Some(NotPlant::NotImported)),
            // Case is as engines write it, and what only holds such a word is no helper.
            ("Tree-COLONLY", None),
            ("Tree-collar", None),
            ("-colonly-tree", None),
            ("Oak_UCX_01", None),
            ("ucx_Oak", None),
            ("Protocol", None),
            ("2", None),
            ("", None),
        ] {
            assert_eq!(kind(name), expected, "{name}");
        }
    }

    #[test]
    fn what_is_drawn_too_names_what_it_helps() {
        let drawn_as = |name| read(name).unwrap().drawn_as;
        assert_eq!(drawn_as("Trunk-col.001"), Some("Trunk"));
        assert_eq!(drawn_as("Trunk-colonly"), None);
    }
}
