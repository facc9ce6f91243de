//! Which leaves of a plant can go, and how large the others become.
//!
//! A run is a row of passes: leaves become coarser ([`mod@coarsen`]), a [`Method`] chooses which go
//! and which grow for them ([`select`]), and the sizes of what is left are fitted to the original
//! ([`mod@fit`]). What views show of the result is one function, [`observe`], for all of them.
//!
//! - [`simplify()`], [`simplify_on`]: a foliage and [`Options`] in, a LOD out.
//! - [`vds`]: viewpoint-driven simplification, the greedy method driven by viewpoint mutual
//!   information ([`secateur_raster::measure::vmi`]), once as the literal algorithm and once as an
//!   exact, fast engine.
//! - [`fsa`]: leaf collapse, two leaves at a time become one.
//! - [`stochastic`]: a random order, and survivors that grow alike.
//! - [`meshopt`](mod@meshopt): a mesh simplifier that knows triangles, not leaves.
//! - `by_branches` (feature `plant`): methods that follow the plant's branches.
//! - [`resolution`]: how fine the images must be.

mod audit;
mod auto_views;
#[cfg(feature = "plant")]
pub mod by_branches;
pub mod coarsen;
mod edge_collapses;
mod effort;
mod error;
mod fill;
mod finer_level;
pub mod fit;
pub mod fsa;
pub mod hanging_leaves;
mod last_views;
mod memory;
pub mod meshopt;
mod method;
mod needles;
mod observe;
#[cfg(feature = "cli")]
pub mod option_numbers;
mod option_values;
mod options;
mod passes;
mod preset;
pub mod resolution;
mod run;
pub mod select;
mod shared;
mod simplified;
mod sizes;
mod stage;
pub mod stochastic;
mod target;
pub mod vds;
mod views;
mod warning;
pub mod whole;
pub mod wood;

pub use effort::{Effort, Work};
pub use error::Error;
pub use finer_level::FinerLevel;
pub use memory::{check_run, take_plant};
pub use method::Method;
pub use needles::Needle;
pub use observe::{Shown, observe};
pub use option_values::{
    Alpha, FieldOfView, Fitting, LeafTriangles, Needles, Resolution, Sides, as_seen,
};
pub use options::Options;
pub use passes::Passes;
pub use preset::Preset;
pub use run::{simplify, simplify_on, simplify_sharing};
pub use shared::Shared;
pub use simplified::{Simplified, Stopped};
pub use stage::{Observer, Progress, Stage};
pub use target::{Amount, Target};
pub use views::{Views, sphere_of};
pub use warning::Warning;

pub(crate) use secateur_raster::measure::{lg, vmi};
