//! Whole plants: one budget of triangles for leaves and wood.

mod bare;
mod budget;
mod crowned;
mod held_leaves;
mod keeping_wood;
mod solid_wood;
mod wood_mode;

use std::borrow::Cow;
use std::sync::Arc;

use secateur_model::{Foliage, Lod, RemovalOrder};
use secateur_raster::occluders::Occluded;
use secateur_raster::{OpenEngine, Rasteriser, ViewSet};

pub use budget::{Budget, Sharing};
use crowned::Crowned;
pub use keeping_wood::{simplify_keeping_wood, simplify_keeping_wood_sharing};
pub use wood_mode::WoodMode;

use crate::fill::is_met;
use crate::observe::seen_px;
use crate::stage::Observer;
use crate::wood::{Chosen, Parts, Wood, WoodBudget, crown_and_rest};
use crate::{
    Error, Fitting, Options, Shared, Simplified, Target, Views, Warning, simplify_on,
    simplify_sharing, sphere_of,
};

/// Pixels a side of views that judge plants without leaves: half of a crown of three balls is .20 from it, .35 by 512.
const BARE_RESOLUTION: u32 = 256;

/// The most pixels over all views in which levels are judged: 32 views of 512 x 512.
const MOST_PIXELS: usize = 1 << 23;

/// What is hidden at first counts this much of what is seen: leaves that go lay some of it bare.
/// Other values were not tried.
const HIDDEN_WEIGHT: f64 = 0.1;

/// [`Sharing::LeafMargin`] of levels with a fifth of the triangles or more, where no other is asked for. Seven plants at ten
/// shares, .1 to .7, 270 pixels high, are beyond the limits of the default difference in 15, 14, 12, 14 and 18 of 70 cases
/// with .05, .1, .15, .2 and .3; their geometric means over the limits are .60, .61, .61, .63 and .65 (example
/// `wood_and_leaves`).
const LEAF_MARGIN: f64 = 0.15;

/// [`Sharing::LeafMargin`] of levels with a tenth of the triangles or fewer: with .15 FLIP at a tenth is 1.05 times as
/// large in the geometric mean of ten plants, 1.27 on `ez_bush2` (`secateur study --plan whole`).
const LEAF_MARGIN_OF_FEW: f64 = 0.3;

/// Between a tenth and a fifth of all triangles the margin times the share is this.
const MARGIN_TIMES_SHARE: f64 = 0.03;

/// Wood gets at most this share of a budget that cannot hold all.
const MOST_WOOD: f64 = 0.5;

/// Pixels along a side of the views in which levels of wood are judged, at most this many.
fn level_resolution(most: u32, views: usize) -> u32 {
    let mut resolution = most;
    while resolution > 1 && views * (resolution as usize).pow(2) > MOST_PIXELS {
        resolution /= 2;
    }
    resolution
}

/// A plant's leaves and wood, looked at once for any number of levels.
#[derive(Clone, Debug)]
pub struct WholePlant<'a> {
    leaves: Cow<'a, Foliage>,
    wood: Cow<'a, Foliage>,
    /// The wood as it was, which hides leaves at every level, so that levels share one order. With it
    /// FLIP at a tenth of all triangles was .0220 instead of .0231 on a willow, .0220 for .0224 on
    /// an oak, .0260 for .0262 on a birch, the same on `quat_commontree_1`, and .0641 for .0639 on a
    /// palmetto.
    occluders: Arc<Foliage>,
    levels: Wood,
    /// Pixels that the views show of leaves.
    leaves_px: f64,
    /// What a plant without leaves has for a crown.
    crowned: Option<Box<Crowned>>,
    /// Whether solid pieces in the air are the larger part of the wood.
    has_solid_crown: bool,
}

/// A level of a whole plant.
#[derive(Clone, Debug)]
pub struct WholeLevel {
    /// What came of the leaves.
    pub leaves: Simplified,
    /// What is left of the wood.
    pub wood: Lod,
    /// Number of triangles that `wood` has.
    pub wood_triangles: usize,
    /// By part of the wood whether a level that is nested in this one has nothing of it; empty where it may have all.
    pub wood_gone: Vec<bool>,
    /// How far leaves may be from the wood, or from a lower leaf that rests on it, in world units:
    /// what is further is gone, where triangles were the target. Nothing where no leaf was looked at
    /// for it.
    pub leaf_gap: Option<f64>,
}

