//! Nested levels: a level has only leaves and wood that a finer one has.

use std::sync::Arc;

use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder, Step};
use secateur_raster::measure::vmi::ScaledBits;

use crate::select::Begun;
use crate::whole::WholeLevel;

/// What a finer level shows: nothing else may be left of a level that is nested in it.
#[derive(Clone, Debug, PartialEq)]
pub struct FinerLevel {
    /// By original leaf its area there, in square world units; nothing where it is gone.
    areas: Vec<Option<f64>>,
    /// By part of the wood whether it is gone; empty where all wood may be left.
    pub(crate) wood_gone: Arc<[bool]>,
}

impl FinerLevel {
    /// What a level of these leaves shows. A leaf that was made shows its donor.
    ///
    /// # Panics
    /// If the level is one of other leaves.
    pub fn of(level: &WholeLevel, leaves: &Foliage) -> Self {
        Self {
            areas: areas(leaves, &level.leaves.lod),
            wood_gone: level.wood_gone.as_slice().into(),
        }
    }

    pub(crate) fn is_gone(&self, leaf: LeafId) -> bool {
        self.areas[leaf.index()].is_none()
    }

    /// How many of the original leaves are gone.
    pub(crate) fn gone_count(&self) -> usize {
        self.areas.iter().filter(|area| area.is_none()).count()
    }

    /// The leaves that may be left.
    pub(crate) fn left(&self) -> Vec<LeafId> {
        let all = (0..self.areas.len()).map(LeafId::from_index);
        all.filter(|leaf| !self.is_gone(*leaf)).collect()
    }

    /// The steps that an order of these leaves begins with, which are the original ones or as many coarser ones:
    /// what is gone goes, and the last step gives the others the areas that they have in the finer level.
    /// Nothing where no leaf is gone.
    pub(crate) fn begun(&self, leaves: &Foliage) -> Option<Begun> {
        assert_eq!(leaves.leaves().len(), self.areas.len());
        let all = || (0..self.areas.len()).map(LeafId::from_index);
        let gone: Vec<LeafId> = all().filter(|leaf| self.is_gone(*leaf)).collect();
        let (last, before) = gone.split_last()?;
        let growth = |leaf: LeafId| {
            let area_scale = self.areas[leaf.index()]? / leaves.leaf(leaf).area();
            let is_other = area_scale.is_finite() && area_scale > 0.0;
            is_other.then_some(Growth { leaf, area_scale })
        };
        let mut order = RemovalOrder::new(self.areas.len() as u32);
        for leaf in before {
            order.push(*leaf, &[]);
        }
        order.push_step(Step {
            removed: &[*last],
            grown: &all().filter_map(growth).collect::<Vec<_>>(),
            made: &[],
            survivors_area_scale: 1.0,
        });
        Some(Begun {
            costs: vec![ScaledBits(0); order.len()],
            order,
        })
    }
}

/// By original leaf the area that a level shows of it.
fn areas(leaves: &Foliage, lod: &Lod) -> Vec<Option<f64>> {
    let left = lod.foliage(leaves);
    let originals = lod.leaves().map(|(leaf, _)| leaf);
    let donors = lod.made().map(|(made, _)| made.donor);
    let mut areas: Vec<Option<f64>> = vec![None; leaves.leaves().len()];
    for (name, leaf) in originals.chain(donors).zip(left.leaves()) {
        *areas[name.index()].get_or_insert(0.0) += leaf.area();
    }
    areas
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::{LeafTriangle, Place};

    use super::*;

    /// Right triangles of these legs, so that leaf 2 has an area of 2.
    fn leaves(legs: &[f64]) -> Foliage {
        let mut foliage = Foliage::default();
        for (index, leg) in legs.iter().enumerate() {
            let at = 9.0 * index as f64 * DVec3::X;
            let corners = [at, at + *leg * DVec3::X, at + *leg * DVec3::Y];
            let triangle = LeafTriangle::plain(corners);
            foliage.push_leaf(&[triangle], None).unwrap();
        }
        foliage
    }

    /// Leaf 1 is gone, 2 has grown to twice its area of 2, and 3 has another shape of area .5.
    #[test]
    fn an_order_begins_with_what_a_finer_level_did() {
        let foliage = leaves(&[1.0, 2.0, 3.0]);
        let id = LeafId::from_index;
        let mut lod = Lod::original(3);
        lod.remove(id(0));
        lod.resize(id(1), 2.0);
        lod.remove(id(2));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        lod.make(secateur_model::NewLeaf {
            donor: id(2),
            triangles: vec![corners.map(|corner| secateur_model::NewCorner {
                place: Place::At(corner),
                like: 0,
            })],
        });
        let finer = FinerLevel {
            areas: areas(&foliage, &lod),
            wood_gone: Arc::new([]),
        };
        assert_eq!(finer.areas, [None, Some(4.0), Some(0.5)]);
        assert_eq!((finer.gone_count(), finer.left()), (1, vec![id(1), id(2)]));
        // As coarser leaves of other sizes: 2 had an area of .5, 3 of 8.
        let begun = finer.begun(&leaves(&[1.0, 1.0, 4.0])).unwrap();
        let after = Lod::after(&begun.order, begun.order.len());
        assert_eq!(after.area_scales(), [None, Some(8.0), Some(1.0 / 16.0)]);
        let all = FinerLevel {
            areas: vec![Some(1.0)],
            wood_gone: Arc::new([]),
        };
        assert!(all.begun(&leaves(&[1.0])).is_none());
    }
}
