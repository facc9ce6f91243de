//! Lists of fragments from the GPU, window by window, put together view by view.

use rayon::prelude::*;

use super::chunk::Window;
use crate::{Fragment, ViewFragments};

/// Bytes of a fragment on the GPU: its depth and its leaf, 32 bits each.
pub(super) const FRAGMENT_BYTES: u64 = 8;

/// The fewest fragments for which a copy is shared by another core.
const LEAST_COPY: usize = 1 << 14;

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
        // A window may begin and end within a view, and go on over several.
        let mut runs = Vec::new();
        let mut pixel = 0;
        while pixel < pixels {
            let filled = if pixel == 0 { self.starts.len() } else { 0 };
            let end = pixels.min(pixel + self.pixels_per_view - filled);
            runs.push(pixel..end);
            pixel = end;
        }
        let runs: Vec<Run> = runs
            .into_par_iter()
            .map(|run| {
                let [first, end] =
                    [run.start, run.end].map(|at| starts[at] - window.first_fragment);
                let kept = kept.map(|kept| &kept[run.clone()]);
                Run::new(&starts[run], kept, &lists[first as usize..end as usize])
            })
            .collect();
        for run in runs {
            self.append_to_view(run);
        }
        self.area_px
            .extend_from_slice(bytemuck::cast_slice(&parts[4][..table_bytes]));
    }

    fn append_to_view(&mut self, run: Run) {
        let Run { starts, fragments } = run;
        self.len += fragments.len() as u64;
        if self.starts.is_empty() {
            self.starts = starts;
            self.fragments = fragments;
        } else {
            let before = self.fragments.len() as u32;
            self.starts
                .extend(starts.iter().map(|start| before + start));
            self.fragments.extend_from_slice(&fragments);
        }
        if self.starts.len() == self.pixels_per_view {
            self.starts.push(self.fragments.len() as u32);
            self.views.push(ViewFragments::from_lists(
                std::mem::take(&mut self.starts),
                std::mem::take(&mut self.fragments),
            ));
        }
    }
}

/// The lists of pixels of one view that follow each other.
struct Run {
    /// Where each pixel's list begins among the fragments of the run.
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Run {
    /// Of each list `kept` fragments, or all. `starts` count from anywhere.
    fn new(starts: &[u32], kept: Option<&[u32]>, lists: &[Fragment]) -> Self {
        // One more, for the end of the view's last list.
        let mut own = Vec::with_capacity(starts.len() + 1);
        let from_first = starts.iter().map(|start| start - starts[0]);
        let Some(kept) = kept else {
            own.extend(from_first);
            return Self {
                starts: own,
                // New memory is what takes the time of a copy: each core gets a part of it.
                fragments: lists.par_iter().with_min_len(LEAST_COPY).copied().collect(),
            };
        };
        let mut fragments = Vec::with_capacity(lists.len());
        for (start, kept) in from_first.zip(kept) {
            own.push(fragments.len() as u32);
            fragments.extend_from_slice(&lists[start as usize..][..*kept as usize]);
        }
        Self {
            starts: own,
            fragments,
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
