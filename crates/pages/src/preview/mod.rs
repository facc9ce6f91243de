//! One page to look at a tree's levels of detail.
//!
//! The page needs nothing else: its script, the geometry and the pictures are in
//! it, and it asks no network. It draws with WebGL 2; what it needs of the
//! browser beside that is `DecompressionStream` (any browser since 2023).
//!
//! Geometry is packed small (`geometry`), the pictures that levels share are in
//! it once (`textures`), and `page/` holds what the browser runs.

mod continuous;
mod geometry;
mod page;
mod textures;

use glam::DVec3;
use secateur_model::Surface;

use secateur_levels::chain::LevelReport;
use secateur_runtime::Screen;

pub use continuous::Continuous;
pub use page::{Packed, packed, page};
pub use textures::Pictures;

// What a page of a stream draws in the same way.
pub(crate) use geometry::{bounds, octahedral};
pub(crate) use page::{escaped, filled, look, vertex_shader};
pub(crate) use textures::Textures;

/// Levels of a tree to look at.
#[derive(Clone, Copy, Debug)]
pub struct Preview<'a> {
    /// What the page is headed with.
    pub title: &'a str,
    /// The screen that distances and heights in pixels are of.
    pub screen: Screen,
    /// The original first, then ever coarser ones.
    pub levels: &'a [Level<'a>],
    /// The removal order of its leaves, where there is one: any number of them can be looked at then,
    /// with the wood of the levels.
    pub continuous: Option<Continuous<'a>>,
}

/// A level: how it looks, and its figures.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// All that is drawn, each with whether it is foliage; the rest is wood.
    pub surfaces: &'a [(Surface, bool)],
    /// By surface where its vertices are when the next level takes over; nothing where they stay.
    pub ends: Option<&'a [Vec<DVec3>]>,
    /// What the page says of it.
    pub facts: Facts,
}

/// What a page says of a level.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Facts {
    /// What it is called, short: `LOD1`.
    pub name: String,
    /// The figures that the page's table shows.
    #[serde(flatten)]
    pub report: LevelReport,
}

/// Why there is no page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PreviewError {
    /// There is nothing to look at.
    #[error("a preview needs a tree with at least one triangle")]
    NothingToShow,
    /// An image could not be packed.
    #[error("a texture of {width} x {height} texels cannot be packed into the page ({reason})")]
    Texture {
        /// Its width in texels.
        width: u32,
        /// Its height in texels.
        height: u32,
        /// What the encoder said.
        reason: String,
    },
}
