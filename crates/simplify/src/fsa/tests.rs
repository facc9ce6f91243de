use glam::{DVec2, DVec3};
use proptest::prelude::*;
use secateur_model::{LeafId, LeafTriangle, Lod, Place};

use super::*;

const UVS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// A textured quadrilateral, its corners in turn.
fn quad(corners: [DVec3; 4]) -> [LeafTriangle; 2] {
    [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle {
        corners: t.map(|k: usize| corners[k]),
        uvs: t.map(|k| DVec2::from(UVS[k])),
    })
}

fn unit_square(at: DVec3) -> [LeafTriangle; 2] {
    quad([DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y].map(|p| at + p))
}

fn foliage(leaves: &[[LeafTriangle; 2]]) -> Foliage {
    let mut foliage = Foliage::default();
    for leaf in leaves {
        foliage.push_leaf(leaf, None).unwrap();
    }
    foliage
}

fn run(foliage: &Foliage, leaves: usize, options: &FsaOptions) -> RemovalOrder {
    simplify(foliage, leaves, options, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Every pair looked at for every step.
fn by_all_pairs(foliage: &Foliage, leaves: usize, options: &FsaOptions) -> RemovalOrder {
    let cost = Cost::new(foliage, options);
    let count = foliage.leaves().len();
    let mut active: Vec<Option<ActiveLeaf>> = (0..count)
        .map(|k| {
            let leaf = LeafId::from_index(k);
            Some(ActiveLeaf::original(foliage, leaf, options.hausdorff))
        })
        .collect();
    let mut order = RemovalOrder::new(count as u32);
    while count - order.len() > leaves.max(1) {
        let left: Vec<usize> = (0..active.len()).filter(|k| active[*k].is_some()).collect();
        let mut best = (f64::INFINITY, 0, 0);
        for (i, &a) in left.iter().enumerate() {
            for &b in &left[i + 1..] {
                let c = cost.of(active[a].as_ref().unwrap(), active[b].as_ref().unwrap());
                if c < best.0 {
                    best = (c, a, b);
                }
            }
        }
        let [a, b] = [best.1, best.2].map(|k| active[k].take().unwrap());
        let new = ActiveLeaf::collapse(&a, &b, options.corners, options.hausdorff);
        order.push_step(Step {
            removed: &[best.1, best.2].map(LeafId::from_index),
            grown: &[],
            made: &[new.new_leaf()],
            survivors_area_scale: 1.0,
        });
        active.push(Some(new));
    }
    order
}

/// Squares at x = 0 to 1 and 3 to 4, and a third far away. The first two have
/// the Hausdorff distance 3 (the corners at x = 0 from those at x = 3) and one
/// plane. What they leave behind is the rectangle from x = 0 to 4: the corners
/// at x = 0 and at x = 4 are furthest from the other leaf. It shows the whole
/// texture once.
#[test]
fn two_squares_become_the_rectangle_around_them() {
    let far = DVec3::new(0.0, 50.0, 0.0);
    let foliage = foliage(&[
        unit_square(DVec3::ZERO),
        unit_square(far),
        unit_square(3.0 * DVec3::X),
    ]);
    let order = run(&foliage, 2, &FsaOptions::default());
    let step = order.steps().next().unwrap();
    assert_eq!(
        step.removed.iter().map(|l| l.get()).collect::<Vec<_>>(),
        [1, 3]
    );
    let made = step.made[0].triangles_in(&foliage, 1.0);
    let mut corners: Vec<([f64; 3], [f64; 2])> = made
        .iter()
        .flat_map(|t| t.corners.iter().zip(t.uvs))
        .map(|(p, uv)| (p.to_array(), uv.to_array()))
        .collect();
    corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
    corners.dedup();
    let places: Vec<[f64; 3]> = corners.iter().map(|c| c.0).collect();
    assert_eq!(
        places,
        [
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [4.0, 0.0, 0.0],
            [4.0, 1.0, 0.0]
        ]
    );
    // The edge at x = 0 keeps its coordinates, that at x = 4 has the others.
    let uvs: Vec<[f64; 2]> = corners.iter().map(|c| c.1).collect();
    assert_eq!(uvs, [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]);
    assert_eq!(Lod::after(&order, 1).leaf_count(), 2);
}

/// A square over another, a little to the right: the left edge of the one and
/// the right edge of the other, no sliver between corners that nearly coincide.
#[test]
fn leaves_that_nearly_coincide_become_a_leaf_of_their_size() {
    let step = DVec3::new(0.01, 0.0, 0.001);
    let foliage = foliage(&[unit_square(DVec3::ZERO), unit_square(step)]);
    let order = run(&foliage, 1, &FsaOptions::default());
    let left = Lod::after(&order, 1).foliage(&foliage);
    let area = left.leaves()[0].area();
    assert!((area - 1.01).abs() < 1e-3, "{area}");
}

/// Two such leaves by the published rule: in a view along z all four corners of each are as far from
/// the other leaf as its nearest corner, the two on the left of the left one .01 from the other's
/// left edge and those on the right of the right one likewise. So each gives its first two, which
/// lie beside each other, and a sliver is what is left.
#[test]
fn the_published_rule_makes_slivers_of_leaves_that_nearly_coincide() {
    let step = DVec3::new(0.01, 0.0, 0.001);
    let foliage = foliage(&[unit_square(DVec3::ZERO), unit_square(step)]);
    let order = run(&foliage, 1, &FsaOptions::published());
    let left = Lod::after(&order, 1).foliage(&foliage);
    let area = left.leaves()[0].area();
    assert!(area < 0.02, "{area}");
}

/// A square of side 1, and one of side 3 beneath it whose left edge is under the square's. From
/// the other's middle (1.5 to the right) the square's left corners are furthest; from the other's
/// corners the right ones are, which are 2 from its right edge and no less than 1 from its left.
#[test]
fn furthest_is_from_the_other_leaf_and_not_from_its_middle() {
    let large =
        quad([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]].map(|[x, y]| DVec3::new(x, y, -0.1)));
    let foliage = foliage(&[unit_square(DVec3::ZERO), large]);
    let places = |corners| {
        let options = FsaOptions {
            corners,
            ..FsaOptions::default()
        };
        let order = run(&foliage, 1, &options);
        let made = order.steps().next().unwrap().made[0].clone();
        let of_square = made
            .triangles
            .iter()
            .flatten()
            .filter_map(|c| match c.place {
                Place::Of(at) if at.leaf.get() == 1 => Some(at),
                _ => None,
            });
        let at = |c: secateur_model::CornerRef| {
            let triangles = foliage.triangles_of(c.leaf);
            triangles[c.corner as usize / 3].corners[c.corner as usize % 3]
        };
        let mut places: Vec<[i32; 2]> = of_square
            .map(at)
            .map(|p| [p.x as i32, p.y as i32])
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    };
    // (1, 1) is the square root of 2 from the corner at 0, 0; (1, 0) and (0, 1) are 1 from it.
    assert_eq!(places(Corners::Furthest), [[1, 0], [1, 1]]);
    assert_ne!(places(Corners::Spread), places(Corners::Furthest));
}

/// A unit square .1 above the middle of one of side 9: no corner of the large one is near, but its
/// surface is. From the square's corners it is .1 away, from the large one's it is
/// sqrt(4^2 + 4^2 + .1^2) either way; from the square's corners to the large one's corners
/// sqrt(5^2 + 4^2 + .1^2) at most and sqrt(4^2 + 4^2 + .1^2) at least.
#[test]
fn a_surface_is_near_where_its_corners_are_not() {
    let large = quad(
        [[-4.0, -4.0], [5.0, -4.0], [5.0, 5.0], [-4.0, 5.0]].map(|[x, y]| DVec3::new(x, y, -0.1)),
    );
    let leaf = |triangles: [LeafTriangle; 2]| {
        let foliage = foliage(&[triangles]);
        ActiveLeaf::original(&foliage, LeafId::from_index(0), Hausdorff::Surface)
    };
    let (square, large) = (leaf(unit_square(DVec3::ZERO)), leaf(large));
    let corner = DVec3::ZERO;
    let squared = |of, hausdorff| ActiveLeaf::distance_squared(of, corner, hausdorff);
    assert!((squared(&large, Hausdorff::Surface) - 0.01).abs() < 1e-12);
    assert!((squared(&large, Hausdorff::Corners) - 32.01).abs() < 1e-12);
    // Over an edge, beyond a corner, and in the middle of the other triangle.
    for (point, nearest) in [
        ([0.5, -2.0, 0.0], 2.0),
        ([4.0, 5.0, 0.0], 5.0),
        ([0.25, 0.75, -3.0], 3.0),
    ] {
        let point = DVec3::from(point);
        let found = square.distance_squared(point, Hausdorff::Surface).sqrt();
        assert!((found - nearest).abs() < 1e-12, "{point}: {found}");
    }
}

/// Two squares in one plane, 2 apart, against two that are 1 apart at right
/// angles: 2 against 1 + w, so the weight decides.
#[test]
fn planarity_counts_as_much_as_its_weight() {
    let upright =
        |at: DVec3| quad([DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Z, DVec3::Z].map(|p| at + p));
    let leaves = [
        unit_square(DVec3::ZERO),
        unit_square(2.0 * DVec3::Y),
        unit_square(100.0 * DVec3::X),
        upright(100.0 * DVec3::X),
    ];
    let foliage = foliage(&leaves);
    let first = |planarity_weight| {
        let options = FsaOptions {
            planarity_weight,
            ..FsaOptions::default()
        };
        run(&foliage, 3, &options).removed()[0].get()
    };
    // The corner at y = 1, z = 0 is 1 from z = 0 and y = 0; so is H.
    assert_eq!(first(0.5), 3);
    assert_eq!(first(1.5), 1);
}

#[test]
fn the_last_leaf_goes_too() {
    let foliage = foliage(&[unit_square(DVec3::ZERO), unit_square(DVec3::Y)]);
    let order = run(&foliage, 0, &FsaOptions::default());
    assert_eq!(order.len(), 2);
    assert_eq!(Lod::after(&order, 2).leaf_count(), 0);
    assert!(run(&Foliage::default(), 0, &FsaOptions::default()).is_empty());
}

/// A leaf at the same place as all others costs nothing with any of them, so the
/// lowest numbers go first: the originals in turn, then what they became. When
/// each leaf looked through all others at each step, this took a quarter of an
/// hour.
#[test]
fn leaves_at_one_place_take_no_longer_than_others() {
    let count = 4000;
    let foliage = foliage(&vec![unit_square(DVec3::ONE); count]);
    let start = std::time::Instant::now();
    let order = run(&foliage, 0, &FsaOptions::default());
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 20.0, "{seconds} s");
    let in_turn: Vec<u32> = (1..2 * count as u32).collect();
    let removed: Vec<u32> = order.removed().iter().map(|leaf| leaf.get()).collect();
    assert_eq!(removed, in_turn);
}

