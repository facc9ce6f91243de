//! Chains that end in cards.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};
use secateur_eval::{Difference, DifferenceJudge, ViewCount};
use secateur_gltf::{Detail, Document, WholeTree, plant_to_glb};
use secateur_model::{AlphaMode, BoundingSphere, Material, Surface};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_raster::{OpenEngine, View, ViewSet};
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Effort, Error, Options, Preset, Progress, Target};

use super::cards::CardSearch;
use super::impostors::PlacedImpostor;
use super::level_surfaces::{LevelSurfaces, retextured};
use super::look::{Drawn, LevelPicture};
use super::placed::{Place, Placed};
use super::textures::end_of;
use super::*;
use crate::impostor::cards::{Cards, Texels};
use crate::impostor::{Choice, Impostor};
use secateur_runtime::Screen;

/// A grown oak that is quick to simplify.
fn oak() -> WholeTree {
    grown(Species::Oak, 120)
}

/// A grown plant of a species with this number of leaves.
pub(super) fn grown(species: Species, leaves: u32) -> WholeTree {
    grown_from(species, GrowOptions { leaves, seed: 5 })
}

pub(super) fn grown_from(species: Species, options: GrowOptions) -> WholeTree {
    let plant = plant_to_glb(&grow(species, &options).unwrap());
    let document = Document::from_bytes("grown.glb", plant, None).unwrap();
    document.into_whole_tree(&[]).unwrap()
}

fn engine() -> OpenEngine {
    OpenEngine::cpu()
}

/// Levels for distances, with whatever impostor has fewer triangles.
pub(super) fn options(distances: &[f64]) -> ChainOptions {
    let mut leaves = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    leaves.audit = false;
    leaves.shows_what_is_left = false;
    ChainOptions {
        wanted: Wanted::Distances(distances.to_vec()),
        screen: Screen::default(),
        max_difference: 1.5,
        as_one: false,
        original: false,
        plant_height_m: None,
        leaves,
        wood: WoodMode::Auto,
        impostor: Some(Choice::Auto),
        shadow_steps: 0,
        max_pop: None,
        morph: false,
        textures: Textures::Fit,
        cost: "draw=0,disk-kib=0,gpu-kib=0".parse().unwrap(),
        impostor_texture_bytes: None,
        scene: None,
    }
}

