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
//! with H the Hausdorff distance of the two sets of vertices or of the two surfaces
//! ([`Hausdorff`]), L the square root of the mean area of an original leaf, and n unit normals
//! (the second term is 1 where a leaf has no area). No vertex is new: each leaf gives two, those
//! furthest from the other leaf by the rule that the tool for LOD models of Ripolles et al.
//! prints ([`Corners`] has another). The new leaf has the look of the larger of the two, all of
//! its texture on the new outline.

mod leaf;
mod pairs;

use std::ops::ControlFlow;

use secateur_model::{Foliage, PlantSkeleton, RemovalOrder, Step};
use serde::{Deserialize, Serialize};

use crate::Error;
#[cfg(feature = "cli")]
use crate::option_numbers::{above_zero, from_zero};
use crate::select::{Select, Selection, Steps, Task, refuse};

use leaf::{ActiveLeaf, Vertex};
use pairs::Pairs;

/// Which two corners a leaf gives to the new one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Corners {
    /// Of the larger leaf the two corners furthest from the other leaf's middle, of the other leaf the two
    /// furthest from those: no slivers.
    #[default]
    Spread,
    /// Of each leaf the two corners furthest from the other leaf, as it is published.
    Furthest,
}

/// What the Hausdorff distance of two leaves is taken between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Hausdorff {
    /// Between the corners of the two leaves.
    #[default]
    Corners,
    /// Between the surfaces of the two leaves.
    ///
    /// From the corners of one to the triangles of the other, which is exact for flat, convex leaves. A leaf
    /// through another's middle is near it, whatever its corners.
    Surface,
}

/// What can be chosen about leaf collapse.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct FsaOptions {
    /// fsa: how much the distance of two leaves counts, in units of a leaf's size.
    ///
    /// w_d: above 0 and finite.
    #[cfg_attr(feature = "cli", arg(long, value_name = "W", default_value_t = 1.0))]
    #[cfg_attr(feature = "cli", arg(allow_negative_numbers = true, value_parser = above_zero))]
    pub distance_weight: f64,
    /// fsa: how much it counts that two leaves are not in one plane.
    ///
    /// w_p: 0 or more and finite.
    #[cfg_attr(feature = "cli", arg(long, value_name = "W", default_value_t = 1.0))]
    #[cfg_attr(feature = "cli", arg(allow_negative_numbers = true, value_parser = from_zero))]
    pub planarity_weight: f64,
    /// fsa: which two corners each of two leaves gives to the one that takes their place.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    #[serde(default)]
    pub corners: Corners,
    /// fsa: what the Hausdorff distance of two leaves is taken between.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    #[serde(default)]
    pub hausdorff: Hausdorff,
}

impl FsaOptions {
    /// With the corners that are published: those furthest from the other leaf.
    pub fn published() -> Self {
        Self {
            corners: Corners::Furthest,
            ..Self::default()
        }
    }
}

impl Default for FsaOptions {
    fn default() -> Self {
        Self {
            distance_weight: 1.0,
            planarity_weight: 1.0,
            corners: Corners::default(),
            hausdorff: Hausdorff::default(),
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
    let mut pairs = Pairs::new(foliage, cost, options.corners);
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
    hausdorff: Hausdorff,
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
            hausdorff: options.hausdorff,
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
            let distance = |v: &Vertex| b.distance_squared(v.position, self.hausdorff);
            a.vertices.iter().map(distance).fold(0.0, f64::max)
        };
        self.of_distance(from(a, b).max(from(b, a))) + self.of_planes(a, b)
    }
}

/// Room for rounding in bounds.
const SLACK: f64 = 1.0 - 1e-9;

#[cfg(test)]
mod tests;
