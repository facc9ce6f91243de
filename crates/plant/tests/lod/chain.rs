//! Tests of the multiresolution chain: every prefix of its branches is a plant.

use glam::DVec3;
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod};
use secateur_plant::{
    Branches, Chain, GrowOptions, LeafPose, Metric, Record, Segment, SegmentIndex, Skeleton,
    Species, chain_order, grow_skeleton,
};

/// The tree of Hybrid's output chain (3), a segment of 1 m for each branch. The
/// numbers are those of the paper; branches are found in the order they are drawn.
const DRAWN: [u32; 16] = [1, 2, 3, 4, 5, 6, 7, 9, 11, 10, 8, 12, 13, 14, 15, 16];

fn example() -> Skeleton {
    let mut skeleton = Skeleton::default();
    let (mut at, mut saved) = (None, Vec::new());
    for letter in "F[F[F[F][F[F][F]]][F[F][F]][F]][F[F][F][F[F]]]".chars() {
        match letter {
            'F' => {
                let start = at.map_or(DVec3::ZERO, |p: SegmentIndex| {
                    skeleton.segments[p.index()].end
                });
                skeleton.segments.push(Segment {
                    parent: at,
                    continues_parent: false,
                    start,
                    end: start + DVec3::Y,
                    start_radius_m: 0.01,
                    end_radius_m: 0.01,
                    sides: 3,
                });
                at = Some(SegmentIndex::from_index(skeleton.segments.len() - 1));
            }
            '[' => saved.push(at),
            _ => at = saved.pop().expect("brackets match"),
        }
    }
    skeleton
}

fn by_paper_number(weights: &[f64]) -> Vec<(u32, f64)> {
    let mut named: Vec<(u32, f64)> = DRAWN.into_iter().zip(weights.iter().copied()).collect();
    named.sort_by_key(|(number, _)| *number);
    named
}

#[test]
fn the_papers_tree_has_the_papers_metrics() {
    let branches = Branches::of(&example());
    let values = |metric| -> Vec<f64> {
        let named = by_paper_number(&branches.weights(metric));
        named.into_iter().map(|(_, value)| value).collect()
    };
    // C1 .. C16, by hand from section 4.1.1 on chain (3).
    assert_eq!(
        values(Metric::BranchingLength),
        [
            16., 10., 5., 1., 3., 1., 1., 1., 3., 1., 1., 5., 1., 1., 2., 1.
        ]
    );
    assert_eq!(
        values(Metric::Children),
        [
            2., 3., 2., 0., 2., 0., 0., 0., 2., 0., 0., 3., 0., 0., 1., 0.
        ]
    );
    assert_eq!(
        values(Metric::Descendants),
        [
            15., 9., 4., 0., 2., 0., 0., 0., 2., 0., 0., 4., 0., 0., 1., 0.
        ]
    );
    assert_eq!(
        values(Metric::LongestPath),
        [
            5., 4., 3., 1., 2., 1., 1., 1., 2., 1., 1., 3., 1., 1., 2., 1.
        ]
    );
}

#[test]
fn the_papers_tree_gives_nine_paths_in_this_order() {
    let chain = Chain::of(&example(), Metric::BranchingLength);
    let name = |path: &Vec<secateur_plant::BranchIndex>| -> Vec<u32> {
        path.iter().map(|branch| DRAWN[branch.index()]).collect()
    };
    let paths: Vec<Vec<u32>> = chain.paths().iter().map(name).collect();
    // By hand from section 4.1.3. After the first path 6 m are left in C2 and 5
    // in C12, so C2 comes first again, by C9; then C12 (5) before C2 (4).
    assert_eq!(
        paths,
        [
            vec![1, 2, 3, 5, 6],
            vec![9, 11],
            vec![12, 15, 16],
            vec![4],
            vec![7],
            vec![10],
            vec![13],
            vec![8],
            vec![14],
        ]
    );
    // Each level but the first restores the state of its branch's parent.
    let restored = chain.records().iter().filter_map(|record| match record {
        Record::Restore(id) => Some(DRAWN[id.index()]),
        _ => None,
    });
    assert_eq!(restored.collect::<Vec<_>>(), [2, 1, 3, 5, 9, 12, 2, 12]);
}

fn oak() -> Skeleton {
    let options = GrowOptions {
        leaves: 600,
        seed: 4,
    };
    grow_skeleton(Species::Oak, &options).unwrap()
}

