//! Tubes that grow on each other.

use glam::{DVec2, DVec3};
use secateur_model::{BoundingSphere, LeafTriangle, Place};

use super::*;

/// A tube of eight sides from one point to another.
pub(super) fn tube(from: DVec3, to: DVec3, radius: f64, rings: usize) -> Vec<LeafTriangle> {
    const SIDES: usize = 8;
    let along = (to - from).normalize();
    let across = along.any_orthonormal_vector();
    let beside = along.cross(across);
    let at = |ring: usize, side: usize| {
        let angle = std::f64::consts::TAU * side as f64 / SIDES as f64;
        let share = ring as f64 / rings as f64;
        let place = from.lerp(to, share) + radius * (angle.cos() * across + angle.sin() * beside);
        // Whole sides and rings: corners of two triangles are the same vertex to the last bit.
        (place, DVec2::new(side as f64 / SIDES as f64, share))
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let [a, b, c, d] = [
                (ring, side),
                (ring, next),
                (ring + 1, next),
                (ring + 1, side),
            ]
            .map(|(ring, side)| at(ring, side));
            for t in [[a, b, c], [a, c, d]] {
                triangles.push(LeafTriangle {
                    corners: t.map(|corner| corner.0),
                    uvs: t.map(|corner| corner.1),
                });
            }
        }
    }
    triangles
}

/// A trunk, a bough on it, and a twig on the bough.
pub(super) fn wood() -> Foliage {
    let mut wood = Foliage::default();
    let bough_tip = DVec3::new(3.0, 5.0, 0.0);
    let pieces = [
        tube(bough_tip, bough_tip + DVec3::new(1.0, 0.5, 0.0), 0.02, 4),
        tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12),
        tube(DVec3::new(0.3, 4.0, 0.0), bough_tip, 0.1, 8),
    ];
    for piece in pieces {
        wood.push_leaf(&piece, None).unwrap();
    }
    wood
}

/// The wood as few views of few pixels judge its levels.
pub(super) fn by_geometry(foliage: &Foliage, seen_px: &[f64]) -> Wood {
    let sphere = foliage.bounding_sphere().unwrap_or(BoundingSphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    });
    let views = ViewSet::dodecahedron(sphere);
    Wood::by_geometry(Parts::of(foliage), seen_px, &views, 128)
}

#[test]
fn twigs_grow_on_boughs_and_boughs_on_trunks() {
    assert_eq!(supports(&wood()), [Some(2), None, Some(1)]);
}

#[test]
fn a_budget_is_kept_and_nothing_hangs_in_the_air() {
    let foliage = wood();
    let wood = by_geometry(&foliage, &[50.0, 1000.0, 300.0]);
    let all = foliage.triangles().len();
    let mut lost_before = f64::INFINITY;
    for budget in 0..=all {
        let (lod, lost) = wood.within(budget);
        let left = lod.foliage(&foliage);
        assert!(left.triangles().len() <= budget, "{budget}");
        assert!(
            lost <= lost_before + 1e-9,
            "{budget}: {lost} after {lost_before}"
        );
        lost_before = lost;
        let is_left = |piece: usize| {
            let name = LeafId::from_index(piece);
            lod.leaves().any(|(leaf, _)| leaf == name)
                || lod.made().any(|(made, _)| made.donor == name)
        };
        assert!(
            !is_left(0) || is_left(2),
            "a twig without its bough at {budget}"
        );
        assert!(
            !is_left(2) || is_left(1),
            "a bough without its trunk at {budget}"
        );
    }
    assert_eq!(lost_before, 0.0);
    // A tenth of the triangles shows most of the pixels.
    assert!(
        wood.within(all / 10).1 < 0.4 * 1350.0,
        "{}",
        wood.within(all / 10).1
    );
}

/// A twig that shows the most, on a bough and a trunk that hardly show.
#[test]
fn what_shows_most_waits_for_what_it_grows_on() {
    let foliage = wood();
    let wood = by_geometry(&foliage, &[1000.0, 5.0, 20.0]);
    for budget in 0..=foliage.triangles().len() {
        let (lod, _) = wood.within(budget);
        let is_left = |piece: usize| {
            let name = LeafId::from_index(piece);
            lod.leaves().any(|(leaf, _)| leaf == name)
                || lod.made().any(|(made, _)| made.donor == name)
        };
        assert!(
            !is_left(0) || is_left(2),
            "a twig without its bough at {budget}"
        );
        assert!(
            !is_left(2) || is_left(1),
            "a bough without its trunk at {budget}"
        );
    }
}

