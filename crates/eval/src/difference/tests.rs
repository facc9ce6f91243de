use glam::{DVec3, Vec3};
use secateur_model::{AlphaMode, Finish, Material};
use secateur_raster::ViewSet;

use super::*;

fn surface(color: [f32; 3], quads: &[[DVec3; 4]]) -> Surface {
    let [r, g, b] = color;
    Surface {
        positions: quads.concat(),
        normals: vec![Vec3::Y; 4 * quads.len()],
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: (0..quads.len() as u32)
            .flat_map(|k| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| 4 * k + c)))
            .collect(),
        material: Arc::new(Material {
            name: String::new(),
            base_color: [r, g, b, 1.0],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            finish: Finish::default(),
        }),
    }
}

/// Leaves of side .2 on five shelves, every `step`th of a hundred.
fn leaves(color: [f32; 3], step: usize) -> Surface {
    let leaf = |k: usize| {
        let (shelf, place) = (k / 20, k % 20);
        let angle = 2.4 * place as f64 + shelf as f64;
        let reach = 0.3 + 0.03 * place as f64;
        let centre = DVec3::new(
            reach * angle.sin(),
            0.8 + 0.25 * shelf as f64,
            reach * angle.cos(),
        );
        let (x, y) = (
            DVec3::new(angle.cos(), 0.3, -angle.sin()) * 0.1,
            DVec3::new(0.0, 0.9, 0.3) * 0.1,
        );
        [
            centre - x - y,
            centre + x - y,
            centre + x + y,
            centre - x + y,
        ]
    };
    let all: Vec<[DVec3; 4]> = (0..100).step_by(step).map(leaf).collect();
    surface(color, &all)
}

/// A trunk of two crossed strips, 2 high.
fn trunk(width: f64) -> Surface {
    let strip = |x: DVec3| {
        let up = DVec3::Y * 2.0;
        [-x, x, x + up, -x + up]
    };
    let (x, z) = (DVec3::X * width / 2.0, DVec3::Z * width / 2.0);
    surface([0.2, 0.1, 0.05], &[strip(x), strip(z)])
}

fn moved(surfaces: &[Surface], scale: f64, by: DVec3) -> Vec<Surface> {
    let mut moved = surfaces.to_vec();
    for position in moved.iter_mut().flat_map(|s| &mut s.positions) {
        *position = *position * scale + by;
    }
    moved
}

const GREEN: [f32; 3] = [0.1, 0.35, 0.05];

fn judged(original: &[Surface], level: &[Surface], pixels_high: f64) -> Difference {
    let judge = DifferenceJudge::new(original.to_vec(), &[true, false, true, false]);
    judge.difference(level, pixels_high, ViewCount::All)
}

#[test]
fn a_plant_does_not_differ_from_itself_and_no_plant_is_another() {
    let plant = [trunk(0.1), leaves(GREEN, 1)];
    assert_eq!(judged(&plant, &plant, 200.0), Difference::default());
    let nothing = judged(&plant, &[], 200.0);
    assert!(nothing.difference > 0.5, "{nothing:?}");
    assert_eq!(nothing.block_coverage, 1.0);
    // Nothing of nothing is all of it.
    assert_eq!(judged(&[], &[], 200.0), Difference::default());
}

#[test]
fn more_that_is_gone_differs_more() {
    let plant = [trunk(0.1), leaves(GREEN, 1)];
    let of = |step: usize| judged(&plant, &[trunk(0.1), leaves(GREEN, step)], 200.0).difference;
    let [half, most] = [2, 10].map(of);
    assert!(0.05 < half && half < most, "{half} {most}");
}

