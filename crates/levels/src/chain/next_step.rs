//! Which step of a ladder a search tries next.

use std::ops::Range;

use super::ladder::STEPS_A_HALF;

/// By how much the logarithm of the difference over its limit rises from step to step, until two levels tell.
pub(super) const USUAL_SLOPE: f64 = 0.0125;

/// The least and the greatest slope that is learnt from two levels. Levels also differ by chance: with .004 a search of
/// `sap_birch_hex_9k` went from 22,639 triangles to 1,478 in one guess.
const SLOPES: [f64; 2] = [0.006, 0.03];

/// A guess goes at most this many steps beyond what is known, and later ones twice as far each.
const MOST_AWAY: f64 = STEPS_A_HALF as f64;

/// After so many guesses in one search the rest is halved: guesses may creep.
const MOST_GUESSES: u32 = 4;

/// After a level that is beyond the limits in pictures of its size, those that are tried next are at least this many
/// steps finer: such pictures take the longest.
pub(super) const FINER_BY: usize = 4;

/// A step, and how many times the limits it is.
pub(super) type Tried = (usize, f64);

/// The step to try where one was beyond the limits in pictures of its size, and those of a search then know of none that
/// is not: large pictures need not show as many times as much of each. With nothing known of it in a search.
pub(super) fn finer_than((step, over): Tried, slope: f64, steps: &Range<usize>) -> Option<Tried> {
    let by = (over.ln() / slope).ceil() as usize + FINER_BY;
    let finer = step.checked_sub(by)?;
    steps.contains(&finer).then_some((finer, 0.0))
}

/// By how much the logarithm of the difference rises from step to step between a level and the nearest that was tried
/// before it; nothing where that is no number.
pub(super) fn slope_beside(
    (within, beyond): (Option<Tried>, Option<Tried>),
    (step, over): Tried,
) -> Option<f64> {
    let others = [within, beyond].into_iter().flatten();
    let (other, other_over) = others.min_by_key(|(other, _)| other.abs_diff(step))?;
    let slope = (over / other_over).ln() / (step as f64 - other as f64);
    slope.is_finite().then(|| slope.clamp(SLOPES[0], SLOPES[1]))
}

/// The next step to try, of `steps`: where a line through what is known crosses the goal; `first` where nothing is
/// known. After some guesses the rest is halved, and while only one side is known each goes twice as far.
pub(super) fn guess(
    (within, beyond): (Option<Tried>, Option<Tried>),
    (goal, slope): (f64, f64),
    (first, guesses): (usize, u32),
    steps: Range<usize>,
) -> usize {
    let above = |over: f64| (over / goal).ln();
    let is_number = |tried: &Tried| above(tried.1).is_finite();
    let last = steps.end - 1;
    let middle = (steps.start + last) as f64 / 2.0;
    // Each is further off than the one before, but not off the end.
    let away = |(step, over): Tried| {
        let by = (above(over) / slope).abs().max(1.0);
        let by = by.min(MOST_AWAY) * f64::from(2u32.pow(guesses.saturating_sub(1).min(8)));
        match over <= goal {
            true => (step as f64 + by).min(middle.max(step as f64 + 1.0)),
            false => step as f64 - by,
        }
    };
    let at = match (within, beyond) {
        (None, None) => first as f64,
        (Some(fine), Some(coarse)) => {
            let both = is_number(&fine) && is_number(&coarse) && guesses < MOST_GUESSES;
            let (under, over) = (above(fine.1), above(coarse.1));
            match both {
                // At least a quarter of the way off either end: else it may creep.
                true => {
                    let share = (-under / (over - under)).clamp(0.25, 0.75);
                    fine.0 as f64 + share * (coarse.0 - fine.0) as f64
                }
                false => middle,
            }
        }
        // Where nothing differs, or all does, no slope is known.
        (Some(one), None) | (None, Some(one)) => match is_number(&one) {
            true => away(one),
            false => middle,
        },
    };
    (at.floor().max(0.0) as usize).clamp(steps.start, last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_step_is_where_the_goal_should_be_crossed() {
        let known =
            |within, beyond, steps| guess((within, beyond), (1.0, USUAL_SLOPE), (104, 1), steps);
        assert_eq!(known(None, None, 1..300), 104);
        assert_eq!(known(None, None, 110..300), 110);
        // What is e^.3 times the limits is 24 steps beyond them.
        assert_eq!(known(None, Some((80, 0.3f64.exp())), 1..80), 56);
        assert_eq!(known(Some((80, (-0.3f64).exp())), None, 81..300), 104);
        // Between two it is where a line crosses, but not near either.
        let [fine, coarse] = [(40, (-0.1f64).exp()), (60, 0.1f64.exp())];
        assert_eq!(known(Some(fine), Some(coarse), 41..60), 50);
        assert_eq!(known(Some((40, 0.999)), Some((60, 9.0)), 41..60), 45);
        // A level that is the tree says nothing of a slope: the rest is halved.
        assert_eq!(known(Some((1, 0.0)), None, 2..101), 51);
        assert_eq!(known(None, Some((3, 9.0)), 1..3), 1);
    }

    /// Of two levels the nearer one tells; differences that fall, or are 0, tell of no slope that could be.
    #[test]
    fn two_levels_tell_how_fast_the_difference_rises() {
        let e = std::f64::consts::E;
        let beside = |within, beyond| slope_beside((within, beyond), (100, e));
        assert_eq!(beside(None, None), None);
        assert_eq!(beside(Some((50, 1.0)), Some((200, 9.0))), Some(0.02));
        assert_eq!(beside(Some((99, 1.0)), None), Some(0.03));
        assert_eq!(beside(Some((50, 3.0)), None), Some(0.006));
        assert_eq!(beside(Some((50, 0.0)), None), None);
    }

    /// A level a thousand times better than it must be does not say where the limits are.
    #[test]
    fn a_guess_goes_no_farther_than_half_of_the_triangles() {
        let next = |guesses| {
            guess(
                (Some((10, 0.001)), None),
                (1.0, 0.006),
                (0, guesses),
                11..300,
            )
        };
        assert_eq!([next(1), next(2)], [42, 74]);
    }

    /// Of a level a fifth beyond the limits sixteen steps should be enough, and four more are; none before the first.
    #[test]
    fn after_a_level_beyond_the_limits_a_finer_one_is_tried() {
        let beyond = (60, 1.22);
        assert_eq!(finer_than(beyond, USUAL_SLOPE, &(0..60)), Some((40, 0.0)));
        assert_eq!(finer_than(beyond, USUAL_SLOPE, &(41..60)), None);
        assert_eq!(finer_than((10, 1.22), USUAL_SLOPE, &(0..10)), None);
    }
}
