use std::ops::ControlFlow;

use proptest::prelude::*;
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::ViewSet;

use super::super::{Objective, fit};
use secateur_model::{Budget, Foliage, Lod};
use secateur_raster::{Scene, cpu};

use super::*;

fn crown(leaves: u32, seed: u64) -> Foliage {
    ellipsoid_crown(leaves, seed, &EllipsoidCrown::default()).unwrap()
}

/// Every `every`-th leaf, its area multiplied.
fn thinned(foliage: &Foliage, every: usize, area_scale: f64) -> Foliage {
    let mut lod = Lod::original(foliage.leaves().len());
    for index in 0..foliage.leaves().len() {
        let leaf = LeafId::from_index(index);
        match index % every {
            0 => lod.resize(leaf, area_scale),
            _ => lod.remove(leaf),
        }
    }
    lod.foliage(foliage)
}

fn of<'a>(original: &'a Foliage, left: &'a Foliage, views: &'a [ViewSet]) -> Fit<'a> {
    Fit {
        occluders: None,
        original,
        left,
        views,
        resolution: 61,
        objective: Objective::Coverage,
    }
}

fn views_of(original: &Foliage) -> [ViewSet; 1] {
    [ViewSet::cuboctahedron(original.bounding_sphere().unwrap())]
}

/// What is found in pictures alone is what the lists say, also where something hides leaves.
#[test]
fn pictures_say_whether_there_is_nothing_to_gain() {
    let original = crown(80, 3);
    let before = crown(15, 9);
    let mut said = [0; 2];
    for gone in [0, 40, 20, 10, 5, 3, 2] {
        let mut lod = Lod::original(80);
        for index in 0..gone {
            lod.remove(LeafId::from_index(index));
        }
        let left = lod.foliage(&original);
        let views = views_of(&original);
        for occluders in [None, Some(&before)] {
            let way = Fit {
                occluders,
                ..of(&original, &left, &views)
            };
            let originals = way.draw_originals().unwrap();
            let trial = Coverage::new(&way, &mut Budget::unlimited(), Some(&originals)).unwrap();
            let is_there_nothing = trial.is_there_nothing_to_gain();
            assert_eq!(way.covers_alike(&originals), is_there_nothing, "{gone}");
            said[usize::from(is_there_nothing)] += 1;
        }
    }
    assert!(said[0] > 2 && said[1] > 2, "{said:?}");
}

fn fitted(original: &Foliage, left: &Foliage) -> Vec<f64> {
    let views = views_of(original);
    match fit(&of(original, left, &views), &mut |_, _| {
        ControlFlow::Continue(())
    }) {
        ControlFlow::Continue(factors) => factors,
        ControlFlow::Break(()) => panic!("nobody broke it off"),
    }
}

/// Which pixels of the views show a leaf of these sizes, drawn from scratch.
fn covered(foliage: &Foliage, factors: &[f64], views: &ViewSet) -> Vec<Vec<bool>> {
    let mut lod = Lod::original(foliage.leaves().len());
    for (index, factor) in factors.iter().enumerate() {
        lod.resize(LeafId::from_index(index), *factor);
    }
    let scene = Scene {
        foliage,
        lod: &lod,
        views,
        resolution: 61,
    };
    let images = views
        .views()
        .iter()
        .map(|v| cpu::draw_leaf_ids(&scene, v).leaf_ids);
    images
        .map(|ids| ids.iter().map(|leaf| *leaf != 0).collect())
        .collect()
}

/// J as its formula says, everything drawn.
fn objective_drawn(original: &Foliage, left: &Foliage, factors: &[f64]) -> i128 {
    let [views] = views_of(original);
    let [then, now] = [
        covered(original, &[], &views),
        covered(left, factors, &views),
    ];
    let (mut errors, mut original_px) = (Errors::default(), 0);
    for (then, now) in then.iter().zip(&now) {
        let mut excess_px = [[0i64; 8]; 8];
        for pixel in 0..61 * 61 {
            let [then, now] = [then[pixel], now[pixel]].map(i64::from);
            excess_px[pixel / 61 / 8][pixel % 61 / 8] += now - then;
            errors.outline_px += (now - then).abs();
            original_px += then;
        }
        let blocks = excess_px.iter().flatten();
        errors.excess_px += blocks.clone().sum::<i64>();
        errors.blocks_px += blocks.map(|e| e.abs()).sum::<i64>();
    }
    let beyond = (errors.excess_px.abs() - original_px / 64).max(0);
    i128::from(2 * errors.blocks_px + errors.outline_px + 3 * beyond)
}