/// A trunk that is bent at a right angle with a twig at the bend: what leaves the bend out is too far
/// from the twig.
#[test]
fn a_twig_waits_for_a_level_that_meets_it() {
    let mut trunk = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.2, 8);
    let bend = |corner: DVec3| match corner.y > 4.0 {
        true => DVec3::new(corner.x + corner.y - 4.0, 4.0 - corner.x, corner.z),
        false => corner,
    };
    for triangle in &mut trunk {
        triangle.corners = triangle.corners.map(bend);
    }
    let mut foliage = Foliage::default();
    foliage.push_leaf(&trunk, None).unwrap();
    let from = DVec3::new(-0.1, 4.0, 0.0);
    let twig = tube(from, from + DVec3::new(-1.0, 1.0, 0.0), 0.02, 4);
    foliage.push_leaf(&twig, None).unwrap();
    let gap_of = |left: &Foliage| wood_gaps(left).into_iter().fold(0.0, f64::max);
    let thickness = thickness::thickness(&foliage, LeafId::from_index(0));
    // The trunk shows nothing: it gets the fewest triangles that will do.
    let wood = by_geometry(&foliage, &[0.0, 1000.0]);
    let mut coarsest = usize::MAX;
    for budget in 0..=foliage.triangles().len() {
        let left = wood.within(budget).0.foliage(&foliage);
        assert!(gap_of(&left) <= thickness, "{} at {budget}", gap_of(&left));
        coarsest = coarsest.min(match left.leaves().len() {
            2 => left.triangles().len(),
            _ => usize::MAX,
        });
    }
    // Two strips, that of the trunk with a ring between its ends.
    assert!(coarsest <= 8, "{coarsest}");
}

/// The twig shows next to nothing, but twenty leaves hang on it.
#[test]
fn a_twig_is_worth_the_leaves_that_it_bears() {
    let foliage = wood();
    let mut leaves = Foliage::default();
    for k in 0..20 {
        let at = DVec3::new(3.2 + 0.04 * f64::from(k), 5.1 + 0.02 * f64::from(k), 0.0);
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Z].map(|c| at + 0.2 * c);
        leaves
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
    }
    let bare = by_geometry(&foliage, &[0.001, 1000.0, 300.0]);
    let leafy = bare.clone().with_leaves(&leaves, &[1.0; 20]);
    let bound = leafy.leaf_gap();
    assert!(bare.leaf_gap().is_infinite() && bound < 0.2);
    let hanging = |(left, _): (Lod, f64)| hanging_on(&leaves, &left.foliage(&foliage), bound);
    // Not as what carries the crown.
    let budget = WoodBudget {
        triangles: 40,
        standing: 0,
        first: 0,
    };
    let bare = hanging(leafy.bearing(&[], budget));
    assert!(bare.iter().any(Option::is_some));
    let borne = hanging(leafy.bearing(&[100.0; 20], budget));
    assert_eq!(borne, [None; 20]);
}

#[test]
fn what_stays_is_made_of_corners_that_were_there_but_for_thin_parts() {
    let foliage = wood();
    let wood = by_geometry(&foliage, &[1.0, 1.0, 1.0]);
    let twig = LeafId::from_index(0);
    let mut moved = 0;
    let lods: Vec<Lod> = (20..200)
        .step_by(10)
        .map(|budget| wood.within(budget).0)
        .collect();
    for (made, area_scale) in lods.iter().flat_map(Lod::made) {
        assert_eq!(area_scale, 1.0);
        for corner in made.triangles.iter().flatten() {
            match corner.place {
                Place::Of(at) => assert_eq!((at.leaf, at.corner), (made.donor, corner.like)),
                Place::At(_) => moved += u32::from(made.donor == twig),
                Place::InPlaneOf { .. } => panic!("{corner:?}"),
            }
            let is_own = matches!(corner.place, Place::Of(_));
            assert!(is_own || made.donor == twig, "{corner:?}");
        }
    }
    assert!(moved > 0);
    // Levels along an order share the vertices that were there.
    let order = wood.order();
    let mut corners = order
        .made()
        .iter()
        .flat_map(|made| made.triangles.as_flattened());
    assert!(corners.all(|corner| matches!(corner.place, Place::Of(_))));
}

#[test]
fn no_wood_is_no_wood() {
    let (lod, lost) = by_geometry(&Foliage::default(), &[]).within(0);
    assert_eq!((lod.leaf_count(), lost), (0, 0.0));
}

#[test]
fn an_order_takes_pieces_away_before_what_they_grow_on() {
    let foliage = wood();
    let order = by_geometry(&foliage, &[50.0, 1000.0, 300.0]).order();
    order.check(&foliage).unwrap();
    let left = |steps: usize| Lod::after(&order, steps).foliage(&foliage);
    assert_eq!(left(0), foliage);
    assert_eq!(left(order.len()).leaves().len(), 0);
    // Some steps put a coarser piece in the place of one.
    assert!(order.len() > 3 && !order.made().is_empty());
    for steps in 0..order.len() {
        let [now, next] = [steps, steps + 1].map(|k| left(k).triangles().len());
        assert!(next < now, "{now} triangles, then {next}");
        let lod = Lod::after(&order, steps);
        let is_left = |piece: usize| {
            let name = LeafId::from_index(piece);
            lod.leaves().any(|(leaf, _)| leaf == name)
                || lod.made().any(|(made, _)| made.donor == name)
        };
        assert!(!is_left(0) || is_left(2), "a twig without its bough");
        assert!(!is_left(2) || is_left(1), "a bough without its trunk");
    }
}

