//! Which levels a chain has, and how they are made.

use std::ops::RangeInclusive;

use secateur_eval::Limits;
use secateur_gltf::chain::MAX_LEVELS;
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Amount, Method, Options, Target};
use serde::{Deserialize, Serialize};

use super::cost::CostWeights;
use super::error::BadOptions;
use super::scene_look::SceneLook;
use super::textures::Textures;
use crate::impostor::Choice;
use secateur_runtime::{SCREEN_HEIGHTS_PX, Screen};

/// Heights on a screen of 1080 pixels for which levels are made where nothing else is asked for.
pub const HEIGHTS_PX: [f64; 7] = [1080.0, 540.0, 270.0, 135.0, 64.0, 32.0, 16.0];

/// The least height at which a level begins, in pixels: a block of the judge.
pub(super) const LEAST_PX: f64 = 8.0;

/// The least bound of the textures that impostors of a chain take on the GPU, in bytes.
pub(super) const LEAST_BOUND_BYTES: u64 = 1 << 20;

/// The largest difference that can be asked for: no figure is above 1.75.
pub const MOST_DIFFERENCE: f64 = 2.0;

/// Distances from which levels may be asked for, in units of the file: a value outside is taken for a
/// typing error.
pub const DISTANCES: RangeInclusive<f64> = 0.01..=1e6;

/// Which levels a chain has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wanted {
    /// As [`Heights`](Self::Heights), for [`HEIGHTS_PX`] in proportion to the height of the screen.
    UsualHeights,
    /// Levels of these numbers of triangles of the whole plant, finest first.
    Triangles(Vec<Amount>),
    /// For each of these heights on the screen in pixels, the largest first, the fewest triangles within the
    /// difference.
    Heights(Vec<f64>),
    /// For each of these distances in units of the file (metres), the nearest first, the fewest
    /// triangles within the difference.
    Distances(Vec<f64>),
}

/// How a chain is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChainOptions {
    /// Which levels are made: shares, numbers of triangles, or heights.
    pub wanted: Wanted,
    /// The screen and camera that distances are for.
    #[serde(with = "ScreenFields")]
    pub screen: Screen,
    /// The [difference](secateur_eval::Difference) that a level may have at the height from which it is seen, above
    /// 0 and at most 2. Its companion `block_coverage` may be as much in proportion ([`Limits::of_difference`]).
    pub max_difference: f64,
    /// Whether the chain begins with the plant itself, from distance 0 to where the first lighter level may stand.
    pub original: bool,
    /// Whether all of the file is one plant, such as a hedge: else what stands apart is judged, and made lighter, by
    /// itself.
    pub as_one: bool,
    /// How high the plant really is in metres, where the file's unit is not a metre.
    pub plant_height_m: Option<f64>,
    /// How leaves are simplified; its target is not looked at.
    pub leaves: Options,
    /// What becomes of the wood; it stays as it is for [`WoodMode::Keep`] and [`WoodMode::Ignore`].
    pub wood: WoodMode,
    /// Which impostor the chain ends in. Where nothing is said [`Choice::Auto`] for heights and distances, and none
    /// after levels of numbers of triangles.
    pub impostor: Option<Choice>,
    /// How many levels coarser what casts a level's shadow is, 0 to 2.
    pub shadow_steps: usize,
    /// The largest difference between a level and the next where they switch; a level that would differ more from
    /// the one before it is left out.
    pub max_pop: Option<f64>,
    /// Whether levels are nested and say how one becomes the next: what is gone from a level is gone from all coarser
    /// ones, and each mesh before another has the attribute `_MORPH`. Leaves must be chosen by [`Method::Vds`].
    pub morph: bool,
    /// Which textures leaves have.
    pub textures: Textures,
    /// What the parts of a level count for where the one that costs less is taken.
    pub cost: CostWeights,
    /// How many bytes the textures of all impostors of the chain may take on the GPU; as many as those of the plant
    /// itself, and at least 1 MiB, where nothing is said.
    pub impostor_texture_bytes: Option<u64>,
    /// Where levels are judged from and what stands before them; from all around, with nothing
    /// about the plant, where there is no scene.
    #[serde(skip)]
    pub scene: Option<SceneLook>,
}

/// The fields of a screen, as files have them.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Screen", deny_unknown_fields)]
struct ScreenFields {
    height_px: f64,
    field_of_view_degrees: f64,
}

impl Default for ChainOptions {
    /// The plant itself, levels for [`HEIGHTS_PX`] on the default screen within [`Limits::GOOD`], and an impostor
    /// where one is lighter and good enough.
    fn default() -> Self {
        let mut leaves = Options::to(Target::triangle_share(1.0));
        leaves.audit = false;
        // Levels have figures of their own, from views that drove none of them.
        leaves.shows_what_is_left = false;
        Self {
            wanted: Wanted::UsualHeights,
            screen: Screen::default(),
            max_difference: Limits::GOOD.difference,
            original: true,
            as_one: false,
            plant_height_m: None,
            leaves,
            wood: WoodMode::Auto,
            impostor: None,
            shadow_steps: 1,
            max_pop: None,
            morph: false,
            textures: Textures::Fit,
            cost: CostWeights::default(),
            impostor_texture_bytes: None,
            scene: None,
        }
    }
}