/// What is left of the wood.
#[derive(Clone, Debug)]
struct WoodLevel {
    chosen: Chosen,
    lod: Lod,
    triangles: usize,
}

impl<'a> WholePlant<'a> {
    /// Looks at the plant, and finds how far each piece of wood can be simplified. `items` are the
    /// leaves and then the wood.
    ///
    /// # Errors
    /// [`Error`] if there is neither leaf nor wood, the plant is out of range, or the rasteriser fails.
    pub fn new(
        items: &Foliage,
        leaves: &'a Foliage,
        wood: &'a Foliage,
        engine: &OpenEngine,
    ) -> Result<Self, Error> {
        let usual = Options::to(Target::triangle_share(1.0));
        Self::within(items, leaves, wood, &usual, engine)
    }

    /// As [`Self::new`]; but where the options have [`Options::occluders`] it is looked at among these,
    /// and from cameras that the caller has placed, if there are any. So wood that they hide goes
    /// first too.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn within(
        items: &Foliage,
        leaves: impl Into<Cow<'a, Foliage>>,
        wood: impl Into<Cow<'a, Foliage>>,
        options: &Options,
        engine: &OpenEngine,
    ) -> Result<Self, Error> {
        let (leaves, wood) = (leaves.into(), wood.into());
        let sphere = sphere_of(items)?;
        if !leaves.leaves().is_empty() {
            sphere_of(&leaves)?;
        }
        let occluders = options.occluders.as_deref();
        let views = match (&options.views, occluders) {
            (Views::Cameras(views), Some(_)) => views.clone(),
            _ => ViewSet::dodecahedron(sphere),
        };
        let occluders = occluders.filter(|occluders| !occluders.leaves().is_empty());
        let occluded = occluders.map(|occluders| Occluded {
            rasteriser: engine,
            occluders,
        });
        let rasteriser: &dyn Rasteriser = match &occluded {
            Some(occluded) => occluded,
            None => engine,
        };
        let [resolution_px, level_px] = options.effort.work().wood_px;
        let px = |foliage: &Foliage| seen_px(foliage, &views, resolution_px, rasteriser);
        let parts = Parts::of(&wood);
        let seen = match parts.are_pieces() {
            true => px(items)?,
            false => px(&leaves.followed_by(parts.foliage())?)?,
        };
        let bare = match wood.leaves().is_empty() {
            true => Vec::new(),
            false => px(parts.foliage())?,
        };
        let of_wood = seen[leaves.leaves().len()..].iter().zip(bare);
        let weights: Vec<f64> = of_wood
            .map(|(seen, bare)| seen + HIDDEN_WEIGHT * (bare - seen).max(0.0))
            .collect();
        let most = match leaves.leaves().is_empty() {
            true => BARE_RESOLUTION,
            false => level_px,
        };
        let resolution = level_resolution(most, views.len());
        let levels = Wood::by_geometry(parts, &weights, &views, resolution);
        let of_leaves = &seen[..leaves.leaves().len()];
        let crowned = match leaves.leaves().is_empty() {
            true => Crowned::of(&wood, options, engine)?.map(Box::new),
            false => None,
        };
        Ok(Self {
            crowned,
            has_solid_crown: crown_and_rest(&wood).is_some(),
            occluders: Arc::new(wood.clone().into_owned()),
            leaves_px: of_leaves.iter().sum(),
            levels: levels.with_leaves(&leaves, of_leaves),
            leaves,
            wood,
        })
    }

    /// What hides leaves: the wood, and what the options have.
    fn hiding(&self, options: &Options) -> Result<Arc<Foliage>, Error> {
        match &options.occluders {
            None => Ok(Arc::clone(&self.occluders)),
            Some(others) => Ok(Arc::new(self.occluders.followed_by(others)?)),
        }
    }

    /// Its leaves as they are.
    pub fn leaves(&self) -> &Foliage {
        &self.leaves
    }

    /// Triangles of leaves and wood.
    pub fn triangle_count(&self) -> usize {
        self.leaves.triangles().len() + self.wood.triangles().len()
    }

    /// All levels of the wood as one removal order of its pieces: [`Wood::order`].
    pub fn wood_order(&self) -> RemovalOrder {
        self.levels.order()
    }

    /// How many triangles of a budget are wood's: those that save as many pixels each as a
    /// triangle of leaves does, at most half of the budget.
    pub fn wood_budget(&self, triangles: usize) -> usize {
        self.wood_budget_bearing(&[], triangles.into())
    }

    /// [`Self::wood_budget`], where leaves lose these pixels that nothing bears.
    fn wood_budget_bearing(&self, hanging_px: &[f64], budget: Budget) -> usize {
        let triangles = budget.triangles;
        let share = triangles as f64 / self.triangle_count().max(1) as f64;
        let usual = (MARGIN_TIMES_SHARE / share).clamp(LEAF_MARGIN, LEAF_MARGIN_OF_FEW);
        let leaf_margin = match budget.sharing {
            Sharing::LeafMargin(margin) => margin,
            Sharing::ByNumber | Sharing::Evenly => usual,
        };
        let px_a_triangle = leaf_margin * self.px_a_leaf_triangle(triangles);
        let most = (MOST_WOOD * triangles as f64) as usize;
        let spare = triangles.saturating_sub(self.leaves.triangles().len());
        let of_wood = WoodBudget::of_plant(most, triangles);
        let worth = self.levels.worth(hanging_px, px_a_triangle, of_wood);
        worth.max(spare)
    }

    /// Pixels that the views show of leaves, for each triangle of a budget.
    fn px_a_leaf_triangle(&self, triangles: usize) -> f64 {
        self.leaves_px / triangles.max(1) as f64
    }

    /// The plant with at most this many triangles, shared between wood and leaves as
    /// [`Self::wood_budget`] says, but that wood which bears leaves that would hang in the air is worth
    /// them too; how leaves are simplified is as the options say, but for their target. What one
    /// level finds out about the leaves, others of the same options share.
    ///
    /// Leaves are chosen twice, the first time to see which would hang.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn level(
        &self,
        budget: impl Into<Budget>,
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let budget = budget.into();
        match &options.finer {
            Some(finer) if !finer.wood_gone.is_empty() => {
                let nested = Self {
                    levels: self.levels.clone().without(Arc::clone(&finer.wood_gone)),
                    ..self.clone()
                };
                nested.level_of(budget, options, engine, shared, observer)
            }
            Some(_) | None => self.level_of(budget, options, engine, shared, observer),
        }
    }

    /// [`Self::level`] of wood that is nested already.
    fn level_of(
        &self,
        budget: Budget,
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let triangles = budget.triangles;
        if self.leaves.leaves().is_empty() {
            return self.bare_level(budget, options, engine, shared, observer);
        }
        let mut own = Shared::default();
        let shared = shared.unwrap_or(&mut own);
        if budget.sharing == Sharing::Evenly
            && let Some(wood) = self.solid_wood_of(budget)
        {
            return self.beside_solid_wood(wood, budget, options, engine, shared, observer);
        }
        let mut options = Options {
            occluders: Some(self.hiding(options)?),
            ..options.clone()
        };
        let plain = self.wood_of(&[], budget);
        let sketch = Options {
            fit: Fitting::None,
            audit: false,
            shows_what_is_left: false,
            target: Target::triangles((triangles - plain.triangles) as u64),
            ..options.clone()
        };
        let sketch = simplify_sharing(engine, &self.leaves, &sketch, Some(&mut *shared), observer)?;
        let least = shared.least_gap_doubled();
        let (mut wood, held_by, doubled) = self.held(plain, &sketch.lod, budget, least);
        shared.gap_doubled = doubled;
        let leaf_gap = held_by.as_ref().map(|held_by| held_by.largest_gap());
        options.held_by = held_by.map(Arc::new);
        options.target = Target::triangles((triangles - wood.triangles) as u64);
        let mut leaves = simplify_sharing(engine, &self.leaves, &options, Some(shared), observer)?;
        let of_leaves = leaves.lod.foliage(&self.leaves).triangles().len();
        self.use_rest(&mut wood, of_leaves, triangles);
        leaves.warnings.extend(self.warning_of(&wood));
        Ok(WholeLevel {
            leaves,
            wood_gone: wood.chosen.gone(),
            wood: wood.lod,
            wood_triangles: wood.triangles,
            leaf_gap,
        })
    }

    /// Has wood the triangles of a budget that leaves cannot use, where these are many of them.
    fn use_rest(&self, wood: &mut WoodLevel, of_leaves: usize, triangles: usize) {
        let left = of_leaves + wood.triangles;
        if left >= triangles || is_met(triangles, left) {
            return;
        }
        let lod = self.levels.refined(&wood.chosen, triangles - left);
        let count = lod.foliage(&self.wood).triangles().len();
        if (wood.triangles..=triangles - of_leaves).contains(&count) {
            (wood.lod, wood.triangles) = (lod, count);
        }
    }

    /// Says that pieces which carry the crown are gone.
    fn warning_of(&self, wood: &WoodLevel) -> Option<Warning> {
        let [gone, there] = self.levels.carriers_gone(&wood.chosen);
        (gone > 0).then_some(Warning::SupportsGone { gone, there })
    }

    /// The wood of a plant of a budget.
    fn wood_of(&self, hanging_px: &[f64], budget: Budget) -> WoodLevel {
        let triangles = budget.triangles;
        let most = self.wood_budget_bearing(hanging_px, budget);
        let budget = WoodBudget::of_plant(most.min(triangles), triangles);
        let chosen = self.levels.chosen(hanging_px, budget);
        let lod = self.levels.lod(&chosen);
        WoodLevel {
            triangles: lod.foliage(&self.wood).triangles().len(),
            chosen,
            lod,
        }
    }

    /// The plant simplified to the target of the options, which counts leaves and wood where it is
    /// one of triangles. Other targets are those of the leaves, of which none goes then for hanging in
    /// the air; wood gets as many triangles as it has in a plant with as many triangles of leaves.
    ///
    /// # Errors
    /// [`Error::BudgetNotMet`] if the plant has no such number of triangles; else as [`simplify_on`].
    pub fn simplified(
        &self,
        options: &Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        options.target.check()?;
        if let Target::Triangles(amount) = options.target {
            let triangles = amount.of(self.triangle_count());
            let level = self.level(triangles, options, engine, None, observer)?;
            let of_leaves = level.leaves.lod.foliage(&self.leaves).triangles().len();
            let left = of_leaves + level.wood_triangles;
            options.check_met(left, self.triangle_count())?;
            return Ok(level);
        }
        let options = Options {
            occluders: Some(self.hiding(options)?),
            ..options.clone()
        };
        let leaves = simplify_on(engine, &self.leaves, &options, observer)?;
        let left = leaves.lod.foliage(&self.leaves).triangles().len();
        let triangles = left + self.wood_beside(left);
        let plain = self.wood_of(&[], triangles.into());
        let (wood, held_by, _) = self.held(plain, &leaves.lod, triangles.into(), 0);
        Ok(WholeLevel {
            leaves,
            wood_gone: wood.chosen.gone(),
            wood: wood.lod,
            wood_triangles: wood.triangles,
            leaf_gap: held_by.map(|held_by| held_by.largest_gap()),
        })
    }

    /// How many triangles wood has in the least plant in which leaves have `leaf_triangles`: by halving,
    /// since what is not wood's grows with the budget.
    fn wood_beside(&self, leaf_triangles: usize) -> usize {
        let (mut low, mut high) = (leaf_triangles, self.triangle_count());
        while low < high {
            let middle = low + (high - low) / 2;
            match middle - self.wood_budget(middle) < leaf_triangles {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        self.wood_budget(low)
    }
}
