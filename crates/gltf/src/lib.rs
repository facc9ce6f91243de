//! Edits glTF without renumbering what stays.
//!
//! Most programs that change a glTF file read it into structures of their own
//! and write it anew. What they do not know is lost on the way: extras,
//! extensions, names, animations, the order of lists. Here the file itself is
//! what is edited. Its JSON is kept whole, an edit changes the entries that it
//! concerns, and accessors and buffer views keep their numbers, so that whatever
//! else names an entry by its number stays right, even an extension that this
//! crate has never heard of.
//!
//! The edits are those that a tree needs: connected sets of triangles (leaves)
//! are removed, resized, or replaced by others.
//!
//! # From a file to an edited file
//! 1. [`Document::open`] reads a .glb or .gltf; every number in it is checked.
//! 2. [`Document::inspect`] says what is in it, and what looks like foliage.
//! 3. [`Document::into_tree`] makes a [`Tree`]: it splits the triangles that
//!    [`Selector`]s name, or that look like foliage, into leaves.
//! 4. A [`Lod`](secateur_model::Lod) says which leaves are left, and how large.
//! 5. [`Tree::write_lod`] writes the file with these leaves, and
//!    [`Tree::lod_to_bytes`] a GLB to memory.
//!
//! ```
//! use secateur_gltf::Document;
//! use secateur_model::{LeafId, Lod};
//!
//! // Two triangles that do not touch, in a buffer that nobody names twice.
//! let file = br#"{
//!     "asset": {"version": "2.0"},
//!     "scene": 0,
//!     "scenes": [{"nodes": [1]}],
//!     "nodes": [{"name": "not drawn"}, {"mesh": 0, "extras": {"season": "spring"}}],
//!     "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "material": 0}]}],
//!     "materials": [{"name": "leaf", "extensions": {"ACME_wind": {"sway": 0.5}}}],
//!     "extensionsUsed": ["ACME_wind"],
//!     "accessors": [
//!         {"componentType": 5126, "count": 1, "type": "VEC3", "extras": "somebody needs it"},
//!         {"componentType": 5126, "count": 6, "type": "VEC3", "bufferView": 0,
//!          "min": [0, 0, 0], "max": [1, 1, 2]}
//!     ],
//!     "bufferViews": [{"buffer": 0, "byteLength": 72}],
//!     "buffers": [{"byteLength": 72, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAABAAACAPwAAAAAAAABAAAAAAAAAgD8AAABA"}]
//! }"#;
//! let document = Document::from_bytes("two.gltf", file.to_vec(), None)?;
//! let tree = document.into_tree(&["material:leaf".parse()?])?;
//! assert_eq!(tree.foliage().leaves().len(), 2);
//!
//! let mut lod = Lod::original(2);
//! lod.remove(LeafId::from_index(0));
//! let glb = tree.lod_to_bytes(&lod)?;
//!
//! let edited = Document::from_bytes("one.glb", glb, None)?;
//! let (old, new) = (tree.document().json(), edited.json());
//! // Three vertices fewer under the same number, with the bounds that they have now.
//! assert_eq!(new["accessors"][1]["count"], 3);
//! assert_eq!(new["accessors"][1]["min"], serde_json::json!([0.0, 0.0, 2.0]));
//! // The rest is as it was.
//! assert_eq!(new["accessors"][0], old["accessors"][0]);
//! for list in ["nodes", "meshes", "materials", "extensionsUsed"] {
//!     assert_eq!(new[list], old[list]);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Rules of the reader
//! - Every number of the file is checked before it is used, and nothing is
//!   allocated that the file's own size (or a stated limit) doesn't cover.
//! - What the file and its images take is reckoned before it is taken, and keeps
//!   to the memory that the file was opened with.
//! - World positions are f64: the file's f32 (or dequantised) position times
//!   the product of the node matrices. Where that product is the identity they
//!   are the file's own numbers.
//! - A leaf is a set of triangles of one primitive of one node (or one instance
//!   of it) that hang together by shared edges, edges being equal where the
//!   positions of both ends are: vertices split for normals or texture
//!   coordinates don't part a leaf, and leaves that touch in one point stay two.
//! - A file that a URI names lies in the glTF's own folder, links followed.
//! - Skins are read in bind pose, morph targets at rest.
//!
//! # Rules of the writer
//! - An entry that nothing names any more goes if it is the last of its list, and
//!   otherwise gives its number to a new entry or keeps it as the smallest valid
//!   one. Only meshes that are left without triangles may make others move up, and
//!   only where every extension of the file is one whose references are known.
//! - The bytes that are still named are packed into one buffer.
//! - What is meshopt-compressed or quantised stays so, and streams that still serve are copied;
//!   Draco-compressed primitives are written so, with vertices and triangles in another order.
//! - The same input gives the same bytes.
//!
//! # Map
//! | for | look at |
//! |---|---|
//! | the two chunks of a GLB | `container.rs` |
//! | elements of accessors | `accessor.rs`, `sparse.rs`, `view.rs`, `meshopt/`, `draco.rs` |
//! | what is drawn, and where | `node.rs`, `instances.rs`, `parts.rs` |
//! | which triangles are a leaf | `leaves.rs`, `find.rs`, `found_leaves.rs`; what is doubtful: `find_warnings.rs` |
//! | what is foliage | `choice.rs`, `evidence.rs`, `selector.rs`, `known_roles.rs`; wood among leaves: `wood_pieces.rs`; what a click or a lasso meets: `pieces.rs`, `scene_pieces.rs` |
//! | what is not the plant | `roles.rs`, `helper_names.rs`, `levels_inside.rs`, `levels_in_one_place.rs`; pieces of a primitive: `halves.rs` |
//! | how a surface looks | `material.rs`, `vertex_alpha.rs`, `picture.rs`, `ktx2.rs`, `cutouts.rs`, `surfaces.rs` |
//! | kinds of plants in a scene, and a scene put together | `scene_kinds.rs`, `write/stand.rs` |
//! | cameras of a scene, and what hides leaves | `scene.rs`; cameras that move: `camera_path.rs` |
//! | what becomes of a primitive | `write/meshes.rs`, `write/primitive.rs`, `write/instances.rs` |
//! | which entries stay | `write/references.rs`, `write/drop_unreferenced.rs` |
//! | chains of levels | `write/chain/`; as USD: `write/chain/usd/` |
//! | alpha cutoffs of a level | `write/cutoffs.rs`, `write/beyond_cards.rs` |
//! | files on disk | `write/files.rs`, `write/images.rs` |
//! | grown plants | `write/plant.rs` |
//! | what vertices hang on, for wind | `wind.rs`; where the file does not say it: `hang.rs` |
//! | textured triangles as a file | `write/surfaces.rs` |

