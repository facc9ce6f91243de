//! What every other crate of secateur speaks about.
//!
//! - [`Foliage`]: the leaves of a plant, in world space, each a few triangles.
//! - [`LeafId`]: the name of a leaf; 0 is the background and never a leaf.
//! - [`Cutout`]: the alpha mask of a leaf texture, as bits.
//! - [`RemovalOrder`]: what a simplification method decided, step by step.
//! - [`Lod`]: which leaves are left, and how large, after some of those steps.
//! - [`LodModel`]: all levels of a removal order, each reached from any other.
//! - [`Forest`]: the same order as collapses that depend on each other, for parts of a foliage.
//! - [`Surface`]: textured triangles, what a tree looks like; [`Plant`]: a grown
//!   plant made of two of them, its [`PlantSkeleton`], and what its parts hang on ([`Hold`]).
//! - [`Memory`]: how much memory a run may take; [`Budget`]: what is left of it.
//! - [`Note`]: a sentence about a plant, with the options that it speaks of.
//! - [`Random`]: numbers drawn by lot, the same on every machine.
//!
//! Nothing here knows a file format, a view, an image or a method.

#![forbid(unsafe_code)]

mod cutout;
mod foliage;
mod forest;
mod hex;
mod hold;
mod leaf_id;
mod lod;
mod lod_model;
mod memory;
mod new_leaf;
mod note;
mod order_error;
mod plant;
mod principal_axes;
mod random;
mod removal_order;
mod skeleton;
mod strips;
mod surface;

pub use cutout::{Cutout, Wrap};
pub use foliage::{BoundingSphere, Facing, Foliage, FoliageError, Leaf, LeafTriangle, centroid_of};
pub use forest::{CollapseIndex, Forest, Heirs, NoHeirs, Node, NodeIndex};
pub use hex::hex;
pub use hold::{Hold, PlantHolds};
pub use leaf_id::LeafId;
pub use lod::Lod;
pub use lod_model::{LodModel, UniformLevel};
pub use memory::{Budget, Memory, OverMemory, Remedy};
pub use new_leaf::{CornerRef, NewCorner, NewLeaf, Place};
pub use note::{NamedOption, Note};
pub use order_error::OrderError;
pub use plant::Plant;
pub use principal_axes::{moment, principal_axes};
pub use random::Random;
pub use removal_order::{Growth, RemovalOrder, Step};
pub use skeleton::{PlantSkeleton, Segment, SegmentIndex, SkeletonError};
pub use strips::{joined_strips, strips};
pub use surface::{AlphaMode, Filters, Finish, Material, Mips, NormalMap, Surface, Texture};
