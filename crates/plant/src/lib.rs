//! Plants grown from parametric L-systems.
//!
//! ```text
//! rule file -> Rules --derive--> Word --draw--> Skeleton -> Plant
//! ```
//!
//! - [`grow()`]: a [`Species`] and a number of leaves to a plant, wood and leaves;
//!   [`grow_rules`] does the same with one's own rules.
//! - [`Rules`]: a rule file, read; [`language`] says what can be in it, and
//!   [`Species::text`] gives examples.
//! - [`RuleSource`]: a species or a rule file by its name; plants of it, and levels of them by their branches.
//! - [`draw`]: the turtle, from a derived [`Word`] to a [`Skeleton`].
//! - [`Branches`], [`Chain`]: branches by what they matter, every prefix a plant.
//! - [`merge_levels`]: sticks and leaf clusters merged, levels of a whole plant.
//! - [`chain_order`], [`merge_order`]: the same two as orders in which any foliage
//!   with a skeleton loses its leaves.
//! - [`ellipsoid_crown()`]: leaves without wood, for measuring.
//! - [`Random`]: the generator behind every chance.
//!
//! ```
//! use secateur_plant::{GrowOptions, Species, grow};
//!
//! let options = GrowOptions { leaves: 500, seed: 1 };
//! let oak = grow(Species::Oak, &options)?;
//! assert_eq!(oak.triangles_per_leaf.len(), 500);
//! assert_eq!(oak.leaves.triangles.len(), 1000);
//! # Ok::<(), secateur_plant::GrowError>(())
//! ```
//!
//! Trees are the same bit for bit wherever they grow: chance comes from integers,
//! and sines, roots and powers from the `libm` crate.

#![forbid(unsafe_code)]

// What pest derives names it, where pest's own `std` feature is off.
extern crate alloc;

mod bark_texture;
mod branch_level;
mod branches;
mod chain;
mod chain_order;
mod chain_paths;
mod depth;
mod derive;
mod ellipsoid_crown;
mod grow;
mod holds;
pub mod language;
mod leaf_surface;
mod leaf_texture;
mod merge;
mod outline;
mod rule_source;
mod skeleton;
mod species;
mod turtle;
mod wood;

pub use branch_level::{BranchAmount, BranchLevel, BranchLevelOptions, BranchMethod};
pub use branches::{Branch, BranchIndex, Branches, Metric};
pub use chain::{Chain, Record};
pub use chain_order::chain_order;
pub use depth::{MAX_DEPTH, TooDeep, check_depth};
pub use derive::Word;
pub use ellipsoid_crown::{EllipsoidCrown, ellipsoid_crown};
pub use grow::{
    GrowError, GrowOptions, MAX_LEAVES, grow, grow_rules, grow_skeleton, plant_of, rules_skeleton,
};
pub use language::{Rules, RulesError};
pub use merge::{
    ClusterSize, MergedLevel, Scheme, SchemeError, StickSize, Thresholds, ThresholdsError,
    height_over_radius, merge_at, merge_below, merge_levels, merge_order,
};
pub use rule_source::{RuleSource, RuleSourceError};
pub use secateur_model::{PlantSkeleton, Random, Segment, SegmentIndex};
pub use skeleton::{LeafKind, LeafPose, Skeleton};
pub use species::{Species, UnknownSpecies};
pub use turtle::draw;
