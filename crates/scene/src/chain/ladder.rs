//! The search for the lightest level within a difference.

use std::collections::BTreeMap;

use secateur_simplify::Observer;

use super::error::ChainError;
use super::maker::{Made, Maker};

/// How many steps halve the triangles: from step to step there are 2 % fewer.
const STEPS_A_HALF: usize = 32;

/// The number of shares of all triangles among which levels for heights are sought. Step 0 is the tree as it is, for
/// heights at which nothing less will do; the last has .78 % of all.
const STEPS: usize = 7 * STEPS_A_HALF + 1;

/// The step that is tried first, of a tenth of all triangles: levels at which pictures of 256
/// pixels differ by .02 have a tenth to a quarter on the trees that it was tried with.
const FIRST: usize = 104;

/// How many steps coarser a level must be to save a third: to switch for less would not pay.
pub(super) const STEPS_THAT_PAY: usize = 19;

/// By how much the logarithm of FLIP rises from step to step, until two levels tell.
const USUAL_SLOPE: f64 = 0.0125;

/// The next level is not made if it should be fewer steps coarser: it takes as long as any.
const LEAST_GAIN: usize = 2;

/// So far below what is allowed the next level is aimed, as FLIP is not as smooth as a line.
const AIM: f64 = 0.012;

/// The least number of steps by which the search goes back from a level that differs too much: with
/// fewer it would creep.
const LEAST_BACK: f64 = 2.0;

/// The most levels that are made for the same heights after one was within the difference.
const MORE_TRIALS: usize = 3;

/// Levels of shares of all triangles, made as they are asked for.
pub(super) struct Ladder<'a, 'm> {
    maker: &'m Maker<'a>,
    made: BTreeMap<usize, Made>,
    steps: usize,
    /// By how much the logarithm of FLIP rises from step to step, once two levels have told.
    slope: Option<f64>,
}

/// A step, and the logarithm of the FLIP of its level over that which is allowed.
type Tried = (usize, f64);

impl<'a, 'm> Ladder<'a, 'm> {
    pub(super) fn new(maker: &'m Maker<'a>) -> Self {
        // Wood that stays as it is ends the ladder above it.
        let least = maker.least_triangles();
        let has_more = |step: &usize| triangles_of(*step, maker.all) > least;
        Self {
            maker,
            made: BTreeMap::new(),
            steps: (0..STEPS).take_while(has_more).count().max(1),
            slope: None,
        }
    }

    /// The level of a step.
    pub(super) fn level(
        &mut self,
        step: usize,
        observer: &mut Observer<'_>,
    ) -> Result<&Made, ChainError> {
        if !self.made.contains_key(&step) {
            let triangles = triangles_of(step, self.maker.all);
            let made = self.maker.level(triangles, observer)?;
            self.made.insert(step, made);
        }
        Ok(&self.made[&step])
    }

