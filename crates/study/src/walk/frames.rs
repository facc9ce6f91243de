//! The frames of a walk: what is drawn in each, and how far that is from full geometry.

use rayon::prelude::*;
use secateur_eval::{JudgedStand, StandCamera, StandPicture, StandPlace};

use super::levels::{Drawable, LevelsBy, Plants, range_at};
use super::panorama::Panorama;
use super::scene::{Spot, camera, is_in_view, spots};
use crate::Error;

/// The height of frames in pixels; 16 samples each.
pub(super) const HEIGHT_PX: u32 = 180;

/// What is drawn in every frame beside full geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Case {
    pub(super) by: LevelsBy,
    /// Whether what is always beyond the last range is a panorama behind the rest.
    pub(super) has_panorama: bool,
}

impl Case {
    /// Levels alone, then with the panorama.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let of = |has_panorama| LevelsBy::ALL.map(|by| Self { by, has_panorama });
        of(false).into_iter().chain(of(true))
    }
}

/// What a case draws in a frame.
pub(super) struct Drawn {
    pub(super) picture: StandPicture,
    /// Of the plants that may be in view.
    pub(super) leaves: u64,
    pub(super) triangles: u64,
}

/// What came of a case in a frame.
pub(super) struct Outcome {
    pub(super) drawn: Drawn,
    /// FLIP against full geometry, over the frame.
    pub(super) flip: f64,
    /// How many plants have got another level since the frame before.
    pub(super) switches: u64,
    /// FLIP between the frame before and this; none of the first.
    pub(super) step: Option<f64>,
    /// FLIP of the frame against itself with the levels of the frame before: what is seen of the switches alone. None
    /// where nothing has switched.
    pub(super) pop: Option<f64>,
}

/// A frame of the walk: full geometry, and what each way of making levels shows there.
pub(super) struct Frame {
    pub(super) original: Drawn,
    /// FLIP of full geometry between the frame before and this; none of the first.
    pub(super) step_original: Option<f64>,
    /// One outcome for each of [`Case::all`], in that order.
    pub(super) outcomes: Vec<Outcome>,
}

/// Draws frames, one after another.
pub(super) struct Walker {
    plants: Plants,
    spots: Vec<Spot>,
    pub(super) panorama: Panorama,
    /// The frame before: what was drawn, full geometry first, and the range of each spot.
    before: Option<(Vec<JudgedStand>, Vec<usize>)>,
}

impl Walker {
    pub(super) fn new() -> Result<Self, Error> {
        let plants = Plants::grow()?;
        let spots = spots();
        let far = spots.iter().filter(|spot| spot.is_backdrop);
        let places: Vec<StandPlace<'_>> = far
            .map(|spot| placed(spot, &plants.originals[spot.kind]))
            .collect();
        // As fine as frames are.
        let panorama = Panorama::of(&places, HEIGHT_PX * 6 / 5);
        Ok(Self {
            plants,
            spots,
            panorama,
            before: None,
        })
    }

    /// The leaves of all that stands in the woods.
    pub(super) fn leaves(&self) -> u64 {
        let leaves = |spot: &Spot| self.plants.originals[spot.kind].leaves;
        self.spots.iter().map(leaves).sum()
    }

