//! Whole plants: one budget of triangles for leaves and wood.

use std::sync::Arc;

use secateur_model::{Foliage, Lod, RemovalOrder};
use secateur_raster::occluders::Occluded;
use secateur_raster::{OpenEngine, Rasteriser, ViewSet};
use serde::{Deserialize, Serialize};

use crate::observe::observe;
use crate::stage::Observer;
use crate::wood::Wood;
use crate::{
    Error, Options, Shared, Simplified, Target, Views, simplify_on, simplify_sharing, sphere_of,
};

/// Views of this many pixels a side say how much of each piece of wood is seen: enough for what
/// shows at all at the heights at which coarse levels are seen.
const SEEN_RESOLUTION: u32 = 256;

/// Collapses of wood are chosen in views of this many pixels a side, where there are few enough views:
/// with 256 FLIP was .0138 instead of .0127 on `ez_bush2` at a quarter of all triangles.
const COLLAPSE_RESOLUTION: u32 = 512;

/// The most pixels over all views in which collapses are chosen: 32 views of 512 x 512.
const MOST_PIXELS: usize = 1 << 23;

/// What is hidden at first counts this much of what is seen: leaves that go lay some of it bare.
/// Other values were not tried.
const HIDDEN_WEIGHT: f64 = 0.1;

/// What another triangle of leaves saves, as a share of what the views show of leaves for each
/// triangle of the budget: the first triangles save more than the last. Of .1, .25, .6 and 1, tried
/// at a tenth of all triangles, .25 had the least FLIP on an oak and a palmetto, .1 and .25 on
/// `quat_commontree_1` and a birch, whose outline .6 kept better.
const LEAF_MARGIN: f64 = 0.3;

/// Wood gets at most this share of a budget that cannot hold all.
const MOST_WOOD: f64 = 0.5;

/// What becomes of the wood while leaves are simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum WoodMode {
    /// It is simplified too, by whichever of [`Self::Geometry`] and [`Self::Vmi`] looks better a
    /// triangle: see [`Self::decided`].
    Auto,
    /// It stays as it was: [`simplify_keeping_wood`].
    Keep,
    /// It is not looked at: triangles count the leaves alone, as in
    /// [`simplify`](crate::simplify()).
    Ignore,
    /// It is simplified too; pieces get coarser by half-edge collapses that change the mutual
    /// information of views least: [`Wood::by_information`].
    Vmi,
    /// It is simplified too; pieces get coarser by meshoptimizer, by their geometry: [`Wood::new`].
    Geometry,
}

impl WoodMode {
    /// What runs: [`Self::Geometry`] for [`Self::Auto`].
    pub fn decided(self) -> Self {
        match self {
            Self::Auto => Self::Geometry,
            said => said,
        }
    }
}

/// Pixels along a side of the views in which collapses are chosen.
fn collapse_resolution(views: usize) -> u32 {
    let mut resolution = COLLAPSE_RESOLUTION;
    while resolution > 1 && views * (resolution as usize).pow(2) > MOST_PIXELS {
        resolution /= 2;
    }
    resolution
}

/// A plant's leaves and wood, looked at once for any number of levels.
#[derive(Clone, Debug)]
pub struct WholePlant<'a> {
    leaves: &'a Foliage,
    wood: &'a Foliage,
    /// The wood as it was, which hides leaves at every level, so that levels share one order. With it
    /// FLIP at a tenth of all triangles was .0220 instead of .0231 on a willow, .0220 for .0224 on
    /// an oak, .0260 for .0262 on a birch, the same on `quat_commontree_1`, and .0641 for .0639 on a
    /// palmetto.
    occluders: Arc<Foliage>,
    levels: Wood,
    /// Pixels that the views show of leaves.
    leaves_px: f64,
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
}

