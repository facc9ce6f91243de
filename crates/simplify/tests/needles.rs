//! Crowns of needles: runs in which they grow across.

use std::ops::ControlFlow;

use glam::DVec3;
use secateur_model::{CollapseIndex, Foliage, Forest, LeafTriangle, Lod, NoHeirs, Random};
use secateur_raster::OpenEngine;
use secateur_simplify::{
    Fitting, LeafTriangles, Method, Needles, Options, Resolution, Shared, Simplified, Target,
    Views, simplify, simplify_sharing,
};

const LENGTH: f64 = 0.4;

/// Quads of this length and a fiftieth of it wide, at random in a cube of side 2.
fn crown(count: usize) -> Foliage {
    let mut random = Random::new(5);
    let mut foliage = Foliage::default();
    let mut vector = || DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
    for _ in 0..count {
        let (at, along) = (vector(), vector().normalize());
        let across = along.cross(vector()).normalize() * LENGTH / 50.0;
        let along = along * LENGTH;
        let corners = [at, at + along, at + along + across, at + across];
        let triangles =
            [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle::plain(t.map(|k: usize| corners[k])));
        foliage.push_leaf(&triangles, None).unwrap();
    }
    foliage
}

fn options(share: f64, needles: Needles) -> Options {
    Options {
        views: Views::Dodecahedron,
        resolution: Resolution::Pixels(64),
        audit: true,
        needles,
        ..Options::to(Target::triangle_share(share))
    }
}

/// The longest edge of each leaf that is left.
fn lengths(foliage: &Foliage, lod: &Lod) -> Vec<f64> {
    let left = lod.foliage(foliage);
    let of_triangle = |t: &LeafTriangle| {
        let [a, b, c] = t.corners;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    let triangles = left.triangles().iter();
    triangles.map(of_triangle).collect()
}

fn area(foliage: &Foliage, result: &Simplified) -> f64 {
    let left = result.lod.foliage(foliage);
    left.leaves().iter().map(|leaf| leaf.area()).sum()
}

#[test]
fn no_needle_gets_longer_and_as_many_of_the_same_area_are_left() {
    let crown = crown(150);
    for share in [0.5, 0.3] {
        let unfitted = |needles| {
            let options = Options {
                fit: Fitting::None,
                ..options(share, needles)
            };
            simplify(&crown, &options).unwrap()
        };
        let [wide, long] = [Needles::Widen, Needles::Scale].map(unfitted);
        let most =
            |result: &Simplified| lengths(&crown, &result.lod).into_iter().fold(0.0, f64::max);
        assert!(most(&wide) < 0.92 * LENGTH, "{}", most(&wide));
        assert!(most(&long) > 1.3 * LENGTH, "{}", most(&long));
        assert!((area(&crown, &wide) / area(&crown, &long) - 1.0).abs() < 1e-9);
        assert_eq!(wide.lod.leaf_count(), long.lod.leaf_count());
        let scales = [&wide, &long].map(|result| result.passes.max_area_scale());
        assert!((scales[0] / scales[1] - 1.0).abs() < 1e-12, "{scales:?}");
        assert_eq!(scales[1], long.lod.max_area_scale());
        // Both chose the same leaves in the same order.
        assert_eq!(wide.passes.order, long.passes.order);
        assert_eq!(wide.costs, long.costs);
        wide.passes.in_one_order().check(&crown).unwrap();
        assert!(long.passes.needles.is_empty());
    }
}

#[test]
fn leaves_that_keep_their_triangles_and_other_targets_stay_as_they_are() {
    let crown = crown(60);
    let keep = Options {
        leaf_triangles: LeafTriangles::Keep,
        ..options(0.3, Needles::Widen)
    };
    let leaves = Options {
        target: Target::leaf_share(0.3),
        ..options(0.3, Needles::Widen)
    };
    let stochastic = Options {
        method: Method::Stochastic(Default::default()),
        ..options(0.3, Needles::Widen)
    };
    for options in [keep, leaves, stochastic] {
        let result = simplify(&crown, &options).unwrap();
        assert!(result.passes.needles.is_empty());
    }
}

/// All triangles may stay: no needle has grown, and nothing is done.
#[test]
fn a_crown_that_keeps_all_is_as_it_was() {
    let crown = crown(40);
    let result = simplify(&crown, &options(1.0, Needles::Widen)).unwrap();
    assert_eq!(result.lod, Lod::original(40));
}

/// In the forest each needle is a collapse of its own.
#[test]
fn each_needle_takes_the_place_of_one() {
    let crown = crown(60);
    let result = simplify(&crown, &options(0.3, Needles::Widen)).unwrap();
    let order = result.passes.in_one_order();
    let step = order
        .steps()
        .find(|step| !step.made.is_empty() && step.made.len() < 60);
    let needles = step.unwrap().made.len();
    assert_eq!(needles, result.passes.needles.len());
    let forest = Forest::new(&order, &mut NoHeirs);
    let of_one = |collapse: &CollapseIndex| forest.sources(*collapse).len() == 1;
    let collapses = (0..forest.collapse_count()).map(CollapseIndex::from_index);
    assert!(collapses.filter(of_one).count() >= 60 + needles);
}

#[test]
fn levels_that_share_what_runs_found_are_those_of_runs_of_their_own() {
    let crown = crown(80);
    let engine = OpenEngine::cpu();
    let mut shared = Shared::default();
    let mut go_on = |_| ControlFlow::Continue(());
    for share in [0.4, 0.1, 0.2, 0.5] {
        let options = options(share, Needles::Widen);
        let alone = simplify(&crown, &options).unwrap();
        let sharing =
            simplify_sharing(&engine, &crown, &options, Some(&mut shared), &mut go_on).unwrap();
        assert!(!alone.passes.needles.is_empty());
        assert_eq!(alone.lod, sharing.lod, "{share}");
    }
}