#[test]
fn what_is_as_it_was_stays() {
    let original = crown(120, 1);
    assert_eq!(fitted(&original, &original), vec![1.0; 120]);
    assert_eq!(fitted(&original, &Foliage::default()), Vec::<f64>::new());
}

#[test]
fn leaves_of_another_size_get_their_own_back() {
    let original = crown(1, 5);
    for (area_scale, expected) in [(2.0, 0.5), (0.25, 4.0)] {
        let factors = fitted(&original, &thinned(&original, 1, area_scale));
        assert!((factors[0] / expected - 1.0).abs() < 0.25, "{factors:?}");
    }
}

/// A crown that is too thin, and one that is too dense, have the coverage of the original
/// in views in which they were not fitted.
#[test]
fn a_crown_is_as_dense_as_it_was_in_other_views() {
    let original = crown(900, 3);
    let other = ViewSet::icosahedron(original.bounding_sphere().unwrap());
    let count = |foliage: &Foliage, factors: &[f64]| {
        let views = covered(foliage, factors, &other);
        views.iter().flatten().filter(|is| **is).count() as f64
    };
    let wanted = count(&original, &[]);
    for area_scale in [2.0, 5.0] {
        let left = thinned(&original, 4, area_scale);
        let [before, after] =
            [vec![1.0; 225], fitted(&original, &left)].map(|f| count(&left, &f) / wanted);
        assert!((before - 1.0).abs() > 0.08, "{before}");
        assert!((after - 1.0).abs() < 0.03, "{before} {after}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let original = crown(300, 7);
    let left = thinned(&original, 3, 3.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| fitted(&original, &left))
    };
    assert_eq!(on(1), on(3));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// What is kept up to date is what is drawn anew, after every batch; and it never gets
    /// worse.
    #[test]
    fn the_errors_are_true(seed in 0u64..1000, every in 1usize..5, scale in 0.3..6.0f64) {
        let original = crown(90, seed);
        let left = thinned(&original, every, scale);
        let views = views_of(&original);
        let mut trial = Coverage::new(&of(&original, &left, &views), &mut Budget::unlimited(), None).unwrap();
        let mut last = trial.objective();
        prop_assert_eq!(last, objective_drawn(&original, &left, &trial.scales));
        // All leaves at once see nothing of each other, and are often undone together.
        for (factor, step) in [(6.0, 1), (2.0, 1), (1.3, 2)] {
            let members: Vec<usize> = (0..trial.scales.len()).step_by(step).collect();
            trial.try_batch(&members, factor);
            prop_assert!(trial.objective() <= last);
            last = trial.objective();
            prop_assert_eq!(last, objective_drawn(&original, &left, &trial.scales));
        }
    }

    /// What is foreseen of one leaf is what comes of it.
    #[test]
    fn an_effect_is_what_happens(seed in 0u64..1000, to in 0.2..5.0f64) {
        let original = crown(60, seed);
        let left = thinned(&original, 2, 2.0);
        let views = views_of(&original);
        let mut trial = Coverage::new(&of(&original, &left, &views), &mut Budget::unlimited(), None).unwrap();
        let leaf = LeafId::from_index(seed as usize % 30);
        let effects = trial.views.iter_mut().map(|v| v.effects(leaf, [to, 1.0])[0]);
        let effects: Vec<Effect> = effects.collect();
        let foreseen = effects.iter().fold(trial.errors, |sum, e| sum.plus(e.errors));
        trial.with_views(|view| view.try_out(&[Change { leaf, to }]));
        prop_assert_eq!(trial.errors, foreseen);
        let mut scales = trial.scales.clone();
        scales[leaf.index()] = to;
        prop_assert_eq!(trial.objective(), objective_drawn(&original, &left, &scales));
        trial.with_views(CoveredView::take_back);
        prop_assert_eq!(trial.objective(), objective_drawn(&original, &left, &trial.scales));
    }
}
