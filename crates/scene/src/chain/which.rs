//! Which levels a chain has: those that are asked for, or what heights on the screen need.

use secateur_simplify::{Amount, Observer};

use super::error::ChainError;
use super::ladder::{Ladder, STEPS_THAT_PAY};
use super::maker::{Made, Maker};

/// A level that is sought for a distance has at most this share of the triangles of the one before
/// it: to switch for less would not pay.
pub(super) const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// How many times the triangles of the next coarser level a level for a height has: four of them
/// go from all that shows to a fifth of it.
const STEP: f64 = 1.7;

/// A level, at which height it begins, and its FLIP there.
pub(super) type Placed = (Made, f64, f64);

/// How a note begins that says why there is no level for a place.
pub(super) fn no_level(place: &str) -> String {
    format!("no level begins at {place}:")
}

/// Levels of these numbers of triangles.
pub(super) fn asked(
    maker: &Maker<'_>,
    amounts: &[Amount],
    notes: &mut Vec<String>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut made: Vec<Placed> = Vec::new();
    for amount in amounts {
        let triangles = amount.of(maker.all);
        let level = maker.level(triangles, observer)?;
        if level.triangles() == 0 {
            return Err(ChainError::Wanted(format!(
                "no leaf and no piece of wood is left with {triangles} of {} triangles: ask for more",
                maker.all
            )));
        }
        if is_no_less(&level, made.last().map(|(level, ..)| level), maker.all) {
            notes.push(format!(
                "a level of {} triangles is left out: it would be as large as the one before",
                level.triangles()
            ));
            continue;
        }
        let before = made.last().map_or(f64::INFINITY, |(_, height, _)| *height);
        let (height, flip) = maker.height_for(&level, before);
        made.push((level, height, flip));
    }
    Ok(made)
}

fn is_no_less(level: &Made, before: Option<&Made>, all: usize) -> bool {
    match before {
        Some(before) => level.triangles() >= before.triangles(),
        // The first level may be the tree as it is.
        None => level.triangles() > all,
    }
}

/// For each place the fewest triangles within the difference, but for places that would save less than a
/// third, and for the last where an impostor stands there whatever a mesh would look like.
pub(super) fn lightest(
    maker: &Maker<'_>,
    notes: &mut Vec<String>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut ladder = Ladder::new(maker);
    let mut made: Vec<Placed> = Vec::new();
    let (mut first, mut pays_from) = (0, 0);
    let mut places = maker.heights();
    let heights: Vec<f64> = places.iter().map(|(height, _)| *height).collect();
    if maker.options.impostor.is_demanded() && places.len() > 1 {
        places.pop();
    }
    for (k, (height, place)) in places.into_iter().enumerate() {
        // It may be the last level, and FLIP is larger farther off on some plants.
        let step = ladder.lightest(&heights[k..], first, pays_from, observer)?;
        let level = ladder.level(step, observer)?;
        if let Some((before, ..)) = made.last()
            && level.triangles() as f64 > MOST_OF_BEFORE * before.triangles() as f64
        {
            notes.push(format!(
                "{} what is within the difference saves less than a third of the {} triangles before",
                no_level(&place),
                before.triangles()
            ));
            continue;
        }
        let flip = maker.flip_mean(level, height);
        made.push((level.clone(), height, flip));
        (first, pays_from) = (step, step + STEPS_THAT_PAY);
    }
    Ok(made)
}

/// For the lowest height the fewest triangles within the difference; for each height above it
/// [`STEP`] times those of the next, or more if the difference asks for it there. A difference alone makes no
/// chain: FLIP of what is left of a crown hardly depends on the size at which it is seen, so that
/// one level would do for all heights.
pub(super) fn spread(
    maker: &Maker<'_>,
    notes: &mut Vec<String>,
    observer: &mut Observer<'_>,
) -> Result<Vec<Placed>, ChainError> {
    let mut ladder = Ladder::new(maker);
    let mut made: Vec<Placed> = Vec::new();
    for (height, place) in maker.heights().into_iter().rev() {
        let step = match made.last() {
            None => None,
            Some((next, ..)) => {
                let triangles = (STEP * next.triangles() as f64).round() as usize;
                if triangles > maker.all {
                    notes.push(format!(
                        "{} with {STEP} times the {} triangles of the next it would have more than the tree",
                        no_level(&place),
                        next.triangles()
                    ));
                    break;
                }
                Some(maker.level(triangles, observer)?)
            }
        };
        let is_near = |level: &Made| maker.flip(level, height) <= maker.options.max_flip;
        let level = match step.filter(is_near) {
            Some(level) => level,
            None => {
                let step = ladder.lightest(&[height], 0, 0, observer)?;
                ladder.level(step, observer)?.clone()
            }
        };
        let flip = maker.flip_mean(&level, height);
        made.push((level, height, flip));
    }
    made.reverse();
    Ok(made)
}
