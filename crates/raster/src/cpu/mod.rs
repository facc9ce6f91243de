//! The twins that run on the CPU; the GPU's must give the same bits.

mod canvas;
mod draw;
mod fragments;
mod histogram;
mod runs;
mod triangle;

pub use draw::{draw_leaf_ids, draw_leaf_ids_among};
pub use fragments::{
    LeafFragments, areas_of_heads, fragments, fragments_and_areas, fragments_within,
};
pub use histogram::{areas, histogram};
pub use triangle::rasterise;
