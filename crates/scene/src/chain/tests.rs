//! Chains that end in cards.

use std::ops::ControlFlow;

use secateur_gltf::{Document, WholeTree, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_raster::{Engine, OpenEngine};
use secateur_simplify::whole::WoodMode;
use secateur_simplify::{Error, Options, Preset, Progress, Target};

use super::*;
use crate::Screen;
use crate::impostor::Choice;

/// A small oak.
fn oak() -> WholeTree {
    let options = GrowOptions {
        leaves: 120,
        seed: 5,
    };
    let oak = plant_to_glb(&grow(Species::Oak, &options).unwrap());
    let document = Document::from_bytes("oak.glb", oak, None).unwrap();
    document.into_whole_tree(&[]).unwrap()
}

fn engine() -> OpenEngine {
    OpenEngine::open(Engine::Cpu, 0).unwrap()
}

/// Levels for distances, with whatever impostor is lighter.
fn options(distances: &[f64]) -> ChainOptions {
    let mut leaves = Options::with_preset(Preset::Look, Target::triangle_share(1.0));
    leaves.audit = false;
    leaves.shows_what_is_left = false;
    ChainOptions {
        wanted: Wanted::Distances(distances.to_vec()),
        screen: Screen::default(),
        max_flip: 0.05,
        leaves,
        wood: WoodMode::Auto,
        impostor: Choice::Auto,
        shadow_steps: 0,
        max_pop: None,
        textures: Textures::Fit,
        scene: None,
    }
}

/// What is asked to stop, once, while cards are sought or a mesh is made beside them, stops the chain.
#[test]
fn a_chain_stops_while_it_looks_for_cards() {
    let (tree, engine) = (oak(), engine());
    let is_impostor = |progress| progress == Progress::Impostor;
    let is_stage = |progress| matches!(progress, Progress::Stage(_));
    for is_last in [is_impostor, is_stage] {
        let (mut has_impostor, mut is_over) = (false, false);
        let observer = &mut |progress| {
            assert!(!is_over, "it went on");
            is_over = (has_impostor || is_impostor(progress)) && is_last(progress);
            has_impostor |= is_impostor(progress);
            match is_over {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let made = chain(&tree, &options(&[20.0, 60.0]), &engine, observer);
        let is_stopped = matches!(made, Err(ChainError::Simplify(Error::Stopped)));
        assert!(is_stopped && is_over);
    }
}