/// A mean over a pale frame lets a white plant lose what a dark one may not. Here the worse background counts.
#[test]
fn what_is_gone_counts_whatever_its_colour() {
    let of = |color: [f32; 3]| {
        let plant = [trunk(0.1), leaves(color, 1)];
        judged(&plant, &[trunk(0.1), leaves(color, 4)], 200.0).difference
    };
    let all = [GREEN, [0.02, 0.05, 0.02], [0.9; 3], [0.0; 3]].map(of);
    let [least, most] = [f64::min, f64::max].map(|pick| all.into_iter().reduce(pick).unwrap());
    assert!(least > 0.3 && most < 2.0 * least, "{all:?}");
}

#[test]
fn units_and_places_do_not_matter() {
    let plant = [trunk(0.1), leaves(GREEN, 1)];
    let level = [trunk(0.1), leaves(GREEN, 3)];
    let here = judged(&plant, &level, 150.0);
    for (scale, by) in [(100.0, DVec3::ZERO), (0.01, DVec3::new(7.0, -2.0, 1.0))] {
        let there = judged(&moved(&plant, scale, by), &moved(&level, scale, by), 150.0);
        let ratio = there.difference / here.difference;
        assert!((ratio - 1.0).abs() < 0.02, "{here:?} {there:?}");
    }
}

/// Plants that stand apart are as large on the screen as one alone, and the worst of them speaks.
#[test]
fn plants_that_stand_apart_are_judged_each_alone() {
    let plant = [trunk(0.1), leaves(GREEN, 1)];
    let level = [trunk(0.1), leaves(GREEN, 3)];
    let alone = judged(&plant, &level, 150.0);
    let row = |of: [&[Surface]; 2]| {
        let [first, second] = of;
        [first.to_vec(), moved(second, 1.0, DVec3::X * 4.0)].concat()
    };
    let originals = row([&plant, &plant]);
    let judge = DifferenceJudge::new(originals.clone(), &[true, false, true, false]);
    assert_eq!(judge.plant_count(), 2);
    assert!((judge.size() / DifferenceJudge::new(plant.to_vec(), &[]).size() - 1.0).abs() < 0.05);
    let one = DifferenceJudge::of_one_plant(originals.clone(), &[true, false, true, false]);
    assert_eq!(one.plant_count(), 1);
    assert!(one.size() > 1.5 * judge.size());
    for levels in [row([&plant, &level]), row([&level, &plant])] {
        let worst = judge.difference(&levels, 150.0, ViewCount::All).difference;
        assert!(
            (worst / alone.difference - 1.0).abs() < 0.1,
            "{worst} {alone:?}"
        );
    }
    // Shoots that stand close are one plant.
    let close = [plant.to_vec(), moved(&plant, 1.0, DVec3::X * 1.6)].concat();
    assert_eq!(DifferenceJudge::new(close, &[]).plant_count(), 1);
}

/// Boughs within a crown are few pixels: without them little differs but what is wood.
#[test]
fn wood_within_a_crown_counts_by_itself() {
    let leaves = leaves(GREEN, 1);
    let trunk = Surface {
        material: Arc::clone(&leaves.material),
        ..trunk(0.06)
    };
    let plant = [trunk, leaves.clone()];
    let level = [leaves];
    let known = judged(&plant, &level, 200.0);
    let judge = DifferenceJudge::new(plant.to_vec(), &[]);
    let unknown = judge.difference(&level, 200.0, ViewCount::All);
    assert_eq!(unknown.worst_wood, 0.0);
    assert!(known.worst_wood > 0.5, "{known:?}");
    assert_eq!(known.worst_block, unknown.worst_block);
}

/// Who is certain to be beyond the limits is looked at from fewer views; who is within them from all.
#[test]
fn few_views_are_enough_to_refuse() {
    let plant = [trunk(0.1), leaves(GREEN, 1)];
    let level = [trunk(0.1), leaves(GREEN, 3)];
    let judge = DifferenceJudge::new(plant.to_vec(), &[]);
    let all = judge.difference(&level, 150.0, ViewCount::All);
    let within = |difference: f64| {
        let limits = Limits {
            difference,
            block_coverage: f64::INFINITY,
        };
        judge.difference_within(&level, 150.0, ViewCount::All, limits)
    };
    assert_eq!(within(all.difference), all);
    let refused = within(0.1 * all.difference);
    assert!(refused.difference > 0.1 * all.difference && refused != all);
}

