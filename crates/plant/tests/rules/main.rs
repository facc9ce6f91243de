//! Rule files: what they can say, and what they are told when they go wrong.

mod corpus;
mod derivation;
mod errors;
mod expressions;
mod long_lines;

use secateur_plant::{Random, Rules, RulesError};

/// The word that rules derive, as text.
fn derived(text: &str) -> Result<String, RulesError> {
    let rules = Rules::parse(text)?;
    Ok(rules.derive(1.0, &mut Random::new(0))?.to_text(&rules))
}

#[track_caller]
fn word(text: &str) -> String {
    derived(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// What is wrong with rules.
#[track_caller]
fn error(text: &str) -> String {
    match derived(text) {
        Ok(word) => panic!("{text} derives {word}"),
        Err(error) => error.to_string(),
    }
}
