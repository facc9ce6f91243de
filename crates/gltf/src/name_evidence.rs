//! What a name says: leaf, wood, or nothing.

/// Parts of words that speak of leaves, in the languages of common exporters.
const LEAF_PARTS: [&str; 21] = [
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
    GRASS,
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

/// Names blades of grass, and as often the lawn that they grow on.
const GRASS: &str = "grass";

/// Parts of words that speak of wood.
const WOOD_PARTS: [&str; 15] = [
    "bark", "branch", "corteza", "ecorce", "holz", "rinde", "root", "stamm", "stem", "tronc",
    "trunk", "twig", "wood", "zweig", "écorce",
];

/// Whole words that speak of wood; as parts they'd be in too many others.
const WOOD_WORDS: [&str; 4] = ["ast", "limb", "log", "rama"];

/// Words of wood that a card with leaves on it may have: it shows a whole branch.
const BRANCH_WORDS: [&str; 6] = ["ast", "branch", "limb", "rama", "twig", "zweig"];

/// What a name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameSays {
    Leaf,
    Wood,
}

/// The word that a name says something by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TellingWord {
    pub(crate) says: NameSays,
    pub(crate) word: &'static str,
}

impl TellingWord {
    /// Whether it speaks of branches, which cut-out cards show with their leaves.
    pub(crate) fn is_of_branches(&self) -> bool {
        BRANCH_WORDS.contains(&self.word)
    }

    /// Whether it speaks of grass: blades, or a lawn in one piece.
    pub(crate) fn is_of_grass(&self) -> bool {
        self.word == GRASS
    }
}

/// Reads a name. A name that speaks of both, such as `BranchLeaves`, says
/// nothing.
pub(crate) fn read(name: &str) -> Option<TellingWord> {
    let lower = name.to_lowercase();
    let part_of = |parts: &[&'static str]| parts.iter().copied().find(|part| lower.contains(part));
    let mut words = lower.split(|c: char| !c.is_alphabetic());
    let whole = words.find_map(|word| WOOD_WORDS.into_iter().find(|known| *known == word));
    match (part_of(&LEAF_PARTS), part_of(&WOOD_PARTS).or(whole)) {
        (Some(word), None) => Some(TellingWord {
            says: NameSays::Leaf,
            word,
        }),
        (None, Some(word)) => Some(TellingWord {
            says: NameSays::Wood,
            word,
        }),
        (Some(_), Some(_)) | (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_leaves_wood_and_neither() {
        for (name, says) in [
            ("Leaves_NormalTree", Some(NameSays::Leaf)),
            ("eiche_Blätter.001", Some(NameSays::Leaf)),
            ("pineNeedles", Some(NameSays::Leaf)),
            ("Mf_Grass.003", Some(NameSays::Leaf)),
            ("Bark_NormalTree", Some(NameSays::Wood)),
            ("dicker_Ast", Some(NameSays::Wood)),
            ("Plastic", None),
            ("BranchLeaves", None),
            ("tree.023", None),
            ("", None),
        ] {
            assert_eq!(read(name).map(|word| word.says), says, "{name}");
        }
    }

    #[test]
    fn a_name_tells_by_which_word_it_speaks() {
        let word = |name| read(name).map(|word| (word.word, word.is_of_branches()));
        assert_eq!(word("Tree_Branches_01"), Some(("branch", true)));
        assert_eq!(word("dicker_Ast"), Some(("ast", true)));
        assert_eq!(word("Tree_Trunk_01"), Some(("trunk", false)));
    }
}