/// No view that judges stands within five degrees of one that drives by default.
#[test]
fn no_view_drives() {
    let sphere = BoundingSphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    };
    let driving = ViewSet::dodecahedron(sphere);
    for (number, view) in VIEWS.into_iter().enumerate() {
        let eye = Eye::about(number, view, sphere, RADII).at.normalize();
        let degrees = |view: &View| view.eye().normalize().angle_between(eye).to_degrees();
        let nearest = driving.views().iter().map(degrees).fold(180.0, f64::min);
        assert!(nearest > 5.0, "{number}: {nearest}");
    }
}

/// A search comes back to its largest pictures after small ones; of pictures as large only the last are kept.
#[test]
fn pictures_are_kept_as_long_as_they_are_not_too_many() {
    let judge = DifferenceJudge::new(vec![trunk(0.1)], &[true]);
    let kept = || {
        let drawn = judge.drawn.lock().unwrap();
        let heights: Vec<f64> = drawn.iter().map(|at| at.pixels_high).collect();
        heights
    };
    for px in [1080.0, 540.0, 270.0, 135.0, 64.0, 32.0, 16.0] {
        judge.difference(&[], px, ViewCount::Glance);
    }
    assert_eq!(kept(), [16.0, 32.0, 64.0, 135.0, 270.0, 540.0, 1080.0]);
    let views = judge.drawn.lock().unwrap()[0].pictures.len();
    assert_eq!(views, GLANCE_VIEWS);
    for px in [2000.0, 3000.0] {
        judge.difference(&[], px, ViewCount::Glance);
    }
    assert_eq!(kept(), [3000.0, 2000.0]);
}

#[test]
fn what_is_thinner_than_a_pixel_is_thin() {
    let is_thin = |width: f64, pixels_high: f64| {
        let judge = DifferenceJudge::new(vec![trunk(width)], &[true]);
        judge.is_thin(pixels_high)
    };
    // A pixel is a tenth, an eightieth and a tenth high.
    assert!(is_thin(0.03, 20.0) && !is_thin(0.1, 160.0));
    assert!(!is_thin(1.0, 20.0));
}

/// Fruits of side .1 before and behind the leaves, every `step`th of twelve.
fn fruits(step: usize) -> Surface {
    let fruit = |k: usize| {
        let angle = 0.52 * k as f64;
        let centre = DVec3::new(angle.sin(), 0.8 + 0.09 * k as f64, angle.cos());
        let (x, y) = (
            DVec3::new(angle.cos(), 0.0, -angle.sin()) * 0.05,
            DVec3::Y * 0.05,
        );
        [
            centre - x - y,
            centre + x - y,
            centre + x + y,
            centre - x + y,
        ]
    };
    let all: Vec<[DVec3; 4]> = (0..12).step_by(step).map(fruit).collect();
    surface([0.6, 0.02, 0.02], &all)
}

#[test]
fn fruits_that_are_gone_count_by_themselves() {
    let leaves = [leaves(GREEN, 1), leaves(GREEN, 1)];
    let all = [&leaves[..], &[fruits(1)]].concat();
    let fewer = [&leaves[..], &[fruits(2)]].concat();
    let judge = DifferenceJudge::new(all.clone(), &[]);
    let of = |level: &[Surface], pixels_high| judge.difference(level, pixels_high, ViewCount::All);
    let seen = of(&fewer, 400.0);
    assert!(seen.worst_wood > 2.0 * seen.worst_block, "{seen:?}");
    assert_eq!(of(&all, 400.0).worst_wood, 0.0);
    assert_eq!(of(&fewer, 40.0).worst_wood, 0.0, "fruits of a pixel");
}
