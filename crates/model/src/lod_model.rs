//! All levels of a foliage at once: a removal order that can be walked both ways.
//!
//! The sequence of leaf removals is a continuous model (Gasch, Remolar, Chover, Rebollo: Entropy
//! 2018, section 6): a level of n leaves is a prefix of it. What a step changes is kept together
//! with what it was before, so that a level can be reached from any other in time proportional to
//! the steps between them, in both directions, and at no steps the original is there again bit for
//! bit.

use crate::{Foliage, LeafId, Lod, OrderError, RemovalOrder};

/// A removal order of a foliage, and what each of its steps undoes.
#[derive(Clone, Debug, PartialEq)]
pub struct LodModel {
    order: RemovalOrder,
    foliage_sha256: [u8; 32],
    /// For each growth of the order the leaf's own scale before it.
    grown_from: Vec<f64>,
    /// For each removed leaf its own scale before it went.
    removed_at: Vec<f64>,
}

impl LodModel {
    /// The levels of a foliage along an order.
    ///
    /// # Errors
    /// [`OrderError`] if it is no order of this foliage.
    pub fn new(order: RemovalOrder, foliage: &Foliage) -> Result<Self, OrderError> {
        order.check(foliage)?;
        let mut own_scales = own_scales_at_first(&order);
        let mut grown_from = Vec::with_capacity(order.growth_count());
        let mut removed_at = Vec::with_capacity(order.removed().len());
        for index in 0..order.len() {
            let step = order.step(index);
            own_scales[names_made(&order, index)].fill(1.0);
            for leaf in step.removed {
                removed_at.push(std::mem::take(&mut own_scales[leaf.index()]));
            }
            for growth in step.grown {
                let scale = &mut own_scales[growth.leaf.index()];
                grown_from.push(std::mem::replace(scale, growth.area_scale));
            }
        }
        Ok(Self {
            foliage_sha256: foliage.sha256(),
            order,
            grown_from,
            removed_at,
        })
    }

    /// The removal order that the levels follow.
    pub fn order(&self) -> &RemovalOrder {
        &self.order
    }

    /// [`Foliage::sha256`] of the foliage that the levels are of.
    pub fn foliage_sha256(&self) -> [u8; 32] {
        self.foliage_sha256
    }

    /// How many leaves the original has.
    pub fn most_leaves(&self) -> usize {
        self.order.leaf_count() as usize
    }

    /// How many leaves are left after the last step.
    pub fn fewest_leaves(&self) -> usize {
        self.order.leaves_after(self.order.len())
    }

    /// How many steps lead to a level of at most `leaves` leaves; all steps where no level has so few.
    ///
    /// With as many leaves as the original it is none. Of several levels with as many leaves it is
    /// the last: sizes that were fitted at the end of a run are a step in which no leaf goes.
    pub fn steps_to(&self, leaves: usize) -> usize {
        if leaves >= self.most_leaves() {
            return 0;
        }
        let after = |steps: usize| self.order.leaves_after(steps);
        let first = first_where(self.order.len(), |steps| after(steps) <= leaves);
        let found = after(first);
        first_where(self.order.len() + 1, |steps| after(steps) < found) - 1
    }

    /// The finest level, from which others can be reached.
    pub fn finest(&self) -> UniformLevel<'_> {
        UniformLevel {
            model: self,
            steps: 0,
            own_scales: own_scales_at_first(&self.order),
            changed: Vec::new(),
        }
    }

    /// The level after `steps` steps, found from the finest.
    ///
    /// # Panics
    /// If the order has fewer steps.
    pub fn lod_after(&self, steps: usize) -> Lod {
        let mut level = self.finest();
        level.go_to(steps);
        level.lod()
    }
}

/// The first number from 0 on for which `is_so` holds, or `end` if it holds for none before; found by
/// halving, so `is_so` must hold for all numbers after the first.
fn first_where(end: usize, is_so: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, end);
    while low < high {
        let middle = low + (high - low) / 2;
        match is_so(middle) {
            true => high = middle,
            false => low = middle + 1,
        }
    }
    low
}

