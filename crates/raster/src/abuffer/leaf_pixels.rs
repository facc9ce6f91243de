//! In which pixels each leaf has a fragment.

use std::ops::Range;

use crate::ViewFragments;

/// Pixels of leaves that have others by now are dropped when they are more than those that
/// count, and this number more.
const MAX_STALE: usize = 65_536;

/// By leaf the pixels in which it has a fragment, in order.
#[derive(Clone, Debug)]
pub(super) struct LeafPixels {
    /// Start and length, by leaf number.
    ranges: Vec<(u32, u32)>,
    pixels: Vec<u32>,
    /// How many entries of `pixels` some range still covers.
    live: usize,
}

impl LeafPixels {
    /// Of the fragments of some views, whose pixels follow each other.
    pub(super) fn new(views: &[ViewFragments], leaf_count: usize) -> Self {
        let mut ranges = vec![(0u32, 0u32); leaf_count + 1];
        for fragment in views.iter().flat_map(ViewFragments::as_slice) {
            ranges[fragment.leaf() as usize].1 += 1;
        }
        let mut before = 0;
        for range in &mut ranges {
            range.0 = before;
            before += std::mem::take(&mut range.1);
        }
        let mut pixels = vec![0; before as usize];
        for (pixel, list) in (0..).zip(views.iter().flat_map(ViewFragments::pixels)) {
            for fragment in list {
                let (start, filled) = &mut ranges[fragment.leaf() as usize];
                pixels[(*start + *filled) as usize] = pixel;
                *filled += 1;
            }
        }
        Self {
            ranges,
            live: pixels.len(),
            pixels,
        }
    }

    #[inline]
    pub(super) fn range(&self, leaf: u32) -> Range<usize> {
        let (start, len) = self.ranges[leaf as usize];
        start as usize..(start + len) as usize
    }

    #[inline]
    pub(super) fn of(&self, leaf: u32) -> &[u32] {
        &self.pixels[self.range(leaf)]
    }

    /// The pixels of all leaves: those of one are at its [range](Self::range).
    #[inline]
    pub(super) fn all(&self) -> &[u32] {
        &self.pixels
    }

    pub(super) fn clear(&mut self, leaf: u32) {
        self.live -= self.ranges[leaf as usize].1 as usize;
        self.ranges[leaf as usize].1 = 0;
    }

    /// The leaf has these pixels, which are in order, instead of its own.
    pub(super) fn replace(&mut self, leaf: u32, pixels: impl ExactSizeIterator<Item = u32>) {
        self.clear(leaf);
        if self.pixels.len() > 2 * self.live + MAX_STALE {
            self.compact();
        }
        let start = u32::try_from(self.pixels.len()).expect("fragments fit 32 bits");
        self.live += pixels.len();
        self.ranges[leaf as usize] = (start, pixels.len() as u32);
        self.pixels.extend(pixels);
    }

    fn compact(&mut self) {
        let mut kept = Vec::with_capacity(self.live);
        for (start, len) in &mut self.ranges {
            let range = *start as usize..(*start + *len) as usize;
            *start = kept.len() as u32;
            kept.extend_from_slice(&self.pixels[range]);
        }
        self.pixels = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fragment;

    #[test]
    fn pixels_of_leaves_outlast_those_that_are_dropped() {
        let fragments = [1, 2, 2].map(|leaf| Fragment::new(7, leaf));
        let view = ViewFragments::from_lists(vec![0, 2, 2, 3], fragments.to_vec());
        let mut pixels = LeafPixels::new(&[view.clone(), view], 3);
        let others: [&[u32]; 2] = [&[0, 3], &[]];
        assert_eq!([pixels.of(1), pixels.of(3)], others);
        let mut longest = 0;
        for round in 0..40_000 {
            assert_eq!(
                pixels.of(2),
                if round == 0 {
                    &[0, 2, 3, 5][..]
                } else {
                    &[1, 4, 5]
                }
            );
            pixels.replace(2, [1, 4, 5].into_iter());
            assert_eq!([pixels.of(1), pixels.of(3)], others);
            longest = longest.max(pixels.all().len());
        }
        assert!((MAX_STALE..MAX_STALE + 20).contains(&longest), "{longest}");
    }
}
