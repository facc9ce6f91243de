//! The levels of each kind, for the heights at which its plants are seen.

use secateur_eval::{Difference, StandKind};
use secateur_gltf::Document;
use secateur_gltf::chain::Layout;
use secateur_levels::chain::{LevelKind, LevelParts, LevelReport, Wanted};
use secateur_model::Note;
use secateur_simplify::Observer;

use super::read::drawn;
use super::{PlantKind, StandOptions};
use crate::{Error, Session};

/// The most heights that a kind has levels for: with the plant itself as many as a chain may have.
const MOST_HEIGHTS: usize = 7;

/// The difference that levels may have alone at the height that they are made for: whether it is seen, pictures of the
/// stand say. Coarser ones are other plants.
const MOST_DIFFERENCE: f64 = Difference::ANOTHER_PLANT;

/// The first level is made for so many times the largest height: so there are finer ones than that difference for the
/// nearest plants too.
const FIRST: f64 = 2.0;

/// The least height that a level is made for, in pixels.
const LEAST_PX: f64 = 8.0;

/// The levels of a kind, finest first; the first is the plant itself.
#[derive(Debug)]
pub struct KindLevels {
    /// The levels.
    pub levels: Vec<KindLevel>,
    /// What was asked for and left out, and the like, a sentence each.
    pub notes: Vec<Note>,
}

/// A level of a kind.
#[derive(Debug)]
pub struct KindLevel {
    /// Its figures.
    pub report: LevelReport,
    /// What one plant of it costs, and its bytes: those that are there once for all plants that show it.
    pub parts: LevelParts,
    pub(super) document: Document,
    pub(super) drawn: StandKind,
}

impl PlantKind {
    /// The plant itself as the only level: of kinds that no camera sees.
    pub(super) fn as_it_is(&self) -> Result<KindLevels, Error> {
        Ok(KindLevels {
            levels: vec![self.itself()],
            notes: Vec::new(),
        })
    }

    fn itself(&self) -> KindLevel {
        let report = self.plant.report();
        let cost = self.document.cost();
        KindLevel {
            parts: LevelParts {
                triangles: report.triangles,
                draws: cost.draws,
                bytes: cost.bytes,
                gpu_bytes: cost.geometry_bytes,
            },
            report,
            document: self.document.clone(),
            drawn: self.drawn.clone(),
        }
    }

    /// Levels for heights from the largest to the least at which a plant of the kind is seen, in pixels.
    pub(super) fn levels(
        &self,
        [largest_px, least_px]: [f64; 2],
        options: &StandOptions,
        session: &Session,
        observer: &mut Observer<'_>,
    ) -> Result<KindLevels, Error> {
        let mut of_kind = options.levels.clone();
        of_kind.wanted = Wanted::Heights(heights(largest_px, least_px, of_kind.screen.height_px));
        of_kind.original = true;
        of_kind.max_difference = MOST_DIFFERENCE;
        let levels = self.plant.levels_on(session, &of_kind, observer)?;
        let levels = levels.named(self.name.clone());
        let written = levels.to_bytes(Layout::Files)?;
        let mut found = vec![self.itself()];
        let pairs = levels
            .chain
            .levels
            .iter()
            .zip(written.files)
            .zip(written.costs);
        for ((level, file), cost) in pairs {
            let report = level.report.clone();
            if report.kind == LevelKind::Original {
                found[0].parts.gpu_bytes += report.texture_bytes;
                continue;
            }
            let document = Document::from_bytes(&file.name, file.bytes, self.document.folder())?;
            found.push(KindLevel {
                parts: LevelParts {
                    triangles: report.triangles,
                    draws: cost.draws,
                    bytes: cost.bytes,
                    gpu_bytes: report.texture_bytes + cost.geometry_bytes,
                },
                drawn: drawn(&document)?,
                document,
                report,
            });
        }
        Ok(KindLevels {
            levels: found,
            notes: levels.chain.notes.clone(),
        })
    }
}

/// From twice the largest height on each half of the one before, to the least one.
fn heights(largest_px: f64, least_px: f64, screen_px: f64) -> Vec<f64> {
    let first = (FIRST * largest_px).clamp(LEAST_PX, screen_px.max(LEAST_PX));
    let halves = (0..MOST_HEIGHTS as i32).map(|k| first / 2f64.powi(k));
    let least = least_px.max(LEAST_PX);
    let mut heights: Vec<f64> = halves.take_while(|px| *px > least).collect();
    // One that all plants may show.
    if heights.len() < MOST_HEIGHTS {
        heights.push(least.min(first));
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::heights;

    #[test]
    fn heights_go_from_the_largest_plant_to_the_smallest() {
        assert_eq!(heights(100.0, 30.0, 1080.0), [200.0, 100.0, 50.0, 30.0]);
        assert_eq!(heights(f64::INFINITY, 900.0, 1080.0), [1080.0, 900.0]);
        assert_eq!(heights(2.0, 1.0, 1080.0), [8.0]);
        assert_eq!(heights(1000.0, 1.0, 1080.0).len(), 7);
    }
}
