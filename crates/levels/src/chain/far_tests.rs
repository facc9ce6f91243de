//! Levels of few pixels: what stands there, and what it costs.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;
use secateur_eval::Limits;
use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, Document, WholeTree, surfaces_to_glb};
use secateur_model::{AlphaMode, Filters, NormalMap, Surface, Texture, Wrap};
use secateur_plant::{GrowOptions, Species};
use secateur_raster::OpenEngine;

use super::tests::{go_on, grown, grown_from, options};
use super::*;
use crate::impostor::Choice;
use crate::impostor::fewest_cards::{self, Search, Seen};

/// Heights of a plant that is far, in pixels.
const FAR: [f64; 3] = [64.0, 32.0, 16.0];

fn far_options() -> ChainOptions {
    ChainOptions {
        wanted: Wanted::Heights(FAR.to_vec()),
        max_difference: 0.7,
        original: true,
        cost: CostWeights::default(),
        ..options(&[])
    }
}

fn impostors(options: &ChainOptions) -> Vec<ChainLevel> {
    impostors_of(120, options)
}

fn impostors_of(leaves: u32, options: &ChainOptions) -> Vec<ChainLevel> {
    let tree = grown(Species::Oak, leaves);
    let made = chain(&tree, options, &OpenEngine::cpu(), &mut go_on).unwrap();
    let is_impostor = |level: &ChainLevel| level.kind == LevelKind::Impostor;
    made.levels.into_iter().filter(is_impostor).collect()
}

/// In a chain for heights, too, and with no more triangles than pixels that the plant covers.
#[test]
fn cards_stand_for_a_plant_of_few_pixels() {
    let options = far_options();
    let made = impostors(&options);
    assert!(!made.is_empty());
    let tree = grown(Species::Oak, 120);
    let engine = OpenEngine::cpu();
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    for level in &made {
        assert!(FAR.contains(&level.pixels_high));
        assert!(level.triangles as f64 <= maker.look.covered_px(level.pixels_high));
        assert!(level.difference.over(options.limits()) <= 1.0);
    }
    let bytes: u64 = made.iter().map(|level| level.texture_bytes).sum();
    assert!(bytes > 0 && bytes <= 1 << 20, "{bytes}");
}

/// Leaves hide that cards are torn: without them people tell it at a difference that would do for a mesh.
#[test]
fn cards_of_a_plant_without_leaves_to_speak_of_look_nearer() {
    let options = ChainOptions {
        max_difference: 0.45,
        ..far_options()
    };
    let farthest = |leaves| {
        let made = impostors_of(leaves, &options);
        let differences = made.iter().map(|level| level.difference.difference);
        differences.fold(0.0, f64::max)
    };
    let for_surfaces = options.max_difference * 0.18 / 0.28;
    let [of_many, of_few] = [120, 40].map(farthest);
    assert!(of_many > for_surfaces, "{of_many}");
    assert!(of_few <= for_surfaces, "{of_few}");
}

/// Without mip maps the leaves of this rowan's own texture are near enough, of which clients show a tenth.
#[test]
fn levels_of_few_pixels_do_not_fade_in_clients() {
    let options = ChainOptions {
        wanted: Wanted::Heights(HEIGHTS_PX[3..6].to_vec()),
        max_difference: 0.28,
        impostor: Some(Choice::None),
        original: true,
        ..options(&[])
    };
    let leaves = 400;
    let rowan = grown_from(Species::Rowan, GrowOptions { leaves, seed: 2 });
    let made = chain(&rowan, &options, &OpenEngine::cpu(), &mut go_on).unwrap();
    let last = made.levels.last().unwrap();
    assert_eq!(last.pixels_high, 32.0);
    let shown = last.as_drawn.unwrap().begin.coverage_over_truth;
    assert!((0.5..1.5).contains(&shown), "{shown}");
}

#[test]
fn impostors_keep_the_bound_of_their_textures() {
    let bounded = |bytes| ChainOptions {
        impostor_texture_bytes: Some(bytes),
        ..far_options()
    };
    assert!(impostors(&bounded(1_000)).is_empty());
    let most = 40_000;
    let bytes = impostors(&bounded(most))
        .iter()
        .map(|level| level.texture_bytes)
        .sum::<u64>();
    assert!(bytes <= most, "{bytes}");
}

