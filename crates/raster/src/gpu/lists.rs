//! Lists of fragments from the GPU, window by window, put together view by view.

use super::chunk::Window;
use crate::{Fragment, ViewFragments};

/// Bytes of a fragment on the GPU: its depth and its leaf, 32 bits each.
pub(super) const FRAGMENT_BYTES: u64 = 8;

/// The lists of fragments that have come back from the GPU, in the order of their pixels.
pub(super) struct Lists {
    pixels_per_view: usize,
    /// Views of which all lists are there.
    pub(super) views: Vec<ViewFragments>,
    /// Where the lists of the next view start, as far as it has come.
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
    /// Number of fragments over all views.
    pub(super) len: u64,
    /// Rows of the area table, where areas are asked for.
    pub(super) area_px: Vec<u32>,
}

impl Lists {
    pub(super) fn new(pixels_per_view: usize) -> Self {
        Self {
            pixels_per_view,
            views: Vec::new(),
            starts: Vec::new(),
            fragments: Vec::new(),
            len: 0,
            area_px: Vec::new(),
        }
    }

    /// Appends the lists of a window and, if `table_bytes` is not 0, the areas of its chunk. `parts` are
    /// what came back: the number of dropped fragments, where lists start, how many of each are
    /// kept, the lists, and the areas.
    pub(super) fn append(&mut self, window: &Window, table_bytes: usize, parts: &[&[u8]]) {
        let pixels = window.pixel_count as usize;
        let dropped: &[u32] = bytemuck::cast_slice(parts[0]);
        let starts: &[u32] = bytemuck::cast_slice(&parts[1][..4 * (pixels + 1)]);
        let kept: &[u32] = bytemuck::cast_slice(&parts[2][..4 * pixels]);
        let list_bytes = FRAGMENT_BYTES as usize * window.fragment_count as usize;
        let lists: &[Fragment] = bytemuck::cast_slice(&parts[3][..list_bytes]);
        let kept = (dropped[0] > 0).then_some(kept);
        let mut pixel = 0;
        while pixel < pixels {
            // A window may end within a view, and go on over several.
            let end = pixels.min(pixel + self.pixels_per_view - self.starts.len());
            let first = (starts[pixel] - window.first_fragment) as usize;
            let size = (starts[end] - starts[pixel]) as usize;
            let kept = kept.map(|kept| &kept[pixel..end]);
            self.append_to_view(&starts[pixel..end], kept, &lists[first..first + size]);
            pixel = end;
        }
        self.area_px
            .extend_from_slice(bytemuck::cast_slice(&parts[4][..table_bytes]));
    }

    /// Lists of pixels that follow each other; of each `kept` fragments, or all.
    fn append_to_view(&mut self, starts: &[u32], kept: Option<&[u32]>, lists: &[Fragment]) {
        let before = self.fragments.len();
        // And for the end of the last.
        self.starts.reserve(starts.len() + 1);
        self.fragments.reserve(lists.len());
        match kept {
            None => {
                let own = starts.iter().map(|s| s - starts[0] + before as u32);
                self.starts.extend(own);
                self.fragments.extend_from_slice(lists);
            }
            Some(kept) => {
                for (start, kept) in starts.iter().zip(kept) {
                    self.starts.push(self.fragments.len() as u32);
                    let list = &lists[(start - starts[0]) as usize..][..*kept as usize];
                    self.fragments.extend_from_slice(list);
                }
            }
        }
        self.len += (self.fragments.len() - before) as u64;
        if self.starts.len() == self.pixels_per_view {
            self.starts.push(self.fragments.len() as u32);
            self.views.push(ViewFragments::from_lists(
                std::mem::take(&mut self.starts),
                std::mem::take(&mut self.fragments),
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three views of two pixels with lists of 1, 2, 1, 2, 0 and 3 fragments, in
    /// two windows of three pixels; `kept` says how many of each list are kept.
    fn appended(kept: [u32; 6]) -> Lists {
        let starts = [0u32, 1, 3, 4, 6, 6, 9];
        let fragments: Vec<Fragment> = (1..=9).map(|leaf| Fragment::new(9, leaf)).collect();
        let mut lists = Lists::new(2);
        for pixels in [0..3usize, 3..6] {
            let (first, end) = (starts[pixels.start], starts[pixels.end]);
            let window = Window {
                first_pixel: pixels.start as u32,
                pixel_count: pixels.len() as u32,
                first_fragment: first,
                fragment_count: end - first,
            };
            let kept = &kept[pixels.clone()];
            let dropped = end - first - kept.iter().sum::<u32>();
            let parts: [&[u8]; 5] = [
                bytemuck::bytes_of(&dropped),
                bytemuck::cast_slice(&starts[pixels.start..=pixels.end]),
                bytemuck::cast_slice(kept),
                bytemuck::cast_slice(&fragments[first as usize..end as usize]),
                bytemuck::cast_slice::<u32, u8>(&[]),
            ];
            lists.append(&window, 0, &parts);
        }
        lists
    }

    fn leaves(lists: &Lists) -> Vec<Vec<Vec<u32>>> {
        let of_list = |list: &[Fragment]| list.iter().map(|f| f.leaf()).collect();
        let of_view = |view: &ViewFragments| view.pixels().map(of_list).collect();
        lists.views.iter().map(of_view).collect()
    }

    #[test]
    fn windows_begin_and_end_within_views() {
        let lists = appended([1, 2, 1, 2, 0, 3]);
        let expected = [
            [vec![1], vec![2, 3]],
            [vec![4], vec![5, 6]],
            [vec![], vec![7, 8, 9]],
        ];
        assert_eq!(leaves(&lists), expected);
        assert_eq!(lists.len, 9);
    }

    #[test]
    fn what_was_dropped_is_left_out() {
        let lists = appended([1, 1, 1, 1, 0, 2]);
        let expected = [[vec![1], vec![2]], [vec![4], vec![5]], [vec![], vec![7, 8]]];
        assert_eq!(leaves(&lists), expected);
        assert_eq!(lists.len, 6);
    }
}
