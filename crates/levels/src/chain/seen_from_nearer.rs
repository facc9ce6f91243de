//! Levels that are looked at from nearer than they are made for: in a viewer, or in a picture of 512 pixels.

use super::level_as_drawn::MOST_MORE_SPECKS;
use super::level_surfaces::{LevelSurfaces, retextured};
use super::textures::{Chosen, Client};

/// About as high as `measure --as-drawn 512` shows a plant.
const NEARER_PX: f64 = 300.0;

impl Client<'_> {
    /// Keeps the `exact` textures of a level that begins at this height in pixels, or takes the `smooth` ones if
    /// they suit the level too and show fewer specks where the plant is 300 pixels high. Those are made with the
    /// same mip maps or none, as the exact ones are.
    pub(super) fn calmer(
        &self,
        level: &LevelSurfaces,
        begin_px: f64,
        exact: Chosen,
        smooth: impl FnOnce() -> Option<Chosen>,
    ) -> Chosen {
        if begin_px >= NEARER_PX {
            return exact;
        }
        let more_specks = |of: &Chosen| {
            let surfaces = retextured(level, &of.textures);
            self.more_specks_at(&surfaces, NEARER_PX)
        };
        let specks = more_specks(&exact);
        if specks <= MOST_MORE_SPECKS {
            return exact;
        }
        let is_calmer = |of: &Chosen| of.as_drawn.is_within() && more_specks(of) < specks;
        smooth().filter(is_calmer).unwrap_or(exact)
    }
}
