//! A level where it stands in a chain: with its textures, and judged as it is put down.

use secateur_eval::{Difference, Shown};
use secateur_gltf::chain::LevelTexture;
use secateur_model::Surface;
use secateur_simplify::{Observer, Progress};

use super::cards::FAR_PX;
use super::error::ChainError;
use super::level_surfaces::{LevelSurfaces, retextured};
use super::maker::{Made, Maker};
use super::smaller_base_colors::smaller_base_colors;
use super::stage_clock::ChainStage;
use super::texture_bytes::texture_bytes;
use super::textures::{Chosen, Client, Textures};

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

/// Where a level stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Heights on the screen in pixels from which, and down to which, it is seen.
    pub(super) range: [f64; 2],
    /// Whether it is the finest: what is seen from near by, too.
    pub(super) is_first: bool,
    /// How many times the limits it may be in the pictures of a search, so that it is within them in its own.
    pub(super) goal: f64,
}

impl Place {
    /// A place whose own pictures show about what those of a search do.
    pub(super) fn new(range: [f64; 2], is_first: bool) -> Self {
        Self {
            range,
            is_first,
            goal: 1.0,
        }
    }
}

/// Where clients show less than this share of what there is, textures of the plant are no way out: `ez_bush2` 16 pixels
/// high would be there by a judge without mip maps, and .09 of it in clients.
pub(super) const LEAST_SHOWN: f64 = 0.5;

/// Texels along a pixel that are tried, without mip maps, where those of about a pixel look too coarse, and the plant's
/// own fade or are far more than a far level needs.
const TEXELS_A_PIXEL: [f64; 2] = [2.0, 4.0];

/// How many times as many texels smaller base colours have along a side, one after the other until some look as they
/// should.
const FINER: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// A level with the textures that it has at a place.
struct Dressed {
    made: Made,
    chosen: Chosen,
    surfaces: Vec<Surface>,
}