#![forbid(unsafe_code)]

mod accessor;
mod binary_chunk;
mod buffer;
mod camera_path;
mod chain_problem;
mod choice;
mod container;
mod cost;
mod cutouts;
mod document;
mod draco;
mod error;
mod evidence;
mod file_kind;
mod find;
mod find_warnings;
mod folder;
mod found_leaves;
mod halves;
mod hang;
mod helper_names;
mod input;
mod inspection;
mod instances;
mod kept_images;
mod known_roles;
mod ktx2;
mod leaf_surfaces;
mod leaves;
mod level_names;
mod levels_in_one_place;
mod levels_inside;
mod material;
mod material_images;
mod meshopt;
mod morph_end;
mod name_evidence;
mod node;
mod order_extras;
mod parts;
mod picture;
mod pieces;
mod primitive;
mod property;
mod report;
mod role_groups;
mod roles;
mod scene;
mod scene_kinds;
mod scene_pieces;
mod selected;
mod selector;
mod shape_evidence;
mod skeleton;
mod sparse;
mod surfaces;
mod survey;
mod tree;
mod uri;
mod vertex_alpha;
mod view;
mod whole_tree;
mod wind;
mod wood_pieces;
mod write;
mod write_problem;

pub mod chain {
    //! Chains of levels of detail, in the layouts that engines read.
    //!
    //! [`Tree::chain_to_bytes`](crate::Tree::chain_to_bytes) and
    //! [`Tree::write_chain`](crate::Tree::write_chain) make one of [`Level`]s.

    pub use super::chain_problem::{ChainProblem, MAX_LEVELS};
    pub use super::write::chain::LevelContent;
    pub use super::write::chain::{
        ChainFile, ChainFiles, Layout, Level, LevelTexture, MORPH, Morph, PreparedChain,
        UnknownLayout, WrittenChain, check_name,
    };
}

pub use camera_path::{MAX_VIEWS_OF_A_PATH, VIEWS_OF_A_PATH};
pub use cost::LevelCost;
pub use document::Document;
pub use error::{GltfError, Problem};
pub use evidence::Reason;
pub use file_kind::{has_extension, is_gltf_name};
pub use halves::OtherPieces;
pub use input::read_within;
pub use inspection::{FoliageReport, Inspection, PrimitiveReport, Spread, TakenFor};
pub use leaf_surfaces::{LeafSurface, SurfaceLeaf};
pub use material_images::{MaterialImage, TexelContent};
pub use pieces::Piece;
pub use scene::{MAX_CAMERA_WEIGHT, MAX_WEIGHED_CAMERAS, SceneCamera};
pub use scene_kinds::{MAX_THINGS, Placement, SceneKind};
pub use scene_pieces::ScenePieces;
pub use selector::{Selector, SelectorError};
pub use surfaces::{Detail, DrawnSurface};
pub use tree::Tree;
pub use vertex_alpha::VertexAlpha;
pub use whole_tree::WholeTree;
pub use write::{
    CommitError, CutOutTexture, Cutoffs, ImageFormat, NoImageFormat, PreparedLod, StagedFiles,
    StandPart, StandWriter, WriteOptions, Written, plant_into_glb, plant_to_glb, surfaces_to_glb,
};
pub use write_problem::WriteProblem;