/// A further level of cards saves a third of what is dear; where only draws are, none does, as each is drawn at once.
#[test]
fn a_further_impostor_pays_by_what_is_dear() {
    let dear = |cost: &str| {
        let mut made = impostors(&ChainOptions {
            cost: cost.parse().unwrap(),
            ..far_options()
        });
        made.retain(|level| level.impostor.as_ref().unwrap().facts["layout"] == "cards");
        made
    };
    let by_bytes = dear("triangle=0,draw=0,disk-kib=0,gpu-kib=1");
    for pair in by_bytes.windows(2) {
        let [before, after] = [0, 1].map(|k| pair[k].texture_bytes + 70 * pair[k].triangles);
        assert!(3 * after <= 2 * before, "{after} after {before}");
    }
    assert_eq!(dear("triangle=0,draw=1,disk-kib=0,gpu-kib=0").len(), 1);
}

#[test]
fn usual_heights_end_where_a_plant_is_a_block() {
    let usual = |height_px| {
        let mut options = ChainOptions::default();
        options.screen.height_px = height_px;
        options.heights_px()
    };
    assert_eq!(usual(1080.0), HEIGHTS_PX);
    assert_eq!(usual(16.0), [16.0, 8.0]);
    assert_eq!(usual(480.0).last(), Some(&(32.0 * 480.0 / 1080.0)));
}

/// A log of 16 triangles in four draws, without textures: 32 triangles with a picture, in one draw, would cost less.
#[test]
fn no_impostor_has_more_triangles_and_more_textures_than_the_plant() {
    let oak = grown(Species::Oak, 1);
    let bark = oak.items().drawn(Detail::Color).unwrap().swap_remove(0);
    let side = |k: usize| {
        let color = [0.4 + 0.1 * k as f32, 0.3, 0.2, 1.0];
        let mut side = Surface::empty(Arc::clone(&bark.surface.material));
        let material = Arc::make_mut(&mut side.material);
        (material.base_color, material.texture) = (color, None);
        (material.alpha_mode, material.double_sided) = (AlphaMode::Opaque, true);
        let corner = |turn: usize, x: f64| {
            let angle = TAU * turn as f64 / 8.0;
            DVec3::new(x, 0.2 + 0.2 * angle.sin(), 0.2 * angle.cos())
        };
        for turn in [2 * k, 2 * k + 1] {
            let first = side.positions.len() as u32;
            let corners = [(turn, 0.0), (turn, 1.0), (turn + 1, 0.0), (turn + 1, 1.0)];
            let corners = corners.map(|(turn, x)| corner(turn, x));
            side.positions.extend(corners);
            let quad = [[0, 1, 2], [2, 1, 3]];
            side.triangles.extend(quad.map(|t| t.map(|c| c + first)));
        }
        (side, false)
    };
    let glb = surfaces_to_glb("log", &[0, 1, 2, 3].map(side));
    let document = Document::from_bytes("log.glb", glb, None).unwrap();
    let tree = document.into_whole_tree(&[]).unwrap();
    let options = ChainOptions {
        max_difference: 0.28,
        ..far_options()
    };
    let made = chain(&tree, &options, &OpenEngine::cpu(), &mut go_on).unwrap();
    let triangles = made.levels.iter().map(|level| level.triangles);
    assert_eq!(triangles.max(), Some(16));
}

/// A row of low-poly firs, solid and without leaves; and how many triangles it has.
fn firs(count: u32) -> (WholeTree, u64) {
    let oak = grown(Species::Oak, 1);
    let bark = oak.items().drawn(Detail::Color).unwrap().swap_remove(0);
    let mut firs = Surface::empty(Arc::clone(&bark.surface.material));
    let material = Arc::make_mut(&mut firs.material);
    (material.base_color, material.texture) = ([0.1, 0.4, 0.1, 1.0], None);
    (material.alpha_mode, material.double_sided) = (AlphaMode::Opaque, true);
    for (fir, tier) in (0..count).flat_map(|fir| [0, 1, 2].map(|tier| (fir, tier))) {
        let (foot, first) = (f64::from(tier), firs.positions.len() as u32);
        let middle = DVec3::new(0.3 * f64::from(fir % 3), foot, 0.6 * f64::from(fir));
        let rim = (0..8).map(|k| {
            let angle = TAU * f64::from(k) / 8.0;
            middle + (1.2 - 0.3 * foot) * DVec3::new(angle.sin(), 0.0, angle.cos())
        });
        firs.positions.extend([middle + 1.6 * DVec3::Y, middle]);
        firs.positions.extend(rim);
        for k in 0..8 {
            let [a, b] = [first + 2 + k, first + 2 + (k + 1) % 8];
            firs.triangles.extend([[first, a, b], [first + 1, b, a]]);
        }
    }
    let triangles = firs.triangles.len() as u64;
    let glb = surfaces_to_glb("firs", &[(firs, false)]);
    let document = Document::from_bytes("firs.glb", glb, None).unwrap();
    (document.into_whole_tree(&[]).unwrap(), triangles)
}

