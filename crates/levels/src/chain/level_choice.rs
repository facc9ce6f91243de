//! Which levels a chain has: those that are asked for, or what heights on the screen need.

use secateur_model::{NamedOption, Note};
use secateur_simplify::{Amount, Observer, Progress};

use super::cards::{CardSearch, FAR_PX};
use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::ladder::{Ladder, step_of_share};
use super::maker::{Made, Maker};
use super::options::{HEIGHTS_PX, LEAST_PX, Wanted};
use super::placed::{LEAST_SHOWN, Place, Placed};
use super::textures::{Client, end_of};
use crate::impostor::Choice;

/// A level that is sought for a height has at most this share of the triangles of the one before it: to switch for
/// less would not pay.
pub(super) const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// A level that is sought for a distance that was asked for has at most this share.
const MOST_OF_ASKED: f64 = 0.9;

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

/// For each place the fewest triangles within the limits, but for places that would save too little, and for the
/// last where an impostor stands there whatever a mesh would look like. Where the leaves of the level before fade in
/// clients, one that saves less stands, too. And the cards that stand from the first place on
/// that is far and at which some do.
pub(super) fn lightest(
    maker: &Maker<'_>,
    cards: &mut CardSearch<'_>,
    client: &Client<'_>,
    notes: &mut Vec<Note>,
    observer: &mut Observer<'_>,
) -> Result<(Vec<Placed>, Vec<PlacedImpostor>), ChainError> {
    let mut places = maker.heights();
    if maker.options.chosen_impostor().is_demanded() && places.len() > 1 {
        places.pop();
    }
    let heights: Vec<f64> = places.iter().map(|(height, _)| *height).collect();
    let most_of_before = match maker.options.wanted {
        Wanted::Distances(_) => MOST_OF_ASKED,
        Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Triangles(_) => MOST_OF_BEFORE,
    };
    let mut ladder = Ladder::new(maker, client);
    // The levels, each with its step and the place where it begins.
    let mut found: Vec<(usize, usize, Placed)> = Vec::new();
    // Further heights at which the level of a place has to do, as none is lighter there.
    let mut serves: Vec<Vec<f64>> = vec![Vec::new(); places.len()];
    let mut far = Vec::new();
    // From here on it is not known that there are no cards.
    let mut may_have_cards = 0;
    let mut place = 0;
    let far_cards_at =
        |found: &[(usize, usize, Placed)], place, cards: &mut _, observer: &mut _| {
            let meshes: Vec<Placed> = found.iter().map(|(.., mesh)| mesh.clone()).collect();
            maker.far_cards(&meshes, (&heights, place), cards, client, observer)
        };
    while place < places.len() {
        let [done, of] = [place, places.len()];
        Progress::Level { done, of }.tell(observer)?;
        let height = heights[place];
        let is_far = maker.options.chosen_impostor() == Choice::Auto && height <= FAR_PX;
        if is_far && place >= may_have_cards {
            far = far_cards_at(&found, place, cards, observer)?;
            if !far.is_empty() {
                break;
            }
            may_have_cards = place + 1;
        }
        let end_px = end_of(height, heights.get(place + 1).copied());
        let before = found.last();
        let before_fades = before
            .is_some_and(|(.., before)| maker.shown_down_to(before, end_px, client) < LEAST_SHOWN);
        let most_of_before = match before_fades {
            true => 1.0,
            false => most_of_before,
        };
        let first = step_of_share(most_of_before, before.map_or(0, |(step, ..)| *step));
        let start = (first, before.is_none());
        if maker.options.morph {
            ladder.nest_in(before.map(|(.., before)| &before.made));
        }
        let at = [&[height], &serves[place][..]].concat();
        let sought = ladder.lightest(&at, end_px, start, observer)?;
        let of_before = before.map_or(maker.all, |(.., before)| before.triangles());
        let pays = |level: &Placed| level.triangles() as f64 <= most_of_before * of_before as f64;
        match (sought.filter(|(_, level)| pays(level)), before) {
            (Some((step, mut level)), _) => {
                // What does at the place before as well takes the place of what stands there.
                let mut from = place;
                while let Some((_, before, _)) = found.last() {
                    let does =
                        |height: &f64| maker.look.over_in_search(&level.made.drawn, *height) <= 1.0;
                    if !heights[before + 1..from].iter().all(does) {
                        break;
                    }
                    let at = (heights[*before], end_px, found.len() == 1);
                    let Some(earlier) = ladder.also_at(&level, at, observer)? else {
                        break;
                    };
                    (from, level) = (*before, earlier);
                    found.pop();
                }
                let is_dense = level.triangles() as f64 > maker.look.covered_px(height);
                found.push((step, from, level));
                if is_far && from == place && is_dense {
                    far = far_cards_at(&found, place, cards, observer)?;
                    if !far.is_empty() {
                        found.pop();
                        break;
                    }
                }
            }
            // What stands before it must do there too, or is sought again so that it does.
            (None, Some((_, from, level)))
                if !serves[*from].contains(&height)
                    && maker.look.over_in_search(&level.made.drawn, height) > 1.0 =>
            {
                place = *from;
                serves[place].push(height);
                found.pop();
                continue;
            }
            (None, _) => {}
        }
        place += 1;
    }
    let sought = &places[..place];
    note_places_without_level(sought, &found, maker, most_of_before, notes);
    let meshes = found.into_iter().map(|(.., level)| level).collect();
    Ok((meshes, far))
}

/// Says of each place without a level of its own which level serves there.
fn note_places_without_level(
    places: &[(f64, String)],
    found: &[(usize, usize, Placed)],
    maker: &Maker<'_>,
    most_of_before: f64,
    notes: &mut Vec<Note>,
) {
    for (k, (_, place)) in places.iter().enumerate() {
        if found.iter().any(|(_, at, _)| *at == k) {
            continue;
        }
        let before = found.iter().rfind(|(_, at, _)| *at < k);
        let (before, of_before) = match before {
            Some((.., level)) => ("the level before", level.triangles()),
            None => ("the plant itself", maker.all),
        };
        let note = format!(
            "{} {before} of {of_before} triangles serves there, since what is within the difference saves less than {:.0} %",
            no_level(place),
            100.0 * (1.0 - most_of_before)
        );
        notes.push(note.into());
    }
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
