use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::*;

const PIXELS: usize = 4;

/// Depths of a leaf at the pixels where it is.
type Depths = [Option<u32>; PIXELS];

fn any_depths() -> impl Strategy<Value = Depths> {
    prop::array::uniform4(prop::option::weighted(0.8, 0u32..100))
}

fn drawn(depths: &Depths) -> Vec<(u32, u32)> {
    let pixels = (0..).zip(depths);
    pixels.filter_map(|(p, d)| Some((p, (*d)?))).collect()
}

/// What the A-buffer must say: sorted lists.
#[derive(Clone)]
struct Lists(Vec<BTreeSet<Fragment>>);

impl Lists {
    fn put(&mut self, leaf: u32, depths: &Depths) {
        for (list, depth) in self.0.iter_mut().zip(depths) {
            list.retain(|f: &Fragment| f.leaf() != leaf);
            list.extend(depth.map(|depth| Fragment::new(depth, leaf)));
        }
    }

    fn fronts(&self) -> Vec<FrontTwo> {
        let fronts = |list: &BTreeSet<Fragment>| {
            let mut leaves = list.iter().map(|f| f.leaf());
            [0, 1].map(|_| leaves.next().unwrap_or(0))
        };
        self.0.iter().map(fronts).collect()
    }

    fn a_buffer(&self, leaf_count: usize) -> ABuffer {
        let mut starts = vec![0];
        for list in &self.0 {
            starts.push(starts[starts.len() - 1] + list.len() as u32);
        }
        let fragments = self.0.iter().flatten().copied().collect();
        let view = ViewFragments::from_lists(starts, fragments);
        ABuffer::new(vec![view], leaf_count)
    }

    fn assert_is(&self, a_buffer: &ABuffer, leaves: &[u32]) {
        assert_eq!(a_buffer.fronts().collect::<Vec<_>>(), self.fronts());
        for (pixel, list) in (0..).zip(&self.0) {
            assert_eq!(a_buffer.cover(pixel) as usize, list.len().min(2));
            for &leaf in leaves {
                let other = list.iter().find(|f| f.leaf() != leaf);
                let nothing = Fragment::new(u32::MAX, 0);
                let other = *other.unwrap_or(&nothing);
                assert_eq!(a_buffer.nearest_but(pixel, leaf), other);
            }
        }
        for &leaf in leaves {
            let has = |list: &BTreeSet<Fragment>| list.iter().any(|f| f.leaf() == leaf);
            let pixels = (0..).zip(&self.0).filter(|(_, list)| has(list));
            let pixels: Vec<u32> = pixels.map(|(pixel, _)| pixel).collect();
            assert_eq!(a_buffer.pixels_of(leaf), pixels);
        }
    }
}

proptest! {
    /// Lists of up to 60 leaves, long and short, as leaves go and change.
    #[test]
    fn lists_stay_sorted_and_changes_are_told(
        leaves in prop::collection::vec(any_depths(), 1..60),
        steps in prop::collection::vec(
            (any::<prop::sample::Index>(), prop::option::weighted(0.7, any_depths())),
            1..60,
        ),
    ) {
        let mut lists = Lists(vec![BTreeSet::new(); PIXELS]);
        for (leaf, depths) in (1..).zip(&leaves) {
            lists.put(leaf, depths);
        }
        let mut a_buffer = lists.a_buffer(leaves.len());
        let mut left: Vec<u32> = (1..=leaves.len() as u32).collect();
        lists.assert_is(&a_buffer, &left);
        for (index, depths) in steps {
            if left.is_empty() {
                break;
            }
            let before = lists.fronts();
            let at = index.index(left.len());
            let mut told = BTreeMap::new();
            let changed = |pixel: u32, before: FrontTwo, after: FrontTwo| {
                assert_eq!(told.insert(pixel as usize, (before, after)), None);
            };
            match depths {
                None => {
                    let leaf = left.swap_remove(at);
                    lists.put(leaf, &[None; PIXELS]);
                    a_buffer.remove(leaf, changed);
                }
                Some(depths) => {
                    lists.put(left[at], &depths);
                    a_buffer.replace(left[at], &drawn(&depths), changed);
                }
            }
            let pairs = before.into_iter().zip(lists.fronts()).enumerate();
            let expected = pairs.filter(|(_, (before, after))| before != after);
            prop_assert_eq!(told, expected.collect());
            lists.assert_is(&a_buffer, &left);
        }
    }

    /// Leaves go, some get other fragments for a while, one of them twice.
    #[test]
    fn what_is_tried_out_can_be_taken_back(
        leaves in prop::collection::vec(any_depths(), 3..40),
        tried in prop::collection::vec((any::<prop::sample::Index>(), any_depths()), 1..20),
    ) {
        let mut lists = Lists(vec![BTreeSet::new(); PIXELS]);
        for (leaf, depths) in (1..).zip(&leaves) {
            lists.put(leaf, depths);
        }
        let mut a_buffer = lists.a_buffer(leaves.len());
        lists.put(1, &[None; PIXELS]);
        a_buffer.remove(1, |_, _, _| ());
        let left: Vec<u32> = (2..=leaves.len() as u32).collect();
        let mut undo = Undo::default();
        let mut with = lists.clone();
        let mut fronts = lists.fronts();
        for (index, depths) in tried.iter().chain(&tried[..1]) {
            let leaf = left[index.index(left.len())];
            with.put(leaf, depths);
            a_buffer.try_out(leaf, &drawn(depths), &mut undo, |pixel, _, after| {
                fronts[pixel as usize] = after;
            });
        }
        with.assert_is(&a_buffer, &left);
        prop_assert_eq!(&fronts, &with.fronts());
        a_buffer.undo(&mut undo, |pixel, before, after| {
            assert_eq!(fronts[pixel as usize], before);
            fronts[pixel as usize] = after;
        });
        lists.assert_is(&a_buffer, &left);
        prop_assert_eq!(&fronts, &lists.fronts());
        // Nothing is left to be taken back.
        a_buffer.undo(&mut undo, |_, _, _| panic!("taken back twice"));
    }
}

/// The third of three leaves behind each other is hidden: without it pixels show the same, now and when others go.
#[test]
fn a_hidden_leaf_goes_unseen() {
    let mut lists = Lists(vec![BTreeSet::new(); PIXELS]);
    for leaf in 1..4 {
        lists.put(leaf, &[Some(10 * leaf), Some(10 * leaf), None, None]);
    }
    lists.put(2, &[Some(20), None, None, None]);
    lists.put(4, &[None; PIXELS]);
    let mut a_buffer = lists.a_buffer(4);
    // In the second pixel the third leaf is right behind the first, and the fourth is nowhere.
    let hidden = [1, 2, 3, 4].map(|leaf| a_buffer.is_hidden(leaf));
    assert_eq!(hidden, [false, false, false, true]);
    a_buffer.replace(3, &[(0, 30)], |_, _, _| {});
    assert!(a_buffer.is_hidden(3));
    a_buffer.remove_hidden(3);
    assert_eq!(a_buffer.front_two(0), [1, 2]);
    let mut told = Vec::new();
    a_buffer.remove(1, |pixel, before, after| told.push((pixel, before, after)));
    assert_eq!(told, [(0, [1, 2], [2, 0]), (1, [1, 0], [0, 0])]);
}