pub(super) fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// What is asked to stop, once, stops the chain: while cards are sought or a mesh is made beside them, and whenever
/// a level is finished.
#[test]
fn a_chain_stops_when_it_is_asked_to() {
    let (tree, engine) = (oak(), engine());
    let mut options = options(&[20.0, 60.0]);
    options.screen.height_px = 270.0;
    let is_impostor = |progress| progress == Progress::Impostor;
    let is_stage = |progress| matches!(progress, Progress::Stage(_));
    let is_end = |progress| progress == Progress::Finish;
    let (mut ends, mut has_impostor) = (0, false);
    let observer = &mut |progress| {
        has_impostor |= is_impostor(progress);
        ends += usize::from(has_impostor && is_end(progress));
        ControlFlow::Continue(())
    };
    let made = chain(&tree, &options, &engine, observer).unwrap();
    // After cards were sought, at least the switch to each level.
    assert!(ends >= made.levels.len(), "{ends}");
    let of_cards = [is_impostor, is_stage].map(|is_last: fn(Progress) -> bool| (is_last, 0));
    let of_ends = (0..ends).map(|before| (is_end as fn(Progress) -> bool, before));
    for (is_last, mut before) in of_cards.into_iter().chain(of_ends) {
        let (mut has_impostor, mut is_over) = (false, false);
        let observer = &mut |progress| {
            assert!(!is_over, "it went on");
            has_impostor |= is_impostor(progress);
            if has_impostor && is_last(progress) {
                is_over = before == 0;
                before = before.saturating_sub(1);
            }
            match is_over {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let made = chain(&tree, &options, &engine, observer);
        let is_stopped = matches!(made, Err(ChainError::Simplify(Error::Stopped)));
        assert!(is_stopped && is_over);
    }
}

/// A mesh of this many triangles, drawn where the plant is at most this many pixels high.
fn mesh(maker: &Maker<'_>, triangles: usize, height: f64) -> Placed {
    let made = maker.level(triangles, &mut go_on).unwrap();
    let place = Place::new([height, end_of(height, None)], false);
    let placed = maker.placed(made, place, &maker.client(), &mut go_on);
    placed.unwrap()
}

/// This number of cards, drawn where the plant is at most this many pixels high.
fn cards(maker: &Maker<'_>, count: usize, height: f64) -> PlacedImpostor {
    let cards = Cards::new(&maker.look.original.surfaces, count);
    let level = ImpostorLevel {
        impostor: Impostor::cards(&cards, height, Texels::up_to(f64::INFINITY, height, false))
            .unwrap(),
        mesh_triangles: 0,
        mesh_difference: 0.0,
        same_cost: None,
    };
    PlacedImpostor {
        difference: maker.seen(height).difference(&level.impostor),
        level,
        begins_px: height,
    }
}

/// The cards that are found for these heights, but for the first, beside meshes.
fn found_cards(maker: &Maker<'_>, meshes: &[Placed], heights: &[f64]) -> Vec<PlacedImpostor> {
    let (client, mut search) = (maker.client(), CardSearch::new(maker));
    let at = (heights, 1..heights.len());
    let found = maker.cards((meshes, true), at, &[], &mut search, &client, &mut go_on);
    found.unwrap()
}

fn of_mesh(mesh: &Placed) -> LevelPicture {
    LevelPicture::Mesh(LevelSurfaces {
        surfaces: retextured(&mesh.made.drawn.level, &mesh.chosen.textures),
        materials: Vec::new(),
    })
}

fn of_cards(cards: &PlacedImpostor) -> LevelPicture {
    LevelPicture::Impostor(cards.level.impostor.clone())
}

/// The difference that is seen where one gives way to the other at this height.
fn pop(maker: &Maker<'_>, before: &LevelPicture, after: &LevelPicture, height: f64) -> f64 {
    maker.look.difference_of_switch(before, after, height)
}

fn heights(maker: &Maker<'_>) -> Vec<f64> {
    maker.heights().iter().map(|(height, _)| *height).collect()
}

fn bounded(max_pop: f64) -> ChainOptions {
    ChainOptions {
        max_pop: Some(max_pop),
        ..options(&DISTANCES)
    }
}

const DISTANCES: [f64; 3] = [20.0, 60.0, 200.0];

#[test]
fn cards_whose_switch_shows_too_much_are_not_chosen() {
    let (tree, engine) = (oak(), engine());
    let free = options(&DISTANCES);
    let maker = Maker::new(&tree, &free, &engine).unwrap();
    let heights = heights(&maker);
    let made = [mesh(&maker, 200, heights[0])];
    let found = |maker: &Maker<'_>| found_cards(maker, &made, &heights);
    let pop_after_mesh = |cards: &PlacedImpostor| {
        pop(
            &maker,
            &of_mesh(&made[0]),
            &of_cards(cards),
            cards.begins_px,
        )
    };
    let all = found(&maker);
    assert_eq!(all[0].begins_px, heights[1], "the first cards stand there");
    // A bound hardly below what the switch to these shows.
    let most = 0.97 * pop_after_mesh(&all[0]);
    let bounded = bounded(most);
    let [later] = &found(&Maker::new(&tree, &bounded, &engine).unwrap())[..] else {
        panic!("farther off cards are within the bound");
    };
    assert_eq!(later.begins_px, heights[2]);
    assert!(pop_after_mesh(later) <= most);
}

/// Where a mesh begins there is a switch in any case: cards that cost less stand in its place. In the place of one that goes
/// on they must save a third.
#[test]
fn cards_need_to_cost_less_than_a_mesh_that_begins_there() {
    let (tree, engine) = (oak(), engine());
    let options = options(&DISTANCES);
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let heights = heights(&maker);
    let first = |made: &[Placed]| {
        let found = found_cards(&maker, made, &heights[..2]);
        let cards = found.first()?;
        Some(cards.level.impostor.surface.triangles.len())
    };
    let near = mesh(&maker, 700, heights[0]);
    let fewest = first(std::slice::from_ref(&near)).unwrap();
    let little_more = fewest + fewest / 6;
    let begins = mesh(&maker, little_more, heights[1]);
    assert!(begins.triangles() > fewest, "{fewest}");
    assert_eq!(first(&[near, begins]), Some(fewest));
    assert_eq!(first(&[mesh(&maker, little_more, heights[0])]), None);
}

/// Cards that go because of the bound leave the meshes in whose place they stood, and others may follow these.
#[test]
fn where_cards_go_for_what_their_switch_shows_the_meshes_stay() {
    let (tree, engine) = (oak(), engine());
    let free = options(&DISTANCES);
    let maker = Maker::new(&tree, &free, &engine).unwrap();
    let heights = heights(&maker);
    let made = [mesh(&maker, 400, heights[0]), mesh(&maker, 250, heights[1])];
    let impostors = [cards(&maker, 8, heights[1]), cards(&maker, 200, heights[2])];
    let [fine, coarse] = [0, 1].map(|k| of_mesh(&made[k]));
    let [few, many] = [0, 1].map(|k| of_cards(&impostors[k]));
    let [to_mesh, to_few] = [&coarse, &few].map(|next| pop(&maker, &fine, next, heights[1]));
    let [to_many, few_to_many] =
        [&coarse, &few].map(|before| pop(&maker, before, &many, heights[2]));
    let ending = |options: &ChainOptions| {
        let maker = Maker::new(&tree, options, &engine).unwrap();
        let mut notes = Vec::new();
        let (made, impostors) = (made.to_vec(), impostors.to_vec());
        let levels = maker.ending(made, impostors, &maker.client(), &mut notes, &mut go_on);
        let levels = levels.unwrap();
        for level in &levels[1..] {
            assert!(level.pop.unwrap() <= options.max_pop.unwrap_or(f64::INFINITY));
        }
        let triangles: Vec<u64> = levels.iter().map(|level| level.triangles).collect();
        (triangles, notes)
    };
    let [of_few, of_many] =
        [0, 1].map(|k| impostors[k].level.impostor.surface.triangles.len() as u64);
    let [of_fine, of_coarse] = [0, 1].map(|k| made[k].triangles() as u64);
    assert_eq!(ending(&free).0, [of_fine, of_few, of_many]);
    // Of a bound below what any switch shows the finest mesh alone is left, and each of the others is named.
    let least = [to_mesh, to_few, to_many, few_to_many]
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let (levels, notes) = ending(&bounded(0.9 * least));
    assert_eq!(levels, [of_fine]);
    for triangles in [of_few, of_many, of_coarse] {
        let left_out = format!("a level of {triangles} triangles is left out");
        assert!(
            notes.iter().any(|note| note.starts_with(&left_out)),
            "{notes:?}"
        );
    }
    // The mesh in whose place the few cards stood is back where the bound lets it be.
    if to_mesh < to_few.min(to_many) {
        let (levels, _) = ending(&bounded((to_mesh + to_few.min(to_many)) / 2.0));
        assert_eq!(levels, [of_fine, of_coarse]);
    }
}

/// What is seen where a level of a whole chain gives way to the next, cards among them, is no more than may be.
#[test]
fn a_chain_with_cards_keeps_the_bound() {
    const MOST: f64 = 1.3;
    let (tree, engine) = (oak(), engine());
    let bounded = bounded(MOST);
    let made = chain(&tree, &bounded, &engine, &mut go_on).unwrap();
    let maker = Maker::new(&tree, &bounded, &engine).unwrap();
    let pictured = |level: &ChainLevel| match &level.shape {
        Shape::Original(lod) | Shape::Mesh(lod) => {
            let document = tree.items().lod_document(lod).unwrap();
            let drawn = Drawn::of(&document).unwrap();
            LevelPicture::Mesh(LevelSurfaces {
                surfaces: retextured(&drawn.level, &level.textures),
                materials: Vec::new(),
            })
        }
        Shape::Impostor(level) => LevelPicture::Impostor(level.impostor.clone()),
    };
    let last = made.levels.last().unwrap();
    assert!(matches!(last.shape, Shape::Impostor(_)), "{:?}", made.notes);
    for pair in made.levels.windows(2) {
        let [before, after] = [0, 1].map(|k| pictured(&pair[k]));
        let shown = pop(&maker, &before, &after, pair[1].pixels_high);
        assert!(shown > 0.0 && shown <= MOST, "{shown}");
        assert_eq!(pair[1].pop, Some(shown));
    }
}

/// Four walls about a plant, so far from its middle and so high that nothing is seen over them.
fn courtyard(maker: &Maker<'_>, distance: f64) -> Surface {
    let material = Material {
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        ..(*maker.look.original.surfaces[0].material).clone()
    };
    let corners = [[-1.0, -9.0], [1.0, -9.0], [1.0, 9.0], [-1.0, 9.0]];
    let wall = |k: u32| {
        let turn = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2 * f64::from(k));
        corners.map(|[x, y]| maker.look.sphere.centre + turn * DVec3::new(x, y, 1.0) * distance)
    };
    let positions: Vec<DVec3> = (0..4).flat_map(wall).collect();
    Surface {
        normals: vec![Vec3::Y; positions.len()],
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: (0..4)
            .flat_map(|k| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|corner| 4 * k + corner)))
            .collect(),
        positions,
        material: Arc::new(material),
    }
}