/// A row of firs has no mesh of as few triangles as the few pixels that it covers: fewer cards than such a mesh has stand
/// there, though more than pixels.
#[test]
fn cards_stand_where_what_is_drawn_has_more_triangles_than_pixels() {
    let (tree, all) = firs(40);
    let options = ChainOptions {
        max_difference: 0.28,
        ..far_options()
    };
    let engine = OpenEngine::cpu();
    let made = chain(&tree, &options, &engine, &mut go_on).unwrap();
    let last = made.levels.last().unwrap();
    let covered = Maker::new(&tree, &options, &engine)
        .unwrap()
        .look
        .covered_px(last.pixels_high);
    assert_eq!(last.kind, LevelKind::Impostor);
    assert!(last.triangles as f64 > covered && 4 * last.triangles < all);
}

/// Where fewer are allowed than the fewest, there are none.
#[test]
fn no_fewer_cards_than_are_found_would_do() {
    let (tree, _) = firs(40);
    let (engine, options) = (OpenEngine::cpu(), far_options());
    let look = Maker::new(&tree, &options, &engine).unwrap().look;
    let (surfaces, judge) = (&look.original.surfaces, look.judge_of_impostors());
    let mut search = Search::new(surfaces, u64::MAX);
    for difference in [0.15, 0.3] {
        let seen = Seen::new(judge, 32.0, Limits::of_difference(difference));
        let mut fewest = |most| {
            let found = search.fewest(&seen, most, |made| made, &mut go_on);
            Some(found.unwrap()?.impostor.surface.triangles.len() / 2)
        };
        let found = fewest(fewest_cards::most()).unwrap();
        assert_eq!(fewest(found - 1), None, "{found} within {difference}");
    }
}

/// Surfaces may use more of the limits where gaps between cards are less than a pixel.
#[test]
fn cards_of_a_small_solid_plant_may_use_more() {
    let ((tree, _), engine, options) = (firs(1), OpenEngine::cpu(), far_options());
    let look = Maker::new(&tree, &options, &engine).unwrap().look;
    let share = |px| look.limits_of_impostors(px).difference / look.limits.difference;
    let [small, large] = [16.0, 32.0].map(share);
    assert!((small - 0.22 / 0.28).abs() < 1e-9, "{small}");
    assert!((large - 0.18 / 0.28).abs() < 1e-9, "{large}");
}

/// The first level keeps the normal map of its bark, as it is seen from near by; one of few pixels gets a smaller one, and
/// takes less memory.
#[test]
fn far_levels_have_small_normal_maps() {
    const SIDE: u32 = 256;
    let oak = grown(Species::Oak, 120);
    let drawn = oak.items().drawn(Detail::Color).unwrap().into_iter();
    let bent = drawn.map(|drawn| {
        let mut surface = drawn.surface;
        if !drawn.is_foliage {
            let texture = Texture {
                width: SIDE,
                height: SIDE,
                rgba: [128, 128, 255, 255].repeat((SIDE * SIDE) as usize),
                wrap: [Wrap::Repeat; 2],
                filters: Filters::default(),
            };
            let map = NormalMap {
                texture: Arc::new(texture),
                scale: 1.0,
            };
            Arc::make_mut(&mut surface.material).finish.normal_map = Some(map);
        }
        (surface, drawn.is_foliage)
    });
    let glb = surfaces_to_glb("oak", &bent.collect::<Vec<_>>());
    let document = Document::from_bytes("oak.glb", glb, None).unwrap();
    let tree = document.into_whole_tree(&[]).unwrap();
    let options = ChainOptions {
        impostor: Some(Choice::None),
        ..far_options()
    };
    let made = chain(&tree, &options, &OpenEngine::cpu(), &mut go_on).unwrap();
    let has_smaller = |level: &ChainLevel| {
        let is_small = |own: &LevelTexture| own.image.is_some() && own.texture.width <= SIDE / 4;
        level.textures.iter().any(is_small)
    };
    let [_, first, others @ ..] = &made.levels[..] else {
        panic!("the plant and levels of it")
    };
    assert!(!has_smaller(first) && !others.is_empty());
    assert!(others.iter().all(has_smaller));
    let all = with_mips(SIDE);
    assert!(first.texture_bytes >= all && others.iter().all(|level| level.texture_bytes < all));
}

/// Bytes of a square texture with all its mip maps on a GPU.
fn with_mips(side: u32) -> u64 {
    let sides = (0..=side.ilog2()).map(|level| u64::from(side >> level));
    sides.map(|side| 4 * side * side).sum()
}
