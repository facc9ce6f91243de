//! Which levels of detail a plant gets, what they look like, and from where they are seen.
//!
//! - [`chain`]: which levels of detail a plant gets, and from which distances they are seen.
//! - [`choose_cutoffs`]: alpha cutoffs with which clients show as much of a level as there is, or whether
//!   they had better read no mip maps.
//! - [`dilated_textures`]: leaf textures whose clear texels have the colours of what is near;
//!   [`material_changes`] joins them with chosen cutoffs.
//! - [`impostor`]: pictures that stand for a plant far off.
//! - [`stand`]: which level each plant of a stand has.
//! - [`leaf_boxes`]: boxes about the leaves of branches, and pictures on their diagonal planes.

#![forbid(unsafe_code)]

pub mod chain;
mod clear_texels;
mod cutoffs;
mod dilate;
pub mod impostor;
pub mod leaf_boxes;
mod material_changes;
mod morph;
pub mod stand;

pub use clear_texels::{Dilated, dilated_textures};
pub use cutoffs::{ChosenCutoffs, CutoffChoice, MaterialChange, Raised, choose_cutoffs};
pub use material_changes::material_changes;
