//! Which level of which step is found.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use secateur_gltf::{Document, Selector, WholeTree, surfaces_to_glb};
use secateur_model::Surface;
use secateur_plant::{GrowOptions, Species, grow};
use secateur_raster::OpenEngine;

use super::*;
use crate::chain::ChainOptions;
use crate::chain::tests::{go_on, grown, options};

/// Nine fronds around a stem, each an arch of 1,024 triangles; leaves, or solid surface.
fn fronds(are_leaves: bool) -> WholeTree {
    const CELLS: [u32; 2] = [8, 64];
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let mut fronds = Surface::empty(Arc::clone(&oak.wood.material));
    for frond in 0..9 {
        let turn = DMat3::from_rotation_y(TAU * f64::from(frond) / 9.0);
        let first = fronds.positions.len() as u32;
        for row in 0..=CELLS[1] {
            for column in 0..=CELLS[0] {
                let [across, along] = [(column, CELLS[0]), (row, CELLS[1])]
                    .map(|(k, of)| f64::from(k) / f64::from(of));
                let wide = 0.3 * (1.0 - along).max(0.05) * (across - 0.5);
                let at = DVec3::new(wide, 1.0 + along - 1.5 * along * along, 0.1 + along);
                fronds.positions.push(turn * at);
            }
        }
        let corner = |column: u32, row: u32| first + row * (CELLS[0] + 1) + column;
        for (column, row) in (0..CELLS[0]).flat_map(|x| (0..CELLS[1]).map(move |y| (x, y))) {
            let [a, b] = [column, column + 1].map(|column| corner(column, row));
            let [c, d] = [column, column + 1].map(|column| corner(column, row + 1));
            fronds.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Arc::make_mut(&mut fronds.material).double_sided = true;
    let glb = surfaces_to_glb("palm", &[(fronds, are_leaves)]);
    let document = Document::from_bytes("palm.glb", glb, None).unwrap();
    let foliage: Vec<Selector> = are_leaves
        .then(|| "all".parse().unwrap())
        .into_iter()
        .collect();
    document.into_whole_tree(&foliage).unwrap()
}

/// To remove one of nine leaves shows at once; all of them as coarser arches do not.
#[test]
fn few_leaves_of_many_triangles_become_coarser_and_all_stay() {
    let (tree, engine) = (fronds(true), OpenEngine::cpu());
    let options = options(&[20.0]);
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let client = maker.client();
    let mut ladder = Ladder::new(&maker, &client);
    for step in (3..100).step_by(12) {
        let level = ladder.level(step, &mut go_on).unwrap();
        let left = level.leaves.foliage(tree.leaves());
        assert_eq!(left.leaves().len(), 9, "of {} triangles", level.triangles());
    }
}

/// How triangles were shared best at a nearer height is forgotten: far off nothing else would be tried.
#[test]
fn a_plant_without_leaves_shares_evenly_at_first_at_each_height() {
    let (tree, engine) = (fronds(false), OpenEngine::cpu());
    assert!(tree.leaves().leaves().is_empty());
    let options = options(&[20.0]);
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let client = maker.client();
    let mut ladder = Ladder::new(&maker, &client);
    ladder.sharing = 1;
    let found = ladder.lightest(&[16.0], 8.0, (0, true), &mut go_on);
    assert!(found.unwrap().is_some());
    assert!(ladder.made.keys().all(|(_, sharing)| *sharing == 0));
}

/// At some steps another sharing than the first looks best, at some none is within the limits.
#[test]
fn a_step_takes_the_sharing_that_looks_best() {
    let (tree, engine) = (grown(Species::Palmetto, 60), OpenEngine::cpu());
    let options = ChainOptions {
        max_difference: 0.4,
        ..options(&[20.0])
    };
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let client = maker.client();
    let mut ladder = Ladder::new(&maker, &client);
    let goal = ladder.goals.at(60.0);
    let (mut others, mut nones) = (0, 0);
    for step in (64..170).step_by(16) {
        let overs = [0, 1, 2].map(|sharing| {
            ladder.sharing = sharing;
            ladder.over(step, &[60.0], &mut go_on).unwrap()
        });
        ladder.sharing = 0;
        let found = ladder.share_better(&[60.0], step, &mut go_on).unwrap();
        let least = overs[1].min(overs[2]);
        assert_eq!(found, Some(least).filter(|least| *least <= goal));
        match found {
            Some(over) => assert_eq!(overs[ladder.sharing], over),
            None => assert_eq!(ladder.sharing, 0),
        }
        others += usize::from(found.is_some_and(|over| over < overs[0]));
        nones += usize::from(found.is_none());
    }
    assert!(others > 0 && nones > 0, "{others}, {nones}");
}

/// Pictures as large as those of a search show as much; larger ones tell the goal of their height before any level is
/// judged whole.
#[test]
fn a_glance_tells_how_much_more_large_pictures_show() {
    let (tree, engine) = (grown(Species::Palmetto, 60), OpenEngine::cpu());
    let options = options(&[20.0]);
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let client = maker.client();
    let mut ladder = Ladder::new(&maker, &client);
    let usual = ladder.goals.at(700.0);
    let learnt = ladder.learn_goal(&[700.0], 1..200, 60, &mut go_on);
    let step = learnt.unwrap().expect("one that does");
    let drawn = ladder.level(step, &mut go_on).unwrap().drawn.clone();
    let [small, large] = [300.0, 700.0].map(|px| maker.look.times_in_search(&drawn, px));
    assert_eq!(small, Some(1.0));
    let large = large.unwrap();
    assert!(large > 1.0 && large < 1.5, "{large}");
    assert!(ladder.goals.are_known(700.0) && ladder.goals.at(700.0) != usual);
    let again = ladder.learn_goal(&[700.0], 1..200, 60, &mut go_on);
    assert_eq!(again.unwrap(), None, "it is known");
}

#[test]
fn a_step_has_two_per_cent_fewer_triangles() {
    assert_eq!([step_of_share(0.5, 7), step_of_share(1.0, 7)], [39, 7]);
    assert_eq!(step_of_share(2.0 / 3.0, 0), 19);
    let left = |steps: usize| triangles_of(steps, 1_000_000);
    assert_eq!(
        [left(0), left(32), left(STEPS - 1)],
        [1_000_000, 500_000, 977]
    );
}

/// A ball of this many rings, as many sides and such a radius about a point.
fn ball(centre: DVec3, radius: f64, rings: u32, like: &Surface) -> Surface {
    let mut ball = Surface::empty(Arc::clone(&like.material));
    for ring in 0..=rings {
        for side in 0..rings {
            let turn = TAU * f64::from(side) / f64::from(rings);
            let (out, up) = (0.5 * TAU * f64::from(ring) / f64::from(rings)).sin_cos();
            let on_ball = DVec3::new(out * turn.cos(), up, out * turn.sin());
            ball.positions.push(centre + radius * on_ball);
        }
    }
    for (ring, side) in (0..rings).flat_map(|ring| (0..rings).map(move |side| (ring, side))) {
        let corner = |ring: u32, side: u32| ring * rings + side % rings;
        let [a, b] = [side, side + 1].map(|side| corner(ring, side));
        let [c, d] = [side, side + 1].map(|side| corner(ring + 1, side));
        ball.triangles.extend([[a, b, c], [b, d, c]]);
    }
    ball
}

/// A grown tree of one leaf with a ball for a crown.
fn ball_and_leaf() -> WholeTree {
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let high = |surface: &Surface| surface.positions.iter().map(|at| at.y).fold(0.0, f64::max);
    let top = high(&oak.wood);
    let ball = ball(top * DVec3::Y, 0.5 * top, 16, &oak.wood);
    let leaves = format!("material:{}", oak.leaves.material.name);
    let all = [(ball, false), (oak.wood, false), (oak.leaves, true)];
    let document = Document::from_bytes("tree.glb", surfaces_to_glb("tree", &all), None).unwrap();
    document
        .into_whole_tree(&[leaves.parse().unwrap()])
        .unwrap()
}

/// Even collapses bring back what a finer level has lost, so levels that are nested are made without them.
#[test]
fn a_solid_crown_is_collapsed_evenly_unless_levels_are_nested() {
    let (tree, engine) = (ball_and_leaf(), OpenEngine::cpu());
    assert_eq!(tree.leaves().leaves().len(), 1);
    let sharings = |morph: bool| {
        let options = ChainOptions {
            morph,
            ..options(&[20.0])
        };
        let maker = Maker::new(&tree, &options, &engine).unwrap();
        Ladder::new(&maker, &maker.client()).sharings
    };
    let usual = secateur_simplify::Effort::Normal.work().sharings.to_vec();
    assert_eq!(sharings(false), [&[Sharing::Evenly], &usual[..]].concat());
    assert_eq!(sharings(true), usual);
}

/// A bush, a ball of few triangles, with berries that have most of all.
fn bush_with_berries() -> WholeTree {
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let bush = ball(DVec3::Y, 1.0, 8, &oak.wood);
    let mut all = vec![(bush, false)];
    for k in 0..17 {
        let (turn, up) = (2.4 * f64::from(k), f64::from(k) / 8.5 - 0.95);
        let out = (1.0 - up * up).sqrt();
        let at = DVec3::new(out * turn.cos(), 1.0 + up, out * turn.sin());
        all.push((ball(at, 0.04, 4, &oak.wood), false));
    }
    let glb = surfaces_to_glb("bush", &all);
    let document = Document::from_bytes("bush.glb", glb, None).unwrap();
    document.into_whole_tree(&[]).unwrap()
}

/// Even collapses take as much from a bush as from its berries.
#[test]
fn far_off_another_sharing_is_tried_where_the_first_has_no_level() {
    let (tree, engine) = (bush_with_berries(), OpenEngine::cpu());
    let options = ChainOptions {
        max_difference: 0.35,
        ..options(&[20.0])
    };
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let client = maker.client();
    let mut ladder = Ladder::new(&maker, &client);
    let even = ladder.coarsest_so_shared(&[60.0], 50..ladder.steps, (50, None), &mut go_on);
    assert_eq!(even.unwrap(), None);
    let found = ladder.lightest(&[60.0], 30.0, (50, true), &mut go_on);
    assert!(found.unwrap().is_some() && ladder.sharing != 0);
}