fn own_scales_at_first(order: &RemovalOrder) -> Vec<f64> {
    let mut scales = vec![0.0; order.name_count()];
    scales[..order.leaf_count() as usize].fill(1.0);
    scales
}

/// The places of the names that a step makes.
fn names_made(order: &RemovalOrder, step: usize) -> std::ops::Range<usize> {
    let (made, originals) = (order.made_in(step), order.leaf_count() as usize);
    originals + made.start..originals + made.end
}

/// A level of a model, on its way to others.
#[derive(Clone, Debug)]
pub struct UniformLevel<'a> {
    model: &'a LodModel,
    steps: usize,
    /// Of each leaf by its name, made ones included, without the scale that survivors share; 0
    /// where it is not there.
    own_scales: Vec<f64>,
    changed: Vec<LeafId>,
}

impl UniformLevel<'_> {
    /// Goes to the level of at most `leaves` leaves ([`LodModel::steps_to`]), or to the coarsest. Takes time in proportion to the steps between.
    pub fn uniform(&mut self, leaves: usize) {
        self.go_to(self.model.steps_to(leaves));
    }

    /// Goes to the level after `steps` steps.
    ///
    /// # Panics
    /// If the order has fewer steps.
    pub fn go_to(&mut self, steps: usize) {
        assert!(steps <= self.model.order.len(), "{steps} steps of fewer");
        self.changed.clear();
        while self.steps < steps {
            self.forward();
        }
        while self.steps > steps {
            self.back();
        }
    }

    fn forward(&mut self) {
        let order = &self.model.order;
        let step = order.step(self.steps);
        for name in names_made(order, self.steps) {
            self.set(LeafId::from_index(name), 1.0);
        }
        for &leaf in step.removed {
            self.set(leaf, 0.0);
        }
        for growth in step.grown {
            self.set(growth.leaf, growth.area_scale);
        }
        self.steps += 1;
    }

    fn back(&mut self) {
        self.steps -= 1;
        let (model, order) = (self.model, &self.model.order);
        let step = order.step(self.steps);
        let before = &model.grown_from[order.grown_in(self.steps)];
        for (growth, &own_scale) in step.grown.iter().zip(before).rev() {
            self.set(growth.leaf, own_scale);
        }
        let before = &model.removed_at[order.removed_in(self.steps)];
        for (&leaf, &own_scale) in step.removed.iter().zip(before) {
            self.set(leaf, own_scale);
        }
        for name in names_made(order, self.steps) {
            self.set(LeafId::from_index(name), 0.0);
        }
    }

    fn set(&mut self, leaf: LeafId, own_scale: f64) {
        self.own_scales[leaf.index()] = own_scale;
        self.changed.push(leaf);
    }

    /// How many steps of the order were made.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// How many leaves it has, made ones included.
    pub fn leaf_count(&self) -> usize {
        self.model.order.leaves_after(self.steps)
    }

    /// The leaves that came, went or changed their own size when this level was last gone to: what
    /// a renderer has to bring up to date. A leaf may be named more than once.
    pub fn changed(&self) -> &[LeafId] {
        &self.changed
    }

    /// By what the areas of all original leaves that are there are multiplied beside their own
    /// scale; 1 but for stochastic pruning.
    pub fn survivors_area_scale(&self) -> f64 {
        self.model.order.survivors_area_scale_after(self.steps)
    }

    /// The area of a leaf as a multiple of its original one, or of that of its triangles if it was
    /// made, without [`Self::survivors_area_scale`]; nothing where it is not there.
    ///
    /// # Panics
    /// If no leaf ever has this name.
    pub fn own_area_scale(&self, leaf: LeafId) -> Option<f64> {
        Some(self.own_scales[leaf.index()]).filter(|scale| *scale != 0.0)
    }

    /// The level by itself, equal to [`Lod::after`] the same steps. Takes time in proportion to the
    /// original's leaves.
    pub fn lod(&self) -> Lod {
        let order = &self.model.order;
        let made = order.made_in_first(self.steps);
        let names = order.leaf_count() as usize + made.len();
        Lod::from_own_scales(
            order.leaf_count() as usize,
            &self.own_scales[..names],
            made,
            self.survivors_area_scale(),
        )
    }
}

#[cfg(test)]
mod tests;
