//! How many cards it takes to look like a plant.

use std::collections::BTreeMap;

use secateur_eval::Pictures;
use secateur_model::Surface;
use secateur_simplify::{Error, Observer};

use super::cards::Cards;
use super::judge::Judge;
use super::{Impostor, poll};

/// The fewest cards that are tried.
const LEAST: f64 = 8.0;

/// How many times as many each next number has.
const STEP: f64 = 1.25;

/// How many numbers there are: the largest is 867.
const STEPS: usize = 22;

/// FLIP falls about as the number of cards to this power, by which the next number to try is guessed.
const POWER: f64 = 0.2;

/// With FLIP that falls as fast as that there is no hope, if there is none.
const BEST_POWER: f64 = 0.35;

/// The step that tells whether there is hope: 60 cards.
const FEW: usize = 9;

/// The height in pixels for which cards of a search are baked, at most: in its pictures of 256 pixels a side their
/// texels are a pixel long, as finer ones would take four times as long.
const SEARCH_PX: f64 = 128.0;

/// The most pixels a side of the pictures that what is found is judged by.
const MOST_PICTURE_PX: f64 = 1024.0;

/// What is this many times what is wanted in one view is so in all.
const HOPELESS: f64 = 1.2;

/// The most pixels that a texel of cards may be long where they begin to be seen: longer ones look blurred.
const COARSEST_PX: f64 = 2.0;

/// Where an atlas has no room for a number of cards, the number three steps below is tried: about half.
const FEWER: usize = 3;

/// Normals of half the size do if FLIP is at most this many times what it is with all.
const AS_NEAR: f64 = 1.01;

/// How often a number of cards that turns out not to be enough at its size is raised.
const MORE: usize = 3;

/// The most cards there are.
pub fn most() -> usize {
    number(STEPS - 1)
}

/// The numbers that are tried, from few to many.
fn number(step: usize) -> usize {
    (LEAST * STEP.powi(step as i32)).round() as usize
}

/// Cards that were found for a place.
pub struct Found {
    /// The cards with their pictures.
    pub impostor: Impostor,
    /// Mean FLIP against the plant at that place, 0 to 1.
    pub flip: f64,
}

/// A plant from where cards are looked at.
pub struct Seen {
    judge: Judge,
    /// The plant from there.
    original: Pictures,
    /// A judge from one view alone in which the plant is seen, and the plant from there.
    one: (Judge, Pictures),
    /// The same in larger pictures, where the screen shows it so large.
    large: Option<(Judge, Pictures)>,
    /// How high the screen shows the plant, in pixels.
    pixels_high: f64,
}

impl Seen {
    /// What a judge sees of a plant where the screen shows it at this height.
    pub fn new(surfaces: &[Surface], judge: Judge, pixels_high: f64) -> Self {
        let original = judge.of_surfaces(surfaces);
        let one = judge.from_one_that_sees(&original);
        let large = one.from_one().in_pictures_of_at_most(MOST_PICTURE_PX);
        let with_original = |judge: Judge| {
            let original = judge.of_surfaces(surfaces);
            (judge, original)
        };
        Self {
            large: (large.side() > one.side()).then(|| with_original(large)),
            one: with_original(one),
            original,
            judge,
            pixels_high,
        }
    }

    /// FLIP of an impostor in the usual pictures.
    fn flip(&self, impostor: &Impostor) -> f64 {
        self.judge
            .flip(&self.original, &self.judge.of_impostor(impostor))
    }

    /// FLIP in one view.
    fn flip_of_one((judge, original): &(Judge, Pictures), impostor: &Impostor) -> f64 {
        judge.flip(original, &judge.of_impostor(impostor))
    }

    /// FLIP in one view, in pictures as large as the screen shows the plant.
    fn flip_of_one_at_its_size(&self, impostor: &Impostor) -> f64 {
        Self::flip_of_one(self.large.as_ref().unwrap_or(&self.one), impostor)
    }

