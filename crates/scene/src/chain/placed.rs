//! A level where it stands in a chain: with its textures, and judged as it is put down.

use secateur_eval::Difference;
use secateur_simplify::{Observer, Progress};

use super::error::ChainError;
use super::level_surfaces::retextured;
use super::maker::{Made, Maker};
use super::textures::{Chosen, Client};

/// A level, where it is seen, and how far it looks from the plant there.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) made: Made,
    /// Its textures.
    pub(super) chosen: Chosen,
    /// Heights on the screen in pixels from which, and down to which, it is seen.
    pub(super) range: [f64; 2],
    /// With these textures, where it begins.
    pub(super) difference: Difference,
}

impl Placed {
    pub(super) fn triangles(&self) -> usize {
        self.made.triangles()
    }

    /// Height on the screen where it begins, in pixels.
    pub(super) fn begins(&self) -> f64 {
        self.range[0]
    }
}

impl Maker<'_> {
    /// A level with leaves and textures that cover what they should over a range of heights, and judged with them.
    /// Textures that would take it beyond the limits are not taken.
    pub(super) fn placed(
        &self,
        made: Made,
        range: [f64; 2],
        is_first: bool,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Placed, ChainError> {
        Progress::Finish.tell(observer)?;
        let made = self.covering(made, range, client)?;
        let level = &made.drawn.level;
        let mut chosen = client.choose(level, range, self.options.textures, is_first);
        let mut surfaces = retextured(level, &chosen.textures);
        if !chosen.keeps_textures {
            let kept = self.look.over_in_search(&made.drawn, range[0]);
            let own = self.look.over_of_surfaces(&surfaces, range[0]);
            if own > kept.max(1.0) {
                chosen = client.kept(level, range);
                surfaces = retextured(level, &chosen.textures);
            }
        }
        let difference = self.look.difference(&surfaces, range[0]);
        Ok(Placed {
            made,
            chosen,
            range,
            difference,
        })
    }

    /// The same level for a range that ends elsewhere, if it is within the limits there too.
    pub(super) fn placed_down_to(
        &self,
        placed: Placed,
        end: f64,
        is_first: bool,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Placed, ChainError> {
        let range = [placed.begins(), end];
        if range == placed.range {
            return Ok(placed);
        }
        // Colours and outlines where it begins are what they were.
        let surfaces = retextured(&placed.made.drawn.level, &placed.chosen.textures);
        let as_drawn = client.as_drawn(&surfaces, range);
        if as_drawn.is_within() {
            let chosen = Chosen {
                as_drawn,
                ..placed.chosen
            };
            return Ok(Placed {
                chosen,
                range,
                ..placed
            });
        }
        let again = self.placed(placed.made.clone(), range, is_first, client, observer)?;
        let is_within = again.difference.over(self.look.limits) <= 1.0;
        Ok(if is_within { again } else { placed })
    }
}
