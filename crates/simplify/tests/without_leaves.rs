//! Plants without leaves: all of them is wood. And plants of which hardly anything else is.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use glam::{DVec2, DVec3};
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{Budget, Sharing, WholePlant};
use secateur_simplify::wood::wood_gaps;
use secateur_simplify::{Options, Preset, Target};

/// A ball of 264 triangles.
fn ball(centre: DVec3, radius: f64) -> Vec<LeafTriangle> {
    const AROUND: usize = 12;
    const ALONG: usize = 12;
    let place = |i: usize, k: usize| {
        // Both poles are one place, whatever the angle.
        let (ring, height) = match i {
            0 => (0.0, 1.0),
            ALONG => (0.0, -1.0),
            i => (PI * i as f64 / ALONG as f64).sin_cos(),
        };
        let (sin, cos) = (TAU * (k % AROUND) as f64 / AROUND as f64).sin_cos();
        centre + radius * DVec3::new(ring * cos, height, ring * sin)
    };
    let quads = (0..ALONG).flat_map(|i| (0..AROUND).map(move |k| (i, k)));
    let triangles = quads.flat_map(|(i, k)| {
        let [a, b] = [place(i, k), place(i, k + 1)];
        let [c, d] = [place(i + 1, k), place(i + 1, k + 1)];
        [[a, b, d], [a, d, c]]
    });
    let has_area = |[a, b, c]: &[DVec3; 3]| a != b && b != c && a != c;
    triangles
        .filter(has_area)
        .map(LeafTriangle::plain)
        .collect()
}

/// Two balls that touch at a vertex of each.
fn snowman() -> Foliage {
    let mut wood = Foliage::default();
    for (height, radius) in [(2.0, 2.0), (5.0, 1.0)] {
        let ball = ball(height * DVec3::Y, radius);
        assert_eq!(ball.len(), 264);
        wood.push_leaf(&ball, None).unwrap();
    }
    wood
}

#[test]
fn a_plant_without_leaves_has_levels() {
    let (wood, leaves) = (snowman(), Foliage::default());
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(&wood, &leaves, &wood, &engine).unwrap();
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    for sharing in [Sharing::ByNumber, Sharing::Evenly] {
        for triangles in [400, 250, 100] {
            let budget = Budget { triangles, sharing };
            let mut go_on = |_| ControlFlow::Continue(());
            let level = plant
                .level(budget, &options, &engine, None, &mut go_on)
                .unwrap();
            assert_eq!(level.leaves.lod.leaf_count(), 0);
            let left = level.wood.foliage(&wood).triangles().len();
            assert_eq!(left, level.wood_triangles);
            let is_met = (9 * triangles / 10..=triangles).contains(&left);
            assert!(is_met, "{left} of {triangles}, {sharing:?}");
            // Both balls are there, and each has corners of its own alone.
            assert_eq!(level.wood.leaf_count(), 2);
            for (number, low, high) in [(0, 0.0, 4.0), (1, 4.0, 6.0)] {
                let left = level.wood.foliage(&wood);
                let of_ball = left.triangles_of(secateur_model::LeafId::from_index(number));
                let mut corners = of_ball.iter().flat_map(|t| t.corners);
                assert!(corners.all(|c| (low..=high).contains(&c.y)), "{sharing:?}");
            }
        }
    }
}

