//! The A-buffer: every leaf behind every pixel, nearest first.

use crate::LeafIdImage;

/// One leaf at one pixel: depth in the upper, leaf number in the lower 32
/// bits, so that the order of the integers is the order of ownership: nearest
/// first, at equal depth the lowest leaf number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Fragment(u64);

impl Fragment {
    /// A leaf (its number) at a depth.
    #[inline]
    pub fn new(depth: u32, leaf: u32) -> Self {
        Self(u64::from(depth) << 32 | u64::from(leaf))
    }

    /// Depth, smaller is nearer (see [`snap`](crate::snap)).
    #[inline]
    pub fn depth(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The leaf's number, from 1.
    #[inline]
    pub fn leaf(self) -> u32 {
        self.0 as u32
    }
}

/// The fragments of all views. A leaf has at most one fragment a pixel, its
/// nearest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fragments {
    resolution: u32,
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Fragments {
    /// From lists laid end to end: those of pixel k (`view * P + pixel`) are
    /// `fragments[starts[k]..starts[k + 1]]`, in order.
    ///
    /// # Panics
    /// If `starts` does not end with the number of fragments, or is no whole
    /// number of views.
    pub fn from_lists(resolution: u32, starts: Vec<u32>, fragments: Vec<Fragment>) -> Self {
        let pixels = resolution as usize * resolution as usize;
        assert_eq!((starts.len() - 1) % pixels, 0, "a whole number of views");
        assert_eq!(starts.last().copied(), Some(fragments.len() as u32));
        Self {
            resolution,
            starts,
            fragments,
        }
    }

    /// Width and height of a view in pixels.
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Pixels of one view.
    pub fn pixels_per_view(&self) -> usize {
        self.resolution as usize * self.resolution as usize
    }

    /// Views.
    pub fn view_count(&self) -> usize {
        (self.starts.len() - 1) / self.pixels_per_view()
    }

    /// How many fragments there are over all views.
    pub fn len(&self) -> usize {
        self.fragments.len()
    }

    /// Whether nothing is seen in any view.
    pub fn is_empty(&self) -> bool {
        self.fragments.is_empty()
    }

    /// The fragments of pixel `view * P + pixel`, nearest first.
    #[inline]
    pub fn at(&self, view_pixel: usize) -> &[Fragment] {
        &self.fragments[self.starts[view_pixel] as usize..self.starts[view_pixel + 1] as usize]
    }

    /// Where each pixel's list starts, and the end of the last.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// All fragments, pixel by pixel.
    pub fn as_slice(&self) -> &[Fragment] {
        &self.fragments
    }

    /// Takes the lists apart: starts and fragments.
    pub fn into_lists(self) -> (Vec<u32>, Vec<Fragment>) {
        (self.starts, self.fragments)
    }

    /// The front fragments of one view.
    pub fn leaf_ids(&self, view: usize) -> LeafIdImage {
        let pixels = self.pixels_per_view();
        let front = |k: usize| self.at(k).first().map_or(0, |f| f.leaf());
        LeafIdImage {
            resolution: self.resolution,
            leaf_ids: (view * pixels..(view + 1) * pixels).map(front).collect(),
        }
    }
}
