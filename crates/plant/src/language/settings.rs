//! What a file says about how its plant looks: `set NAME = VALUE;`.

use pest::iterators::Pair;

use super::error::place_of;
use super::{Rule, RulesError, cut};

/// What is drawn on a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outline {
    /// Nothing is cut out: a leaf is its polygons.
    Plain,
    /// An egg, pointed, its edge toothed: birch.
    Ovate,
    /// Round lobes on both sides: oak.
    Lobed,
    /// Nearly round, widest above the middle: alder.
    Round,
    /// Pointed lobes from one point: maple.
    Palmate,
    /// A narrow blade: willow.
    Lanceolate,
    /// Few large leaflets in pairs and one at the end: hickory.
    Pinnate,
    /// Many narrow toothed leaflets in pairs and one at the end: rowan.
    PinnateFine,
    /// Segments from one point, like a hand fan: palmetto.
    Fan,
    /// A small smooth egg: a bush.
    Elliptic,
}

impl Outline {
    const NAMES: [(&'static str, Self); 10] = [
        ("plain", Self::Plain),
        ("ovate", Self::Ovate),
        ("lobed", Self::Lobed),
        ("round", Self::Round),
        ("palmate", Self::Palmate),
        ("lanceolate", Self::Lanceolate),
        ("pinnate", Self::Pinnate),
        ("pinnate_fine", Self::PinnateFine),
        ("fan", Self::Fan),
        ("elliptic", Self::Elliptic),
    ];
}

/// What is drawn on wood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Bark {
    /// One colour, without a pattern.
    Plain,
    /// Long ridges along the stem: oak.
    Ridged,
    /// Dark dashes across, on a pale ground: birch.
    Banded,
    /// Plates with dark seams: pine.
    Plated,
}

impl Bark {
    const NAMES: [(&'static str, Self); 4] = [
        ("plain", Self::Plain),
        ("ridged", Self::Ridged),
        ("banded", Self::Banded),
        ("plated", Self::Plated),
    ];
}

/// What gets smaller where there are more leaves, and larger where there are fewer,
/// so that all together keep their area.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shrinks {
    /// Length and width alike.
    Both,
    /// The width only: needles, and segments of fans.
    Width,
}

impl Shrinks {
    const NAMES: [(&'static str, Self); 2] = [("both", Self::Both), ("width", Self::Width)];
}

/// What a rule file sets, with what holds where it sets nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// `leaves`: the number of leaves that the lengths in the rules are meant
    /// for, and that a plant has unless others are asked for.
    pub leaves: Option<u32>,
    /// `leaf_outline`: the shape that the leaf's texture is cut to.
    pub leaf_outline: Outline,
    /// `leaf_width`: the width of a leaf as a share of its length, 0.001 to 10.
    pub leaf_width: f64,
    /// `leaf_shrinks`: what gets smaller where a plant has more leaves than its
    /// rules are meant for.
    pub leaf_shrinks: Shrinks,
    /// `leaf_droop`: the angle by which a blade's tip hangs below its base's
    /// direction, in degrees, -360 to 360.
    pub leaf_droop_degrees: f64,
    /// `leaf_fold`: the angle by which the halves of a blade are raised, in
    /// degrees, -90 to 90.
    pub leaf_fold_degrees: f64,
    /// `leaf_colour`: sRGB, each 0 to 1.
    pub leaf_colour: [f64; 3],
    /// `leaf_variety`: by how much leaves differ in colour, 0 to 1.
    pub leaf_variety: f64,
    /// `leaf_outward`: how far shading normals lean from the leaf's own (0) to
    /// straight out of the crown (1).
    pub leaf_outward: f64,
    /// `bark_colour`: sRGB, each 0 to 1.
    pub bark_colour: [f64; 3],
    /// `bark_pattern`: what the texture of wood shows.
    pub bark_pattern: Bark,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            leaves: None,
            leaf_outline: Outline::Ovate,
            leaf_width: 0.7,
            leaf_shrinks: Shrinks::Both,
            leaf_droop_degrees: 25.0,
            leaf_fold_degrees: 12.0,
            leaf_colour: [0.33, 0.50, 0.16],
            leaf_variety: 0.5,
            leaf_outward: 0.45,
            bark_colour: [0.44, 0.37, 0.31],
            bark_pattern: Bark::Ridged,
        }
    }
}

