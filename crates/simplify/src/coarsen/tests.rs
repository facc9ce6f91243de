use glam::{DQuat, DVec2, DVec3};
use proptest::prelude::*;
use secateur_model::Lod;

use super::*;

/// A regular polygon about its own middle, a fan from its first corner.
fn polygon(corners: usize, size: f64, at: DVec3) -> Vec<LeafTriangle> {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, at.x, at.y, at.z);
    let place = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / corners as f64;
        let flat = DVec2::from_angle(angle);
        (at + turn * (size * flat.extend(0.0)), 0.5 * flat)
    };
    let triangle = |k: usize| {
        let corners = [place(0), place(k), place(k + 1)];
        LeafTriangle {
            corners: corners.map(|c| c.0),
            uvs: corners.map(|c| c.1),
        }
    };
    (1..corners - 1).map(triangle).collect()
}

fn of(leaves: &[Vec<LeafTriangle>]) -> Foliage {
    let mut foliage = Foliage::default();
    for leaf in leaves {
        foliage.push_leaf(leaf, None).unwrap();
    }
    foliage
}

fn counts(foliage: &Foliage) -> Vec<usize> {
    let leaves = (0..foliage.leaves().len()).map(LeafId::from_index);
    leaves.map(|l| foliage.triangles_of(l).len()).collect()
}

/// Leaves of numbers of triangles that are not looked at: more than can be.
fn large(triangles: &[usize]) -> Foliage {
    let leaf = |(x, count): (usize, &usize)| polygon(count + 2, 1.0, DVec3::X * x as f64);
    of(&triangles.iter().enumerate().map(leaf).collect::<Vec<_>>())
}

#[test]
fn triangles_go_where_they_show_the_most() {
    // One more of n takes away 1/n - 1/(n + 1) of a leaf, and these are of one size.
    let foliage = large(&[200, 200, 300]);
    let curves = LossCurves::of(&foliage);
    let shares = |at_most| share_triangles(&foliage, at_most, &curves);
    assert_eq!(shares(700), [200, 200, 300]);
    assert_eq!(shares(1000), [200, 200, 300]);
    let [a, b, c] = shares(100)[..] else { panic!() };
    assert_eq!((a + b + c, a, b), (100, 33, 33));
    assert_eq!(shares(0), [1, 1, 1]);
    assert!(
        share_triangles(&Foliage::default(), 5, &LossCurves::of(&Foliage::default())).is_empty()
    );

    // Of leaves alike the largest are the first.
    let sizes = [1.0, 3.0, 2.0, 4.0];
    let leaf = |(x, size): (usize, &f64)| polygon(10, *size, DVec3::X * 20.0 * x as f64);
    let foliage = of(&sizes.iter().enumerate().map(leaf).collect::<Vec<_>>());
    let shares = share_triangles(&foliage, 16, &LossCurves::of(&foliage));
    assert!(shares[0] <= shares[2] && shares[2] <= shares[1] && shares[1] <= shares[3]);
    assert!(shares[0] < shares[3], "{shares:?}");
}

#[test]
fn leaves_that_are_hidden_leave_their_triangles_to_others() {
    let foliage = large(&[200, 200, 200]);
    let shares = |seen_px: [f64; 3]| {
        let curves = LossCurves::of(&foliage).seen(seen_px.to_vec());
        share_triangles(&foliage, 100, &curves)
    };
    assert_eq!(shares([9.0, 9.0, 0.0]), [50, 50, 1]);
    let [a, b, c] = shares([9.0, 9.0, 1.0])[..] else {
        panic!()
    };
    assert!(
        c < 20 && a + b + c == 100 && a.abs_diff(b) <= 1,
        "{a} {b} {c}"
    );
    assert_eq!(shares([9.0; 3]).iter().sum::<usize>(), 100);
}

/// An arch of three strips: with three triangles it is lopsided.
fn arch(at: DVec3) -> Vec<LeafTriangle> {
    let place = |k: usize, side: f64| {
        let (x, y) = [(-3.0, 0.0), (-1.0, 1.0), (1.0, 1.0), (3.0, 0.0)][k];
        (
            at + DVec3::new(x, y, 0.3 * side),
            DVec2::new(k as f64, side),
        )
    };
    let strip = |k: usize| {
        let [a, b, c, d] =
            [(k, 0.0), (k, 1.0), (k + 1, 1.0), (k + 1, 0.0)].map(|p| place(p.0, p.1));
        [[a, b, c], [a, c, d]].map(|t| LeafTriangle {
            corners: t.map(|corner| corner.0),
            uvs: t.map(|corner| corner.1),
        })
    };
    (0..3).flat_map(strip).collect()
}

