//! The search for the lightest level within a difference.

use secateur_simplify::Observer;

use super::error::ChainError;
use super::maker::{Made, Maker};

/// How many shares of all triangles levels for heights are sought among, each the fourth root of a
/// half of the one before. The first is the tree as it is, for heights at which nothing less will
/// do; the last has .78 % of all.
const RUNGS: usize = 29;

/// The rung that is tried first, of a tenth of all triangles: levels at which pictures of 256
/// pixels differ by .05 have a tenth to a quarter on the trees that it was tried with.
const FIRST: usize = 13;

/// By how much the logarithm of FLIP rises from rung to rung, until two rungs tell.
const USUAL_SLOPE: f64 = 0.1;

/// By how much the logarithm of FLIP may be guessed to be above that of what is allowed before a
/// level is not worth making to see: 5 %.
const NOT_WORTH_A_TRY: f64 = 0.05;

/// Levels of shares of all triangles, made as they are asked for.
pub(super) struct Ladder<'a, 'm> {
    maker: &'m Maker<'a>,
    made: Vec<Option<Made>>,
    /// By how much the logarithm of FLIP rises from rung to rung, once two rungs have told.
    slope: Option<f64>,
}

/// A rung, and the logarithm of the FLIP of its level over that which is allowed.
type Tried = (usize, f64);

impl<'a, 'm> Ladder<'a, 'm> {
    pub(super) fn new(maker: &'m Maker<'a>) -> Self {
        // Wood that stays as it is ends the ladder above it.
        let least = maker.least_triangles();
        let has_more = |rung: &usize| triangles_of(*rung, maker.all) > least;
        let rungs = (0..RUNGS).take_while(has_more).count().max(1);
        Self {
            maker,
            made: vec![None; rungs],
            slope: None,
        }
    }

    /// The level of a rung.
    pub(super) fn level(
        &mut self,
        rung: usize,
        observer: &mut Observer<'_>,
    ) -> Result<&Made, ChainError> {
        let made = &mut self.made[rung];
        Ok(match made.take() {
            Some(level) => made.insert(level),
            None => {
                let triangles = triangles_of(rung, self.maker.all);
                made.insert(self.maker.level(triangles, observer)?)
            }
        })
    }

    /// The rung with the fewest triangles within the difference at a height, `first` or a coarser
    /// one; `first` if none is within it. What has fewer triangles is taken to differ more, and
    /// where the difference is crossed is guessed from what was tried.
    pub(super) fn lightest(
        &mut self,
        height: f64,
        first: usize,
        observer: &mut Observer<'_>,
    ) -> Result<usize, ChainError> {
        let (mut within, mut beyond): (Option<Tried>, Option<Tried>) = (None, None);
        // What was made for other heights is there to be looked at.
        let rungs = self.made.len();
        let there: Vec<usize> = (first..rungs).filter(|k| self.made[*k].is_some()).collect();
        let mut there = there.into_iter().rev();
        loop {
            let (low, high) = (
                within.map_or(first, |(rung, _)| rung + 1),
                beyond.map_or(rungs, |(rung, _)| rung),
            );
            if low >= high {
                return Ok(within.map_or(first, |(rung, _)| rung));
            }
            let next = there.find(|rung| (low..high).contains(rung));
            if next.is_none()
                && let Some((rung, over)) = within
                && over + self.slope.unwrap_or(USUAL_SLOPE) > NOT_WORTH_A_TRY
            {
                return Ok(rung);
            }
            let slope = self.slope.unwrap_or(USUAL_SLOPE);
            let rung = next.unwrap_or_else(|| guess(within, beyond, slope, low, high));
            let maker = self.maker;
            let flip = maker.flip(self.level(rung, observer)?, height);
            let over = (flip / maker.options.max_flip).max(f64::MIN_POSITIVE).ln();
            let before = match over <= 0.0 {
                true => within.replace((rung, over)),
                false => beyond.replace((rung, over)),
            };
            if let Some((other, over_there)) = before.or(match over <= 0.0 {
                true => beyond,
                false => within,
            }) {
                let measured = (over - over_there) / (rung as f64 - other as f64);
                // Levels may differ for other reasons too.
                if measured.is_finite() {
                    let range = USUAL_SLOPE / 4.0..=USUAL_SLOPE * 4.0;
                    self.slope = Some(measured.clamp(*range.start(), *range.end()));
                }
            }
        }
    }
}

/// How many triangles a rung has of all.
fn triangles_of(rung: usize, all: usize) -> usize {
    let share = (-0.25 * rung as f64).exp2();
    (share * all as f64).round() as usize
}

/// The next rung to try, of `low..high`.
fn guess(
    within: Option<Tried>,
    beyond: Option<Tried>,
    slope: f64,
    low: usize,
    high: usize,
) -> usize {
    let at = match (within, beyond) {
        (Some((rung, over)), _) => rung as f64 - over / slope,
        (None, Some((rung, over))) => rung as f64 - over / slope,
        (None, None) => return FIRST.clamp(low, high - 1),
    };
    // The last rung that should be within it.
    (at.floor().max(0.0) as usize).clamp(low, high - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_rung_is_where_the_difference_should_be_crossed() {
        assert_eq!(guess(None, None, 0.1, 0, RUNGS), FIRST);
        assert_eq!(guess(None, None, 0.1, 14, RUNGS), 14);
        // Three tenths too much are three rungs finer, as much to spare three coarser.
        assert_eq!(guess(None, Some((10, 0.31)), 0.1, 0, 10), 6);
        assert_eq!(guess(Some((10, -0.31)), None, 0.1, 11, RUNGS), 13);
        // It never leaves the rungs between what is within and what is beyond.
        assert_eq!(guess(Some((4, -0.01)), Some((9, 0.9)), 0.1, 5, 9), 5);
        assert_eq!(guess(Some((4, -0.9)), Some((9, 0.01)), 0.1, 5, 9), 8);
        assert_eq!(guess(None, Some((3, 9.0)), 0.1, 0, 3), 0);
        assert_eq!(guess(Some((3, -9.0)), None, 0.1, 4, RUNGS), RUNGS - 1);
    }
}