/// Sets what a statement says.
pub(super) fn set(
    settings: &mut Settings,
    name: &Pair<'_, Rule>,
    values: &[Pair<'_, Rule>],
) -> Result<(), RulesError> {
    let fraction = |at: usize| number(name, values, at, 0.0, 1.0);
    match name.as_str() {
        "leaves" => {
            let most = f64::from(crate::MAX_LEAVES);
            settings.leaves = Some(number(name, values, 0, 1.0, most)? as u32);
        }
        "leaf_outline" => settings.leaf_outline = word(name, values, &Outline::NAMES)?,
        "leaf_width" => settings.leaf_width = number(name, values, 0, 0.001, 10.0)?,
        "leaf_droop" => settings.leaf_droop_degrees = number(name, values, 0, -360.0, 360.0)?,
        "leaf_fold" => settings.leaf_fold_degrees = number(name, values, 0, -90.0, 90.0)?,
        "leaf_shrinks" => settings.leaf_shrinks = word(name, values, &Shrinks::NAMES)?,
        "leaf_variety" => settings.leaf_variety = fraction(0)?,
        "leaf_outward" => settings.leaf_outward = fraction(0)?,
        "bark_pattern" => settings.bark_pattern = word(name, values, &Bark::NAMES)?,
        "leaf_colour" => {
            settings.leaf_colour = [fraction(0)?, fraction(1)?, fraction(2)?];
            return count(name, values, 3);
        }
        "bark_colour" => {
            settings.bark_colour = [fraction(0)?, fraction(1)?, fraction(2)?];
            return count(name, values, 3);
        }
        other => {
            let other = cut(other);
            let message = format!(
                "unknown setting `{other}`: there are leaves, leaf_outline, leaf_width, leaf_shrinks, \
                 leaf_droop, leaf_fold, leaf_colour, leaf_variety, leaf_outward, bark_colour, bark_pattern"
            );
            return Err(RulesError::at(place_of(name), message));
        }
    }
    count(name, values, 1)
}

fn count(name: &Pair<'_, Rule>, values: &[Pair<'_, Rule>], takes: usize) -> Result<(), RulesError> {
    if values.len() == takes {
        return Ok(());
    }
    let (name_text, given) = (name.as_str(), values.len());
    let plural = if takes == 1 { "" } else { "s" };
    let message = format!("`{name_text}` takes {takes} value{plural}, not {given}");
    Err(RulesError::at(place_of(name), message))
}

/// A number as it is written, maybe with a minus.
fn number(
    name: &Pair<'_, Rule>,
    values: &[Pair<'_, Rule>],
    at: usize,
    low: f64,
    high: f64,
) -> Result<f64, RulesError> {
    let Some(value) = values.get(at) else {
        return count(name, values, at + 1).map(|()| 0.0);
    };
    match value.as_str().trim().parse::<f64>() {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        _ => {
            let message = format!("expected a number from {low} to {high}");
            Err(RulesError::at(place_of(value), message))
        }
    }
}

fn word<T: Copy>(
    name: &Pair<'_, Rule>,
    values: &[Pair<'_, Rule>],
    words: &[(&str, T)],
) -> Result<T, RulesError> {
    let written = values.first().map_or("", |value| value.as_str().trim());
    let known = words.iter().find(|(known, _)| *known == written);
    known.map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
        let place = place_of(values.first().unwrap_or(name));
        RulesError::at(place, format!("expected one of {}", known.join(", ")))
    })
}
