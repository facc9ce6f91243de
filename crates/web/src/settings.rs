//! What is asked for, as JSON: the options of `secateur simplify` and `secateur lods` that a page offers.

use secateur::chain::{ImpostorChoice, LevelsOptions, Wanted};
use secateur::{Amount, Effort, LevelOptions, Target};
use serde::Deserialize;

/// What a level is to be like: a [`LevelAmount`], with `"effort"` how much work goes into it, and with
/// `"judged": false` that nobody asks how far it looks from the plant.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub struct LevelSettings {
    /// How many triangles it has.
    #[serde(flatten)]
    pub amount: LevelAmount,
    /// How much work goes into it: `fast`, `normal` or `best`.
    #[serde(default)]
    pub effort: Effort,
    /// Whether its difference is measured; 0 in its report where it is not.
    #[serde(default = "yes")]
    pub judged: bool,
}

/// How many triangles a level has: `{"amount": "share", "value": 0.25}`, a share of all triangles from 0 to 1, or
/// `{"amount": "triangles", "value": 5000}`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(tag = "amount", content = "value", rename_all = "lowercase")]
pub enum LevelAmount {
    /// A share of all triangles, 0 to 1.
    Share(f64),
    /// A number of triangles.
    Triangles(u64),
}

/// Which levels a chain has: `{"levels": "heights"}`, or with `"values"`, `"distances"` in metres or `"shares"`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "levels", content = "values", rename_all = "lowercase")]
pub enum WantedLevels {
    /// Four levels for the heights of the program's default.
    Heights,
    /// Levels for these distances in metres, rising.
    Distances(Vec<f64>),
    /// Levels of these shares of all triangles, falling.
    Shares(Vec<f64>),
}

/// What a chain is to be like: a [`WantedLevels`], and what differs from the program's defaults.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct ChainSettings {
    /// Which levels it has.
    #[serde(flatten)]
    pub wanted: WantedLevels,
    /// The largest difference that a level may have, above 0 to 2; the program's where none is given.
    #[serde(rename = "maxDifference")]
    pub max_difference: Option<f64>,
    /// Whether it begins with the plant itself.
    #[serde(default = "yes")]
    pub original: bool,
    /// How much work goes into the search: `fast`, `normal` or `best`.
    #[serde(default)]
    pub effort: Effort,
    /// Whether it may end in pictures of the plant, where it is for heights or distances.
    #[serde(default = "yes")]
    pub impostor: bool,
}

fn yes() -> bool {
    true
}

impl LevelSettings {
    /// The settings in a text.
    ///
    /// # Errors
    /// A sentence where the text is no such JSON, or the share is outside 0 to 1.
    pub fn parse(json: &str) -> Result<Self, String> {
        let settings: Self = parsed(json)?;
        match settings.amount {
            LevelAmount::Share(share) if !(0.0..=1.0).contains(&share) => {
                Err(format!("a share of triangles is from 0 to 1, not {share}"))
            }
            LevelAmount::Share(_) | LevelAmount::Triangles(_) => Ok(settings),
        }
    }

    /// As the library has them.
    pub fn options(self) -> LevelOptions {
        let mut options = match self.amount {
            LevelAmount::Share(share) => LevelOptions::triangles(share),
            LevelAmount::Triangles(count) => LevelOptions::to(Target::triangles(count)),
        };
        options.simplify.effort = self.effort;
        options.judged = self.judged;
        options
    }
}

impl ChainSettings {
    /// The settings in a text.
    ///
    /// # Errors
    /// A sentence where the text is no such JSON.
    pub fn parse(json: &str) -> Result<Self, String> {
        parsed(json)
    }

    /// As the library has them.
    pub fn options(&self) -> LevelsOptions {
        let mut usual = LevelsOptions::default();
        usual.leaves.effort = self.effort;
        LevelsOptions {
            wanted: match &self.wanted {
                WantedLevels::Heights => usual.wanted,
                WantedLevels::Distances(all) => Wanted::Distances(all.clone()),
                WantedLevels::Shares(all) => {
                    Wanted::Triangles(all.iter().map(|share| Amount::Share(*share)).collect())
                }
            },
            max_difference: self.max_difference.unwrap_or(usual.max_difference),
            original: self.original,
            impostor: (!self.impostor).then_some(ImpostorChoice::None),
            ..usual
        }
    }
}

fn parsed<'t, T: Deserialize<'t>>(json: &'t str) -> Result<T, String> {
    serde_json::from_str(json).map_err(|error| format!("the settings are wrong: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_the_programs_options() {
        let level = LevelSettings::parse(r#"{"amount": "triangles", "value": 300}"#).unwrap();
        assert_eq!(level.options().simplify.target, Target::triangles(300));
        let chain = |json| ChainSettings::parse(json).unwrap().options();
        assert_eq!(chain(r#"{"levels": "heights"}"#), LevelsOptions::default());
        let shares = chain(r#"{"levels": "shares", "values": [0.5, 0.1], "original": false}"#);
        assert_eq!(shares.chosen_impostor(), ImpostorChoice::None);
        assert!(!shares.original);
        let far = chain(r#"{"levels": "distances", "values": [5, 20], "maxDifference": 0.5}"#);
        assert_eq!(far.wanted, Wanted::Distances(vec![5.0, 20.0]));
        assert_eq!(far.max_difference, 0.5);
        assert_eq!(far.leaves.effort, Effort::Normal);
        let fast = chain(r#"{"levels": "heights", "effort": "fast"}"#);
        assert_eq!(fast.leaves.effort, Effort::Fast);
        let best = r#"{"amount": "share", "value": 0.5, "effort": "best"}"#;
        let best = LevelSettings::parse(best).unwrap().options();
        assert!(best.simplify.effort == Effort::Best && best.judged);
        let first = r#"{"amount": "share", "value": 0.5, "judged": false}"#;
        assert!(!LevelSettings::parse(first).unwrap().options().judged);
    }

    #[test]
    fn wrong_settings_are_said_in_a_sentence() {
        for wrong in [r#"{"amount": "share", "value": 2}"#, "{}", "half"] {
            assert!(LevelSettings::parse(wrong).is_err(), "{wrong}");
        }
        assert!(ChainSettings::parse(r#"{"levels": "some"}"#).is_err());
    }
}
