//! The species that can be grown: a rule file each.

use std::str::FromStr;
use std::sync::OnceLock;

use crate::Rules;

/// A kind of plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Species {
    /// English oak (Quercus robur).
    Oak,
    /// Shagbark hickory (Carya ovata); a leaf is a whole pinnate leaf.
    Carya,
    /// Silver birch (Betula pendula).
    Birch,
    /// Common alder (Alnus glutinosa).
    Alder,
    /// Norway maple (Acer platanoides).
    Maple,
    /// Rowan (Sorbus aucuparia); a leaf is a whole pinnate leaf of 18 triangles.
    Rowan,
    /// Scots pine (Pinus sylvestris); a leaf is a needle.
    Pine,
    /// Cabbage palmetto (Sabal palmetto); a leaf is a segment of a fan.
    Palmetto,
    /// Weeping willow (Salix babylonica).
    Willow,
    /// A bush such as box or privet.
    Bush,
}

/// What belongs to a species.
struct Entry {
    species: Species,
    name: &'static str,
    text: &'static str,
}

macro_rules! species {
    ($($species:ident = $name:literal),+ $(,)?) => {
        impl Species {
            /// All species, in the order they are listed to people.
            pub const ALL: &'static [Self] = &[$(Self::$species),+];
        }

        static ENTRIES: &[Entry] = &[$(Entry {
            species: Species::$species,
            name: $name,
            text: include_str!(concat!($name, ".lsys")),
        }),+];

        static RULES: [OnceLock<Rules>; ENTRIES.len()] =
            [const { OnceLock::new() }; ENTRIES.len()];
    };
}

species! {
    Oak = "oak",
    Carya = "carya",
    Birch = "birch",
    Alder = "alder",
    Maple = "maple",
    Rowan = "rowan",
    Pine = "pine",
    Palmetto = "palmetto",
    Willow = "willow",
    Bush = "bush",
}

impl Species {
    fn index(self) -> usize {
        let found = ENTRIES.iter().position(|entry| entry.species == self);
        found.expect("every species has an entry")
    }

    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        ENTRIES[self.index()].name
    }

    /// Its rule file, as an example to start from.
    pub fn text(self) -> &'static str {
        ENTRIES[self.index()].text
    }

    /// The L-system of the species, read once.
    pub fn rules(self) -> &'static Rules {
        RULES[self.index()].get_or_init(|| {
            Rules::parse(self.text()).unwrap_or_else(|e| panic!("the rules of {self}: {e}"))
        })
    }

    /// How many leaves it has unless others are asked for.
    pub fn default_leaves(self) -> u32 {
        let leaves = self.rules().settings().leaves;
        leaves.expect("the rules of every species set its leaves")
    }
}

impl std::fmt::Display for Species {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no species.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no species is called '{name}': choose one of {}", names())]
pub struct UnknownSpecies {
    /// What was asked for.
    pub name: String,
}

fn names() -> String {
    let names: Vec<&str> = Species::ALL.iter().map(|s| s.name()).collect();
    names.join(", ")
}

impl FromStr for Species {
    type Err = UnknownSpecies;

    fn from_str(name: &str) -> Result<Self, UnknownSpecies> {
        let found = Self::ALL.iter().find(|s| s.name() == name);
        found
            .copied()
            .ok_or_else(|| UnknownSpecies { name: name.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_back_to_its_species_and_its_rules_can_be_read() {
        for &species in Species::ALL {
            assert_eq!(species.name().parse(), Ok(species));
            assert!(species.default_leaves() > 0);
        }
        let error = "yew".parse::<Species>().unwrap_err().to_string();
        assert!(error.starts_with("no species is called 'yew': choose one of oak"));
    }
}