    /// FLIP as it is in pictures as large as the screen shows the plant.
    pub fn flip_at_its_size(&self, impostor: &Impostor) -> f64 {
        self.at_its_size(self.flip(impostor), impostor)
    }

    /// The same cards with a normal map of half as many texels a side; none if they look farther from the plant, or
    /// have no normal map.
    pub fn with_half_normals(&self, found: &Found) -> Option<Found> {
        let impostor = found.impostor.with_half_normals()?;
        let flip = self.flip_at_its_size(&impostor);
        (flip <= AS_NEAR * found.flip).then_some(Found { impostor, flip })
    }

    /// The same of an impostor with this FLIP in the usual pictures.
    fn at_its_size(&self, flip: f64, impostor: &Impostor) -> f64 {
        if self.large.is_none() {
            return flip;
        }
        let usual = Self::flip_of_one(&self.one, impostor);
        match usual > 0.0 {
            true => flip * self.flip_of_one_at_its_size(impostor) / usual,
            false => flip,
        }
    }
}

/// A search for the fewest cards of a plant, at one place after another.
pub struct Search<'a> {
    surfaces: &'a [Surface],
    sorted: BTreeMap<usize, Cards<'a, Surface>>,
    /// Cards for the pictures of a search, by their height in pixels and step.
    rough: BTreeMap<(u64, usize), Impostor>,
}

impl<'a> Search<'a> {
    /// A search of cards for what is drawn of a plant.
    pub fn new(surfaces: &'a [Surface]) -> Self {
        Self {
            surfaces,
            sorted: BTreeMap::new(),
            rough: BTreeMap::new(),
        }
    }

    /// Whether an atlas has room for any cards where the screen shows the plant at this height.
    pub fn has_room(&mut self, pixels_high: f64) -> bool {
        self.sorted(number(0)).fit(pixels_high, COARSEST_PX)
    }

