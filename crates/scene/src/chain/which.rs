//! Which levels a chain has: those that are asked for, or what heights on the screen need.

use secateur_simplify::{Amount, Observer};

use super::error::ChainError;
use super::ladder::{Ladder, step_of_share};
use super::maker::{Made, Maker};
use super::options::{HEIGHTS_PX, Wanted};
use super::placed::Placed;
use super::textures::{Client, end_of};

/// A level that is sought for a height has at most this share of the triangles of the one before it: to switch for
/// less would not pay.
pub(super) const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// A level that is sought for a distance that was asked for has at most this share.
const MOST_OF_ASKED: f64 = 0.9;

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
    let heights: Vec<f64> = places.iter().map(|(height, _)| *height).collect();
    let most_of_before = match maker.options.wanted {
        Wanted::Distances(_) => MOST_OF_ASKED,
        Wanted::Heights(_) | Wanted::Triangles(_) => MOST_OF_BEFORE,
    };
    let mut ladder = Ladder::new(maker, client);
    let mut placed: Vec<Placed> = Vec::new();
    let mut before_step = 0;
    for (k, (height, place)) in places.iter().enumerate() {
        let end_px = end_of(*height, heights.get(k + 1).copied());
        let first = step_of_share(most_of_before, before_step);
        let is_finest = placed.is_empty();
        let found = ladder.lightest(&heights[k..], end_px, (first, is_finest), observer)?;
        let (before, of_before) = match placed.last() {
            Some(before) => ("the level before", before.triangles()),
            None => ("the plant itself", maker.all),
        };
        let pays = |found: &Placed| found.triangles() as f64 <= most_of_before * of_before as f64;
        match found.filter(|(_, found)| pays(found)) {
            Some((step, found)) => {
                before_step = step;
                placed.push(found);
            }
            None => notes.push(format!(
                "{} {before} of {of_before} triangles serves there, since what is within the difference saves less than {:.0} %",
                no_level(place),
                100.0 * (1.0 - most_of_before)
            )),
        }
    }
    Ok(placed)
}
