//! How many cards it takes to look like a plant.

use std::collections::BTreeMap;

use secateur_eval::{Difference, DifferenceJudge, Limits, ViewCount};
use secateur_model::Surface;
use secateur_simplify::{Error, Observer};

use super::cards::{Cards, Texels};
use super::{Impostor, poll};

/// The fewest cards that are tried.
const LEAST: f64 = 8.0;

/// How many times as many each next number has.
const STEP: f64 = 1.25;

/// How many numbers there are: the largest is 867.
const STEPS: usize = 22;

/// The difference falls about as the number of cards to this power, by which the next number to try is guessed.
const POWER: f64 = 0.2;

/// With a difference that falls as fast as that there is no hope, if there is none. With .35 a crown that 284 cards show
/// well enough had none where no more than these were allowed.
const BEST_POWER: f64 = 0.5;

/// The step that tells whether there is hope: 60 cards.
const FEW: usize = 9;

/// Up to this many steps beyond, the largest number is looked at whatever the few look like: of a low-poly tree of 372
/// triangles 75 cards are .79 of what 60 are, far less than a power foretells, and took the place of 244 triangles at
/// 32 pixels.
const FAR_FROM_FEW: usize = 3;

/// The height in pixels for which cards of a search are baked and at which they are looked at, at most: finer ones
/// would take four times as long.
const SEARCH_PX: f64 = 128.0;

/// What is this many times beyond the limits in the pictures of a search is so in those of its size.
const HOPELESS: f64 = 1.2;

/// Up to this height in pixels all cards that are tried are as they will stand: rough ones do not tell how many of them
/// are enough.
const FINISHED_PX: f64 = 32.0;

/// The most pixels that a texel of cards may be long where they begin to be seen: longer ones look blurred.
const COARSEST_PX: f64 = 2.0;

/// Lengths of a texel in pixels that are tried once cards are found, until one does: the screen shows no finer ones.
const COARSER_PX: [f64; 3] = [1.0, 0.5, 0.25];

/// From this height in pixels down all pieces of stems have two cards. A crown has few layers there; where it has
/// hundreds, more layers look nearer than second cards.
const STEMS_CROSS_PX: f64 = 32.0;

/// Cards are made darker or brighter in steps of this, as long as they look nearer.
const BRIGHTER: f32 = 1.12;

/// After so many steps it ends.
const MOST_BRIGHTER: usize = 4;

/// Where an atlas has no room for a number of cards, the number three steps below is tried: about half.
const FEWER: usize = 3;

/// Normals of half the size do if the difference is at most this many times what it is with all.
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
    /// How far they look from the plant at that place.
    pub difference: Difference,
}

/// A plant where the screen shows it at a height, and how far cards may look from it there.
pub struct Seen<'a> {
    judge: &'a DifferenceJudge,
    pixels_high: f64,
    limits: Limits,
    /// Whether nearly all of the plant is thinner than a pixel there.
    is_thin: bool,
}

impl<'a> Seen<'a> {
    /// A plant where its largest extent is `pixels_high` pixels on the screen, by a judge with turned normals.
    pub fn new(judge: &'a DifferenceJudge, pixels_high: f64, limits: Limits) -> Self {
        Self {
            judge,
            pixels_high,
            limits,
            is_thin: judge.is_thin(pixels_high.min(SEARCH_PX)),
        }
    }

    /// The finest texels that show the plant there, to those of `coarsest_px`.
    pub fn texels_up_to(&self, coarsest_px: f64) -> Texels {
        let pixels_high = self.pixels_high.min(SEARCH_PX);
        Texels::up_to(coarsest_px, pixels_high, self.is_thin)
    }

    /// How many times the limits an impostor is, in the pictures of a search.
    fn over_in_search(&self, impostor: &Impostor) -> f64 {
        let pixels_high = self.pixels_high.min(SEARCH_PX);
        let difference = self.judged(impostor, pixels_high, ViewCount::Search, self.limits);
        difference.over(self.limits)
    }