    /// The step with the fewest triangles within the difference at all these heights, or hardly more; `first` if
    /// none of it and the `pays_from` coarser ones on is within it. What has fewer triangles is taken to
    /// differ more, and where the difference is crossed is guessed from what was tried.
    pub(super) fn lightest(
        &mut self,
        heights: &[f64],
        first: usize,
        pays_from: usize,
        observer: &mut Observer<'_>,
    ) -> Result<usize, ChainError> {
        let (mut within, mut beyond): (Option<Tried>, Option<Tried>) = (None, None);
        let mut more = 0;
        // What was made for other heights is there to be looked at.
        let there: Vec<usize> = self.made.range(first..).map(|(step, _)| *step).collect();
        let mut there = there.into_iter().rev();
        loop {
            let low = within.map_or(first, |(step, _)| step + 1);
            let high = beyond.map_or(self.steps, |(step, _)| step);
            let pays = low.max(pays_from);
            if low >= high || (within.is_some() && pays >= high) {
                return Ok(within.map_or(first, |(step, _)| step));
            }
            let slope = self.slope.unwrap_or(USUAL_SLOPE);
            let next = match there.find(|step| (low..high).contains(step)) {
                Some(step) => step,
                None => {
                    let next = guess(within, beyond, slope, low, high);
                    if let Some((step, over)) = within {
                        let is_enough = over > -AIM || next < step + LEAST_GAIN;
                        if is_enough || more == MORE_TRIALS {
                            return Ok(step);
                        }
                        more += 1;
                    }
                    next
                }
            };
            let maker = self.maker;
            let level = self.level(next, observer)?;
            let flips = heights.iter().map(|height| maker.flip(level, *height));
            let flip = flips.fold(0.0, f64::max);
            let over = (flip / maker.options.max_flip).max(f64::MIN_POSITIVE).ln();
            let before = match over <= 0.0 {
                true => within.replace((next, over)),
                false => beyond.replace((next, over)),
            };
            if let Some((other, over_there)) = before.or(match over <= 0.0 {
                true => beyond,
                false => within,
            }) {
                let measured = (over - over_there) / (next as f64 - other as f64);
                // Levels may differ for other reasons too.
                if measured.is_finite() {
                    let range = USUAL_SLOPE / 4.0..=USUAL_SLOPE * 4.0;
                    self.slope = Some(measured.clamp(*range.start(), *range.end()));
                }
            }
        }
    }
}

/// How many triangles a step has of all.
fn triangles_of(step: usize, all: usize) -> usize {
    let share = (-(step as f64) / STEPS_A_HALF as f64).exp2();
    (share * all as f64).round() as usize
}

/// The next step to try, of `low..high`.
fn guess(
    within: Option<Tried>,
    beyond: Option<Tried>,
    slope: f64,
    low: usize,
    high: usize,
) -> usize {
    let at = match (within, beyond) {
        (Some((fine, under)), Some((coarse, over))) => {
            let between = (-AIM - under) / (over - under);
            fine as f64 + between * (coarse - fine) as f64
        }
        (Some((step, over)), None) => step as f64 - (over + AIM) / slope,
        (None, Some((step, over))) => step as f64 - ((over + AIM) / slope).max(LEAST_BACK),
        (None, None) => FIRST as f64,
    };
    // The last step that should be within it.
    (at.floor().max(0.0) as usize).clamp(low, high - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_step_is_where_the_difference_should_be_crossed() {
        assert_eq!(guess(None, None, 0.0125, 0, STEPS), FIRST);
        assert_eq!(guess(None, None, 0.0125, 110, STEPS), 110);
        // What is .3 above and as much below what it is aimed at is 24 steps off.
        assert_eq!(guess(None, Some((80, 0.3 - AIM)), 0.0125, 0, 80), 56);
        assert_eq!(guess(Some((80, -0.3 - AIM)), None, 0.0125, 81, STEPS), 104);
        // A hair too much is no reason to creep.
        assert_eq!(guess(None, Some((80, 0.001)), 0.0125, 0, 80), 78);
        // Between two it is where a line crosses, and never beyond what is known.
        let [fine, coarse] = [(40, -0.1 - AIM), (60, 0.3 - AIM)];
        assert_eq!(guess(Some(fine), Some(coarse), 9.0, 41, 60), 45);
        assert_eq!(guess(Some((4, -0.01)), Some((9, 0.9)), 0.0125, 5, 9), 5);
        assert_eq!(guess(Some((4, -0.9)), Some((9, 0.01)), 0.0125, 5, 9), 8);
        assert_eq!(guess(None, Some((3, 9.0)), 0.0125, 0, 3), 0);
        assert_eq!(guess(Some((3, -9.0)), None, 0.0125, 4, STEPS), STEPS - 1);
    }

    #[test]
    fn steps_that_pay_save_a_third() {
        let left = |steps: usize| triangles_of(steps, 1_000_000);
        assert!(left(STEPS_THAT_PAY) <= 666_667 && left(STEPS_THAT_PAY - 1) > 666_667);
        assert_eq!(
            [left(0), left(32), left(STEPS - 1)],
            [1_000_000, 500_000, 7813]
        );
    }
}
