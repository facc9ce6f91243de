//! From leaves and views to fragments and areas, in integers.
//!
//! Data flows one way: a [`Foliage`](secateur_model::Foliage) at some
//! [`Lod`](secateur_model::Lod) is projected in f64 and snapped to a sub-pixel
//! grid once ([`snap`]); from there every stage only adds, multiplies and
//! compares 32-bit integers, so that its CPU and GPU twins agree bit for bit:
//!
//! | stage | CPU twin | shader |
//! |---|---|---|
//! | [`SnappedTriangle`] to pixels | [`cpu::rasterise`] | `rasterise.wgsl` |
//! | a leaf's triangles to its pixels | [`cpu::LeafFragments`] | |
//! | pixels to [`Fragments`], the A-buffer | [`cpu::fragments`] | `fragments_*.wgsl` |
//! | pixels to a [`LeafIdImage`], by depth | [`cpu::draw_leaf_ids`] | `rasterise.wgsl` |
//! | front fragments to a [`LeafIdImage`] | [`Fragments::leaf_ids`] | `leaf_ids.wgsl` |
//! | [`LeafIdImage`] to an [`AreaTable`] | [`cpu::histogram`] | `histogram.wgsl` |
//!
//! What an area table says, viewpoint mutual information, is in [`measure`]. Fragments that
//! are edited stand in [`abuffer`], areas that change in [`measure::incremental`].
//!
//! The shaders run through wgpu, behind the feature `gpu` (on by default).
//!
//! Images are square. Pixel (x, y) is `y * resolution + x`, row 0 on top.
//!
//! # Which leaf owns a pixel
//! The one whose triangle covers the pixel's centre (top-left rule) nearest to
//! the eye; at equal depth the lowest leaf number. Leaves are two-sided. Where
//! a leaf's cut-out has a hole there is no fragment.

pub mod abuffer;
mod area_table;
mod cameras;
pub mod cpu;
mod engine;
mod fragments;
#[cfg(feature = "gpu")]
pub mod gpu;
mod leaf_id_image;
pub mod measure;
pub mod occluders;
pub mod prefetch;
mod rasteriser;
pub mod snap;
mod view;
mod view_set;

pub use area_table::AreaTable;
pub use cameras::{CamerasError, cameras_from_json, read_cameras};
pub use engine::{Engine, OpenEngine};
pub use fragments::{Fragment, Fragments, TooManyFragments, ViewFragments};
pub use leaf_id_image::LeafIdImage;
pub use rasteriser::{CpuRasteriser, RasterError, Rasteriser};
pub use snap::SnappedTriangle;
pub use view::{View, ViewError};
pub use view_set::ViewSet;

/// The largest image side in pixels: beyond it the edge functions would leave
/// 32 bits (see [`snap`]).
pub const MAX_RESOLUTION: u32 = 2048;

/// The most pixels over all views: the integer VMI is bounded for this many,
/// and pixel numbers over all views fit 32 bits.
pub const MAX_TOTAL_PIXELS: u64 = 1 << 29;

/// What is looked at, from where, how finely.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The leaves at their original sizes.
    pub foliage: &'a secateur_model::Foliage,
    /// Which of them are there, and how large. One with new leaves is drawn by
    /// [`Lod::foliage`](secateur_model::Lod::foliage).
    pub lod: &'a secateur_model::Lod,
    /// The cameras from which it is drawn.
    pub views: &'a ViewSet,
    /// Image width and height in pixels, 1 to [`MAX_RESOLUTION`].
    pub resolution: u32,
}

impl Scene<'_> {
    /// Pixels of one view.
    pub fn pixels_per_view(&self) -> usize {
        self.resolution as usize * self.resolution as usize
    }

    /// # Panics
    /// If the resolution or the number of pixels is out of range, or the level
    /// is one of another foliage.
    pub(crate) fn assert_in_range(&self) {
        assert!(
            (1..=MAX_RESOLUTION).contains(&self.resolution),
            "resolution {} is not in 1..={MAX_RESOLUTION}",
            self.resolution
        );
        let total = self.pixels_per_view() as u64 * self.views.len() as u64;
        assert!(
            total <= MAX_TOTAL_PIXELS,
            "{total} pixels over all views, at most {MAX_TOTAL_PIXELS}"
        );
        assert_eq!(
            self.lod.area_scales().len(),
            self.foliage.leaves().len(),
            "the level belongs to another foliage"
        );
        assert!(
            self.lod.is_of_originals(),
            "a level with new leaves is drawn as the foliage that it makes"
        );
    }
}