#[test]
fn no_leaf_keeps_a_number_that_shows_less_than_a_smaller_one() {
    let leaves: Vec<_> = (0..30)
        .map(|k| arch(DVec3::new(k as f64, 7.0 * (k % 5) as f64, 3.0)))
        .collect();
    let foliage = of(&leaves);
    let curves = LossCurves::of(&foliage);
    let kept = curves.hull(LeafId::from_index(0)).iter();
    let kept: Vec<usize> = kept.map(|k| k.triangles).collect();
    assert_eq!([kept[0], kept[kept.len() - 1]], [1, 6]);
    assert!(!kept.contains(&3) && !kept.contains(&5), "{kept:?}");
    // Half of the triangles, but no leaf has half of its own.
    let shares = share_triangles(&foliage, 90, &curves);
    let sum: usize = shares.iter().sum();
    assert!((86..=90).contains(&sum), "{shares:?}");
    assert!(!shares.contains(&3), "{shares:?}");
}

/// Two halves, each at 45 degrees to the mean plane of both.
#[test]
fn a_folded_leaf_becomes_a_triangle_in_its_mean_plane() {
    let leaf = |x: f64| {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let [base, tip] = [at(x, 0.0, 0.0), at(x + 1.5, 0.0, 0.0)];
        let [left, right] = [at(x + 0.7, 0.5, 0.5), at(x + 0.7, -0.5, 0.5)];
        [[base, left, tip], [base, tip, right]]
            .map(LeafTriangle::plain)
            .to_vec()
    };
    let foliage = of(&[0.0, 2.0, 4.0].map(leaf));
    let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &[1, 1, 2]).unwrap();
    for (before, after) in foliage
        .leaves()
        .iter()
        .zip(coarse.foliage().leaves())
        .take(2)
    {
        assert!(before.centre().distance(after.centre()) < 1e-12);
        assert!((before.area() - after.area()).abs() < 1e-12);
    }
    assert_eq!(counts(coarse.foliage()), [1, 1, 2]);
    for (triangle, before) in coarse.foliage().triangles()[..2]
        .iter()
        .zip(foliage.triangles().chunks(2))
    {
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let facing = normal(before[0].corners) + normal(before[1].corners);
        let cosine = normal(triangle.corners).normalize().dot(facing.normalize());
        assert!(cosine > 1.0 - 1e-12, "{cosine}");
    }
}

#[test]
fn what_is_worth_more_the_later_it_comes_is_left_out() {
    let kept = |losses: &[f64]| {
        let all = losses
            .iter()
            .zip(1..)
            .map(|(&loss, triangles)| LossPoint { triangles, loss });
        let kept = loss_curve::lower_hull(&all.collect::<Vec<_>>());
        kept.iter().map(|k| k.triangles).collect::<Vec<_>>()
    };
    assert_eq!(kept(&[0.9, 0.4, 0.2, 0.0]), [1, 2, 4]);
    assert_eq!(kept(&[0.9, 0.4, 0.1, 0.0]), [1, 2, 3, 4]);
    assert_eq!(kept(&[0.7, 0.6, 0.8, 0.5, 0.7, 0.0]), [1, 6]);
    assert_eq!(kept(&[0.7, 0.3, 0.5, 0.2, 0.4, 0.0]), [1, 2, 6]);
    assert_eq!(kept(&[0.7, 0.2, 0.5, 0.1, 0.4, 0.0]), [1, 2, 6]);
    assert_eq!(kept(&[0.0]), [1]);
}

#[test]
fn a_hexagon_becomes_a_triangle_of_its_area_at_its_place() {
    let foliage = of(&[polygon(6, 1.0, DVec3::new(1.0, 2.0, 3.0))]);
    let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &[1]).unwrap();
    let (before, after) = (&foliage.leaves()[0], &coarse.foliage().leaves()[0]);
    assert_eq!(coarse.foliage().triangles().len(), 1);
    assert!((before.area() - after.area()).abs() < 1e-12 * before.area());
    assert!(before.centre().distance(after.centre()) < 1e-12);
    // Each corner has the texture of the one that it was: 0.5 at this distance.
    let triangle = coarse.foliage().triangles()[0];
    assert!(
        triangle
            .uvs
            .iter()
            .all(|uv| (uv.length() - 0.5).abs() < 1e-12)
    );
}

