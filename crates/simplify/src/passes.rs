//! What the passes of a run did, one after the other: leaves became coarser, leaves went and
//! others grew for them, needles got wider, what is left took other sizes.

use rustc_hash::FxHashSet;
use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder, Step};

use crate::coarsen::Coarse;
use crate::hanging_leaves::{HeldBy, push_removals};
use crate::needles::{Needle, widened};

/// The outcome of each pass; together they make a LOD.
#[derive(Clone, Debug)]
pub struct Passes {
    /// Coarser leaves, where some became so.
    pub coarse: Option<Coarse>,
    /// Which leaves went, in order, and which grew for them; of the coarser leaves where there
    /// are such. Every prefix of it is a LOD: [`Self::lod_after`].
    pub order: RemovalOrder,
    /// What took the place of needles that grow across.
    pub needles: Vec<Needle>,
    /// By what the area of each leaf that is left was multiplied at the end, in the order of
    /// [`Lod::all_leaves`], where that was done.
    pub sizes: Option<Vec<f64>>,
}

impl Passes {
    /// The LOD after all passes.
    pub fn lod(&self) -> Lod {
        let steps = self.in_one_order();
        Lod::after(&steps, steps.len())
    }

    /// The LOD in which the first `removals` steps of the order were made (all of them if it has fewer), before needles
    /// got wider and sizes were fitted to another.
    pub fn lod_after(&self, removals: usize) -> Lod {
        let order = self.removals();
        Lod::after(&order, removals + usize::from(self.coarse.is_some()))
    }

    /// The largest multiple of its area that a leaf has grown to, 1 where none has grown: of the original's,
    /// or of that of the leaf which was made of it.
    pub fn max_area_scale(&self) -> f64 {
        let first_needle = self.removals().name_count();
        let grown = |(leaf, area_scale): (LeafId, f64)| {
            let needle = leaf.index().checked_sub(first_needle);
            area_scale * needle.map_or(1.0, |needle| self.needles[needle].area_scale)
        };
        self.lod().all_leaves().map(grown).fold(1.0, f64::max)
    }

    /// All that was done as the steps of one order over the original leaves: where leaves became
    /// coarser a first step that puts these in their place, then the removals, where needles got
    /// wider a step that puts those in their place, and where sizes were fitted a last step in which
    /// no leaf goes. This is what is hashed and written.
    pub fn in_one_order(&self) -> RemovalOrder {
        let mut order = self.unsized_order();
        if let Some(factors) = &self.sizes {
            let lod = Lod::after(&order, order.len());
            push_sizes(&mut order, &lod, factors);
        }
        order
    }

    /// All but needles and sizes.
    fn removals(&self) -> RemovalOrder {
        match &self.coarse {
            Some(coarse) => coarse.order(&self.order),
            None => self.order.clone(),
        }
    }

    fn unsized_order(&self) -> RemovalOrder {
        let mut order = self.removals();
        if !self.needles.is_empty() {
            push_needles(&mut order, &self.needles);
        }
        order
    }

    /// Has needles grow across, and takes away those that then hang in the air.
    pub(crate) fn widen_needles(&mut self, foliage: &Foliage, held_by: Option<&HeldBy>) {
        self.needles = widened(foliage, &self.lod());
        if let (Some(held_by), false) = (held_by, self.needles.is_empty()) {
            self.take_hanging(foliage, held_by);
        }
    }

    /// Takes away the leaves that hang in the air at their sizes, with what these were multiplied by.
    pub(crate) fn take_hanging(&mut self, foliage: &Foliage, held_by: &HeldBy) {
        let lod = self.lod();
        let hanging = held_by.hanging(foliage, &lod);
        if hanging.is_empty() {
            return;
        }
        let is_hanging: FxHashSet<LeafId> = hanging.iter().copied().collect();
        if let Some(factors) = &mut self.sizes {
            let of_left = lod.all_leaves().zip(factors.iter());
            let of_left = of_left.filter(|((leaf, _), _)| !is_hanging.contains(leaf));
            *factors = of_left.map(|(_, factor)| *factor).collect();
        }
        // The needles that hang go as what they were before they got wider.
        let first_needle = self.removals().name_count();
        let mut going: Vec<LeafId> = Vec::new();
        for leaf in hanging {
            let needle = leaf.index().checked_sub(first_needle);
            going.push(needle.map_or(leaf, |needle| self.needles[needle].removed));
        }
        let is_going: FxHashSet<LeafId> = going.iter().copied().collect();
        self.needles
            .retain(|needle| !is_going.contains(&needle.removed));
        let own: Vec<LeafId> = match &self.coarse {
            None => going,
            Some(coarse) => {
                let names = coarse.names().into_iter().enumerate();
                let own = names.filter(|(_, name)| is_going.contains(name));
                own.map(|(leaf, _)| LeafId::from_index(leaf)).collect()
            }
        };
        push_removals(&mut self.order, &own);
    }
}

