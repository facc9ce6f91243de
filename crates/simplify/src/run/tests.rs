//! Runs as a whole.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::DVec3;
use secateur_eval::Judging;
use secateur_model::LeafTriangle;
use secateur_raster::ViewSet;

use super::*;
use crate::{Fitting, LeafTriangles, Method, Preset, Progress, Resolution, Views};

fn leaf_at(place: DVec3, size: f64) -> Foliage {
    let mut foliage = Foliage::default();
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| place + size * p);
    foliage
        .push_leaf(&[LeafTriangle::plain(corners)], None)
        .unwrap();
    foliage
}

#[test]
fn what_no_camera_can_be_put_around_is_refused() {
    assert!(sphere_of(&leaf_at(DVec3::ZERO, 1.0)).is_ok());
    // A leaf that is a point is looked at as if it were of size 1.
    assert!(sphere_of(&leaf_at(DVec3::ONE, 0.0)).is_ok());
    for foliage in [
        leaf_at(DVec3::ZERO, 1e200),
        leaf_at(DVec3::ZERO, 1e-100),
        leaf_at(DVec3::splat(1e9), 1.0),
    ] {
        let error = sphere_of(&foliage).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }));
    }
    let empty = sphere_of(&Foliage::default()).unwrap_err();
    assert!(matches!(empty, Error::NoLeaf));
}

#[test]
fn many_views_are_no_reason_to_leave_the_range() {
    let foliage = leaf_at(DVec3::ZERO, 1.0);
    let one = ViewSet::octahedron(foliage.bounding_sphere().unwrap()).views()[0];
    // 513 views of 1024 x 1024 pixels are more than 2^29 pixels.
    let sphere = sphere_of(&foliage).unwrap();
    let options = Options {
        views: Views::Cameras(ViewSet::new(vec![one; 513])),
        ..Options::with_preset(Preset::Information, Target::leaves(1))
    };
    let chosen = resolution_for(&foliage, &options, sphere, &OpenEngine::cpu(), None).unwrap();
    assert_eq!(chosen.0, 256);
}

