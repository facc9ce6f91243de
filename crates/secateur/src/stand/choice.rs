//! Which level each place has: figures of its levels there, from how large it is seen, set right by what pictures show.

use secateur_levels::chain::{CostWeights, LevelParts};
use secateur_levels::stand::{
    LevelThere, cheapest_within_error, error_a_pixel, nearest_within_cost,
};

use super::{KindLevels, PlantPlace, StandOptions};

/// How far one picture may set a place's errors right: further off, it is chance.
const SET_RIGHT: [f64; 2] = [0.25, 4.0];

/// A difference is about so many times the mean FLIP over plants.
const OF_MEAN: f64 = 1.75;

/// A place that cameras see.
#[derive(Clone, Debug)]
pub(super) struct SeenPlace {
    /// Its number in the stand.
    pub(super) place: usize,
    /// By camera, how many pixels of its picture show it, and how many pixels high it is there.
    pub(super) seen: Vec<(f64, f64)>,
    /// By what errors of its levels are multiplied: 1 until pictures say otherwise.
    factor: f64,
}

/// What a choice is made from.
pub(super) struct Choice<'a> {
    pub(super) places: &'a [PlantPlace],
    pub(super) kinds: &'a [KindLevels],
    pub(super) seen: Vec<SeenPlace>,
    pub(super) weights: CostWeights,
    /// Pixels of all pictures together.
    pub(super) all_px: f64,
    /// By kind and level, whether a place may show it.
    pub(super) allowed: Vec<Vec<bool>>,
}

/// What is sought.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sought {
    /// The least cost within a mean error.
    WithinError(f64),
    /// The least error within a number of triangles.
    WithinTriangles(u64),
}

impl SeenPlace {
    pub(super) fn new(place: usize, seen: Vec<(f64, f64)>) -> Self {
        Self {
            place,
            seen,
            factor: 1.0,
        }
    }
}

impl StandOptions {
    /// Whether pictures have a limit.
    pub(super) fn has_limit(&self) -> bool {
        self.max_difference.is_some() || self.max_flip.is_some()
    }
}

