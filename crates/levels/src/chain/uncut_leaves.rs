//! Leaves without holes: no texture can make a client show more of them, so where a level shows too little
//! of the plant, or too much, they grow or shrink.
//!
//! The sizes of leaves are fitted to what the leaves covered; what thin wood covered that is gone from a
//! level is missing from it. Seen as small as a level is, it counts for a tenth of a birch.

use secateur_model::AlphaMode;

use super::error::ChainError;
use super::maker::{Made, Maker};
use super::placed::Place;
use super::textures::Client;

/// Coverage that is no farther off than this is left alone: in other views it is then within a tenth.
const NEAR_ENOUGH: f64 = 0.05;

/// How often other sizes are tried.
const TRIES: usize = 4;

/// Leaves hide each other, and wood has its share: coverage changes by less than the area of leaves. Of it
/// this power is tried.
const POWER: f64 = 1.5;

/// The areas of leaves are multiplied by no less and no more.
const RANGE: [f64; 2] = [0.5, 2.0];

impl Maker<'_> {
    /// The level with leaves of such sizes that it covers about what it should over a range of heights.
    pub(super) fn covering(
        &self,
        made: Made,
        place: Place,
        client: &Client<'_>,
    ) -> Result<Made, ChainError> {
        let range = place.range;
        let original = &self.look.original.surfaces;
        if original.iter().any(|s| is_cut_out(s.material.alpha_mode)) {
            return Ok(made);
        }
        let over = |made: &Made| self.look.over_in_search(&made.drawn, range[0]);
        let mut seen = client.as_drawn(&made.drawn.level.surfaces, range);
        let mut best = (seen.coverage_error(), made.clone());
        let mut most_over = None;
        let mut factor = 1.0;
        let mut step = seen.wanted_gain().powf(POWER);
        for _ in 0..TRIES {
            if seen.coverage_error() <= NEAR_ENOUGH {
                break;
            }
            // To grow must not cost what was asked for; what is beyond it anyhow stays as near as it is.
            let most_over = *most_over.get_or_insert_with(|| over(&made).max(place.goal));
            let tried = f64::clamp(factor * step, RANGE[0], RANGE[1]);
            let next = self.resized(&made, tried)?;
            if over(&next) > most_over {
                step = step.sqrt();
                continue;
            }
            factor = tried;
            seen = client.as_drawn(&next.drawn.level.surfaces, range);
            step = seen.wanted_gain().powf(POWER);
            if seen.coverage_error() < best.0 {
                best = (seen.coverage_error(), next);
            }
        }
        Ok(best.1)
    }

    /// The level with leaves of this many times the area.
    fn resized(&self, made: &Made, factor: f64) -> Result<Made, ChainError> {
        let mut parts = made.parts.clone();
        for level in &mut parts {
            let passes = &mut level.leaves.passes;
            let count = level.leaves.lod.all_leaves().count();
            let sizes = passes.sizes.take().unwrap_or_else(|| vec![1.0; count]);
            passes.sizes = Some(sizes.into_iter().map(|size| size * factor).collect());
            level.leaves.lod = level.leaves.passes.lod();
        }
        self.made(parts)
    }
}

fn is_cut_out(mode: AlphaMode) -> bool {
    matches!(mode, AlphaMode::Mask(_))
}