/// Leaves of a few shapes at a few places, as a tree of cards has them: groups
/// lose all members and get new ones.
#[test]
fn leaves_at_a_few_places_go_as_if_every_pair_was_looked_at() {
    let square = |k: i32| {
        let at = f64::from(k % 3) * DVec3::X + f64::from(k % 2) * DVec3::Y;
        let mut corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y].map(|p| at + p);
        corners.rotate_left((k % 4) as usize);
        if k % 5 == 0 {
            corners.reverse();
        }
        quad(corners)
    };
    let foliage = foliage(&(0..90).map(square).collect::<Vec<_>>());
    for planarity_weight in [0.0, 1.0] {
        let options = FsaOptions {
            planarity_weight,
            ..FsaOptions::default()
        };
        assert_eq!(
            run(&foliage, 1, &options),
            by_all_pairs(&foliage, 1, &options)
        );
    }
}

#[test]
fn a_run_can_be_broken_off() {
    let foliage = foliage(&[unit_square(DVec3::ZERO), unit_square(DVec3::Y)]);
    let stop = &mut |_| ControlFlow::Break(());
    assert_eq!(simplify(&foliage, 1, &FsaOptions::default(), stop), None);
}

/// Corners on a small grid, so that there are ties, points and doubled leaves.
fn any_foliage() -> impl Strategy<Value = Foliage> {
    let corner = prop::array::uniform3(0..4i32);
    let place = prop::array::uniform3(0..12i32);
    let leaf = (prop::array::uniform4(corner), place).prop_map(|(corners, place)| {
        let point = |p: [i32; 3]| DVec3::from(p.map(f64::from));
        quad(corners.map(|c| point(place) + 0.5 * point(c)))
    });
    prop::collection::vec(leaf, 1..40).prop_map(|leaves| foliage(&leaves))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn it_is_the_greedy_choice_among_all_pairs(
        foliage in any_foliage(),
        planarity_weight in prop::sample::select(vec![0.0, 1.0, 5.0]),
        corners in prop::sample::select(vec![Corners::Spread, Corners::Furthest]),
        hausdorff in prop::sample::select(vec![Hausdorff::Corners, Hausdorff::Surface]),
    ) {
        let options = FsaOptions {
            planarity_weight,
            corners,
            hausdorff,
            ..FsaOptions::default()
        };
        prop_assert_eq!(run(&foliage, 1, &options), by_all_pairs(&foliage, 1, &options));
    }

    #[test]
    fn bounds_are_bounds(
        foliage in any_foliage(),
        hausdorff in prop::sample::select(vec![Hausdorff::Corners, Hausdorff::Surface]),
    ) {
        let cost = Cost::new(&foliage, &FsaOptions { hausdorff, ..FsaOptions::default() });
        let leaves: Vec<ActiveLeaf> = (0..foliage.leaves().len())
            .map(|k| ActiveLeaf::original(&foliage, LeafId::from_index(k), hausdorff))
            .collect();
        for (a, b) in leaves.iter().flat_map(|a| leaves.iter().map(move |b| (a, b))) {
            prop_assert!(cost.at_least(a, b) <= cost.of(a, b));
            prop_assert_eq!(cost.of(a, b), cost.of(b, a));
            let middles = a.middle().distance_squared(b.middle()) / 3.0;
            prop_assert!(SLACK * cost.of_distance(middles) <= cost.of(a, b));
        }
    }

    /// No vertex is new, and every corner names one.
    #[test]
    fn corners_are_corners_of_the_foliage(foliage in any_foliage()) {
        let order = run(&foliage, 1, &FsaOptions::published());
        for made in order.steps().flat_map(|step| step.made) {
            let references = made.triangles.iter().flatten();
            prop_assert!(references.clone().all(|c| matches!(c.place, Place::Of(_))));
            prop_assert_eq!(made.triangles_in(&foliage, 1.0).len(), 2);
        }
        prop_assert_eq!(Lod::after(&order, order.len()).leaf_count(), 1);
    }
}
