//! Whole plants: one budget of triangles for leaves and wood.

use secateur_model::{Foliage, Lod};
use secateur_raster::{OpenEngine, ViewSet};

use crate::observe::observe;
use crate::stage::Observer;
use crate::wood::Wood;
use crate::{Error, Options, Simplified, Target, simplify_on, sphere_of};

/// Views of this many pixels a side say how much of each piece of wood is seen: enough for what
/// shows at all at the heights at which coarse levels are seen.
const SEEN_RESOLUTION: u32 = 256;

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

/// A plant's leaves and wood, looked at once for any number of levels.
#[derive(Clone, Debug)]
pub struct WholePlant<'a> {
    leaves: &'a Foliage,
    wood: &'a Foliage,
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
        sphere_of(leaves)?;
        let sphere = sphere_of(items)?;
        let views = ViewSet::dodecahedron(sphere);
        let px = |foliage: &Foliage| -> Result<Vec<f64>, Error> {
            let all = Lod::original(foliage.leaves().len());
            let areas = observe(foliage, &all, &views, SEEN_RESOLUTION, engine)?;
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
        Ok(Self {
            leaves,
            wood,
            levels: Wood::new(wood, &weights),
            leaves_px: seen[..leaves.leaves().len()].iter().sum(),
        })
    }

    /// Triangles of leaves and wood.
    pub fn triangle_count(&self) -> usize {
        self.leaves.triangles().len() + self.wood.triangles().len()
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
    /// target.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn level(
        &self,
        triangles: usize,
        options: &Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let wood_triangles = self.wood_budget(triangles);
        self.level_of(triangles, wood_triangles, options, engine, observer)
    }

    /// As [`Self::level`], with this share of the triangles for the wood.
    ///
    /// # Errors
    /// As [`simplify_on`].
    pub fn level_of(
        &self,
        triangles: usize,
        wood_triangles: usize,
        options: &Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let (wood, _) = self.levels.within(wood_triangles.min(triangles));
        let wood_triangles = wood.foliage(self.wood).triangles().len();
        let options = Options {
            target: Target::triangles((triangles - wood_triangles) as u64),
            ..options.clone()
        };
        Ok(WholeLevel {
            leaves: simplify_on(engine, self.leaves, &options, observer)?,
            wood,
            wood_triangles,
        })
    }
}
