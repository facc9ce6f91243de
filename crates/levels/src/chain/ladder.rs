//! The search for the lightest level within the limits.

use std::collections::BTreeMap;
use std::ops::Range;

use secateur_simplify::whole::{Budget, Sharing};
use secateur_simplify::{Observer, Work};

use super::cards::FAR_PX;
use super::error::ChainError;
use super::goals::Goals;
use super::maker::{Made, Maker};
use super::memory::most_kept;
use super::next_step::{FINER_BY, Tried, USUAL_SLOPE, finer_than, guess, slope_beside};
use super::placed::{Place, Placed};
use super::textures::Client;

/// How many steps halve the triangles: from step to step there are 2 % fewer.
pub(super) const STEPS_A_HALF: usize = 32;

/// The number of shares of all triangles among which levels are sought. Step 0 is the tree as it is; the last has
/// .1 % of all.
const STEPS: usize = 10 * STEPS_A_HALF + 1;

/// A search ends where the next level to try is fewer steps from what is known to do.
const LEAST_GAIN: usize = 4;

/// A level that reaches this share of what is allowed is light enough.
const ENOUGH: f64 = 0.85;

/// A level that reaches this share of the goal of a search ends it.
const NEAR: f64 = 0.95;

/// And where the goal is a guess.
const NEAR_FIRST: f64 = 0.85;

/// The step that is tried first where nothing is known: a third of all triangles.
const FIRST: usize = 51;

/// Other sharings are tried this many steps further on: of 2 % each, they come to 12 % fewer triangles.
const BETTER_BY: usize = 6;

/// Levels of shares of all triangles, made as they are asked for.
pub(super) struct Ladder<'a, 'm> {
    maker: &'m Maker<'a>,
    client: &'m Client<'m>,
    /// By step and place in `sharings`.
    made: BTreeMap<(usize, usize), Made>,
    /// How triangles may be shared.
    sharings: Vec<Sharing>,
    work: Work,
    /// The place in `sharings` of how they are.
    sharing: usize,
    steps: usize,
    goals: Goals,
    /// By how much the logarithm of the difference rose from step to step where that was last seen.
    slope: f64,
}

impl<'a, 'm> Ladder<'a, 'm> {
    pub(super) fn new(maker: &'m Maker<'a>, client: &'m Client<'m>) -> Self {
        // Wood that stays as it is ends the ladder above it.
        let least = maker.least_triangles();
        let has_more = |step: &usize| triangles_of(*step, maker.all) > least;
        let work = maker.options.leaves.effort.work();
        Self {
            maker,
            client,
            made: BTreeMap::new(),
            sharings: maker.sharings(work.sharings),
            sharing: 0,
            slope: USUAL_SLOPE,
            steps: (0..STEPS).take_while(has_more).count().max(1),
            goals: Goals::of(work.search_px),
            work,
        }
    }

    /// From now on levels have only what this one has; anything where there is none.
    pub(super) fn nest_in(&mut self, finer: Option<&Made>) {
        self.made.clear();
        self.maker.nest_in(finer);
    }

