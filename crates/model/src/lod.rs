//! Which leaves are left, and how large.

use crate::{LeafId, RemovalOrder};

/// A level of detail of a foliage: for each leaf its area as a multiple of the
/// original one, or nothing where the leaf is gone.
#[derive(Clone, Debug, PartialEq)]
pub struct Lod {
    area_scales: Vec<Option<f64>>,
}

impl Lod {
    /// Every one of `leaf_count` leaves at its original size.
    pub fn original(leaf_count: usize) -> Self {
        Self {
            area_scales: vec![Some(1.0); leaf_count],
        }
    }

    /// What is left after the first `steps` steps of an order (all of them if
    /// it has fewer).
    pub fn after(order: &RemovalOrder, steps: usize) -> Self {
        let mut lod = Self::original(order.leaf_count() as usize);
        for step in order.steps().take(steps) {
            lod.remove(step.removed);
            for growth in step.grown {
                lod.resize(growth.leaf, growth.area_scale);
            }
        }
        lod
    }

    /// Takes a leaf away.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn remove(&mut self, leaf: LeafId) {
        self.area_scales[leaf.index()] = None;
    }

    /// Gives a leaf this multiple of its original area.
    ///
    /// # Panics
    /// If the leaf is gone or `area_scale` is not a finite positive number.
    pub fn resize(&mut self, leaf: LeafId, area_scale: f64) {
        assert!(
            area_scale.is_finite() && area_scale > 0.0,
            "{leaf} cannot be resized to {area_scale} times its area"
        );
        let scale = self.area_scales[leaf.index()].as_mut();
        *scale.expect("only a leaf that is left can be resized") = area_scale;
    }

    /// The area of a leaf as a multiple of its original one, or `None` if it is
    /// gone.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn area_scale(&self, leaf: LeafId) -> Option<f64> {
        self.area_scales[leaf.index()]
    }

    /// [`area_scale`](Self::area_scale) of every leaf, leaf 1 first.
    pub fn area_scales(&self) -> &[Option<f64>] {
        &self.area_scales
    }

    /// The leaves that are left with their area scales, in leaf order.
    pub fn leaves(&self) -> impl Iterator<Item = (LeafId, f64)> + '_ {
        let scales = self.area_scales.iter().enumerate();
        scales.filter_map(|(index, scale)| Some((LeafId::from_index(index), (*scale)?)))
    }

    /// How many leaves are left.
    pub fn leaf_count(&self) -> usize {
        self.area_scales.iter().flatten().count()
    }

    /// The largest area scale of a leaf that is left, 1 where none is.
    pub fn max_area_scale(&self) -> f64 {
        self.area_scales
            .iter()
            .flatten()
            .copied()
            .fold(1.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Growth;

    #[test]
    fn a_prefix_of_an_order_is_a_level() {
        let leaf = |n| LeafId::new(n).unwrap();
        let mut order = RemovalOrder::new(3);
        let grown = Growth {
            leaf: leaf(1),
            area_scale: 1.5,
        };
        order.push(leaf(2), &[grown]);
        order.push(leaf(1), &[]);
        assert_eq!(Lod::after(&order, 0), Lod::original(3));
        let one = Lod::after(&order, 1);
        assert_eq!(one.area_scales(), [Some(1.5), None, Some(1.0)]);
        assert_eq!(one.max_area_scale(), 1.5);
        let two = Lod::after(&order, 9);
        assert_eq!(two.leaves().collect::<Vec<_>>(), [(leaf(3), 1.0)]);
        assert_eq!(two.leaf_count(), 1);
    }
}
