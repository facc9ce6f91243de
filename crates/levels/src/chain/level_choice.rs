//! Levels of numbers of triangles that are asked for, and notes of places without a level.

use secateur_model::{NamedOption, Note};
use secateur_simplify::{Amount, Observer, Progress};

use super::error::ChainError;
use super::maker::{Made, Maker};
use super::options::{HEIGHTS_PX, LEAST_PX};
use super::placed::{Place, Placed};
use super::textures::{Client, end_of};
use crate::impostor::Choice;

/// How a note begins that says why there is no level for a place, which follows with a colon.
const NO_LEVEL: &str = "no level begins at ";

/// The words for a height on the screen.
pub(super) fn in_pixels(height: f64) -> String {
    format!("{} pixels", (10.0 * height).round() / 10.0)
}

/// How a note begins that says why there is no level for this place.
pub(super) fn no_level(place: &str) -> String {
    format!("{NO_LEVEL}{place}:")
}

/// Notes of which those of places without a level for the same reason are one: `135 pixels` after `270 pixels` makes
/// `270 and 135 pixels`.
pub(super) fn join_places(notes: Vec<Note>) -> Vec<Note> {
    let mut joined: Vec<Note> = Vec::new();
    let parts = |note: &str| {
        let (place, reason) = note.strip_prefix(NO_LEVEL)?.split_once(':')?;
        Some((place.to_owned(), reason.to_owned()))
    };
    for note in notes {
        let before = joined.last().and_then(|last| parts(last));
        match (before, parts(&note)) {
            (Some((places, reason)), Some((place, same))) if reason == same => {
                let unit = place.rsplit_once(' ').map_or("", |(_, unit)| unit);
                let earlier = places.strip_suffix(unit).unwrap_or(&places).trim_end();
                let earlier = earlier.replace(" and ", ", ");
                joined.pop();
                joined.push((no_level(&format!("{earlier} and {place}")) + &reason).into());
            }
            (_, _) => joined.push(note),
        }
    }
    joined
}

/// Levels of these numbers of triangles.
pub(super) fn asked(
    maker: &Maker<'_>,
    amounts: &[Amount],
    client: &Client<'_>,
    notes: &mut Vec<Note>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut placed: Vec<Placed> = Vec::new();
    let mut finest_beyond = None;
    for (done, amount) in amounts.iter().enumerate() {
        let of = amounts.len();
        Progress::Level { done, of }.tell(observer)?;
        let triangles = amount.of(maker.all);
        if maker.options.morph {
            maker.nest_in(placed.last().map(|finer| &finer.made));
        }
        let level = maker.level(triangles, observer)?;
        if level.triangles() == 0 {
            return Err(ChainError::NothingLeft {
                triangles,
                there: maker.all,
            });
        }
        if is_no_less(&level, placed.last(), maker) {
            let note = format!(
                "a level of {} triangles is left out: it would be as large as the one before",
                level.triangles()
            );
            notes.push(note.into());
            continue;
        }
        let below = placed.last().map_or(f64::INFINITY, Placed::begins);
        let (triangles, is_first) = (level.triangles(), placed.is_empty());
        match placed_below(maker, (level, below), is_first, client, observer)? {
            Some(found) => placed.push(found),
            None => {
                finest_beyond = finest_beyond.or(Some(triangles));
                let note = format!(
                    "a level of {triangles} triangles is left out: even {LEAST_PX} pixels high it differs by more than {}; ask for more triangles, or raise ",
                    maker.options.max_difference
                );
                notes.push(Note::from(note).naming(NamedOption::MaxDifference(None)));
            }
        }
    }
    let options = maker.options;
    let has_others = options.original || options.chosen_impostor() != Choice::None;
    match finest_beyond.filter(|_| placed.is_empty() && !has_others) {
        Some(triangles) => Err(ChainError::NoneWithin {
            triangles,
            max_difference: options.max_difference,
        }),
        None => Ok(placed),
    }
}

fn is_no_less(level: &Made, before: Option<&Placed>, maker: &Maker<'_>) -> bool {
    match before {
        Some(before) => level.triangles() >= before.triangles(),
        // Without the original before it the first level may be the tree as it is.
        None if maker.options.original => level.triangles() >= maker.all,
        None => level.triangles() > maker.all,
    }
}

/// A level from the largest of the usual heights below another at which it is within the limits; none if it is at
/// none.
fn placed_below(
    maker: &Maker<'_>,
    (level, below): (Made, f64),
    is_first: bool,
    client: &Client<'_>,
    observer: &mut Observer<'_>,
) -> Result<Option<Placed>, ChainError> {
    let screen = maker.options.screen.height_px / HEIGHTS_PX[0];
    let mut height = (below / 2.0).min(HEIGHTS_PX[0] * screen);
    while height >= LEAST_PX {
        // From few views it is known sooner that it is not.
        if maker.look.over_in_search(&level.drawn, height) <= 1.1 {
            let place = Place::new([height, end_of(height, None)], is_first);
            let placed = maker.placed(level.clone(), place, client, observer)?;
            if placed.difference.over(maker.look.limits) <= 1.0 {
                return Ok(Some(placed));
            }
        }
        height /= 2.0;
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_said_to_a_tenth_of_a_pixel() {
        let said = [1080.0, 67.5, 217.761_850_784].map(in_pixels);
        assert_eq!(said, ["1080 pixels", "67.5 pixels", "217.8 pixels"]);
    }

    #[test]
    fn places_without_a_level_for_one_reason_are_one_note() {
        let note = |place: &str, why: &str| Note::from(format!("{} {why}", no_level(place)));
        let notes = vec![
            "the plant is 99 units high: as it is".into(),
            note("1080 pixels", "the plant serves: it is light"),
            note("540 pixels", "the plant serves: it is light"),
            note("270 pixels", "the plant serves: it is light"),
            note("135 pixels", "the impostor is enough"),
        ];
        assert_eq!(
            join_places(notes),
            [
                "the plant is 99 units high: as it is",
                "no level begins at 1080, 540 and 270 pixels: the plant serves: it is light",
                "no level begins at 135 pixels: the impostor is enough"
            ]
        );
        let far = vec![note("20 m", "so"), note("21.5 m", "so")];
        assert_eq!(join_places(far), ["no level begins at 20 and 21.5 m: so"]);
    }
}
