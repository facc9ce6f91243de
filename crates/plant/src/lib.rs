//! Plants grown from parametric L-systems.
//!
//! ```text
//! Species -> LSystem --derive--> [Module] --draw--> Skeleton -> Plant
//! ```
//!
//! - [`grow()`]: a [`Species`] and a number of leaves to a plant, wood and leaves.
//! - [`LSystem`], [`Production`], [`Module`]: rules and what they rewrite.
//! - [`draw`]: the turtle, from modules to a [`Skeleton`].
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

mod ellipsoid_crown;
mod grow;
mod leaf_card;
mod leaf_texture;
mod lsystem;
mod module;
mod oak;
mod random;
mod skeleton;
mod species;
mod turtle;
mod wood;

pub use ellipsoid_crown::{EllipsoidCrown, ellipsoid_crown};
pub use grow::{GrowError, GrowOptions, MAX_LEAVES, grow, grow_skeleton};
pub use lsystem::{DeriveError, LSystem, Predecessor, Production};
pub use module::{Module, Symbol};
pub use random::Random;
pub use skeleton::{LeafPose, Segment, SegmentIndex, Skeleton};
pub use species::{Species, UnknownSpecies};
pub use turtle::{TurtleError, draw};
