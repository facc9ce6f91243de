//! The species that can be grown.

use std::str::FromStr;

/// A kind of plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Species {
    /// A small broadleaf tree with lobed leaves, after English oak.
    Oak,
}

impl Species {
    /// All species, in the order they are listed to people.
    pub const ALL: &'static [Self] = &[Self::Oak];

    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Oak => "oak",
        }
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
    fn every_name_leads_back_to_its_species() {
        for &species in Species::ALL {
            assert_eq!(species.name().parse(), Ok(species));
        }
        let error = "yew".parse::<Species>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "no species is called 'yew': choose one of oak"
        );
    }
}