impl Choice<'_> {
    /// What is sought before any picture is drawn.
    pub(super) fn first_sought(&self, options: &StandOptions) -> Sought {
        let seen = self.seen.iter().flat_map(|place| &place.seen);
        let covered: f64 = seen.map(|(px, _)| px).sum();
        let of_difference = options.max_difference;
        let of_difference = of_difference.map(|most| most / OF_MEAN * covered / self.all_px);
        let limits = options.max_flip.into_iter().chain(of_difference);
        match (limits.reduce(f64::min), options.triangles) {
            (Some(most), _) => Sought::WithinError(most),
            (None, Some(triangles)) => Sought::WithinTriangles(triangles),
            (None, None) => Sought::WithinError(0.0),
        }
    }

    /// Triangles of all plants of a choice.
    pub(super) fn triangles(&self, chosen: &[usize]) -> u64 {
        let level = |(seen, level): (&SeenPlace, &usize)| {
            let kind = self.places[seen.place].kind;
            self.kinds[kind].levels[*level].parts.triangles
        };
        self.seen.iter().zip(chosen).map(level).sum()
    }

    /// The mean error that a level of a place is taken to add to the pictures.
    fn error(&self, seen: &SeenPlace, level: usize) -> f64 {
        let kind = self.places[seen.place].kind;
        let report = &self.kinds[kind].levels[level].report;
        let of_camera = |&(px, high): &(f64, f64)| {
            px * error_a_pixel(report.difference.mean, report.pixels_high, high)
        };
        seen.factor * seen.seen.iter().map(of_camera).sum::<f64>() / self.all_px
    }

    /// What a plant more of a level costs.
    fn cost(&self, kind: usize, level: usize) -> f64 {
        let parts = self.kinds[kind].levels[level].parts;
        self.weights.cost(LevelParts {
            bytes: 0,
            gpu_bytes: 0,
            ..parts
        })
    }

    /// What a level costs once, however many plants show it.
    fn fixed_cost(&self, kind: usize, level: usize) -> f64 {
        let parts = self.kinds[kind].levels[level].parts;
        self.weights.cost(LevelParts {
            triangles: 0,
            draws: 0,
            ..parts
        })
    }

    /// The level of each seen place.
    pub(super) fn levels(&self, sought: Sought) -> Vec<usize> {
        let allowed = |kind: usize| {
            let all = self.allowed[kind].iter().enumerate();
            all.filter_map(|(level, is)| is.then_some(level))
        };
        let there = |seen: &SeenPlace| -> Vec<LevelThere> {
            let kind = self.places[seen.place].kind;
            let level = |level: usize| LevelThere {
                cost: match sought {
                    Sought::WithinError(_) => self.cost(kind, level),
                    Sought::WithinTriangles(_) => {
                        self.kinds[kind].levels[level].parts.triangles as f64
                    }
                },
                error: self.error(seen, level),
            };
            allowed(kind).map(level).collect()
        };
        let options: Vec<Vec<LevelThere>> = self.seen.iter().map(there).collect();
        let chosen = match sought {
            Sought::WithinError(most) => cheapest_within_error(&options, most),
            Sought::WithinTriangles(most) => nearest_within_cost(&options, most as f64),
        };
        let numbers = self.seen.iter().zip(chosen).map(|(seen, k)| {
            let kind = self.places[seen.place].kind;
            allowed(kind).nth(k).expect("one of those that are allowed")
        });
        let mut chosen: Vec<usize> = numbers.collect();
        if let Sought::WithinError(_) = sought {
            self.drop_dear_levels(&mut chosen);
        }
        chosen
    }

    /// Gives the few plants of a level that costs more once than they save the next finer one that is shown.
    fn drop_dear_levels(&self, chosen: &mut [usize]) {
        for kind in 0..self.kinds.len() {
            let is_of_kind = |seen: &SeenPlace| self.places[seen.place].kind == kind;
            for level in 1..self.kinds[kind].levels.len() {
                let shows = |chosen: &[usize], k: usize| {
                    let places = self.seen.iter().zip(chosen);
                    places
                        .filter(|(seen, l)| is_of_kind(seen) && **l == k)
                        .count()
                };
                let count = shows(chosen, level);
                let finer = (0..level).rev().find(|k| shows(chosen, *k) > 0);
                let Some(finer) = finer.filter(|_| count > 0) else {
                    continue;
                };
                let more = count as f64 * (self.cost(kind, finer) - self.cost(kind, level));
                if more < self.fixed_cost(kind, level) {
                    for (seen, own) in self.seen.iter().zip(&mut *chosen) {
                        if is_of_kind(seen) && *own == level {
                            *own = finer;
                        }
                    }
                }
            }
        }
    }

    /// The mean error that this choice is taken to make.
    pub(super) fn error_of(&self, chosen: &[usize]) -> f64 {
        let pairs = self.seen.iter().zip(chosen);
        pairs.map(|(seen, level)| self.error(seen, *level)).sum()
    }

    /// Sets the errors of each place right by the FLIP over its pixels that pictures of this choice show, by place of the
    /// stand.
    pub(super) fn set_right(&mut self, chosen: &[usize], flip_px: &[f64]) {
        for (k, level) in chosen.iter().enumerate() {
            let taken = self.error(&self.seen[k], *level) * self.all_px;
            let shown = flip_px[self.seen[k].place];
            if taken > 0.0 && *level > 0 {
                let [least, most] = SET_RIGHT;
                self.seen[k].factor *= (shown / taken).clamp(least, most);
            }
        }
    }

    /// Forbids levels until those that are shown take no more than this on the GPU: each time the one whose plants show
    /// least for the bytes when they get the next coarser one.
    pub(super) fn fit_gpu_bytes(&mut self, most: u64, sought: Sought) {
        loop {
            let chosen = self.levels(sought);
            let mut errors: Vec<Vec<f64>> = self
                .kinds
                .iter()
                .map(|k| vec![0.0; k.levels.len()])
                .collect();
            let mut shown: Vec<Vec<bool>> = self
                .kinds
                .iter()
                .map(|k| vec![false; k.levels.len()])
                .collect();
            for (seen, level) in self.seen.iter().zip(&chosen) {
                let kind = self.places[seen.place].kind;
                shown[kind][*level] = true;
                let others = (0..self.kinds[kind].levels.len())
                    .filter(|k| self.allowed[kind][*k] && k != level);
                let least = others
                    .map(|k| self.error(seen, k))
                    .fold(f64::INFINITY, f64::min);
                errors[kind][*level] += least - self.error(seen, *level);
            }
            let all = (0..self.kinds.len())
                .flat_map(|kind| (0..self.kinds[kind].levels.len()).map(move |k| (kind, k)));
            let used: Vec<(usize, usize)> = all.filter(|(kind, k)| shown[*kind][*k]).collect();
            let bytes = |&(kind, k): &(usize, usize)| self.kinds[kind].levels[k].parts.gpu_bytes;
            if used.iter().map(bytes).sum::<u64>() <= most {
                return;
            }
            let has_another = |&&(kind, _): &&(usize, usize)| {
                self.allowed[kind].iter().filter(|is| **is).count() > 1
            };
            let worst = used.iter().filter(has_another).min_by(|a, b| {
                let rate =
                    |at: &(usize, usize)| errors[at.0][at.1].max(0.0) / bytes(at).max(1) as f64;
                rate(a).total_cmp(&rate(b))
            });
            let Some(&(kind, level)) = worst else {
                return;
            };
            self.allowed[kind][level] = false;
        }
    }
}