/// Of a ball that few triangles are left of, a front and a back may be: they do not hide each other.
#[test]
fn no_two_faces_of_a_flattened_body_are_in_one_place() {
    let (mut wood, leaves) = (Foliage::default(), Foliage::default());
    let heights = (0..12).map(f64::from);
    for (height, radius) in heights.map(|k| (1.5 + k, 0.4)).chain([(0.5, 0.5)]) {
        wood.push_leaf(&ball(height * DVec3::Y, radius), None)
            .unwrap();
    }
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(&wood, &leaves, &wood, &engine).unwrap();
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    let mut flat = 0;
    for sharing in [Sharing::ByNumber, Sharing::Evenly] {
        for triangles in [60, 40, 26] {
            let budget = Budget { triangles, sharing };
            let mut go_on = |_| ControlFlow::Continue(());
            let level = plant.level(budget, &options, &engine, None, &mut go_on);
            let left = level.unwrap().wood.foliage(&wood);
            let pieces = (0..left.leaves().len()).map(LeafId::from_index);
            flat += pieces
                .filter(|piece| left.triangles_of(*piece).len() == 2)
                .count();
            let mut places: Vec<[[u64; 3]; 3]> = left
                .triangles()
                .iter()
                .map(|t| {
                    let mut places = t.corners.map(|at| at.to_array().map(f64::to_bits));
                    places.sort();
                    places
                })
                .collect();
            places.sort();
            assert!(
                places.windows(2).all(|pair| pair[0] != pair[1]),
                "{triangles}, {sharing:?}"
            );
        }
    }
    assert!(flat > 0);
}

/// A curved sheet of 200 triangles from x on, one unit wide and high.
fn sheet(x: f64) -> Vec<LeafTriangle> {
    const SIDE: usize = 10;
    let place = |i: usize, k: usize| {
        let [u, v] = [i, k].map(|n| n as f64 / SIDE as f64);
        DVec3::new(x + u, v, 0.1 * (2.0 * (x + u)).sin() * v)
    };
    let quads = (0..SIDE).flat_map(|i| (0..SIDE).map(move |k| (i, k)));
    let triangles = quads.flat_map(|(i, k)| {
        let [a, b] = [place(i, k), place(i + 1, k)];
        let [c, d] = [place(i, k + 1), place(i + 1, k + 1)];
        [[a, b, d], [a, d, c]]
    });
    triangles.map(LeafTriangle::plain).collect()
}

/// Both face the same way where they touch, so nothing but their names tells whose a corner is.
#[test]
fn pieces_that_touch_keep_their_own_corners() {
    let mut wood = Foliage::default();
    for x in [0.0, 1.0] {
        wood.push_leaf(&sheet(x), None).unwrap();
    }
    let level = level_of(&wood, 200);
    for (made, _) in level.made() {
        let corners = made.triangles.iter().flatten();
        let own = 3 * wood.triangles_of(made.donor).len() as u32;
        for corner in corners {
            assert!(corner.like < own);
        }
    }
    assert!((180..=200).contains(&level.foliage(&wood).triangles().len()));
}

/// A level of a plant of this wood alone.
fn level_of(wood: &Foliage, triangles: usize) -> Lod {
    let leaves = Foliage::default();
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(wood, &leaves, wood, &engine).unwrap();
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    let budget = Budget {
        triangles,
        sharing: Sharing::Evenly,
    };
    let mut go_on = |_| ControlFlow::Continue(());
    let level = plant.level(budget, &options, &engine, None, &mut go_on);
    level.unwrap().wood
}

/// A crown of two balls on a trunk of this radius, as finely cut.
fn low_poly_tree(trunk_radius: f64) -> Foliage {
    let mut wood = Foliage::default();
    for (height, radius) in [(8.0, 3.0), (12.0, 2.0)] {
        let ball = ball(height * DVec3::Y, radius);
        wood.push_leaf(&ball, None).unwrap();
    }
    let trunk = ball(DVec3::ZERO, 1.0).into_iter().map(|triangle| {
        let on_trunk =
            |at: DVec3| DVec3::new(trunk_radius * at.x, 3.0 + 3.0 * at.y, trunk_radius * at.z);
        LeafTriangle::plain(triangle.corners.map(on_trunk))
    });
    wood.push_leaf(&trunk.collect::<Vec<_>>(), None).unwrap();
    wood
}