    /// How far an impostor looks from the plant where it stands, from few views: at least so far where that is beyond
    /// the limits.
    pub fn at_a_glance(&self, impostor: &Impostor) -> Difference {
        self.judged(impostor, self.pixels_high, ViewCount::Search, self.limits)
    }

    /// How far an impostor looks from the plant in pictures as large as the screen shows it.
    pub fn difference(&self, impostor: &Impostor) -> Difference {
        let no_limit = Limits::of_difference(f64::INFINITY);
        self.judged(impostor, self.pixels_high, ViewCount::All, no_limit)
    }

    /// An impostor as bright as looks nearest to the plant: the mean of what leaves show is darker, or brighter, than
    /// what shows with the mean of their normals.
    fn as_bright(&self, impostor: Impostor) -> Impostor {
        if self.pixels_high > SEARCH_PX {
            return impostor;
        }
        let figure = |of: &Impostor| {
            let seen = self.at_a_glance(of);
            seen.difference
        };
        let (mut least, mut times, mut best) = (figure(&impostor), 1.0, impostor.clone());
        for step in [1.0 / BRIGHTER, BRIGHTER] {
            for _ in 0..MOST_BRIGHTER {
                let tried = impostor.with_brightness(times * step);
                let of_tried = figure(&tried);
                if of_tried >= least {
                    break;
                }
                (least, times, best) = (of_tried, times * step, tried);
            }
            if times < 1.0 {
                break;
            }
        }
        best
    }

    /// Whether an impostor looks as much like the plant as it has to.
    pub fn is_within(&self, impostor: &Impostor) -> bool {
        let seen = self.judged(impostor, self.pixels_high, ViewCount::All, self.limits);
        seen.over(self.limits) <= 1.0
    }

    fn judged(
        &self,
        impostor: &Impostor,
        pixels_high: f64,
        count: ViewCount,
        limits: Limits,
    ) -> Difference {
        let seen = |eye| vec![impostor.seen_from(eye)];
        self.judge
            .difference_of_seen(seen, pixels_high, count, limits)
    }

    /// These cards with a normal map of half as many texels a side; none if they look farther from the plant, or
    /// have no normal map.
    pub fn with_half_normals(&self, found: &Found) -> Option<Found> {
        let impostor = found.impostor.with_half_normals()?;
        let difference = self.difference(&impostor);
        let most = AS_NEAR * found.difference.over(self.limits);
        (difference.over(self.limits) <= most).then_some(Found {
            impostor,
            difference,
        })
    }

    /// Lit by its normals or flat, whichever looks nearer.
    fn nearer_of_flat(&self, impostor: Impostor) -> Found {
        let flat = impostor.flat();
        let [of_flat, of_bent] = [&flat, &impostor].map(|impostor| self.difference(impostor));
        match of_flat.over(self.limits) <= of_bent.over(self.limits) {
            true => Found {
                impostor: flat,
                difference: of_flat,
            },
            false => Found {
                impostor,
                difference: of_bent,
            },
        }
    }
}

/// A search for the fewest cards of a plant, at one place after another.
pub struct Search<'a> {
    surfaces: &'a [Surface],
    /// By the number of layers, and whether stems have two cards that cross.
    sorted: BTreeMap<(usize, bool), Cards<'a, Surface>>,
    /// Cards for the pictures of a search, by their height in pixels, step and most bytes.
    rough: BTreeMap<(u64, usize, u64), Impostor>,
    /// Bytes that the pictures of cards may take on the GPU.
    most_bytes: u64,
}

impl<'a> Search<'a> {
    /// A search of cards for what is drawn of a plant, whose pictures take at most so many bytes on the GPU.
    pub fn new(surfaces: &'a [Surface], most_bytes: u64) -> Self {
        Self {
            surfaces,
            sorted: BTreeMap::new(),
            rough: BTreeMap::new(),
            most_bytes,
        }
    }

    /// Lets the pictures of cards take at most so many bytes from now on.
    pub fn bound(&mut self, most_bytes: u64) {
        self.most_bytes = most_bytes;
    }

    fn texels(&self, seen: &Seen<'_>) -> Texels {
        Texels {
            most_bytes: self.most_bytes,
            ..seen.texels_up_to(COARSEST_PX)
        }
    }

