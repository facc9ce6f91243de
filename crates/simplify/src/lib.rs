//! Which leaves can go.
//!
//! - [`vmi`]: viewpoint mutual information, the measure.
//! - [`vds`]: viewpoint-driven simplification, the greedy method driven by it,
//!   once as the literal algorithm and once as an exact, fast engine.
//! - [`fsa`]: leaf collapse, two leaves at a time become one.
//! - [`stochastic`]: a random order, and survivors that grow alike.
//! - [`meshopt`](mod@meshopt): a mesh simplifier that knows triangles, not leaves.
//! - [`mod@coarsen`]: leaves of fewer triangles, before any goes.
//! - [`mod@fit`]: sizes of the leaves that are left, fitted to outline and VMI.
//! - [`resolution`]: how fine the images must be.
//!
//! Every method returns a [`RemovalOrder`](secateur_model::RemovalOrder).

pub mod coarsen;
pub mod fit;
pub mod fsa;
pub mod meshopt;
pub mod resolution;
pub mod stochastic;
pub mod vds;

pub use secateur_raster::measure::{lg, vmi};