    /// The level with the fewest triangles within the limits, or hardly more, at the first of these heights, where it
    /// begins, and about so at the others, where it may have to serve too; and its step. None if no step from `first` on
    /// is. `end_px` is where it is seen last.
    pub(super) fn lightest(
        &mut self,
        heights: &[f64],
        end_px: f64,
        (first, is_finest): (usize, bool),
        observer: &mut Observer<'_>,
    ) -> Result<Option<(usize, Placed)>, ChainError> {
        if self.sharings[0] == Sharing::Evenly {
            // Which sharing looks best of a few large pieces changes from height to height.
            self.sharing = 0;
        }
        let mut steps = first..self.steps;
        let mut best: Option<(usize, Placed)> = None;
        let mut beyond: Option<Tried> = None;
        let mut guess = match is_finest {
            true => FIRST,
            // Whether any level pays is known from the finest that would.
            false => first,
        };
        if let Some(step) = self.learn_goal(heights, steps.clone(), guess, observer)? {
            guess = step;
        }
        for _ in 0..self.work.placed {
            let found = self.coarsest(heights, steps.clone(), guess, observer)?;
            let slope = self.slope;
            let finer = || finer_than(beyond?, slope, &steps);
            // Pictures of its size take longer than a step or two are worth.
            let pays = |step: usize| {
                best.as_ref()
                    .is_none_or(|(best, _)| step >= best + LEAST_GAIN)
            };
            let Some((step, in_search)) = found.or_else(finer).filter(|(step, _)| pays(*step))
            else {
                break;
            };
            let made = self.level(step, observer)?.clone();
            let place = Place {
                range: [heights[0], end_px],
                is_first: is_finest,
                goal: self.goals.at(heights[0]),
            };
            let placed = self.maker.placed(made, place, self.client, observer)?;
            let over = placed.difference.over(self.maker.look.limits);
            if over <= 1.0 {
                best = Some((step, placed));
                steps.start = step + 1;
            } else {
                steps.end = step.saturating_sub(FINER_BY - 1).max(steps.start);
                beyond = Some((step, over));
            }
            // What pictures of its size, with its own textures, show beyond those of the search is about the same for
            // others.
            if over > 0.0 && in_search > 0.0 {
                self.goals.learn(heights[0], over / in_search);
            }
            // What serves at further heights, too, is mostly no lighter for those than it must be.
            let is_enough = over >= ENOUGH || heights.len() > 1;
            if steps.is_empty() || over <= 1.0 && is_enough {
                break;
            }
            guess = step;
        }
        Ok(best)
    }

