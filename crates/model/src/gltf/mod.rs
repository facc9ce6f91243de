//! glTF in and out.
//!
//! A [`Document`] is a file as it was found: its JSON, kept whole, and the
//! bytes of its buffers. [`Document::inspect`] says what is in it and what
//! would be taken for foliage; [`Document::into_tree`] finds the leaves.
//!
//! Rules of the reader:
//! - Every number of the file is checked before it is used, and nothing is
//!   allocated that the file's own size (or a stated limit) doesn't cover.
//! - World positions are f64: the file's f32 (or dequantised) position times
//!   the product of the node matrices. Where that product is the identity they
//!   are the file's own numbers.
//! - A leaf is a set of triangles of one primitive of one node (or one instance
//!   of it) that hang together by shared edges, edges being equal where the
//!   positions of both ends are: vertices split for normals or texture
//!   coordinates don't part a leaf, and leaves that touch in one point stay two.
//! - A file that a URI names lies in the glTF's own folder, links followed.
//! - Skins are read in bind pose, morph targets at rest.

mod accessor;
mod buffer;
mod choice;
mod container;
mod cutouts;
mod document;
mod error;
mod evidence;
mod find;
mod folder;
mod inspection;
mod instances;
mod leaves;
mod material;
mod meshopt;
mod name_evidence;
mod node;
mod parts;
mod picture;
mod primitive;
mod property;
mod report;
mod selector;
mod shape_evidence;
mod skeleton;
mod sparse;
mod surfaces;
mod survey;
mod tree;
mod uri;
mod view;
mod write;

pub use document::Document;
pub use error::{GltfError, Problem};
pub use evidence::Reason;
pub use inspection::{FoliageReport, Inspection, PrimitiveReport, Spread, TakenFor};
pub use selector::{Selector, SelectorError};
pub use surfaces::Detail;
pub use tree::Tree;
pub use write::{WriteProblem, Written, plant_into_glb, plant_to_glb};