#[test]
fn what_cannot_be_coarser_stays() {
    let point = vec![LeafTriangle::plain([DVec3::ONE; 3]); 4];
    let line = vec![LeafTriangle::plain([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]); 3];
    let triangle = polygon(3, 1.0, DVec3::ZERO);
    let foliage = of(&[point.clone(), line.clone(), triangle.clone()]);
    assert!(coarsen(&foliage, &LossCurves::of(&foliage), &[1, 1, 1]).is_none());
    let hexagon = polygon(6, 1.0, DVec3::ZERO);
    let foliage = of(&[point, line, triangle, hexagon]);
    let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &[1; 4]).unwrap();
    assert_eq!(counts(coarse.foliage()), [4, 3, 1, 1]);
    assert_eq!(coarse.foliage().triangles()[..8], foliage.triangles()[..8]);
}

/// Fronts and backs share their vertices: of each a triangle is left, with corners of
/// its own side, whose normals they have.
#[test]
fn leaves_of_two_sides_keep_a_triangle_of_each() {
    let front = polygon(6, 1.0, DVec3::ZERO);
    let back = front.iter().map(|t| LeafTriangle {
        corners: [t.corners[0], t.corners[2], t.corners[1]],
        uvs: [t.uvs[0], t.uvs[2], t.uvs[1]],
    });
    let foliage = of(&[front.iter().copied().chain(back).collect()]);
    let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &[1]).unwrap();
    let made = coarse.made[0].as_ref().unwrap();
    assert_eq!(made.triangles.len(), 2);
    let sides = made.triangles.iter().map(|t| {
        let sides = t.map(|corner| corner.like / 3 < 4);
        assert!(sides.iter().all(|side| *side == sides[0]), "{sides:?}");
        sides[0]
    });
    let sides: Vec<bool> = sides.collect();
    assert_ne!(sides[0], sides[1]);
    for (triangle, is_front) in coarse.foliage().triangles().iter().zip(sides) {
        let [a, b, c] = triangle.corners;
        assert_eq!((b - a).cross(c - a).z > 0.0, is_front);
    }
}

/// As many as there are left of a leaf are counted, not as many as were asked for.
#[test]
fn a_leaf_of_two_sides_takes_no_fewer_than_two() {
    let leaf = |at: DVec3| {
        let front = polygon(4, 1.0, at);
        let back = front.iter().map(|t| LeafTriangle {
            corners: [t.corners[0], t.corners[2], t.corners[1]],
            uvs: [t.uvs[0], t.uvs[2], t.uvs[1]],
        });
        front.iter().copied().chain(back).collect::<Vec<_>>()
    };
    let leaves: Vec<_> = (0..9).map(|k| leaf(DVec3::X * 3.0 * k as f64)).collect();
    let foliage = of(&leaves);
    let curves = LossCurves::of(&foliage);
    let kept = curves.hull(LeafId::from_index(0));
    assert_eq!(kept.first().map(|k| k.triangles), Some(2));
    let shares = share_triangles(&foliage, 18, &curves);
    assert_eq!(shares, [2; 9]);
    let coarse = coarsen(&foliage, &curves, &shares).unwrap();
    assert_eq!(coarse.foliage().triangles().len(), 18);
}

#[test]
fn nothing_that_is_of_use_is_left_over() {
    // One jump of 4 does not fit, one of 2 does.
    let foliage = of(&[arch(DVec3::ZERO)]);
    let curves = LossCurves::of(&foliage);
    let losses: Vec<f64> = curves
        .points(LeafId::from_index(0))
        .iter()
        .map(|k| k.loss)
        .collect();
    for at_most in 1..=6 {
        let share = share_triangles(&foliage, at_most, &curves)[0];
        assert!(share <= at_most);
        let least = losses[..at_most]
            .iter()
            .fold(f64::INFINITY, |a, b| a.min(*b));
        assert_eq!(losses[share - 1], least, "{at_most}: {losses:?}");
    }
}

