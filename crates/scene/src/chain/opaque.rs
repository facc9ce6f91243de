//! Leaves without holes: no texture can make a client show more of them, so where a level shows too little
//! of the plant, or too much, they grow or shrink.
//!
//! The sizes of leaves are fitted to what the leaves covered; what thin wood covered that is gone from a
//! level is missing from it. Seen as small as a level is, it counts for a tenth of a birch.

use secateur_model::AlphaMode;
use secateur_simplify::{Observer, Progress};

use super::error::ChainError;
use super::look::Drawn;
use super::maker::{Made, Maker};
use super::textures::{Client, end_of};
use super::which::Placed;

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
    /// The levels, each of which covers about what it should from where it begins to where the next does, or
    /// whatever follows them begins.
    pub(super) fn covering(
        &self,
        placed: Vec<Placed>,
        followed_at: Option<f64>,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<Placed>, ChainError> {
        if self
            .look
            .original
            .iter()
            .any(|s| is_cut_out(s.material.alpha_mode))
        {
            return Ok(placed);
        }
        let mut ends: Vec<Option<f64>> = placed.iter().skip(1).map(|(_, h, _)| Some(*h)).collect();
        ends.push(followed_at);
        let levels = placed.into_iter().zip(ends);
        levels
            .map(|((made, height, flip), end)| {
                Progress::Finish.tell(observer)?;
                let (made, flip) = self.in_other_sizes(client, (made, flip), height, end)?;
                Ok((made, height, flip))
            })
            .collect()
    }

    fn in_other_sizes(
        &self,
        client: &Client<'_>,
        (made, flip): (Made, f64),
        height: f64,
        end: Option<f64>,
    ) -> Result<(Made, f64), ChainError> {
        let range = [height, end_of(height, end)];
        let mut seen = client.as_drawn(&made.drawn.level.surfaces, range);
        // To grow must not cost what was asked for; what is beyond it anyhow stays as near as it is.
        let most_flip = self.options.max_flip.max(flip);
        let mut best = (seen.coverage_error(), made.clone(), flip);
        let mut factor = 1.0;
        let mut step = seen.wanted_gain().powf(POWER);
        for _ in 0..TRIES {
            if seen.coverage_error() <= NEAR_ENOUGH {
                break;
            }
            let tried = f64::clamp(factor * step, RANGE[0], RANGE[1]);
            let next = self.resized(&made, tried)?;
            let flip = self.flip(&next, height);
            if flip > most_flip {
                step = step.sqrt();
                continue;
            }
            factor = tried;
            seen = client.as_drawn(&next.drawn.level.surfaces, range);
            step = seen.wanted_gain().powf(POWER);
            if seen.coverage_error() < best.0 {
                best = (seen.coverage_error(), next, flip);
            }
        }
        Ok((best.1, best.2))
    }

    /// The level with leaves of this many times the area.
    fn resized(&self, made: &Made, factor: f64) -> Result<Made, ChainError> {
        let mut level = made.level.clone();
        let passes = &mut level.leaves.passes;
        let count = level.leaves.lod.all_leaves().count();
        let sizes = passes.sizes.take().unwrap_or_else(|| vec![1.0; count]);
        passes.sizes = Some(sizes.into_iter().map(|size| size * factor).collect());
        level.leaves.lod = level.leaves.passes.lod();
        let lod = self.tree.joined(&level.leaves.lod, &level.wood);
        let document = self.tree.items().lod_document(&lod)?;
        Ok(Made {
            drawn: Drawn::of(&document)?,
            level,
            lod,
            foliage_triangles: made.foliage_triangles,
        })
    }
}

fn is_cut_out(mode: AlphaMode) -> bool {
    matches!(mode, AlphaMode::Mask(_))
}