impl Maker<'_> {
    /// A level with leaves and textures that cover what they should over a range of heights, and judged with them.
    /// Textures that would take it beyond the limits are not taken.
    pub(super) fn placed(
        &self,
        made: Made,
        place: Place,
        client: &Client<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Placed, ChainError> {
        Progress::Finish.tell(observer)?;
        let dress = || self.dressed(made, place, client);
        let dressed = self.look.clock.time(ChainStage::Textures, dress)?;
        let difference = self.look.difference(&dressed.surfaces, place.range[0]);
        Ok(Placed {
            made: dressed.made,
            chosen: dressed.chosen,
            range: place.range,
            difference,
        })
    }

    fn dressed(
        &self,
        made: Made,
        place: Place,
        client: &Client<'_>,
    ) -> Result<Dressed, ChainError> {
        let made = self.covering(made, place, client)?;
        let (level, range) = (&made.drawn.level, place.range);
        let mut chosen = client.choose(level, range, self.options.textures, place.is_first);
        let mut surfaces = retextured(level, &chosen.textures);
        let is_beyond = |surfaces: &[Surface]| {
            let kept = self.look.over_in_search(&made.drawn, range[0]);
            self.look.over_of_surfaces(surfaces, range[0]) > kept.max(place.goal)
        };
        if !chosen.keeps_textures && is_beyond(&surfaces) {
            let as_it_was = client.kept(level, range);
            let fades = |shown: &Shown| shown.coverage_over_truth < LEAST_SHOWN;
            let is_far = range[0] <= FAR_PX;
            let finer = TEXELS_A_PIXEL
                .iter()
                .filter(|_| is_far || fades(&as_it_was.as_drawn.end));
            let own = finer
                .filter_map(|texels| client.fitted_without_mips(level, range, *texels))
                .map(|own| (retextured(level, &own.textures), own))
                .find(|(own, _)| !is_beyond(own));
            if let Some((own_surfaces, own)) = own {
                (surfaces, chosen) = (own_surfaces, own);
            } else if place.is_first || !fades(&as_it_was.as_drawn.begin) {
                chosen = as_it_was;
                surfaces = retextured(level, &chosen.textures);
            }
        }
        if !place.is_first && self.options.textures == Textures::Fit {
            let pixels = client.pixels_a_unit(range[0]);
            // Pictures of a few pixels are looked at in full as soon as in a search.
            let is_within = |surfaces: &[Surface]| {
                let full = || self.look.difference(surfaces, range[0]);
                !is_beyond(surfaces) || range[0] <= FAR_PX && full().over(self.look.limits) <= 1.0
            };
            let smaller = FINER.iter().find_map(|finer| {
                let own = self.smaller_base_colors(level, &chosen.textures, finer * pixels)?;
                let dressed = retextured(level, &own);
                is_within(&dressed).then_some((dressed, own))
            });
            if let Some(smaller) = smaller {
                (surfaces, chosen.textures) = smaller;
            }
            let document = self.tree.items().document();
            let maps = self.smaller_images.of(level, document, pixels);
            chosen.textures.extend(maps);
        }
        let has_own = |material| {
            let mut own = chosen.textures.iter().filter(|own| own.image.is_none());
            own.any(|own| own.material == material)
        };
        let filled = made.filled.iter().filter(|one| !has_own(one.material));
        let filled: Vec<LevelTexture> = filled.cloned().collect();
        chosen.textures.extend(filled);
        Ok(Dressed {
            made,
            chosen,
            surfaces,
        })
    }

    /// These textures of a level with smaller base colours for what is not cut out, where a unit of length is `pixels`
    /// pixels; none where that saves nothing.
    fn smaller_base_colors(
        &self,
        level: &LevelSurfaces,
        textures: &[LevelTexture],
        pixels: f64,
    ) -> Option<Vec<LevelTexture>> {
        let document = self.tree.items().document();
        let own = smaller_base_colors(level, document, pixels);
        let bytes = |own: &[LevelTexture]| texture_bytes(document, &level.materials, own);
        let all = [textures, &own].concat();
        (bytes(&all) < bytes(textures)).then_some(all)
    }

    /// The share of what there is that a client shows of a level where it ends, if it ends at this height in pixels.
    pub(super) fn shown_down_to(&self, placed: &Placed, end: f64, client: &Client<'_>) -> f64 {
        let surfaces = retextured(&placed.made.drawn.level, &placed.chosen.textures);
        let as_drawn = self.look.clock.time(ChainStage::Textures, || {
            client.as_drawn(&surfaces, [placed.begins(), end])
        });
        as_drawn.end.coverage_over_truth
    }

    /// A level for a range that ends elsewhere, if it is within the limits there too.
    pub(super) fn placed_down_to(
        &self,
        placed: Placed,
        end: f64,
        is_first: bool,
        client: &Client<'_>,
    ) -> Result<Placed, ChainError> {
        let place = Place::new([placed.begins(), end], is_first);
        if place.range == placed.range {
            return Ok(placed);
        }
        // Colours and outlines where it begins are what they were.
        let surfaces = retextured(&placed.made.drawn.level, &placed.chosen.textures);
        let clock = &self.look.clock;
        let as_drawn = clock.time(ChainStage::Textures, || {
            client.as_drawn(&surfaces, place.range)
        });
        let as_before = |as_drawn| Placed {
            chosen: Chosen {
                as_drawn,
                ..placed.chosen.clone()
            },
            range: place.range,
            ..placed.clone()
        };
        if as_drawn.is_within() {
            return Ok(as_before(as_drawn));
        }
        let again = clock.time(ChainStage::Textures, || {
            self.dressed(placed.made.clone(), place, client)
        })?;
        if again.surfaces == surfaces {
            return Ok(as_before(again.chosen.as_drawn));
        }
        let difference = self.look.difference(&again.surfaces, placed.begins());
        if difference.over(self.look.limits) > 1.0 {
            return Ok(placed);
        }
        Ok(Placed {
            made: again.made,
            chosen: again.chosen,
            range: place.range,
            difference,
        })
    }
}
