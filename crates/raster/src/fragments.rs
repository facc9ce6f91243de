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

/// The fragments of one view. A leaf has at most one fragment a pixel, its
/// nearest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewFragments {
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl ViewFragments {
    /// From lists laid end to end: those of pixel k (`row * resolution + column`)
    /// are `fragments[starts[k]..starts[k + 1]]`, in order.
    ///
    /// # Panics
    /// If `starts` does not lead from 0 to the number of fragments.
    pub fn from_lists(starts: Vec<u32>, fragments: Vec<Fragment>) -> Self {
        let ends = [starts.first(), starts.last()].map(|end| end.map(|end| *end as usize));
        assert_eq!(ends, [Some(0), Some(fragments.len())]);
        Self { starts, fragments }
    }

    /// The fragments of a pixel, nearest first.
    #[inline]
    pub fn at(&self, pixel: usize) -> &[Fragment] {
        &self.fragments[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }

    /// The fragments of each pixel in turn.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[Fragment]> {
        let pixels = self.starts.windows(2);
        pixels.map(|w| &self.fragments[w[0] as usize..w[1] as usize])
    }

    /// All fragments, pixel by pixel.
    pub fn as_slice(&self) -> &[Fragment] {
        &self.fragments
    }
}

/// The fragments of all views.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fragments {
    resolution: u32,
    views: Vec<ViewFragments>,
}

impl Fragments {
    /// Of views of `resolution` x `resolution` pixels.
    ///
    /// # Panics
    /// If a view has another number of pixels, or there are over 2^32 fragments.
    pub fn from_views(resolution: u32, views: Vec<ViewFragments>) -> Self {
        let pixels = resolution as usize * resolution as usize;
        assert!(views.iter().all(|view| view.pixels().len() == pixels));
        let fragments = Self { resolution, views };
        assert!(
            u32::try_from(fragments.len()).is_ok(),
            "{} fragments, at most {}",
            fragments.len(),
            u32::MAX
        );
        fragments
    }

    /// Width and height of a view in pixels.
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Pixels of one view.
    pub fn pixels_per_view(&self) -> usize {
        self.resolution as usize * self.resolution as usize
    }

    /// The views in turn.
    pub fn views(&self) -> &[ViewFragments] {
        &self.views
    }

    /// Takes the views apart.
    pub fn into_views(self) -> Vec<ViewFragments> {
        self.views
    }

    /// How many fragments there are over all views.
    pub fn len(&self) -> usize {
        self.views.iter().map(|view| view.fragments.len()).sum()
    }

    /// Whether nothing is seen in any view.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The front fragments of one view.
    pub fn leaf_ids(&self, view: usize) -> LeafIdImage {
        let front = |list: &[Fragment]| list.first().map_or(0, |f| f.leaf());
        LeafIdImage {
            resolution: self.resolution,
            leaf_ids: self.views[view].pixels().map(front).collect(),
        }
    }
}

/// More fragments than there may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there are {found} fragments over all views, and at most {most} are allowed")]
pub struct TooManyFragments {
    /// How many there are; where a GPU counts, how many at least.
    pub found: u64,
    /// How many there may be.
    pub most: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "left: [Some(1), Some(1)]")]
    fn lists_begin_with_the_first_fragment() {
        ViewFragments::from_lists(vec![1, 1], vec![Fragment::new(0, 1)]);
    }

    #[test]
    #[should_panic(expected = "left: [Some(0), Some(2)]")]
    fn lists_end_with_the_last_fragment() {
        ViewFragments::from_lists(vec![0, 2], vec![Fragment::new(0, 1)]);
    }

    #[test]
    #[should_panic(expected = "== pixels")]
    fn a_view_has_all_its_pixels() {
        let view = ViewFragments::from_lists(vec![0, 0], Vec::new());
        Fragments::from_views(2, vec![view]);
    }
}
