use glam::DVec3;

use super::*;
use crate::{CornerRef, Growth, LeafTriangle, NewCorner, NewLeaf, Place, Random, Step};

fn leaf(number: usize) -> LeafId {
    LeafId::new(number as u32).unwrap()
}

fn foliage(count: u32) -> Foliage {
    let mut foliage = Foliage::default();
    for x in 0..count {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + f64::from(x));
        let triangle = LeafTriangle::plain(corners);
        foliage.push_leaf(&[triangle], None).unwrap();
    }
    foliage
}

fn made_like(donor: LeafId) -> NewLeaf {
    let corner = |corner| NewCorner {
        place: Place::Of(CornerRef {
            leaf: donor,
            corner,
        }),
        like: corner,
    };
    NewLeaf {
        donor,
        triangles: vec![[0, 1, 2].map(corner)],
    }
}

/// Steps of every kind that methods take, drawn by lot.
fn any_order(count: u32, seed: u64) -> RemovalOrder {
    let mut random = Random::new(seed);
    let mut order = RemovalOrder::new(count);
    let mut left: Vec<LeafId> = (1..=count as usize).map(leaf).collect();
    let mut names = count as usize;
    while left.len() > 2 {
        let mut lot = |end: usize| (random.bits() % end as u64) as usize;
        let (kind, size) = (lot(5), 0.5 + lot(8) as f64);
        let (mut removed, mut grown, mut made) = (Vec::new(), Vec::new(), Vec::new());
        if kind != 4 {
            removed.push(left.swap_remove(lot(left.len())));
        }
        if kind == 1 {
            removed.push(left.swap_remove(lot(left.len())));
            made.push(made_like(leaf(1 + lot(count as usize))));
        }
        if kind == 2 || kind == 4 {
            grown.extend((0..2).map(|k| Growth {
                leaf: left[lot(left.len())],
                area_scale: size + f64::from(k),
            }));
        }
        order.push_step(Step {
            removed: &removed,
            grown: &grown,
            made: &made,
            survivors_area_scale: if kind == 3 { size } else { 1.0 },
        });
        names += made.len();
        left.extend((0..made.len()).map(|k| leaf(names - k)));
    }
    order
}

#[test]
fn every_level_is_reached_from_every_other() {
    for seed in 0..20 {
        let foliage = foliage(40);
        let model = LodModel::new(any_order(40, seed), &foliage).unwrap();
        let order = model.order().clone();
        let mut level = model.finest();
        let mut random = Random::new(seed + 100);
        for _ in 0..60 {
            let steps = (random.bits() % (order.len() as u64 + 1)) as usize;
            let names = 1..=order.name_count();
            let own = |level: &UniformLevel<'_>| {
                let names = names.clone().map(leaf);
                names
                    .map(|leaf| level.own_area_scale(leaf))
                    .collect::<Vec<_>>()
            };
            let before = own(&level);
            level.go_to(steps);
            assert_eq!(level.lod(), Lod::after(&order, steps), "seed {seed}");
            assert_eq!(level.leaf_count(), level.lod().leaf_count());
            for (index, (before, after)) in before.iter().zip(own(&level)).enumerate() {
                let is_named = level.changed().contains(&LeafId::from_index(index));
                assert!(is_named || *before == after, "seed {seed}");
            }
        }
        level.uniform(40);
        assert_eq!(level.lod(), Lod::original(40), "the original, bit for bit");
    }
}

#[test]
fn levels_differ_by_a_step() {
    let model = LodModel::new(any_order(40, 3), &foliage(40)).unwrap();
    let mut level = model.finest();
    for steps in 1..=model.order().len() {
        level.go_to(steps);
        let step = model.order().step(steps - 1);
        let changes = step.removed.len() + step.grown.len() + step.made.len();
        assert_eq!(level.changed().len(), changes);
    }
}

#[test]
fn a_number_of_leaves_names_the_last_level_that_has_as_many() {
    let mut order = RemovalOrder::new(5);
    order.push(leaf(2), &[]);
    order.push(leaf(1), &[]);
    let grown = Growth {
        leaf: leaf(3),
        area_scale: 2.0,
    };
    // Sizes at the end of a run: no leaf goes.
    order.push_step(Step {
        removed: &[],
        grown: &[grown],
        made: &[],
        survivors_area_scale: 1.0,
    });
    let model = LodModel::new(order.clone(), &foliage(5)).unwrap();
    assert_eq!(
        [9, 5, 4, 3, 2, 0].map(|n| model.steps_to(n)),
        [0, 0, 1, 3, 3, 3]
    );
    assert_eq!((model.most_leaves(), model.fewest_leaves()), (5, 3));
    // A step in which several go is not stopped in.
    order.push_step(Step {
        removed: &[leaf(3), leaf(4)],
        grown: &[],
        made: &[],
        survivors_area_scale: 1.0,
    });
    let model = LodModel::new(order, &foliage(5)).unwrap();
    assert_eq!([4, 3, 2, 1].map(|n| model.steps_to(n)), [1, 3, 4, 4]);
    let empty = LodModel::new(RemovalOrder::new(5), &foliage(5)).unwrap();
    assert_eq!([5, 1].map(|n| empty.steps_to(n)), [0, 0]);
}

#[test]
fn foliage_is_known_by_its_shapes() {
    let model = |foliage: &Foliage| LodModel::new(RemovalOrder::new(3), foliage).unwrap();
    let three = foliage(3);
    assert_eq!(model(&three).foliage_sha256(), three.sha256());
    let mut moved = foliage(2);
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + 2.0 + 1e-15);
    moved
        .push_leaf(&[LeafTriangle::plain(corners)], None)
        .unwrap();
    assert_ne!(three.sha256(), moved.sha256());
    // Two leaves of a triangle are not one leaf of two.
    let triangles = three.triangles();
    let mut joined = Foliage::default();
    joined.push_leaf(&triangles[..2], None).unwrap();
    joined.push_leaf(&triangles[2..], None).unwrap();
    let mut parted = Foliage::default();
    parted.push_leaf(&triangles[..1], None).unwrap();
    parted.push_leaf(&triangles[1..], None).unwrap();
    assert_ne!(joined.sha256(), parted.sha256());
}