#[test]
fn a_run_can_be_broken_off_at_a_stage_and_at_a_step() {
    let mut foliage = leaf_at(DVec3::ZERO, 1.0);
    for x in 1..4 {
        let other = leaf_at(DVec3::X * f64::from(x), 1.0);
        foliage.push_leaf(other.triangles(), None).unwrap();
    }
    let settings = Options {
        resolution: Resolution::Pixels(32),
        ..Options::to(Target::leaves(1))
    };
    let at = |last: Progress| {
        let mut seen = Vec::new();
        let result = simplify_on(&OpenEngine::cpu(), &foliage, &settings, &mut |progress| {
            seen.push(progress);
            match progress == last {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        assert!(matches!(result, Err(Error::Stopped)));
        seen.len()
    };
    assert_eq!(at(Progress::Stage(Stage::Resolution)), 1);
    assert_eq!(
        at(Progress::Step {
            done: 2,
            at_most: 3
        }),
        4
    );
}

/// Upright leaves side by side, of 1 and of 3 triangles in turn, the latter small
/// and so the first to go.
fn uneven(leaves: usize) -> Foliage {
    let mut foliage = Foliage::default();
    for k in 0..leaves {
        let at = DVec3::new(k as f64, 0.1 * (k * k % 7) as f64, 0.2 * (k % 3) as f64);
        let fan = |t: usize| {
            let size = if k % 2 == 0 { 1.0 } else { 0.25 };
            let corner = |t: usize| size * DVec3::new(0.5, 0.4 * t as f64, 0.0);
            LeafTriangle::plain([DVec3::ZERO, corner(t), corner(t + 1)].map(|p| at + p))
        };
        let triangles: Vec<LeafTriangle> = (0..1 + 2 * (k % 2)).map(fan).collect();
        foliage.push_leaf(&triangles, None).unwrap();
    }
    foliage
}

fn to(foliage: &Foliage, triangles: u64, leaf_triangles: LeafTriangles) -> Simplified {
    let settings = Options {
        resolution: Resolution::Pixels(64),
        leaf_triangles,
        audit: true,
        ..Options::to(Target::triangles(triangles))
    };
    simplify(foliage, &settings).unwrap()
}

fn is_fit_tried(foliage: &Foliage, triangles: u64, fit: Fitting) -> bool {
    let settings = Options {
        fit,
        ..Options::with_preset(Preset::Information, Target::triangles(triangles))
    };
    let result = simplify(foliage, &settings);
    let seconds = result.unwrap().seconds;
    seconds.iter().any(|(stage, _)| *stage == Stage::Fit)
}

#[test]
fn leaves_of_many_and_few_triangles_end_at_the_first_level_within_the_budget() {
    let foliage = uneven(12);
    assert_eq!(foliage.triangles().len(), 24);
    for triangles in 0..=24 {
        let result = to(&foliage, triangles, LeafTriangles::Keep);
        let left = |steps| {
            let lod = secateur_model::Lod::after(&result.passes.in_one_order(), steps);
            lod.foliage(&foliage).triangles().len() as u64
        };
        let steps = result.passes.order.len();
        assert!(left(steps) <= triangles);
        assert!(steps == 0 || left(steps - 1) > triangles, "{triangles}");
        assert_eq!(
            result.lod.foliage(&foliage).triangles().len() as u64,
            left(steps)
        );
        assert_eq!(result.costs.len(), steps);
        assert_eq!(result.stopped, Stopped::AtTriangles);
    }
}

/// VDS went on to fewer views before the order was cut.
#[test]
fn what_is_left_is_looked_at_from_the_views_of_its_last_step() {
    let foliage = uneven(12);
    let settings = Options {
        resolution: Resolution::Pixels(64),
        leaf_triangles: LeafTriangles::Keep,
        views: crate::Views::Variable,
        audit: true,
        ..Options::to(Target::triangles(18))
    };
    let result = simplify(&foliage, &settings).unwrap();
    let pruned_percent = 100 * result.passes.order.len() / 12;
    let expected = [(10, 20), (30, 12), (50, 8), (100, 6)];
    let (_, views) = expected
        .into_iter()
        .find(|(most, _)| pruned_percent <= *most)
        .unwrap();
    assert_eq!(result.views.len(), views, "{pruned_percent} % are gone");
    assert!(Target::triangles(18).fewest_leaves(&foliage) < result.lod.leaf_count());
}

#[test]
fn coarser_leaves_are_no_removal() {
    let foliage = uneven(12);
    let coarser = to(&foliage, 14, LeafTriangles::Auto);
    let removals = |result: &Simplified| result.passes.order.len();
    assert!(coarser.passes.coarse.is_some());
    assert_eq!((removals(&coarser), coarser.lod.leaf_count()), (0, 12));
    assert!(coarser.costs.is_empty());
    // Coarser leaves without a texture do not show all that they did.
    let is_tried = |triangles| is_fit_tried(&foliage, triangles, Fitting::Auto);
    assert!(is_tried(14) && !is_tried(24));
    let fewer = to(&foliage, 5, LeafTriangles::Auto);
    assert_eq!((removals(&fewer), fewer.lod.leaf_count()), (7, 5));
    assert_eq!(fewer.costs.len(), 7);
    assert!(fewer.costs[6].0 > 0);
    // Every prefix is a LOD, of coarser leaves.
    assert_eq!(fewer.passes.lod_after(0).leaf_count(), 12);
    assert_eq!(fewer.passes.lod_after(7).leaf_count(), 5);
    assert_eq!(
        fewer.passes.in_one_order().len(),
        8 + usize::from(fewer.passes.sizes.is_some())
    );
}

/// Cards whose textures are empty at their borders: half of the triangles show all of
/// them, each at its place, as it was.
#[test]
fn all_cards_stay_where_every_one_may_keep_a_triangle() {
    use std::sync::Arc;

    use glam::DVec2;
    use secateur_model::{Cutout, Wrap};

    let middle = |x: u32| (8..24).contains(&x);
    let mask = Cutout::from_fn([32, 32], [Wrap::ClampToEdge; 2], |x, y| {
        middle(x) && middle(y)
    });
    let mut foliage = Foliage::new(vec![Arc::new(mask)]);
    for k in 0..9 {
        let at = DVec3::new((k % 3) as f64, (k / 3) as f64, 0.1 * k as f64);
        let corner = |(u, v): (f64, f64)| (at + DVec3::new(u, v, 0.2 * u), DVec2::new(u, v));
        let triangle = |corners: [(f64, f64); 3]| LeafTriangle {
            corners: corners.map(|c| corner(c).0),
            uvs: corners.map(|c| corner(c).1),
        };
        let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let card = [triangle([a, b, c]), triangle([a, c, d])];
        foliage.push_leaf(&card, Some(0)).unwrap();
    }
    let result = to(&foliage, 9, LeafTriangles::Auto);
    assert_eq!(result.lod.leaf_count(), 9);
    assert_eq!(result.lod.foliage(&foliage).triangles().len(), 9);
    let judging = Judging::held_out(&foliage).unwrap();
    let left = result.lod.foliage(&foliage);
    let measured = secateur_eval::measure(&foliage, &left, &judging).unwrap();
    assert!(
        measured.silhouette_iou() > 0.99,
        "{}",
        measured.silhouette_iou()
    );
    assert!(measured.vmi_error_percent() < 0.5);

    // There is nothing to fit where all is shown, unless one insists. The borders of one
    // triangle are drawn otherwise than those of two: in nine leaves that shows.
    let auto = [9, 18, 8].map(|count| is_fit_tried(&foliage, count, Fitting::Auto));
    assert_eq!(auto, [true, false, true]);
    assert!(is_fit_tried(&foliage, 18, Fitting::Weight(1.0)));

    let fewer = to(&foliage, 5, LeafTriangles::Auto);
    assert_eq!(fewer.lod.leaf_count(), 5);
    let kept = to(&foliage, 9, LeafTriangles::Keep);
    assert_eq!(kept.lod.leaf_count(), 4);
}

/// A crown with a wall through its middle.
fn crown_and_wall() -> (Foliage, Foliage) {
    use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
    let crown = ellipsoid_crown(24, 5, &EllipsoidCrown::default()).unwrap();
    let sphere = crown.bounding_sphere().unwrap();
    let corner = |x: f64, y: f64| sphere.centre + sphere.radius * DVec3::new(x, y, 0.1);
    let [a, b, c, d] = [
        corner(-0.8, -0.8),
        corner(0.8, -0.8),
        corner(0.8, 0.8),
        corner(-0.8, 0.8),
    ];
    let mut wall = Foliage::default();
    for triangle in [[a, b, c], [a, c, d]] {
        wall.push_leaf(&[LeafTriangle::plain(triangle)], None)
            .unwrap();
    }
    (crown, wall)
}

/// The engine that edits lists chooses among what hides leaves as drawing everything anew does, in
/// the views of all its phases.
#[test]
fn among_occluders_the_fast_engine_is_the_literal_algorithm() {
    let (crown, wall) = crown_and_wall();
    for preset in [Preset::Look, Preset::Information] {
        for views in [Views::Cube, Views::Variable] {
            for target in [Target::leaves(6), Target::MaxErrorPercent(8.0)] {
                let vds = preset.vds();
                let run = |method: Method, occluders: Option<&Foliage>| {
                    let options = Options {
                        method,
                        views: views.clone(),
                        resolution: Resolution::Pixels(48),
                        occluders: occluders.map(|o| Arc::new(o.clone())),
                        audit: true,
                        ..Options::with_preset(preset, target)
                    };
                    simplify(&crown, &options).unwrap()
                };
                let fast = run(Method::Vds(vds), Some(&wall));
                let literal = run(Method::VdsReference(vds), Some(&wall));
                assert_eq!(fast.passes.order.sha256(), literal.passes.order.sha256());
                assert_eq!(fast.costs, literal.costs);
                assert_eq!(fast.areas, literal.areas);
                assert_eq!(fast.vmi_original, literal.vmi_original);
                assert_eq!(fast.passes.sizes, literal.passes.sizes);
                let bare = run(Method::Vds(vds), None);
                assert_ne!(fast.vmi_original, bare.vmi_original);
                let nothing = run(Method::Vds(vds), Some(&Foliage::default()));
                assert_eq!(nothing.areas, bare.areas);
            }
        }
    }
}

/// What is hidden from all sides goes first, and costs nothing.
#[test]
fn what_occluders_hide_goes_first() {
    let mut foliage = Foliage::default();
    let square = |at: DVec3, side: f64| {
        let [a, b, c, d] = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
            .map(|(x, y)| at + side * DVec3::new(x, y, 0.0));
        [[a, b, c], [a, c, d]].map(LeafTriangle::plain)
    };
    // The second is between two walls.
    for z in [1.0, 0.0, -1.0] {
        let leaf = square(DVec3::Z * z, 0.3);
        foliage.push_leaf(&leaf, None).unwrap();
    }
    let mut walls = Foliage::default();
    for z in [0.01, -0.01] {
        let wall = square(DVec3::Z * z, 0.8);
        walls.push_leaf(&wall, None).unwrap();
    }
    let options = Options {
        resolution: Resolution::Pixels(64),
        views: Views::Dodecahedron,
        occluders: Some(Arc::new(walls)),
        ..Options::to(Target::leaves(2))
    };
    let result = simplify(&foliage, &options).unwrap();
    let first = result.passes.order.steps().next().unwrap();
    assert_eq!(first.removed, [secateur_model::LeafId::from_index(1)]);
    assert!(first.grown.is_empty());
    assert_eq!(result.costs[0], ScaledBits(0));
}

/// Levels that go on from each other, in any order, are those of runs of their own.
#[test]
fn runs_that_share_what_they_found_are_the_same() {
    let (crown, wall) = crown_and_wall();
    for (preset, views) in [
        (Preset::Look, Views::Cube),
        (Preset::Information, Views::Variable),
    ] {
        for occluders in [None, Some(Arc::new(wall.clone()))] {
            let mut shared = crate::Shared::default();
            let engine = OpenEngine::cpu();
            // Leaves are cards of two triangles: below half of them all become single ones.
            for triangles in [40, 20, 6, 14, 9, 2, 40, 0] {
                let options = Options {
                    views: views.clone(),
                    resolution: Resolution::Pixels(48),
                    occluders: occluders.clone(),
                    ..Options::with_preset(preset, Target::triangles(triangles))
                };
                let mut go_on = |_| ControlFlow::Continue(());
                let alone = simplify(&crown, &options).unwrap();
                let sharing =
                    simplify_sharing(&engine, &crown, &options, Some(&mut shared), &mut go_on)
                        .unwrap();
                assert_eq!(
                    alone.passes.in_one_order().sha256(),
                    sharing.passes.in_one_order().sha256(),
                    "{triangles}"
                );
                assert_eq!(alone.lod, sharing.lod, "{triangles}");
                assert_eq!(alone.costs, sharing.costs, "{triangles}");
                assert_eq!(alone.areas, sharing.areas, "{triangles}");
                assert_eq!(alone.vmi_original, sharing.vmi_original);
                // What a method drew itself is handed on; of coarser leaves than it chose from it drew none.
                if preset == Preset::Look && triangles == 6 {
                    let unseen = Options {
                        shows_what_is_left: false,
                        audit: false,
                        ..options
                    };
                    let unseen = simplify(&crown, &unseen).unwrap();
                    assert_eq!(alone.lod, unseen.lod);
                    assert_eq!((unseen.areas, unseen.vmi_final), (None, None));
                }
            }
        }
    }
}

/// Whoever asks for an error has what is left looked at.
#[test]
fn an_error_is_looked_at_whether_it_is_to_be_shown_or_not() {
    let (crown, _) = crown_and_wall();
    let options = Options {
        views: Views::Cube,
        resolution: Resolution::Pixels(48),
        audit: false,
        shows_what_is_left: false,
        ..Options::with_preset(Preset::Information, Target::MaxErrorPercent(5.0))
    };
    let found = simplify(&crown, &options).unwrap();
    assert!(found.driving_error_percent().unwrap() <= 5.0);
}

/// Leaves of a thousandth of the crown: far below a pixel at 256.
#[test]
fn small_leaves_get_more_pixels_for_information_and_not_for_the_look() {
    let mut foliage = Foliage::default();
    for k in 0..200u32 {
        let place = DVec3::new(f64::from(k % 6), f64::from(k / 6 % 6), f64::from(k / 36)) / 6.0;
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| place + 0.004 * p);
        let triangle = [LeafTriangle::plain(corners)];
        foliage.push_leaf(&triangle, None).unwrap();
    }
    let resolution = |preset| {
        let options = Options {
            fit: Fitting::None,
            audit: false,
            ..Options::with_preset(preset, Target::leaves(199))
        };
        simplify(&foliage, &options).unwrap().resolution
    };
    assert_eq!(resolution(Preset::Look), 256);
    assert!(resolution(Preset::Information) > 256);
}

/// An opaque quad about its middle, of these two sides.
fn quad(middle: DVec3, [across, up]: [DVec3; 2]) -> [LeafTriangle; 2] {
    let corner = |x: f64, y: f64| middle + x * across + y * up;
    let [a, b, c, d] = [
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(0.5, 0.5),
        corner(-0.5, 0.5),
    ];
    [
        LeafTriangle::plain([a, b, c]),
        LeafTriangle::plain([a, c, d]),
    ]
}

/// A closed box of six quads around six others: what is hidden goes before what is seen gets coarser.
#[test]
fn seen_quads_stay_whole_while_hidden_ones_can_go() {
    let mut foliage = Foliage::default();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for size in [2.0, 0.5] {
        for axis in 0..3 {
            let sides = [size * axes[(axis + 1) % 3], size * axes[(axis + 2) % 3]];
            for side in [-0.5, 0.5] {
                let middle = side * size * axes[axis];
                foliage.push_leaf(&quad(middle, sides), None).unwrap();
            }
        }
    }
    let result = to(&foliage, 14, LeafTriangles::Auto);
    let seen = result.lod.leaves().filter(|(leaf, _)| leaf.index() < 6);
    assert_eq!(seen.count(), 6, "the box is made of the leaves that it had");
    assert!(result.lod.foliage(&foliage).triangles().len() <= 14);
}