    /// Where it is not known how much more large pictures show, learns it of the coarsest of some steps that would
    /// usually do; and which step that is.
    fn learn_goal(
        &mut self,
        heights: &[f64],
        steps: Range<usize>,
        first: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<usize>, ChainError> {
        if self.goals.are_known(heights[0]) {
            return Ok(None);
        }
        let found = self.coarsest_so_shared(heights, steps, (first, None), observer)?;
        let Some((step, _)) = found else {
            return Ok(None);
        };
        let look = &self.maker.look;
        let drawn = &self.level(step, observer)?.drawn;
        if let Some(times) = look.times_in_search(drawn, heights[0]) {
            self.goals.learn(heights[0], times);
        }
        Ok(Some(step))
    }

    /// A level where it is larger, at a height and down to another, if it is within the limits there too.
    pub(super) fn also_at(
        &self,
        level: &Placed,
        (height, end_px, is_first): (f64, f64, bool),
        observer: &mut Observer<'_>,
    ) -> Result<Option<Placed>, ChainError> {
        let (look, goal) = (&self.maker.look, self.goals.at(height));
        if look.over_in_search(&level.made.drawn, height) > goal {
            return Ok(None);
        }
        let place = Place {
            range: [height, end_px],
            is_first,
            goal,
        };
        let made = level.made.clone();
        let placed = self.maker.placed(made, place, self.client, observer)?;
        Ok((placed.difference.over(look.limits) <= 1.0).then_some(placed))
    }

    /// The coarsest of some steps that does in the pictures of a search, however triangles are shared, and how many
    /// times the limits it is there; none if none does. It is the level of its step until another place is sought.
    fn coarsest(
        &mut self,
        heights: &[f64],
        steps: Range<usize>,
        first: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Tried>, ChainError> {
        let best = self.coarsest_so_shared(heights, steps.clone(), (first, None), observer)?;
        // Of few pixels no other sharing shows enough to be worth the time, unless so shared none does.
        if heights[0] <= FAR_PX && best.is_some() {
            return Ok(best);
        }
        let next = best.map_or(steps.start, |(step, _)| step + BETTER_BY);
        if next >= steps.end {
            return Ok(best);
        }
        let Some(over) = self.share_better(heights, next, observer)? else {
            return Ok(best);
        };
        let known = (next, Some((next, over)));
        self.coarsest_so_shared(heights, steps, known, observer)
    }

    /// Shares triangles otherwise, as does best at a step, and how many times the limits the level is then; nothing, and
    /// no other sharing, where no other does.
    fn share_better(
        &mut self,
        heights: &[f64],
        step: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<f64>, ChainError> {
        let (before, goal) = (self.sharing, self.goals.at(heights[0]));
        let mut best: Option<(usize, f64)> = None;
        for sharing in (0..self.sharings.len()).filter(|sharing| *sharing != before) {
            self.sharing = sharing;
            let over = self.over(step, heights, observer)?;
            if over <= best.map_or(goal, |(_, least)| least) {
                best = Some((sharing, over));
            }
        }
        self.sharing = best.map_or(before, |(sharing, _)| sharing);
        Ok(best.map(|(_, over)| over))
    }

    /// The coarsest of some steps that does, with triangles shared as they are; beginning with a step, or with one that is
    /// known to do.
    fn coarsest_so_shared(
        &mut self,
        heights: &[f64],
        steps: Range<usize>,
        (first, known): (usize, Option<Tried>),
        observer: &mut Observer<'_>,
    ) -> Result<Option<Tried>, ChainError> {
        let (mut within, mut beyond): (Option<Tried>, Option<Tried>) = (known, None);
        let goal = self.goals.at(heights[0]);
        let near = if self.goals.are_known(heights[0]) {
            NEAR
        } else {
            NEAR_FIRST
        };
        for guesses in 0.. {
            let low = within.map_or(steps.start, |(step, _)| step + 1);
            let high = beyond.map_or(steps.end, |(step, _)| step);
            let is_near = within.is_some() && high < low + LEAST_GAIN;
            let is_enough = within.is_some_and(|(_, over)| over >= near * goal);
            if low >= high || is_near || is_enough {
                break;
            }
            let known = (within, beyond);
            let next = guess(known, (goal, self.slope), (first, guesses), low..high);
            let over = self.over(next, heights, observer)?;
            self.slope = slope_beside(known, (next, over)).unwrap_or(self.slope);
            match over <= goal {
                true => within = Some((next, over)),
                false => beyond = Some((next, over)),
            }
        }
        Ok(within)
    }

    /// How many times the limits a level is in the pictures of a search: at the first height as its goal has it, at the
    /// others as it is.
    fn over(
        &mut self,
        step: usize,
        heights: &[f64],
        observer: &mut Observer<'_>,
    ) -> Result<f64, ChainError> {
        let (look, goal) = (&self.maker.look, self.goals.at(heights[0]));
        let level = self.level(step, observer)?;
        if level.triangles() == 0 {
            // Where nothing of the plant is seen it would look alike.
            return Ok(f64::INFINITY);
        }
        let drawn = &level.drawn;
        let mut over = look.over_in_search(drawn, heights[0]);
        for height in &heights[1..] {
            if over > goal {
                break;
            }
            over = over.max(goal * look.over_in_search(drawn, *height));
        }
        Ok(over)
    }

    /// The level of a step.
    fn level(&mut self, step: usize, observer: &mut Observer<'_>) -> Result<&Made, ChainError> {
        let key = (step, self.sharing);
        if !self.made.contains_key(&key) {
            let budget = Budget {
                triangles: triangles_of(step, self.maker.all),
                sharing: self.sharings[self.sharing],
            };
            let made = self.maker.level(budget, observer)?;
            // What is known of an equal level is known of this one.
            let others = self.made.range((step, 0)..(step + 1, 0));
            let equal = others
                .map(|(_, other)| other)
                .find(|other| other.lod == made.lod);
            let made = equal.cloned().unwrap_or(made);
            self.made.insert(key, made);
            self.forget_far_from(key);
        }
        Ok(&self.made[&key])
    }

    /// Drops levels while they are more than memory is taken for, those first that are most steps away.
    fn forget_far_from(&mut self, (step, sharing): (usize, usize)) {
        let most = most_kept(self.maker.all);
        let mut kept: usize = self.made.values().map(Made::triangles).sum();
        while kept > most && self.made.len() > 1 {
            let others = self.made.keys().filter(|key| **key != (step, sharing));
            let farthest = others.max_by_key(|(other, _)| other.abs_diff(step));
            let farthest = *farthest.expect("one beside it");
            let gone = self.made.remove(&farthest);
            kept -= gone.map_or(0, |made| made.triangles());
        }
    }
}

/// The first step whose levels have at most this share of the triangles that a step has.
pub(super) fn step_of_share(share: f64, of_step: usize) -> usize {
    of_step + (-share.log2() * STEPS_A_HALF as f64).ceil() as usize
}

/// How many triangles a step has of all.
fn triangles_of(step: usize, all: usize) -> usize {
    let share = (-(step as f64) / STEPS_A_HALF as f64).exp2();
    (share * all as f64).round() as usize
}

#[cfg(test)]
mod tests;
