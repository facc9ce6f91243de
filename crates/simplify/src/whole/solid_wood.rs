//! Plants whose wood has a solid crown, beside which there are leaves: low-poly trees with a few leaves, fruits or
//! flowers.

use secateur_model::Lod;
use secateur_raster::OpenEngine;

use super::{Budget, Sharing, WholeLevel, WholePlant};
use crate::stage::Observer;
use crate::wood::sides_apart;
use crate::{Error, Options, Shared, Target, simplify_sharing};

impl WholePlant<'_> {
    /// How triangles may be shared on this plant; the first is to be tried first. `of_leaves_and_wood` are the ways of an
    /// effort for plants of leaves and wood. Without leaves there are two others, and a solid crown adds one.
    pub fn sharings(&self, of_leaves_and_wood: &[Sharing]) -> Vec<Sharing> {
        if self.leaves.leaves().is_empty() {
            return vec![Sharing::Evenly, Sharing::ByNumber];
        }
        let first: &[Sharing] = match self.has_solid_crown {
            true => &[Sharing::Evenly],
            false => &[],
        };
        [first, of_leaves_and_wood].concat()
    }

    /// The wood after collapses over all of its pieces, with at most the triangles that a budget leaves for wood. None
    /// where the wood has no solid crown, or collapses do not get there.
    pub(super) fn solid_wood_of(&self, budget: Budget) -> Option<Lod> {
        let most = || self.wood_budget_bearing(&[], budget);
        let wood = self.has_solid_crown.then(most);
        let even = self.levels.evenly(&self.wood, wood?)?;
        Some(sides_apart(&self.wood, even))
    }

    /// The plant of a budget with this wood.
    pub(super) fn beside_solid_wood(
        &self,
        wood: Lod,
        budget: Budget,
        options: &Options,
        engine: &OpenEngine,
        shared: &mut Shared,
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let wood_triangles = wood.foliage(&self.wood).triangles().len();
        let left = budget.triangles.saturating_sub(wood_triangles);
        let options = Options {
            occluders: Some(self.hiding(options)?),
            target: Target::triangles(left as u64),
            ..options.clone()
        };
        let leaves = simplify_sharing(engine, &self.leaves, &options, Some(shared), observer)?;
        Ok(WholeLevel {
            leaves,
            wood_gone: Vec::new(),
            wood,
            wood_triangles,
            leaf_gap: None,
        })
    }
}
