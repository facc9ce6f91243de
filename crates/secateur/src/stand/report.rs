//! The figures of a stand with a level for each plant, as records have them.

use secateur_levels::chain::LevelKind;
use serde::Serialize;

use super::{KindLevel, Stand, StandFigures, StandLevels};

/// A stand, and the level of each of its plants.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct StandReport {
    /// The kinds of plants, and their levels.
    pub kinds: Vec<KindReport>,
    /// Each plant of the scene.
    pub places: Vec<PlaceReport>,
    /// The scene as it is.
    pub before: StandFigures,
    /// The scene as it is written, each plant as its level.
    pub after: StandFigures,
    /// How many times less it costs.
    pub cost_ratio: f64,
}

/// A kind of plants.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct KindReport {
    /// What its levels are called after.
    pub name: String,
    /// How many plants of it there are, and how many of those a camera sees.
    pub plants: usize,
    /// How many of them a camera sees.
    pub seen_plants: usize,
    /// Its levels, finest first; the first is the plant itself.
    pub levels: Vec<KindLevelReport>,
}

/// A level of a kind.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct KindLevelReport {
    /// Whether the level is the plant itself, a mesh or an impostor.
    pub kind: LevelKind,
    /// How many plants show it.
    pub plants: usize,
    /// Triangles of the level, where one plant shows it.
    pub triangles: u64,
    /// Primitives that are drawn.
    pub draws: u64,
    /// Bytes that it takes in a GPU's memory.
    pub gpu_bytes: u64,
    /// The largest height in pixels that it was made for; null for the plant itself.
    pub pixels_high: Option<f64>,
    /// How far it looks from the plant there.
    pub difference: f64,
}

/// A plant of a stand.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PlaceReport {
    /// What its node is called.
    pub name: String,
    /// The name of its kind.
    pub plant: String,
    /// The number of its level, from 0; null where no camera sees it.
    pub level: Option<usize>,
    /// The largest height in pixels at which a camera sees it; null where none does.
    pub pixels_high: Option<f64>,
    /// How many pixels of all pictures show it.
    pub seen_px: f64,
}

impl StandLevels {
    /// The figures of these levels of a stand.
    pub fn report(&self, stand: &Stand) -> StandReport {
        StandReport {
            kinds: (0..stand.kinds.len())
                .map(|kind| self.kind(stand, kind))
                .collect(),
            places: (0..stand.places.len())
                .map(|place| self.place(stand, place))
                .collect(),
            before: self.before,
            after: self.after,
            cost_ratio: self.before.cost / self.after.cost,
        }
    }

    fn place(&self, stand: &Stand, number: usize) -> PlaceReport {
        let place = &stand.places[number];
        let seen = self.seen[number].iter().filter(|(px, _)| *px > 0.0);
        PlaceReport {
            name: place.name.clone(),
            plant: stand.kinds[place.kind].name.clone(),
            level: self.levels[number],
            pixels_high: seen.clone().map(|(_, high)| *high).reduce(f64::max),
            seen_px: seen.map(|(px, _)| px).sum(),
        }
    }

    fn kind(&self, stand: &Stand, kind: usize) -> KindReport {
        let of_kind = stand.places.iter().zip(&self.levels);
        let own: Vec<Option<usize>> = of_kind
            .filter(|(place, _)| place.kind == kind)
            .map(|(_, level)| *level)
            .collect();
        let level = |(number, level): (usize, &KindLevel)| KindLevelReport {
            kind: level.report.kind,
            plants: own.iter().filter(|own| **own == Some(number)).count(),
            triangles: level.parts.triangles,
            draws: level.parts.draws,
            gpu_bytes: level.parts.gpu_bytes,
            pixels_high: Some(level.report.pixels_high).filter(|px| px.is_finite()),
            difference: level.report.difference.difference,
        };
        let levels = self.kinds[kind].levels.iter().enumerate();
        KindReport {
            name: stand.kinds[kind].name.clone(),
            plants: own.len(),
            seen_plants: own.iter().flatten().count(),
            levels: levels.map(level).collect(),
        }
    }
}
