//! Names of what a level has of its own: `leaves_LOD1` is made of `leaves`.

/// Begins the number of a level.
const WORD: &str = "_LOD";

/// The name, in the level of this number, of what is called so in the plant.
pub(crate) fn with_level(name: &str, level: usize) -> String {
    format!("{name}{WORD}{level}")
}

/// The name in the plant of what is called so in a level; the same where it says no level.
pub(crate) fn without_level(name: &str) -> &str {
    match name.rsplit_once(WORD) {
        Some((stem, number))
            if !stem.is_empty()
                && !number.is_empty()
                && number.bytes().all(|b| b.is_ascii_digit()) =>
        {
            stem
        }
        _ => name,
    }
}

/// What a material without a name is called in a level, before the level's number.
pub(crate) fn of_unnamed_material(index: usize) -> String {
    format!("material{index}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_added_and_taken_away_once() {
        for name in ["leaves", "Oak_LOD2", "", "_LOD"] {
            let of_level = with_level(name, 12);
            let back = without_level(&of_level);
            assert_eq!(back, if name.is_empty() { "_LOD12" } else { name });
        }
        for name in ["leaves", "leaves_LOD", "leaves_LOD1b", "_LOD1"] {
            assert_eq!(without_level(name), name);
        }
    }
}