/// A kind is known by which corners meet: an arrowhead is one with a kite.
#[test]
fn every_leaf_keeps_the_way_round_that_it_is() {
    let leaf = |x: f64, notch: f64| {
        let at = |u: f64, v: f64, z: f64| DVec3::new(x + u, v, z);
        let [tip, left, back, right] = [
            at(2.0, 0.0, 0.0),
            at(0.0, 1.0, 0.4),
            at(notch, 0.0, 0.0),
            at(0.0, -1.0, 0.4),
        ];
        [[tip, left, back], [tip, back, right]]
            .map(LeafTriangle::plain)
            .to_vec()
    };
    for order in [[-1.0, 0.7], [0.7, -1.0]] {
        let foliage = of(&[leaf(0.0, order[0]), leaf(5.0, order[1])]);
        let curves = LossCurves::of(&foliage);
        let triangles = [[0_u32, 1, 5], [0, 1, 2], [1, 2, 5], [0, 2, 5]];
        for (leaf, three) in (0..2).flat_map(|leaf| triangles.map(|three| (leaf, three))) {
            let leaf = LeafId::from_index(leaf);
            let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
            let facing: DVec3 = foliage
                .triangles_of(leaf)
                .iter()
                .map(|t| normal(t.corners))
                .sum();
            let made = triangle::flat(&foliage, leaf, three).unwrap();
            let after = made.triangles_in(&foliage, 1.0)[0];
            assert!(
                normal(after.corners).dot(facing) > 0.0,
                "{leaf:?} {three:?}"
            );
        }
        assert_eq!(
            curves.hull(LeafId::from_index(0)),
            curves.hull(LeafId::from_index(1))
        );
    }
}

/// A back that is smaller than the front leaves some area to face by, but no plane that
/// one triangle could stand for.
#[test]
fn a_leaf_with_a_smaller_back_is_no_flat_triangle() {
    let front = polygon(6, 1.0, DVec3::ZERO);
    let back = polygon(6, 0.9, DVec3::ZERO);
    let turned = back.iter().map(|t| LeafTriangle {
        corners: [t.corners[0], t.corners[2], t.corners[1]],
        uvs: [t.uvs[0], t.uvs[2], t.uvs[1]],
    });
    let two_sided = of(&[front.iter().copied().chain(turned).collect()]);
    let one_sided = of(&[front.iter().copied().chain(back).collect()]);
    let leaf = LeafId::from_index(0);
    let is_one = |foliage: &Foliage| {
        let candidates = triangle::candidates(foliage, leaf);
        let flat = |three: &triangle::CornerTriple| triangle::flat(foliage, leaf, *three).is_some();
        candidates.iter().any(flat)
    };
    assert!(is_one(&one_sided));
    assert!(!is_one(&two_sided));
}

#[test]
fn a_closed_leaf_stays_or_keeps_its_sides() {
    let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let tetrahedron = [[a, c, b], [a, b, d], [a, d, c], [b, c, d]].map(LeafTriangle::plain);
    let foliage = of(&[tetrahedron.to_vec()]);
    for at_most in 1..=4 {
        let left = coarsen(&foliage, &LossCurves::of(&foliage), &[at_most]);
        let area = |foliage: &Foliage| foliage.leaves()[0].area();
        if let Some(left) = left {
            assert!((area(left.foliage()) - area(&foliage)).abs() < 1e-9);
            assert!((2..4).contains(&left.foliage().triangles().len()));
        }
    }
}

/// Of a leaf that stays, one that becomes coarser and grows, and one that becomes
/// coarser and goes.
#[test]
fn an_order_over_coarser_leaves_is_one_over_the_original_ones() {
    let at = |x: f64, corners| polygon(corners, 1.0, DVec3::X * x);
    let foliage = of(&[at(0.0, 3), at(5.0, 6), at(9.0, 6)]);
    let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &[1, 2, 2]).unwrap();
    let leaf = LeafId::from_index;
    let mut order = RemovalOrder::new(3);
    let grown = Growth {
        leaf: leaf(1),
        area_scale: 2.0,
    };
    order.push(leaf(2), &[grown]);
    let whole = coarse.order(&order);
    assert_eq!([0, 1, 2].map(|k| whole.leaves_after(k)), [3, 3, 2]);
    assert_eq!(whole.removed(), [leaf(1), leaf(2), leaf(4)]);
    for steps in 0..=1 {
        let direct = Lod::after(&order, steps).foliage(coarse.foliage());
        let lod = Lod::after(&whole, steps + 1);
        let composed = lod.foliage(&foliage);
        assert_eq!(composed.triangles(), direct.triangles(), "after {steps}");
        assert_eq!(lod.max_area_scale(), [1.0, 2.0][steps]);
    }
    assert_eq!(whole.steps_to_triangles(&foliage, 9), 0);
    assert_eq!(whole.steps_to_triangles(&foliage, 8), 1);
    assert_eq!(whole.steps_to_triangles(&foliage, 4), 2);
    assert_eq!(whole.steps_to_triangles(&foliage, 0), 2);
}

