//! What the passes of a run did, one after the other: leaves became coarser, leaves went and
//! others grew for them, needles got wider, what is left took other sizes.

use rustc_hash::FxHashSet;
use secateur_model::{Foliage, Growth, LeafId, Lod, RemovalOrder, Step};

use crate::coarsen::Coarse;
use crate::needles::Needle;
use crate::rest::{HeldBy, push_removals};

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

    /// The LOD in which the first `removals` steps of the order were made, before sizes were
    /// fitted to another.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn lod_after(&self, removals: usize) -> Lod {
        let order = self.unsized_order();
        Lod::after(&order, removals + usize::from(self.coarse.is_some()))
    }

    /// All that was done as the steps of one order over the original leaves: where leaves became
    /// coarser a first step that puts these in their place, then the removals, where needles got
    /// wider two steps, which put those in their place and let them grow, and where sizes were fitted a last step in which
    /// no leaf goes. This is what is hashed and written.
    pub fn in_one_order(&self) -> RemovalOrder {
        let mut order = self.unsized_order();
        if let Some(factors) = &self.sizes {
            let lod = Lod::after(&order, order.len());
            push_sizes(&mut order, &lod, factors);
        }
        order
    }

    fn unsized_order(&self) -> RemovalOrder {
        let mut order = match &self.coarse {
            Some(coarse) => coarse.order(&self.order),
            None => self.order.clone(),
        };
        if !self.needles.is_empty() {
            push_needles(&mut order, &self.needles);
        }
        order
    }

    /// Takes away the leaves that hang in the air at their sizes, with what these were multiplied by.
    pub(crate) fn take_hanging(&mut self, foliage: &Foliage, held_by: &HeldBy) {
        let lod = self.lod();
        let hanging = held_by.hanging(foliage, &lod);
        if hanging.is_empty() {
            return;
        }
        let mut is_hanging: FxHashSet<LeafId> = hanging.iter().copied().collect();
        if let Some(factors) = &mut self.sizes {
            let of_left = lod.all_leaves().zip(factors.iter());
            let of_left = of_left.filter(|((leaf, _), _)| !is_hanging.contains(leaf));
            *factors = of_left.map(|(_, factor)| *factor).collect();
        }
        // The needles that hang go as what they were before they got wider.
        let mut next = self.unsized_order().name_count() - self.needles.len();
        self.needles.retain(|needle| {
            let name = LeafId::from_index(next);
            next += 1;
            let hangs = is_hanging.remove(&name);
            if hangs {
                is_hanging.insert(needle.removed);
            }
            !hangs
        });
        let names = match &self.coarse {
            None => (0..self.order.leaf_count() as usize)
                .map(LeafId::from_index)
                .collect(),
            Some(coarse) => coarse.names(),
        };
        let names = names.into_iter().enumerate();
        let own = names.filter(|(_, name)| is_hanging.contains(name));
        let own: Vec<LeafId> = own.map(|(leaf, _)| LeafId::from_index(leaf)).collect();
        push_removals(&mut self.order, &own);
    }
}

/// Two steps more: leaves take the place of needles, and get their sizes, as what a step makes cannot
/// grow in it.
fn push_needles(order: &mut RemovalOrder, needles: &[Needle]) {
    let first = order.name_count();
    let grown = needles.iter().enumerate().map(|(index, needle)| Growth {
        leaf: LeafId::from_index(first + index),
        area_scale: needle.area_scale,
    });
    let survivors_area_scale = order.survivors_area_scale_after(order.len());
    order.push_step(Step {
        removed: &needles.iter().map(|n| n.removed).collect::<Vec<_>>(),
        grown: &[],
        made: &needles.iter().map(|n| n.made.clone()).collect::<Vec<_>>(),
        survivors_area_scale,
    });
    order.push_step(Step {
        removed: &[],
        grown: &grown.filter(|g| g.area_scale != 1.0).collect::<Vec<_>>(),
        made: &[],
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