/// One leaf beside a solid crown changes nothing of how that gets coarser.
#[test]
fn a_solid_crown_beside_a_leaf_gets_coarser_as_without_one() {
    let wood = low_poly_tree(0.2);
    let mut leaves = Foliage::default();
    let leaf = [2.0, 1.0, 0.0].map(|x| DVec3::new(x, 1.0, 1.5 * x * (2.0 - x)));
    leaves
        .push_leaf(&[LeafTriangle::plain(leaf)], None)
        .unwrap();
    let items = leaves.followed_by(&wood).unwrap();
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(&items, &leaves, &wood, &engine).unwrap();
    assert_eq!(
        plant.sharings(&[Sharing::ByNumber]),
        [Sharing::Evenly, Sharing::ByNumber]
    );
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    let budget = Budget {
        triangles: 201,
        sharing: Sharing::Evenly,
    };
    let mut go_on = |_| ControlFlow::Continue(());
    let level = plant.level(budget, &options, &engine, None, &mut go_on);
    let level = level.unwrap();
    assert_eq!(level.leaves.lod.foliage(&leaves), leaves);
    assert_eq!(level.wood, level_of(&wood, 200));
    assert_eq!(
        level.wood_triangles,
        level.wood.foliage(&wood).triangles().len()
    );
}

/// Six times what a closed surface holds.
fn volume(triangles: &[LeafTriangle]) -> f64 {
    let of_triangle = |t: &LeafTriangle| t.corners[0].dot(t.corners[1].cross(t.corners[2]));
    triangles.iter().map(of_triangle).sum::<f64>().abs()
}

/// Corners of a coarser ball are outside of it, else it shrinks; and errors count more where wood is thin, else the
/// trunk is a needle.
#[test]
fn blobs_and_trunk_of_a_low_poly_tree_hold_as_much() {
    let wood = low_poly_tree(0.2);
    let all = wood.triangles().len();
    let left = level_of(&wood, all / 5).foliage(&wood);
    assert!(left.triangles().len() <= all / 5);
    assert_eq!(left.leaves().len(), 3);
    for (piece, least) in [(0, 0.9), (1, 0.9), (2, 0.6)] {
        let piece = LeafId::from_index(piece);
        let share = volume(left.triangles_of(piece)) / volume(wood.triangles_of(piece));
        assert!((least..1.05).contains(&share), "{piece:?}: {share}");
    }
    // No foot sinks into the ground.
    let corners = left.triangles().iter().flat_map(|t| t.corners);
    assert!(corners.map(|c| c.y).fold(f64::INFINITY, f64::min) >= 0.0);
}

/// A ball of fewer triangles is within the ball that it was: as a leaf it grows to the area that it had. What it stands
/// on goes from the ground to it.
#[test]
fn a_crown_keeps_its_area_and_its_trunk() {
    let (wood, leaves) = (low_poly_tree(0.2), Foliage::default());
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(&wood, &leaves, &wood, &engine).unwrap();
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    for triangles in [250, 120] {
        let mut go_on = |_| ControlFlow::Continue(());
        let level = plant.level(triangles, &options, &engine, None, &mut go_on);
        let level = level.unwrap();
        assert!((9 * triangles / 10..=triangles).contains(&level.wood_triangles));
        assert_eq!(level.wood.leaf_count(), 3, "of {triangles} triangles");
        let left = level.wood.foliage(&wood);
        for (number, (made, _)) in level.wood.made().enumerate() {
            let of_piece = LeafId::from_index(number);
            let corners = left.triangles_of(of_piece).iter().flat_map(|t| t.corners);
            let low = corners.clone().map(|at| at.y).fold(f64::INFINITY, f64::min);
            let high = corners.map(|at| at.y).fold(f64::NEG_INFINITY, f64::max);
            let share = left.leaf(of_piece).area() / wood.leaf(made.donor).area();
            match made.donor.index() {
                2 => assert!(low < 0.1 && high > 5.5, "a trunk from {low} to {high}"),
                _ => assert!(share > 0.97, "a ball of {share} of {triangles} triangles"),
            }
        }
    }
}

