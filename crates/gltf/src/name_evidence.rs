//! What a name says: leaf, wood, or nothing.

/// Parts of words that speak of leaves, in the languages of common exporters.
const LEAF_PARTS: [&str; 20] = [
    "blaett",
    "blatt",
    "blossom",
    "blätt",
    "feuill",
    "flower",
    "fogli",
    "foliage",
    "folha",
    "frond",
    "hoja",
    "laub",
    "leaf",
    "leav",
    "listva",
    "nadel",
    "needle",
    "petal",
    "листв",
    "葉",
];

/// Parts of words that speak of wood.
const WOOD_PARTS: [&str; 15] = [
    "bark", "branch", "corteza", "ecorce", "holz", "rinde", "root", "stamm", "stem", "tronc",
    "trunk", "twig", "wood", "zweig", "écorce",
];

/// Whole words that speak of wood; as parts they'd be in too many others.
const WOOD_WORDS: [&str; 4] = ["ast", "limb", "log", "rama"];

/// What a name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameSays {
    Leaf,
    Wood,
    /// The name has words of neither, or of both.
    Nothing,
}

/// Reads a name. A name that speaks of both, such as `BranchLeaves`, says
/// nothing.
pub(crate) fn read(name: &str) -> NameSays {
    let lower = name.to_lowercase();
    let has_part = |parts: &[&str]| parts.iter().any(|part| lower.contains(part));
    let is_word = |word: &str| WOOD_WORDS.contains(&word);
    let leaf = has_part(&LEAF_PARTS);
    let wood = has_part(&WOOD_PARTS) || lower.split(|c: char| !c.is_alphabetic()).any(is_word);
    match (leaf, wood) {
        (true, false) => NameSays::Leaf,
        (false, true) => NameSays::Wood,
        _ => NameSays::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_leaves_wood_and_neither() {
        for (name, says) in [
            ("Leaves_NormalTree", NameSays::Leaf),
            ("eiche_Blätter.001", NameSays::Leaf),
            ("pineNeedles", NameSays::Leaf),
            ("Bark_NormalTree", NameSays::Wood),
            ("dicker_Ast", NameSays::Wood),
            ("Plastic", NameSays::Nothing),
            ("BranchLeaves", NameSays::Nothing),
            ("tree.023", NameSays::Nothing),
            ("", NameSays::Nothing),
        ] {
            assert_eq!(read(name), says, "{name}");
        }
    }
}