impl<'a> WholePlant<'a> {
    /// Looks at the plant, and finds how far each piece of wood can be simplified. `items` are the
    /// leaves and then the wood.
    ///
    /// # Errors
    /// [`Error`] if there is no leaf, the plant is out of range, or the rasteriser fails.
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
        leaves: &'a Foliage,
        wood: &'a Foliage,
        options: &Options,
        engine: &OpenEngine,
    ) -> Result<Self, Error> {
        Self::by(WoodMode::Auto, items, leaves, wood, options, engine)
    }

    /// As [`Self::within`], with the wood made coarser as a mode says; modes that do not simplify it
    /// are taken for [`WoodMode::Auto`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn by(
        mode: WoodMode,
        items: &Foliage,
        leaves: &'a Foliage,
        wood: &'a Foliage,
        options: &Options,
        engine: &OpenEngine,
    ) -> Result<Self, Error> {
        sphere_of(leaves)?;
        let sphere = sphere_of(items)?;
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
        let px = |foliage: &Foliage| -> Result<Vec<f64>, Error> {
            let all = Lod::original(foliage.leaves().len());
            let areas = observe(foliage, &all, &views, SEEN_RESOLUTION, rasteriser)?;
            let mut px = vec![0.0; foliage.leaves().len()];
            for row in areas.rows() {
                for (sum, area_px) in px.iter_mut().zip(&row[1..]) {
                    *sum += f64::from(*area_px);
                }
            }
            Ok(px)
        };
        let seen = px(items)?;
        let bare = if wood.leaves().is_empty() {
            Vec::new()
        } else {
            px(wood)?
        };
        let of_wood = seen[leaves.leaves().len()..].iter().zip(bare);
        let weights: Vec<f64> = of_wood
            .map(|(seen, bare)| seen + HIDDEN_WEIGHT * (bare - seen).max(0.0))
            .collect();
        let levels = match mode.decided() {
            WoodMode::Vmi => {
                let resolution = collapse_resolution(views.len());
                Wood::by_information(wood, &weights, &views, resolution, rasteriser)?
            }
            _ => Wood::new(wood, &weights),
        };
        Ok(Self {
            leaves,
            wood,
            occluders: Arc::new(wood.clone()),
            levels,
            leaves_px: seen[..leaves.leaves().len()].iter().sum(),
        })
    }

    /// What hides leaves: the wood, and what the options have.
    fn hiding(&self, options: &Options) -> Result<Arc<Foliage>, Error> {
        match &options.occluders {
            None => Ok(Arc::clone(&self.occluders)),
            Some(others) => Ok(Arc::new(self.occluders.followed_by(others)?)),
        }
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
        let px_a_leaf_triangle = self.leaves_px / triangles.max(1) as f64;
        let most = (MOST_WOOD * triangles as f64) as usize;
        let spare = triangles.saturating_sub(self.leaves.triangles().len());
        self.levels
            .worth(LEAF_MARGIN * px_a_leaf_triangle, most)
            .max(spare)
    }

    /// The plant with at most this many triangles, shared between wood and leaves as
    /// [`Self::wood_budget`] says; how leaves are simplified is as the options say, but for their
    /// target. What one level finds out about the leaves, others of the same options
    /// share.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn level(
        &self,
        triangles: usize,
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let wood_triangles = self.wood_budget(triangles);
        self.level_of(
            [triangles, wood_triangles],
            options,
            engine,
            shared,
            observer,
        )
    }

    /// The plant simplified to the target of the options, which counts leaves and wood where it is
    /// one of triangles. Other targets are those of the leaves; then wood gets as many triangles as
    /// it has in a plant with as many triangles of leaves.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn simplified(
        &self,
        options: &Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        options.target.check()?;
        if let Target::Triangles(amount) = options.target {
            let triangles = amount.of(self.triangle_count());
            return self.level(triangles, options, engine, None, observer);
        }
        let options = Options {
            occluders: Some(self.hiding(options)?),
            ..options.clone()
        };
        let leaves = simplify_on(engine, self.leaves, &options, observer)?;
        let left = leaves.lod.foliage(self.leaves).triangles().len();
        let (wood, _) = self.levels.within(self.wood_beside(left));
        Ok(WholeLevel {
            wood_triangles: wood.foliage(self.wood).triangles().len(),
            leaves,
            wood,
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

    /// As [`Self::level`], with a bound on the triangles of wood too.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn level_of(
        &self,
        [triangles, wood_triangles]: [usize; 2],
        options: &Options,
        engine: &OpenEngine,
        shared: Option<&mut Shared>,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let (wood, _) = self.levels.within(wood_triangles.min(triangles));
        let wood_triangles = wood.foliage(self.wood).triangles().len();
        let options = Options {
            occluders: Some(self.hiding(options)?),
            target: Target::triangles((triangles - wood_triangles) as u64),
            ..options.clone()
        };
        Ok(WholeLevel {
            leaves: simplify_sharing(engine, self.leaves, &options, shared, observer)?,
            wood,
            wood_triangles,
        })
    }
}

/// Simplifies the leaves of a plant whose wood stays as it is, and hides leaves. A target of
/// triangles counts leaves and wood.
///
/// # Errors
/// [`Error::BudgetBelowWood`] if the wood alone has more triangles than may be left; else as
/// [`simplify_on`].
pub fn simplify_keeping_wood(
    leaves: &Foliage,
    wood: &Foliage,
    options: &Options,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<WholeLevel, Error> {
    options.target.check()?;
    let least = wood.triangles().len();
    let target = match options.target {
        Target::Triangles(amount) => {
            let asked = amount.of(leaves.triangles().len() + least);
            let rest = asked.checked_sub(least);
            let rest = rest.ok_or(Error::BudgetBelowWood { asked, least })?;
            Target::triangles(rest as u64)
        }
        other => other,
    };
    let occluders = match &options.occluders {
        Some(others) => wood.followed_by(others)?,
        None => wood.clone(),
    };
    let options = Options {
        target,
        occluders: Some(Arc::new(occluders)),
        ..options.clone()
    };
    Ok(WholeLevel {
        leaves: simplify_on(engine, leaves, &options, observer)?,
        wood: Lod::original(wood.leaves().len()),
        wood_triangles: least,
    })
}