/// A camera in a courtyard sees a plant that no eye beyond the walls does; one that looks away is none, and eyes all
/// around stand behind the walls too.
#[test]
fn the_fewest_triangles_stand_where_nothing_is_seen_of_a_plant() {
    let (tree, engine) = (oak(), engine());
    let free = options(&DISTANCES);
    let maker = Maker::new(&tree, &free, &engine).unwrap();
    let BoundingSphere { centre, radius } = maker.look.sphere;
    let eye = centre + DVec3::Z * 1.1 * radius;
    let away = centre + DVec3::Z * 9.0 * radius;
    for (target, impostor) in [(centre, Choice::Auto), (away, Choice::Cards)] {
        let camera = View::look_at(eye, target, DVec3::Y, 0.5, 0.1).unwrap();
        let options = ChainOptions {
            scene: Some(SceneLook {
                cameras: Some(ViewSet::new(vec![camera])),
                obstacles: vec![courtyard(&maker, 1.2 * radius)],
            }),
            max_pop: Some(0.1),
            impostor: Some(impostor),
            ..free.clone()
        };
        let made = chain(&tree, &options, &engine, &mut go_on).unwrap();
        if impostor == Choice::Cards {
            let last = made.levels.last().unwrap();
            assert!(last.triangles <= 20, "{}", last.triangles);
            let figures = (last.difference, last.flip_mean);
            assert_eq!(figures, (Difference::default(), 0.0));
        }
        for level in &made.levels {
            let drawn = level.as_drawn.unwrap();
            let all = [
                level.difference.over(options.limits()),
                level.flip_mean,
                level.pop.unwrap_or(0.0),
                drawn.begin.coverage_over_truth,
                drawn.end.coverage_over_truth,
            ];
            assert!(all.iter().all(|figure| figure.is_finite()), "{all:?}");
        }
    }
}