    /// The fewest cards, at most `most`, whose FLIP is at most `most_flip`, with textures as fine as the place asks for,
    /// and as `finish` makes them; none if there are none. The observer is asked at each number of cards that is sorted
    /// for, baked or looked at.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the observer breaks it off.
    pub fn fewest(
        &mut self,
        seen: &Seen,
        most_flip: f64,
        most: usize,
        finish: impl Fn(Impostor) -> Impostor,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Found>, Error> {
        let all = (0..STEPS).take_while(|step| number(*step) <= most).count();
        if all == 0 {
            return Ok(None);
        }
        // To sort for a few takes a tenth of the time.
        let few = FEW.min(all - 1);
        let best = (number(few) as f64 / number(all - 1) as f64).powf(BEST_POWER);
        let Some(of_few) = self.rough(few, seen, observer)? else {
            return Ok(None);
        };
        if best * Seen::flip_of_one(&seen.one, of_few) > HOPELESS * most_flip {
            return Ok(None);
        }
        let Some(last) = self.last(all, most, seen, observer)? else {
            return Ok(None);
        };
        let Some(rough) = self.rough(last, seen, observer)? else {
            return Ok(None);
        };
        let of_one = Seen::flip_of_one(&seen.one, rough);
        if of_one > HOPELESS * most_flip {
            return Ok(None);
        }
        // What pictures of its size show beyond those of the search is about the same for fewer cards.
        let of_last = seen.flip(rough);
        let at_its_size = |made: &Impostor| match of_one > 0.0 {
            true => of_last * seen.flip_of_one_at_its_size(made) / of_one,
            // Nothing is seen of the plant, or no difference.
            false => of_last,
        };
        poll(observer)?;
        let cards = self.sorted(number(last));
        let Some(fine) = Impostor::cards(cards, seen.pixels_high, COARSEST_PX) else {
            return Ok(None);
        };
        if at_its_size(&fine) > HOPELESS * most_flip {
            return Ok(None);
        }
        poll(observer)?;
        let at_its_size = at_its_size(&finish(fine));
        if at_its_size > most_flip {
            return Ok(None);
        }
        let most_rough = match at_its_size > 0.0 {
            true => of_last * most_flip / at_its_size,
            false => most_flip,
        };
        let Some(step) = self.fewest_rough(last, of_last, seen, most_rough, observer)? else {
            return Ok(None);
        };
        for step in (step..last).take(MORE).chain([last]) {
            let found = self.finished(number(step), seen, COARSEST_PX, &finish, observer)?;
            if let Some(found) = found.filter(|found| found.flip <= most_flip) {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// The last of the first `all` steps whose cards an atlas has room for and are no more than `most`, or one of the
    /// few before it.
    fn last(
        &mut self,
        all: usize,
        most: usize,
        seen: &Seen,
        observer: &mut Observer<'_>,
    ) -> Result<Option<usize>, Error> {
        for step in (0..all).rev().step_by(FEWER).chain([0]) {
            poll(observer)?;
            let cards = self.sorted(number(step));
            // Trunks have more cards than layers.
            if cards.count() <= most && cards.fit(seen.pixels_high, COARSEST_PX) {
                return Ok(Some(step));
            }
        }
        Ok(None)
    }

    /// The least step whose FLIP in the pictures of a search is within a bound, as that of the last one is.
    fn fewest_rough(
        &mut self,
        last: usize,
        of_last: f64,
        seen: &Seen,
        most_flip: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Option<usize>, Error> {
        let mut enough = (last, of_last);
        let mut least = 0;
        while least < enough.0 {
            // As many fewer as the bound leaves room for, at least one step.
            let room = (most_flip / enough.1).ln() / (POWER * STEP.ln());
            let fewer = (room.floor().max(1.0) as usize).min(enough.0 - least);
            let step = enough.0 - fewer;
            let Some(rough) = self.rough(step, seen, observer)? else {
                return Ok(None);
            };
            let flip = seen.flip(rough);
            match flip <= most_flip {
                true => enough = (step, flip),
                false => least = step + 1,
            }
        }
        Ok(Some(enough.0))
    }

    /// This number of cards with textures as fine as the place asks for and an atlas has room for, but not with texels of
    /// more pixels than these; lit by their normals or flat, whichever looks nearer.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the observer breaks it off.
    pub fn finished(
        &mut self,
        count: usize,
        seen: &Seen,
        coarsest_px: f64,
        finish: impl Fn(Impostor) -> Impostor,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Found>, Error> {
        poll(observer)?;
        let cards = self.sorted(count);
        let Some(baked) = Impostor::cards(cards, seen.pixels_high, coarsest_px) else {
            return Ok(None);
        };
        poll(observer)?;
        let impostor = finish(baked);
        poll(observer)?;
        let flat = impostor.flat();
        let [of_flat, of_bent] = [&flat, &impostor].map(|impostor| seen.flip(impostor));
        let (impostor, flip) = match of_flat <= of_bent {
            true => (flat, of_flat),
            false => (impostor, of_bent),
        };
        let flip = seen.at_its_size(flip, &impostor);
        Ok(Some(Found { impostor, flip }))
    }

    /// Cards for the pictures of a search.
    fn rough(
        &mut self,
        step: usize,
        seen: &Seen,
        observer: &mut Observer<'_>,
    ) -> Result<Option<&Impostor>, Error> {
        poll(observer)?;
        let pixels_high = seen.pixels_high.min(SEARCH_PX);
        let key = (pixels_high.to_bits(), step);
        if !self.rough.contains_key(&key) {
            let cards = self.sorted(number(step));
            let Some(made) = Impostor::cards(cards, pixels_high, f64::INFINITY) else {
                return Ok(None);
            };
            self.rough.insert(key, made);
        }
        Ok(self.rough.get(&key))
    }

    fn sorted(&mut self, count: usize) -> &Cards<'a, Surface> {
        let surfaces = self.surfaces;
        let new = || Cards::new(surfaces, count);
        self.sorted.entry(count).or_insert_with(new)
    }
}

#[cfg(test)]
mod tests;
