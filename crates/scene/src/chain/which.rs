//! Which levels a chain has: those that are asked for, or what heights on the screen need.

use secateur_simplify::{Amount, Observer};

use super::error::ChainError;
use super::ladder::{Ladder, STEPS_A_HALF};
use super::maker::{Made, Maker};
use super::options::{HEIGHTS_PX, Wanted};
use super::placed::Placed;
use super::textures::{Client, end_of};

/// A level that is sought for a height has at most this share of the triangles of the one before it: to switch for
/// less would not pay.
pub(super) const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// A level that is sought for a distance that was asked for has at most this share.
const MOST_OF_ASKED: f64 = 0.9;

/// Of how many times as many triangles a level is that begins twice as near, until two tell.
const STEPS_A_DOUBLING: f64 = 0.9 * STEPS_A_HALF as f64;

/// The step that is tried first where nothing is known: a tenth of all triangles.
const FIRST: usize = 104;

/// The least height at which a level of a given number of triangles may begin, in pixels: a block of the judge.
const LEAST_PX: f64 = 8.0;

/// How a note begins that says why there is no level for a place.
pub(super) fn no_level(place: &str) -> String {
    format!("no level begins at {place}:")
}

/// Levels of these numbers of triangles.
pub(super) fn asked(
    maker: &Maker<'_>,
    amounts: &[Amount],
    client: &Client<'_>,
    notes: &mut Vec<String>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut placed: Vec<Placed> = Vec::new();
    for amount in amounts {
        let triangles = amount.of(maker.all);
        let level = maker.level(triangles, observer)?;
        if level.triangles() == 0 {
            return Err(ChainError::Wanted(format!(
                "no leaf and no piece of wood is left with {triangles} of {} triangles: ask for more",
                maker.all
            )));
        }
        if is_no_less(&level, placed.last(), maker) {
            notes.push(format!(
                "a level of {} triangles is left out: it would be as large as the one before",
                level.triangles()
            ));
            continue;
        }
        let below = placed.last().map_or(f64::INFINITY, Placed::begins);
        let (triangles, is_first) = (level.triangles(), placed.is_empty());
        match placed_below(maker, (level, below), is_first, client, observer)? {
            Some(found) => placed.push(found),
            None => notes.push(format!(
                "a level of {triangles} triangles is left out: even {LEAST_PX} pixels high it differs by more than {}; ask for more triangles, or raise `--max-difference`",
                maker.options.max_difference
            )),
        }
    }
    Ok(placed)
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
            let range = [height, end_of(height, None)];
            let placed = maker.placed(level.clone(), range, is_first, client, observer)?;
            if placed.difference.over(maker.look.limits) <= 1.0 {
                return Ok(Some(placed));
            }
        }
        height /= 2.0;
    }
    Ok(None)
}

/// For each place the fewest triangles within the limits, but for places that would save too little, and for the
/// last where an impostor stands there whatever a mesh would look like.
///
/// The farthest place is sought for first: its pictures are the smallest, and what does there is more than does
/// nearer.
pub(super) fn lightest(
    maker: &Maker<'_>,
    client: &Client<'_>,
    notes: &mut Vec<String>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut places = maker.heights();
    if maker.options.impostor.is_demanded() && places.len() > 1 {
        places.pop();
    }
    let found = sought(maker, &places, client, observer)?;
    let most_of_before = match maker.options.wanted {
        Wanted::Distances(_) => MOST_OF_ASKED,
        Wanted::Heights(_) | Wanted::Triangles(_) => MOST_OF_BEFORE,
    };
    let mut placed: Vec<Placed> = Vec::new();
    for ((_, place), found) in places.iter().zip(found) {
        let (before, of_before) = match placed.last() {
            Some(before) => ("the level before", before.triangles()),
            None => ("the plant itself", maker.all),
        };
        match found {
            Some(found) if found.triangles() as f64 <= most_of_before * of_before as f64 => {
                placed.push(found);
            }
            Some(found) => notes.push(format!(
                "{} {before} of {of_before} triangles serves there, since {} would be needed",
                no_level(place),
                found.triangles()
            )),
            None => notes.push(format!(
                "{} {before} of {of_before} triangles serves there, since nothing lighter is within the difference",
                no_level(place)
            )),
        }
    }
    Ok(placed)
}

/// For each place the lightest level within the limits, if any is but the tree itself.
fn sought(
    maker: &Maker<'_>,
    places: &[(f64, String)],
    client: &Client<'_>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Option<Placed>>, ChainError> {
    let mut ladder = Ladder::new(maker, client);
    let mut found: Vec<Option<Placed>> = Vec::new();
    let mut farther: Option<(f64, usize)> = None;
    for (k, (height, _)) in places.iter().enumerate().rev() {
        let next = places.get(k + 1).map(|(height, _)| *height);
        let (end, guess) = match farther {
            // What is no lighter far off is none near by.
            Some((_, 0)) => (1, 1),
            Some((height_there, step)) => {
                let doublings = (height / height_there).log2();
                let finer = (STEPS_A_DOUBLING * doublings) as usize;
                let end = step.max(1);
                (end, step.saturating_sub(finer).max(1))
            }
            None => (ladder.steps(), FIRST),
        };
        let range = [*height, end_of(*height, next)];
        let lightest = ladder.lightest(range, k == 0, (end, guess), observer)?;
        let step = lightest.as_ref().map_or(0, |(step, _)| *step);
        farther = Some((*height, step));
        found.push(lightest.map(|(_, placed)| placed));
    }
    found.reverse();
    Ok(found)
}