/// Little effort estimates how far large levels look from the plant, and says so; more effort has no estimates.
#[test]
fn little_effort_estimates_large_differences() {
    let (tree, engine) = (oak(), engine());
    let made_by = |effort: Effort| {
        let mut options = options(&[20.0]);
        options.leaves.effort = effort;
        options.wanted = Wanted::Heights(vec![300.0]);
        options.impostor = Some(Choice::None);
        options.textures = Textures::Keep;
        options.max_difference = 0.5;
        chain(&tree, &options, &engine, &mut go_on).unwrap()
    };
    let is_said = |chain: &Chain| chain.notes.iter().any(|note| note.contains("estimates"));
    assert!(!is_said(&made_by(Effort::Normal)));
    let fast = made_by(Effort::Fast);
    assert!(is_said(&fast));
    let Shape::Mesh(lod) = &fast.levels[0].shape else {
        panic!("a mesh was asked for");
    };
    let drawn = tree.items().drawn(Detail::Color).unwrap();
    let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
    let judge = DifferenceJudge::new(LevelSurfaces::of(drawn).surfaces, &is_wood);
    let level = Drawn::of(&tree.items().lod_document(lod).unwrap()).unwrap();
    let exact = judge.difference(&level.level.surfaces, 300.0, ViewCount::All);
    let ratio = exact.difference / fast.levels[0].difference.difference;
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn cards_of_twigs_may_use_more_than_those_of_surfaces() {
    let (tree, engine) = (grown(Species::Oak, 40), engine());
    let options = options(&[20.0]);
    let maker = Maker::new(&tree, &options, &engine).unwrap();
    let share = |pixels_high: f64| {
        let limits = maker.look.limits_of_impostors(pixels_high);
        limits.difference / maker.look.limits.difference
    };
    let (of_twigs, of_surfaces) = (share(8.0), share(500.0));
    assert!(
        of_surfaces < of_twigs && of_twigs < 1.0,
        "{of_surfaces} {of_twigs}"
    );
}
