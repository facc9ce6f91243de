//! The levels of a stand: chosen, drawn, set right by what the pictures show, and chosen again.

use secateur_eval::{JudgedStand, StandDifference, StandKind, StandPicture};
use secateur_levels::chain::BadOptions;
use secateur_simplify::Observer;

use super::choice::{Choice, SeenPlace, Sought};
use super::written::{StandFigures, written};
use super::{KindLevels, Stand, StandOptions};
use crate::{Error, Session};

/// How often levels are chosen and drawn at most.
const ROUNDS: usize = 6;

/// A choice that is within this share of the limits is near enough to them.
const NEAR_ENOUGH: f64 = 0.94;

/// By how much the next choice is aimed below the limit: pictures differ from what was taken.
const AIMED_BELOW: f64 = 0.98;

/// A stand with a level for each plant.
#[derive(Debug)]
pub struct StandLevels {
    /// The levels of each kind.
    pub kinds: Vec<KindLevels>,
    /// By place, the number of its level; none where no camera sees it.
    pub levels: Vec<Option<usize>>,
    /// By place and camera, how many pixels of its picture show it, and how many pixels high it is there.
    pub seen: Vec<Vec<(f64, f64)>>,
    /// By camera, the pictures and how far they are apart.
    pub cameras: Vec<CameraFigures>,
    /// What the stand costs as it is.
    pub before: StandFigures,
    /// What it costs with a level for each plant that is seen.
    pub after: StandFigures,
    /// The stand as a GLB: a node for each plant that is seen, meshes shared.
    pub glb: Vec<u8>,
    /// What has to be said, a sentence each.
    pub notes: Vec<String>,
}

/// What a camera sees of a stand before and after.
#[derive(Debug)]
pub struct CameraFigures {
    /// The stand as it is.
    pub before: StandPicture,
    /// The stand with a level for each plant that is seen.
    pub after: StandPicture,
    /// How far it is from that.
    pub difference: StandDifference,
}

/// A choice, and what its pictures show.
struct Drawn {
    chosen: Vec<usize>,
    pictures: Vec<StandPicture>,
    differences: Vec<StandDifference>,
    /// How many times the limits the worst picture is; by its FLIP where there are none.
    over: f64,
    cost: f64,
}

impl Drawn {
    /// The cheaper one of two within the limits, else the one that is nearer to the plants.
    fn is_better_than(&self, other: &Self, has_limit: bool) -> bool {
        match (self.over <= 1.0, other.over <= 1.0) {
            (true, true) if has_limit => self.cost < other.cost,
            _ => self.over < other.over,
        }
    }
}

impl Stand {
    /// Gives each plant its level.
    ///
    /// # Errors
    /// [`Error::Levels`] if options are out of range, as [`Plant::levels`](crate::Plant::levels), or [`Error::Gltf`] if
    /// the stand can't be written.
    pub fn levels(&self, options: &StandOptions, session: &Session) -> Result<StandLevels, Error> {
        session.watched(|observer| self.levels_on(options, session, observer))
    }

    /// As [`levels`](Self::levels), with an observer that may borrow and may break it off.
    ///
    /// # Errors
    /// As [`levels`](Self::levels), or [`SimplifyError::Stopped`](secateur_simplify::Error::Stopped) if it was broken off.
    pub fn levels_watched(
        &self,
        options: &StandOptions,
        observer: &mut Observer<'_>,
    ) -> Result<StandLevels, Error> {
        self.levels_on(options, &Session::default(), observer)
    }

    fn levels_on(
        &self,
        options: &StandOptions,
        session: &Session,
        observer: &mut Observer<'_>,
    ) -> Result<StandLevels, Error> {
        check(options)?;
        let height_px = options.levels.screen.height_px as u32;
        let itself: Vec<Option<&StandKind>> = self
            .places
            .iter()
            .map(|p| Some(&self.kinds[p.kind].drawn))
            .collect();
        let truths = self
            .cameras
            .iter()
            .map(|camera| JudgedStand::new(self.picture(&itself, camera, height_px)));
        let truths: Vec<JudgedStand> = truths.collect();
        let seen = self.seen(&truths, height_px);
        let kinds = self.kind_levels(&seen, options, session, observer)?;
        let is_seen = |place: usize| seen[place].iter().any(|(px, _)| *px > 0.0);
        let places = (0..self.places.len()).filter(|place| is_seen(*place));
        let mut choice = Choice {
            places: &self.places,
            kinds: &kinds,
            seen: places
                .map(|place| SeenPlace::new(place, seen[place].clone()))
                .collect(),
            weights: options.levels.cost,
            all_px: truths
                .iter()
                .map(|truth| truth.picture.image.pixels().len() as f64)
                .sum(),
            allowed: kinds
                .iter()
                .map(|kind| vec![true; kind.levels.len()])
                .collect(),
        };
        let mut notes = self.notes.clone();
        let drawn = self.chosen(&mut choice, options, (&truths, height_px), &mut notes)?;
        let mut levels = vec![None; self.places.len()];
        for (seen, level) in choice.seen.iter().zip(&drawn.chosen) {
            levels[seen.place] = Some(*level);
        }
        let weights = options.levels.cost;
        let all: Vec<Option<usize>> = vec![Some(0); self.places.len()];
        let (before, _) = written(self, &kinds, &all, weights)?;
        let (after, glb) = written(self, &kinds, &levels, weights)?;
        let figures = truths
            .into_iter()
            .zip(drawn.pictures)
            .zip(drawn.differences);
        let figures = figures.map(|((truth, after), difference)| CameraFigures {
            before: truth.picture,
            after,
            difference,
        });
        Ok(StandLevels {
            cameras: figures.collect(),
            kinds,
            levels,
            seen,
            before,
            after,
            glb,
            notes,
        })
    }

