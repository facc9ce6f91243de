//! Trees in a scene: how large a screen shows them, and a page to look at them.
//!
//! - [`Screen`]: how many pixels high a screen shows a plant at a distance.
//! - [`choose_cutoffs`]: alpha cutoffs with which clients show as much of a level as there is, or whether
//!   they had better read no mip maps.
//! - [`dilated_textures`]: leaf textures whose clear texels have the colours of what is near;
//!   [`material_changes`] joins them with chosen cutoffs.
//! - [`chain`]: which levels of detail a plant gets, and from which distances they are seen.
//! - [`impostor`]: pictures that stand for a plant far off.
//! - [`leaf_boxes`]: boxes about the leaves of branches, and pictures on their diagonal planes.
//! - [`order_file`]: removal orders as files, for any level later.
//! - [`view_dependent`]: parts of a crown in full detail, others coarse, as a view asks for it.
//! - [`prefix_buffers`]: a removal order on a GPU, every level a prefix of one index buffer.
//! - [`stream`]: a plant that can be drawn while it arrives, every prefix a plant.
//! - [`wind`]: how a plant sways, original and levels alike.
//! - [`stand`]: instances of a plant, those that a camera sees, and how much detail each needs.
//! - [`preview`]: a page that shows a tree's levels of detail beside the original.

#![forbid(unsafe_code)]

pub mod chain;
mod clear_texels;
mod cutoffs;
mod dilate;
#[cfg(test)]
mod gpu_for_tests;
pub mod impostor;
pub mod leaf_boxes;
mod material_changes;
pub mod order_file;
pub mod prefix_buffers;
pub mod preview;
mod screen;
pub mod stand;
pub mod stream;
pub mod view_dependent;
pub mod wind;

pub use clear_texels::{Dilated, dilated_textures};
pub use cutoffs::{ChosenCutoffs, MaterialChange, Raised, choose_cutoffs};
pub use material_changes::material_changes;
pub use screen::Screen;