    /// Whether an atlas has room for any cards where the screen shows the plant at this height.
    pub fn has_room(&mut self, seen: &Seen<'_>) -> bool {
        let texels = self.texels(seen);
        self.sorted(number(0), seen).fit(seen.pixels_high, texels)
    }

    /// The fewest cards, at most `most`, that are within the limits, with textures as fine as the place asks for,
    /// and as `finish` makes them; none if there are none. The observer is asked at each number of cards that is sorted
    /// for, baked or looked at.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the observer breaks it off.
    pub fn fewest(
        &mut self,
        seen: &Seen<'_>,
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
        if all - 1 > few + FAR_FROM_FEW && best * seen.over_in_search(of_few) > HOPELESS {
            return Ok(None);
        }
        let texels = self.texels(seen);
        let most_within = self.most_within((all, most), (seen, texels), &finish, observer)?;
        let Some((last, of_last, over)) = most_within else {
            return Ok(None);
        };
        let most_over = match over > 0.0 {
            true => of_last / over,
            // Nothing is seen of the plant, or no difference.
            false => 1.0,
        };
        let most_px = match seen.is_thin {
            true => SEARCH_PX,
            false => FINISHED_PX,
        };
        let step = match seen.pixels_high <= most_px {
            true => Some(self.fewest_finished(last, (seen, texels), &finish, observer)?),
            false => self.fewest_rough((last, of_last), seen, most_over, observer)?,
        };
        let Some(step) = step else {
            return Ok(None);
        };
        for step in (step..last).take(MORE).chain([last]) {
            let found = self.finished(number(step), seen, texels, &finish, observer)?;
            let Some(found) = found.filter(|found| found.difference.over(seen.limits) <= 1.0)
            else {
                continue;
            };
            for finest_px in COARSER_PX {
                if found.impostor.texel_px().is_none_or(|px| px >= finest_px) {
                    break;
                }
                let coarser = Texels {
                    finest_px,
                    ..texels
                };
                let coarser = self.finished(number(step), seen, coarser, &finish, observer)?;
                let does = |coarser: &Found| coarser.difference.over(seen.limits) <= 1.0;
                if coarser.as_ref().is_some_and(does) {
                    return Ok(coarser);
                }
            }
            return Ok(Some(found));
        }
        Ok(None)
    }

