//! Writing glTF: grown plants, and trees with fewer leaves.
//!
//! A LOD is the input with other leaves: nothing else is made anew. The JSON is
//! copied and changed where a leaf goes or grows; accessors and buffer views
//! keep their numbers, so that an extension nobody here knows stays right; the
//! bytes that are still named are packed into one buffer.

mod baked_instances;
mod base_color;
mod beyond_cards;
mod bounds;
pub(crate) mod chain;
mod compact_vertices;
mod compress;
mod content;
mod cutoffs;
mod draco;
mod draft;
mod drop_unreferenced;
mod files;
mod grid;
mod images;
mod instances;
mod interleaved;
mod leaf_edits;
mod lod_document;
mod meshes;
mod nodes;
pub(crate) mod old_normals;
mod packing;
mod plant;
mod primitive;
mod references;
mod single_leaf_mesh;
mod skeleton;
mod staged_files;
mod stand;
mod strips;
mod surfaces;
mod temporary_name;
#[cfg(test)]
mod tests;
mod texels;
mod vertices;

pub use cutoffs::{CutOutTexture, Cutoffs};
pub use files::{ImageFormat, NoImageFormat, PreparedLod, WriteOptions, Written};
pub use plant::{plant_into_glb, plant_to_glb};
pub(crate) use references::check_references;
pub use staged_files::{CommitError, StagedFiles};
pub use stand::{StandPart, StandWriter};
pub use surfaces::surfaces_to_glb;
