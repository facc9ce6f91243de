//! What lies behind a leaf.

/// In `pixels` pixels of a view a leaf is in front and another, or the
/// background, right behind it: that is what removing it would reveal.
///
/// Edges order by front, second and view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct RevealEdge {
    /// Number of the front leaf, from 1.
    pub front: u32,
    /// Number of the leaf behind it; 0 is the background.
    pub second: u32,
    /// Index of the view.
    pub view: u32,
    /// In how many pixels, at least 1.
    pub pixels: u32,
}