/// Of a palette texture each face, or each row of them, has a colour of its own, and no face may have any between.
#[test]
fn faces_keep_the_colours_of_a_palette() {
    let colour = |number: usize| DVec2::new((number % 16) as f64, (number / 16) as f64) / 16.0;
    let of_faces = ball(DVec3::ZERO, 1.0).into_iter().enumerate();
    let of_rows = sheet(0.0).into_iter().enumerate();
    // Two triangles a quad, ten quads a row.
    let of_rows = of_rows.map(|(face, triangle)| (face / 20, triangle));
    let plants: [Vec<(usize, LeafTriangle)>; 2] = [of_faces.collect(), of_rows.collect()];
    for (plant, triangles) in plants.into_iter().zip([60, 8]) {
        let coloured = plant.into_iter().map(|(number, triangle)| LeafTriangle {
            uvs: [colour(number); 3],
            ..triangle
        });
        let mut wood = Foliage::default();
        wood.push_leaf(&coloured.collect::<Vec<_>>(), None).unwrap();
        let left = level_of(&wood, triangles).foliage(&wood);
        let count = left.triangles().len();
        assert!(count > triangles / 2 && count <= triangles, "{count}");
        for triangle in left.triangles() {
            assert_eq!(triangle.uvs, [triangle.uvs[0]; 3]);
        }
    }
}

#[test]
fn all_of_it_may_stay() {
    let (wood, leaves) = (snowman(), Foliage::default());
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(&wood, &leaves, &wood, &engine).unwrap();
    let options = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    let mut go_on = |_| ControlFlow::Continue(());
    let level = plant.simplified(&options, &engine, &mut go_on).unwrap();
    assert_eq!(level.wood_triangles, 528);
}

/// A tube of six sides that gets thinner, of eight rings.
fn bough(from: DVec3, to: DVec3, radius: f64) -> Vec<LeafTriangle> {
    const SIDES: usize = 6;
    const RINGS: usize = 8;
    let across = (to - from).normalize().any_orthonormal_vector();
    let beside = (to - from).normalize().cross(across);
    let place = |ring: usize, side: usize| {
        let (sin, cos) = (TAU * (side % SIDES) as f64 / SIDES as f64).sin_cos();
        let share = ring as f64 / RINGS as f64;
        let round = radius * (1.0 - 0.7 * share) * (cos * across + sin * beside);
        from.lerp(to, share) + round + 0.05 * (6.0 * share).sin() * DVec3::X
    };
    let quads = (0..RINGS).flat_map(|i| (0..SIDES).map(move |k| (i, k)));
    let triangles = quads.flat_map(|(i, k)| {
        let [a, b] = [place(i, k), place(i, k + 1)];
        let [c, d] = [place(i + 1, k), place(i + 1, k + 1)];
        [[a, b, d], [a, d, c]]
    });
    triangles.map(LeafTriangle::plain).collect()
}

/// Boughs on a trunk, and twigs on the boughs. Collapses over all of them know nothing of what grows on what.
#[test]
fn nothing_of_a_bare_tree_hangs_in_the_air() {
    let mut wood = Foliage::default();
    let trunk = bough(DVec3::ZERO, 8.0 * DVec3::Y, 0.3);
    wood.push_leaf(&trunk, None).unwrap();
    for k in 0..12 {
        let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
        let out = DVec3::new(cos, 0.6, sin);
        let from = (2.0 + 0.45 * f64::from(k)) * DVec3::Y;
        let tip = from + 2.5 * out;
        wood.push_leaf(&bough(from, tip, 0.08), None).unwrap();
        for (share, side) in [
            (0.5, 1.0),
            (0.6, -1.0),
            (0.7, 1.0),
            (0.8, -1.0),
            (0.95, 1.0),
        ] {
            let from = from.lerp(tip, share);
            let to = from + 0.8 * (out + side * DVec3::new(-sin, 0.3, cos));
            wood.push_leaf(&bough(from, to, 0.02), None).unwrap();
        }
    }
    for triangles in [1200, 600, 400, 300, 250, 200, 150, 100] {
        let left = level_of(&wood, triangles).foliage(&wood);
        assert!(left.triangles().len() <= triangles);
        // A third of the trunk's thickness, of which a trunk of three sides has lost some.
        let gap = wood_gaps(&left).into_iter().fold(0.0, f64::max);
        assert!(gap < 0.2, "{gap} with {triangles} triangles");
    }
}