/// Beside such large ones these show hardly a pixel, and of either a sliver shows as many.
#[test]
fn a_leaf_too_small_to_be_looked_at_is_no_sliver() {
    let nine = polygon(
        9,
        0.963_706_532_712_345_1,
        DVec3::new(
            29.015_540_800_336_268,
            39.736_220_161_683_78,
            26.718_528_158_479_423,
        ),
    );
    let seven = polygon(
        7,
        0.768_527_584_537_913_9,
        DVec3::new(0.0, -13.565_810_589_460_83, 35.347_535_554_442_9),
    );
    let scenes = [
        of(&[
            nine,
            polygon(
                8,
                845.411_061_418_535_3,
                DVec3::new(-12.585_461_452_078_613, 0.0, 0.0),
            ),
            polygon(
                8,
                986.568_979_726_339_5,
                DVec3::new(0.0, -10.784_912_419_215_26, 4.347_468_105_277_311),
            ),
        ]),
        of(&[
            seven,
            polygon(
                9,
                561.608_537_417_523_3,
                DVec3::new(
                    17.315_100_490_680_89,
                    -25.931_219_751_769_16,
                    18.091_447_291_670_5,
                ),
            ),
        ]),
    ];
    for foliage in scenes {
        let all_one = vec![1; foliage.leaves().len()];
        let coarse = coarsen(&foliage, &LossCurves::of(&foliage), &all_one).unwrap();
        assert_eq!(counts(coarse.foliage()), all_one);
        let (before, after) = (&foliage.leaves()[0], &coarse.foliage().leaves()[0]);
        assert!((before.area() - after.area()).abs() <= 1e-9 * before.area());
    }
}

proptest! {
    /// Any polygons: no leaf has more triangles than its share, each share is one that
    /// such a leaf takes well, all together are no more than asked for, none is lost, and each keeps its area and centre.
    #[test]
    fn coarser_leaves_keep_to_their_share_their_area_and_their_centre(
        leaves in prop::collection::vec((3_usize..12, 1e-3..1e3, prop::array::uniform3(-50.0..50.0)), 1..12),
        share in 0.0..1.0,
    ) {
        let leaves: Vec<_> = leaves
            .iter()
            .map(|(corners, size, at)| polygon(*corners, *size, DVec3::from_array(*at)))
            .collect();
        let foliage = of(&leaves);
        let at_most = (share * foliage.triangles().len() as f64) as usize;
        let curves = LossCurves::of(&foliage);
        let shares = share_triangles(&foliage, at_most, &curves);
        let coarse = coarsen(&foliage, &curves, &shares);
        let after = coarse.as_ref().map_or(&foliage, Coarse::foliage);
        let (coarse, after) = (after, counts(after));
        prop_assert!(after.iter().zip(&shares).all(|(count, share)| count <= share));
        let sum: usize = shares.iter().sum();
        prop_assert!(sum <= at_most.max(leaves.len()));
        for (index, &share) in shares.iter().enumerate() {
            let all = curves.points(LeafId::from_index(index));
            let now = all.iter().find(|kept| kept.triangles == share);
            prop_assert!(now.is_some(), "{} is none of {:?}", share, all);
            // With what is left over no leaf would lose less.
            let is_better = |kept: &&LossPoint| {
                let more = kept.triangles.saturating_sub(share);
                more > 0 && more <= at_most.saturating_sub(sum) && kept.loss < now.unwrap().loss
            };
            prop_assert_eq!(all.iter().find(is_better), None);
        }
        for (before, after) in foliage.leaves().iter().zip(coarse.leaves()) {
            prop_assert!((before.area() - after.area()).abs() <= 1e-9 * before.area());
            let tolerance = 1e-9 * (before.area().sqrt() + before.centre().length());
            prop_assert!(before.centre().distance(after.centre()) <= tolerance);
        }
    }
}

/// What is left of a square is a strip along its diagonal: at the square's area it would be 3.2 times as long, and the
/// tips of leaves would hang in the air beside their plant.
#[test]
fn a_leaf_of_which_strips_are_left_stays_near_its_place() {
    let square = polygon(4, 1.0, DVec3::X);
    let mut strip = square[0];
    strip.corners[1] = 0.9 * strip.corners[0].midpoint(strip.corners[2]) + 0.1 * strip.corners[1];
    let foliage = of(&[[square, vec![strip]].concat()]);
    let leaf = LeafId::from_index(0);
    let triangles = foliage.triangles_of(leaf);
    let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
    let left = in_place_of(&foliage, leaf, &[[6, 7, 8]], position).unwrap();
    let centre = foliage.leaf(leaf).centre();
    let corners = left.triangles_in(&foliage, 1.0)[0].corners;
    let reach = corners
        .map(|c| c.distance(centre))
        .into_iter()
        .fold(0.0, f64::max);
    assert!((1.2..1.7).contains(&reach), "{reach}");
}