/// Every parent comes before its child, and a child starts where its parent ends.
fn assert_is_plant(skeleton: &Skeleton) {
    for (index, segment) in skeleton.segments.iter().enumerate() {
        match segment.parent {
            None => assert_eq!(index, 0, "only the trunk has no parent"),
            Some(parent) => {
                assert!(parent.index() < index);
                assert_eq!(skeleton.segments[parent.index()].end, segment.start);
            }
        }
    }
    for leaf in &skeleton.leaves {
        let segment = leaf.segment.expect("every oak leaf grows on wood");
        assert_eq!(skeleton.segments[segment.index()].end, leaf.base);
    }
}

/// All that a skeleton is made of but who bears what, in an order of its own.
fn parts(skeleton: &Skeleton) -> Vec<String> {
    let segment = |s: &Segment| {
        let places = [s.start, s.end].map(|p| p.to_array().map(f64::to_bits));
        let radii = [s.start_radius_m, s.end_radius_m].map(f64::to_bits);
        format!("{places:?} {radii:?} {} {}", s.sides, s.continues_parent)
    };
    let leaf = |leaf: &LeafPose| {
        let bare = LeafPose {
            segment: None,
            ..*leaf
        };
        format!("{bare:?}")
    };
    let segments = skeleton.segments.iter().map(segment);
    let mut all: Vec<_> = segments.chain(skeleton.leaves.iter().map(leaf)).collect();
    all.sort_unstable();
    all
}

#[test]
fn every_prefix_is_a_plant_and_the_last_is_the_whole() {
    let oak = oak();
    for metric in [
        Metric::BranchingLength,
        Metric::Children,
        Metric::Descendants,
        Metric::LongestPath,
    ] {
        let chain = Chain::of(&oak, metric);
        let mut before = 0;
        for levels in 0..=chain.levels() {
            let skeleton = chain.skeleton(levels);
            assert_is_plant(&skeleton);
            assert!(skeleton.segments.len() >= before);
            before = skeleton.segments.len();
        }
        let whole = chain.skeleton(usize::MAX);
        assert_eq!(parts(&whole), parts(&oak));
    }
}

/// A level is made of its own records, each obeyed once: two a segment, one a
/// leaf and two a fork at most.
#[test]
fn a_level_costs_what_it_holds() {
    let chain = Chain::of(&oak(), Metric::BranchingLength);
    for levels in 1..chain.levels() {
        let skeleton = chain.skeleton(levels);
        let held = 3 * skeleton.segments.len() + skeleton.leaves.len() + levels;
        assert!(chain.prefix(levels).len() <= held, "{levels}");
        assert!(chain.prefix(levels).len() < chain.records().len());
    }
}

#[test]
fn a_skeleton_without_wood_keeps_its_leaves() {
    let mut skeleton = oak();
    skeleton.segments.clear();
    skeleton.leaves.truncate(2);
    skeleton
        .leaves
        .iter_mut()
        .for_each(|leaf| leaf.segment = None);
    let chain = Chain::of(&skeleton, Metric::default());
    assert_eq!(chain.levels(), 1);
    assert_eq!(chain.skeleton(1), skeleton);
    assert_eq!(chain.skeleton(0), Skeleton::default());
}

/// The leaves that an order keeps, at the end of each level, are the level's.
#[test]
fn an_order_takes_the_levels_away_from_the_last() {
    let oak = oak();
    let chain = Chain::of(&oak, Metric::BranchingLength);
    let mut foliage = Foliage::default();
    for leaf in &oak.leaves {
        let corners = [leaf.base, leaf.base + DVec3::X, leaf.base + DVec3::Y];
        foliage
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
    }
    let mut skeleton = oak.clone().into_plant_skeleton();
    let metric = Metric::BranchingLength;
    let order = chain_order(&foliage, &skeleton, metric, 0);
    assert_eq!(order.len(), oak.leaves.len());
    // What grows on nothing is in every level: the first one has it.
    let first = order.removed()[0];
    skeleton.leaf_segments[first.index()] = None;
    let stray = chain_order(&foliage, &skeleton, metric, 0);
    assert_eq!(stray.removed().last(), Some(&first));
    skeleton = oak.clone().into_plant_skeleton();
    for levels in [1, 2, 10, chain.levels()] {
        let numbers = chain
            .prefix(levels)
            .iter()
            .filter_map(|record| match record {
                Record::Leaf(number, _) => Some(LeafId::from_index(*number as usize)),
                _ => None,
            });
        let mut drawn: Vec<LeafId> = numbers.collect();
        drawn.sort_unstable();
        let kept = Lod::after(&order, oak.leaves.len() - drawn.len());
        let kept: Vec<LeafId> = kept.leaves().map(|(leaf, _)| leaf).collect();
        assert_eq!(kept, drawn);
        let alone = chain_order(&foliage, &skeleton, metric, drawn.len());
        assert_eq!(alone.removed(), &order.removed()[..alone.len()]);
    }
}