/// A step more, in which leaves take the place of needles.
fn push_needles(order: &mut RemovalOrder, needles: &[Needle]) {
    let survivors_area_scale = order.survivors_area_scale_after(order.len());
    order.push_step(Step {
        removed: &needles.iter().map(|n| n.removed).collect::<Vec<_>>(),
        grown: &[],
        made: &needles.iter().map(|n| n.made.clone()).collect::<Vec<_>>(),
        survivors_area_scale,
    });
}

/// A step more, after which the areas of what is left are multiplied by these factors.
fn push_sizes(order: &mut RemovalOrder, lod: &Lod, factors: &[f64]) {
    let survivors_area_scale = order
        .steps()
        .last()
        .map_or(1.0, |step| step.survivors_area_scale);
    let is_original = |leaf: LeafId| leaf.index() < lod.area_scales().len();
    let sized = |((leaf, area_scale), &factor): ((LeafId, f64), &f64)| {
        // Survivors are scaled after their own growth.
        let common = if is_original(leaf) {
            survivors_area_scale
        } else {
            1.0
        };
        (factor != 1.0).then_some(Growth {
            leaf,
            area_scale: area_scale / common * factor,
        })
    };
    let grown: Vec<Growth> = lod.all_leaves().zip(factors).filter_map(sized).collect();
    order.push_step(Step {
        removed: &[],
        grown: &grown,
        made: &[],
        survivors_area_scale,
    });
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::LeafTriangle;
    use secateur_plant::{EllipsoidCrown, ellipsoid_crown};

    use super::*;
    use crate::fsa::FsaOptions;
    use crate::{Fitting, Method, Options, Resolution, Target, simplify};

    /// Leaves that were made hang as original ones do, and go with their sizes.
    #[test]
    fn made_leaves_that_hang_go() {
        let crown = ellipsoid_crown(200, 11, &EllipsoidCrown::default()).unwrap();
        let middle = crown.bounding_sphere().unwrap();
        let floor = [(-9.0, -9.0), (30.0, -9.0), (-9.0, 30.0)]
            .map(|(x, z)| middle.centre + middle.radius * DVec3::new(x, -0.8, z));
        let mut wood = Foliage::default();
        wood.push_leaf(&[LeafTriangle::plain(floor)], None).unwrap();
        let held_by = HeldBy::new(&wood, 0.12 * middle.radius);
        let options = Options {
            method: Method::Fsa(FsaOptions::default()),
            resolution: Resolution::Pixels(32),
            fit: Fitting::Coverage,
            ..Options::to(Target::leaf_share(0.25))
        };
        let mut passes = simplify(&crown, &options).unwrap().passes;
        let before = passes.lod();
        let hanging = held_by.hanging(&crown, &before);
        let is_made = |leaf: &LeafId| leaf.index() >= 200;
        let (count, left) = (hanging.len(), before.leaf_count());
        assert!(
            hanging.iter().any(is_made) && count < left,
            "{count} of {left}"
        );
        let stays = |(leaf, _): &(LeafId, f64)| !hanging.contains(leaf);
        let left: Vec<(LeafId, f64)> = before.all_leaves().filter(stays).collect();
        passes.take_hanging(&crown, &held_by);
        assert_eq!(passes.sizes.as_ref().unwrap().len(), left.len());
        assert_eq!(passes.lod().all_leaves().collect::<Vec<_>>(), left);
    }
}
