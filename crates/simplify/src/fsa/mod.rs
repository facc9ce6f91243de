//! The foliage simplification algorithm: two leaves at a time become one.
//!
//! Remolar, Chover, Belmonte, Ribelles, Rebollo: Geometric Simplification of
//! Foliage (Eurographics 2002, short paper), as the View-Dependent
//! Multiresolution Model for Foliage (WSCG 2003, section 3) reviews it. Of all
//! pairs of leaves the one of least cost is replaced by a new leaf of four of
//! its vertices, again and again. The cost combines how far the leaves are
//! apart and how far they are from one plane; the papers do not print the
//! formula or its weights, so here it is
//!
//! ```text
//! cost(a, b) = w_d H(a, b) / L + w_p (1 - |n_a . n_b|)
//! ```
//!
//! with H the Hausdorff distance of the two sets of vertices, L the square root
//! of the mean area of an original leaf, and n unit normals (the second term is
//! 1 where a leaf has no area). No vertex is new; the new leaf has the look of
//! the larger of the two, all of its texture on the new outline.

mod leaf;
mod pairs;

use std::ops::ControlFlow;

use secateur_model::{Foliage, PlantSkeleton, RemovalOrder, Step};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::select::{Select, Selection, Steps, Task, refuse};

use leaf::{ActiveLeaf, distance_squared};
use pairs::Pairs;

/// What can be chosen about leaf collapse.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FsaOptions {
    /// w_d: above 0 and finite.
    pub distance_weight: f64,
    /// w_p: 0 or more and finite.
    pub planarity_weight: f64,
}

impl Default for FsaOptions {
    fn default() -> Self {
        Self {
            distance_weight: 1.0,
            planarity_weight: 1.0,
        }
    }
}

impl Select for FsaOptions {
    fn check(&self, _: &Foliage, _: Option<&PlantSkeleton>) -> Result<(), Error> {
        let (distance, planarity) = (self.distance_weight, self.planarity_weight);
        if !(distance.is_finite() && distance > 0.0) {
            return refuse("distance weight", distance, "above 0");
        }
        if !(planarity.is_finite() && planarity >= 0.0) {
            return refuse("planarity weight", planarity, "from 0 upwards");
        }
        Ok(())
    }

    fn select(&self, task: &Task<'_>, steps: &mut Steps<'_>) -> Result<Selection, Error> {
        let leaves = task.target.leaves_to_stop_at(task.foliage);
        let at_most = task.foliage.leaves().len().saturating_sub(leaves);
        let order = simplify(task.foliage, leaves, self, &mut |done| steps(done, at_most));
        order.map(Selection::unseen).ok_or(Error::Stopped)
    }
}

/// Collapses pairs until `leaves` are left; the last leaf, which has no other,
/// goes without a trace. Every prefix is the order to more leaves. Of pairs of
/// equal cost the one of the lower leaf numbers goes first.
///
/// The choice among all pairs is exact. Leaves whose partner is gone look for
/// the next one only when it could matter, through a spatial index: about n log
/// n time at equal crown density, and where leaves coincide. `progress` gets the
/// steps done.
///
/// `None` if `progress` broke off.
///
/// # Panics
/// If a weight is out of range.
pub fn simplify(
    foliage: &Foliage,
    leaves: usize,
    options: &FsaOptions,
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Option<RemovalOrder> {
    let cost = Cost::new(foliage, options);
    let count = foliage.leaves().len();
    let mut pairs = Pairs::new(foliage, cost);
    let mut order = RemovalOrder::new(count as u32);
    while count - order.len() > leaves {
        let Some(pair) = pairs.cheapest() else {
            if let Some(last) = pairs.any() {
                order.push(last, &[]);
            }
            break;
        };
        let made = pairs.collapse(pair);
        order.push_step(Step {
            removed: &pair.leaves(),
            grown: &[],
            made: &[made],
            survivors_area_scale: 1.0,
        });
        if progress(order.len()).is_break() {
            return None;
        }
    }
    Some(order)
}

/// The cost of a pair. Symmetric to the last bit.
#[derive(Clone, Copy, Debug)]
struct Cost {
    per_distance: f64,
    planarity_weight: f64,
}

impl Cost {
    fn new(foliage: &Foliage, options: &FsaOptions) -> Self {
        let (distance, planarity) = (options.distance_weight, options.planarity_weight);
        assert!(
            distance.is_finite() && distance > 0.0 && planarity.is_finite() && planarity >= 0.0,
            "weights {distance} and {planarity} are out of range"
        );
        let areas = foliage.leaves().iter().map(|leaf| leaf.area());
        let mean_area = areas.sum::<f64>() / foliage.leaves().len().max(1) as f64;
        let unit = if mean_area > 0.0 {
            mean_area.sqrt()
        } else {
            1.0
        };
        Self {
            per_distance: distance / unit,
            planarity_weight: planarity,
        }
    }

    fn of_distance(&self, squared: f64) -> f64 {
        self.per_distance * squared.sqrt()
    }

    fn of_planes(&self, a: &ActiveLeaf, b: &ActiveLeaf) -> f64 {
        self.planarity_weight * (1.0 - a.normal.dot(b.normal).abs()).max(0.0)
    }

    /// Never above [`of`](Self::of): a set cannot be nearer than its bounds are.
    fn at_least(&self, a: &ActiveLeaf, b: &ActiveLeaf) -> f64 {
        let apart = (a.low - b.low)
            .abs()
            .max((a.high - b.high).abs())
            .max_element();
        SLACK * self.of_distance(apart * apart) + self.of_planes(a, b)
    }

    fn of(&self, a: &ActiveLeaf, b: &ActiveLeaf) -> f64 {
        let from = |a: &ActiveLeaf, b: &ActiveLeaf| {
            let distances = a.vertices.iter().map(|v| distance_squared(v.position, b));
            distances.fold(0.0, f64::max)
        };
        self.of_distance(from(a, b).max(from(b, a))) + self.of_planes(a, b)
    }
}

/// Room for rounding in bounds.
const SLACK: f64 = 1.0 - 1e-9;

#[cfg(test)]
mod tests;