    /// The last of the first `all` steps whose cards are within the limits; how many times the limits they are in the
    /// pictures of a search, and as they will stand. Where a plant is thin, fewer cards are tried as long as they look
    /// nearer: many small pictures of twigs lose more than a few large ones.
    fn most_within(
        &mut self,
        (mut all, most): (usize, usize),
        (seen, texels): (&Seen<'_>, Texels),
        finish: impl Fn(Impostor) -> Impostor,
        observer: &mut Observer<'_>,
    ) -> Result<Option<(usize, f64, f64)>, Error> {
        let mut least_over = f64::INFINITY;
        while let Some(last) = self.last(all, most, seen, observer)? {
            let Some(rough) = self.rough(last, seen, observer)? else {
                break;
            };
            let of_last = seen.over_in_search(rough);
            if of_last > HOPELESS && !seen.is_thin {
                break;
            }
            poll(observer)?;
            let cards = self.sorted(number(last), seen);
            let Some(fine) = Impostor::cards(cards, seen.pixels_high, texels) else {
                break;
            };
            poll(observer)?;
            let bright = seen.as_bright(finish(fine));
            let over = seen.difference(&bright).over(seen.limits);
            if over <= 1.0 {
                return Ok(Some((last, of_last, over)));
            }
            if !seen.is_thin || over >= least_over || last < FEWER {
                break;
            }
            (least_over, all) = (over, last + 1 - FEWER);
        }
        Ok(None)
    }

    /// The last of the first `all` steps whose cards an atlas has room for and are no more than `most`, or one of the
    /// few before it.
    fn last(
        &mut self,
        all: usize,
        most: usize,
        seen: &Seen<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<usize>, Error> {
        for step in (0..all).rev().step_by(FEWER).chain([0]) {
            poll(observer)?;
            let texels = self.texels(seen);
            let cards = self.sorted(number(step), seen);
            // Trunks have more cards than layers.
            if cards.count() <= most && cards.fit(seen.pixels_high, texels) {
                return Ok(Some(step));
            }
        }
        Ok(None)
    }

    /// The least step that is at most so many times the limits in the pictures of a search, as the last one is.
    fn fewest_rough(
        &mut self,
        last: (usize, f64),
        seen: &Seen<'_>,
        most_over: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Option<usize>, Error> {
        let mut enough = last;
        let mut least = 0;
        while least < enough.0 {
            // As many fewer as the bound leaves room for, at least one step.
            let room = match enough.1 > 0.0 {
                true => (most_over / enough.1).ln() / (POWER * STEP.ln()),
                false => f64::INFINITY,
            };
            let fewer = (room.floor().max(1.0) as usize).min(enough.0 - least);
            let step = enough.0 - fewer;
            let Some(rough) = self.rough(step, seen, observer)? else {
                return Ok(None);
            };
            let over = seen.over_in_search(rough);
            match over <= most_over {
                true => enough = (step, over),
                false => least = step + 1,
            }
        }
        Ok(Some(enough.0))
    }

    /// The least step whose cards are within the limits as they will stand, as those of `last` are. Rough cards do not
    /// tell that of twigs, of which the cutoff decides how much is left.
    fn fewest_finished(
        &mut self,
        last: usize,
        (seen, texels): (&Seen<'_>, Texels),
        finish: impl Fn(Impostor) -> Impostor,
        observer: &mut Observer<'_>,
    ) -> Result<usize, Error> {
        let (mut least, mut enough) = (0, last);
        while least < enough {
            let step = (least + enough) / 2;
            let found = self.finished(number(step), seen, texels, &finish, observer)?;
            match found.is_some_and(|found| found.difference.over(seen.limits) <= 1.0) {
                true => enough = step,
                false => least = step + 1,
            }
        }
        Ok(enough)
    }

    /// This number of cards with these texels; lit by their normals or flat, whichever looks nearer.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the observer breaks it off.
    pub fn finished(
        &mut self,
        count: usize,
        seen: &Seen<'_>,
        texels: Texels,
        finish: impl Fn(Impostor) -> Impostor,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Found>, Error> {
        poll(observer)?;
        let cards = self.sorted(count, seen);
        let Some(baked) = Impostor::cards(cards, seen.pixels_high, texels) else {
            return Ok(None);
        };
        poll(observer)?;
        let impostor = seen.as_bright(finish(baked));
        poll(observer)?;
        Ok(Some(seen.nearer_of_flat(impostor)))
    }

    /// Cards for the pictures of a search.
    fn rough(
        &mut self,
        step: usize,
        seen: &Seen<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<&Impostor>, Error> {
        poll(observer)?;
        let pixels_high = seen.pixels_high.min(SEARCH_PX);
        let most_bytes = match seen.pixels_high <= SEARCH_PX {
            true => self.most_bytes,
            false => u64::MAX,
        };
        let key = (pixels_high.to_bits(), step, most_bytes);
        if !self.rough.contains_key(&key) {
            let texels = Texels {
                most_bytes,
                ..seen.texels_up_to(f64::INFINITY)
            };
            let cards = self.sorted(number(step), seen);
            let Some(made) = Impostor::cards(cards, pixels_high, texels) else {
                return Ok(None);
            };
            self.rough.insert(key, seen.as_bright(made));
        }
        Ok(self.rough.get(&key))
    }

    fn sorted(&mut self, count: usize, seen: &Seen<'_>) -> &Cards<'a, Surface> {
        let surfaces = self.surfaces;
        let crosses_stems = seen.pixels_high <= STEMS_CROSS_PX;
        let new = || match crosses_stems {
            true => Cards::with_crossed_stems(surfaces, count),
            false => Cards::new(surfaces, count),
        };
        self.sorted
            .entry((count, crosses_stems))
            .or_insert_with(new)
    }
}

#[cfg(test)]
mod tests;