impl ChainOptions {
    /// How much levels may differ.
    pub fn limits(&self) -> Limits {
        Limits::of_difference(self.max_difference)
    }

    /// The heights on the screen in pixels that levels are sought for, the largest first; none where numbers of
    /// triangles or distances are asked for. The usual ones are those of 8 pixels and more, and the first in any case.
    pub fn heights_px(&self) -> Vec<f64> {
        match &self.wanted {
            Wanted::UsualHeights => {
                let heights =
                    HEIGHTS_PX.map(|height| height * self.screen.height_px / HEIGHTS_PX[0]);
                let [first, others @ ..] = heights;
                let others = others.into_iter().filter(|height| *height >= LEAST_PX);
                std::iter::once(first).chain(others).collect()
            }
            Wanted::Heights(heights) => heights.clone(),
            Wanted::Triangles(_) | Wanted::Distances(_) => Vec::new(),
        }
    }

    /// Which impostor the chain ends in, whether that was said or not.
    pub fn chosen_impostor(&self) -> Choice {
        self.impostor.unwrap_or(match self.wanted {
            Wanted::Triangles(_) => Choice::None,
            Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Distances(_) => Choice::Auto,
        })
    }

    /// Whether there are levels, not too many, ever coarser ones, and all numbers are in range.
    ///
    /// # Errors
    /// [`BadOptions`], which names the option that is out of range.
    pub fn check(&self) -> Result<(), BadOptions> {
        let out_of_range = |what| Err(BadOptions::OutOfRange(what));
        let (count, falls) = match &self.wanted {
            Wanted::Triangles(amounts) => {
                let of = |amount: &Amount| match amount {
                    Amount::Count(count) => *count as f64,
                    Amount::Share(share) => *share,
                };
                (
                    amounts.len(),
                    amounts.windows(2).all(|w| of(&w[0]) > of(&w[1])),
                )
            }
            Wanted::UsualHeights => (HEIGHTS_PX.len(), true),
            Wanted::Heights(heights) => (heights.len(), heights.windows(2).all(|w| w[0] > w[1])),
            Wanted::Distances(distances) => {
                (distances.len(), distances.windows(2).all(|w| w[0] < w[1]))
            }
        };
        if let Wanted::Triangles(amounts) = &self.wanted
            && amounts.iter().any(|amount| amount.of(usize::MAX) == 0)
        {
            return Err(BadOptions::NoTriangles);
        }
        let is_above_zero = |x: f64| x.is_finite() && x > 0.0;
        let is_difference = |x: f64| x > 0.0 && x <= MOST_DIFFERENCE;
        if let Wanted::Heights(all) = &self.wanted
            && !all.iter().all(|x| is_above_zero(*x))
        {
            return out_of_range("heights of levels must be above 0");
        }
        if let Wanted::Distances(all) = &self.wanted
            && !all.iter().all(|x| DISTANCES.contains(x))
        {
            return out_of_range("distances of levels must be from 0.01 to 1,000,000");
        }
        if !SCREEN_HEIGHTS_PX.contains(&self.screen.height_px) {
            return out_of_range("a screen must be from 16 to 100,000 pixels high");
        }
        let degrees = self.screen.field_of_view_degrees;
        if !(is_above_zero(degrees) && degrees < 180.0) {
            return out_of_range("a field of view must be above 0 and below 180 degrees");
        }
        match (count, falls) {
            (0, _) => Err(BadOptions::NoLevel),
            (count, _) if count > MAX_LEVELS => Err(BadOptions::TooManyLevels(count)),
            // After numbers of triangles an impostor is a level more.
            (MAX_LEVELS, _)
                if self.chosen_impostor() != Choice::None
                    && matches!(self.wanted, Wanted::Triangles(_)) =>
            {
                Err(BadOptions::NoRoomForImpostor)
            }
            (_, false) if matches!(self.wanted, Wanted::Distances(_)) => {
                Err(BadOptions::NotFarther)
            }
            (_, false) => Err(BadOptions::NotCoarser),
            _ if self.shadow_steps > 2 => {
                out_of_range("what casts a shadow is at most two levels coarser")
            }
            _ if !self.max_pop.is_none_or(is_difference) => {
                out_of_range("the difference that a switch may show must be above 0 and at most 2")
            }
            _ if self.morph && !matches!(self.leaves.method, Method::Vds(_)) => {
                out_of_range("nested levels are made by the method vds")
            }
            _ if !self.cost.are_in_range() => {
                out_of_range("the weights of a cost must be 0 or more, and not all 0")
            }
            _ if !is_difference(self.max_difference) => {
                out_of_range("the difference that a level may have must be above 0 and at most 2")
            }
            _ if !self.plant_height_m.is_none_or(is_above_zero) => {
                out_of_range("the height of a plant must be above 0 metres")
            }
            _ => Ok(()),
        }
    }
}