    /// Chooses and draws until the pictures are within the limits, and no further within than need be.
    fn chosen(
        &self,
        choice: &mut Choice<'_>,
        options: &StandOptions,
        (truths, height_px): (&[JudgedStand], u32),
        notes: &mut Vec<String>,
    ) -> Result<Drawn, Error> {
        let has_limit = options.has_limit();
        let mut sought = choice.first_sought(options);
        let mut is_too_dear = false;
        let mut best: Option<Drawn> = None;
        for _ in 0..ROUNDS {
            if let Some(most) = options.gpu_bytes {
                choice.fit_gpu_bytes(most, sought);
            }
            let mut chosen = choice.levels(sought);
            if let Some(most) = options
                .triangles
                .filter(|most| choice.triangles(&chosen) > *most)
            {
                chosen = choice.levels(Sought::WithinTriangles(most));
                is_too_dear = choice.triangles(&chosen) > most;
            }
            if best.as_ref().is_some_and(|best| best.chosen == chosen) {
                break;
            }
            let drawn = self.drawn(choice, chosen, options, (truths, height_px))?;
            let flip_px = flip_px(&drawn.differences);
            choice.set_right(&drawn.chosen, &flip_px);
            if has_limit && drawn.over > 0.0 {
                sought =
                    Sought::WithinError(AIMED_BELOW * choice.error_of(&drawn.chosen) / drawn.over);
            }
            let is_done = (NEAR_ENOUGH..=1.0).contains(&drawn.over) && has_limit;
            if best
                .as_ref()
                .is_none_or(|best| drawn.is_better_than(best, has_limit))
            {
                best = Some(drawn);
            }
            if is_done {
                break;
            }
        }
        let best = best.expect("at least one round");
        if is_too_dear {
            notes.push(
                "the lightest levels of all plants have more triangles than were asked for"
                    .to_owned(),
            );
        }
        if !has_limit || best.over <= 1.0 {
            return Ok(best);
        }
        if options.triangles.is_some() || options.gpu_bytes.is_some() {
            notes.push(
                "the pictures differ more than asked for: the budget allows no nearer levels"
                    .to_owned(),
            );
            return Ok(best);
        }
        notes.push(
            "no levels were found within the limits: all plants that are seen are left as they are"
                .to_owned(),
        );
        let itself = vec![0; choice.seen.len()];
        self.drawn(choice, itself, options, (truths, height_px))
    }

    /// The pictures of a choice, and how far they are off.
    fn drawn(
        &self,
        choice: &Choice<'_>,
        chosen: Vec<usize>,
        options: &StandOptions,
        (truths, height_px): (&[JudgedStand], u32),
    ) -> Result<Drawn, Error> {
        let mut levels: Vec<Option<usize>> = vec![None; self.places.len()];
        for (seen, level) in choice.seen.iter().zip(&chosen) {
            levels[seen.place] = Some(*level);
        }
        let kind = |(place, level): (&super::PlantPlace, &Option<usize>)| {
            level.map(|level| &choice.kinds[place.kind].levels[level].drawn)
        };
        let shown: Vec<Option<&StandKind>> = self.places.iter().zip(&levels).map(kind).collect();
        let pictures = self
            .cameras
            .iter()
            .map(|camera| self.picture(&shown, camera, height_px));
        let pictures: Vec<StandPicture> = pictures.collect();
        let pairs = truths.iter().zip(&pictures);
        let differences: Vec<StandDifference> = pairs
            .map(|(truth, picture)| truth.difference(picture))
            .collect();
        let over = |found: &StandDifference| {
            let of_flip = options.max_flip.map(|most| found.flip_mean / most);
            let of_difference = options.max_difference.map(|most| found.difference / most);
            of_flip
                .into_iter()
                .chain(of_difference)
                .reduce(f64::max)
                .unwrap_or(found.flip_mean)
        };
        let (figures, _) = written(self, choice.kinds, &levels, choice.weights)?;
        Ok(Drawn {
            over: differences.iter().map(over).fold(0.0, f64::max),
            cost: figures.cost,
            chosen,
            pictures,
            differences,
        })
    }
}

/// By place, FLIP over its pixels in all pictures.
fn flip_px(differences: &[StandDifference]) -> Vec<f64> {
    let places = differences.first().map_or(0, |first| first.flip_px.len());
    let sum = |place: usize| differences.iter().map(|found| found.flip_px[place]).sum();
    (0..places).map(sum).collect()
}

fn check(options: &StandOptions) -> Result<(), Error> {
    options.levels.check().map_err(Error::from)?;
    let is_limit = |most: &Option<f64>| most.is_none_or(|most| most > 0.0 && most <= 2.0);
    match is_limit(&options.max_difference) && is_limit(&options.max_flip) {
        true => Ok(()),
        false => Err(BadOptions::OutOfRange(
            "limits on the pictures of a stand must be above 0 and at most 2",
        )
        .into()),
    }
}