    /// The next frame; they are numbered from 0.
    pub(super) fn frame(&mut self, number: usize) -> Frame {
        let camera = camera(number);
        let range_of = |spot: &Spot| {
            let middle = self.plants.originals[spot.kind].kind.middle();
            let middle = spot.world_from_own.transform_point3(middle);
            range_at(middle.distance(camera.eye))
        };
        let ranges: Vec<usize> = self.spots.iter().map(range_of).collect();
        let before = self.before.take();
        let old_ranges = before.as_ref().map_or(&ranges, |(_, ranges)| ranges);
        let switches = (ranges.iter().zip(old_ranges))
            .filter(|(a, b)| a != b)
            .count();
        let plain = StandPicture::of(&[], &camera, HEIGHT_PX).image;
        let behind = self.panorama.seen_by(&camera, &plain);
        let draw = |case: Option<Case>, ranges: &[usize]| {
            let mut drawn = self.drawn(case, ranges, &camera);
            if case.is_some_and(|case| case.has_panorama) {
                drawn.picture = drawn.picture.before(&behind, &plain);
            }
            drawn
        };
        let cases: Vec<Option<Case>> = [None].into_iter().chain(Case::all().map(Some)).collect();
        let drawn = cases.par_iter().map(|case| draw(*case, &ranges));
        let mut drawn: Vec<Drawn> = drawn.collect();
        let judges = drawn
            .par_iter()
            .map(|d| JudgedStand::new(d.picture.clone()));
        let judges: Vec<JudgedStand> = judges.collect();
        let step = |k: usize| {
            let (before, _) = before.as_ref()?;
            Some(before[k].difference(&judges[k].picture).flip_mean)
        };
        let judged = |k: usize| {
            let pop = (switches > 0).then(|| {
                let old = draw(cases[k], old_ranges).picture;
                judges[k].difference(&old).flip_mean
            });
            let flip = judges[0].difference(&judges[k].picture).flip_mean;
            (flip, step(k), pop)
        };
        let found: Vec<_> = (1..cases.len()).into_par_iter().map(judged).collect();
        let step_original = step(0);
        let original = drawn.remove(0);
        let outcomes = drawn.into_iter().zip(found);
        let outcomes = outcomes.map(|(drawn, (flip, step, pop))| Outcome {
            drawn,
            flip,
            switches: switches as u64,
            step,
            pop,
        });
        let outcomes = outcomes.collect();
        self.before = Some((judges, ranges));
        Frame {
            original,
            step_original,
            outcomes,
        }
    }

    /// All plants as they are, or what a case has for their ranges.
    fn drawn(&self, case: Option<Case>, ranges: &[usize], camera: &StandCamera) -> Drawn {
        let mut places = Vec::new();
        let (mut leaves, mut triangles) = (0, 0);
        for (spot, range) in self.spots.iter().zip(ranges) {
            let what = match case {
                Some(case) if case.has_panorama && spot.is_backdrop => continue,
                Some(case) => self.plants.level(case.by, spot.kind, *range),
                None => &self.plants.originals[spot.kind],
            };
            let middle = spot.world_from_own.transform_point3(what.kind.middle());
            // Half the diagonal of a cube is the most that a box of its size reaches.
            let radius = 0.5 * 3.0_f64.sqrt() * what.kind.size();
            if is_in_view(camera, middle, radius) {
                places.push(placed(spot, what));
                leaves += what.leaves;
                triangles += what.triangles;
            }
        }
        Drawn {
            picture: StandPicture::of(&places, camera, HEIGHT_PX),
            leaves,
            triangles,
        }
    }
}

fn placed<'a>(spot: &Spot, what: &'a Drawable) -> StandPlace<'a> {
    StandPlace {
        kind: &what.kind,
        world_from_own: spot.world_from_own,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(threads: usize) -> Vec<Frame> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let mut walker = Walker::new().unwrap();
            (0..3).map(|number| walker.frame(number)).collect()
        })
    }

    /// A step of none has neither step nor pop; the light scheme draws less; threads change nothing.
    #[test]
    fn frames_are_the_same_whatever_the_threads() {
        let [alone, many] = [1, 4].map(frames);
        for (number, (a, b)) in alone.iter().zip(&many).enumerate() {
            assert_eq!(
                (a.step_original, number > 0),
                (b.step_original, a.step_original.is_some())
            );
            for (a, b) in a.outcomes.iter().zip(&b.outcomes) {
                let facts = |o: &Outcome| (o.drawn.triangles, o.flip, o.switches, o.step, o.pop);
                assert_eq!(facts(a), facts(b));
                assert_eq!(
                    (a.step.is_some(), a.pop.is_some()),
                    (number > 0, a.switches > 0)
                );
                assert!(a.flip > 0.0);
            }
            let triangles = |k: usize| a.outcomes[k].drawn.triangles;
            assert!(triangles(0) < triangles(1) && triangles(1) < a.original.triangles);
            // The backdrop is drawn once for all.
            assert!(triangles(3) < triangles(0));
        }
        assert!(alone.iter().any(|frame| frame.outcomes[0].switches > 0));
    }
}