/// A leaf on the trunk, one on it, and one that is far from both.
#[test]
fn a_leaf_rests_on_wood_or_on_a_lower_leaf() {
    let mut leaves = Foliage::default();
    for (x, y) in [(0.5, 4.0), (1.5, 4.2), (7.0, 4.4), (1.5, 3.0)] {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X - 0.1 * DVec3::Y];
        let triangle = LeafTriangle::plain(corners.map(|c| c + DVec3::new(x, y, 0.0)));
        leaves.push_leaf(&[triangle], None).unwrap();
    }
    let mut trunk = Foliage::default();
    trunk
        .push_leaf(&tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12), None)
        .unwrap();
    let gaps = leaf_gaps(&leaves, &trunk);
    assert!(gaps[0] < 0.15, "{gaps:?}");
    assert!((0.1..0.3).contains(&gaps[1]), "{gaps:?}");
    assert!((4.5..5.0).contains(&gaps[2]), "{gaps:?}");
    // What is above does not bear it.
    assert!((1.0..1.2).contains(&gaps[3]), "{gaps:?}");
}

/// Leaves one above the other beside a trunk: the lowest is at it, or is not.
#[test]
fn leaves_rest_on_wood_through_lower_leaves() {
    let mut leaves = Foliage::default();
    for (x, y) in [
        (0.5, 4.0),
        (1.6, 4.2),
        (2.7, 4.4),
        (5.5, 4.0),
        (6.6, 4.2),
        (6.7, 3.0),
    ] {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X - 0.1 * DVec3::Y];
        let triangle = LeafTriangle::plain(corners.map(|c| c + DVec3::new(x, y, 0.0)));
        leaves.push_leaf(&[triangle], None).unwrap();
    }
    let mut trunk = Foliage::default();
    trunk
        .push_leaf(&tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12), None)
        .unwrap();
    // The fifth rests on the fourth, which rests on nothing; the last is too far from all.
    let lowest = hanging_on(&leaves, &trunk, 0.4);
    assert_eq!(lowest, [None, None, None, Some(3), Some(3), Some(5)]);
    assert_eq!(
        hanging_on(&leaves, &Foliage::default(), 0.4)[..3],
        [Some(0); 3]
    );
}

#[test]
fn places_of_two_pieces_stay() {
    let mut foliage = Foliage::default();
    let (a, b, c) = (DVec3::ZERO, 2.0 * DVec3::Y, 4.0 * DVec3::Y);
    foliage.push_leaf(&tube(a, b, 0.3, 4), None).unwrap();
    foliage.push_leaf(&tube(b, c, 0.3, 4), None).unwrap();
    let is_joint = joints(&Parts::of(&foliage));
    let corners = foliage.triangles().iter().flat_map(|t| t.corners);
    let shared: Vec<DVec3> = corners.filter(|corner| is_joint(*corner)).collect();
    assert!(!shared.is_empty() && shared.iter().all(|corner| corner.y == 2.0));
    let wood = by_geometry(&foliage, &[1.0, 1.0]);
    let coarsest = wood.pieces[0].levels.last().unwrap();
    let triangles = foliage.triangles_of(LeafId::from_index(0));
    let place = |c: &u32| triangles[*c as usize / 3].corners[*c as usize % 3];
    let left: Vec<DVec3> = coarsest
        .triangles
        .as_flattened()
        .iter()
        .map(place)
        .collect();
    let is_kept = |corner: &DVec3| left.contains(corner);
    let of_first = triangles.iter().flat_map(|t| t.corners);
    let mut of_first = of_first.filter(|corner| is_joint(*corner));
    assert!(of_first.all(|corner| is_kept(&corner)));
}

/// A bough of 60 triangles is offered at ever fewer, down to a tube of three sides and less, so that it need
/// not go at once: the levels of each halving lose less than half, and go from its foot to its tip.
#[test]
fn a_bough_has_levels_between_what_it_is_and_nothing() {
    let bough = |cut: bool| {
        let from = DVec3::new(0.3, 4.0, 0.0);
        let mut bough = tube(from, from + DVec3::new(3.0, 1.0, 0.0), 0.1, 4);
        for (triangle, number) in bough.iter_mut().zip(0..).filter(|_| cut) {
            for uv in &mut triangle.uvs {
                uv.x += 7.0 * f64::from(number);
            }
        }
        bough
    };
    for cut in [false, true] {
        let mut foliage = Foliage::default();
        let trunk = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 12);
        foliage.push_leaf(&trunk, None).unwrap();
        foliage.push_leaf(&bough(cut), None).unwrap();
        let wood = by_geometry(&foliage, &[1000.0, 100.0]);
        let piece = &wood.pieces[1];
        assert_eq!(piece.triangles, 64);
        for most in [32, 16, 12, 6] {
            let levels = piece.levels.iter();
            let mut offered = levels.filter(|level| level.triangles.len() <= most);
            let best = offered.next().unwrap();
            assert!(best.reaches && best.loss < 0.5, "{most}: {best:?}");
        }
    }
}
